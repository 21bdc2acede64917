//! What everybody does in one cycle: the ops and the ends of the waits say it exactly.

use super::waits::{last_before, next_after};
use super::way::Walk;
use super::window::Past;
use super::{Stand, Station, actor};
use crate::machine::line::hold::Hold;
use crate::measure::{Doing, Snapshot, Topology, What, When};
use crate::quantities::Cycles;
use crate::seam::{Channel, Op, OpKind};

/// Looks for what all stations do in a cycle. Each comes to it when it does, so each is looked at by itself.
#[derive(Debug)]
pub(super) struct Look {
    when: When,
    /// The cycle, once it is known; and how long the wait is that it lies in.
    at: Option<(u64, u64)>,
    found: Vec<Option<Found>>,
}

/// What a station does.
#[derive(Clone, Copy, Debug)]
struct Found {
    op: Op,
    job: Option<u32>,
    since: u64,
    until: u64,
    /// What it waits for, if it does.
    hold: Option<Hold>,
    /// Whether the run ends before that comes.
    is_cut: bool,
}

impl Look {
    pub fn new(stations: usize, when: When) -> Look {
        let at = match when {
            When::Cycle(at) => Some((at.0, 0)),
            When::Job { .. } => None,
        };
        Look { when, at, found: vec![None; stations] }
    }

    /// Looks at what happened since the last reckoning.
    pub fn look(&mut self, past: &Past<'_>, stations: &[Station]) {
        match self.when {
            When::Cycle(Cycles(at)) => {
                for (index, (found, station)) in self.found.iter_mut().zip(stations).enumerate() {
                    *found = found.or_else(|| doing(past, index, station, at));
                }
            }
            When::Job { station, job } => {
                let Some(of_cell) = stations.get(station + 1) else { return };
                for wait in longest_waits(past, station + 1, of_cell, job) {
                    if self.at.is_none_or(|(_, length)| wait.1 > length) {
                        self.at = Some(wait);
                    }
                }
            }
        }
    }

    /// The cycle, if it has been come to.
    pub fn cycle(&self) -> Option<Cycles> {
        self.at.map(|(at, _)| Cycles(at))
    }

    /// What was found, if it was a cycle that was looked for. Who did nothing in it any more has done all.
    pub fn finish(self, past: &Past<'_>, topology: &Topology) -> Option<Snapshot> {
        let (When::Cycle(at), latency) = (self.when, past.latency()) else { return None };
        let read = |reader: usize, channel: Channel| topology.fifo_of(&channel.to_string(), actor(reader));
        // Who waits to write has written before.
        let fifo = |reader: usize, channel: Channel| read(reader, channel).unwrap_or_default();
        let reads = |station: usize, op: Op| op.kind().reads().and_then(|channel| read(station, channel));
        let writes = |station: usize, op: Op| {
            let passes_on = op.kind() != OpKind::PassX || station != past.last();
            op.kind().writes().filter(|_| passes_on).map(|channel| fifo(past.reader(station, channel), channel))
        };
        let doing = |(station, found): (usize, &Option<Found>)| {
            let Some(found) = found else {
                let since = Cycles(past.stands[station].clock);
                return Doing { what: What::Done, job: None, since, until: since };
            };
            let what = match (found.hold, found.op.unit()) {
                (Some(Hold::Word(channel)), _) => {
                    let cut = || past.next_written(station, channel).unwrap_or(u64::MAX);
                    let written = if found.is_cut { cut() } else { found.until - latency };
                    What::WaitsForWord { fifo: read(station, channel), written: Cycles(written) }
                }
                (Some(Hold::Slot(channel)), _) => {
                    What::WaitsForSlot { fifo: fifo(past.reader(station, channel), channel) }
                }
                (Some(Hold::Wire(channel)), _) => {
                    What::WaitsForWire { fifo: fifo(past.reader(station, channel), channel) }
                }
                (Some(Hold::Answer), _) => {
                    let written = if found.is_cut { u64::MAX } else { found.until - 1 - latency };
                    What::WaitsForAnswer { message: found.op.count(), written: Cycles(written) }
                }
                (None, Some(unit)) => What::Works { unit: unit.0 as usize, count: found.op.count() },
                (None, None) => What::Moves { reads: reads(station, found.op), writes: writes(station, found.op) },
            };
            Doing { what, job: found.job, since: Cycles(found.since), until: Cycles(found.until) }
        };
        let mut doings = self.found.iter().enumerate().map(doing);
        Some(Snapshot { at, host: doings.next()?, stations: doings.collect() })
    }
}

