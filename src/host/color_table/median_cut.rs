//! Median cut: boxes of colours, halved until there are as many as the table has room for.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{Chosen, Counts, means, peano};

/// Chooses `most` colours of a picture that has more. The box with the most colours is halved along its longest side, so that each half has as many
/// colours; a box gets the mean of its pixels.
pub(super) fn choose(counts: &Counts, most: usize) -> Chosen {
    let mut boxes: Vec<Vec<(u32, u64)>> = vec![counts.iter().map(|(&key, &count)| (key, count)).collect()];
    // By their colours; of equals the first.
    let mut by_size = BinaryHeap::from([(boxes[0].len(), Reverse(0))]);
    while boxes.len() < most {
        let Some((_, Reverse(largest))) = by_size.pop().filter(|(colors, _)| *colors > 1) else { break };
        let side = longest_side(&boxes[largest]);
        let whole = &mut boxes[largest];
        whole.sort_by_key(|(key, _)| (peano::color(*key)[side], *key));
        let half = whole.split_off(whole.len() / 2);
        by_size.extend([(whole.len(), Reverse(largest)), (half.len(), Reverse(boxes.len()))]);
        boxes.push(half);
    }
    let sets: Vec<Counts> = boxes.into_iter().map(|colors| colors.into_iter().collect()).collect();
    means(sets.iter())
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
