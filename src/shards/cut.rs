//! How work is cut into shards.

use std::collections::HashMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::host::camera::ImageSize;
use crate::sweep::Sweep;

/// What one shard has to do.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Part {
    /// Points of a sweep: their numbers, each with its [`Sweep::identity`].
    Points(Vec<(usize, String)>),
    /// Lines of an image.
    Lines(Range<u32>),
}

/// Cuts points of a sweep into about so many shards.
///
/// Points that share a recording stay together, unless they are more than a shard's share: then each of their shards traces
/// once.
pub fn parts_of(sweep: &Sweep, points: &[(usize, &str)], count: usize) -> Vec<Part> {
    let numbers: Vec<usize> = points.iter().map(|(index, _)| *index).collect();
    let keys: HashMap<usize, &str> = points.iter().copied().collect();
    let part = |numbers: Vec<usize>| {
        let keyed = numbers.into_iter().filter_map(|index| Some((index, (*keys.get(&index)?).to_owned())));
        Part::Points(keyed.collect())
    };
    pack(sweep.groups(&numbers), numbers.len().div_ceil(count.max(1))).into_iter().map(part).collect()
}

/// Puts groups together to shards of no more than so many points, one after the other. A group is cut only if it is larger.
fn pack(groups: Vec<Vec<usize>>, most: usize) -> Vec<Vec<usize>> {
    let mut shards: Vec<Vec<usize>> = Vec::new();
    for group in groups {
        match shards.last_mut().filter(|last| last.len() + group.len() <= most) {
            Some(last) => last.extend(group),
            None => shards.extend(even(group.len(), group.len().div_ceil(most)).map(|piece| group[piece].to_vec())),
        }
    }
    shards
}

/// Cuts an image into so many shards of whole lines.
pub fn lines_of(size: ImageSize, count: usize) -> Vec<Part> {
    let height = size.height as usize;
    let lines = |piece: Range<usize>| Part::Lines(piece.start as u32..piece.end as u32);
    even(height, count.clamp(1, height.max(1))).map(lines).collect()
}

/// `0..count` in so many pieces, which differ by no more than one.
fn even(count: usize, pieces: usize) -> impl Iterator<Item = Range<usize>> {
    (0..pieces).map(move |piece| piece * count / pieces..(piece + 1) * count / pieces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn groups_by_hand() {
        let packed = |sizes: &[usize], most| {
            let mut next = 0..;
            let groups = sizes.iter().map(|&size| next.by_ref().take(size).collect()).collect();
            pack(groups, most).iter().map(Vec::len).collect::<Vec<_>>()
        };
        assert_eq!(packed(&[2, 3, 4], 5), [5, 4]);
        assert_eq!(packed(&[2, 11, 1], 5), [2, 3, 4, 4 + 1]);
        assert_eq!(packed(&[1, 1, 1], 1), [1, 1, 1]);
        assert_eq!(packed(&[], 3), [] as [usize; 0]);
    }

    proptest! {
        /// Each point is in one shard, in the order of the groups, and a group is in no more shards than it must.
        #[test]
        fn shards_keep_groups_together(sizes in prop::collection::vec(1usize..40, 0..30), most in 1usize..50) {
            let mut next = 0..;
            let groups: Vec<Vec<usize>> = sizes.iter().map(|&size| next.by_ref().take(size).collect()).collect();
            let shards = pack(groups.clone(), most);
            prop_assert!(shards.iter().all(|shard| (1..=most).contains(&shard.len())));
            prop_assert!(shards.iter().flatten().copied().eq(0..sizes.iter().sum()));
            for group in groups {
                let among = shards.iter().filter(|shard| shard.iter().any(|point| group.contains(point))).count();
                prop_assert_eq!(among, group.len().div_ceil(most));
            }
        }

        #[test]
        fn lines_are_cut_evenly(height in 1u32..500, count in 1usize..600) {
            let parts = lines_of(ImageSize { width: 7, height }, count);
            prop_assert_eq!(parts.len(), count.min(height as usize));
            let mut from = 0;
            for part in &parts {
                let Part::Lines(lines) = part else { panic!("lines of an image") };
                prop_assert_eq!(lines.start, from);
                prop_assert!(lines.len().abs_diff(height as usize / parts.len()) <= 1);
                from = lines.end;
            }
            prop_assert_eq!(from, height);
        }
    }
}
