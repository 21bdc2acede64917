//! The trees of the reference scene.

use glam::{DVec2, DVec3, dvec2};

use super::land::{self, HALF};
use super::stuff::Stuff;
use super::{EYE, village};
use crate::scene::Mesh;
use crate::scene::builtin::kit::{cone, sphere};
use crate::scene::builtin::noise::{fractal, unit};

/// Polygons of a tree: a trunk of 6 and three cones of 8, or a trunk of 6, a crown of 18 and a bush of 6.
pub const TREE_FACES: u32 = 30;

/// How many places are tried for a tree before it must do with one outside of the woods, and with any.
const TRIES_IN_WOODS: i32 = 24;
const TRIES: i32 = 200;

/// Adds `count` trees.
pub fn add(mesh: &mut Mesh, count: u32) {
    for number in 0..count as i32 {
        let at = place(number);
        let foot = at.extend(land::height(at) - 0.1);
        let height = 1.2 + 1.6 * unit(200, [number, 0]);
        if unit(201, [number, 0]) < 0.35 + 0.09 * foot.z {
            fir(mesh, foot, height);
        } else {
            round_tree(mesh, foot, 0.75 * height);
        }
    }
}

/// Where a tree stands: at random, on dry even ground outside of the village, mostly in woods.
fn place(number: i32) -> DVec2 {
    let candidate = |trial: i32| {
        let along = |seed: u64| (2.0 * unit(seed, [number, trial]) - 1.0) * 0.98 * HALF;
        dvec2(along(202), along(203))
    };
    let fit = |trial: &i32| {
        let at = candidate(*trial);
        let in_woods = *trial >= TRIES_IN_WOODS || fractal(204, at * 0.09, 3) > 0.52;
        in_woods && at.distance(EYE.truncate()) > 10.0 && village::ground(at) < 0.2 && grows(at)
    };
    candidate((0..TRIES).find(fit).unwrap_or(TRIES))
}

fn grows(at: DVec2) -> bool {
    (0.5..9.5).contains(&land::height(at)) && land::slope(at) < 1.0
}

fn trunk(mesh: &mut Mesh, foot: DVec3, height: f64, radius: f64) {
    let top = foot + DVec3::Z * height;
    cone(mesh, (foot, radius), (top, 0.7 * radius), 6, Stuff::Trunk.index());
}

fn fir(mesh: &mut Mesh, foot: DVec3, height: f64) {
    trunk(mesh, foot, 0.3 * height, 0.06 * height);
    for (low, high, radius) in [(0.18, 0.6, 0.3), (0.4, 0.8, 0.24), (0.62, 1.05, 0.17)] {
        let at = |share: f64| foot + DVec3::Z * (share * height);
        cone(mesh, (at(low), radius * height), (at(high), 0.0), 8, Stuff::Fir.index());
    }
}

fn round_tree(mesh: &mut Mesh, foot: DVec3, height: f64) {
    trunk(mesh, foot, 0.5 * height, 0.07 * height);
    let crown = foot + DVec3::Z * (0.75 * height);
    sphere(mesh, crown, 0.4 * height, 6, Stuff::Leaves.index());
    let bush = foot + DVec3::X * (0.3 * height);
    cone(mesh, (bush, 0.15 * height), (bush + DVec3::Z * (0.25 * height), 0.0), 6, Stuff::Leaves.index());
}
