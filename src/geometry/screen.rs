//! What an eye may see: boxes on the plane before it, as rectangles.
//!
//! A rectangle holds whatever a ray from the eye can hit in its box, however the ray's direction was rounded; so who looks
//! elsewhere hits nothing there.

use glam::{DVec2, DVec3, Vec3};

use super::bounds::Bounds;
use super::ray::Ray;
use super::rounding;
use crate::scene::Camera;

/// A camera's eye, with the plane at distance 1 before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Where it is.
    pub at: Vec3,
    /// Where it looks, of unit length.
    pub forward: DVec3,
    /// To the right in the plane, of unit length.
    pub right: DVec3,
    /// Upwards in the plane, of unit length.
    pub up: DVec3,
}

/// A rectangle in the plane before an eye: to the right and upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenRectangle {
    /// Its lower left corner.
    pub low: DVec2,
    /// Its upper right one.
    pub high: DVec2,
}

/// A corner must lie so far before the eye, as a share of its distance from it, for its place in the plane to be told.
const LEAST_DEPTH: f64 = 1e-6;

/// What double precision may put the place of such a corner off by, as a share of the place.
const ROUNDING: f64 = 1e-9;

impl Eye {
    /// The eye of a camera.
    pub fn of(camera: &Camera) -> Eye {
        let forward = (camera.at - camera.from).as_dvec3().normalize_or(DVec3::NEG_Z);
        let right = forward.cross(camera.up.as_dvec3()).try_normalize().unwrap_or(forward.any_orthonormal_vector());
        Eye { at: camera.from, forward, right, up: right.cross(forward) }
    }

    /// The rectangle of a box, or of the part of it that lies before the eye. Nothing of an empty box; all of the plane if a corner lies
    /// so near beside the eye that rounding could hide on which side.
    pub fn rectangle(&self, bounds: Bounds) -> ScreenRectangle {
        if bounds.is_empty() {
            return ScreenRectangle::NOTHING;
        }
        let ends = [bounds.low, bounds.high];
        // Corners from the eye: to the right, upwards, forward.
        let corners: [DVec3; 8] = std::array::from_fn(|corner| {
            let corner = DVec3::new(ends[corner & 1].x, ends[corner >> 1 & 1].y, ends[corner >> 2].z);
            let away = corner - self.at.as_dvec3();
            DVec3::new(away.dot(self.right), away.dot(self.up), away.dot(self.forward))
        });
        let size = corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
        if corners.iter().any(|corner| corner.z.abs() <= LEAST_DEPTH * size) {
            return ScreenRectangle::ALL;
        }
        let places = corners.iter().filter(|corner| corner.z > 0.0).map(|corner| corner.truncate() / corner.z);
        let found = places.fold(ScreenRectangle::NOTHING, |found, place| ScreenRectangle {
            low: found.low.min(place),
            high: found.high.max(place),
        });
        let off = ROUNDING * (1.0 + found.low.abs().max(found.high.abs()));
        let found = ScreenRectangle { low: found.low - off, high: found.high + off };
        edges(&corners).fold(found, |found, (one, other)| found.opened_towards(beside(one, other), ROUNDING * size))
    }

    /// Where a ray from the eye meets the plane; `None` if it starts elsewhere, or does not meet it.
    pub fn place_of(&self, ray: &Ray) -> Option<DVec2> {
        (ray.origin == self.at).then(|| self.place(ray.direction.as_dvec3())).flatten()
    }

    /// Where the plane is met that way.
    fn place(&self, way: DVec3) -> Option<DVec2> {
        let depth = way.dot(self.forward);
        let is_before = depth > LEAST_DEPTH * way.abs().max_element();
        is_before.then(|| DVec2::new(way.dot(self.right), way.dot(self.up)) / depth)
    }

    /// How far off in the plane, at `corner` or nearer to its middle, a ray may meet it whose direction was rounded to 32 bits.
    pub fn rounding_at(corner: DVec2) -> f64 {
        // A direction of unit length is off by u in each component; there the plane is so much farther, and met so much more slantingly.
        let away = (1.0 + corner.length_squared()).sqrt();
        4.0 * rounding::UNIT * away * (1.0 + away)
    }
}

/// The edges of a box that lead from before the eye to behind it.
fn edges(corners: &[DVec3; 8]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    let pairs = (0..8usize).flat_map(|corner| [1, 2, 4].map(|bit| (corner, corner | bit)));
    let pairs = pairs.filter(|(one, other)| one != other).map(|(one, other)| (corners[one], corners[other]));
    pairs.filter(|(one, other)| (one.z > 0.0) != (other.z > 0.0))
}

/// Where an edge passes beside the eye, to the right and upwards.
fn beside(one: DVec3, other: DVec3) -> DVec2 {
    let share = one.z / (one.z - other.z);
    (one + (other - one) * share).truncate()
}

impl ScreenRectangle {
    /// The same, as far as it goes on that way: a box that passes beside the eye on one side is seen out to there. On which side, it is
    /// not told to less than `off`.
    fn opened_towards(self, beside: DVec2, off: f64) -> ScreenRectangle {
        let mut opened = self;
        for axis in 0..2 {
            if beside[axis] >= -off {
                opened.high[axis] = f64::INFINITY;
            }
            if beside[axis] <= off {
                opened.low[axis] = f64::NEG_INFINITY;
            }
        }
        opened
    }

    /// No point.
    pub const NOTHING: ScreenRectangle = ScreenRectangle { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };

    /// All of the plane.
    pub const ALL: ScreenRectangle = ScreenRectangle { low: DVec2::NEG_INFINITY, high: DVec2::INFINITY };

    /// Whether a point is in it.
    pub fn holds(&self, place: DVec2) -> bool {
        place.cmpge(self.low).all() && place.cmple(self.high).all()
    }
}
