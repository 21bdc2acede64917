//! A tree.

use glam::{DAffine3, DMat3, DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Mesh, Scene};

/// As the Standard Procedural Databases define it, after Aono and Kunii (1984): every branch is a cone with a sphere at
/// its end, where two smaller branches begin, down to the size factor; below lies a green square. Seven lights.
pub const SCENE: Builtin = Builtin {
    name: "tree",
    about: "A bare tree of forking branches on a field, under seven lights.",
    default_size: 11,
    size_range: 1..=18,
    default_resolution: Some(6),
    count: |size| {
        let branches = (1u64 << (size + 1)) - 1;
        Primitives { polygons: 1, spheres: branches, cones: branches, ..Primitives::default() }
    },
    build,
};

/// What a branch's upper radius is to its lower one, and a child's lower radius to its parent's.
const TAPER: f64 = 0.67;

/// Lower radius of the trunk, whose length is 1.
const TRUNK_RADIUS: f64 = 0.15;

fn build(size: u32, slices: u32) -> Scene {
    let mut mesh = Mesh::default();
    kit::ground(&mut mesh, 50.0, 0.0, 0);
    let tree = Tree { forks: [fork(40.0, 90.0, 0.65), fork(25.0, 230.0, 0.70)], slices };
    tree.grow(&mut mesh, size, DAffine3::IDENTITY, TRUNK_RADIUS);
    let materials = vec![kit::matt(Vec3::new(0.2, 0.7, 0.2), 1.0), kit::matt(Vec3::new(0.55, 0.4, 0.2), 1.0)];
    let lights = kit::lights([
        dvec3(-5.0, 5.0, 50.0),
        dvec3(30.0, -30.0, 30.0),
        dvec3(-40.0, -30.0, 20.0),
        dvec3(10.0, 30.0, 40.0),
        dvec3(-30.0, 40.0, 10.0),
        dvec3(50.0, 25.0, 20.0),
        dvec3(-10.0, -60.0, 30.0),
    ]);
    let camera = kit::camera(dvec3(4.5, 0.4, 2.0), dvec3(0.0, 0.0, 1.5), DVec3::Z, 45.0);
    kit::scene("tree", mesh, materials, lights, camera, kit::SKY)
}

struct Tree {
    forks: [DAffine3; 2],
    slices: u32,
}

impl Tree {
    /// Adds the branch that `place` makes of the unit vector along z, and all that grow from it.
    fn grow(&self, mesh: &mut Mesh, depth: u32, place: DAffine3, radius: f64) {
        let apex = place.transform_point3(DVec3::Z);
        kit::cone(mesh, (place.translation, radius), (apex, radius * TAPER), self.slices, 1);
        kit::sphere(mesh, apex, radius * TAPER, self.slices, 1);
        if depth > 0 {
            for fork in self.forks {
                self.grow(mesh, depth - 1, place * fork, radius * TAPER);
            }
        }
    }
}

/// Where a child branch lies if its parent is the unit vector along z: tilted, turned around the parent, shortened, at
/// the parent's end. Angles in degrees.
fn fork(tilt: f64, turn: f64, length: f64) -> DAffine3 {
    let rotation = DMat3::from_rotation_z(turn.to_radians()) * DMat3::from_rotation_x(tilt.to_radians());
    DAffine3::from_mat3_translation(rotation * length, DVec3::Z)
}
