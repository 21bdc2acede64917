//! What a whole run counts. Every figure is an exact integer.

use std::sync::Arc;

use super::state::StateTimes;
use super::topology::{Actor, Topology};
use crate::quantities::{Cycles, Words};

/// The times and fills of a whole run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Measured {
    /// What the figures are of.
    pub topology: Arc<Topology>,
    /// The number of the cycle in which the host read its last word, plus one. A run that returns no word lasts until
    /// its last op has ended.
    pub cycles: Cycles,
    /// Jobs that the host sent.
    pub jobs: u64,
    /// Where each station's cycles went.
    pub stations: Vec<StateTimes>,
    /// What each FIFO held.
    pub fifos: Vec<FifoStats>,
    /// How long each wire was busy.
    pub links: Vec<LinkStats>,
}

/// What one FIFO held. Occupancy is the number of words written and not yet read at the end of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FifoStats {
    /// How many words were written to it.
    pub words: Words,
    /// The highest occupancy.
    pub max: Words,
    /// The sum of the occupancies of all cycles, in words times cycles.
    pub word_cycles: u128,
    /// Cycles at whose end it was full.
    pub full: Cycles,
    /// Cycles at whose end it was empty.
    pub empty: Cycles,
    /// The depth from which nothing changes any more, if it was asked for: with as many words in all FIFOs, no word ever waits
    /// for room.
    pub enough: Option<Words>,
}

/// How long the wire of a link, or a bus, was busy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkStats {
    /// Who sends over it; `None` for a bus, over which all do.
    pub from: Option<Actor>,
    /// To whom it leads; `None` for a bus, which leads to all.
    pub into: Option<Actor>,
    /// Cycles in which it carried words; of wires that carry channels side by side, those of the busiest.
    pub busy: Cycles,
    /// As many of them as words take that were read before the end; of a bus all.
    pub read: Cycles,
    /// The messages that it carried, if it carries whole ones and not word by word.
    pub messages: Option<LinkMessages>,
}

/// The messages that a link, or a bus, carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkMessages {
    /// How many were sent over it.
    pub sent: u64,
    /// Their bytes.
    pub bytes: u64,
    /// For how long they waited for it when they were ready to go. One that needs several links waits for that which is free last.
    pub waited: Cycles,
}

impl FifoStats {
    /// The mean occupancy, in words, over a run of `cycles` cycles.
    pub fn mean(&self, cycles: Cycles) -> f64 {
        if cycles.0 == 0 { 0.0 } else { self.word_cycles as f64 / cycles.0 as f64 }
    }
}

impl Measured {
    /// A part of the run as a share of it.
    pub fn share(&self, part: Cycles) -> f64 {
        if self.cycles.0 == 0 { 0.0 } else { part.0 as f64 / self.cycles.0 as f64 }
    }

    /// The station that works most, the first of several.
    pub fn busiest(&self) -> Option<usize> {
        let works = |station: usize| self.topology.states.works(&self.stations[station]);
        (0..self.stations.len()).max_by_key(|&station| (works(station), std::cmp::Reverse(station)))
    }

    /// Words through the FIFO of a group that somebody reads; 0 where there is none.
    pub fn words_into(&self, group: &str, to: Actor) -> Words {
        self.topology.fifo_of(group, to).map_or(Words(0), |fifo| self.fifos[fifo].words)
    }
}
