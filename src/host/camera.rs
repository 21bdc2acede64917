//! Primary rays.

use glam::DVec3;

use crate::geometry::Ray;
use crate::scene::Camera;

/// Size of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageSize {
    /// Pixels a line.
    pub width: u32,
    /// Lines.
    pub height: u32,
}

/// One ray through the middle of each pixel, line by line from the top left. Directions have unit length.
pub fn primary_rays(camera: &Camera, size: ImageSize) -> Vec<Ray> {
    let forward = (camera.at - camera.from).as_dvec3().normalize_or(DVec3::NEG_Z);
    let right = forward.cross(camera.up.as_dvec3()).try_normalize().unwrap_or(forward.any_orthonormal_vector());
    let up = right.cross(forward);
    let half_height = ((camera.angle as f64).to_radians() / 2.0).tan();
    let half_width = half_height * size.width as f64 / size.height as f64;
    let through = |x: u32, y: u32| {
        let across = (2.0 * (x as f64 + 0.5) / size.width as f64 - 1.0) * half_width;
        let above = (1.0 - 2.0 * (y as f64 + 0.5) / size.height as f64) * half_height;
        Ray::new(camera.from, (forward + right * across + up * above).normalize().as_vec3())
    };
    (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y))).map(|(x, y)| through(x, y)).collect()
}
