//! Rays as nodes read them: where each goes, what it makes them do there, and what follows from it.

use std::ops::Range;

use crate::host::shading::RayKind;
use crate::machine::KernelTimes;
use crate::program::cube::graph::{Leg, RayTask, Share, TaskGraph, WorkTimes};
use crate::program::cube::pool::Placing;

/// A ray in a region.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visit {
    /// Where the ray stands in the itinerary of its run.
    pub head: u32,
    /// Where its leg stands there.
    pub leg: u32,
}

/// The trees of a graph, node by node, in the order in which each node begins its own.
///
/// In a graph they stand in the order of their pixels, which nodes begin all over the image. Here what is needed soon stands together, so
/// that nodes do not wait for memory: a tree's rays, in each a head and its legs in a word each, and behind them the node's next tree.
#[derive(Clone, Debug)]
pub(super) struct Itinerary {
    /// Ray by ray a head of [`HEAD`] words, then its legs. Nothing stands at 0.
    words: Vec<u64>,
    /// Where the first ray of each tree stands.
    trees: Vec<u32>,
    /// Legs that do too much for a word to tell.
    long: Vec<Leg>,
}

/// A ray's head: its number and its first rank; its tree and where the first ray stands that its hit asks for (or 0); where the next ray
/// stands that was asked for together with it (or 0), the node that its pixel belongs to, and whether it is a shadow ray.
const HEAD: u32 = 3;
/// In the last word of a head.
const SHADOW: u64 = 1 << 63;

/// A leg in a word: the node in 8 bits, three flags, then voxels in 17 bits, slab tests in 18 and intersection tests in 18.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LegWord(u64);

/// It is its ray's last.
const LAST: u64 = 1 << 8;
/// The ray's hit is shaded there.
const SHADES: u64 = 1 << 9;
/// In place of its counts stands the number of a long leg.
const LONG: u64 = 1 << 10;
const COUNTS: u32 = 11;
const VOXEL_BITS: u32 = 17;
const TEST_BITS: u32 = 18;

impl LegWord {
    /// The node that has its region.
    #[inline]
    pub fn node(self) -> usize {
        (self.0 & 0xff) as usize
    }

    /// Whether it is its ray's last.
    #[inline]
    pub fn is_last(self) -> bool {
        self.0 & LAST != 0
    }
}

fn pair(low: u32, high: u32) -> u64 {
    u64::from(low) | u64::from(high) << 32
}

#[inline]
fn high(word: u64) -> u32 {
    (word >> 32) as u32
}

impl Itinerary {
    /// The trees in that order, each of which belongs to a node of `owners`; `node_of` tells each region's node, and so many regions are
    /// met by a line at the most. None if there are more rays and legs than can be counted.
    pub fn new(
        graph: &TaskGraph,
        (order, owners): (&[u32], &[u16]),
        node_of: &[u16],
        most_regions: u32,
    ) -> Option<Itinerary> {
        let words = 1 + HEAD as usize * graph.rays.len() + graph.legs.len();
        u32::try_from(words).ok()?;
        let mut itinerary = Itinerary { words: Vec::with_capacity(words), trees: Vec::new(), long: Vec::new() };
        itinerary.words.push(0);
        itinerary.trees.reserve_exact(order.len());
        let mut are_followed = Vec::new();
        for &tree in order {
            let owner = owners[tree as usize];
            itinerary.add(graph, tree as usize, owner, &mut are_followed, (node_of, most_regions));
        }
        Some(itinerary)
    }

    /// Adds a tree. In `are_followed` it keeps whether each of its rays was asked for together with the next one.
    fn add(
        &mut self,
        graph: &TaskGraph,
        tree: usize,
        owner: u16,
        are_followed: &mut Vec<bool>,
        (node_of, most_regions): (&[u16], u32),
    ) {
        let rays = graph.tree(tree);
        let (start, first) = (self.words.len() as u32, graph.rays[rays.start as usize]);
        let number = self.trees.len() as u32;
        self.trees.push(start);
        are_followed.clear();
        are_followed.resize(rays.len(), false);
        for ray in rays.clone() {
            let task = graph.rays[ray as usize];
            let place = |ray: u32, task: RayTask| start + HEAD * (ray - rays.start) + task.first_leg - first.first_leg;
            let child = match task.children {
                (_, 0) => 0,
                (child, count) => {
                    let place_in_tree = (child - rays.start) as usize;
                    are_followed[place_in_tree..place_in_tree + count as usize - 1].fill(true);
                    place(child, graph.rays[child as usize])
                }
            };
            let sibling = match are_followed[(ray - rays.start) as usize] {
                true => place(ray + 1, graph.rays[ray as usize + 1]),
                false => 0,
            };
            let shadow = if task.kind == RayKind::Shadow { SHADOW } else { 0 };
            let rank = u32::from(task.turns) * most_regions + u32::from(task.hop);
            self.words.extend([pair(ray, rank), pair(number, child), pair(sibling, owner.into()) | shadow]);
            for leg in graph.legs_of(ray) {
                let word = self.leg_word(leg, node_of[usize::from(leg.region)]);
                self.words.push(word);
            }
            if let Some(last) = self.words.last_mut() {
                *last |= LAST | if task.shaded { SHADES } else { 0 };
            }
        }
    }

