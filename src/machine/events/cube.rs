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
    ways: Ways,
    /// When each link is free: those out of node 0 by bit, those out of node 1, ..., then the one from the host, then the one to it.
    free: Vec<u64>,
    /// For how long messages waited for each link.
    waited: Vec<Cycles>,
    /// What was carried from each place to each, row by row.
    carried: Vec<Carried>,
}

/// The links of the ways from each place to each, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Ways {
    links: Vec<u32>,
    /// Where each way begins among the links, and behind them where the last ends.
    starts: Vec<u32>,
}

/// Messages that were carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Carried {
    messages: u64,
    bytes: u64,
    /// For how long they had their links.
    held: u64,
}

impl Carried {
    #[inline]
    fn add(&mut self, more: Carried) {
        self.messages += more.messages;
        self.bytes += more.bytes;
        self.held += more.held;
    }
}

impl Ways {
    /// Those of so many nodes, whose numbers have so many bits, and the host.
    fn new(nodes: usize, bits: usize) -> Ways {
        let mut ways = Ways { links: Vec::new(), starts: vec![0] };
        for from in 0..=nodes {
            for to in 0..=nodes {
                ways.links.extend(way((nodes, bits), from, to).map(|link| link as u32));
                ways.starts.push(ways.links.len() as u32);
            }
        }
        ways
    }

    #[inline]
    fn of(&self, pair: usize) -> &[u32] {
        &self.links[self.starts[pair] as usize..self.starts[pair + 1] as usize]
    }
}

/// The links of a way from place to place, in a cube of so many nodes, whose numbers have so many bits.
fn way((host, bits): (usize, usize), from: usize, to: usize) -> impl Iterator<Item = usize> {
    let host_links = bits << bits;
    let node = |place: usize| if place == host { 0 } else { place };
    let (start, differs) = (node(from), node(from) ^ node(to));
    // The bits below have been gone by already.
    let at = move |bit: usize| start ^ differs & ((1 << bit) - 1);
    let between = (0..bits).filter(move |bit| differs >> bit & 1 == 1).map(move |bit| at(bit) * bits + bit);
    let from_host = (from == host).then_some(host_links);
    let to_host = (to == host).then_some(host_links + 1);
    from_host.into_iter().chain(between).chain(to_host)
}

impl Cube {
    /// So many nodes of the smallest cube that has them, whose others only pass messages on.
    pub fn new(nodes: usize, times: WireTimes) -> Cube {
        let nodes = nodes.max(1);
        let bits = nodes.next_power_of_two().ilog2() as usize;
        let (links, places) = ((bits << bits) + 2, nodes + 1);
        Cube {
            nodes,
            bits,
            times,
            ways: Ways::new(nodes, bits),
            free: vec![0; links],
            waited: vec![Cycles(0); links],
            carried: vec![Carried::default(); places * places],
        }
    }

    /// What the way takes.
    pub fn times(&self) -> &WireTimes {
        &self.times
    }

    /// How many links a message passes.
    #[inline]
    pub fn hops(&self, from: usize, to: usize) -> u64 {
        self.ways.of(self.pair(from, to)).len() as u64
    }

    /// The number of a pair of tasks' places, where these are listed row by row.
    #[inline]
    pub fn pair(&self, from: usize, to: usize) -> usize {
        self.place(from) * self.places() + self.place(to)
    }

    /// The node that a task is on, or the number behind them for the host. Tasks behind the host are helpers, one on each node.
    #[inline]
    pub fn place(&self, task: usize) -> usize {
        if task > self.nodes { task - self.nodes - 1 } else { task }
    }

    /// How many places there are: the nodes', and the host's behind them.
    #[inline]
    pub fn places(&self) -> usize {
        self.nodes + 1
    }

    /// For how long a message has its links.
    #[inline]
    fn holds(&self, bytes: u64) -> u64 {
        let set_up = if bytes > self.times.short_bytes { self.times.long.0 } else { 0 };
        set_up + bytes.saturating_mul(self.times.byte_millicycles).div_ceil(1000)
    }

    /// How many links there are.
    pub(super) fn count(&self) -> usize {
        self.free.len()
    }

    /// Takes a message that is ready to go.
    #[inline(always)]
    pub(super) fn carry(&mut self, (from, to): (usize, usize), ready: u64, bytes: u64) -> Passage {
        let pair = self.pair(from, to);
        let way = self.ways.of(pair);
        // It waits for the link that is free last, the first of several.
        let (mut starts, mut last) = (ready, None);
        for &link in way {
            let free = self.free[link as usize];
            if free > starts {
                (starts, last) = (free, Some(link));
            }
        }
        if let Some(link) = last {
            self.waited[link as usize] += Cycles(starts - ready);
        }
        let held = self.holds(bytes);
        let free = starts + held;
        way.iter().for_each(|&link| self.free[link as usize] = free);
        let arrives = free + self.way_after(way.len() as u64, bytes);
        self.carried[pair].add(Carried { messages: 1, bytes, held });
        Passage { bus: 0, starts, free, arrives }
    }

    /// How long a message is under way from node to node if nothing is in its way.
    pub fn least_time(&self, from: usize, to: usize, bytes: u64) -> Cycles {
        Cycles(self.holds(bytes) + self.way_after(self.hops(from, to), bytes))
    }

    /// How long a message is still under way over so many links when these are free for others.
    #[inline]
    fn way_after(&self, hops: u64, bytes: u64) -> u64 {
        let set_up = if bytes > self.times.short_bytes { 0 } else { self.times.short.0 };
        set_up + self.times.hop.0 * hops.saturating_sub(1)
    }

    /// The links of a message's way, from task to task: those out of node 0 by bit, those out of node 1, ..., then the one from the
    /// host, then the one to it.
    pub fn links_between(&self, from: usize, to: usize) -> impl Iterator<Item = usize> {
        self.ways.of(self.pair(from, to)).iter().map(|&link| link as usize)
    }

    /// How long each link was busy, and with what.
    pub(super) fn stats(&self) -> Vec<LinkStats> {
        let mut carried = vec![Carried::default(); self.count()];
        for (pair, &more) in self.carried.iter().enumerate() {
            self.ways.of(pair).iter().for_each(|&link| carried[link as usize].add(more));
        }
        let between = self.count() - 2;
        let ends = |link: usize| match link {
            link if link < between => {
                let (node, bit) = (link / self.bits, link % self.bits);
                (Actor::Station(node), Actor::Station(node ^ 1 << bit))
            }
            link if link == between => (Actor::Host, Actor::Station(0)),
            _ => (Actor::Station(0), Actor::Host),
        };
        let stats = |(link, (carried, &waited)): (usize, (Carried, &Cycles))| {
            let (from, into) = ends(link);
            let busy = Cycles(carried.held);
            let messages = LinkMessages { sent: carried.messages, bytes: carried.bytes, waited };
            LinkStats { from: Some(from), into: Some(into), busy, read: busy, messages: Some(messages) }
        };
        carried.into_iter().zip(&self.waited).enumerate().map(stats).collect()
    }
}
