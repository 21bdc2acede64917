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

use std::collections::VecDeque;

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
    /// Where the ray stands in the itinerary that wants a slot next, or 0 if all have one.
    pub next: u32,
    /// Whether it is a pixel's new ray, which has no slot yet and itself wants the first.
    pub is_new: bool,
    /// Whether the leg was the ray's last.
    pub is_last: bool,
}

/// A placing that waits for a slot, for what it places next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aside {
    /// The placing.
    pub placing: Placing,
    /// What is older has a lower number.
    pub age: u64,
}

/// Placings that wait for slots, by the rank of what they place next: in each the oldest first.
#[derive(Clone, Debug, Default)]
struct Ranks {
    queues: Vec<VecDeque<Aside>>,
    /// Above the highest rank of any.
    above: usize,
}

impl Ranks {
    fn push(&mut self, rank: u32, aside: Aside) {
        let rank = rank as usize;
        if self.queues.len() <= rank {
            self.queues.resize_with(rank + 1, VecDeque::new);
        }
        self.queues[rank].push_back(aside);
        self.above = self.above.max(rank + 1);
    }

    /// Of those of the highest rank the oldest, and that rank.
    fn first(&self) -> Option<(u32, &Aside)> {
        let rank = self.above.checked_sub(1)?;
        self.queues[rank].front().map(|aside| (rank as u32, aside))
    }

    fn pop(&mut self) -> Option<Aside> {
        let popped = self.queues[self.above.checked_sub(1)?].pop_front();
        while self.above > 0 && self.queues[self.above - 1].is_empty() {
            self.above -= 1;
        }
        popped
    }
}

/// Who waits for the slots of a node, and for what others' slots it waits.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    /// Nodes that wait to send to it, in the order in which they came, under blocking.
    pub waiting: VecDeque<u16>,
    /// What others have asked for a slot for and not been given one.
    asked: Ranks,
    /// For each node, what this one has put aside for want of a slot there.
    aside: Vec<Ranks>,
    /// The rank and the age of the first of that, for each node for which there is any.
    firsts: Vec<(u32, u64)>,
    /// The nodes for which there is any, a bit each.
    wanted: u128,
    /// The nodes that have put anything aside for want of a slot here, a bit each.
    pub wanted_by: u128,
}

impl Slots {
    /// The slots of one of so many nodes.
    pub fn new(nodes: usize) -> Slots {
        Slots { aside: vec![Ranks::default(); nodes], firsts: vec![(0, 0); nodes], ..Slots::default() }
    }

    /// Puts a placing aside that wants a slot of a rank at a node. It is younger than all others.
    pub fn put_aside(&mut self, to: usize, rank: u32, aside: Aside) {
        if !self.wants(to) || rank > self.firsts[to].0 {
            self.firsts[to] = (rank, aside.age);
        }
        self.aside[to].push(rank, aside);
        self.wanted |= 1 << to;
    }

    /// Whether anything is put aside for a slot at a node.
    pub fn wants(&self, node: usize) -> bool {
        self.wanted & 1 << node != 0
    }

    /// The rank of what goes on first when there is a slot for it at a node, for which something is put aside.
    pub fn first_rank(&self, node: usize) -> u32 {
        self.firsts[node].0
    }

    /// Whether anything is put aside.
    pub fn wants_any(&self) -> bool {
        self.wanted != 0
    }

    /// Of all that can go on, what has the highest rank, and of that the oldest, and the node that it goes to; `may` tells of a node and
    /// a rank.
    pub fn take_movable(&mut self, may: impl Fn(usize, u32) -> bool) -> Option<(usize, Aside)> {
        let mut best: Option<(u32, u64, usize)> = None;
        let mut wanted = self.wanted;
        while wanted != 0 {
            let node = wanted.trailing_zeros() as usize;
            wanted &= wanted - 1;
            let (rank, age) = self.firsts[node];
            let is_before = best.is_none_or(|(known, other, _)| rank > known || rank == known && age < other);
            if is_before && may(node, rank) {
                best = Some((rank, age, node));
            }
        }
        let (.., node) = best?;
        let taken = self.aside[node].pop()?;
        match self.aside[node].first() {
            Some((rank, first)) => self.firsts[node] = (rank, first.age),
            None => self.wanted &= !(1 << node),
        }
        Some((node, taken))
    }

    /// Another node's placing waits for a slot of a rank here. It is younger than all others.
    pub fn wait(&mut self, rank: u32, aside: Aside) {
        self.asked.push(rank, aside);
    }

    /// Of what others wait for slots for, what has the highest rank, if it may have one; `may` tells of a rank.
    pub fn take_waiting(&mut self, may: impl Fn(u32) -> bool) -> Option<Placing> {
        self.asked.first().filter(|&(rank, _)| may(rank))?;
        self.asked.pop().map(|first| first.placing)
    }

    /// One of those for which others wait.
    pub fn waiting_of(&self, is_meant: impl Fn(Placing) -> bool) -> Option<Placing> {
        self.asked.queues.iter().flatten().map(|aside| aside.placing).find(|&placing| is_meant(placing))
    }

    /// The first that is put aside for a node.
    pub fn first_aside(&self) -> Option<(usize, Placing)> {
        self.aside.iter().enumerate().find_map(|(node, ranks)| Some((node, ranks.first()?.1.placing)))
    }
}
