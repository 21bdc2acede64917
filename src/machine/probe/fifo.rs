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
    seen: Seen,
    place: Place,
    write_run: Run,
    read_run: Run,
}

/// What has been entered.
#[derive(Debug)]
struct Seen {
    timeline: Timeline<FifoBin>,
    /// For each occupancy, the cycles for which it was held.
    held: Vec<u64>,
    /// Of the cycles in which the occupancy was passed on the way up or down, the differences from one occupancy to the
    /// next, modulo 2^64.
    passed: Vec<u64>,
    capacity: u64,
}

/// How far a FIFO has been followed. It is copied out of the lane meanwhile, to stay in registers.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
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
        FifoLane {
            seen: Seen {
                timeline: Timeline::new(bins),
                held: vec![0; capacity as usize + 1],
                passed: vec![0; capacity as usize + 1],
                capacity,
            },
            place: Place::default(),
            write_run: Run { usual: 1 },
            read_run: Run { usual: 1 },
        }
    }

    /// Goes on as far as both sequences are known. To be called after every stretch of reads and after every stretch of
    /// writes, before the FIFO forgets their times.
    pub fn follow(&mut self, fifo: &Fifo) {
        let FifoLane { seen, write_run, read_run, .. } = self;
        let (write_time, read_time) = (|word| fifo.write_time(word), |word| fifo.read_time(word));
        let (written, read) = (fifo.words_written(), fifo.words_read());
        let mut place = self.place;
        while place.writes < written && place.reads < read {
            if place.exchange(seen, fifo, write_run.usual) {
                continue;
            }
            let (write, read_in) = (write_time(place.writes), read_time(place.reads));
            let (writes, reads) = (written - place.writes, read - place.reads);
            if write < read_in {
                let count = write_run.length(place.writes, writes.min(read_in - write), write_time);
                place.rise(seen, write, count);
            } else if read_in < write {
                let count = read_run.length(place.reads, reads.min(write - read_in), read_time);
                place.fall(seen, read_in, count);
            } else {
                // A word comes and a word goes: nothing changes, for as long as both go on.
                let count = write_run.length(place.writes, writes.min(reads), write_time);
                place.skip(read_run.length(place.reads, count, read_time));
            }
        }
        self.place = place;
    }

    /// What the FIFO held in a run of `cycles` cycles.
    pub fn finish(mut self, fifo: &Fifo, name: String, cycles: u64) -> FifoProfile {
        self.follow(fifo);
        let FifoLane { mut seen, mut place, .. } = self;
        while place.writes < fifo.words_written() {
            place.rise(&mut seen, fifo.write_time(place.writes).min(cycles), 1);
        }
        while place.reads < fifo.words_read() {
            place.fall(&mut seen, fifo.read_time(place.reads).min(cycles), 1);
        }
        place.hold_until(&mut seen, cycles);
        let (histogram, step) = seen.histogram();
        let (capacity, bins) = (Words(seen.capacity), seen.timeline.finish(cycles).0);
        FifoProfile { name, capacity, bins, histogram, step }
    }
}

impl Place {
    /// Follows the next `count` words in and the next `count` words out together, if on each side they come one a cycle and
    /// the side that begins brings no more words until the other is through. So most messages pass, each in the place of
    /// another or of itself.
    #[inline(always)]
    fn exchange(&mut self, seen: &mut Seen, fifo: &Fifo, count: u64) -> bool {
        let (next_write, next_read) = (self.writes + count, self.reads + count);
        if next_write >= fifo.words_written() || next_read >= fifo.words_read() {
            return false;
        }
        let (write, read_in) = (fifo.write_time(self.writes), fifo.read_time(self.reads));
        let (written, read) = (write + count, read_in + count);
        if fifo.write_time(next_write - 1) + 1 != written || fifo.read_time(next_read - 1) + 1 != read {
            return false;
        }
        // Where one side runs while the other does, nothing changes.
        let apart = write.abs_diff(read_in).min(count);
        if write < read_in && fifo.write_time(next_write) >= read {
            self.rise(seen, write, apart);
            self.skip(count - apart);
            self.fall(seen, written.max(read_in), apart);
        } else if read_in < write && fifo.read_time(next_read) >= written {
            self.fall(seen, read_in, apart);
            self.skip(count - apart);
            self.rise(seen, read.max(write), apart);
        } else {
            return false;
        }
        true
    }

    /// So many words come and as many go, each in the same cycle.
    #[inline(always)]
    fn skip(&mut self, words: u64) {
        self.writes += words;
        self.reads += words;
    }

    /// `count` words are written, one a cycle, the first in cycle `at`.
    #[inline(always)]
    fn rise(&mut self, seen: &mut Seen, at: u64, count: u64) {
        let held = self.hold_until(seen, at);
        self.writes += count;
        if count > 1 {
            self.slope(seen, held + 1, count - 1, |passed| held + 1 + passed);
        }
    }

