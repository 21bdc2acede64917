//! All that watches an array at work. An array that nobody watches pays nothing for it.

use std::sync::Arc;

use super::cell::Cell;
use super::cursor::Halt;
use super::link::Link;
use super::prices::Prices;
use super::probe::Probe;
use super::recorder::Recorder;
use crate::measure::{Observed, Topology};
use crate::seam::{Op, OpStream};

/// Those that watch an array.
#[derive(Debug, Default)]
pub(super) struct Observers {
    pub probe: Option<Probe>,
    pub recorder: Option<Recorder>,
}

impl Observers {
    /// The host's next lines are known.
    pub fn fed(&mut self, host: &OpStream) {
        self.probe.iter_mut().for_each(|probe| probe.fed(host));
        self.recorder.iter_mut().for_each(|recorder| recorder.fed(host));
    }

    /// Does the host's ops as [`Cell::run_host`], if somebody watches it at this time.
    pub fn run_host(
        &mut self,
        host: &mut Cell,
        stream: &OpStream,
        done: &mut usize,
        output: &mut Link,
        (prices, returned): (&Prices, &[u64]),
    ) -> Option<Halt> {
        let recorder = self.recorder.as_mut().filter(|recorder| recorder.is_open_at(host.now.clock))?;
        let (halt, events) = recorder.host().run(stream, done, |ops, done, track| {
            let halt = host.run_host(ops, done, output, returned, (prices, track));
            (halt, host.now.clock)
        });
        recorder.count(events);
        Some(halt)
    }

    /// Does a cell's ops as [`Cell::run`], if somebody watches it at this time. Kept apart from the cells that nobody watches.
    #[inline(never)]
    pub fn run_cell(
        &mut self,
        index: usize,
        cell: &mut Cell,
        stream: &OpStream,
        done: &mut usize,
        (input, output): (&mut Link, &mut Link),
        (prices, is_last): (&Prices, bool),
    ) -> Option<Halt> {
        let recorder = self.recorder.as_mut().filter(|recorder| recorder.is_open_at(cell.now.clock));
        match (self.probe.as_mut().map(|probe| probe.cell(index)), recorder) {
            (None, None) => None,
            (Some(lane), None) => Some(cell.run(stream.ops(), done, (input, output), is_last, (prices, lane))),
            (mut lane, Some(recorder)) => {
                let (halt, events) = recorder.cell(index).run(stream, done, |ops, done, track| {
                    let halt = cell.run(ops, done, (input, output), is_last, (prices, (lane.as_deref_mut(), track)));
                    (halt, cell.now.clock)
                });
                recorder.count(events);
                Some(halt)
            }
        }
    }

    /// Lets the host spend the cycles up to the limit as [`Cell::stall_to_limit`].
    pub fn stall_host_to_limit(&mut self, host: &mut Cell, (halt, op): (Halt, Op), output: &Link, prices: &Prices) {
        let mut track = self.recorder.as_mut().map(Recorder::host);
        host.stall_to_limit(halt, op, output, (prices, track.as_mut()));
    }

    /// Lets a cell do so.
    pub fn stall_cell_to_limit(
        &mut self,
        (index, cell): (usize, &mut Cell),
        (halt, op): (Halt, Op),
        input: &Link,
        prices: &Prices,
    ) {
        let lane = self.probe.as_mut().map(|probe| probe.cell(index));
        let mut track = self.recorder.as_mut().map(|recorder| recorder.cell(index));
        cell.stall_to_limit(halt, op, input, (prices, (lane, track.as_mut())));
    }

    /// Follows the FIFOs of a link, after each stretch of reads or writes.
    pub fn follow(&mut self, index: usize, link: &Link) {
        self.probe.iter_mut().for_each(|probe| probe.follow(index, link));
        self.recorder.iter_mut().for_each(|recorder| recorder.follow(index, link));
    }

    /// The host read the last word of the next answer in that cycle.
    pub fn returned(&mut self, cycle: u64) {
        self.probe.iter_mut().for_each(|probe| probe.returned(cycle));
    }

    /// All that was seen in a run of `cycles` cycles. `clocks` are those of the host and of the cells at its end.
    pub fn finish(
        self,
        topology: &Arc<Topology>,
        links: &[Link],
        clocks: impl Iterator<Item = u64> + Clone,
        cycles: u64,
    ) -> Observed {
        Observed {
            profile: self.probe.map(|probe| probe.finish(topology, links, clocks.clone().skip(1), cycles)),
            recording: self.recorder.map(|recorder| recorder.finish(topology, links, clocks, cycles)),
        }
    }
}
