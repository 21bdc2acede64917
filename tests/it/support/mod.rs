//! What several test files need.

pub mod browser;
pub mod command;
pub mod cube_ticking;
pub mod cube_wires;
pub mod farm_looking_back;
pub mod farm_ticking;
pub mod heap_events;
pub mod intervals;
pub mod lab;
pub mod looking_back;
pub mod memory_ticking;
pub mod pictures;
pub mod random_ops;
pub mod ticking;
pub mod whitted;

use std::convert::Infallible;
use std::path::Path;

use pcs_sim::geometry::{Hit, Ray};
use pcs_sim::host::camera::{ImageSize, primary_rays};
use pcs_sim::isa::InstructionCycles;
use pcs_sim::machine::{KernelTimes, Machine, MachineFile};
use pcs_sim::measure::{FifoStats, Measured, Recording};
use pcs_sim::program::cells::{Annex, CellOptions};
use pcs_sim::program::{ArrayProgram, Workload, work};
use pcs_sim::quantities::Cycles;
use pcs_sim::run::{self, Layers, PlannedRun, RunSpec, Setup, TracedBatch, Watching, Workers};
use pcs_sim::scene::{self, Mesh, ReadOptions, Scene, builtin};
use pcs_sim::seam::activity_trace::{Form, TraceWriter};
use pcs_sim::seam::{Costs, Op, OpBatch};

/// PCS.
pub fn machine() -> Machine {
    MachineFile::standard().unwrap().build().unwrap()
}

/// A standard program with so many groups.
pub fn program(name: &str, groups: usize) -> ArrayProgram {
    ArrayProgram { groups, ..ArrayProgram::standard(name).unwrap().unwrap() }
}

/// A built-in scene and primary rays of a square image.
pub fn scene(name: &str, size: u32, width: u32) -> (Scene, Vec<Ray>) {
    let scene = builtin::generate(name, Some(size), None).unwrap();
    let rays = primary_rays(&scene.camera, ImageSize { width, height: width });
    (scene, rays)
}

/// Glass, mirrors and lights.
pub fn glass() -> Scene {
    scene::load(Path::new("tests/data/glass.ron"), &ReadOptions::default()).unwrap()
}

pub fn workload(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray]) -> Workload {
    Workload::new(mesh, program, machine().times, rays).unwrap()
}

/// A hit as the words of its message, but for the ray's number.
pub fn bits(hit: &Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.polygon, hit.alpha.to_bits(), hit.beta.to_bits()]
}

/// The hits of a whole run.
pub fn hits(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray], threads: usize) -> Vec<[u32; 4]> {
    let workload = workload(mesh, program, rays);
    let outcome =
        run::run(&workload, &machine().spec, rays, &Workers::new(threads), |_| Ok::<_, Infallible>(())).unwrap();
    outcome.hits.iter().map(bits).collect()
}

/// The run that statistics describe, recorded from its first cycle on.
pub fn recorded(stats: serde_json::Value) -> (Setup, Recording) {
    let workers = Workers::new(1);
    let planned = PlannedRun::new(RunSpec::from_json(stats).unwrap()).unwrap();
    let setup = Setup::new(planned, &mut Layers::default(), &workers.cancel).unwrap();
    let watching = Watching { recording: Some(Cycles(0)..Cycles(u64::MAX)), ..Watching::default() };
    let watched = (&setup.machine.spec, &watching);
    let rays = &setup.prepared.rays;
    let outcome = run::run_watched(&setup.workload, watched, rays, &workers, |_, _| Ok::<_, Infallible>(()));
    let recording = outcome.unwrap().observed.recording.unwrap();
    (setup, recording)
}

/// Standard programs for the cells.
pub fn cell_options() -> CellOptions {
    let cycles = machine().instructions.unwrap();
    CellOptions { cycles, folder: None, instruction_limit: 1 << 36, annex: Annex::default() }
}

/// The hits of a whole run of cells that run programs.
pub fn program_hits(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray]) -> Vec<[u32; 4]> {
    let workload = workload(mesh, program, rays).with_programs(&cell_options()).unwrap();
    let outcome = run::run(&workload, &machine().spec, rays, &Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap();
    outcome.hits.iter().map(bits).collect()
}

/// The ops of a run.
pub fn ops(workload: &Workload, rays: &[Ray]) -> Vec<OpBatch> {
    let mut batches = Vec::new();
    run::trace(workload, rays, &Workers::new(1), |batch| {
        batches.push(batch.ops);
        Ok::<_, Infallible>(TracedBatch::default())
    })
    .unwrap();
    batches
}

/// Ops as an activity trace in cycles has them.
pub fn priced(ops: &[Op], costs: &Costs) -> String {
    let mut batch = OpBatch::new(1);
    batch.host.end_line(0);
    batch.cells[0].push_line(0, ops);
    let mut writer = TraceWriter::new(Vec::new(), 1, costs.clone(), Form::Cycles).unwrap();
    writer.write(&batch).unwrap();
    let text = String::from_utf8(writer.into_inner()).unwrap();
    text.lines().last().unwrap().trim_start_matches("0 0").trim().to_owned()
}

/// The units of cells that run programs, whose instructions take so many cycles.
pub fn instruction_costs(cycles: &InstructionCycles) -> Costs {
    work::costs(&work::vocabulary(true), &KernelTimes::default(), Some(cycles))
}

/// The cycles that some cell spent in a state, by the state's name.
pub fn spent(run: &Measured, cell: usize, state: &str) -> u64 {
    let found = run.topology.states.all().iter().find(|other| other.name == state).expect("there is such a state");
    run.stations[cell].of(found.id).0
}

/// What a FIFO held, by its name.
pub fn fifo<'a>(run: &'a Measured, name: &str) -> &'a FifoStats {
    let place = run.topology.fifos.iter().position(|fifo| fifo.name == name).expect("there is such a FIFO");
    &run.fifos[place]
}
