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

    /// The rectangle of a box: all of the plane if some of the box lies beside the eye or behind it, and nothing of an empty box.
    pub fn rectangle(&self, bounds: Bounds) -> ScreenRectangle {
        if bounds.is_empty() {
            return ScreenRectangle::NOTHING;
        }
        let ends = [bounds.low, bounds.high];
        let mut found = ScreenRectangle::NOTHING;
        for corner in 0..8 {
            let corner = DVec3::new(ends[corner & 1].x, ends[corner >> 1 & 1].y, ends[corner >> 2].z);
            let Some(place) = self.place(corner - self.at.as_dvec3()) else { return ScreenRectangle::ALL };
            found = ScreenRectangle { low: found.low.min(place), high: found.high.max(place) };
        }
        let off = ROUNDING * (1.0 + found.low.abs().max(found.high.abs()));
        ScreenRectangle { low: found.low - off, high: found.high + off }
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

impl ScreenRectangle {
    /// No point.
    pub const NOTHING: ScreenRectangle = ScreenRectangle { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };

    /// All of the plane.
    pub const ALL: ScreenRectangle = ScreenRectangle { low: DVec2::NEG_INFINITY, high: DVec2::INFINITY };

    /// Whether a point is in it.
    pub fn holds(&self, place: DVec2) -> bool {
        place.cmpge(self.low).all() && place.cmple(self.high).all()
    }
}
