//! Axis-parallel boxes.

use glam::{DVec3, Vec3};

use super::ray::Ray;

/// An axis-parallel box, in double precision: volumes and their cuts are worked out by the host, before the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub low: DVec3,
    /// The corner with the largest.
    pub high: DVec3,
}

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Bounds = Bounds { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// The smallest box around some points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Bounds {
        points.into_iter().fold(Bounds::EMPTY, |bounds, p| Bounds { low: bounds.low.min(p), high: bounds.high.max(p) })
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        self.low.cmpgt(self.high).any()
    }

    /// The smallest box around both.
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// What both have in common.
    pub fn intersection(self, other: Bounds) -> Bounds {
        Bounds { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// The box with every face moved outward by `margin`.
    pub fn grown(self, margin: f64) -> Bounds {
        Bounds { low: self.low - margin, high: self.high + margin }
    }

    /// Lengths of the edges.
    pub fn extent(&self) -> DVec3 {
        self.high - self.low
    }

    /// The sum of its faces' areas.
    pub fn surface(&self) -> f64 {
        let [x, y, z] = self.extent().to_array();
        2.0 * (x * y + y * z + z * x)
    }

    /// Where on a ray it enters the box, or 0 if it starts inside; `None` if it misses it or ends before.
    pub fn entered_by(&self, ray: &Ray) -> Option<f64> {
        let (mut enters, mut leaves) = (0.0f64, ray.t_max as f64);
        for axis in 0..3 {
            let (origin, direction) = (ray.origin[axis] as f64, ray.direction[axis] as f64);
            let (low, high) = (self.low[axis] - origin, self.high[axis] - origin);
            if direction != 0.0 {
                let (a, b) = (low / direction, high / direction);
                (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
            } else if low > 0.0 || high < 0.0 {
                return None;
            }
        }
        (enters <= leaves).then_some(enters)
    }

    /// The two parts on either side of the plane `axis` = `at`.
    pub fn cut(self, axis: usize, at: f64) -> (Bounds, Bounds) {
        let (mut left, mut right) = (self, self);
        left.high[axis] = at;
        right.low[axis] = at;
        (left, right)
    }
}

/// The largest absolute value of the coordinates.
pub fn largest_coordinate(point: Vec3) -> f32 {
    point.abs().max_element()
}
