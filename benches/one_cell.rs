//! Broadcast on one cell, the functional half alone, on one thread: the rays of a file on the scene of a file. `benches/embree.py` holds
//! it against Embree.
//!
//! `cargo bench --bench one_cell -- SCENE RAYS`

use std::convert::Infallible;
use std::path::Path;
use std::time::Instant;

use pcs_sim::host::ray_file;
use pcs_sim::machine::MachineFile;
use pcs_sim::program::{ArrayProgram, Workload};
use pcs_sim::run::{self, Workers};
use pcs_sim::scene::{self, ReadOptions};

const REPEATS: usize = 5;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with("--")).collect();
    let [scene, rays] = &args[..] else {
        println!("one_cell needs a scene and rays: cargo bench --bench one_cell -- SCENE RAYS");
        return;
    };
    let scene = scene::load(Path::new(scene), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let rays = ray_file::read(Path::new(rays)).unwrap_or_else(|error| panic!("{error}"));
    let machine = MachineFile::standard().and_then(|file| file.build()).expect("the standard machine");
    let standard = ArrayProgram::standard("broadcast").expect("a standard program").expect("a good program");
    let program = ArrayProgram { groups: 1, ..standard };
    let start = Instant::now();
    let workload = Workload::new(&scene.mesh, &program, machine.times, &rays).expect("it fits");
    let prepared = start.elapsed().as_secs_f64();
    let (mut best, mut hits) = (f64::INFINITY, 0);
    for _ in 0..REPEATS {
        let (start, mut found) = (Instant::now(), 0);
        run::trace(&workload, &rays, &Workers::new(1), |batch| {
            found += batch.counts.hits;
            Ok::<_, Infallible>(batch)
        })
        .expect("tracing cannot fail");
        (best, hits) = (best.min(start.elapsed().as_secs_f64()), found);
    }
    println!("{} polygons, {} rays, best of {REPEATS}", scene.mesh.face_count(), rays.len());
    println!("prepared {prepared:.3} s");
    println!("traced {best:.3} s");
    println!("hits {hits}");
}