    fn leg_word(&mut self, leg: &Leg, node: u16) -> u64 {
        let &Leg { voxels, slab_tests, intersection_tests, .. } = leg;
        let fits = voxels >> VOXEL_BITS == 0 && (slab_tests | intersection_tests) >> TEST_BITS == 0;
        let tests = u64::from(slab_tests) | u64::from(intersection_tests) << TEST_BITS;
        match fits {
            true => u64::from(node) | u64::from(voxels) << COUNTS | tests << (COUNTS + VOXEL_BITS),
            false => {
                self.long.push(*leg);
                u64::from(node) | LONG | (self.long.len() as u64 - 1) << COUNTS
            }
        }
    }

    /// What a leg takes, with the shading of its ray's hit.
    #[inline]
    pub fn time(&self, LegWord(word): LegWord, times: &KernelTimes) -> WorkTimes {
        let count = |from: u32, bits: u32| (word >> from) as u32 & ((1 << bits) - 1);
        let leg = match word & LONG {
            0 => Leg {
                region: 0,
                voxels: count(COUNTS, VOXEL_BITS),
                slab_tests: count(COUNTS + VOXEL_BITS, TEST_BITS),
                intersection_tests: count(COUNTS + VOXEL_BITS + TEST_BITS, TEST_BITS),
            },
            _ => self.long[(word >> COUNTS) as usize],
        };
        Share { leg, shades: word & SHADES != 0 }.time(times)
    }

    #[inline]
    fn word(&self, place: u32) -> u64 {
        self.words[place as usize]
    }

    #[inline]
    pub fn leg(&self, visit: Visit) -> LegWord {
        LegWord(self.word(visit.leg))
    }

    /// A ray's number in the graph.
    #[inline]
    pub fn ray(&self, visit: Visit) -> u32 {
        self.word(visit.head) as u32
    }

    /// How many legs of its ray come before a visit's.
    pub fn legs_before(&self, visit: Visit) -> u32 {
        visit.leg - visit.head - HEAD
    }

    /// A ray's rank in a region.
    #[inline]
    pub fn rank(&self, visit: Visit) -> u32 {
        high(self.word(visit.head)) + self.legs_before(visit)
    }

    /// A ray's tree, and the node that this belongs to.
    #[inline]
    pub fn tree(&self, visit: Visit) -> (u32, usize) {
        let owner = high(self.word(visit.head + 2) & !SHADOW);
        (self.word(visit.head + 1) as u32, owner as usize)
    }

    #[inline]
    pub fn is_shadow(&self, visit: Visit) -> bool {
        self.word(visit.head + 2) & SHADOW != 0
    }

    /// The first ray of a tree, which is placed where it starts.
    #[inline]
    pub fn begin(&self, tree: u32) -> Placing {
        let head = self.trees[tree as usize];
        Placing { visit: Visit { head, leg: head + HEAD }, next: head, is_new: true, is_last: false }
    }

    /// Looks at some visits and what follows from them, so that they are at hand when they are worked on: for what is asked for together
    /// memory is waited for but once.
    #[inline(always)]
    pub fn look_at(&self, visits: impl Iterator<Item = Visit>) {
        for visit in visits {
            std::hint::black_box(self.follower(self.placing(visit, self.leg(visit))));
        }
    }

    /// Looks at some trees in the same way: at each eighth word, as that many words come from memory together.
    #[inline(always)]
    pub fn look_at_trees(&self, trees: Range<u32>) {
        let place = |tree: u32| self.trees.get(tree as usize).map_or(self.words.len(), |&place| place as usize);
        let words = &self.words[place(trees.start)..place(trees.end)];
        std::hint::black_box(words.iter().step_by(8).fold(0, |all, word| all ^ word));
    }

    /// What follows from a visit is to be placed.
    #[inline]
    pub fn placing(&self, visit: Visit, leg: LegWord) -> Placing {
        let next = if leg.is_last() { high(self.word(visit.head + 1)) } else { visit.head };
        Placing { visit, next, is_new: false, is_last: leg.is_last() }
    }

    /// What of a placing comes next, and the node that it goes to: the ray in its next region, or a ray that its hit asks for.
    #[inline]
    pub fn follower(&self, Placing { visit, next, is_new, .. }: Placing) -> Option<(Visit, usize)> {
        let leg = if next == visit.head { visit.leg + u32::from(!is_new) } else { next + HEAD };
        let visit = Visit { head: next, leg };
        (next != 0).then(|| (visit, self.leg(visit).node()))
    }

    /// A placing when that has its place.
    #[inline]
    pub fn after(&self, placing: Placing) -> Placing {
        let next = if placing.next == placing.visit.head { 0 } else { self.word(placing.next + 2) as u32 };
        Placing { next, ..placing }
    }
}
