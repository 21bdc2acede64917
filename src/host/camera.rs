//! Primary rays.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::geometry::{Eye, Ray};
use crate::scene::Camera;

/// Size of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ImageSize {
    /// Pixels a line.
    pub width: u32,
    /// Lines.
    pub height: u32,
}

impl ImageSize {
    /// The pixels of each tile, tile by tile and line by line; those at the right and at the bottom may be smaller than `side` x `side`.
    pub fn tiles(self, side: u32) -> impl Iterator<Item = impl Iterator<Item = usize>> {
        let ImageSize { width, height } = self;
        let from = move |end: u32| (0..end).step_by(side as usize);
        let corners = from(height).flat_map(move |y| from(width).map(move |x| (x, y)));
        corners.map(move |(left, top)| {
            let (right, bottom) = (left.saturating_add(side).min(width), top.saturating_add(side).min(height));
            (top..bottom).flat_map(move |y| (left..right).map(move |x| (y * width + x) as usize))
        })
    }
}

/// The largest number of pixels: rays are numbered in 32 bits, and kept in memory.
const MOST_PIXELS: u64 = 1 << 26;

impl std::str::FromStr for ImageSize {
    type Err = String;

    /// `640x480`.
    fn from_str(text: &str) -> Result<ImageSize, String> {
        let (width, height) = text.split_once(['x', 'X']).ok_or("expected a width and a height, as in 640x480")?;
        let side = |side: &str| side.parse::<u32>().ok().filter(|&n| n > 0).ok_or("width and height must be 1 or more");
        let size = ImageSize { width: side(width)?, height: side(height)? };
        if size.width as u64 * size.height as u64 > MOST_PIXELS {
            return Err(format!("an image can have at most {MOST_PIXELS} pixels"));
        }
        Ok(size)
    }
}

impl TryFrom<String> for ImageSize {
    type Error = String;

    fn try_from(text: String) -> Result<ImageSize, String> {
        text.parse()
    }
}

impl From<ImageSize> for String {
    fn from(size: ImageSize) -> String {
        format!("{}x{}", size.width, size.height)
    }
}

impl ImageSize {
    /// How many pixels it has.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// A camera with an image before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    eye: Eye,
    /// From the image's middle to its right edge, and to its upper edge.
    right: DVec3,
    up: DVec3,
    size: ImageSize,
}

impl View {
    /// What a camera sees in an image of that size.
    pub fn new(camera: &Camera, size: ImageSize) -> View {
        let eye = Eye::of(camera);
        let half = half_extent(camera, size);
        View { eye, right: eye.right * half.x, up: eye.up * half.y, size }
    }

    /// The ray through a point of the image, in pixels from the top left corner. Its direction has unit length.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let across = 2.0 * x / self.size.width as f64 - 1.0;
        let above = 1.0 - 2.0 * y / self.size.height as f64;
        Ray::new(self.eye.at, (self.eye.forward + self.right * across + self.up * above).normalize().as_vec3())
    }
}

/// How far an image reaches to the right and upwards, in the plane at distance 1 before the eye.
pub(super) fn half_extent(camera: &Camera, size: ImageSize) -> DVec2 {
    let half_height = ((camera.angle as f64).to_radians() / 2.0).tan();
    DVec2::new(half_height * size.width as f64 / size.height as f64, half_height)
}

/// One ray through the middle of each pixel, line by line from the top left. Directions have unit length.
pub fn primary_rays(camera: &Camera, size: ImageSize) -> Vec<Ray> {
    let view = View::new(camera, size);
    let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
    pixels.map(|(x, y)| view.ray(x as f64 + 0.5, y as f64 + 0.5)).collect()
}
