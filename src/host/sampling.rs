//! Where in its pixels an image is sampled.

use super::camera::ImageSize;
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
    pixels: Pixels,
    side: u32,
    width: u32,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Pixels {
    All(usize),
    /// Some of `count` pixels.
    These {
        pixels: Vec<u32>,
        count: usize,
    },
}

impl Pass {
    /// The first pass over an image, which looks into every pixel.
    pub fn first(size: ImageSize, sampling: Sampling) -> Pass {
        let side = if sampling.adaptive { 1 } else { sampling.side };
        Pass { pixels: Pixels::All(size.pixels()), side, width: size.width }
    }

    /// The second pass of adaptive sampling: the pixels that have a neighbour with another object. `objects` is what the
    /// first pass saw in each pixel, `None` for the background.
    pub fn second(size: ImageSize, sampling: Sampling, objects: &[Option<Object>]) -> Pass {
        let (width, count) = (size.width as usize, size.pixels());
        let differs = |pixel: usize| {
            let beside = pixel % width + 1 < width && objects[pixel + 1] != objects[pixel];
            let before = !pixel.is_multiple_of(width) && objects[pixel - 1] != objects[pixel];
            let below = pixel + width < count && objects[pixel + width] != objects[pixel];
            let above = pixel >= width && objects[pixel - width] != objects[pixel];
            beside || before || below || above
        };
        let pixels = (0..count).filter(|&pixel| differs(pixel)).map(|pixel| pixel as u32).collect();
        Pass { pixels: Pixels::These { pixels, count }, side: sampling.side, width: size.width }
    }

    /// How many samples it takes.
    pub fn len(&self) -> usize {
        let pixels = match &self.pixels {
            Pixels::All(count) => *count,
            Pixels::These { pixels, .. } => pixels.len(),
        };
        pixels * self.per_pixel()
    }

    /// Whether it takes none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many samples of the first pass decide whether this one is taken: so many from its start on. Those of the first
    /// pass itself depend on none.
    pub fn decided_by(&self, sample: usize) -> usize {
        match &self.pixels {
            Pixels::All(_) => 0,
            // The pixel below is the last of those that are looked at.
            Pixels::These { count, .. } => (self.pixel(sample) + self.width as usize + 1).min(*count),
        }
    }

    /// How many samples it takes in each of its pixels.
    pub fn per_pixel(&self) -> usize {
        (self.side * self.side) as usize
    }

    /// The pixel of a sample.
    pub fn pixel(&self, sample: usize) -> usize {
        let index = sample / self.per_pixel();
        match &self.pixels {
            Pixels::All(_) => index,
            Pixels::These { pixels, .. } => pixels[index] as usize,
        }
    }

    /// Where a sample is, in pixels from the image's top left corner.
    pub fn position(&self, sample: usize) -> (f64, f64) {
        let (pixel, within) = (self.pixel(sample), sample % self.per_pixel());
        let (side, width) = (self.side as usize, self.width as usize);
        let middle = |square: usize| (square as f64 + 0.5) / side as f64;
        ((pixel % width) as f64 + middle(within % side), (pixel / width) as f64 + middle(within / side))
    }
}
