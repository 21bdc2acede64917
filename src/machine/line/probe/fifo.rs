//! What a FIFO held over time: the merge of the two rising sequences of its write and read times.

use crate::machine::line::fifo::Fifo;
use crate::machine::timeline::{Timeline, histogram};
use crate::measure::{FifoBin, FifoProfile};
use crate::quantities::{Cycles, Words};

/// Follows one FIFO.
#[derive(Debug)]
pub struct FifoLane {
    tally: Tally,
    cursor: FifoCursor,
    write_run: Run,
    read_run: Run,
    both_run: Run,
    /// Whether words came and went mostly one by one.
    singly: bool,
}

/// What has been entered.
#[derive(Debug)]
struct Tally {
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
struct FifoCursor {
    /// Writes and reads before these have been followed.
    writes: u64,
    reads: u64,
    /// The first cycle that has not been entered yet; the FIFO holds `writes - reads` words from it on.
    since: u64,
}

impl FifoLane {
    pub fn new(capacity: u64, bins: usize) -> FifoLane {
        FifoLane {
            tally: Tally {
                timeline: Timeline::new(bins),
                held: vec![0; capacity as usize + 1],
                passed: vec![0; capacity as usize + 1],
                capacity,
            },
            cursor: FifoCursor::default(),
            write_run: Run { usual: 1 },
            read_run: Run { usual: 1 },
            both_run: Run { usual: 1 },
            singly: false,
        }
    }

    /// Goes on if the FIFO may forget times before the next call. To be called after every stretch of reads and after every stretch
    /// of writes.
    #[inline]
    pub fn follow(&mut self, fifo: &Fifo) {
        if fifo.may_forget(self.cursor.writes.min(self.cursor.reads)) {
            self.go_on(fifo);
        }
    }

    /// Goes on as far as both sequences are known.
    fn go_on(&mut self, fifo: &Fifo) {
        let before = self.cursor;
        let steps = if self.singly { self.step_on::<true>(fifo) } else { self.step_on::<false>(fifo) };
        let moved = self.cursor.writes - before.writes;
        self.singly = moved < 2 * steps;
    }

    /// Goes on as far as both sequences are known, and expects words to come and go one by one, or not to: all the same to what is entered.
    /// Returns how many messages, or parts of such, it was.
    fn step_on<const SINGLY: bool>(&mut self, fifo: &Fifo) -> u64 {
        let mut steps = 0;
        let FifoLane { tally, write_run, read_run, both_run, .. } = self;
        let (written, read) = (fifo.words_written(), fifo.words_read());
        let mut cursor = self.cursor;
        while cursor.writes < written && cursor.reads < read {
            steps += 1;
            let (write, read_in) = (fifo.write_time(cursor.writes), fifo.read_time(cursor.reads));
            let (writes, reads) = (written - cursor.writes, read - cursor.reads);
            // As times rise, words come one a cycle if the last of them comes as many cycles later.
            let FifoCursor { writes: first_in, reads: first_out, .. } = cursor;
            let writes_on = |count| fifo.write_time(first_in + count - 1) == write + count - 1;
            let reads_on = |count| fifo.read_time(first_out + count - 1) == read_in + count - 1;
            if write < read_in {
                // Mostly a message comes in, and one goes out before the next comes in.
                let count = write_run.usual;
                if SINGLY && let Some(then) = cursor.swing_singly(true, tally, fifo) {
                    steps += then.writes - cursor.writes;
                    cursor = then;
                    continue;
                }
                let passes = count < writes && count <= reads && writes_on(count) && reads_on(count);
                if passes && fifo.write_time(cursor.writes + count) >= read_in + count {
                    let apart = count.min(read_in - write);
                    if cursor.swing(tally, (write, apart), read_in.max(write + count), cursor.level() + apart) {
                        cursor.skip(count);
                        continue;
                    }
                }
                let count = write_run.length(writes, writes_on).min(read_in - write);
                cursor.rise(tally, write, count);
            } else if read_in < write {
                let count = read_run.usual;
                if SINGLY && let Some(then) = cursor.swing_singly(false, tally, fifo) {
                    steps += then.writes - cursor.writes;
                    cursor = then;
                    continue;
                }
                let passes = count < reads && count <= writes && writes_on(count) && reads_on(count);
                if passes && fifo.read_time(cursor.reads + count) >= write + count {
                    let apart = count.min(write - read_in);
                    if cursor.swing(tally, (read_in, apart), write.max(read_in + count), cursor.level() - apart) {
                        cursor.skip(count);
                        continue;
                    }
                }
                let count = read_run.length(reads, reads_on).min(write - read_in);
                cursor.fall(tally, read_in, count);
            } else {
                // A word comes and a word goes: nothing changes, for as long as both go on.
                cursor.skip(both_run.length(writes.min(reads), |count| writes_on(count) && reads_on(count)));
            }
        }
        self.cursor = cursor;
        steps
    }

