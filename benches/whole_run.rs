//! Whole runs against their functional half alone, side by side: what exact timing costs.
//!
//! `cargo bench --bench whole_run [-- SCENE [WIDTH]]`; the scene is `reference` and the image 512 x 512 by default.

use std::convert::Infallible;
use std::time::Instant;

use pcs_sim::geometry::Ray;
use pcs_sim::host::camera::{ImageSize, primary_rays};
use pcs_sim::machine::MachineFile;
use pcs_sim::machine::MachineSpec;
use pcs_sim::program::{ArrayProgram, Workload};
use pcs_sim::run::{self, Workers};
use pcs_sim::scene::builtin;

const REPEATS: usize = 7;

fn functional(workload: &Workload, rays: &[Ray], threads: usize) -> f64 {
    let start = Instant::now();
    run::trace(workload, rays, &Workers::new(threads), Ok::<_, Infallible>).expect("tracing cannot fail");
    start.elapsed().as_secs_f64()
}

fn whole(workload: &Workload, spec: &MachineSpec, rays: &[Ray], threads: usize) -> (f64, u64) {
    let start = Instant::now();
    let outcome = run::run(workload, spec, rays, &Workers::new(threads), |_| Ok::<_, Infallible>(())).expect("it ends");
    (start.elapsed().as_secs_f64(), outcome.stats.fifos.iter().map(|fifo| fifo.words.0).sum())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let mut args = std::env::args().skip(1).filter(|arg| !arg.starts_with("--"));
    let scene = args.next().unwrap_or("reference".to_owned());
    let width: u32 = args.next().map_or(512, |width| width.parse().expect("a width in pixels"));
    let scene = builtin::generate(&scene, None, None).expect("a built-in scene");
    let machine = MachineFile::standard().and_then(|file| file.build()).expect("the standard machine");
    let rays = primary_rays(&scene.camera, ImageSize { width, height: width });
    println!("{}, {} rays; medians of {REPEATS} pairs", scene.name, rays.len());
    println!(
        "{:<12} {:>7} {:>14} {:>10} {:>8} {:>14}",
        "program", "threads", "functional, s", "whole, s", "ratio", "Mwords/s whole"
    );
    for name in ["pipeline", "broadcast", "hybrid"] {
        let program = ArrayProgram::standard(name).expect("a standard program").expect("a good program");
        let workload = Workload::new(&scene.mesh, &program, machine.times, &rays).expect("it fits");
        for threads in [1, 2] {
            let pair = |_| (functional(&workload, &rays, threads), whole(&workload, &machine.spec, &rays, threads));
            let pairs: Vec<(f64, (f64, u64))> = (0..REPEATS).map(pair).collect();
            let alone = median(pairs.iter().map(|pair| pair.0).collect());
            let both = median(pairs.iter().map(|pair| pair.1.0).collect());
            let ratio = median(pairs.iter().map(|pair| pair.1.0 / pair.0).collect());
            let rate = pairs[0].1.1 as f64 / both / 1e6;
            println!("{name:<12} {threads:>7} {alone:>14.3} {both:>10.3} {ratio:>8.2} {rate:>14.0}");
        }
    }
}
