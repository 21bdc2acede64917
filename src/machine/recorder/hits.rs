//! When the host read HITs.

use std::collections::VecDeque;

use super::Window;
use crate::machine::array::RETURN_WORDS;
use crate::machine::fifo::Fifo;
use crate::machine::op::OpStream;
use crate::machine::recording::Visit;
use crate::machine::units::Cycles;

/// The messages that come back to the host, one for each line of its ops, in their order.
#[derive(Debug, Default)]
pub struct Hits {
    visits: Vec<Visit>,
    /// The rays whose messages have not come back.
    rays: VecDeque<u32>,
    /// Words before this one have been looked at.
    seen: u64,
    /// When the first word of the message under way was read.
    began: u64,
}

impl Hits {
    /// The host's next lines are known.
    pub fn fed(&mut self, host: &OpStream) {
        self.rays.extend(host.lines().map(|(ray, _)| ray));
    }

    /// Notes the messages that have been read, before the FIFO forgets it. Returns how many lie in the window.
    pub fn follow(&mut self, fifo: &Fifo, window: Window) -> usize {
        let before = self.visits.len();
        for word in self.seen..fifo.words_read() {
            if word % RETURN_WORDS == 0 {
                self.began = fifo.read_time(word);
            }
            if word % RETURN_WORDS == RETURN_WORDS - 1
                && let Some(ray) = self.rays.pop_front()
            {
                let until = fifo.read_time(word) + 1;
                let inside = window.clip(self.began, until);
                self.visits.extend(inside.map(|(from, _)| Visit { ray, from: Cycles(from), until: Cycles(until) }));
            }
        }
        self.seen = fifo.words_read();
        self.visits.len() - before
    }

    /// The cycles in which the messages that are held begin.
    pub fn starts(&self) -> impl Iterator<Item = u64> {
        self.visits.iter().map(|visit| visit.from.0)
    }

    /// Drops all that begins in cycle `end` or later.
    pub fn forget_from(&mut self, end: u64) {
        self.visits.truncate(self.visits.partition_point(|visit| visit.from.0 < end));
    }

    /// The messages in their final window.
    pub fn into_visits(mut self, window: Window) -> Vec<Visit> {
        self.forget_from(window.until);
        self.visits.last_mut().into_iter().for_each(|last| last.until = last.until.min(Cycles(window.until)));
        self.visits
    }
}
