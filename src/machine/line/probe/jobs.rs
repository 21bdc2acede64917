//! When jobs were done, and how long each took.

use std::collections::VecDeque;

use crate::machine::line::fifo::Fifo;
use crate::machine::timeline::{Count, Timeline};
use crate::measure::Latency;
use crate::seam::{OpKind, OpStream};

/// Follows the jobs.
#[derive(Debug)]
pub struct JobLane {
    done: Timeline<Count>,
    latency: Latency,
    /// Words that the host's lines so far write to X.
    words: u64,
    /// For each line whose first word is not known to have been written: that word's number.
    first_words: VecDeque<u64>,
    /// For each job under way: the cycle in which its first word was written.
    sent: VecDeque<u64>,
    /// For each message whose job is not known to have been sent: the cycle in which its last word was read.
    back: VecDeque<u64>,
}

impl JobLane {
    pub fn new(bins: usize) -> JobLane {
        JobLane {
            done: Timeline::new(bins),
            latency: Latency::default(),
            words: 0,
            first_words: VecDeque::new(),
            sent: VecDeque::new(),
            back: VecDeque::new(),
        }
    }

    /// The host's next lines are known.
    pub fn fed(&mut self, host: &OpStream) {
        for (_, ops) in host.lines() {
            self.first_words.push_back(self.words);
            let writes = ops.iter().filter(|op| op.kind() == OpKind::WriteX);
            self.words += writes.map(|op| op.count() as u64).sum::<u64>();
        }
    }

    /// Notes when the host wrote the first words of jobs, before its FIFO forgets it.
    pub fn follow(&mut self, fifo: &Fifo) {
        while let Some(word) = self.first_words.front().copied().filter(|&word| word < fifo.words_written()) {
            self.sent.push_back(fifo.write_time(word));
            self.first_words.pop_front();
        }
        self.pair();
    }

    /// The host read the last word of the next answer in that cycle.
    pub fn returned(&mut self, cycle: u64) {
        self.done.at(cycle).0 += 1;
        self.back.push_back(cycle);
        self.pair();
    }

    /// Ends the ways of the jobs of which both ends are known. A message that left before its job came took no time.
    fn pair(&mut self) {
        while let (Some(sent), Some(back)) = (self.sent.front(), self.back.front()) {
            self.latency.add((back + 1).saturating_sub(*sent));
            self.sent.pop_front();
            self.back.pop_front();
        }
    }

    /// Jobs done in each bin of a run of `cycles` cycles, their latencies, and the width of a bin.
    pub fn finish(self, cycles: u64) -> (Vec<u64>, Latency, u64) {
        let (bins, width) = self.done.finish(cycles);
        (bins.into_iter().map(|count| count.0).collect(), self.latency, width)
    }
}
