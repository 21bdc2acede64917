//! A pyramid of tetrahedra.

use glam::{DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Mesh, Scene};

/// As the Standard Procedural Databases define it: a tetrahedron in a cube of half side 1, of which only the
/// half-sized tetrahedra in its corners are kept, and so on, 4 to the power of the size factor triangles in all. The
/// scene goes back to Glassner's of 1984 and Kay and Kajiya's of 1986, whose view and light it keeps.
pub const SCENE: Builtin = Builtin {
    name: "tetra",
    about: "Sierpinski's tetrahedron: a pyramid of red tetrahedra, mostly empty space.",
    default_size: 6,
    size_range: 1..=11,
    default_resolution: None,
    count: |size| Primitives { polygons: 4u64.pow(size), ..Primitives::default() },
    build: |size, _| build(size),
};

/// The corners of a cube that make a tetrahedron, in the databases' order.
const CORNERS: [DVec3; 4] =
    [dvec3(-1.0, -1.0, 1.0), dvec3(-1.0, 1.0, -1.0), dvec3(1.0, -1.0, -1.0), dvec3(1.0, 1.0, 1.0)];

/// Its sides, seen from outside.
const SIDES: [[usize; 3]; 4] = [[0, 1, 2], [3, 2, 1], [2, 3, 0], [1, 0, 3]];

fn build(size: u32) -> Scene {
    let mut mesh = Mesh::default();
    pyramid(&mut mesh, size, DVec3::ZERO, 1.0);
    let camera = kit::camera(
        dvec3(1.022846, -3.177154, -2.174512),
        dvec3(-0.004103, -0.004103, 0.216539),
        dvec3(-0.816497, -0.816497, 0.816497),
        45.0,
    );
    let materials = vec![kit::matt(Vec3::new(1.0, 0.2, 0.2), 1.0)];
    kit::scene("tetra", mesh, materials, kit::lights([dvec3(2.0, -18.0, -5.0)]), camera, kit::SKY)
}

fn pyramid(mesh: &mut Mesh, depth: u32, center: DVec3, half: f64) {
    if depth > 1 {
        for corner in CORNERS {
            pyramid(mesh, depth - 1, center + corner * half / 2.0, half / 2.0);
        }
        return;
    }
    mesh.begin_object();
    let points = CORNERS.map(|corner| mesh.add_point((center + corner * half).as_vec3()));
    for side in SIDES {
        mesh.add_face(&side.map(|corner| points[corner]), 0);
    }
}
