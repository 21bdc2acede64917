//! Where in its pixels an image is sampled.

use std::ops::Range;

use bitvec::vec::BitVec;
use serde::{Deserialize, Serialize};

use super::camera::ImageSize;
use super::color_table::Color;
use super::order::{Order, Sequence};

/// How many rays the eye sends through a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// So many along each side of the pixel, in the middles of equal squares.
    pub side: u32,
    /// One in the middle first, and that many only where this says so.
    pub adaptive: Option<Criterion>,
}

impl Default for Sampling {
    /// One in the middle.
    fn default() -> Self {
        Sampling { side: 1, adaptive: None }
    }
}

/// What must differ for a pixel to get more samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// The object that a neighbour (left, right, above, below) shows.
    Object,
    /// The smooth surface that a neighbour shows.
    Surface,
    /// Among it and its eight neighbours the surface, the lights that reach it, or the same of what is seen in mirrors and through
    /// glass; or some of the nine has an object before it that is smaller than a pixel. (LAO, Argence's thesis, chapter 3.)
    Lao,
    /// A component of the colour, by more than so many steps of 255, among the samples at the corners of a square: four pixels' middles,
    /// its own among them (Whitted).
    Whitted {
        /// The most that it may differ by.
        threshold: u8,
    },
}

/// A criterion, by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum AdaptiveBy {
    /// A neighbour shows another object.
    #[default]
    Object,
    /// A neighbour shows another smooth surface.
    Surface,
    /// One of eight neighbours shows another surface, light or mirror image, or something is smaller than a pixel.
    Lao,
    /// Colours differ by more than the threshold.
    Whitted,
}

impl Criterion {
    /// Whitted's threshold of the thesis's table, in steps of 255.
    pub const THRESHOLD: u8 = 16;

    /// Whether a pixel gets more samples.
    fn asks(self, pixel: usize, plane: Plane, shown: &Shown) -> bool {
        let keys = &shown.keys;
        let differs = |all| plane.neighbours(pixel, all).any(|other| keys[other] != keys[pixel]);
        match self {
            Criterion::Object | Criterion::Surface => differs(false),
            Criterion::Lao => {
                differs(true) || plane.neighbours(pixel, true).chain([pixel]).any(|at| shown.is_small(at))
            }
            Criterion::Whitted { threshold } => plane.squares(pixel).any(|square| {
                let colors = square.iter().flatten().map(|&at| color_of(keys[at]));
                let (low, high) = colors.fold(([u8::MAX; 3], [0; 3]), |(low, high): (Color, Color), color| {
                    ([0, 1, 2].map(|k| low[k].min(color[k])), [0, 1, 2].map(|k| high[k].max(color[k])))
                });
                (0..3).any(|k| high[k] - low[k] > threshold)
            }),
        }
    }

    /// Whether it looks at all eight neighbours.
    fn looks_around(self) -> bool {
        matches!(self, Criterion::Lao | Criterion::Whitted { .. })
    }
}

/// What the first pass has seen in each pixel, as far as a criterion looks at it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// Of each pixel a number: the same where the same is seen; for Whitted's criterion the colour's ([`key_of`]).
    pub keys: Vec<u64>,
    /// The pixels that have an object before them which is smaller than a pixel, if that matters.
    pub small: Option<BitVec>,
}

impl Shown {
    fn is_small(&self, pixel: usize) -> bool {
        self.small.as_ref().is_some_and(|small| small[pixel])
    }
}

/// A colour as a number.
pub fn key_of([r, g, b]: Color) -> u64 {
    u64::from(r) << 16 | u64::from(g) << 8 | u64::from(b)
}

fn color_of(key: u64) -> Color {
    [(key >> 16) as u8, (key >> 8) as u8, key as u8]
}

/// The pixels of an image as a plane.
#[derive(Clone, Copy)]
struct Plane {
    width: usize,
    count: usize,
}

impl Plane {
    /// The pixel so many columns and lines off, if there is one.
    fn at(self, pixel: usize, (columns, lines): (isize, isize)) -> Option<usize> {
        let column = (pixel % self.width).checked_add_signed(columns).filter(|&column| column < self.width)?;
        let line = (pixel / self.width).checked_add_signed(lines).filter(|&line| line < self.count / self.width)?;
        Some(line * self.width + column)
    }

    /// The pixels beside one: four, or with those across the corners eight.
    fn neighbours(self, pixel: usize, all: bool) -> impl Iterator<Item = usize> {
        let ways = (-1..=1).flat_map(|lines| (-1..=1).map(move |columns| (columns, lines)));
        let ways = ways.filter(move |&(columns, lines): &(isize, isize)| match all {
            true => (columns, lines) != (0, 0),
            false => columns.abs() + lines.abs() == 1,
        });
        ways.filter_map(move |way| self.at(pixel, way))
    }

    /// The four squares of pixels that one is in, as far as there are pixels.
    fn squares(self, pixel: usize) -> impl Iterator<Item = [Option<usize>; 4]> {
        [(-1, -1), (1, -1), (-1, 1), (1, 1)].into_iter().map(move |(columns, lines)| {
            [(0, 0), (columns, 0), (0, lines), (columns, lines)].map(|way| self.at(pixel, way))
        })
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
        let side = if sampling.adaptive.is_some() { 1 } else { sampling.side };
        Pass { pixels: order.of_pixels(size), decided_by: Vec::new(), side, width: size.width }
    }

    /// The second pass of adaptive sampling, with `side` samples along each side of a pixel: the pixels that a criterion asks for, in the
    /// order of the first pass. `shown` is what that saw.
    pub fn second(first: &Pass, (criterion, side): (Criterion, u32), shown: &Shown) -> Pass {
        let plane = Plane { width: first.width as usize, count: first.pixels.len() };
        let places = first.pixels.by_number(&(0..plane.count).collect::<Vec<usize>>());
        let decided_by = |pixel: usize| {
            // Nothing is below the last line; the image's last pixel stands for it.
            let below = (pixel + plane.width).min(plane.count - 1);
            let looked_at = plane.neighbours(pixel, criterion.looks_around()).chain([pixel, below]);
            looked_at.map(|pixel| places[pixel] + 1).max().unwrap_or(0)
        };
        let pixels: Vec<usize> = first.pixels.numbers().filter(|&pixel| criterion.asks(pixel, plane, shown)).collect();
        Pass {
            decided_by: pixels.iter().map(|&pixel| decided_by(pixel)).collect(),
            pixels: Sequence::of_numbers(pixels.into_iter().map(|pixel| pixel as u32).collect()),
            side,
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

    /// The pixels that it looks into, by their numbers, line by line.
    pub fn pixel_numbers(&self) -> Vec<u32> {
        let mut numbers: Vec<u32> = self.pixels.numbers().map(|pixel| pixel as u32).collect();
        numbers.sort_unstable();
        numbers
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
