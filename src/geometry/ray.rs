//! Rays (equation 2: R(t) = O + D t).

use glam::Vec3;

/// A ray. Its direction need not have unit length: t counts in units of the direction as given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// O, where it starts.
    pub origin: Vec3,
    /// D, where it goes.
    pub direction: Vec3,
    /// Hits beyond this t do not count.
    pub t_max: f32,
}

impl Ray {
    /// A ray without end.
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin, direction, t_max: f32::INFINITY }
    }

    /// The same ray, whose hits beyond `t` do not count either.
    pub fn until(self, t: f32) -> Ray {
        Ray { t_max: self.t_max.min(t), ..self }
    }

    /// The point at parameter t.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// The scalar product, added up from x to z: the order is part of the result's bits.
#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}
