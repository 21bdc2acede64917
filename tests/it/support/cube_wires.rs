//! What the judges of a hypercube share: its links, as the times until which they are taken, and what comes out of a run.

use std::collections::BTreeMap;

use pcs_sim::machine::Ipsc2;

/// What came out: when all was over, what each task did in each cycle, what each link did.
#[derive(Debug, Default, PartialEq)]
pub struct Ticked {
    pub cycles: u64,
    /// For each task, its states one after the other, and until when it is in each.
    pub tasks: Vec<Vec<(String, u64)>>,
    pub links: Vec<[u64; 4]>,
    /// Messages of each kind: sent, taken, bytes, links passed, cycles of processors.
    pub messages: [[u64; 5]; 4],
    pub true_end: u64,
    pub told_at: u64,
    pub probes: u64,
    pub longest_queues: Vec<usize>,
    /// The rays that waited in each cycle, summed up, and the cycles without a slot for a pixel's ray.
    pub queues: Vec<(u64, u64)>,
}

/// The links, each by its two ends: until when it is taken, and what it has done. The host is the number behind the nodes.
pub struct Wires<'a> {
    machine: &'a Ipsc2,
    links: BTreeMap<(usize, usize), (u64, [u64; 4])>,
}

impl<'a> Wires<'a> {
    pub fn new(machine: &'a Ipsc2) -> Wires<'a> {
        Wires { machine, links: BTreeMap::new() }
    }

    /// What a processor spends on a message.
    pub fn processor(&self, bytes: u64) -> u64 {
        let messages = &self.machine.messages;
        if bytes > messages.short_bytes { messages.long.0 } else { messages.short.0 }
    }

    /// The links of a way.
    pub fn way(&self, from: usize, to: usize) -> Vec<(usize, usize)> {
        let host = self.machine.nodes;
        let mut way = Vec::new();
        let mut at = from;
        if from == host {
            way.push((host, 0));
            at = 0;
        }
        let end = if to == host { 0 } else { to };
        for bit in 0..8 {
            if (at ^ end) & (1 << bit) != 0 {
                way.push((at, at ^ (1 << bit)));
                at ^= 1 << bit;
            }
        }
        if to == host {
            way.push((0, host));
        }
        way
    }

    /// Takes the links for a message that is ready now, and tells when it arrives.
    pub fn carry(&mut self, from: usize, to: usize, bytes: u64, now: u64) -> u64 {
        let wires = self.machine.wires;
        let is_long = bytes > wires.short_bytes;
        let long = (bytes * wires.byte_millicycles).div_ceil(1000);
        let holds = long + if is_long { wires.long.0 } else { 0 };
        let way = self.way(from, to);
        let free = |link: &(usize, usize)| self.links.get(link).map_or(0, |link| link.0);
        let start = way.iter().map(free).max().unwrap_or(0).max(now);
        // Who waits, waits for the first of those that are taken longest.
        if let Some(link) = way.iter().find(|link| start > now && free(link) == start).copied() {
            self.links.entry(link).or_default().1[3] += start - now;
        }
        for link in &way {
            let (until, done) = self.links.entry(*link).or_default();
            *until = start + holds;
            [holds, 1, bytes].iter().zip(done).for_each(|(more, done)| *done += more);
        }
        let set_up = if is_long { wires.long.0 } else { wires.short.0 };
        start + set_up + long + wires.hop.0 * (way.len() as u64).saturating_sub(1)
    }

    /// For how long each link was taken, its messages, their bytes, and for how long they waited for it.
    pub fn taken(&self) -> Vec<[u64; 4]> {
        let host = self.machine.nodes;
        let bits = host.next_power_of_two().ilog2() as usize;
        let between = (0..1usize << bits).flat_map(|node| (0..bits).map(move |bit| (node, node ^ (1 << bit))));
        between.chain([(host, 0), (0, host)]).map(|link| self.links.get(&link).map_or([0; 4], |link| link.1)).collect()
    }
}
