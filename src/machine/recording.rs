//! What an array did cycle by cycle in a window of time, as a recorder saw it.

use std::ops::Range;

use super::stats::CellState;
use super::units::{Cycles, Words};

/// A window of a run, exact to the cycle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recording {
    /// The cycles that are recorded, from the first to before the last: empty if the run ended before them.
    pub window: Range<Cycles>,
    /// Length of the whole run.
    pub cycles: Cycles,
    /// Whether the window ends earlier than was asked for, because more happened than a recording holds.
    pub cut: bool,
    /// The host as it sends rays. Waiting for a HIT is waiting on Y.
    pub host: Activity,
    /// When the host read the HIT of each ray.
    pub hits: Vec<Visit>,
    /// The cells, from left to right.
    pub cells: Vec<Activity>,
    /// The FIFOs, in the order of [`super::RunStats::fifos`].
    pub fifos: Vec<FifoLevels>,
}

/// What a cell, or the host, did in a window.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Activity {
    /// Its states, one after the other without a gap. No stretch goes over the start or the end of a visit.
    pub states: Vec<Stretch>,
    /// The rays that it worked on, one after the other.
    pub visits: Vec<Visit>,
}

/// Cycles that are spent in one state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// The state.
    pub state: CellState,
    /// The first cycle.
    pub from: Cycles,
    /// The cycle after the last.
    pub until: Cycles,
}

/// The time of a ray in a cell: from the first cycle of its line of ops in which the cell does not wait, to the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    /// The ray's number.
    pub ray: u32,
    /// The first cycle.
    pub from: Cycles,
    /// The cycle after the last.
    pub until: Cycles,
}

/// What a FIFO held in a window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoLevels {
    /// As in [`super::FifoStats`].
    pub name: String,
    /// How many words it can hold.
    pub capacity: Words,
    /// The first cycle of the window, and each one in which the level changes, with the level at its end.
    pub levels: Vec<(Cycles, Words)>,
}

impl Recording {
    /// How many stretches, visits and moves of words a recording holds at the most: what viewers open with ease, and a
    /// bound on its memory and on its files whatever the length of the run.
    pub const MOST_EVENTS: usize = 400_000;

    /// The FIFOs that a cell reads, X first and Z, where it carries words, last; after the last cell comes the host, which reads Yhost.
    pub fn inputs_of(&self, reader: usize) -> impl Iterator<Item = &FifoLevels> {
        let cells = self.cells.len();
        let x = (reader < cells).then_some(reader);
        let y = (reader > 0).then_some(cells + reader - 1);
        let z = self.fifos.iter().skip(2 * cells).find(move |fifo| fifo.name == format!("Z{reader}"));
        x.into_iter().chain(y).filter_map(|fifo| self.fifos.get(fifo)).chain(z)
    }
}