    /// `count` words are read, one a cycle, the first in cycle `at`.
    #[inline(always)]
    fn fall(&mut self, seen: &mut Seen, at: u64, count: u64) {
        let held = self.hold_until(seen, at);
        self.reads += count;
        if count > 1 {
            self.slope(seen, held + 1 - count, count - 1, |passed| held - 1 - passed);
        }
    }

    /// The occupancy stays as it is up to, and without, cycle `until`. Returns it.
    #[inline(always)]
    fn hold_until(&mut self, seen: &mut Seen, until: u64) -> u64 {
        let occupancy = self.writes - self.reads;
        let from = std::mem::replace(&mut self.since, until);
        if from < until {
            seen.hold(occupancy, from, until);
        }
        occupancy
    }

    /// For `count` cycles, the occupancy changes by one a cycle and is never that of a full FIFO: `level` tells it from the
    /// cycles passed, `lowest` is the lowest.
    #[inline(always)]
    fn slope(&mut self, seen: &mut Seen, lowest: u64, count: u64, level: impl Fn(u64) -> u64) {
        let from = self.since;
        self.since += count;
        seen.slope(lowest, from, self.since, level);
    }
}

impl Seen {
    /// Cycles by occupancy, and how many occupancies share an entry.
    fn histogram(&self) -> (Vec<Cycles>, Words) {
        let step = (self.capacity / MOST_ENTRIES + 1).next_power_of_two();
        let mut passing = 0u64;
        let cycles = self.held.iter().zip(&self.passed).map(|(held, passed)| {
            passing = passing.wrapping_add(*passed);
            held + passing
        });
        let cycles: Vec<u64> = cycles.collect();
        (cycles.chunks(step as usize).map(|shared| Cycles(shared.iter().sum())).collect(), Words(step))
    }

    /// One occupancy in the cycles `from..until`.
    #[inline(always)]
    fn hold(&mut self, occupancy: u64, from: u64, until: u64) {
        self.held[occupancy as usize] += until - from;
        let full = occupancy == self.capacity;
        match self.timeline.within(until) {
            Some(bin) => bin.hold(occupancy, until - from, full),
            None => self.timeline.cut(from, until, |bin, from, to| bin.hold(occupancy, to - from, full)),
        }
    }

    /// Another one in each of the cycles `from..until`; see [`Place::slope`].
    #[inline(always)]
    fn slope(&mut self, lowest: u64, from: u64, until: u64, level: impl Fn(u64) -> u64) {
        let count = until - from;
        let past = (lowest + count) as usize;
        self.passed[lowest as usize] = self.passed[lowest as usize].wrapping_add(1);
        self.passed[past] = self.passed[past].wrapping_sub(1);
        match self.timeline.within(until) {
            Some(bin) => bin.pass(level(0), level(count - 1), count),
            None => self.timeline.cut(from, until, |bin, start, end| {
                bin.pass(level(start - from), level(end - 1 - from), end - start);
            }),
        }
    }
}

impl FifoBin {
    /// The FIFO holds so many words for some cycles.
    #[inline(always)]
    fn hold(&mut self, occupancy: u64, cycles: u64, full: bool) {
        self.min = self.min.min(Words(occupancy));
        self.max = self.max.max(Words(occupancy));
        self.word_cycles += occupancy * cycles;
        self.full += Cycles(if full { cycles } else { 0 });
    }

    /// What the FIFO holds goes from one level to another, by one a cycle, both included.
    #[inline(always)]
    fn pass(&mut self, from: u64, to: u64, cycles: u64) {
        self.min = self.min.min(Words(from.min(to)));
        self.max = self.max.max(Words(from.max(to)));
        self.word_cycles += (from + to) * cycles / 2;
    }
}

/// How many words come one a cycle; mostly as many as the last time, as messages are of a few lengths.
#[derive(Clone, Copy, Debug)]
struct Run {
    usual: u64,
}

impl Run {
    /// The number of words from `first` on, at most `most`, that come one a cycle; `time` tells each word's. As times rise,
    /// words do so if the last of them comes as many cycles later.
    #[inline(always)]
    fn length(&mut self, first: u64, most: u64, time: impl Fn(u64) -> u64) -> u64 {
        let start = time(first);
        let steady = |count: u64| count <= most && time(first + count - 1) == start + count - 1;
        if steady(self.usual) && !steady(self.usual + 1) {
            return self.usual;
        }
        let length = longest(steady);
        // One that was cut short says nothing about the next.
        if length < most {
            self.usual = length;
        }
        length
    }
}

/// The largest count for which `steady` holds, as it does for every smaller one.
fn longest(steady: impl Fn(u64) -> bool) -> u64 {
    let mut step = 1;
    while steady(2 * step) {
        step *= 2;
    }
    let mut count = step;
    while step > 1 {
        step /= 2;
        if steady(count + step) {
            count += step;
        }
    }
    count
}
