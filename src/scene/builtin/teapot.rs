//! The teapot.

use glam::{DAffine3, DMat4, DVec2, DVec3, DVec4, Vec3, dvec2, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Corner, Mesh, Scene};

/// As the Standard Procedural Databases define it: Newell's teapot of 1975 with Crow's bottom, 32 bicubic patches, each
/// cut into size times size quadrangles of two triangles, less those that vanish at the lid's and the bottom's poles;
/// it stands on a mirroring chequerboard of size times size squares. Two lights. The bottom is not flat.
pub const SCENE: Builtin = Builtin {
    name: "teapot",
    about: "Newell's teapot on a mirroring chequerboard.",
    default_size: 12,
    size_range: 2..=200,
    default_resolution: None,
    count: |size| Primitives { polygons: faces(size) + u64::from(size).pow(2), ..Primitives::default() },
    build: |size, _| build(size),
};

/// A row of control points around the axis: how far the points on the axes lie from it, how far beside them the points
/// between lie, and the height.
type Circle = [f64; 3];

/// A row of control points across the handle or the spout: x and z on the inner side, x and z on the outer side, and
/// half the width.
type Loop = [f64; 5];

const RIM: [Circle; 4] = [[1.4, 0.784, 2.4], [1.3375, 0.749, 2.53125], [1.4375, 0.805, 2.53125], [1.5, 0.84, 2.4]];
const UPPER_BODY: [Circle; 4] = [[1.5, 0.84, 2.4], [1.75, 0.98, 1.875], [2.0, 1.12, 1.35], [2.0, 1.12, 0.9]];
const LOWER_BODY: [Circle; 4] = [[2.0, 1.12, 0.9], [2.0, 1.12, 0.45], [1.5, 0.84, 0.225], [1.5, 0.84, 0.15]];
const KNOB: [Circle; 4] = [[0.0, 0.0, 3.15], [0.8, 0.45, 3.15], [0.0, 0.0, 2.85], [0.2, 0.112, 2.7]];
const LID: [Circle; 4] = [[0.2, 0.112, 2.7], [0.4, 0.224, 2.55], [1.3, 0.728, 2.55], [1.3, 0.728, 2.4]];
const BOTTOM: [Circle; 4] = [[0.0, 0.0, 0.0], [1.425, 0.798, 0.0], [1.5, 0.84, 0.075], [1.5, 0.84, 0.15]];

const UPPER_HANDLE: [Loop; 4] = [
    [-1.6, 2.025, -1.5, 2.25, 0.3],
    [-2.3, 2.025, -2.5, 2.25, 0.3],
    [-2.7, 2.025, -3.0, 2.25, 0.3],
    [-2.7, 1.8, -3.0, 1.8, 0.3],
];
const LOWER_HANDLE: [Loop; 4] = [
    [-2.7, 1.8, -3.0, 1.8, 0.3],
    [-2.7, 1.575, -3.0, 1.35, 0.3],
    [-2.5, 1.125, -2.65, 0.9375, 0.3],
    [-2.0, 0.9, -1.9, 0.6, 0.3],
];
const LOWER_SPOUT: [Loop; 4] = [
    [1.7, 1.425, 1.7, 0.6, 0.66],
    [2.6, 1.425, 3.1, 0.825, 0.66],
    [2.3, 2.1, 2.4, 2.025, 0.25],
    [2.7, 2.4, 3.3, 2.4, 0.25],
];
const UPPER_SPOUT: [Loop; 4] = [
    [2.7, 2.4, 3.3, 2.4, 0.25],
    [2.8, 2.475, 3.525, 2.49375, 0.25],
    [2.9, 2.475, 3.45, 2.5125, 0.15],
    [2.8, 2.4, 3.2, 2.4, 0.15],
];

/// How many triangles the pot has with `steps` quadrangles along each side of a patch.
pub fn faces(steps: u32) -> u64 {
    let steps = u64::from(steps);
    32 * 2 * steps * steps - 8 * steps
}

fn build(size: u32) -> Scene {
    let mut mesh = Mesh::default();
    board(&mut mesh, size);
    pot(&mut mesh, size, DAffine3::IDENTITY, 2);
    let materials = vec![
        kit::shiny(Vec3::ONE, 0.5, 0.5, 30.0),
        kit::shiny(Vec3::splat(0.5), 0.5, 0.5, 30.0),
        kit::shiny(Vec3::new(1.0, 0.5, 0.1), 0.75, 0.25, 37.0),
    ];
    let lights = kit::lights([dvec3(-3.1, 9.8, 12.1), dvec3(11.3, 5.1, 8.8)]);
    let camera = kit::camera(dvec3(4.86, 7.2, 5.4), DVec3::ZERO, DVec3::Z, 45.0);
    kit::scene("teapot", mesh, materials, lights, camera, kit::SKY)
}

/// Adds the white squares of the board, then the grey ones.
fn board(mesh: &mut Mesh, size: u32) {
    let place = |k: u32| 8.0 * f64::from(k) / f64::from(size) - 4.0;
    for (color, material) in [(1, 0), (0, 1)] {
        for (x, y) in (0..size).flat_map(|x| (0..size).map(move |y| (x, y))).filter(|(x, y)| (x + y) % 2 == color) {
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            kit::polygon(mesh, &corners.map(|(x, y)| dvec3(place(x), place(y), 0.0)), material);
        }
    }
}

