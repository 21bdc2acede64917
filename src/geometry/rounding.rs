//! How far a hit that A.3 computes in 32 bits can lie from the polygon and from the exact ray.
//!
//! Let u = 2^-24 be the unit of rounding, |O| the origin's largest coordinate and M that of the scene. When A.3 reports a
//! hit at t, with exact arithmetic on that t:
//!
//! - the point O + t D differs from the computed one by at most u (|O| + 3 M) in each coordinate;
//! - it lies off the polygon's plane by the rounding of N, d, N.O and N.D, at most about 12 u (|O| + M);
//! - in the plane of projection it lies outside the fan triangle by the rounding of the differences from S0, at most 2 u times
//!   the triangle's size and so 4 u M, and by that of α and β. The latter is worked out triangle by triangle
//!   ([`slivers`](super::slivers)); it is a few u times the triangle's size but for slivers.
//!
//! All but the last stay below u (13 |O| + 19 M), and [`reach_error`] takes 32 for both factors. So it covers what α and β are off
//! by up to [`COVERED`], 13 u M; what is more is a polygon's own *slack*, by which the filters take it to be larger.
//!
//! The slabs test allows each ray its own error. The grid is filled once for all rays: it allows the error of those that start
//! within the *reach*, which is taken from the rays of the run, but for outliers beyond [`FARTHEST`] times M. Such a ray, if
//! it comes near the volume at all, looks into every voxel.
//!
//! With closed edges ([`closed`](super::closed)) a corner seen along the ray is off by at most 6 u (|O| + M), and the hit is exactly that
//! of the corners as they are seen: it lies as near to the polygon as its corners span it, so that no polygon has slack.

/// u, half the distance from 1 to the next larger 32-bit number.
pub const UNIT: f64 = 1.0 / (1u64 << 24) as f64;

/// The least reach, in multiples of the scene's largest coordinate: rays start on the scene's own surfaces, too.
pub const NEAREST: f64 = 2.0;

/// The largest reach, in the same: one ray from far out must not make the grid coarse for all.
pub const FARTHEST: f64 = 4096.0;

/// What α and β may put a hit off by, in each coordinate and multiples of the scene's largest one, before a polygon has slack.
pub const COVERED: f64 = 13.0 * UNIT;

/// The largest distance, per coordinate, between a computed hit and both its ray and its polygon.
pub fn reach_error(origin: f64, scene: f64) -> f64 {
    32.0 * UNIT * (origin + scene)
}

/// The largest number not above a 64-bit one.
pub fn down(value: f64) -> f32 {
    let rounded = value as f32;
    if rounded as f64 > value { rounded.next_down() } else { rounded }
}

/// The smallest number not below a 64-bit one.
pub fn up(value: f64) -> f32 {
    -down(-value)
}
