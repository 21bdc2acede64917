//! A scene, an array program and a machine, run: what the command line does, in a few lines.

use pcs_sim::host::camera::{ImageSize, primary_rays};
use pcs_sim::machine::MachineFile;
use pcs_sim::machine::{MachineSpec, Words};
use pcs_sim::program::{ArrayProgram, Workload};
use pcs_sim::report::summary;
use pcs_sim::run::{self, Workers};
use pcs_sim::{error::InputError, scene::builtin};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = builtin::generate("teapot", None, None)?;
    let rays = primary_rays(&scene.camera, ImageSize { width: 64, height: 64 });
    let machine = MachineFile::standard()?.build()?;
    let broadcast = ArrayProgram::standard("broadcast").ok_or("no such program")??;
    let workload = Workload::new(&scene.mesh, &ArrayProgram { groups: 4, ..broadcast }, machine.times, &rays)?;
    for fifo_words in [512, 64, 8] {
        let spec = MachineSpec { fifo_words: Words(fifo_words), ..machine.spec.clone() };
        let outcome = run::run(&workload, &spec, &rays, &Workers::new(2), |_| Ok::<(), InputError>(()))?;
        println!("{fifo_words:>4} words a FIFO: {}", summary::speed(&outcome.stats, spec.clock()));
    }
    Ok(())
}
