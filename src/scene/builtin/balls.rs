//! The sphereflake.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use glam::{DMat3, DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Mesh, Scene};

/// As the Standard Procedural Databases define it: a mirroring sphere that carries nine of a third of its radius, each
/// of which carries nine again, down to the size factor; below lies a beige square. Three lights.
pub const SCENE: Builtin = Builtin {
    name: "balls",
    about: "The sphereflake: mirroring balls that carry smaller balls, above a floor.",
    default_size: 4,
    size_range: 1..=6,
    default_resolution: Some(8),
    count: |size| Primitives { polygons: 1, spheres: (9u64.pow(size + 1) - 1) / 8, ..Primitives::default() },
    build,
};

/// A child's radius as a share of its parent's.
const SHRINK: f64 = 1.0 / 3.0;

fn build(size: u32, slices: u32) -> Scene {
    let mut mesh = Mesh::default();
    kit::ground(&mut mesh, 12.0, -0.5, 0);
    let flake = Flake { directions: directions(), slices };
    flake.grow(&mut mesh, size, Ball { center: DVec3::ZERO, radius: 0.5, outward: DVec3::Z });
    let materials =
        vec![kit::matt(Vec3::new(1.0, 0.75, 0.33), 0.8), kit::shiny(Vec3::new(1.0, 0.9, 0.7), 0.5, 0.5, 37.0)];
    let lights = kit::lights([dvec3(4.0, 3.0, 2.0), dvec3(1.0, -4.0, 4.0), dvec3(-3.0, 1.0, 5.0)]);
    let camera = kit::camera(dvec3(2.1, 1.3, 1.7), DVec3::ZERO, DVec3::Z, 45.0);
    kit::scene("balls", mesh, materials, lights, camera, kit::SKY)
}

struct Flake {
    directions: [DVec3; 9],
    slices: u32,
}

#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
    /// The unit vector away from the parent.
    outward: DVec3,
}

impl Flake {
    /// Adds a ball and all that it carries.
    fn grow(&self, mesh: &mut Mesh, depth: u32, ball: Ball) {
        kit::sphere(mesh, ball.center, ball.radius, self.slices, 1);
        if depth == 0 {
            return;
        }
        let turn = turn_from_z(ball.outward);
        for direction in self.directions {
            let outward = turn * direction;
            let center = ball.center + outward * (ball.radius * (1.0 + SHRINK));
            self.grow(mesh, depth - 1, Ball { center, radius: ball.radius * SHRINK, outward });
        }
    }
}

/// Where the nine children of a ball lie that itself points up: six around its equator, three above.
fn directions() -> [DVec3; 9] {
    const D: f64 = FRAC_1_SQRT_2;
    let tilt = DMat3::from_axis_angle(dvec3(D, -D, 0.0), (2.0 / 6f64.sqrt()).asin());
    let three = [dvec3(D, D, 0.0), dvec3(D, 0.0, -D), dvec3(0.0, D, -D)].map(|direction| tilt * direction);
    std::array::from_fn(|i| DMat3::from_rotation_z((i / 3) as f64 * TAU / 3.0) * three[i % 3])
}

/// The rotation that takes the z axis to a direction by the shortest way; if the direction is opposite, around y.
fn turn_from_z(direction: DVec3) -> DMat3 {
    // So close to the axis, the direction's x and y are rounding.
    const ALMOST: f64 = 1.0 - 1e-12;
    if direction.z >= ALMOST {
        DMat3::IDENTITY
    } else if direction.z <= -ALMOST {
        DMat3::from_rotation_y(PI)
    } else {
        DMat3::from_axis_angle(DVec3::Z.cross(direction).normalize(), direction.z.acos())
    }
}
