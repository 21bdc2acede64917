//! The octree of colours whose cubes stand in Peano's order: the first method of the thesis, for tables of few colours, and the second, for
//! tables of thousands.

use std::collections::{BTreeMap, BTreeSet};

use super::{Chosen, Color, Counts, entries, means};

/// A colour's place in Peano's order: its bits in turn, the highest first, red before green before blue. The colours of a cube of side
/// 2^n share what is left of their keys without the last 3 n bits.
pub fn key(color: Color) -> u32 {
    (0..8).rev().fold(0, |key, bit| color.iter().fold(key, |key, part| key << 1 | u32::from(part >> bit & 1)))
}

/// The colour of a key.
pub(super) fn color(key: u32) -> Color {
    let part = |place: u32| (0..8).fold(0, |part, bit| part | ((key >> (3 * bit + 2 - place) & 1) << bit) as u8);
    [part(0), part(1), part(2)]
}

/// Chooses `most` colours of a picture that has more, and returns the level of the octree's leaves with them.
///
/// Leaves are cubes of the lowest level whose parents are no more than the table has room for. While there is room for more than
/// the parents, the most frequent leaf gets an entry of its own, of equals the brighter one; each parent gets one for what is left of its
/// leaves. It shows the mean of its pixels, or, where sums would take too much memory, the brightest colour about the middle of its cube.
pub(super) fn choose(counts: &Counts, most: usize, has_means: bool) -> (u32, Chosen) {
    let cubes = |level: u32| counts.keys().map(|key| key >> (3 * level)).collect::<BTreeSet<u32>>().len();
    let level = (0..8).find(|&level| cubes(level + 1) <= most).unwrap_or(7);
    let leaf = |key: &u32| key >> (3 * level);
    let mut leaves: BTreeMap<u32, u64> = BTreeMap::new();
    counts.iter().for_each(|(key, count)| *leaves.entry(leaf(key)).or_default() += count);
    let taken = taken(&leaves, most);
    let entry = |key: &u32| if taken.contains(&leaf(key)) { (leaf(key), true) } else { (leaf(key) >> 3, false) };
    let mut members: BTreeMap<(u32, bool), Counts> = BTreeMap::new();
    for (key, &count) in counts {
        members.entry(entry(key)).or_default().insert(*key, count);
    }
    if has_means {
        return (level, means(members.values()));
    }
    let shown = |&(cube, is_leaf): &(u32, bool)| middle(cube, if is_leaf { level } else { level + 1 });
    (level, (members.keys().map(shown).collect(), entries(members.values())))
}

/// Of the eight colours about the middle of a cube the brightest: its highest bit but one is set in each part. A cube of level 0 is a colour.
fn middle(cube: u32, level: u32) -> Color {
    let first = cube << (3 * level);
    color(if level == 0 { first } else { first | 7 << (3 * (level - 1)) })
}

/// The leaves that get an entry of their own.
fn taken(leaves: &BTreeMap<u32, u64>, most: usize) -> BTreeSet<u32> {
    if leaves.len() <= most {
        return leaves.keys().copied().collect();
    }
    let mut left: BTreeMap<u32, usize> = BTreeMap::new();
    leaves.keys().for_each(|leaf| *left.entry(leaf >> 3).or_default() += 1);
    let mut frequent: Vec<(u64, u32)> = leaves.iter().map(|(&leaf, &count)| (count, leaf)).collect();
    frequent.sort_unstable_by(|one, other| other.cmp(one));
    let (mut room, mut taken) = (most, BTreeSet::new());
    for (_, leaf) in frequent {
        if room <= left.len() {
            break;
        }
        room -= 1;
        taken.insert(leaf);
        if let Some(leaves) = left.get_mut(&(leaf >> 3)) {
            *leaves -= 1;
            if *leaves == 0 {
                left.remove(&(leaf >> 3));
            }
        }
    }
    taken
}
