//! Work items: what the master hands out.

use serde::{Deserialize, Serialize};

use super::pixels::{Counts, PixelWork, Pixels};
use crate::error::InputError;
use crate::host::camera::ImageSize;
use crate::machine::Capitan;
use crate::quantities::Cycles;

/// What a work item is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum ItemKind {
    /// A run of pixels of a line that have the same part of the scene before them.
    #[default]
    Segments,
    /// A line of pixels.
    Lines,
    /// A pixel.
    Pixels,
    /// A square of pixels.
    Tiles,
}

impl ItemKind {
    /// What one is called.
    pub fn noun(self) -> &'static str {
        match self {
            ItemKind::Segments => "segment",
            ItemKind::Lines => "line",
            ItemKind::Pixels => "pixel",
            ItemKind::Tiles => "tile",
        }
    }
}

/// Work items in the order in which they are handed out, each with the times of its pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Items {
    /// What an item is called.
    pub noun: &'static str,
    /// The times of all pixels, item by item.
    times: Vec<Cycles>,
    /// What is counted on all pixels, item by item; nothing of a made-up scene.
    counts: Vec<Counts>,
    /// For each item, where it ends among them.
    ends: Vec<u32>,
}

impl Items {
    /// Items of so many pixels each, for the times that these take.
    pub fn new(noun: &'static str, items: &[Vec<Cycles>]) -> Items {
        let mut end = 0;
        let ends = items.iter().map(|item| {
            end += item.len() as u32;
            end
        });
        Items { noun, ends: ends.collect(), counts: Vec::new(), times: items.concat() }
    }

    /// An image cut up for a machine. `tile` is the side of a tile, in pixels, which the other kinds do not ask for.
    ///
    /// Fails if the whole would take longer than can be counted.
    pub fn cut(pixels: &Pixels, kind: ItemKind, tile: u32, machine: &Capitan) -> Result<Items, InputError> {
        let times = pixels.priced(machine)?;
        let (count, width) = (times.len() as u32, pixels.size.width);
        let until_next =
            |is_first: &dyn Fn(u32) -> bool| (1..=count).filter(|&at| at == count || is_first(at)).collect();
        let counts = match &pixels.work {
            PixelWork::Weights(_) => Vec::new(),
            PixelWork::Counts(counts) => counts.clone(),
        };
        let items = |ends| Items { noun: kind.noun(), ends, times, counts };
        Ok(match kind {
            ItemKind::Segments => items(until_next(&|at| pixels.starts[at as usize])),
            ItemKind::Lines => items(until_next(&|at| at.is_multiple_of(width))),
            ItemKind::Pixels => items((1..=count).collect()),
            ItemKind::Tiles => items(Vec::new()).in_tiles(pixels.size, tile.max(1)),
        })
    }

    /// The pixels of a whole image, line by line, as tiles.
    fn in_tiles(self, size: ImageSize, side: u32) -> Items {
        let mut order = Vec::with_capacity(self.times.len());
        let ends = size.tiles(side).map(|tile| {
            order.extend(tile);
            order.len() as u32
        });
        let ends = ends.collect();
        let counted = |pixel: &usize| self.counts.get(*pixel).copied();
        Items {
            noun: self.noun,
            ends,
            times: order.iter().map(|&pixel| self.times[pixel]).collect(),
            counts: order.iter().filter_map(counted).collect(),
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The times of all pixels, item by item.
    pub fn pixels(&self) -> &[Cycles] {
        &self.times
    }

    /// What is counted on all pixels, item by item; nothing of a made-up scene.
    pub fn counts(&self) -> &[Counts] {
        &self.counts
    }

    /// Where an item's pixels are among all.
    pub fn range(&self, item: usize) -> std::ops::Range<usize> {
        let start = item.checked_sub(1).map_or(0, |before| self.ends[before] as usize);
        start..self.ends[item] as usize
    }

    /// What an item's pixels take together.
    pub fn time(&self, item: usize) -> Cycles {
        self.times[self.range(item)].iter().copied().sum()
    }
}
