//! Cells that run programs find the same bits as cells that take Figure 7's times, and as brute force.

mod support;

use std::convert::Infallible;

use pcs_sim::geometry::{Polygons, Ray, brute_force};
use pcs_sim::program::cells::CellOptions;
use pcs_sim::program::{ArrayProgram, Counts, Workload};
use pcs_sim::scene::{Mesh, builtin};
use pcs_sim::simulation;
use support::{bits, machine, program, scene};

fn options() -> CellOptions {
    CellOptions { cycles: machine().instructions.unwrap(), folder: None, cycle_limit: 1 << 40 }
}

fn run(workload: &Workload, rays: &[Ray]) -> (Vec<[u32; 4]>, Counts, u64) {
    let outcome = simulation::run(workload, &machine().spec, rays, 2, |_| Ok::<_, Infallible>(())).unwrap();
    (outcome.hits.iter().map(bits).collect(), outcome.counts, outcome.stats.cycles.0)
}

/// Runs a program both ways; the hits and the counts must be the same.
fn compare(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray], what: &str) -> Vec<[u32; 4]> {
    let workload = Workload::new(mesh, program, machine().times, rays).unwrap();
    let timings = run(&workload, rays);
    let programs = run(&workload.with_programs(&options()).unwrap(), rays);
    assert_eq!(programs.0, timings.0, "{what}");
    assert_eq!(programs.1, timings.1, "{what}");
    eprintln!("{what}: {:.3}", programs.2 as f64 / timings.2 as f64);
    programs.0
}

#[test]
fn on_full_built_in_scenes() {
    for builtin in builtin::all() {
        let (scene, rays) = scene(builtin.name, builtin.default_size, 16);
        let polygons = Polygons::new(&scene.mesh);
        let expected: Vec<[u32; 4]> = rays.iter().map(|ray| bits(&brute_force(&polygons, ray))).collect();
        for (mode, groups) in [("pipeline", 1), ("broadcast", 1), ("broadcast", 7), ("hybrid", 4), ("hybrid-3", 2)] {
            let what = format!("{}, {mode} in {groups} groups", builtin.name);
            assert_eq!(compare(&scene.mesh, &program(mode, groups), &rays, &what), expected, "{what}");
        }
    }
}

#[test]
fn fit() {
    use pcs_sim::program::cells::{calibrate, figure7};
    let cycles = calibrate::calibrate(&machine().spec, None).unwrap();
    eprintln!("{cycles:?}");
    let options = CellOptions { cycles, ..options() };
    for (number, got) in figure7::NUMBERS.iter().zip(figure7::measure(machine().times, Some(&options)).unwrap()) {
        eprintln!("{} {} {}", number.name, number.paper_us * 20.0, got);
    }
    eprintln!("{:?}", figure7::measure(machine().times, None).unwrap());
}
