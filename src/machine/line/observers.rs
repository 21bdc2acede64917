//! All that watches an array at work. An array that nobody watches pays nothing for it.

use std::sync::Arc;

use super::causes::{Causes, Past};
use super::cell::Cell;
use super::cursor::Halt;
use super::departures::Departures;
use super::link::{Link, around};
use super::prices::Prices;
use super::probe::Probe;
use super::recorder::Recorder;
use crate::measure::{Observed, StateTimes, Topology};
use crate::seam::{Op, OpBatch, OpStream, Vocabulary};

/// Those that watch an array.
#[derive(Debug, Default)]
pub(super) struct Observers {
    pub probe: Option<Probe>,
    pub recorder: Option<Recorder>,
    pub causes: Option<Causes>,
    pub departures: Option<Departures>,
    /// The same, of which all are told at the end.
    pub spans: Option<Departures>,
}

impl Observers {
    /// The next ops are known.
    pub fn fed(&mut self, batch: &OpBatch) {
        self.probe.iter_mut().for_each(|probe| probe.fed(&batch.host));
        self.recorder.iter_mut().for_each(|recorder| recorder.fed(batch));
        self.causes.iter_mut().for_each(|causes| causes.fed(batch));
        self.departures.iter_mut().chain(&mut self.spans).for_each(|departures| departures.fed(&batch.host));
    }

    /// Does the host's ops of a batch as [`Cell::run_host`], if somebody watches it at this time.
    pub fn run_host(
        &mut self,
        host: &mut Cell,
        (batch, stream): (usize, &OpStream),
        output: &mut Link,
        (prices, returned): (&Prices, &[u64]),
    ) -> Option<Halt> {
        let recorder = self.recorder.as_mut().filter(|recorder| recorder.is_open_at(host.now.clock));
        let mut waits = self.causes.as_mut().map(|causes| causes.host(batch));
        let Some(recorder) = recorder else {
            return waits.as_mut().map(|waits| host.run_host(stream.ops(), output, returned, (prices, waits)));
        };
        let (halt, events) = recorder.host().run(stream, host.now.done, |ops, track| {
            let halt = host.run_host(ops, output, returned, (prices, (track, waits.as_mut())));
            (halt, host.now)
        });
        recorder.count(events);
        Some(halt)
    }

    /// Does a cell's ops of a batch as [`Cell::run`], if somebody watches it at this time. Kept apart from the cells that
    /// nobody watches.
    #[inline(never)]
    #[expect(
        clippy::ptr_arg,
        reason = "of a slice, LLVM loads all that links hold before each op, as nothing else could change it"
    )]
    pub fn run_cell(
        &mut self,
        (index, cell): (usize, &mut Cell),
        (batch, stream): (usize, &OpStream),
        links: &mut Vec<Link>,
        (prices, is_last): (&Prices, bool),
    ) -> Option<Halt> {
        let links = around(links, index);
        let recorder = self.recorder.as_mut().filter(|recorder| recorder.is_open_at(cell.now.clock));
        let mut lane = self.probe.as_mut().map(|probe| probe.cell(index));
        let mut waits = self.causes.as_mut().map(|causes| causes.cell(index, batch));
        let Some(recorder) = recorder else {
            return match (lane, waits.as_mut()) {
                (None, None) => None,
                (Some(lane), None) => Some(cell.run(stream.ops(), links, is_last, (prices, lane))),
                (None, Some(waits)) => Some(cell.run(stream.ops(), links, is_last, (prices, waits))),
                both => Some(cell.run(stream.ops(), links, is_last, (prices, both))),
            };
        };
        let (halt, events) = recorder.cell(index).run(stream, cell.now.done, |ops, track| {
            let watchers = (lane.as_deref_mut(), (track, waits.as_mut()));
            let halt = cell.run(ops, (&mut *links.0, &mut *links.1), is_last, (prices, watchers));
            (halt, cell.now)
        });
        recorder.count(events);
        Some(halt)
    }

    /// Lets the host spend the cycles up to the limit as [`Cell::stall_to_limit`], in a batch.
    pub fn stall_host_to_limit(
        &mut self,
        host: &mut Cell,
        (batch, halt, op): (usize, Halt, Op),
        output: &Link,
        prices: &Prices,
    ) {
        let mut track = self.recorder.as_mut().map(Recorder::host);
        let mut waits = self.causes.as_mut().map(|causes| causes.host(batch));
        host.stall_to_limit(halt, op, output, (prices, (track.as_mut(), waits.as_mut())));
    }

    /// Lets a cell do so.
    pub fn stall_cell_to_limit(
        &mut self,
        (index, cell): (usize, &mut Cell),
        (batch, halt, op): (usize, Halt, Op),
        input: &Link,
        prices: &Prices,
    ) {
        let lane = self.probe.as_mut().map(|probe| probe.cell(index));
        let mut track = self.recorder.as_mut().map(|recorder| recorder.cell(index));
        let mut waits = self.causes.as_mut().map(|causes| causes.cell(index, batch));
        cell.stall_to_limit(halt, op, input, (prices, (lane, (track.as_mut(), waits.as_mut()))));
    }

    /// Follows the FIFOs of a link, after each stretch of reads or writes.
    #[inline(never)]
    pub fn follow(&mut self, index: usize, link: &Link) {
        self.probe.iter_mut().for_each(|probe| probe.follow(index, link));
        self.recorder.iter_mut().for_each(|recorder| recorder.follow(index, link));
        if index == 0 {
            self.departures.iter_mut().chain(&mut self.spans).for_each(|departures| departures.follow(&link.x));
        }
    }

    /// The host read the last word of the next answer in that cycle.
    pub fn returned(&mut self, cycle: u64) {
        self.probe.iter_mut().for_each(|probe| probe.returned(cycle));
    }

    /// All that was seen in a run of `cycles` cycles, in which the cells have spent `times` in each state.
    pub fn finish(
        self,
        (past, times): (&Past<'_>, &[StateTimes]),
        (topology, vocabulary): (&Arc<Topology>, &Vocabulary),
        cycles: u64,
    ) -> Observed {
        let clocks = || past.stands.iter().map(|stand| stand.clock);
        let explained = self.causes.map(|causes| causes.finish(past, (topology, vocabulary), cycles));
        let (path, looked_at, snapshot) =
            explained.map_or((None, None, None), |(path, at, seen)| (Some(path), at, seen));
        let profile = |probe: Probe| probe.finish(topology, past.links, (clocks().skip(1), times), cycles);
        Observed {
            profile: self.probe.map(profile),
            recording: self.recorder.map(|recorder| {
                let named = (topology, past.prices.units(vocabulary));
                recorder.finish(named, past.links, clocks(), cycles)
            }),
            path,
            looked_at,
            snapshot,
            spans: self.spans.map(|spans| spans.spans(past.returned)).unwrap_or_default(),
        }
    }
}