/// Adds a teapot of [`faces`] triangles, moved to its place; `place` is to keep angles.
pub fn pot(mesh: &mut Mesh, steps: u32, place: DAffine3, material: u32) {
    mesh.begin_object();
    for patch in patches() {
        patch.add(mesh, steps, place, material);
    }
}

/// All 32 patches, in the databases' order.
fn patches() -> impl Iterator<Item = Patch> {
    let around = |circles, turn| (0..4).map(move |quarter| Patch::quarter(circles, quarter, turn));
    let across = |loops| [-1.0, 1.0].into_iter().map(move |side| Patch::half(loops, side));
    let body = [RIM, UPPER_BODY, LOWER_BODY].into_iter().flat_map(move |circles| around(circles, -1.0));
    let limbs = [UPPER_HANDLE, LOWER_HANDLE, LOWER_SPOUT, UPPER_SPOUT].into_iter().flat_map(across);
    let lid = [KNOB, LID].into_iter().flat_map(move |circles| around(circles, -1.0));
    body.chain(limbs).chain(lid).chain(around(BOTTOM, 1.0))
}

/// A bicubic Bezier patch: for each row of control points a matrix with the points as columns.
struct Patch {
    rows: [DMat4; 4],
}

impl Patch {
    fn new(rows: [[DVec3; 4]; 4]) -> Self {
        Patch { rows: rows.map(|row| DMat4::from_cols_array_2d(&row.map(|point| point.extend(0.0).to_array()))) }
    }

    /// A quarter of a solid of revolution; `turn` is 1 if the quarters follow each other counter-clockwise as seen from
    /// above, else -1.
    fn quarter(circles: [Circle; 4], quarter: usize, turn: f64) -> Self {
        let axes = [dvec2(1.0, 0.0), dvec2(0.0, turn), dvec2(-1.0, 0.0), dvec2(0.0, -turn)];
        let (from, to): (DVec2, DVec2) = (axes[quarter], axes[(quarter + 1) % 4]);
        Patch::new(circles.map(|[out, beside, z]| {
            [from * out, from * out + to * beside, from * beside + to * out, to * out].map(|point| point.extend(z))
        }))
    }

    /// One half of a piece of the handle or the spout, on the negative or the positive side of y.
    fn half(loops: [Loop; 4], side: f64) -> Self {
        Patch::new(loops.map(|[inner_x, inner_z, outer_x, outer_z, width]| {
            let (inner, outer) = (dvec3(inner_x, 0.0, inner_z), dvec3(outer_x, 0.0, outer_z));
            let out = DVec3::Y * (side * width);
            let (first, last) = if side < 0.0 { (inner, outer) } else { (outer, inner) };
            [first, first + out, last + out, last]
        }))
    }

    /// Adds the patch as triangles; those that vanish at a pole are left out.
    fn add(&self, mesh: &mut Mesh, steps: u32, place: DAffine3, material: u32) {
        let at = |k: u32| f64::from(k) / f64::from(steps);
        let side = steps as usize + 1;
        let mut corners = Vec::with_capacity(side * side);
        for s in 0..=steps {
            for t in 0..=steps {
                let (point, normal) = self.at(at(s), at(t));
                let point_index = mesh.add_point(place.transform_point3(point).as_vec3());
                let normal_index = mesh.add_normal(place.transform_vector3(normal).as_vec3());
                corners.push((Corner { point: point_index, normal: normal_index }, on_axis(point)));
            }
        }
        for cell in (0..side * (side - 1)).filter(|cell| cell % side != side - 1) {
            let around = [cell, cell + 1, cell + side + 1, cell + side].map(|i| corners[i]);
            for triangle in [[0, 1, 2], [2, 3, 0]].map(|triangle| triangle.map(|i: usize| around[i])) {
                if triangle.iter().filter(|(_, pole)| *pole).count() < 2 {
                    mesh.add_smooth_face(&triangle.map(|(corner, _)| corner), material);
                }
            }
        }
    }

    /// The point of the patch at a place, and the unit normal there, outward.
    fn at(&self, s: f64, t: f64) -> (DVec3, DVec3) {
        let blend = |s: DVec4, t: DVec4| {
            let row = |i: usize| (self.rows[i] * t).truncate() * s[i];
            row(0) + row(1) + row(2) + row(3)
        };
        let point = blend(bernstein(s), bernstein(t));
        let along_s = blend(bernstein_slope(s), bernstein(t));
        let along_t = blend(bernstein(s), bernstein_slope(t));
        // At a pole all of a row is one point, and one of the tangents is zero but for rounding.
        let normal = match on_axis(point) {
            true if point.z > 1.5 => DVec3::Z,
            true => DVec3::NEG_Z,
            false => along_t.cross(along_s).normalize(),
        };
        (point, normal)
    }
}

/// Whether a point of the pot is one of the poles: no other lies on its axis.
fn on_axis(point: DVec3) -> bool {
    point.truncate().length() < 1e-9
}

/// The weights of a cubic Bezier curve's control points.
fn bernstein(t: f64) -> DVec4 {
    let u = 1.0 - t;
    DVec4::new(u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t)
}

/// The weights' derivatives.
fn bernstein_slope(t: f64) -> DVec4 {
    let u = 1.0 - t;
    DVec4::new(-u * u, u * (u - 2.0 * t), t * (2.0 * u - t), t * t) * 3.0
}
