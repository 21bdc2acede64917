//! A FIFO of timed words, and what is counted on it.

use crate::measure::FifoStats;
use crate::quantities::{Cycles, Words};

/// One FIFO: the times of the words that passed through it, as far back as they still matter, and its statistics.
///
/// Contract: words are written in rising cycles, at most one a cycle, and read likewise; a word is read no earlier than
/// its write plus the latency, and written no earlier than the cycle after the read that freed its slot.
#[derive(Debug)]
pub(super) struct Fifo {
    capacity: u64,
    latency: u64,
    /// For word j, at j modulo the length: the first cycle in which it can be read.
    ready_at: Box<[u64]>,
    /// For word j, at j modulo the length: the first cycle in which its slot can be written again; 0 before it was ever
    /// read.
    free_from: Box<[u64]>,
    written: u64,
    read: u64,
    last_write: u64,
    last_read: u64,
    /// Sums of all read and of all write times: their difference is the time that words spent inside. A deep FIFO in a long
    /// run holds more than 2^64 words times cycles.
    read_times: u128,
    write_times: u128,
    full: u64,
    empty: u64,
    max: u64,
    /// All reads before this one have been looked at for `max`.
    max_scanned: u64,
}

/// Words that are looked at together for the maximum: enough for vector instructions, few enough that one that raises it
/// does not make many be looked at again.
const MAX_STRETCH: usize = 64;

/// A ring's length is a power of two.
#[inline(always)]
fn slot(word: u64, ring: &[u64]) -> usize {
    word as usize & (ring.len() - 1)
}

impl Fifo {
    pub fn new(capacity: u64, latency: u64) -> Fifo {
        let ring = capacity.next_power_of_two() as usize;
        Fifo {
            capacity,
            latency,
            ready_at: vec![0; ring].into(),
            free_from: vec![0; ring].into(),
            written: 0,
            read: 0,
            last_write: 0,
            last_read: 0,
            read_times: 0,
            write_times: 0,
            full: 0,
            empty: 0,
            max: 0,
            max_scanned: 0,
        }
    }

    pub fn capacity(&self) -> u64 {
        self.capacity
    }

    /// The memory that its words' times take, in bytes.
    pub fn bytes(&self) -> u64 {
        ((self.ready_at.len() + self.free_from.len()) * size_of::<u64>()) as u64
    }

    /// Cycles from the write of a word to its first read.
    pub fn latency(&self) -> u64 {
        self.latency
    }

    /// Words inside: written and not yet read.
    pub fn fill(&self) -> u64 {
        self.written - self.read
    }

    /// Words read so far.
    pub fn words_read(&self) -> u64 {
        self.read
    }

    /// Words written so far.
    pub fn words_written(&self) -> u64 {
        self.written
    }

    /// The cycle in which a word was written. The FIFO remembers as many words as it can hold.
    #[inline(always)]
    pub fn write_time(&self, word: u64) -> u64 {
        self.ready_at[slot(word, &self.ready_at)] - self.latency
    }

    /// The cycle in which a word was read, as far back.
    #[inline(always)]
    pub fn read_time(&self, word: u64) -> u64 {
        self.free_from[slot(word, &self.free_from)] - 1
    }

