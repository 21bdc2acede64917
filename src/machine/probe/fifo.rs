//! What a FIFO held over time: the merge of the two rising sequences of its write and read times.

use super::timeline::{Bin, Timeline};
use crate::machine::fifo::Fifo;
use crate::machine::profile::{FifoBin, FifoProfile};
use crate::machine::units::{Cycles, Words};

/// A histogram has about as many entries at the most; deeper FIFOs let occupancies share them.
const MOST_ENTRIES: u64 = 1024;

/// Follows one FIFO.
#[derive(Debug)]
pub struct FifoLane {
    timeline: Timeline<FifoBin>,
    histogram: Vec<u64>,
    /// Occupancies that share an entry of the histogram, as a power of two.
    step: u32,
    capacity: u64,
    /// Writes and reads before these have been followed.
    writes: u64,
    reads: u64,
    /// The first cycle that has not been entered yet; the FIFO holds `writes - reads` words from it on.
    since: u64,
}

impl Default for FifoBin {
    fn default() -> FifoBin {
        FifoBin { min: Words(u64::MAX), max: Words(0), word_cycles: 0, full: Cycles(0) }
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

impl FifoLane {
    pub fn new(capacity: u64, bins: usize) -> FifoLane {
        let step = (capacity / MOST_ENTRIES + 1).next_power_of_two().ilog2();
        FifoLane {
            timeline: Timeline::new(bins),
            histogram: vec![0; (capacity >> step) as usize + 1],
            step,
            capacity,
            writes: 0,
            reads: 0,
            since: 0,
        }
    }

    /// Goes on as far as both sequences are known. To be called after every stretch of reads and after every stretch of
    /// writes, before the FIFO forgets their times.
    pub fn follow(&mut self, fifo: &Fifo) {
        let (written, read) = (fifo.words_written(), fifo.words_read());
        while self.writes < written && self.reads < read {
            let (write, read) = (fifo.write_time(self.writes), fifo.read_time(self.reads));
            self.hold_until(write.min(read));
            self.writes += (write <= read) as u64;
            self.reads += (read <= write) as u64;
        }
    }

    /// What the FIFO held in a run of `cycles` cycles.
    pub fn finish(mut self, fifo: &Fifo, name: String, cycles: u64) -> FifoProfile {
        self.follow(fifo);
        while self.writes < fifo.words_written() {
            self.hold_until(fifo.write_time(self.writes));
            self.writes += 1;
        }
        while self.reads < fifo.words_read() {
            self.hold_until(fifo.read_time(self.reads));
            self.reads += 1;
        }
        self.hold_until(cycles);
        FifoProfile {
            name,
            capacity: Words(self.capacity),
            bins: self.timeline.finish(cycles).0,
            histogram: self.histogram.into_iter().map(Cycles).collect(),
            step: Words(1 << self.step),
        }
    }

    /// The occupancy stays as it is up to, and without, cycle `until`.
    #[inline]
    fn hold_until(&mut self, until: u64) {
        let occupancy = self.writes - self.reads;
        self.histogram[(occupancy >> self.step) as usize] += until - self.since;
        let full = occupancy == self.capacity;
        self.timeline.for_each(self.since, until, |bin, cycles| {
            bin.min = bin.min.min(Words(occupancy));
            bin.max = bin.max.max(Words(occupancy));
            bin.word_cycles += occupancy * cycles;
            bin.full += Cycles(if full { cycles } else { 0 });
        });
        self.since = until;
    }
}
