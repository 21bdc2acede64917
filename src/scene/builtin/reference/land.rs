//! The ground of the reference scene.

use glam::{DVec2, DVec3, dvec2};

use super::stuff::Stuff;
use super::village;
use crate::scene::Mesh;
use crate::scene::builtin::noise::{fractal, ramp, ridged};

/// Half a side of the ground.
pub const HALF: f64 = 50.0;

const LAKE: DVec2 = dvec2(2.0, -18.0);

/// Height of the ground at a place, above the water, which is at 0.
pub fn height(at: DVec2) -> f64 {
    let shore = lake_distance(at) + 4.0 * fractal(11, at * 0.12, 3) - 2.0;
    let basin = -1.6 + 2.8 * ramp(8.0, 17.0, shore);
    let wildness = 21.0 * ramp(4.0, 40.0, at.y) + 9.0 * ramp(24.0, 48.0, at.x.abs()) * ramp(-50.0, 0.0, at.y);
    let dry = ramp(12.0, 20.0, shore);
    let hills = 1.5 * fractal(23, at * 0.1, 4) * dry;
    let wild = basin + hills + wildness * ridged(37, at * 0.045, 6) * dry;
    let tame = village::ground(at);
    wild + (village::LEVEL - wild) * tame
}

/// Steepness: how much the height changes over a unit.
pub fn slope(at: DVec2) -> f64 {
    let step = 0.25;
    let along = |axis: DVec2| (height(at + axis * step) - height(at - axis * step)) / (2.0 * step);
    along(DVec2::X).hypot(along(DVec2::Y))
}

/// Distance from the lake's middle, with the lake half as wide again as it is deep.
fn lake_distance(at: DVec2) -> f64 {
    ((at - LAKE) / dvec2(1.5, 1.0)).length()
}

/// Adds the ground as `cells` by `cells` squares of two triangles.
pub fn add(mesh: &mut Mesh, cells: u32) {
    let place = |k: u32| 2.0 * HALF * f64::from(k) / f64::from(cells) - HALF;
    let mut points = Vec::with_capacity(((cells + 1) * (cells + 1)) as usize);
    for y in 0..=cells {
        for x in 0..=cells {
            let at = dvec2(place(x), place(y));
            points.push(at.extend(height(at)));
        }
    }
    mesh.begin_object();
    let first = mesh.points.len() as u32;
    mesh.points.extend(points.iter().map(|point| point.as_vec3()));
    for y in 0..cells {
        for x in 0..cells {
            let here = y * (cells + 1) + x;
            let (right, above) = (here + 1, here + cells + 1);
            for triangle in [[here, right, above + 1], [above + 1, above, here]] {
                let material = stuff(triangle.map(|i| points[i as usize])).index();
                mesh.add_face(&triangle.map(|i| first + i), material);
            }
        }
    }
}

/// What a triangle of the ground is made of.
fn stuff([a, b, c]: [DVec3; 3]) -> Stuff {
    let middle = (a + b + c) / 3.0;
    let normal = (b - a).cross(c - a).normalize();
    let patchy = fractal(53, middle.truncate() * 0.3, 2);
    if middle.z < 0.35 {
        Stuff::Sand
    } else if normal.z > 0.6 && middle.z > 8.5 + 4.0 * patchy {
        Stuff::Snow
    } else if normal.z < 0.72 || middle.z > 6.5 + 4.0 * patchy {
        Stuff::Rock
    } else {
        Stuff::Grass
    }
}
