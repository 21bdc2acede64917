//! When the host read answers.

use std::collections::VecDeque;

use super::Window;
use crate::machine::line::fifo::Fifo;
use crate::measure::JobSpan;
use crate::quantities::Cycles;
use crate::seam::OpStream;

/// The messages that come back to the host, one for each line of its ops, in their order.
#[derive(Debug)]
pub struct Answers {
    /// Words of each.
    words: u64,
    spans: Vec<JobSpan>,
    /// The jobs whose messages have not come back.
    jobs: VecDeque<u32>,
    /// Words before this one have been looked at.
    seen: u64,
    /// When the first word of the message under way was read.
    began: u64,
}

impl Answers {
    pub fn new(words: u64) -> Answers {
        Answers { words, spans: Vec::new(), jobs: VecDeque::new(), seen: 0, began: 0 }
    }

    /// The host's next lines are known.
    pub fn fed(&mut self, host: &OpStream) {
        self.jobs.extend(host.lines().map(|(job, _)| job));
    }

    /// Notes the messages that have been read, before the FIFO forgets it. Returns how many lie in the window.
    pub fn follow(&mut self, fifo: &Fifo, window: Window) -> usize {
        let before = self.spans.len();
        for word in self.seen..fifo.words_read() {
            if word % self.words == 0 {
                self.began = fifo.read_time(word);
            }
            if word % self.words == self.words - 1
                && let Some(job) = self.jobs.pop_front()
            {
                let until = fifo.read_time(word) + 1;
                let inside = window.clip(self.began, until);
                self.spans.extend(inside.map(|(from, _)| JobSpan { job, from: Cycles(from), until: Cycles(until) }));
            }
        }
        self.seen = fifo.words_read();
        self.spans.len() - before
    }

    /// The cycles in which the messages that are held begin.
    pub fn starts(&self) -> impl Iterator<Item = u64> {
        self.spans.iter().map(|span| span.from.0)
    }

    /// Drops all that begins in cycle `end` or later.
    pub fn forget_from(&mut self, end: u64) {
        self.spans.truncate(self.spans.partition_point(|span| span.from.0 < end));
    }

    /// The messages in their final window.
    pub fn into_spans(mut self, window: Window) -> Vec<JobSpan> {
        self.forget_from(window.until);
        self.spans.last_mut().into_iter().for_each(|last| last.until = last.until.min(Cycles(window.until)));
        self.spans
    }
}
