//! Whether two solids have faces in one plane.

use glam::{DVec3, dvec3};

/// How far two planes' normals may be apart to be one direction.
const SAME_DIRECTION: f64 = 1e-9;

/// Weights that tell planes apart by one number: any that are no simple ratio of each other.
const WEIGHTS: DVec3 = dvec3(0.577_215_664, 0.915_965_594, 0.261_497_212);
const WEIGHT_OF_DISTANCE: f64 = 0.662_743_419;

/// The plane of a face, and where in it the face is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Planes that are one have keys that are nearly the same.
    key: f64,
    normal: DVec3,
    distance: f64,
    low: DVec3,
    high: DVec3,
}

/// The planes of all faces of a mesh in triangles, in the order of their keys. `size` is the largest coordinate of all.
pub(super) fn of(points: &[DVec3], triangles: &[([u32; 3], u32)], size: f64) -> Vec<Plane> {
    let mut sorted: Vec<&([u32; 3], u32)> = triangles.iter().collect();
    sorted.sort_by_key(|(_, face)| *face);
    let faces = sorted.chunk_by(|one, other| one.1 == other.1);
    let mut planes: Vec<Plane> = faces.filter_map(|face| plane(points, face, size)).collect();
    planes.sort_by(|one, other| one.key.total_cmp(&other.key));
    planes
}

/// The plane of a face: that of its largest triangle.
fn plane(points: &[DVec3], face: &[&([u32; 3], u32)], size: f64) -> Option<Plane> {
    let corners = face.iter().map(|(triangle, _)| triangle.map(|corner| points[corner as usize]));
    let (mut low, mut high, mut largest, mut from) = (DVec3::INFINITY, DVec3::NEG_INFINITY, DVec3::ZERO, DVec3::ZERO);
    for triangle in corners {
        let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
        if normal.length_squared() > largest.length_squared() {
            (largest, from) = (normal, triangle[0]);
        }
        (low, high) = triangle.iter().fold((low, high), |(low, high), &point| (low.min(point), high.max(point)));
    }
    let normal = largest.try_normalize()?;
    // A plane has two normals; of these, the one whose first part that counts is positive.
    let leading = normal.to_array().into_iter().find(|part| part.abs() > SAME_DIRECTION)?;
    let normal = normal * leading.signum();
    let distance = normal.dot(from) / size;
    Some(Plane { key: WEIGHTS.dot(normal) + WEIGHT_OF_DISTANCE * distance, normal, distance, low, high })
}

/// Both lists in one, in the order of their keys.
pub(super) fn merged(one: Vec<Plane>, other: Vec<Plane>) -> Vec<Plane> {
    let mut planes = [one, other].concat();
    planes.sort_by(|one, other| one.key.total_cmp(&other.key));
    planes
}

/// Whether a face of one list and a face of the other lie in one plane, and their boxes meet.
pub(super) fn coincide(one: &[Plane], other: &[Plane], size: f64) -> bool {
    let mut start = 0;
    one.iter().any(|plane| {
        // Differences of a key: three parts of a normal and a distance, each weighted with less than 1.
        let tolerance = 4.0 * SAME_DIRECTION;
        start += other[start..].iter().take_while(|candidate| candidate.key < plane.key - tolerance).count();
        let candidates = other[start..].iter().take_while(|candidate| candidate.key <= plane.key + tolerance);
        candidates.into_iter().any(|candidate| plane.touches(candidate, size))
    })
}

impl Plane {
    fn touches(&self, other: &Plane, size: f64) -> bool {
        let margin = DVec3::splat(SAME_DIRECTION * size);
        (self.normal - other.normal).abs().max_element() <= SAME_DIRECTION
            && (self.distance - other.distance).abs() <= SAME_DIRECTION
            && self.low.cmple(other.high + margin).all()
            && other.low.cmple(self.high + margin).all()
    }
}
