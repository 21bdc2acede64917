//! Pictures of few colours: a table of them, and for each pixel an entry (Argence's thesis, chapter 4).

mod median_cut;
mod peano;

use std::collections::BTreeMap;

pub use peano::key;

/// Red, green and blue, as a screen has them.
pub type Color = [u8; 3];

/// How the colours of a table are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Palette {
    /// By an octree of colours in Peano's order, as SKY did it (chapter 4, section 3.1).
    #[default]
    Peano,
    /// By halving boxes of colours (Heckbert's median cut), which the thesis compares itself with.
    MedianCut,
}

impl Palette {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Palette::Peano => "peano",
            Palette::MedianCut => "median-cut",
        }
    }
}

/// A picture of at most 256 colours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColorTable {
    /// The colours.
    pub colors: Vec<Color>,
    /// For each pixel, its colour's place in the table.
    pub pixels: Vec<u8>,
    /// The level of the octree whose cubes became colours, 0 for single colours; none for other ways to choose.
    pub level: Option<u32>,
}

/// How far a picture's colours are off, in steps of 255.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorError {
    /// The mean of the squares of a pixel's distance from its colour.
    pub mean_square: f64,
    /// The largest distance.
    pub largest: f64,
}

/// A colour of the picture with its number of pixels, by Peano's key.
type Counts = BTreeMap<u32, u64>;

/// A table, and the entry for each colour of the picture, by its key.
type Chosen = (Vec<Color>, BTreeMap<u32, u8>);

impl ColorTable {
    /// The picture in at most `most` colours, from 1 to 256. A picture that has no more stays as it is; the order of its pixels does not
    /// matter.
    pub fn new(pixels: &[Color], most: usize, palette: Palette) -> ColorTable {
        let most = most.clamp(1, 256);
        let mut counts = Counts::new();
        pixels.iter().for_each(|&color| *counts.entry(key(color)).or_default() += 1);
        let ((colors, entries), level) = if counts.len() <= most {
            (single(&counts), Some(0).filter(|_| palette == Palette::Peano))
        } else {
            match palette {
                Palette::Peano => {
                    let (level, chosen) = peano::choose(&counts, most);
                    (chosen, Some(level))
                }
                Palette::MedianCut => (median_cut::choose(&counts, most), None),
            }
        };
        let pixels = pixels.iter().map(|&color| entries.get(&key(color)).copied().unwrap_or_default()).collect();
        ColorTable { colors, pixels, level }
    }

    /// How far the table's picture is from the true one.
    pub fn error(&self, pixels: &[Color]) -> ColorError {
        let squares =
            pixels.iter().zip(&self.pixels).map(|(color, &entry)| square(*color, self.colors[usize::from(entry)]));
        let (sum, largest) = squares.fold((0, 0), |(sum, largest), square| (sum + square, largest.max(square)));
        ColorError { mean_square: sum as f64 / pixels.len().max(1) as f64, largest: (largest as f64).sqrt() }
    }

    /// The most that any colour can be off: the diagonal of a cube of the octree's next level.
    pub fn bound(&self) -> Option<f64> {
        self.level.map(|level| 3f64.sqrt() * f64::from(2u32 << level))
    }
}

/// Every colour as it is.
fn single(counts: &Counts) -> Chosen {
    let colors = counts.keys().map(|&key| peano::color(key)).collect();
    (colors, counts.keys().zip(0..=255).map(|(&key, entry)| (key, entry)).collect())
}

fn square(one: Color, other: Color) -> u64 {
    one.iter().zip(other).map(|(&a, b)| u64::from(a.abs_diff(b)).pow(2)).sum()
}

/// The mean of colours with their numbers of pixels, rounded.
fn mean<'a>(colors: impl Iterator<Item = (&'a u32, &'a u64)>) -> Color {
    let (mut sums, mut pixels) = ([0; 3], 0);
    for (&key, &count) in colors {
        pixels += count;
        for (sum, part) in sums.iter_mut().zip(peano::color(key)) {
            *sum += count * u64::from(part);
        }
    }
    sums.map(|sum| ((2 * sum + pixels) / (2 * pixels).max(1)) as u8)
}
