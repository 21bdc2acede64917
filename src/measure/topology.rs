//! What a machine is made of.

use std::fmt;

use super::state::States;
use crate::quantities::Words;

/// Somebody who does something: the host, or a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Actor {
    /// The host, which sends jobs and takes answers.
    Host,
    /// A station, by its place among them.
    Station(usize),
}

/// A FIFO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoInfo {
    /// Its name: `X0`, `Y1`, ..., by the cell that reads it; `Yhost`.
    pub name: String,
    /// What it has in common with others, which pictures show together: `X`.
    pub group: String,
    /// Who writes to it.
    pub from: Actor,
    /// Who reads from it.
    pub to: Actor,
    /// How many words it can hold.
    pub capacity: Words,
}

/// What a machine is made of. Figures of stations and FIFOs stand in this order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// How many stations there are: cells, from left to right.
    pub stations: usize,
    /// The FIFOs that carry words.
    pub fifos: Vec<FifoInfo>,
    /// The states of stations, as far as they occur.
    pub states: States,
}

impl Topology {
    /// The FIFO of a group that somebody reads, by its place.
    pub fn fifo_of(&self, group: &str, to: Actor) -> Option<usize> {
        self.fifos.iter().position(|fifo| fifo.group == group && fifo.to == to)
    }

    /// The FIFOs that somebody reads, by their places.
    pub fn inputs_of(&self, to: Actor) -> impl Iterator<Item = usize> + '_ {
        self.fifos.iter().enumerate().filter(move |(_, fifo)| fifo.to == to).map(|(place, _)| place)
    }
}

impl fmt::Display for Actor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Actor::Host => write!(f, "the host"),
            Actor::Station(index) => write!(f, "cell {index}"),
        }
    }
}
