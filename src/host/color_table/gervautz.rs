//! The octree of Gervautz and Purgathofer (chapter 4, section 2): the deepest cubes are merged first, one at a time.

use std::collections::BTreeMap;

use super::{Chosen, Counts, means};

/// Chooses `most` colours of a picture that has more. Of the deepest cubes that have parts, the one with the fewest pixels becomes a single
/// colour, their mean, until no more are left than asked for; of equals the one that comes first in Peano's order.
pub(super) fn choose(counts: &Counts, most: usize) -> Chosen {
    let mut sets: BTreeMap<u32, Counts> = counts.iter().map(|(&key, &count)| (key, [(key, count)].into())).collect();
    loop {
        let mut left = sets.len();
        let mut cubes: BTreeMap<u32, Vec<Counts>> = BTreeMap::new();
        sets.into_iter().for_each(|(part, colors)| cubes.entry(part >> 3).or_default().push(colors));
        let pixels = |parts: &Vec<Counts>| parts.iter().flat_map(Counts::values).sum::<u64>();
        let mut order: Vec<(u64, u32)> = cubes.iter().map(|(&cube, parts)| (pixels(parts), cube)).collect();
        order.sort_unstable();
        for (_, cube) in order {
            let Some(parts) = cubes.get_mut(&cube).filter(|_| left > most) else { break };
            left -= parts.len() - 1;
            *parts = vec![std::mem::take(parts).into_iter().flatten().collect()];
        }
        if left <= most {
            return means(cubes.values().flatten());
        }
        sets = cubes.into_iter().map(|(cube, parts)| (cube, parts.into_iter().flatten().collect())).collect();
    }
}
