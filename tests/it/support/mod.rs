//! What several test files need.

pub mod command;
pub mod random_ops;
pub mod ticking;
pub mod whitted;

use std::convert::Infallible;

use pcs_sim::geometry::{Hit, Ray};
use pcs_sim::host::camera::{ImageSize, primary_rays};
use pcs_sim::machine::OpBatch;
use pcs_sim::machine::{Machine, MachineFile};
use pcs_sim::program::cells::CellOptions;
use pcs_sim::program::{ArrayProgram, Workload};
use pcs_sim::scene::{Mesh, Scene, builtin};
use pcs_sim::simulation::{self, TracedBatch};

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
    let outcome = simulation::run(&workload, &machine().spec, rays, threads, |_| Ok::<_, Infallible>(())).unwrap();
    outcome.hits.iter().map(bits).collect()
}

/// Standard programs for the cells.
pub fn cell_options() -> CellOptions {
    CellOptions { cycles: machine().instructions.unwrap(), folder: None, cycle_limit: 1 << 40 }
}

/// The hits of a whole run of cells that run programs.
pub fn program_hits(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray]) -> Vec<[u32; 4]> {
    let workload = workload(mesh, program, rays).with_programs(&cell_options()).unwrap();
    let outcome = simulation::run(&workload, &machine().spec, rays, 1, |_| Ok::<_, Infallible>(())).unwrap();
    outcome.hits.iter().map(bits).collect()
}

/// The ops of a run.
pub fn ops(workload: &Workload, rays: &[Ray]) -> Vec<OpBatch> {
    let mut batches = Vec::new();
    simulation::trace(workload, rays, 1, |batch| {
        batches.push(batch.ops);
        Ok::<_, Infallible>(TracedBatch::default())
    })
    .unwrap();
    batches
}
