//! Simulated time in bins whose number is bounded.

use crate::measure::{FifoBin, StateTimes};
use crate::quantities::{Cycles, Words};

/// What is kept of a stretch of time.
pub trait Bin: Clone + Default {
    /// Takes in what is kept of the stretch that follows.
    fn absorb(&mut self, later: &Self);
}

impl Bin for StateTimes {
    fn absorb(&mut self, later: &StateTimes) {
        self.add(later);
    }
}

impl Bin for FifoBin {
    fn absorb(&mut self, later: &FifoBin) {
        self.min = self.min.min(later.min);
        self.max = self.max.max(later.max);
        self.word_cycles += later.word_cycles;
        self.full += later.full;
    }
}

impl FifoBin {
    /// The FIFO holds so many words for some cycles.
    #[inline(always)]
    pub(crate) fn hold(&mut self, occupancy: u64, cycles: u64, full: bool) {
        self.min = self.min.min(Words(occupancy));
        self.max = self.max.max(Words(occupancy));
        self.word_cycles += occupancy as u128 * cycles as u128;
        self.full += Cycles(if full { cycles } else { 0 });
    }
}

/// A histogram has about as many entries at the most; deeper FIFOs let occupancies share them.
const MOST_ENTRIES: u64 = 1024;

/// For how many cycles each occupancy was held, from 0 to the highest, in fewer entries where there are many; and how many share one.
pub fn histogram(cycles: &[u64]) -> (Vec<Cycles>, Words) {
    let highest = cycles.len().saturating_sub(1) as u64;
    let step = (highest / MOST_ENTRIES + 1).next_power_of_two();
    (cycles.chunks(step as usize).map(|shared| Cycles(shared.iter().sum())).collect(), Words(step))
}

/// How many of something.
#[derive(Clone, Debug, Default)]
pub struct Count(pub u64);

impl Bin for Count {
    fn absorb(&mut self, later: &Count) {
        self.0 += later.0;
    }
}

/// How many bins each of some stations has: those of a large machine have fewer.
pub fn bins_for(stations: usize) -> usize {
    (ALL_BINS / stations.next_power_of_two()).clamp(LEAST_BINS, MOST_BINS)
}

/// Bins of a run on few stations. A run that outgrows them has half as many, twice as wide.
const MOST_BINS: usize = 1024;
/// Bins of all stations together.
const ALL_BINS: usize = 1 << 15;
/// Bins of each station in the largest machines: fewer would tell nothing of a run's course.
const LEAST_BINS: usize = 16;

/// Bins of equal width over the time from cycle 0 on, entered from the first to the last. The width is a power of two and
/// doubles, pair by pair, whenever the time outgrows the bins: the memory is bounded whatever the length of the run, and
/// every bin stays exact.
#[derive(Clone, Debug)]
pub struct Timeline<B> {
    /// The bins before the one under way.
    done: Vec<B>,
    /// The bin under way.
    now: B,
    /// The first cycle after it.
    end: u64,
    /// A bin is 2^shift cycles wide.
    shift: u32,
    /// How many bins there may be.
    most: usize,
}

impl<B: Bin> Timeline<B> {
    /// At the most so many bins, an even number, each one cycle wide.
    pub fn new(most: usize) -> Timeline<B> {
        Timeline { done: Vec::with_capacity(most), now: B::default(), end: 1, shift: 0, most }
    }

    /// The bin that a cycle lies in, which is not before that of any earlier call.
    #[inline]
    pub fn at(&mut self, cycle: u64) -> &mut B {
        while cycle >= self.end {
            self.advance();
        }
        &mut self.now
    }

    /// The bin under way, if the cycles up to, and without, `to` lie in it.
    #[inline(always)]
    pub fn within(&mut self, to: u64) -> Option<&mut B> {
        (to <= self.end).then_some(&mut self.now)
    }

    /// The first cycle after the bin under way.
    pub fn end(&self) -> u64 {
        self.end
    }

    /// The bin under way, which the cycle last asked for lies in.
    pub fn under_way(&mut self) -> &mut B {
        &mut self.now
    }

    /// Cuts the cycles `from..to` where bins meet, and visits each bin with its part of them.
    #[cold]
    pub fn cut(&mut self, mut from: u64, to: u64, mut visit: impl FnMut(&mut B, u64, u64)) {
        while from < to {
            self.at(from);
            let end = self.end.min(to);
            visit(&mut self.now, from, end);
            from = end;
        }
    }

    /// Goes on to the next bin.
    #[cold]
    fn advance(&mut self) {
        self.done.push(std::mem::take(&mut self.now));
        if self.done.len() == self.most {
            self.widen();
        }
        self.end = (self.done.len() as u64 + 1) << self.shift;
    }

    fn widen(&mut self) {
        let half = self.most / 2;
        for index in 0..half {
            let mut both = self.done[2 * index].clone();
            both.absorb(&self.done[2 * index + 1]);
            self.done[index] = both;
        }
        self.done.truncate(half);
        self.shift += 1;
    }

    /// The bins of a run of `cycles` cycles, and their width: the smallest at which they hold the run.
    pub fn finish(mut self, cycles: u64) -> (Vec<B>, u64) {
        let Some(last) = cycles.checked_sub(1) else { return (Vec::new(), 1) };
        self.at(last);
        self.done.push(self.now);
        self.done.truncate((last >> self.shift) as usize + 1);
        (self.done, 1 << self.shift)
    }
}
