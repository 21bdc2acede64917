//! Every polygon with A.3: what all modes must agree with.

use super::{Hit, Polygons, Ray};

/// The first hit of a ray, by testing all polygons.
pub fn brute_force(polygons: &Polygons, ray: &Ray) -> Hit {
    (0..polygons.len() as u32).fold(Hit::MISS, |nearest, polygon| polygons.nearer(ray, polygon, nearest))
}
