//! A wave that looks like a hat.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Mesh, Scene};

/// As the Standard Procedural Databases define it (Alexander Enzmann, 1995): heights of a damped cosine of the distance
/// from the middle, on a square grid of 32 points a side, twice as many for each further size factor; every cell is two
/// triangles. The y axis is vertical. One light.
///
/// The definition samples the wave at steps of the side over the number of points, but places the samples at steps of
/// the side over that number less one, so that the hat is a little larger than its formula and off the middle.
pub const SCENE: Builtin = Builtin {
    name: "sombrero",
    about: "A red hat: the wave that a drop leaves in water, as a height field.",
    default_size: 1,
    size_range: 1..=7,
    default_resolution: None,
    count: |size| Primitives { polygons: 2 * u64::from(points(size) - 1).pow(2), ..Primitives::default() },
    build: |size, _| build(size),
};

/// Half a side of the field.
const HALF: f64 = 4.0;

/// Height of the field's zero.
const LEVEL: f64 = -3.0;

fn points(size: u32) -> u32 {
    16 << size
}

fn build(size: u32) -> Scene {
    let side = points(size);
    let mut mesh = Mesh::default();
    for row in 0..side {
        for column in 0..side {
            let place = |k: u32| 2.0 * HALF * f64::from(k) / f64::from(side - 1) - HALF;
            mesh.add_point(dvec3(place(column), LEVEL + height(column, row, side), place(row)).as_vec3());
        }
    }
    for row in 0..side - 1 {
        for column in 0..side - 1 {
            let here = row * side + column;
            mesh.add_face(&[here, here + side + 1, here + 1], 0);
            mesh.add_face(&[here, here + side, here + side + 1], 0);
        }
    }
    let materials = vec![kit::matt(Vec3::new(1.0, 0.1, 0.1), 0.8)];
    let camera = kit::camera(dvec3(0.0, 5.0, -8.0), DVec3::ZERO, DVec3::Z, 40.0);
    kit::scene("sombrero", mesh, materials, kit::lights([dvec3(10.0, 10.0, -10.0)]), camera, kit::SKY)
}

fn height(column: u32, row: u32, side: u32) -> f64 {
    let place = |k: u32| 2.0 * HALF * f64::from(k) / f64::from(side) - HALF;
    let distance = place(column).hypot(place(row));
    (TAU * distance).cos() * (-distance).exp()
}
