//! Smooth surfaces: faces of one object that go over into each other without an edge.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::mesh::{Corner, Face, Mesh, NO_NORMAL, Object};

/// Directions whose cosine is nearer to 1 are the same.
const NEARLY_ONE: f64 = 1.0 - 1e-5;

/// Two corners' points, in one order whichever way they are walked.
type Edge = [[u32; 3]; 2];

/// A face at one of its edges: its object, and its normals at the edge's two points.
#[derive(Clone, Copy)]
struct Side {
    face: u32,
    object: Object,
    is_smooth: bool,
    normals: [DVec3; 2],
}

/// For each face the number of its surface, in the order in which they come first. Faces of one object are of the same surface if they
/// share an edge and have the same normals there; flat ones, if they lie in one plane.
pub fn surfaces(mesh: &Mesh) -> Vec<u32> {
    let mut joined: Vec<u32> = (0..mesh.faces().len() as u32).collect();
    let mut sides: HashMap<Edge, Vec<Side>> = HashMap::new();
    for (number, face) in mesh.faces().iter().enumerate() {
        for (edge, side) in sides_of(mesh, face, number as u32) {
            let others = sides.entry(edge).or_default();
            others
                .iter()
                .filter(|other| other.goes_over_into(&side))
                .for_each(|other| join(&mut joined, other.face, side.face));
            others.push(side);
        }
    }
    let mut numbers: HashMap<u32, u32> = HashMap::new();
    (0..joined.len() as u32)
        .map(|face| {
            let root = root(&mut joined, face);
            let next = numbers.len() as u32;
            *numbers.entry(root).or_insert(next)
        })
        .collect()
}

impl Side {
    fn goes_over_into(&self, other: &Side) -> bool {
        let same = |one: &DVec3, other: &DVec3| one.dot(*other) > NEARLY_ONE;
        let normals = || self.normals.iter().zip(&other.normals);
        self.object == other.object && self.is_smooth == other.is_smooth && normals().all(|(a, b)| same(a, b))
    }
}

fn sides_of(mesh: &Mesh, face: &Face, number: u32) -> impl Iterator<Item = (Edge, Side)> {
    let (corners, object) = (mesh.corners(face), mesh.object(face));
    let points: Vec<DVec3> = mesh.face_points(face).map(|point| point.as_dvec3()).collect();
    let cross = |pair: &[DVec3]| (pair[0] - points[0]).cross(pair[1] - points[0]);
    let flat = points.windows(2).map(cross).sum::<DVec3>().normalize_or_zero();
    let is_smooth = corners.iter().all(|corner| corner.normal != NO_NORMAL);
    let normal = move |corner: &Corner| match is_smooth {
        true => mesh.normals[corner.normal as usize].as_dvec3().normalize_or_zero(),
        false => flat,
    };
    // Zeros of either sign are one place.
    let place = |corner: &Corner| (mesh.points[corner.point as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    (0..corners.len()).map(move |at| {
        let (mut from, mut to) = (&corners[at], &corners[(at + 1) % corners.len()]);
        if place(to) < place(from) {
            (from, to) = (to, from);
        }
        let side = Side { face: number, object, is_smooth, normals: [normal(from), normal(to)] };
        ([place(from), place(to)], side)
    })
}

fn root(joined: &mut [u32], mut face: u32) -> u32 {
    while joined[face as usize] != face {
        let above = joined[joined[face as usize] as usize];
        joined[face as usize] = above;
        face = above;
    }
    face
}

/// Of two that are joined the first is the root.
fn join(joined: &mut [u32], one: u32, other: u32) {
    let (one, other) = (root(joined, one), root(joined, other));
    joined[one.max(other) as usize] = one.min(other);
}