    /// What the FIFO held in a run of `cycles` cycles.
    pub fn finish(mut self, fifo: &Fifo, cycles: u64) -> FifoProfile {
        self.go_on(fifo);
        let FifoLane { mut tally, mut cursor, .. } = self;
        while cursor.writes < fifo.words_written() {
            cursor.rise(&mut tally, fifo.write_time(cursor.writes).min(cycles), 1);
        }
        while cursor.reads < fifo.words_read() {
            cursor.fall(&mut tally, fifo.read_time(cursor.reads).min(cycles), 1);
        }
        cursor.hold_until(&mut tally, cycles);
        let (histogram, step) = tally.histogram();
        FifoProfile { bins: tally.timeline.finish(cycles).0, histogram, step }
    }
}

impl FifoCursor {
    fn level(&self) -> u64 {
        self.writes - self.reads
    }

    /// A message comes in and one goes out, one word a cycle: the occupancy goes to `far` by one a cycle, for `apart` cycles
    /// from `start` on, and back likewise from `turn` on. This is the way of nearly all words. False, and nothing is
    /// done, if it must be followed step by step.
    #[inline(always)]
    fn swing(&mut self, tally: &mut Tally, (start, apart): (u64, u64), turn: u64, far: u64) -> bool {
        let done = self.since < start && tally.swing((self.level(), far), self.since, (start, apart), turn);
        if done {
            self.since = turn + apart - 1;
        }
        done
    }

    /// One word comes in and one goes out before the next comes in (`is_up`), or the other way round, again and again: the way of a
    /// pipeline's candidates. Goes on as long as it is so in the bin under way, and tells where it then is. `None`, and nothing is
    /// done, if it is not so. Kept apart, so that the cursor stays in registers.
    #[inline(never)]
    fn swing_singly(mut self, is_up: bool, tally: &mut Tally, fifo: &Fifo) -> Option<FifoCursor> {
        let near = self.level();
        let (free_from, ready_at) = fifo.known_from(self.reads, near);
        let (reads, writes) = ((free_from, 1), (ready_at, fifo.latency()));
        let (there, back, far) = if is_up { (writes, reads, near + 1) } else { (reads, writes, near - 1) };
        let (swings, since, [near_for, far_for]) = swings_of_one(there, back, self.since, tally.timeline.end());
        if swings == 0 {
            return None;
        }
        tally.hold(near, self.since, self.since + near_for);
        tally.hold(far, self.since, self.since + far_for);
        self.skip(swings);
        self.since = since;
        Some(self)
    }

    /// So many words come and as many go, each in the same cycle.
    #[inline(always)]
    fn skip(&mut self, words: u64) {
        self.writes += words;
        self.reads += words;
    }

    /// `count` words are written, one a cycle, the first in cycle `at`.
    #[inline(always)]
    fn rise(&mut self, tally: &mut Tally, at: u64, count: u64) {
        let held = self.hold_until(tally, at);
        self.writes += count;
        if count > 1 {
            self.slope(tally, held + 1, count - 1, |passed| held + 1 + passed);
        }
    }

    /// `count` words are read, one a cycle, the first in cycle `at`.
    #[inline(always)]
    fn fall(&mut self, tally: &mut Tally, at: u64, count: u64) {
        let held = self.hold_until(tally, at);
        self.reads += count;
        if count > 1 {
            self.slope(tally, held + 1 - count, count - 1, |passed| held - 1 - passed);
        }
    }

    /// The occupancy stays as it is up to, and without, cycle `until`. Returns it.
    #[inline(always)]
    fn hold_until(&mut self, tally: &mut Tally, until: u64) -> u64 {
        let occupancy = self.level();
        let from = std::mem::replace(&mut self.since, until);
        if from < until {
            tally.hold(occupancy, from, until);
        }
        occupancy
    }

