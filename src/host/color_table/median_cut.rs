//! Median cut: boxes of colours, halved until there are as many as the table has room for.

use super::{Chosen, Counts, mean, peano};

/// Chooses `most` colours of a picture that has more. The box with the most colours is halved along its longest side, so that each half has as many
/// colours; a box gets the mean of its pixels.
pub(super) fn choose(counts: &Counts, most: usize) -> Chosen {
    let mut boxes: Vec<Vec<(u32, u64)>> = vec![counts.iter().map(|(&key, &count)| (key, count)).collect()];
    while boxes.len() < most {
        // Of equals the first.
        let Some(largest) = (0..boxes.len()).rev().max_by_key(|&at| boxes[at].len()).filter(|&at| boxes[at].len() > 1)
        else {
            break;
        };
        let side = longest_side(&boxes[largest]);
        let whole = &mut boxes[largest];
        whole.sort_by_key(|(key, _)| (peano::color(*key)[side], *key));
        let half = whole.split_off(whole.len() / 2);
        boxes.push(half);
    }
    let colors = boxes.iter().map(|colors| mean(colors.iter().map(|(key, count)| (key, count)))).collect();
    let places = boxes.iter().zip(0..=255).flat_map(|(colors, place)| colors.iter().map(move |&(key, _)| (key, place)));
    (colors, places.collect())
}

/// Red, green or blue, whichever the colours of a box differ most in.
fn longest_side(colors: &[(u32, u64)]) -> usize {
    let parts = |side: usize| colors.iter().map(move |(key, _)| peano::color(*key)[side]);
    let length = |side: usize| {
        let (low, high) = parts(side).fold((u8::MAX, u8::MIN), |(low, high), part| (low.min(part), high.max(part)));
        high.saturating_sub(low)
    };
    (0..3).rev().max_by_key(|&side| length(side)).unwrap_or_default()
}
