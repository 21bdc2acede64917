//! What a machine did cycle by cycle in a window of time, as a recorder saw it.

use std::ops::Range;
use std::sync::Arc;

use super::path::PathUnit;
use super::state::StateId;
use super::topology::Topology;
use crate::quantities::{Cycles, Words};
use crate::seam::Op;

/// A window of a run, exact to the cycle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recording {
    /// What the figures are of.
    pub topology: Arc<Topology>,
    /// The cycles that are recorded, from the first to before the last: empty if the run ended before them.
    pub window: Range<Cycles>,
    /// Length of the whole run.
    pub cycles: Cycles,
    /// Whether the window ends earlier than was asked for, because more happened than a recording holds.
    pub cut: bool,
    /// Units of work, by their places, of which the ops tell.
    pub units: Vec<PathUnit>,
    /// The ops of the cycles before this one are recorded: all of the window's, unless there were too many.
    pub ops_until: Cycles,
    /// The host as it sends jobs, if there is one. Waiting for an answer is waiting on Y.
    pub host: Option<StationRecord>,
    /// When the host read the answer to each job.
    pub answers: Vec<JobSpan>,
    /// The stations.
    pub stations: Vec<StationRecord>,
    /// The FIFOs.
    pub fifos: Vec<FifoLevels>,
    /// The messages that stations sent each other in it, in the order in which they set out, if they send whole ones.
    pub messages: Vec<MessageSpan>,
}

/// A message from one station to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageSpan {
    /// Who sent it.
    pub from: usize,
    /// Whom to.
    pub to: usize,
    /// When it was ready to go.
    pub sent: Cycles,
    /// When it arrived.
    pub arrived: Cycles,
}

/// What a station, or the host, did in a window.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StationRecord {
    /// Its states, one after the other without a gap. No stretch goes over the start or the end of a job.
    pub states: Vec<Stretch>,
    /// The jobs that it worked on, one after the other.
    pub jobs: Vec<JobSpan>,
    /// Its ops, one after the other without a gap, but for those that took no time.
    pub ops: Vec<OpSpan>,
}

/// An op and its time. What it has to wait for belongs to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpSpan {
    /// The op.
    pub op: Op,
    /// The job that it is done for, if for any.
    pub job: Option<u32>,
    /// The first cycle, which may lie before the window.
    pub from: Cycles,
    /// The cycle after the last, as far as ops are recorded.
    pub until: Cycles,
    /// How many words it had moved before the window.
    pub before: u32,
}

/// Some words of a FIFO, one behind the other, that are one job's, or nobody's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordsOf {
    /// The job.
    pub job: Option<u32>,
    /// How many words.
    pub count: u64,
}

/// Cycles that are spent in one state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// The state.
    pub state: StateId,
    /// The first cycle.
    pub from: Cycles,
    /// The cycle after the last.
    pub until: Cycles,
}

/// The time of a job in a station: from the first cycle of its line of ops in which the station does not wait, to the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobSpan {
    /// The job's number.
    pub job: u32,
    /// The first cycle.
    pub from: Cycles,
    /// The cycle after the last.
    pub until: Cycles,
}

/// What a FIFO held in a window.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FifoLevels {
    /// The first cycle of the window, and each one in which the level changes, with the level at its end.
    pub levels: Vec<(Cycles, Words)>,
    /// The jobs whose words passed through it, in their order: each from the cycle in which its first word was written to the
    /// one in which its last was read. Several may be in it at a time.
    pub jobs: Vec<JobSpan>,
    /// Whose its words are: from the oldest that was inside at the start of the window to the last one written in it.
    pub words: Vec<WordsOf>,
    /// The cycles of the window in which words were written.
    pub writes: Vec<Cycles>,
    /// Those in which words were read.
    pub reads: Vec<Cycles>,
}

impl StationRecord {
    /// Drops all that lies in a cycle or later.
    pub(crate) fn end_at(&mut self, end: Cycles) {
        let StationRecord { states, jobs, .. } = self;
        states.truncate(states.partition_point(|stretch| stretch.from < end));
        jobs.truncate(jobs.partition_point(|span| span.from < end));
        states.last_mut().into_iter().for_each(|last| last.until = last.until.min(end));
        jobs.last_mut().into_iter().for_each(|last| last.until = last.until.min(end));
    }
}

impl Recording {
    /// How many stretches, jobs and moves of words a recording holds at the most, and as many ops: what viewers open with ease, and a
    /// bound on its memory and on its files whatever the length of the run.
    pub const MOST_EVENTS: usize = 400_000;

    /// Lets what stations did and sent end before a cycle, if it does not already.
    pub(crate) fn end_at(&mut self, end: Cycles) {
        if end >= self.window.end {
            return;
        }
        self.cut = true;
        self.window.end = end.max(self.window.start);
        self.stations.iter_mut().for_each(|record| record.end_at(end));
        self.messages.truncate(self.messages.partition_point(|message| message.sent < end));
    }

    /// The end of its beginning: of the cycles before it no more than `most` stretches, jobs, ops and moves of words begin in;
    /// all of the window of which the ops are recorded, if it has no more.
    pub fn end_of_beginning(&self, most: usize) -> Cycles {
        let stations = || self.host.iter().chain(&self.stations);
        let states = stations().flat_map(|station| station.states.iter().map(|stretch| stretch.from));
        let jobs = stations().map(|station| &station.jobs).chain(self.fifos.iter().map(|fifo| &fifo.jobs));
        let jobs = jobs.chain([&self.answers]).flatten().map(|job| job.from);
        let ops = stations().flat_map(|station| station.ops.iter().map(|op| op.from));
        let moves = self.fifos.iter().flat_map(|fifo| fifo.writes.iter().chain(&fifo.reads)).copied();
        let mut starts: Vec<Cycles> = states.chain(jobs).chain(ops).chain(moves).collect();
        if starts.len() <= most { self.ops_until } else { (*starts.select_nth_unstable(most).1).min(self.ops_until) }
    }
}