/// What a station does in a cycle; `None` if that is none of those since the last reckoning.
fn doing(past: &Past<'_>, index: usize, station: &Station, at: u64) -> Option<Found> {
    if !(station.start.clock..past.stands[index].clock).contains(&at) {
        return None;
    }
    let last = last_before(&station.waits, at, station.waits.len());
    let start = last.map_or(station.start, |last| station.waits[last.row].stand(last.number));
    let mut walk = Walk { past, station: index, at: start };
    let next = next_after(&station.waits, last).map(|next| (&station.waits[next.row], next.number));
    let is_cut = next.is_none();
    let next = next.or(station.cut.as_ref().map(|cut| (cut, 0))).map(|(row, number)| (row.stand(number), row.by));
    while let Some((op, each)) = walk.op() {
        let length = walk.left(op) * each;
        let job = past.stream(index, walk.at.batch).and_then(|stream| stream.line_of(walk.at.op)).map(|line| line.job);
        let here = next.filter(|(wait, _)| (wait.batch, wait.op) == (walk.at.batch, walk.at.op));
        if let Some((wait, by)) = here {
            let moved = if op.kind() == OpKind::Await { 0 } else { walk.left(op) - wait.left };
            let since = walk.at.clock + moved;
            if at >= since {
                return Some(Found { op, job, since, until: wait.clock, hold: Some(by), is_cut });
            }
        }
        if at < walk.at.clock + length {
            // Words move one by one, and a reckoning may come between them.
            let (since, until) =
                if op.unit().is_some() { (walk.at.clock, walk.at.clock + length) } else { (at, at + 1) };
            return Some(Found { op, job, since, until, hold: None, is_cut: false });
        }
        walk.skip(length);
    }
    None
}

/// The middles of a station's waits while it is at a job, with their lengths; where it has begun with it, that too.
fn longest_waits(past: &Past<'_>, index: usize, station: &Station, job: u32) -> Vec<(u64, u64)> {
    let mut waits = Vec::new();
    let end = past.stands[index];
    for batch in station.start.batch..=end.batch {
        let Some(stream) = past.stream(index, batch) else { continue };
        let mut first = 0;
        for (other, ops) in stream.lines() {
            let range = first..first + ops.len();
            first = range.end;
            if other != job {
                continue;
            }
            let rows = station.waits.iter().chain(&station.cut);
            let ends = rows.flat_map(|row| (0..row.count()).map(|number| row.stand(number)));
            for wait in ends.filter(|wait| wait.batch == batch && range.contains(&wait.op)) {
                let found = doing(past, index, station, wait.clock - 1);
                waits.extend(found.map(|found| ((found.since + found.until) / 2, found.until - found.since)));
            }
            let begins = Stand { batch, op: range.start, left: 0, clock: 0 };
            waits.extend(clock_at(past, index, station, begins).map(|clock| (clock, 0)));
        }
    }
    waits
}

/// The cycle in which a station comes to an op, if that was since the last reckoning.
fn clock_at(past: &Past<'_>, index: usize, station: &Station, op: Stand) -> Option<u64> {
    let place = |stand: Stand| (stand.batch, stand.op);
    let (start, end) = (station.start, past.stands[index]);
    if place(op) < place(start) || place(op) >= place(end) {
        return None;
    }
    let behind = station.waits.partition_point(|row| place(row.stand(0)) < place(op));
    let last = behind.checked_sub(1).map(|last| &station.waits[last]);
    let start = last.map_or(start, |row| row.stand(row.count() - 1));
    let mut walk = Walk { past, station: index, at: start };
    loop {
        let (next, each) = walk.op()?;
        if place(walk.at) >= place(op) {
            return Some(walk.at.clock);
        }
        walk.skip(walk.left(next) * each);
    }
}
