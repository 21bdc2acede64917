//! A FIFO of timed words, and what is counted on it.

use crate::measure::FifoStats;
use crate::quantities::{Cycles, Words};

/// One FIFO: the times of the words that passed through it, as far back as they still matter, and its statistics.
///
/// Contract: words are written in rising cycles, at most one a cycle, and read likewise; a word is read no earlier than
/// its write plus the latency, and written no earlier than the cycle after the read that freed its slot.
///
/// How long words are inside, and how long it is empty or full, is counted as they move, a burst at once; how high the FIFO rose is
/// told afterwards by the times that are noted of them, many words at once ([`Fifo::follow`]).
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
    /// Sums of all read and of all write times: their difference is the time that words spent inside. A deep FIFO in a long
    /// run holds more than 2^64 words times cycles.
    read_times: u128,
    write_times: u128,
    /// Cycles at whose end nothing was inside, before the last write whose word was read.
    empty: u64,
    last_read: u64,
    /// Cycles at whose end there was no room, before the last write.
    full: u64,
    /// The cycle after the last write; 0 before the first.
    after_last_write: u64,
    peak: Peak,
    /// How many words may be read before the peak must be brought up to date.
    unheeded: u64,
    /// Whether the peak counts a word that is read in the cycle in which another is written: these two need a place each.
    counts_places: bool,
}

/// How high the FIFO rose.
#[derive(Clone, Copy, Debug, Default)]
struct Peak {
    /// All reads before that of this word have been looked at, unless the maximum is the capacity.
    words: u64,
    max: u64,
}

/// Words that are looked at together for the maximum: enough for vector instructions, few enough that one that raises it
/// does not make many be looked at again.
const MAX_STRETCH: usize = 64;

/// The fewest words that are remembered. More than a shallow FIFO holds, so that there, too, many are counted at once.
const LEAST_RING: u64 = 256;

/// A ring's length is a power of two.
#[inline(always)]
fn slot(word: u64, ring: &[u64]) -> usize {
    word as usize & (ring.len() - 1)
}

impl Fifo {
    pub fn new(capacity: u64, latency: u64) -> Fifo {
        // Twice as many as it holds, so that the peak is looked for seldom even if few words move in a stretch.
        let ring = capacity.saturating_mul(2).max(LEAST_RING).next_power_of_two() as usize;
        Fifo {
            capacity,
            latency,
            ready_at: vec![0; ring].into(),
            free_from: vec![0; ring].into(),
            written: 0,
            read: 0,
            read_times: 0,
            write_times: 0,
            empty: 0,
            last_read: 0,
            full: 0,
            after_last_write: 0,
            peak: Peak::default(),
            unheeded: ring as u64 - capacity,
            counts_places: false,
        }
    }

    /// One that holds all there is, up to so many words: to be [made deep enough](Fifo::make_room) before words are written.
    pub fn growing(latency: u64) -> Fifo {
        Fifo { counts_places: true, ..Fifo::new(1, latency) }
    }

    /// Makes it deep enough for no word to wait until word `until`, if the writer stands at cycle `clock`; but no deeper than
    /// `most`, a power of two.
    pub fn make_room(&mut self, until: u64, clock: u64, most: u64) {
        let oldest = self.written.saturating_sub(self.capacity);
        let (mut free, mut held) = (oldest, self.read);
        while free < held {
            let middle = free + (held - free) / 2;
            // What was forgotten as it got deeper is free from cycle 0 on.
            if self.free_from[slot(middle, &self.free_from)] <= clock { free = middle + 1 } else { held = middle }
        }
        let needed = (until - free).next_power_of_two().min(most);
        if needed <= self.capacity {
            return;
        }
        self.peak = self.peak();
        // No word that is written has needed more places than there were; the next ones may.
        let is_highest = self.peak.max == self.capacity;
        self.peak.words = if is_highest { oldest } else { self.peak.words.min(oldest) };
        let moved = |from: &[u64], until: u64| {
            let mut ring: Box<[u64]> = vec![0; needed.max(LEAST_RING) as usize].into();
            for word in oldest..until {
                let place = slot(word, &ring);
                ring[place] = from[slot(word, from)];
            }
            ring
        };
        (self.ready_at, self.free_from) = (moved(&self.ready_at, self.written), moved(&self.free_from, self.read));
        self.capacity = needed;
        self.unheeded = self.heeds_until();
    }

