//! Where in its pixels an image is sampled.

use std::ops::Range;

use super::camera::ImageSize;
use super::order::{Order, Sequence};
use crate::scene::Object;

/// How many rays the eye sends through a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// So many along each side of the pixel, in the middles of equal squares.
    pub side: u32,
    /// One in the middle first, and that many only where a neighbour (left, right, above, below) shows another object.
    pub adaptive: bool,
}

impl Default for Sampling {
    /// One in the middle.
    fn default() -> Self {
        Sampling { side: 1, adaptive: false }
    }
}

/// Samples to be taken one after the other: the same number in each of some pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pass {
    /// The pixels, in the order in which they are begun.
    pixels: Sequence,
    /// For each of them, how many samples of the first pass decide whether it is one of these; without any, none do.
    decided_by: Vec<usize>,
    side: u32,
    width: u32,
}

impl Pass {
    /// The first pass over an image, which looks into every pixel.
    pub fn first(size: ImageSize, sampling: Sampling, order: Order) -> Pass {
        let side = if sampling.adaptive { 1 } else { sampling.side };
        Pass { pixels: order.of_pixels(size), decided_by: Vec::new(), side, width: size.width }
    }

    /// The second pass of adaptive sampling: the pixels that have a neighbour with another object, in the order of the first
    /// pass. `objects` is what that saw in each pixel, `None` for the background.
    pub fn second(first: &Pass, sampling: Sampling, objects: &[Option<Object>]) -> Pass {
        let (width, count) = (first.width as usize, first.pixels.len());
        let differs = |pixel: usize| {
            let beside = pixel % width + 1 < width && objects[pixel + 1] != objects[pixel];
            let before = !pixel.is_multiple_of(width) && objects[pixel - 1] != objects[pixel];
            let below = pixel + width < count && objects[pixel + width] != objects[pixel];
            let above = pixel >= width && objects[pixel - width] != objects[pixel];
            beside || before || below || above
        };
        let places = first.pixels.by_number(&(0..count).collect::<Vec<usize>>());
        let decided_by = |pixel: usize| {
            let beside = (pixel % width + 1 < width).then(|| pixel + 1);
            let before = (!pixel.is_multiple_of(width)).then(|| pixel - 1);
            let above = pixel.checked_sub(width);
            // Nothing is below the last line; the image's last pixel stands for it.
            let below = (pixel + width).min(count - 1);
            let looked_at = [Some(pixel), beside, before, above, Some(below)];
            looked_at.into_iter().flatten().map(|pixel| places[pixel] + 1).max().unwrap_or(0)
        };
        let pixels: Vec<usize> = first.pixels.numbers().filter(|&pixel| differs(pixel)).collect();
        Pass {
            decided_by: pixels.iter().map(|&pixel| decided_by(pixel)).collect(),
            pixels: Sequence::of_numbers(pixels.into_iter().map(|pixel| pixel as u32).collect()),
            side: sampling.side,
            width: first.width,
        }
    }

    /// The same, of some of its pixels alone.
    pub fn within(self, pixels: Range<usize>) -> Pass {
        let places: Vec<usize> =
            (0..self.pixels.len()).filter(|&at| pixels.contains(&self.pixels.number(at))).collect();
        let numbers = places.iter().map(|&at| self.pixels.number(at) as u32).collect();
        Pass {
            pixels: Sequence::of_numbers(numbers),
            decided_by: places.iter().filter_map(|&at| self.decided_by.get(at).copied()).collect(),
            side: self.side,
            width: self.width,
        }
    }

    /// How many samples it takes.
    pub fn len(&self) -> usize {
        self.pixels.len() * self.per_pixel()
    }

    /// Whether it takes none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many samples of the first pass decide whether this one is taken: so many from its start on. Those of the first
    /// pass itself depend on none.
    pub fn decided_by(&self, sample: usize) -> usize {
        self.decided_by.get(sample / self.per_pixel()).copied().unwrap_or(0)
    }

    /// How many samples it takes in each of its pixels.
    pub fn per_pixel(&self) -> usize {
        (self.side * self.side) as usize
    }

    /// The pixel of a sample.
    pub fn pixel(&self, sample: usize) -> usize {
        self.pixels.number(sample / self.per_pixel())
    }

    /// Where a sample is, in pixels from the image's top left corner.
    pub fn position(&self, sample: usize) -> (f64, f64) {
        let (pixel, within) = (self.pixel(sample), sample % self.per_pixel());
        let (side, width) = (self.side as usize, self.width as usize);
        let middle = |square: usize| (square as f64 + 0.5) / side as f64;
        ((pixel % width) as f64 + middle(within % side), (pixel / width) as f64 + middle(within / side))
    }
}
