//! A machine in one cycle of a run: who works, and who waits for whom.

use std::str::FromStr;

use super::clock::Clock;
use super::topology::Actor;
use crate::quantities::Cycles;

/// The cycle that a snapshot is taken in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// That one.
    Cycle(Cycles),
    /// In the middle of the longest wait of a station while it is at a job; where it does not wait, as it begins with it.
    Job {
        /// The station.
        station: usize,
        /// The job.
        job: u32,
    },
}

/// A time in a run, as people say it: a cycle, or a simulated time as in `12.3ms`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// A cycle.
    Cycle(Cycles),
    /// Seconds of simulated time.
    Time(f64),
}

impl At {
    /// The cycle that it is in.
    pub fn cycle(self, clock: Clock) -> Cycles {
        match self {
            At::Cycle(cycle) => cycle,
            At::Time(seconds) => clock.cycle_at(seconds),
        }
    }
}

impl FromStr for At {
    type Err = String;

    fn from_str(text: &str) -> Result<At, String> {
        let units = [("ns", 1e-9), ("us", 1e-6), ("µs", 1e-6), ("ms", 1e-3), ("s", 1.0)];
        match units.iter().find_map(|&(unit, seconds)| Some((text.strip_suffix(unit)?, seconds))) {
            None => text.parse().map(|cycle| At::Cycle(Cycles(cycle))).ok(),
            Some((number, unit)) => {
                let number = number.trim().parse::<f64>().ok().filter(|number| number.is_finite() && *number >= 0.0);
                number.map(|number| At::Time(number * unit))
            }
        }
        .ok_or_else(|| "expected a cycle, or a time in ns, us, ms or s, as in 12.3ms".to_owned())
    }
}

/// What everybody does in one cycle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snapshot {
    /// The cycle.
    pub at: Cycles,
    /// The host, as it sends jobs.
    pub host: Doing,
    /// The stations.
    pub stations: Vec<Doing>,
}

/// What somebody does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Doing {
    /// What it is.
    pub what: What,
    /// The job that it is done for.
    pub job: Option<u32>,
    /// Since which cycle.
    pub since: Cycles,
    /// The first cycle after it.
    pub until: Cycles,
}

/// What there is to do. FIFOs are told by their places in the topology.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// It works on so many units.
    Works {
        /// The unit's place.
        unit: usize,
        /// How many.
        count: u32,
    },
    /// It moves a word, in that one cycle.
    Moves {
        /// The FIFO that it reads.
        reads: Option<usize>,
        /// The FIFO that it writes to.
        writes: Option<usize>,
    },
    /// It waits for a word.
    WaitsForWord {
        /// The FIFO that it reads; none if that carries no word in the whole run.
        fifo: Option<usize>,
        /// The cycle in which the word is written: before it, the FIFO is empty, and from it on the word is on its way. Far
        /// behind the run's end if it is not written in it.
        written: Cycles,
    },
    /// It waits for a place in a full FIFO.
    WaitsForSlot {
        /// The FIFO that it writes to.
        fifo: usize,
    },
    /// It waits for the wire to a FIFO, which carries the word before.
    WaitsForWire {
        /// The FIFO that it writes to.
        fifo: usize,
    },
    /// It waits for an answer.
    WaitsForAnswer {
        /// Its number, from 0.
        message: u32,
        /// The cycle in which its last word is written.
        written: Cycles,
    },
    /// It has done all that it had to.
    Done,
}

impl Snapshot {
    /// What somebody does.
    pub fn of(&self, actor: Actor) -> Option<&Doing> {
        match actor {
            Actor::Host => Some(&self.host),
            Actor::Station(station) => self.stations.get(station),
        }
    }
}
