//! What a machine is made of.

use std::fmt;
use std::str::FromStr;

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
    /// How many words it can hold; none if it takes all that come.
    pub capacity: Option<Words>,
}

impl FifoInfo {
    /// Whether so many words fill it.
    pub fn is_full(&self, held: Words) -> bool {
        self.capacity.is_some_and(|capacity| held >= capacity)
    }
}

/// How the stations of a machine stand to each other, for reports that draw it or say what limits it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// In a row, from left to right, with the host at both ends.
    #[default]
    Line,
    /// The first gives out the scene and takes what comes of it, the second hands out work, the others do it.
    Farm,
    /// All but the last are nodes of a hypercube, by their numbers; the last is the host, which hangs on the first.
    Cube,
}

/// What reports call the parts of a machine, each in the singular.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// All of it.
    pub machine: String,
    /// A station.
    pub station: String,
    /// The stations, if they have names of their own and not just numbers.
    pub stations: Vec<String>,
    /// A FIFO.
    pub fifo: String,
    /// What FIFOs hold.
    pub word: String,
    /// What comes in numbers, and is begun and done.
    pub job: String,
    /// From when to when the time of a job is counted.
    pub job_time: String,
}

/// What a machine is made of. Figures of stations and FIFOs stand in this order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// How the stations stand to each other.
    pub shape: Shape,
    /// How many stations there are.
    pub stations: usize,
    /// The FIFOs that carry words.
    pub fifos: Vec<FifoInfo>,
    /// The states of stations, as far as they occur.
    pub states: States,
    /// What reports call all this.
    pub names: Names,
}

impl Default for Names {
    /// Those of an array.
    fn default() -> Names {
        Names {
            machine: "array".to_owned(),
            station: "cell".to_owned(),
            stations: Vec::new(),
            fifo: "FIFO".to_owned(),
            word: "word".to_owned(),
            job: "ray".to_owned(),
            job_time: "from their first word sent to their last word back".to_owned(),
        }
    }
}

impl Topology {
    /// The name of a station: `cell 3`, or its own.
    pub fn station(&self, index: usize) -> String {
        self.names.stations.get(index).map_or_else(|| format!("{} {index}", self.names.station), String::clone)
    }

    /// The same where it is clear that a station is meant: `3`, or its own.
    pub fn station_number(&self, index: usize) -> String {
        self.names.stations.get(index).map_or_else(|| index.to_string(), String::clone)
    }

    /// The FIFO of a group that somebody reads, by its place.
    pub fn fifo_of(&self, group: &str, to: Actor) -> Option<usize> {
        self.fifos.iter().position(|fifo| fifo.group == group && fifo.to == to)
    }

    /// The FIFO of a group that somebody writes to, by its place.
    pub fn fifo_from(&self, group: &str, from: Actor) -> Option<usize> {
        self.fifos.iter().position(|fifo| fifo.group == group && fifo.from == from)
    }

    /// The FIFOs that somebody reads, by their places.
    pub fn inputs_of(&self, to: Actor) -> impl Iterator<Item = usize> + '_ {
        self.fifos.iter().enumerate().filter(move |(_, fifo)| fifo.to == to).map(|(place, _)| place)
    }
}

impl FromStr for Actor {
    type Err = String;

    /// A cell's number, or `host`.
    fn from_str(text: &str) -> Result<Actor, String> {
        let cell = || text.parse().map(Actor::Station).map_err(|_| "expected the number of a cell, or host".to_owned());
        if text == "host" { Ok(Actor::Host) } else { cell() }
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
