//! The most frequent colours (chapter 4, section 2: Heckbert's popularity algorithm).

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::{Chosen, Color, Counts, mean, square};

/// Colours are counted in cubes: those that have the five highest bits of each part in common.
const CUBE: u32 = 3 * 3;

/// The means of the `most` cubes with the most pixels, of equals those that come first in Peano's order. Every other cube gets the one
/// that is nearest to its own mean.
pub(super) fn choose(counts: &Counts, most: usize) -> Chosen {
    let mut cubes: BTreeMap<u32, Counts> = BTreeMap::new();
    for (&key, &count) in counts {
        cubes.entry(key >> CUBE).or_default().insert(key, count);
    }
    let mut frequent: Vec<(u64, u32)> = cubes.iter().map(|(&cube, colors)| (colors.values().sum(), cube)).collect();
    frequent.sort_by_key(|&(pixels, cube)| (Reverse(pixels), cube));
    frequent.truncate(most);
    let colors: Vec<Color> = frequent.iter().map(|(_, cube)| mean(cubes[cube].iter())).collect();
    let own: BTreeMap<u32, u16> = frequent.iter().zip(0..=u16::MAX).map(|(&(_, cube), place)| (cube, place)).collect();
    let nearest = |color: Color| {
        let places = colors.iter().zip(0..=u16::MAX);
        places.min_by_key(|(other, _)| square(**other, color)).map_or(0, |(_, place)| place)
    };
    let entry = |(cube, members): (&u32, &Counts)| {
        let place = own.get(cube).copied().unwrap_or_else(|| nearest(mean(members.iter())));
        members.keys().map(|&key| (key, place)).collect::<Vec<_>>()
    };
    let entries = cubes.iter().flat_map(entry).collect();
    (colors, entries)
}
