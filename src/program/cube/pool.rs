//! Slots for rays in the queues of nodes, and who may have one.
//!
//! *Blocking*: a queue takes what it has room for, and a sender waits with nothing else to do until it has. That can end in a circle of
//! nodes that all wait.
//!
//! *Classes*: a structured pool (Merlin and Schweitzer, IEEE Trans. Comm. 28, 1980). A ray has a rank, which rises with each turn of its
//! light and with each region that it comes to; R is the highest. Each node has more than R slots, and gives one to rank r only if more
//! than R - r are free. A ray keeps its slot until all that follows from it has one. So it never sticks: take, of the rays that are left
//! after the last move, one of the highest rank r. It waits for a slot of rank r + 1 or more at a node where at most R - r - 1 are free.
//! That node is not empty, and all its rays are stuck; let s be the rank of the one that got its slot last. Then at least R - s were
//! free, and slots only came free since: R - s <= R - r - 1, so s > r, against what was taken.

use std::collections::{BinaryHeap, VecDeque};

use super::regions::Visit;

/// How rays find room in the queues of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// A queue takes all.
    Unlimited,
    /// A queue has so many slots, and who wants to send waits for one.
    Block(u32),
    /// A queue takes all, and a node has so many pixels under way at the most.
    Window(u32),
    /// A node has so many slots, which are given by rank.
    Classes(u32),
}

/// A ray that has done its work and places what follows from it: itself in the next region, or the rays that its hit asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placing {
    /// The ray, and its leg that is done.
    pub visit: Visit,
    /// Whether it is a pixel's new ray, which has no slot yet and itself wants the first.
    pub is_new: bool,
    /// How many of the rays that follow have a slot.
    pub placed: u32,
}

/// A placing that was put aside: by rank, then the oldest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Aside {
    rank: u32,
    age: u64,
    placing: Placing,
}

/// Who waits for the slots of a node, and for what others' slots it waits.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    /// Nodes that wait to send to it, in the order in which they came, under blocking.
    pub waiting: VecDeque<u16>,
    /// What others have asked for a slot for and not been given one.
    asked: BinaryHeap<Aside>,
    /// For each node, what this one has put aside for want of a slot there.
    aside: Vec<BinaryHeap<Aside>>,
    /// The nodes for which there is any, a bit each.
    wanted: u128,
}

impl PartialOrd for Aside {
    fn partial_cmp(&self, other: &Aside) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Aside {
    fn cmp(&self, other: &Aside) -> std::cmp::Ordering {
        (self.rank, std::cmp::Reverse(self.age)).cmp(&(other.rank, std::cmp::Reverse(other.age)))
    }
}

impl Slots {
    /// The slots of one of so many nodes.
    pub fn new(nodes: usize) -> Slots {
        Slots { aside: vec![BinaryHeap::new(); nodes], ..Slots::default() }
    }

    /// Puts a placing aside that wants a slot of a rank at a node.
    pub fn put_aside(&mut self, to: usize, rank: u32, age: u64, placing: Placing) {
        self.aside[to].push(Aside { rank, age, placing });
        self.wanted |= 1 << to;
    }

    /// Whether anything is put aside for a slot at a node.
    pub fn wants(&self, node: usize) -> bool {
        self.wanted & 1 << node != 0
    }

    /// Whether anything is put aside.
    pub fn wants_any(&self) -> bool {
        self.wanted != 0
    }

    /// Of all that can go on, what has the highest rank, and of that the oldest; `may` tells of a node and a rank.
    pub fn take_movable(&mut self, may: impl Fn(usize, u32) -> bool) -> Option<Placing> {
        let mut best: Option<(Aside, usize)> = None;
        let mut wanted = self.wanted;
        while wanted != 0 {
            let node = wanted.trailing_zeros() as usize;
            wanted &= wanted - 1;
            let Some(&first) = self.aside[node].peek() else { continue };
            if may(node, first.rank) && best.is_none_or(|(known, _)| known < first) {
                best = Some((first, node));
            }
        }
        let (_, node) = best?;
        let taken = self.aside[node].pop();
        if self.aside[node].is_empty() {
            self.wanted &= !(1 << node);
        }
        taken.map(|aside| aside.placing)
    }

    /// Another node's placing waits for a slot of a rank here.
    pub fn wait(&mut self, rank: u32, age: u64, placing: Placing) {
        self.asked.push(Aside { rank, age, placing });
    }

    /// Of what others wait for slots for, what has the highest rank, if it may have one; `may` tells of a rank.
    pub fn take_waiting(&mut self, may: impl Fn(u32) -> bool) -> Option<Placing> {
        self.asked.peek().filter(|first| may(first.rank))?;
        self.asked.pop().map(|first| first.placing)
    }

    /// One of those for which others wait.
    pub fn waiting_of(&self, is_meant: impl Fn(Placing) -> bool) -> Option<Placing> {
        self.asked.iter().map(|aside| aside.placing).find(|&placing| is_meant(placing))
    }

    /// The first that is put aside for a node.
    pub fn first_aside(&self) -> Option<(usize, Placing)> {
        self.aside.iter().enumerate().find_map(|(node, heap)| Some((node, heap.peek()?.placing)))
    }
}
