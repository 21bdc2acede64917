//! How many instructions a second cells that run programs execute, on one core, ops and hits included.
//!
//! `cargo bench --bench instructions [-- SCENE [WIDTH]]`; the scene is `reference` and the image 142 x 142 by default.

use std::time::Instant;

use pcs_sim::host::camera::{ImageSize, primary_rays};
use pcs_sim::isa::Processor;
use pcs_sim::machine::MachineFile;
use pcs_sim::program::cells::{Annex, CellOptions};
use pcs_sim::program::{ArrayProgram, Tracer, Workload};
use pcs_sim::scene::builtin;
use pcs_sim::seam::OpBatch;

const REPEATS: usize = 5;

fn main() {
    let mut args = std::env::args().skip(1).filter(|arg| !arg.starts_with("--"));
    let scene = args.next().unwrap_or("reference".to_owned());
    let width: u32 = args.next().map_or(142, |width| width.parse().expect("a width in pixels"));
    let scene = builtin::generate(&scene, None, None).expect("a built-in scene");
    let machine = MachineFile::standard().and_then(|file| file.build()).expect("the standard machine");
    let rays = primary_rays(&scene.camera, ImageSize { width, height: width });
    let cycles = machine.instructions.expect("the standard machine has them");
    let options =
        CellOptions { cycles, folder: None, instruction_limit: Processor::INSTRUCTION_LIMIT, annex: Annex::default() };
    println!("{}, {} rays; the best of {REPEATS} runs", scene.name, rays.len());
    println!("{:<12} {:>14} {:>10} {:>24}", "program", "instructions", "seconds", "million instructions/s");
    for name in ["pipeline", "broadcast", "hybrid"] {
        let program = ArrayProgram::standard(name).expect("a standard program").expect("a good program");
        let workload = Workload::new(&scene.mesh, &program, machine.times, &rays).expect("it fits");
        let workload = workload.with_programs(&options).expect("the programs assemble");
        let mut best = f64::INFINITY;
        let mut executed = 0;
        for _ in 0..REPEATS {
            let mut tracer = Tracer::new(&workload);
            let mut batch = OpBatch::new(workload.cells());
            let start = Instant::now();
            for (id, ray) in rays.iter().enumerate() {
                tracer.trace(id as u32, rays.len(), ray, &mut batch);
                if id % 256 == 0 {
                    batch.clear();
                }
            }
            best = best.min(start.elapsed().as_secs_f64());
            executed = tracer.executed();
        }
        println!("{name:<12} {executed:>14} {best:>10.3} {:>24.0}", executed as f64 / best / 1e6);
    }
}
