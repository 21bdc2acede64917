//! A cubic lattice of balls and rods.

use glam::{DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Mesh, Scene};

/// As the Standard Procedural Databases define it (Antonio Costa, 1993): mirroring spheres at the points of a cubic
/// lattice in the unit cube, joined to their neighbours by matt cylinders of one colour for each direction. The eye
/// stands on top of the cube. Six lights.
pub const SCENE: Builtin = Builtin {
    name: "lattice",
    about: "A crystal: mirroring balls joined by red, green and blue rods.",
    default_size: 12,
    size_range: 1..=50,
    default_resolution: Some(8),
    count: |size| {
        let n = u64::from(size);
        Primitives { spheres: (n + 1).pow(3), cones: 3 * n * (n + 1).pow(2), ..Primitives::default() }
    },
    build,
};

fn build(size: u32, slices: u32) -> Scene {
    let mut mesh = Mesh::default();
    let lattice = Lattice::new(size, slices);
    for x in 0..=size {
        for y in 0..=size {
            for z in 0..=size {
                lattice.point(&mut mesh, [x, y, z]);
            }
        }
    }
    let rods = [[0.9, 0.1, 0.1], [0.1, 0.9, 0.1], [0.1, 0.1, 0.9]].map(|color| kit::matt(Vec3::from(color), 0.99));
    let materials = [kit::shiny(Vec3::splat(0.9), 0.5, 0.5, 37.0)].into_iter().chain(rods).collect();
    let lights = kit::lights([
        dvec3(2.0, 0.5, 0.5),
        dvec3(-1.0, 0.5, 0.5),
        dvec3(0.5, 2.0, 0.5),
        dvec3(0.5, -1.0, 0.5),
        dvec3(0.5, 0.5, 2.0),
        dvec3(0.5, 0.5, -1.0),
    ]);
    let middle = (f64::from(size / 2) + 0.5) / f64::from(size);
    let half_cell = 0.5 / f64::from(size);
    let camera = kit::camera(
        dvec3(middle, 1.0, 1.0 - half_cell),
        dvec3(middle, -1.0, -1.0 - half_cell),
        dvec3(0.2, 1.0, 0.0),
        60.0,
    );
    kit::scene("lattice", mesh, materials, lights, camera, kit::SKY)
}

struct Lattice {
    size: u32,
    cell: f64,
    ball: f64,
    rod: f64,
    /// How far from a ball's middle its rods begin: just inside its surface.
    gap: f64,
    slices: u32,
}

impl Lattice {
    fn new(size: u32, slices: u32) -> Self {
        let cell = 1.0 / f64::from(size);
        let (ball, rod) = (cell / 4.0, cell / 16.0);
        Lattice { size, cell, ball, rod, gap: 0.99 * ball * (1.0 - (rod / ball).sqrt()), slices }
    }

    /// Adds the ball of a point and the rods to its next neighbours.
    fn point(&self, mesh: &mut Mesh, index: [u32; 3]) {
        let center = DVec3::from(index.map(f64::from)) * self.cell;
        kit::sphere(mesh, center, self.ball, self.slices, 0);
        for (axis, material) in (0..3).zip(1..) {
            if index[axis] < self.size {
                let along = DVec3::AXES[axis];
                let (from, to) = (center + along * self.gap, center + along * (self.cell - self.gap));
                kit::cone(mesh, (from, self.rod), (to, self.rod), self.slices, material);
            }
        }
    }
}
