//! A scene from its sides: small pictures, along each axis.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DVec3, Vec3};
use serde::Serialize;

use crate::geometry::{Bounds, Hit, Ray};
use crate::program::Workload;

/// Pixels of the longer edge.
const LONGEST: f64 = 128.0;

/// A scene along an axis.
#[derive(Serialize)]
pub struct Side {
    /// The axes to the right and up.
    axes: [usize; 2],
    /// What the picture shows: the least and the largest coordinate along each of these.
    low: [f64; 2],
    high: [f64; 2],
    /// PNG in base 64: grey, and nothing where there is nothing.
    png: String,
}

/// The scene along x, y and z. Of the two other axes the one with the higher name goes up.
pub fn sides(workload: &Workload) -> [Side; 3] {
    let bounds = workload.grids().fold(Bounds::EMPTY, |bounds, grid| bounds.union(grid.volume()));
    let bounds = if bounds.is_empty() { Bounds { low: DVec3::ZERO, high: DVec3::ZERO } } else { bounds };
    [[1, 2], [0, 2], [0, 1]].map(|axes| Side::new(workload, bounds, axes))
}

impl Side {
    fn new(workload: &Workload, bounds: Bounds, axes: [usize; 2]) -> Side {
        let [right, up] = axes;
        let along = 3 - right - up;
        let extent = bounds.extent();
        let pixel = (extent[right].max(extent[up]) / LONGEST).max(f64::MIN_POSITIVE);
        let count = |axis: usize| ((extent[axis] / pixel).ceil() as usize).clamp(1, LONGEST as usize);
        let (width, height) = (count(right), count(up));
        let ray = |place: usize| {
            let mut origin = bounds.low;
            // From just inside, so that the wall of a room is not all that is seen.
            origin[along] = bounds.high[along] - 0.02 * extent[along];
            origin[right] += ((place % width) as f64 + 0.5) / width as f64 * extent[right];
            origin[up] += ((height - 1 - place / width) as f64 + 0.5) / height as f64 * extent[up];
            let mut direction = Vec3::ZERO;
            direction[along] = -1.0;
            Ray::new(origin.as_vec3(), direction)
        };
        let rays: Vec<Ray> = (0..width * height).map(ray).collect();
        // The lighter, the more it faces the viewer, and the nearer it is.
        let shade = |hit: &Hit| {
            let facing = workload.polygons().normal(hit.polygon).normalize_or_zero()[along].abs();
            let depth = f64::from(hit.t) / extent[along].max(f64::MIN_POSITIVE);
            (255.0 * (0.25 + 0.65 * f64::from(facing)) * (1.0 - 0.6 * depth.clamp(0.0, 1.0))) as u8
        };
        let pixels = workload.look(&rays).into_iter();
        let pixels = pixels.flat_map(|hit| if hit.is_hit() { [shade(&hit), 255] } else { [0, 0] });
        Side {
            axes,
            low: axes.map(|axis| bounds.low[axis]),
            high: axes.map(|axis| bounds.high[axis]),
            png: STANDARD.encode(png(width, height, &pixels.collect::<Vec<u8>>())),
        }
    }
}

/// Pixels of grey and opacity as PNG. What is written to memory is always written.
fn png(width: usize, height: usize, pixels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(png::ColorType::GrayscaleAlpha);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels));
    if written.is_ok() { file } else { Vec::new() }
}
