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
    /// Takes a message that is ready to go from one task to another, and tells when it arrives.
    #[inline]
    pub(super) fn carry(&mut self, (from, to): (usize, usize), ready: u64, bytes: u64) -> u64 {
        match self {
            Network::Buses(buses) => buses.carry(ready, bytes),
            Network::Cube(cube) => cube.carry((from, to), ready, bytes),
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