    /// The cycles of those writes for whose words a reader may yet wait that stands at cycle `clock`, the latest first.
    pub fn writes_awaited_at(&self, clock: u64) -> impl Iterator<Item = u64> + '_ {
        let unread = (self.read..self.written).rev().map(|word| self.write_time(word));
        unread.take_while(move |at| at + self.latency > clock)
    }

    /// The cycles of those reads for whose slots a writer may yet wait that stands at cycle `clock`, the latest first.
    pub fn reads_awaited_at(&self, clock: u64) -> impl Iterator<Item = u64> + '_ {
        let free = (self.written.max(self.capacity)..self.read + self.capacity).rev();
        free.map(|word| self.read_time(word - self.capacity)).take_while(move |at| at + 1 > clock)
    }

    /// The cycle of the last write; 0 before the first.
    pub fn last_write(&self) -> u64 {
        self.last_write
    }

    /// The cycle of the last read; 0 before the first.
    pub fn last_read(&self) -> u64 {
        self.last_read
    }

    /// The first cycle after the last read and the last write so far.
    pub fn known_until(&self) -> u64 {
        let first_unread = if self.read > 0 { self.last_read + 1 } else { 0 };
        let first_unwritten = if self.written > 0 { self.last_write + 1 } else { 0 };
        first_unread.max(first_unwritten)
    }

    /// The first cycle in which the next word can be read, if it is known that it will be written.
    #[inline(always)]
    pub fn ready(&self) -> Option<u64> {
        (self.read < self.written).then(|| self.ready_at[slot(self.read, &self.ready_at)])
    }

    /// The first cycle in which the next word finds room, if it is known that there will be room.
    #[inline(always)]
    pub fn room(&self) -> Option<u64> {
        (self.written < self.read + self.capacity).then(|| self.slot_free_from(self.written))
    }

    /// Whether `count` words can be read in as many cycles from `at` on. As words are written at most one a cycle, this
    /// is so if the last of them is ready in time.
    #[inline(always)]
    pub fn can_read(&self, at: u64, count: u64) -> bool {
        let last = self.read + count - 1;
        last < self.written && self.ready_at[slot(last, &self.ready_at)] < at + count
    }

    /// Whether `count` words can be written in as many cycles from `at` on; as with [`Fifo::can_read`], the last decides.
    #[inline(always)]
    pub fn can_write(&self, at: u64, count: u64) -> bool {
        let last = self.written + count - 1;
        last < self.read + self.capacity && self.slot_free_from(last) < at + count
    }

    /// When the slot that word `word` will take is free. Words of the first round find the 0 of a slot never used.
    #[inline(always)]
    fn slot_free_from(&self, word: u64) -> u64 {
        self.free_from[slot(word.wrapping_sub(self.capacity), &self.free_from)]
    }

    /// The cycle in which the next word to be read was written.
    #[inline(always)]
    fn next_written_in(&self) -> u64 {
        self.write_time(self.read)
    }

    /// Writes a word in cycle `at`. It found room from cycle `room` on, as [`Fifo::room`] told.
    #[inline(always)]
    pub fn write_one(&mut self, at: u64, room: u64) {
        self.ready_at[slot(self.written, &self.ready_at)] = at + self.latency;
        self.count_writes(at, 1, room);
    }

    /// Reads a word in cycle `at`. It was ready from cycle `ready` on, as [`Fifo::ready`] told.
    #[inline(always)]
    pub fn read_one(&mut self, at: u64, ready: u64) {
        self.free_from[slot(self.read, &self.free_from)] = at + 1;
        self.count_reads(at, 1, ready - self.latency);
    }

    /// Writes `count` words, one a cycle, the first in cycle `at`; [`Fifo::can_write`] has allowed it.
    #[inline(always)]
    pub fn write_burst(&mut self, at: u64, count: u64) {
        let room = self.slot_free_from(self.written);
        for k in 0..count {
            self.ready_at[slot(self.written + k, &self.ready_at)] = at + k + self.latency;
        }
        self.count_writes(at, count, room);
    }

    /// Reads `count` words, one a cycle, the first in cycle `at`; [`Fifo::can_read`] has allowed it.
    #[inline(always)]
    pub fn read_burst(&mut self, at: u64, count: u64) {
        let written_in = self.next_written_in();
        for k in 0..count {
            self.free_from[slot(self.read + k, &self.free_from)] = at + k + 1;
        }
        self.count_reads(at, count, written_in);
    }

    #[inline(always)]
    fn count_writes(&mut self, at: u64, count: u64, room: u64) {
        // Full from the write before this one until the read that made room. Inside a burst each word finds room at
        // once, so only its first can end such a time.
        self.full += room.saturating_sub(self.last_write + 1);
        self.write_times += sum_of_run(at, count);
        self.written += count;
        self.last_write = at + count - 1;
    }

    #[inline(always)]
    fn count_reads(&mut self, at: u64, count: u64, written_in: u64) {
        // Empty from the read before this one until the write of this word; as with `full`, only a burst's first.
        self.empty += written_in.saturating_sub(self.last_read);
        self.read_times += sum_of_run(at, count);
        self.read += count;
        self.last_read = at + count - 1;
    }

    /// Brings the maximum up to date with the words whose times are known. To be called after every stretch of reads and
    /// after every stretch of writes, before the ring forgets them.
    ///
    /// The occupancy falls only by reads, so its maximum stands just before one: before the read of word i it is above m
    /// if word i + m was written in an earlier cycle.
    pub fn track_max(&mut self) {
        while self.max < self.capacity {
            let known = self.read.min(self.written.saturating_sub(self.max));
            let early = slot(self.max_scanned, &self.free_from);
            let late = slot(self.max_scanned + self.max, &self.ready_at);
            let length = known.saturating_sub(self.max_scanned) as usize;
            let stretch = length.min(self.free_from.len() - early.max(late)).min(MAX_STRETCH);
            if stretch == 0 {
                return;
            }
            let reads = &self.free_from[early..early + stretch];
            let writes = &self.ready_at[late..late + stretch];
            // Written before read: ready_at - latency < free_from - 1, here as the sign of the difference.
            let offset = 1u64.wrapping_sub(self.latency);
            let above = |(write, read): (&u64, &u64)| write.wrapping_add(offset).wrapping_sub(*read) as i64;
            if writes.iter().zip(reads).map(above).fold(0, |any, sign| any | sign) >= 0 {
                self.max_scanned += stretch as u64;
            } else if let Some(first) = writes.iter().zip(reads).position(|pair| above(pair) < 0) {
                self.max_scanned += first as u64;
                self.max += 1;
            }
        }
    }

    /// The statistics of a run that ended after `cycles` cycles: none of its words was written or read in a later one, which
    /// [`Array::until`](super::Array::until) sees to.
    pub fn stats(&self, cycles: u64) -> FifoStats {
        let inside = self.fill();
        let unread = inside as u128 * cycles as u128;
        FifoStats {
            words: Words(self.written),
            max: Words(self.max.max(inside)),
            word_cycles: self.read_times + unread - self.write_times,
            full: Cycles(self.full_cycles(cycles)),
            empty: Cycles(self.empty_cycles(cycles)),
        }
    }

    fn full_cycles(&self, cycles: u64) -> u64 {
        let since_last_write = if self.fill() == self.capacity {
            cycles - self.last_write
        } else {
            self.slot_free_from(self.written).saturating_sub(self.last_write + 1)
        };
        self.full + since_last_write
    }

    fn empty_cycles(&self, cycles: u64) -> u64 {
        let filled_in = if self.fill() == 0 { cycles } else { self.next_written_in() };
        self.empty + filled_in.saturating_sub(self.last_read)
    }
}

/// at + (at + 1) + ... of `count` terms.
#[inline(always)]
fn sum_of_run(at: u64, count: u64) -> u128 {
    at as u128 * count as u128 + (count * (count - 1) / 2) as u128
}
