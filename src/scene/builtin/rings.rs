//! A pyramid of objects made of rings.

use std::f64::consts::{FRAC_PI_3, FRAC_PI_8, PI, TAU};

use glam::{DMat3, DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Material, Mesh, Scene};

/// As the Standard Procedural Databases define it: an object of six pentagonal rings, which join the middles of the
/// edges of a dodecahedron, each ring of five cylinders and five spheres; a pyramid of such objects, seen from its
/// tip, each layer a square; behind it a wall that just fills the view. Three lights.
pub const SCENE: Builtin = Builtin {
    name: "rings",
    about: "A pyramid of objects of six interlocked rings, seen from its tip, before a wall.",
    default_size: 7,
    size_range: 1..=30,
    default_resolution: Some(8),
    count: |size| {
        let n = u64::from(size);
        let each = 5 * n * (n + 1) * (2 * n + 1);
        Primitives { polygons: 1, spheres: each, cones: each, ..Primitives::default() }
    },
    build,
};

/// Radius of cylinders and spheres.
const RADIUS: f64 = 0.07412;

fn build(size: u32, slices: u32) -> Scene {
    let mut mesh = Mesh::default();
    let layer = 1.0 / FRAC_PI_8.sin();
    let eye = dvec3(-1.0, -layer, 0.5);
    wall(&mut mesh, eye, layer * f64::from(size + 1));
    let joints = joints();
    for depth in 0..size {
        for z in 0..=depth {
            for x in 0..=depth {
                let across = |k: u32| 2.0 * f64::from(k) - f64::from(depth);
                let offset = dvec3(across(x), layer * f64::from(depth + 1), across(z));
                object(&mut mesh, &joints, offset, slices);
            }
        }
    }
    let lights = kit::lights([dvec3(3.0, -layer, 3.0), dvec3(-4.0, -layer, 1.0), dvec3(2.0, -layer, -4.0)]);
    let camera = kit::camera(eye, eye + DVec3::Y, DVec3::Z, 45.0);
    kit::scene("rings", mesh, materials(), lights, camera, kit::SKY)
}

/// White for the wall, then one colour for each ring of an object.
fn materials() -> Vec<Material> {
    let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
    let rings = colors.map(|color| kit::shiny(Vec3::from(color), 0.5, 0.2, 37.0));
    [kit::matt(Vec3::ONE, 1.0)].into_iter().chain(rings).collect()
}

/// Adds a wall at `y` that fills the view of 45 degrees and a hundredth more.
fn wall(mesh: &mut Mesh, eye: DVec3, y: f64) {
    let half = 1.01 * (y - eye.y) * FRAC_PI_8.tan();
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    kit::polygon(mesh, &corners.map(|[x, z]| dvec3(x * half + eye.x, y, z * half + eye.z)), 0);
}

fn object(mesh: &mut Mesh, joints: &[[DVec3; 5]; 6], offset: DVec3, slices: u32) {
    for (material, ring) in (1..).zip(joints) {
        for (i, &joint) in ring.iter().enumerate() {
            let base = joint + offset;
            let apex = ring[(i + 4) % 5] + offset;
            kit::cone(mesh, (base, RADIUS), (apex, RADIUS), slices, material);
            kit::sphere(mesh, base, RADIUS, slices, material);
        }
    }
}

/// The corners of the six pentagons; the object with its thick lines fits into a sphere of radius 1.
fn joints() -> [[DVec3; 5]; 6] {
    let scale = 1.0 / (1.0 + RADIUS);
    let flat: [DVec3; 5] =
        std::array::from_fn(|i| dvec3((i as f64 * TAU / 5.0).cos(), (i as f64 * TAU / 5.0).sin(), 0.0) * scale);
    // The angle between two neighbouring sides of a dodecahedron.
    let dihedral = 2.0 * (FRAC_PI_3.cos() / (PI / 5.0).sin()).acos();
    std::array::from_fn(|pentagon| match pentagon {
        0 => flat,
        n => {
            let around = DMat3::from_rotation_z(PI * (2 * n - 1) as f64 / 5.0);
            flat.map(|corner| around * DMat3::from_rotation_x(dihedral) * corner)
        }
    })
}
