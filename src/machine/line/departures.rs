//! When the host wrote the first word of each job: where a latency begins.

use std::collections::VecDeque;

use super::fifo::Fifo;
use crate::measure::JobSpan;
use crate::quantities::Cycles;
use crate::seam::{OpKind, OpStream};

/// Follows the host's FIFO.
#[derive(Debug, Default)]
pub(super) struct Departures {
    /// Words that the host's lines so far write to X.
    words: u64,
    /// For each line whose first word is not known to have been written: that word's number.
    first_words: VecDeque<u64>,
    /// For each job that was not taken yet: the cycle in which its first word was written.
    sent: VecDeque<u64>,
}

impl Departures {
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
    }

    /// The cycle in which the next job left, if that is known; it is told once.
    pub fn next(&mut self) -> Option<u64> {
        self.sent.pop_front()
    }

    /// Whether it is.
    pub fn is_known(&self) -> bool {
        !self.sent.is_empty()
    }

    /// The latency of a job that left in cycle `sent`, and whose answer's last word the host read in cycle `back`: both cycles count.
    /// A message that left before its job came took no time.
    pub fn latency(sent: u64, back: u64) -> Cycles {
        Cycles((back + 1).saturating_sub(sent))
    }

    /// The spans of all jobs, of which none was told before, if the last words of their answers were read in these cycles.
    pub fn spans(self, returned: &[u64]) -> Vec<JobSpan> {
        let span = |((job, sent), &back): ((u32, u64), &u64)| JobSpan {
            job,
            from: Cycles(sent.min(back + 1)),
            until: Cycles(back + 1),
        };
        (0..).zip(self.sent).zip(returned).map(span).collect()
    }
}
