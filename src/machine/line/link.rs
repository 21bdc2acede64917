//! A link between neighbours: its FIFOs, and the wires that lead to them.

use super::fifo::Fifo;
use crate::machine::FifoName;
use crate::machine::spec::{LinkRate, MachineSpec, RateCounts};
use crate::measure::Actor;
use crate::seam::Channel;

/// Who writes to a channel of a link of a row of so many cells, and who reads from it.
pub(super) fn ends(link: usize, cells: usize, channel: Channel) -> (Actor, Actor) {
    let left = link.checked_sub(1).map_or(Actor::Host, Actor::Station);
    let right = if link < cells { Actor::Station(link) } else { Actor::Host };
    if channel == Channel::Z { (right, left) } else { (left, right) }
}

/// The link into a cell, and the one out of it.
#[inline(always)]
pub(super) fn around(links: &mut [Link], cell: usize) -> (&mut Link, &mut Link) {
    let (left, right) = links.split_at_mut(cell + 1);
    (&mut left[cell], &mut right[0])
}

/// The FIFOs at both ends of a link, and the wires that lead to them.
#[derive(Debug)]
pub(super) struct Link {
    pub x: Fifo,
    pub y: Fifo,
    /// At the left end: the right cell writes to it, on a wire of its own.
    pub z: Fifo,
    rate: LinkRate,
    /// For X and Y, the first cycle in which the wire takes its next word.
    wire_free: [u64; 2],
    /// The same for the wire that leads to the left.
    wire_back_free: u64,
}

impl Link {
    /// Link number `index` of a row of so many cells: the one into that cell, or the one behind the last.
    pub fn new(spec: &MachineSpec, index: usize, cells: usize) -> Link {
        let [x, y, z] = Channel::ALL.map(|channel| {
            let reader = ends(index, cells, channel).1;
            Fifo::new(spec.fifo_words_of(FifoName { channel, reader }).0, spec.link_latency().0)
        });
        Link { x, y, z, rate: spec.link_rate(), wire_free: [0; 2], wire_back_free: 0 }
    }

    /// Cycles, of a run of `cycles` cycles, in which its wire to the right carried words: where channels have wires of their
    /// own, the busier's. What the last word takes beyond the run's end is not of the run.
    pub fn busy(&self, cycles: u64) -> u64 {
        let wire = |fifos: &[&Fifo]| {
            let words: u64 = fifos.iter().map(|fifo| fifo.words_written()).sum();
            let last_write = fifos.iter().map(|fifo| fifo.last_write()).max().unwrap_or_default();
            let last_word = self.rate.cycles_per_word.min(cycles.saturating_sub(last_write));
            words.checked_sub(1).map_or(0, |before| before * self.rate.cycles_per_word + last_word)
        };
        match self.rate.counts {
            RateCounts::Link => wire(&[&self.x, &self.y]),
            RateCounts::Channel => wire(&[&self.x]).max(wire(&[&self.y])),
        }
    }

    /// As many of these cycles as words take that were read.
    pub fn read(&self, cycles: u64) -> u64 {
        let [x, y] = [&self.x, &self.y].map(|fifo| fifo.words_read());
        let words = match self.rate.counts {
            RateCounts::Link => x + y,
            RateCounts::Channel => x.max(y),
        };
        (words * self.rate.cycles_per_word).min(self.busy(cycles))
    }

    /// The memory that its FIFOs take, in bytes.
    pub fn bytes(&self) -> u64 {
        self.x.bytes() + self.y.bytes() + self.z.bytes()
    }

    /// Cycles from the beginning of one word to that of the next.
    pub fn cycles_per_word(&self) -> u64 {
        self.rate.cycles_per_word
    }

    #[inline(always)]
    pub fn fifo(&self, channel: Channel) -> &Fifo {
        match channel {
            Channel::X => &self.x,
            Channel::Y => &self.y,
            Channel::Z => &self.z,
        }
    }

    #[inline(always)]
    pub fn fifo_mut(&mut self, channel: Channel) -> &mut Fifo {
        match channel {
            Channel::X => &mut self.x,
            Channel::Y => &mut self.y,
            Channel::Z => &mut self.z,
        }
    }

    /// Whether the wires take a word in each cycle, and so whenever the writer has one.
    #[inline(always)]
    pub fn takes_a_word_a_cycle(&self) -> bool {
        self.rate.cycles_per_word == 1
    }

    /// The first cycle in which the wire takes the next word of `channel`.
    #[inline(always)]
    pub fn wire_free(&self, channel: Channel) -> u64 {
        if channel == Channel::Z { self.wire_back_free } else { self.wire_free[channel as usize] }
    }

    /// Whether `count` words can be written in as many cycles from `at` on.
    #[inline(always)]
    pub fn can_write(&self, channel: Channel, at: u64, count: u64) -> bool {
        self.takes_a_word_a_cycle() && self.fifo(channel).can_write(at, count)
    }

    /// Writes a word in cycle `at`, in which there is room in the FIFO and the wire is free.
    #[inline(always)]
    pub fn write_one(&mut self, channel: Channel, at: u64) {
        self.fifo_mut(channel).write_one(at);
        // The writer's own clock keeps words one cycle apart.
        if !self.takes_a_word_a_cycle() {
            self.occupy_wire(channel, at);
        }
    }

    fn occupy_wire(&mut self, channel: Channel, at: u64) {
        let free = at + self.rate.cycles_per_word;
        match self.rate.counts {
            _ if channel == Channel::Z => self.wire_back_free = free,
            RateCounts::Link => self.wire_free = [free; 2],
            RateCounts::Channel => self.wire_free[channel as usize] = free,
        }
    }

    /// Brings the FIFOs' peaks up to date; see [`Fifo::follow`].
    #[inline]
    pub fn follow(&mut self) {
        self.x.follow();
        self.y.follow();
        self.z.follow();
    }
}
