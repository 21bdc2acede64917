//! The fixed table: the same colours for all pictures (chapter 4, section 1).

use std::collections::BTreeMap;

use super::{Chosen, Color, Counts, peano};

/// The colours of a table of `most` whose entries are the highest bits of red, green and blue side by side, as many of each as can be, and
/// of red and green one more where it goes no other way. What follows those bits is 0. Colours that the picture does not need are left out.
pub(super) fn choose(counts: &Counts, most: usize) -> Chosen {
    let bits = most.ilog2();
    let of_part = [bits.div_ceil(3), (bits + 1) / 3, bits / 3];
    let shown = |key: u32| -> Color {
        let color = peano::color(key);
        // Of no bits nothing is left.
        [0, 1, 2].map(|part| (u32::from(color[part]) & !(0xff >> of_part[part].min(8))) as u8)
    };
    let mut places: BTreeMap<u32, u16> = counts.keys().map(|&key| (peano::key(shown(key)), 0)).collect();
    places.values_mut().zip(0..=u16::MAX).for_each(|(place, number)| *place = number);
    let colors = places.keys().map(|&key| peano::color(key)).collect();
    (colors, counts.keys().map(|&key| (key, places[&peano::key(shown(key))])).collect())
}
