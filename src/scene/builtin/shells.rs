//! A seashell.

use std::f64::consts::PI;

use glam::{DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Mesh, Scene};

/// As the Standard Procedural Databases define it, after Pickover (1989): spheres along a logarithmic spiral that winds
/// nine times around a cone, each overlapping its neighbours, from tiny to large. One light.
///
/// There are 180 spheres times 2 to the power of the size factor, and one more, as both ends of the spiral have one.
pub const SCENE: Builtin = Builtin {
    name: "shells",
    about: "A seashell of overlapping balls along a spiral, from tiny to large.",
    default_size: 5,
    size_range: 1..=10,
    default_resolution: Some(8),
    count: |size| Primitives { spheres: steps(size) as u64 + 1, ..Primitives::default() },
    build,
};

/// Growth of the spiral for every radian.
const GROWTH: f64 = 0.15;

fn steps(size: u32) -> i32 {
    180 << size
}

fn build(size: u32, slices: u32) -> Scene {
    let mut mesh = Mesh::default();
    let steps = steps(size);
    for step in -steps * 2 / 3..=steps / 3 {
        let angle = 18.0 * PI * f64::from(step) / f64::from(steps);
        let radius = (GROWTH * angle).exp();
        let center = dvec3(angle.sin(), angle.cos(), -2.0) * radius;
        kit::sphere(&mut mesh, center, radius, slices, 0);
    }
    let materials = vec![kit::shiny(Vec3::new(1.0, 0.8, 0.4), 0.8, 0.2, 10.0)];
    let camera = kit::camera(dvec3(-6.0, -60.0, 35.0), dvec3(0.0, 8.0, -15.0), DVec3::Z, 45.0);
    kit::scene("shells", mesh, materials, kit::lights([dvec3(-100.0, -100.0, 100.0)]), camera, kit::SKY)
}