    /// The places that were needed at once: with as many, no word has to wait for one.
    pub fn places(&self) -> u64 {
        self.peak().max.max(self.fill()).max(1)
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
        self.after_last_write.saturating_sub(1)
    }

    /// The cycle of the last read; 0 before the first.
    pub fn last_read(&self) -> u64 {
        self.last_read
    }

    /// The first cycle after the last read and the last write so far.
    pub fn known_until(&self) -> u64 {
        let first_unread = if self.read > 0 { self.last_read + 1 } else { 0 };
        first_unread.max(self.after_last_write)
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

    /// Writes a word in cycle `at`, in which there is [room](Fifo::room).
    #[inline(always)]
    pub fn write_one(&mut self, at: u64) {
        self.ready_at[slot(self.written, &self.ready_at)] = at + self.latency;
        self.count_writes(at, 1);
    }

    /// Reads a word in cycle `at`, in which it is [ready](Fifo::ready): since cycle `ready`.
    #[inline(always)]
    pub fn read_one(&mut self, at: u64, ready: u64) {
        self.free_from[slot(self.read, &self.free_from)] = at + 1;
        self.count_reads(at, 1, ready - self.latency);
    }

    /// Writes `count` words, one a cycle, the first in cycle `at`; [`Fifo::can_write`] has allowed it.
    #[inline(always)]
    pub fn write_burst(&mut self, at: u64, count: u64) {
        note_run(&mut self.ready_at, self.written, count, at + self.latency);
        self.count_writes(at, count);
    }

    /// Reads `count` words, one a cycle, the first in cycle `at`; [`Fifo::can_read`] has allowed it.
    #[inline(always)]
    pub fn read_burst(&mut self, at: u64, count: u64) {
        let written_in = self.write_time(self.read);
        note_run(&mut self.free_from, self.read, count, at + 1);
        self.count_reads(at, count, written_in);
    }

    #[inline(always)]
    fn count_writes(&mut self, at: u64, count: u64) {
        // Full from the write before this one until the read that made room for this word. Inside a burst there is room at once, so
        // only its first can end such a time.
        self.full += self.slot_free_from(self.written).saturating_sub(self.after_last_write);
        self.after_last_write = at + count;
        self.write_times += sum_of_run(at, count);
        self.written += count;
    }

    #[inline(always)]
    fn count_reads(&mut self, at: u64, count: u64, written_in: u64) {
        // Empty from the read before this one until the write of this word. Inside a burst each word is there at once, so only
        // its first can end such a time.
        self.empty += written_in.saturating_sub(self.last_read);
        self.read_times += sum_of_run(at, count);
        self.read += count;
        self.last_read = at + count - 1;
    }

    /// Brings the peak up to date before the rings forget a word that it has not looked at. To be called after every stretch of
    /// reads and after every stretch of writes.
    #[inline(always)]
    pub fn follow(&mut self) {
        if self.read > self.unheeded {
            self.heed();
        }
    }

    #[cold]
    #[inline(never)]
    fn heed(&mut self) {
        self.peak = self.peak();
        self.unheeded = self.heeds_until();
    }

    /// How many words may be read before the peak is in want of times that may be lost.
    fn heeds_until(&self) -> u64 {
        if self.peak.max == self.capacity { u64::MAX } else { self.keeps_until(self.peak.words) }
    }

    /// How many words may be read before the times of a word may be lost in the next stretch of reads or of writes: as far as words
    /// can be written, and read, in it.
    #[inline]
    fn keeps_until(&self, word: u64) -> u64 {
        word + self.ready_at.len() as u64 - self.capacity
    }

    /// Whether the times of a word may be lost in the next stretch of reads or of writes.
    #[inline]
    pub fn may_forget(&self, word: u64) -> bool {
        self.read > self.keeps_until(word)
    }

    /// The maximum among the words whose times are known.
    ///
    /// The occupancy falls only by reads, so its maximum stands just before one: before the read of word i it is above m
    /// if word i + m was written in an earlier cycle.
    fn peak(&self) -> Peak {
        let mut peak = self.peak;
        while peak.max < self.capacity {
            let (reads, writes) = self.known_from(peak.words, peak.max);
            let stretch = reads.len().min(MAX_STRETCH);
            if stretch == 0 {
                return peak;
            }
            // Written before read: ready_at - latency < free_from - 1, here as the sign of the difference; where places are
            // counted, no later than read.
            let offset = u64::from(!self.counts_places).wrapping_sub(self.latency);
            let above = |(write, read): (&u64, &u64)| write.wrapping_add(offset).wrapping_sub(*read) as i64;
            let (reads, writes) = (&reads[..stretch], &writes[..stretch]);
            if writes.iter().zip(reads).map(above).fold(0, |any, sign| any | sign) >= 0 {
                peak.words += stretch as u64;
            } else if let Some(first) = writes.iter().zip(reads).position(|pair| above(pair) < 0) {
                peak.words += first as u64;
                peak.max += 1;
            }
        }
        peak
    }

    /// Of words from `word` on, as far as they lie in a row: from which cycle on each one's slot can be written again, the first after
    /// its read; and from which on the word so many places `behind` it can be read, the latency after its write.
    pub fn known_from(&self, word: u64, behind: u64) -> (&[u64], &[u64]) {
        let (early, late) = (slot(word, &self.free_from), slot(word + behind, &self.ready_at));
        let known = self.read.min(self.written.saturating_sub(behind));
        let length = known.saturating_sub(word) as usize;
        let stretch = length.min(self.free_from.len() - early.max(late));
        (&self.free_from[early..early + stretch], &self.ready_at[late..late + stretch])
    }

    /// The statistics of a run that ended after `cycles` cycles: none of its words was written or read in a later one, which
    /// [`Array::until`](super::Array::until) sees to.
    pub fn stats(&self, cycles: u64) -> FifoStats {
        let peak = self.peak();
        let unread = u128::from(self.fill()) * u128::from(cycles);
        let filled_in = if self.fill() == 0 { cycles } else { self.write_time(self.read) };
        let full = match self.fill() == self.capacity {
            true => cycles - self.last_write(),
            false => self.slot_free_from(self.written).saturating_sub(self.after_last_write),
        };
        FifoStats {
            words: Words(self.written),
            max: Words(peak.max.max(self.fill())),
            word_cycles: self.read_times + unread - self.write_times,
            full: Cycles(self.full + full),
            empty: Cycles(self.empty + filled_in.saturating_sub(self.last_read)),
            enough: None,
        }
    }
}

/// Notes rising times of `count` words, one a cycle.
#[inline(always)]
fn note_run(ring: &mut [u64], word: u64, count: u64, first: u64) {
    let start = slot(word, ring);
    match ring.get_mut(start..start + count as usize) {
        Some(row) => row.iter_mut().zip(first..).for_each(|(time, at)| *time = at),
        // Around the end.
        None => (0..count).for_each(|k| {
            let place = slot(word + k, ring);
            ring[place] = first + k;
        }),
    }
}

/// at + (at + 1) + ... of `count` terms.
#[inline(always)]
fn sum_of_run(at: u64, count: u64) -> u128 {
    u128::from(at) * u128::from(count) + u128::from(count * (count - 1) / 2)
}
