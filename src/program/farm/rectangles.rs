//! A made-up scene: rectangles on the screen, as the primitives of the thesis's scene would cover it.

use super::pixels::{PixelWork, Pixels};
use crate::host::camera::ImageSize;
use crate::scene::builtin::noise;

/// Rectangles on the screen, which depend on their number and a seed alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rectangles {
    /// How many.
    pub count: u32,
    /// What they depend on.
    pub seed: u64,
}

/// Bytes of a rectangle: four integers of 32 bits.
const BYTES: u64 = 16;

/// A stretch of a line, or of lines: from the first to before the last.
type Span = (u32, u32);

impl Default for Rectangles {
    /// As many as the thesis's scene has primitives. Of the seeds, the one whose image of 100 x 100 pixels has about as many
    /// segments (936) as the scene to which the costs of capitan.ron were fitted (933).
    fn default() -> Rectangles {
        Rectangles { count: 16, seed: 57 }
    }
}

impl Rectangles {
    /// The most that are made.
    pub const MOST: u32 = 10_000;

    /// What a processor holds of them, in bytes.
    pub fn bytes(&self) -> u64 {
        BYTES * u64::from(self.count)
    }

    /// An image of them. A pixel weighs 1 and 1 for each rectangle there; a segment ends where the rectangles change.
    pub fn pixels(&self, size: ImageSize) -> Pixels {
        let all: Vec<(Span, Span)> = (0..self.count as i32).map(|number| self.rectangle(number, size)).collect();
        let mut weights = Vec::with_capacity(size.pixels());
        let mut starts = Vec::with_capacity(size.pixels());
        let width = size.width as usize;
        // In a line, by how much more rectangles there are from each pixel on, and whether any begins or ends there.
        let (mut more, mut is_edge) = (vec![0i64; width + 1], vec![false; width + 1]);
        for y in 0..size.height {
            more.fill(0);
            is_edge.fill(false);
            is_edge[0] = true;
            for (across, _) in all.iter().filter(|(_, down)| (down.0..down.1).contains(&y)) {
                let (from, until) = (across.0 as usize, across.1 as usize);
                more[from] += 1;
                more[until] -= 1;
                is_edge[from] = true;
                is_edge[until] = true;
            }
            let mut depth = 0;
            for x in 0..width {
                depth += more[x];
                weights.push(1 + depth as u32);
                starts.push(is_edge[x]);
            }
        }
        Pixels { size, work: PixelWork::Weights(weights), starts }
    }

    /// Columns and lines of one.
    fn rectangle(&self, number: i32, size: ImageSize) -> (Span, Span) {
        let random = |place: i32| noise::unit(self.seed, [number, place]);
        let (width, height) = (0.1 + 0.35 * random(0), 0.1 + 0.35 * random(1));
        let (left, top) = ((1.0 - width) * random(2), (1.0 - height) * random(3));
        let column = |at: f64| (at * f64::from(size.width)).round() as u32;
        // The lines whose middles it covers.
        let line = |at: f64| (at * f64::from(size.height) - 0.5).ceil().max(0.0) as u32;
        ((column(left), column(left + width)), (line(top), line(top + height)))
    }
}
