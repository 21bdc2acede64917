//! The chains of causes that a run may yet come to end with: a tree, as all begin in cycle 0. What follows from what is the
//! machine's own; here it is added up, and forgotten.

mod tally;

use std::ops::Range;

use tally::normalize;
pub use tally::{Code, Entry, Pen};

/// A point of a chain: somebody at the beginning of a cycle.
#[derive(Clone, Debug)]
pub struct Node {
    /// The point that it follows from; none for the first of all.
    pub parent: Option<u32>,
    /// What lies between that and this.
    pub piece: Range<u32>,
}

/// The tree. Where chains have one way only, it is one edge, whose pieces have been added up: there are at the most twice as
/// many nodes as chains. What all chains have in common is settled, whatever comes.
#[derive(Debug)]
pub struct Chains {
    nodes: Vec<Node>,
    /// The pieces of all nodes.
    pub pen: Pen,
    settled: Vec<Entry>,
    /// So many settled entries were left when they were last added up.
    settled_to: usize,
    /// There are so many bins at the most.
    most_bins: u64,
}

/// Settled entries that need not be added up.
const FEW: usize = 1 << 12;

impl Chains {
    /// One chain, which has not gone anywhere: its only point is node 0.
    pub fn new(most_bins: u64) -> Chains {
        Chains {
            nodes: vec![Node { parent: None, piece: 0..0 }],
            pen: Pen::new(0),
            settled: Vec::new(),
            settled_to: 0,
            most_bins,
        }
    }

    /// Widens the bins until they hold a run of so many cycles.
    pub fn reach(&mut self, cycles: u64) {
        while cycles.saturating_sub(1) >> self.pen.shift >= self.most_bins {
            self.pen.shift += 1;
            self.pen.entries.iter_mut().chain(&mut self.settled).for_each(Entry::widen);
        }
    }

    /// How many points there are: the number of the next one.
    pub fn len(&self) -> u32 {
        self.nodes.len() as u32
    }

    /// Adds a point that follows from another, by way of what was entered since the one before was added; or, if the way goes
    /// on through it, leaves that to the next point.
    pub fn push(&mut self, parent: u32, goes_on: bool) {
        let piece = if goes_on { 0..0 } else { self.pen.end_piece() };
        self.nodes.push(Node { parent: Some(parent), piece });
    }

    /// Forgets all points but those on which chains end that are `live`, and where these part. Returns their new numbers.
    pub fn keep(&mut self, live: &[u32]) -> Vec<u32> {
        let family = Family::new(&self.nodes, live);
        let mut number = vec![0; self.nodes.len()];
        let kept: Vec<usize> = (0..self.nodes.len()).filter(|&node| family.keeps(&self.nodes, node)).collect();
        kept.iter().zip(0..).for_each(|(&node, new)| number[node] = new);
        let mut pen = Pen::new(self.pen.shift);
        let mut nodes = Vec::with_capacity(kept.len());
        for &node in &kept {
            let start = pen.entries.len();
            let mut at = node;
            let parent = loop {
                let piece = &self.nodes[at].piece;
                pen.entries.extend_from_slice(&self.pen.entries[piece.start as usize..piece.end as usize]);
                match self.nodes[at].parent {
                    None => break None,
                    Some(parent) if family.keeps(&self.nodes, parent as usize) => break Some(number[parent as usize]),
                    Some(parent) => at = parent as usize,
                }
            };
            normalize(&mut pen.entries, start);
            nodes.push(Node { parent, piece: pen.end_piece() });
        }
        let root = kept.iter().position(|&node| self.nodes[node].parent.is_none());
        let one_way = root.filter(|&root| family.is_one_way(kept[root]));
        (self.nodes, self.pen) = (nodes, pen);
        if let Some(root) = one_way {
            self.settle(root as u32);
        }
        live.iter().map(|&node| number[node as usize]).collect()
    }

    /// All chains go from the first point to the same next one: what lies between is settled, and they begin there.
    fn settle(&mut self, root: u32) {
        let Some(next) = self.nodes.iter_mut().find(|node| node.parent == Some(root)) else { return };
        next.parent = None;
        let piece = std::mem::replace(&mut next.piece, 0..0);
        self.settled.extend_from_slice(&self.pen.entries[piece.start as usize..piece.end as usize]);
        if self.settled.len() > 2 * self.settled_to + FEW {
            normalize(&mut self.settled, 0);
            self.settled_to = self.settled.len();
        }
    }

    /// All that is settled, in the order of bins, places and causes, and the width of a bin.
    pub fn into_settled(mut self) -> (Vec<Entry>, u64) {
        normalize(&mut self.settled, 0);
        (self.settled, 1 << self.pen.shift)
    }
}

/// Who follows from whom, of the points that live chains lead through.
struct Family {
    live: Vec<bool>,
    on_chain: Vec<bool>,
    children: Vec<u32>,
}

impl Family {
    fn new(nodes: &[Node], live: &[u32]) -> Family {
        let mut family = Family {
            live: vec![false; nodes.len()],
            on_chain: vec![false; nodes.len()],
            children: vec![0; nodes.len()],
        };
        for &node in live {
            family.live[node as usize] = true;
            let mut at = node as usize;
            while !std::mem::replace(&mut family.on_chain[at], true) {
                let Some(parent) = nodes[at].parent else { break };
                at = parent as usize;
                family.children[at] += 1;
            }
        }
        family
    }

    /// Whether a point is the first, a last one or one where chains part.
    fn keeps(&self, nodes: &[Node], node: usize) -> bool {
        self.on_chain[node] && (self.live[node] || self.children[node] > 1 || nodes[node].parent.is_none())
    }

    /// Whether no chain ends there, and all go on to the same next one.
    fn is_one_way(&self, node: usize) -> bool {
        !self.live[node] && self.children[node] == 1
    }
}
