//! Hits as CSV.

use std::io::Write;

use crate::geometry::{Hit, Polygons};

/// Writes `ray,t,polygon,alpha,beta`, one line a ray in ray order. `polygon` is the number of the scene's face, from 0 in
/// file order; on a miss all but the ray are empty. Numbers have as many digits as give back the same 32 bits.
pub fn write(out: &mut impl Write, polygons: &Polygons, hits: &[Hit]) -> std::io::Result<()> {
    writeln!(out, "ray,t,polygon,alpha,beta")?;
    for (ray, hit) in hits.iter().enumerate() {
        if hit.is_hit() {
            writeln!(out, "{ray},{},{},{},{}", hit.t, polygons.face(hit.polygon), hit.alpha, hit.beta)?;
        } else {
            writeln!(out, "{ray},,,,")?;
        }
    }
    Ok(())
}
