//! What carries messages from task to task.

use super::buses::Buses;
use super::cube::Cube;
use crate::measure::LinkStats;

/// Buses that all tasks share, or the links of a hypercube.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Network {
    /// Buses.
    Buses(Buses),
    /// A hypercube.
    Cube(Cube),
}

/// How a message passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Passage {
    /// The bus that it takes; 0 in a hypercube, whose links are those between its ends.
    pub bus: usize,
    /// When it sets out: nothing is in its way.
    pub starts: u64,
    /// When bus or links are free for others.
    pub free: u64,
    /// When it arrives.
    pub arrives: u64,
}

impl From<Buses> for Network {
    fn from(buses: Buses) -> Network {
        Network::Buses(buses)
    }
}

impl From<Cube> for Network {
    fn from(cube: Cube) -> Network {
        Network::Cube(cube)
    }
}

impl Network {
    /// Takes a message that is ready to go from one task to another.
    #[inline(always)]
    pub(super) fn carry(&mut self, (from, to): (usize, usize), ready: u64, bytes: u64) -> Passage {
        match self {
            Network::Buses(buses) => buses.carry(ready, bytes),
            Network::Cube(cube) => cube.carry((from, to), ready, bytes),
        }
    }

    /// How many buses or links there are.
    pub(super) fn count(&self) -> usize {
        match self {
            Network::Buses(buses) => buses.count(),
            Network::Cube(cube) => cube.count(),
        }
    }

    /// The buses or links that a message had which has passed from one task to another.
    pub(super) fn taken_by(&self, (from, to): (usize, usize), passage: &Passage) -> Vec<usize> {
        match self {
            Network::Buses(_) => vec![passage.bus],
            Network::Cube(cube) => cube.links_between(from, to).collect(),
        }
    }

    /// The station that a task is at: helpers of a hypercube's nodes are at these.
    pub(super) fn place(&self, task: usize) -> usize {
        match self {
            Network::Buses(_) => task,
            Network::Cube(cube) => cube.place(task),
        }
    }

    /// Whether one message can be for all.
    pub(super) fn broadcasts(&self) -> bool {
        matches!(self, Network::Buses(_))
    }

    /// How long each bus or link was busy.
    pub(super) fn stats(&self) -> Vec<LinkStats> {
        match self {
            Network::Buses(buses) => buses.stats(),
            Network::Cube(cube) => cube.stats(),
        }
    }
}
