//! What is counted while nodes run, beside their time.

use super::messages::{MessageKind, Messages, Sent};
use crate::machine::Cycles;
use crate::machine::events::Cube;

/// What is counted beside the nodes' time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// Messages by kind.
    pub messages: Messages,
    /// When the last result was taken.
    pub true_end: Cycles,
    /// When that was known.
    pub told_at: Cycles,
    /// Rounds of the token that were begun.
    pub probes: u64,
    /// For each node, what it came to.
    pub nodes: Vec<NodeSeen>,
    /// Rays that were sent on or away, from each node to each, row by row.
    pub sent: Vec<u64>,
    /// What was sent from each of the nodes and the host to each, by kind, row by row; the host is the last of them.
    pub pairs: Vec<[Sent; MessageKind::ALL.len()]>,
}

impl Seen {
    /// A message of a kind is sent over links of a cube, between two tasks, of which one spends some time on it.
    #[inline(always)]
    pub(super) fn send(
        &mut self,
        cube: &Cube,
        (from, to): (usize, usize),
        (kind, bytes): (MessageKind, u64),
        time: Cycles,
    ) {
        self.messages[kind as usize].send(bytes, cube.hops(from, to), time);
        let pair = &mut self.pairs[cube.pair(from, to)][kind as usize];
        pair.messages += 1;
        pair.bytes += bytes;
    }
}

/// What a node came to beside its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeSeen {
    /// Pixels that belong to it.
    pub pixels: usize,
    /// Legs that it has worked on.
    pub legs: u64,
    /// The most slots that were taken at once, if there are slots.
    pub most_slots: u32,
    /// Pages that it has fetched, if it fetches any.
    pub pages: u64,
}
