//! When jobs were done, and how long each took.

use std::collections::VecDeque;

use crate::machine::line::departures::Departures;
use crate::machine::line::fifo::Fifo;
use crate::machine::timeline::{Count, Timeline};
use crate::measure::Latency;
use crate::seam::OpStream;

/// Follows the jobs.
#[derive(Debug)]
pub struct JobLane {
    done: Timeline<Count>,
    latency: Latency,
    sent: Departures,
    /// For each message whose job is not known to have been sent: the cycle in which its last word was read.
    back: VecDeque<u64>,
}

impl JobLane {
    pub fn new(bins: usize) -> JobLane {
        JobLane {
            done: Timeline::new(bins),
            latency: Latency::default(),
            sent: Departures::default(),
            back: VecDeque::new(),
        }
    }

    /// The host's next lines are known.
    pub fn fed(&mut self, host: &OpStream) {
        self.sent.fed(host);
    }

    /// Notes when the host wrote the first words of jobs, before its FIFO forgets it.
    pub fn follow(&mut self, fifo: &Fifo) {
        self.sent.follow(fifo);
        self.pair();
    }

    /// The host read the last word of the next answer in that cycle.
    pub fn returned(&mut self, cycle: u64) {
        self.done.at(cycle).0 += 1;
        self.back.push_back(cycle);
        self.pair();
    }

    /// Ends the ways of the jobs of which both ends are known.
    fn pair(&mut self) {
        while self.sent.is_known() && !self.back.is_empty() {
            let (Some(sent), Some(back)) = (self.sent.next(), self.back.pop_front()) else { return };
            self.latency.add(Departures::latency(sent, back).0);
        }
    }

    /// Jobs done in each bin of a run of `cycles` cycles, their latencies, and the width of a bin.
    pub fn finish(self, cycles: u64) -> (Vec<u64>, Latency, u64) {
        let (bins, width) = self.done.finish(cycles);
        (bins.into_iter().map(|count| count.0).collect(), self.latency, width)
    }
}
