//! The links of a hypercube, by which a message has a circuit all the way to its receiver.

use super::network::Passage;
use crate::measure::{Actor, LinkMessages, LinkStats};
use crate::quantities::Cycles;

/// What the way of a message takes, in cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WireTimes {
    /// The most bytes of a short message; longer ones ask for room first.
    pub short_bytes: u64,
    /// What a short message takes to a neighbour, beside its bytes.
    pub short: Cycles,
    /// What a long one takes, for which it has the links, too.
    pub long: Cycles,
    /// What each further link of the way takes.
    pub hop: Cycles,
    /// Thousandths of a cycle that a byte takes.
    pub byte_millicycles: u64,
}

/// The nodes of a hypercube, of which the tasks with the lowest numbers run one each, and the host, the next task, which hangs on
/// node 0. Each has a link in each direction to those whose number differs in one bit.
///
/// A message goes by the lowest bit first (e-cube). It starts when all links of its way are free, and has them for as long as its
/// bytes take (a long one: from when it asks for room), so that it passes nodes on its way without their doing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cube {
    nodes: usize,
    /// Bits of a node's number.
    bits: usize,
    times: WireTimes,
    /// Those out of node 0 by bit, those out of node 1, ..., then the one from the host, then the one to it.
    links: Vec<Link>,
}

/// A link in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Link {
    /// When it is free.
    free: u64,
    /// For how long messages had it.
    busy: u64,
    messages: LinkMessages,
}

/// What is left of a message's way, link by link.
#[derive(Clone, Debug)]
struct Way {
    from_host: Option<usize>,
    /// The node that it has come to, and the bits in which that differs from its receiver's.
    at: usize,
    differs: usize,
    /// Bits of a node's number.
    bits: usize,
    to_host: Option<usize>,
}

impl Iterator for Way {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        if self.from_host.is_some() {
            return self.from_host.take();
        }
        if self.differs == 0 {
            return self.to_host.take();
        }
        let bit = self.differs.trailing_zeros() as usize;
        let link = self.at * self.bits + bit;
        self.at ^= 1 << bit;
        self.differs &= self.differs - 1;
        Some(link)
    }
}

impl Cube {
    /// So many nodes of the smallest cube that has them, whose others only pass messages on.
    pub fn new(nodes: usize, times: WireTimes) -> Cube {
        let nodes = nodes.max(1);
        let bits = nodes.next_power_of_two().ilog2() as usize;
        let links = vec![Link::default(); (bits << bits) + 2];
        Cube { nodes, bits, times, links }
    }

    /// What the way takes.
    pub fn times(&self) -> &WireTimes {
        &self.times
    }

    /// How many links a message passes.
    pub fn hops(&self, from: usize, to: usize) -> u64 {
        let (from, to) = (self.place(from), self.place(to));
        let at = |place: usize| if place == self.nodes { 0 } else { place };
        let with_host = u64::from(from == self.nodes) + u64::from(to == self.nodes);
        u64::from((at(from) ^ at(to)).count_ones()) + with_host
    }

    /// The node that a task is on, or the number behind them for the host. Tasks behind the host are helpers, one on each node.
    pub fn place(&self, task: usize) -> usize {
        if task > self.nodes { task - self.nodes - 1 } else { task }
    }

    /// How many places there are: the nodes', and the host's behind them.
    pub fn places(&self) -> usize {
        self.nodes + 1
    }

    /// For how long a message has its links.
    fn holds(&self, bytes: u64) -> u64 {
        let set_up = if bytes > self.times.short_bytes { self.times.long.0 } else { 0 };
        set_up + bytes.saturating_mul(self.times.byte_millicycles).div_ceil(1000)
    }

    /// How many links there are.
    pub(super) fn count(&self) -> usize {
        self.links.len()
    }

    /// Takes a message that is ready to go.
    pub(super) fn carry(&mut self, (from, to): (usize, usize), ready: u64, bytes: u64) -> Passage {
        let (from, to) = (self.place(from), self.place(to));
        // It waits for the link that is free last, the first of several.
        let (mut starts, mut last) = (ready, None);
        let way = self.way(from, to);
        for link in way.clone() {
            if self.links[link].free > starts {
                (starts, last) = (self.links[link].free, Some(link));
            }
        }
        if let Some(link) = last {
            self.links[link].messages.waited += Cycles(starts - ready);
        }
        let holds = self.holds(bytes);
        let free = starts + holds;
        for link in way {
            let link = &mut self.links[link];
            link.free = free;
            link.busy += holds;
            link.messages.sent += 1;
            link.messages.bytes += bytes;
        }
        Passage { bus: 0, starts, free, arrives: free + self.way_after(from, to, bytes) }
    }

    /// How long a message is under way from node to node if nothing is in its way.
    pub fn least_time(&self, from: usize, to: usize, bytes: u64) -> Cycles {
        Cycles(self.holds(bytes) + self.way_after(from, to, bytes))
    }

    /// How long a message is still under way when its links are free for others.
    fn way_after(&self, from: usize, to: usize, bytes: u64) -> u64 {
        let set_up = if bytes > self.times.short_bytes { 0 } else { self.times.short.0 };
        set_up + self.times.hop.0 * self.hops(from, to).saturating_sub(1)
    }

    /// The links of a message's way, from task to task: those out of node 0 by bit, those out of node 1, ..., then the one from the
    /// host, then the one to it.
    pub fn links_between(&self, from: usize, to: usize) -> impl Iterator<Item = usize> + use<> {
        self.way(self.place(from), self.place(to))
    }

    /// The links of a message's way, from place to place.
    #[inline]
    fn way(&self, from: usize, to: usize) -> Way {
        let (host, host_links) = (self.nodes, self.links.len() - 2);
        let (at, end) = (if from == host { 0 } else { from }, if to == host { 0 } else { to });
        Way {
            from_host: (from == host).then_some(host_links),
            at,
            differs: at ^ end,
            bits: self.bits,
            to_host: (to == host).then_some(host_links + 1),
        }
    }

    /// How long each link was busy, and with what.
    pub(super) fn stats(&self) -> Vec<LinkStats> {
        let between = self.links.len() - 2;
        let ends = |link: usize| match link {
            link if link < between => {
                let (node, bit) = (link / self.bits, link % self.bits);
                (Actor::Station(node), Actor::Station(node ^ 1 << bit))
            }
            link if link == between => (Actor::Host, Actor::Station(0)),
            _ => (Actor::Station(0), Actor::Host),
        };
        let stats = |(number, link): (usize, &Link)| {
            let ((from, into), busy) = (ends(number), Cycles(link.busy));
            LinkStats { from: Some(from), into: Some(into), busy, read: busy, messages: Some(link.messages) }
        };
        self.links.iter().enumerate().map(stats).collect()
    }
}