    /// For `count` cycles, the occupancy changes by one a cycle and is never that of a full FIFO: `level` tells it from the
    /// cycles passed, `lowest` is the lowest.
    #[inline(always)]
    fn slope(&mut self, tally: &mut Tally, lowest: u64, count: u64, level: impl Fn(u64) -> u64) {
        let from = self.since;
        self.since += count;
        tally.slope(lowest, from, self.since, level);
    }
}

impl Tally {
    /// Cycles by occupancy, and how many occupancies share an entry.
    fn histogram(&self) -> (Vec<Cycles>, Words) {
        let mut passing = 0u64;
        let cycles = self.held.iter().zip(&self.passed).map(|(held, passed)| {
            passing = passing.wrapping_add(*passed);
            held + passing
        });
        let cycles: Vec<u64> = cycles.collect();
        histogram(&cycles)
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

    /// See [`FifoCursor::swing`]: the occupancy was `near` from cycle `since` on. False if that spans bins.
    #[inline(always)]
    fn swing(&mut self, (near, far): (u64, u64), since: u64, (start, apart): (u64, u64), turn: u64) -> bool {
        let there = start + apart - 1;
        let Some(bin) = self.timeline.within(turn + apart - 1) else { return false };
        let (near_for, far_for) = (start - since, turn - there);
        self.held[near as usize] += near_for;
        self.held[far as usize] += far_for;
        let ((low, _), (high, high_for)) =
            if near < far { ((near, near_for), (far, far_for)) } else { ((far, far_for), (near, near_for)) };
        bin.min = bin.min.min(Words(low));
        bin.max = bin.max.max(Words(high));
        bin.full += Cycles(if high == self.capacity { high_for } else { 0 });
        // On the way and on the way back, each occupancy between them is passed once: on average, half of both.
        let between = apart - 1;
        bin.word_cycles +=
            u128::from(near) * u128::from(near_for + between) + u128::from(far) * u128::from(far_for + between);
        if between > 0 {
            self.pass(near.min(far) + 1, between, 2);
        }
        true
    }

    /// `count` occupancies from the lowest on were passed, so many times.
    #[inline(always)]
    fn pass(&mut self, lowest: u64, count: u64, times: u64) {
        let past = (lowest + count) as usize;
        self.passed[lowest as usize] = self.passed[lowest as usize].wrapping_add(times);
        self.passed[past] = self.passed[past].wrapping_sub(times);
    }

    /// Another one in each of the cycles `from..until`; see [`FifoCursor::slope`].
    #[inline(always)]
    fn slope(&mut self, lowest: u64, from: u64, until: u64, level: impl Fn(u64) -> u64) {
        let count = until - from;
        self.pass(lowest, count, 1);
        match self.timeline.within(until) {
            Some(bin) => bin.pass(level(0), level(count - 1), count),
            None => self.timeline.cut(from, until, |bin, start, end| {
                bin.pass(level(start - from), level(end - 1 - from), end - start);
            }),
        }
    }
}

/// How often one thing happens and another after it, before the first happens again: at times in rows, each of which tells them so many
/// cycles late; after cycle `since`, and in cycles up to `end`. Returns also the cycle of the last, and for how long it was as before the
/// one, and as before the other.
#[inline]
fn swings_of_one(
    (there, there_late): (&[u64], u64),
    (back, back_late): (&[u64], u64),
    since: u64,
    end: u64,
) -> (u64, u64, [u64; 2]) {
    let (mut swings, mut last, mut far_for) = (0, since, 0);
    for (pair, back) in there.windows(2).zip(back) {
        let (start, turn, next) = (pair[0] - there_late, back - back_late, pair[1] - there_late);
        if last >= start || start >= turn || turn >= next || turn > end {
            break;
        }
        far_for += turn - start;
        last = turn;
        swings += 1;
    }
    (swings, last, [last - since - far_for, far_for])
}

impl FifoBin {
    /// What the FIFO holds goes from one level to another, by one a cycle, both included.
    #[inline(always)]
    fn pass(&mut self, from: u64, to: u64, cycles: u64) {
        self.min = self.min.min(Words(from.min(to)));
        self.max = self.max.max(Words(from.max(to)));
        self.word_cycles += (from + to) as u128 * cycles as u128 / 2;
    }
}

/// How many words come one a cycle; mostly as many as the last time, as messages are of a few lengths.
#[derive(Clone, Copy, Debug)]
struct Run {
    usual: u64,
}

impl Run {
    /// For how many words, at most `most`, `steady` holds: that so many come one a cycle.
    #[inline(always)]
    fn length(&mut self, most: u64, steady: impl Fn(u64) -> bool) -> u64 {
        let steady = |count: u64| count <= most && steady(count);
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
