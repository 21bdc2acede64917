//! What a machine did cycle by cycle in a window of time, as a recorder saw it.

use std::ops::Range;
use std::sync::Arc;

use super::state::StateId;
use super::topology::Topology;
use crate::quantities::{Cycles, Words};

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
    /// The host as it sends jobs, if there is one. Waiting for an answer is waiting on Y.
    pub host: Option<StationRecord>,
    /// When the host read the answer to each job.
    pub answers: Vec<JobSpan>,
    /// The stations.
    pub stations: Vec<StationRecord>,
    /// The FIFOs.
    pub fifos: Vec<FifoLevels>,
}

/// What a station, or the host, did in a window.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StationRecord {
    /// Its states, one after the other without a gap. No stretch goes over the start or the end of a job.
    pub states: Vec<Stretch>,
    /// The jobs that it worked on, one after the other.
    pub jobs: Vec<JobSpan>,
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
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoLevels {
    /// The first cycle of the window, and each one in which the level changes, with the level at its end.
    pub levels: Vec<(Cycles, Words)>,
    /// The jobs whose words passed through it, in their order: each from the cycle in which its first word was written to the
    /// one in which its last was read. Several may be in it at a time.
    pub jobs: Vec<JobSpan>,
}

impl Recording {
    /// How many stretches, jobs and moves of words a recording holds at the most: what viewers open with ease, and a
    /// bound on its memory and on its files whatever the length of the run.
    pub const MOST_EVENTS: usize = 400_000;

    /// The end of its beginning: of the cycles before it no more than `most` stretches, jobs and levels begin in; all of the
    /// window, if it has no more.
    pub fn end_of_beginning(&self, most: usize) -> Cycles {
        let stations = || self.host.iter().chain(&self.stations);
        let states = stations().flat_map(|station| station.states.iter().map(|stretch| stretch.from));
        let jobs = stations().map(|station| &station.jobs).chain(self.fifos.iter().map(|fifo| &fifo.jobs));
        let jobs = jobs.chain([&self.answers]).flatten().map(|job| job.from);
        let levels = self.fifos.iter().flat_map(|fifo| fifo.levels.iter().map(|level| level.0));
        let mut starts: Vec<Cycles> = states.chain(jobs).chain(levels).collect();
        if starts.len() <= most { self.window.end } else { *starts.select_nth_unstable(most).1 }
    }
}
