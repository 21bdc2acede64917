//! Pictures of few colours: a table of them, and for each pixel an entry (Argence's thesis, chapter 4).

mod fixed;
mod gervautz;
mod median_cut;
mod peano;
mod popularity;

use std::collections::BTreeMap;
use std::str::FromStr;

pub use peano::key;

/// Red, green and blue, as a screen has them.
pub type Color = [u8; 3];

/// How the colours of a table are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Palette {
    /// By an octree of colours in Peano's order, as SKY did.
    #[default]
    Peano,
    /// By the same, with the brightest colour about a cube's middle in place of its mean: as SKY did for tables of thousands.
    PeanoLarge,
    /// The same colours for all pictures.
    Fixed,
    /// The most frequent ones.
    Popularity,
    /// By halving boxes of colours (Heckbert).
    MedianCut,
    /// By merging the deepest cubes of an octree (Gervautz and Purgathofer).
    Gervautz,
}

impl Palette {
    /// All of them.
    pub const ALL: [Palette; 6] = [
        Palette::Peano,
        Palette::PeanoLarge,
        Palette::Fixed,
        Palette::Popularity,
        Palette::MedianCut,
        Palette::Gervautz,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Palette::Peano => "peano",
            Palette::PeanoLarge => "peano-large",
            Palette::Fixed => "fixed",
            Palette::Popularity => "popularity",
            Palette::MedianCut => "median-cut",
            Palette::Gervautz => "gervautz",
        }
    }
}

impl FromStr for Palette {
    type Err = String;

    fn from_str(name: &str) -> Result<Palette, String> {
        let found = Palette::ALL.into_iter().find(|palette| palette.name() == name);
        found.ok_or_else(|| format!("expected one of {}", Palette::ALL.map(Palette::name).join(", ")))
    }
}

/// A picture of few colours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColorTable {
    /// The colours.
    pub colors: Vec<Color>,
    /// For each pixel, its colour's place in the table.
    pub pixels: Vec<u16>,
    /// The level of the octree whose cubes became colours, 0 for single colours; none for ways to choose without.
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

impl ColorError {
    /// How far a picture is from the true one.
    pub fn between(picture: impl IntoIterator<Item = Color>, truth: &[Color]) -> ColorError {
        let squares = truth.iter().zip(picture).map(|(color, other)| square(*color, other));
        let (sum, largest) = squares.fold((0, 0), |(sum, largest), square| (sum + square, largest.max(square)));
        ColorError { mean_square: sum as f64 / truth.len().max(1) as f64, largest: (largest as f64).sqrt() }
    }
}

/// A colour of the picture with its number of pixels, by Peano's key.
type Counts = BTreeMap<u32, u64>;

/// A table, and the entry for each colour of the picture, by its key.
type Chosen = (Vec<Color>, BTreeMap<u32, u16>);

impl ColorTable {
    /// The most colours of a table.
    pub const MOST: usize = 1 << 16;

    /// The most colours of a table that a PNG can have.
    pub const MOST_INDEXED: usize = 256;

    /// The picture in at most `most` colours, from 1 to [`ColorTable::MOST`]. A picture that has no more stays as it is; the order of its
    /// pixels does not matter.
    pub fn new(pixels: &[Color], most: usize, palette: Palette) -> ColorTable {
        let most = most.clamp(1, Self::MOST);
        let mut counts = Counts::new();
        pixels.iter().for_each(|&color| *counts.entry(key(color)).or_default() += 1);
        let ((colors, entries), level) = if counts.len() <= most {
            (single(&counts), Some(0).filter(|_| matches!(palette, Palette::Peano | Palette::PeanoLarge)))
        } else {
            match palette {
                Palette::Peano | Palette::PeanoLarge => {
                    let (level, chosen) = peano::choose(&counts, most, palette == Palette::Peano);
                    (chosen, Some(level))
                }
                Palette::Fixed => (fixed::choose(&counts, most), None),
                Palette::Popularity => (popularity::choose(&counts, most), None),
                Palette::MedianCut => (median_cut::choose(&counts, most), None),
                Palette::Gervautz => (gervautz::choose(&counts, most), None),
            }
        };
        let pixels = pixels.iter().map(|&color| entries.get(&key(color)).copied().unwrap_or_default()).collect();
        ColorTable { colors, pixels, level }
    }

    /// The picture's pixels in the colours of the table.
    pub fn picture(&self) -> impl Iterator<Item = Color> + '_ {
        self.pixels.iter().map(|&entry| self.colors[usize::from(entry)])
    }

    /// How far the table's picture is from the true one.
    pub fn error(&self, pixels: &[Color]) -> ColorError {
        ColorError::between(self.picture(), pixels)
    }

    /// The most that any colour can be off: the diagonal of a cube of the octree's next level.
    pub fn bound(&self) -> Option<f64> {
        self.level.map(|level| 3f64.sqrt() * f64::from(2u32 << level))
    }
}

/// Every colour as it is.
fn single(counts: &Counts) -> Chosen {
    let colors = counts.keys().map(|&key| peano::color(key)).collect();
    (colors, counts.keys().zip(0..=u16::MAX).map(|(&key, entry)| (key, entry)).collect())
}

/// A table of the means of sets of colours.
fn means<'a>(sets: impl Iterator<Item = &'a Counts> + Clone) -> Chosen {
    let colors = sets.clone().map(|colors| mean(colors.iter())).collect();
    (colors, entries(sets))
}

/// For each colour of some sets, the number of its set.
fn entries<'a>(sets: impl Iterator<Item = &'a Counts>) -> BTreeMap<u32, u16> {
    sets.zip(0..=u16::MAX).flat_map(|(colors, place)| colors.keys().map(move |&key| (key, place))).collect()
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
