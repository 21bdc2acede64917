//! When the words of one FIFO were written and read, and whose they were.

use super::Window;
use super::owners::Owners;
use super::passages::Passages;
use crate::machine::line::fifo::Fifo;
use crate::measure::FifoLevels;
use crate::quantities::{Cycles, Words};

/// The writes and the reads of one FIFO.
#[derive(Clone, Debug, Default)]
pub struct WordTimes {
    writes: Times,
    reads: Times,
    pub passages: Passages,
    pub owners: Owners,
}

/// The times of one of the two.
#[derive(Clone, Debug, Default)]
struct Times {
    /// How many words lie before the window.
    before: u64,
    /// The times of those inside.
    inside: Vec<u64>,
    /// Words before this one have been looked at.
    seen: u64,
}

impl WordTimes {
    /// The writer's next ops write so many words, for a job or for none.
    pub fn fed(&mut self, job: Option<u32>, words: u64) {
        if !self.passages.is_over() {
            self.owners.fed(job, words);
        }
        self.passages.fed(job, words);
    }

    /// Notes the times that have become known, before the FIFO forgets them. Returns how many lie in the window.
    pub fn follow(&mut self, fifo: &Fifo, window: Window) -> usize {
        let before = self.writes.inside.len() + self.reads.inside.len();
        self.writes.follow(fifo.words_written(), |word| fifo.write_time(word), window);
        self.reads.follow(fifo.words_read(), |word| fifo.read_time(word), window);
        self.passages.follow(fifo, window);
        self.owners.forget_before(self.reads.before);
        self.writes.inside.len() + self.reads.inside.len() - before
    }

    /// The times that are held.
    pub fn times(&self) -> impl Iterator<Item = u64> {
        self.writes.inside.iter().chain(&self.reads.inside).copied()
    }

    /// Drops the times from cycle `end` on.
    pub fn forget_from(&mut self, end: u64) {
        for times in [&mut self.writes, &mut self.reads] {
            times.inside.truncate(times.inside.partition_point(|&time| time < end));
        }
        self.passages.forget_from(end);
    }

    /// The FIFO's levels and jobs in its final window.
    pub fn finish(mut self, window: Window) -> FifoLevels {
        self.forget_from(window.until);
        let mut level = self.writes.before - self.reads.before;
        let mut levels = vec![(Cycles(window.from), Words(level))];
        let all = level + self.writes.inside.len() as u64;
        let mut writes = self.writes.inside.iter().copied().peekable();
        let mut reads = self.reads.inside.iter().copied().peekable();
        while let Some(now) = [writes.peek(), reads.peek()].into_iter().flatten().min().copied() {
            level += writes.next_if_eq(&now).is_some() as u64;
            level -= reads.next_if_eq(&now).is_some() as u64;
            let entry = (Cycles(now), Words(level));
            match levels.last_mut() {
                Some(last) if last.0 == entry.0 => *last = entry,
                Some(last) if last.1 == entry.1 => {}
                _ => levels.push(entry),
            }
        }
        levels.truncate(if window.from < window.until { levels.len() } else { 0 });
        FifoLevels {
            levels,
            jobs: self.passages.into_spans(window),
            words: self.owners.into_runs(self.reads.before, all),
            writes: self.writes.inside.into_iter().map(Cycles).collect(),
            reads: self.reads.inside.into_iter().map(Cycles).collect(),
        }
    }
}

impl Times {
    fn follow(&mut self, count: u64, time: impl Fn(u64) -> u64, window: Window) {
        if self.seen == count {
            return;
        }
        // Times rise: most often all of them lie before the window, or all behind it.
        if time(count - 1) < window.from {
            self.before = count;
        } else if time(self.seen) < window.until {
            let times = (self.seen..count).map(time);
            let (before, inside) = (&mut self.before, &mut self.inside);
            for time in times.take_while(|&time| time < window.until) {
                if time < window.from { *before += 1 } else { inside.push(time) }
            }
        }
        self.seen = count;
    }
}
