//! A fractal mountain behind glass balls.

use std::f64::consts::{SQRT_2, TAU};

use glam::{DMat3, DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Material, Mesh, Scene};

/// As the Standard Procedural Databases define it (there it is called mount), after Carpenter: a square of side 2 whose
/// edges and middle are raised at random and halved, down to the size factor, into 2 triangles times 4 to its power;
/// before it a pyramid of four glass spheres. One light.
///
/// The heights come from the databases' own random numbers, with the hash of 1987 that repeats itself and is kept there
/// for comparison: it is the mountain of the published pictures. That hash is defined up to size factor 7 only; beyond,
/// its last shift is taken to go the other way.
pub const SCENE: Builtin = Builtin {
    name: "mountain",
    about: "A fractal mountain behind four glass balls.",
    default_size: 6,
    size_range: 1..=10,
    default_resolution: Some(16),
    count: |size| Primitives { polygons: 2 * 4u64.pow(size), spheres: 4, ..Primitives::default() },
    build,
};

/// The databases' fractal dimension, between 2 and 3.
const DIMENSION: f64 = 2.2;

/// The number of the databases' mountain.
const SEED: u64 = 21;

fn build(size: u32, slices: u32) -> Scene {
    let mut mesh = Mesh::default();
    glass_balls(&mut mesh, dvec3(-0.8, 0.8, 1.0), 0.17, slices);
    let side = 1 << size;
    let ratio = 2.0 / (2f64.ln() / (DIMENSION - 1.0)).exp();
    let mountain = Mountain { size, cell: 2.0 / f64::from(side), roughness: (ratio * ratio - 1.0).sqrt() };
    mesh.begin_object();
    mountain.grow(&mut mesh, side, [0, 0], [0.0; 4]);
    let glass = Material { transmittance: 0.9, refraction: 1.5, ..kit::shiny(Vec3::ONE, 0.1, 0.1, 6.7) };
    let materials = vec![glass, kit::matt(Vec3::new(0.5, 0.45, 0.35), 1.0)];
    let camera = kit::camera(dvec3(-1.6, 1.6, 1.7), DVec3::ZERO, DVec3::Z, 45.0);
    kit::scene("mountain", mesh, materials, kit::lights([dvec3(-100.0, -100.0, 100.0)]), camera, kit::SKY)
}

/// Adds four spheres that touch, as a pyramid around its middle.
fn glass_balls(mesh: &mut Mesh, center: DVec3, radius: f64, slices: u32) {
    let top = DVec3::Z * (radius * 1.5f64.sqrt());
    kit::sphere(mesh, center + top, radius, slices, 0);
    let lower = DMat3::from_axis_angle(dvec3(1.0, 1.0, 0.0).normalize(), (-1.0f64 / 3.0).acos()) * top;
    for third in 0..3 {
        let around = DMat3::from_rotation_z(f64::from(third) * TAU / 3.0);
        kit::sphere(mesh, center + around * lower, radius, slices, 0);
    }
}

struct Mountain {
    size: u32,
    /// Side of the smallest square.
    cell: f64,
    roughness: f64,
}

impl Mountain {
    /// Adds a square of `width` cells with its lower left corner at cell `[x, y]`. Its heights go around: lower left,
    /// lower right, upper right, upper left.
    fn grow(&self, mesh: &mut Mesh, width: u32, [x, y]: [u32; 2], [ll, lr, ur, ul]: [f64; 4]) {
        if width == 1 {
            return self.cell(mesh, [x, y], [ll, lr, ur, ul]);
        }
        let half = width / 2;
        let rise = f64::from(half) * self.cell * self.roughness;
        let raised = |level: f64, x: u32, y: u32| level + rise * self.random(x, y);
        let bottom = raised((ll + lr) / 2.0, x + half, y);
        let right = raised((lr + ur) / 2.0, x + width, y + half);
        let top = raised((ur + ul) / 2.0, x + half, y + width);
        let left = raised((ul + ll) / 2.0, x, y + half);
        let middle = (ll + lr + ur + ul) / 4.0 + SQRT_2 * rise * self.random(x + half, y + half);
        self.grow(mesh, half, [x, y], [ll, bottom, middle, left]);
        self.grow(mesh, half, [x + half, y], [bottom, lr, right, middle]);
        self.grow(mesh, half, [x + half, y + half], [middle, right, ur, top]);
        self.grow(mesh, half, [x, y + half], [left, middle, top, ul]);
    }

    /// Adds the two triangles of a smallest square.
    fn cell(&self, mesh: &mut Mesh, [x, y]: [u32; 2], heights: [f64; 4]) {
        let place = |k: u32| f64::from(k) * self.cell - 1.0;
        let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        let points: [u32; 4] = std::array::from_fn(|i| {
            mesh.add_point(dvec3(place(corners[i].0), place(corners[i].1), heights[i]).as_vec3())
        });
        mesh.add_face(&[points[0], points[1], points[2]], 1);
        mesh.add_face(&[points[2], points[3], points[0]], 1);
    }

    /// The random number of a grid point.
    fn random(&self, x: u32, y: u32) -> f64 {
        let (x, y) = (u64::from(x), u64::from(y));
        let last = if self.size <= 7 { x << (7 - self.size) } else { x >> (self.size - 7) };
        let hash = ((x << (23 - self.size)) + (y << (15 - self.size)) + last) & 0xffff;
        gaussian(SEED + hash)
    }
}

/// A normally distributed number that depends on the seed alone: the polar method on a small congruential generator.
fn gaussian(seed: u64) -> f64 {
    const MODULUS: u64 = 134_456;
    let mut state = seed;
    let mut next = || {
        state = (state * 8121 + 28_411) % MODULUS;
        2.0 * state as f64 / MODULUS as f64 - 1.0
    };
    loop {
        let (a, b) = (next(), next());
        let square = a * a + b * b;
        if square < 1.0 {
            return a * (-2.0 * square.ln() / square).sqrt();
        }
    }
}
