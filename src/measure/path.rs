//! Why a run took as long as it did: the chain of causes that ends with its last word. Every figure is an exact integer.

use std::sync::Arc;

use super::state::{State, StateId, StateKind, StateTimes};
use super::topology::{Actor, Shape, Topology};
use crate::quantities::Cycles;

/// The critical path of a run: a chain of causes from cycle 0 to the last word that comes back, or to what tasks do last, every
/// cycle of which has just one cause. So its parts sum to the run's cycles.
///
/// In a line of stations whose reads and writes block, every time is the largest of a few sums, so the run is as long as its
/// longest chain; this is one of these, chosen by a rule where several are as long. What lies on it `count` times, and takes
/// a cycle less or more, makes the run `count` cycles shorter or longer as long as the chain stays a longest one, and never
/// shorter than that: the cycles of a run are convex in each of the machine's times, and this is their slope. Where tasks take what
/// comes first, or what is first on a bus, that holds as long as all come in the order in which they did.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CriticalPath {
    /// What the path leads through.
    pub topology: Arc<Topology>,
    /// Length of the run, and of the path.
    pub cycles: Cycles,
    /// What work is done in.
    pub units: Vec<PathUnit>,
    /// Width of a bin: a power of two.
    pub bin: Cycles,
    /// The path over time: in each bin of the run, its parts, in the order of places and causes.
    pub bins: Vec<Vec<PathPart>>,
}

/// A unit of work, as a path or a recording names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathUnit {
    /// Its name, by which the machine's file prices it: `grid_voxel`.
    pub name: String,
    /// The state of a station that does it.
    pub state: StateId,
    /// What it takes; where they differ, about.
    pub cycles: Cycles,
}

/// What a path's cycles are spent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cause {
    /// Work, by the place of its unit.
    Work(usize),
    /// A word that is moved, a cycle.
    Move,
    /// A word on its way to a FIFO, by the FIFO's place in the topology: the latency.
    Latency(usize),
    /// The wire to a FIFO, busy with the word before: cycles a word.
    Wire(usize),
    /// A place in a full FIFO, which its reader frees: a cycle.
    Slot(usize),
}

/// Some cycles of a path, of one cause in one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathPart {
    /// Where it is: who works or moves a word, or who reads the FIFO.
    pub at: Actor,
    /// What it is.
    pub cause: Cause,
    /// How long.
    pub cycles: Cycles,
    /// How often: units of work, words, waits. What lies across two bins counts in the later.
    pub count: u64,
}

impl CriticalPath {
    /// Ops that are held at a time to find the path, about: few enough to stay in a core's cache.
    pub const MOST_OPS: usize = 1 << 16;

    /// Where it is over time: for each station, and for the host of a line behind them, in each bin the cycles that it is there, in
    /// the states that say why. Words on their way are those that their reader waits for, and who writes to a full FIFO or a
    /// wire that is not free is blocked; both are counted where the FIFO is read.
    pub fn places(&self) -> Vec<Vec<StateTimes>> {
        let hosts = usize::from(self.topology.shape == Shape::Line);
        let mut places = vec![vec![StateTimes::default(); self.bins.len()]; self.topology.stations + hosts];
        for (bin, parts) in self.bins.iter().enumerate() {
            for part in parts {
                let place = match part.at {
                    Actor::Host => self.topology.stations,
                    Actor::Station(station) => station,
                };
                if let Some(state) = self.state_of(part.cause) {
                    *places[place][bin].of_mut(state) += part.cycles;
                }
            }
        }
        places
    }

    /// The state of a station that is the cause, or that is held up by it.
    fn state_of(&self, cause: Cause) -> Option<StateId> {
        let at = |kind: StateKind, fifo: Option<usize>| {
            let group = fifo.map(|fifo| self.topology.fifos[fifo].group.as_str());
            let is_at = |state: &&State| {
                state.kind == kind && state.stands_at.as_ref().map(|(group, _)| group.as_str()) == group
            };
            self.topology.states.all().iter().find(is_at).map(|state| state.id)
        };
        match cause {
            Cause::Work(unit) => Some(self.units[unit].state),
            Cause::Move => at(StateKind::Moves, None),
            Cause::Latency(fifo) => at(StateKind::Waits, Some(fifo)),
            Cause::Wire(fifo) | Cause::Slot(fifo) => at(StateKind::Blocked, Some(fifo)),
        }
    }

    /// Its parts over the whole run, in the order of places and causes.
    pub fn parts(&self) -> Vec<PathPart> {
        let mut parts: Vec<PathPart> = self.bins.iter().flatten().copied().collect();
        parts.sort_by_key(|part| (part.at, part.cause));
        parts.dedup_by(|later, part| {
            let same = (later.at, later.cause) == (part.at, part.cause);
            if same {
                part.cycles += later.cycles;
                part.count += later.count;
            }
            same
        });
        parts
    }
}
