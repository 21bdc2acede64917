//! What a ray hits first.

/// The nearest hit so far: the words of a HIT message but for the ray's number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Where on the ray; infinite on a miss.
    pub t: f32,
    /// The polygon's index, or [`Hit::NO_POLYGON`].
    pub polygon: u32,
    /// α of the polygon's fan triangle that holds the point (equation 10); 0 on a miss.
    pub alpha: f32,
    /// β likewise.
    pub beta: f32,
}

impl Hit {
    /// The polygon index that says that nothing was hit.
    pub const NO_POLYGON: u32 = u32::MAX;

    /// Nothing.
    pub const MISS: Hit = Hit { t: f32::INFINITY, polygon: Hit::NO_POLYGON, alpha: 0.0, beta: 0.0 };

    /// Whether a polygon was hit.
    #[inline]
    pub fn is_hit(&self) -> bool {
        self.polygon != Hit::NO_POLYGON
    }

    /// The nearer of two; of two at the same t, the one on the lower polygon index.
    #[inline]
    pub fn nearer(self, other: Hit) -> Hit {
        let first = self.t < other.t || (self.t == other.t && self.polygon <= other.polygon);
        if first { self } else { other }
    }
}

/// A hit on one polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolygonHit {
    /// Where on the ray.
    pub t: f32,
    /// α in the fan triangle.
    pub alpha: f32,
    /// β in the fan triangle.
    pub beta: f32,
    /// Which triangle of the fan: k is (S0, Sk+1, Sk+2).
    pub triangle: u32,
}
