//! How long the evaluation of a large solid takes, on one core.
//!
//! `cargo bench --bench solids`

use std::time::Instant;

use glam::{DAffine3, dvec3};
use pcs_sim::scene::solid::{Options, Shell, Solid, evaluate};

const ROUNDS: usize = 3;

/// Balls of 128 polygons on a lattice, ten along each axis, which reach into their neighbours: in every row the odd ones are cut from the
/// union of the even ones.
fn thousand_leaves() -> Solid {
    let ball = |x: u32, y: u32, z: u32| {
        let place = dvec3(x.into(), y.into(), z.into());
        let map = DAffine3::from_translation(place) * DAffine3::from_scale(dvec3(0.7, 0.65, 0.6));
        Solid::leaf(Shell::sphere(16)).placed(map)
    };
    let row = |y: u32, z: u32| {
        let even = Solid::Union((0..10).step_by(2).map(|x| ball(x, y, z)).collect());
        Solid::Difference(std::iter::once(even).chain((1..10).step_by(2).map(|x| ball(x, y, z))).collect())
    };
    Solid::Union((0..10).map(|z| Solid::Union((0..10).map(|y| row(y, z)).collect())).collect())
}

fn main() {
    let solid = thousand_leaves();
    let mut times: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            match evaluate(&solid, Options::default()) {
                Ok(evaluated) => println!("{}", evaluated.report.sentence()),
                Err(error) => println!("{error}"),
            }
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("a solid of 1 000 leaves: median {:.2} s of {ROUNDS}", times[ROUNDS / 2]);
}
