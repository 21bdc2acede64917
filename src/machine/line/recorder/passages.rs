//! Whose words passed through a FIFO, and when.

use std::collections::VecDeque;

use super::Window;
use crate::machine::line::fifo::Fifo;
use crate::measure::JobSpan;
use crate::quantities::Cycles;

/// The jobs whose words pass through one FIFO, in the order of the words.
#[derive(Clone, Debug, Default)]
pub struct Passages {
    /// Words that the writer's ops so far write.
    known: u64,
    /// Jobs of which no word is known to have been written: first and last word.
    coming: VecDeque<(u32, u64, u64)>,
    /// Those of which not all words are known to have been read: the last word, and when the first was written.
    inside: VecDeque<(u32, u64, u64)>,
    spans: Vec<JobSpan>,
    /// Whether all that is to come lies behind the window.
    is_over: bool,
}

impl Passages {
    /// The writer's next ops write so many words, for a job or for none.
    pub fn fed(&mut self, job: Option<u32>, words: u64) {
        if words > 0 && !self.is_over {
            self.coming.extend(job.map(|job| (job, self.known, self.known + words - 1)));
            self.known += words;
        }
    }

    /// Whether it is worth telling what is to come.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Notes the times that have become known, before the FIFO forgets them.
    pub fn follow(&mut self, fifo: &Fifo, window: Window) {
        while let Some((job, first, last)) = self.coming.front().copied().filter(|job| job.1 < fifo.words_written()) {
            let from = fifo.write_time(first);
            self.is_over = from >= window.until;
            if self.is_over {
                self.coming = VecDeque::new();
                break;
            }
            self.coming.pop_front();
            self.inside.push_back((job, last, from));
        }
        while let Some((job, last, from)) = self.inside.front().copied().filter(|job| job.1 < fifo.words_read()) {
            self.inside.pop_front();
            self.push(job, (from, fifo.read_time(last) + 1), window);
        }
    }

    fn push(&mut self, job: u32, (from, until): (u64, u64), window: Window) {
        let span = |(from, until)| JobSpan { job, from: Cycles(from), until: Cycles(until) };
        self.spans.extend(window.clip(from, until).map(span));
    }

    /// Drops all that begins in cycle `end` or later.
    pub fn forget_from(&mut self, end: u64) {
        self.spans.truncate(self.spans.partition_point(|span| span.from.0 < end));
        self.inside.truncate(self.inside.partition_point(|job| job.2 < end));
    }

    /// The jobs in their final window: what is still inside stays to its end.
    pub fn into_spans(mut self, window: Window) -> Vec<JobSpan> {
        self.forget_from(window.until);
        self.spans.iter_mut().for_each(|span| span.until = span.until.min(Cycles(window.until)));
        for (job, _, from) in std::mem::take(&mut self.inside) {
            self.push(job, (from, window.until), window);
        }
        self.spans
    }
}
