//! What a run counts. Every figure is an exact integer.

use super::units::{Cycles, Words};
use super::{Channel, Work};

/// The times and fills of a whole run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunStats {
    /// The number of the cycle in which the host read its last word, plus one. A run that returns no word lasts until
    /// its last op has ended.
    pub cycles: Cycles,
    /// Rays that the host sent.
    pub rays: u64,
    /// One entry a cell, from left to right.
    pub cells: Vec<CellStats>,
    /// `X0`, `X1`, ..., then `Y1`, `Y2`, ..., `Yhost`, each named after the cell that reads it.
    pub fifos: Vec<FifoStats>,
}

/// Cycles spent computing, by what was computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Busy(pub [Cycles; 4]);

impl Busy {
    /// The cycles of one kind of work.
    pub fn of(&self, work: Work) -> Cycles {
        self.0[work as usize]
    }

    /// All of them.
    pub fn total(&self) -> Cycles {
        self.0.iter().copied().sum()
    }
}

/// Where one cell spent its cycles: every cycle of the run is in exactly one of these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellStats {
    /// Computing.
    pub busy: Busy,
    /// Moving a word (reading, writing, or both at once).
    pub moving: Cycles,
    /// A read from X found nothing to read.
    pub waiting_x: Cycles,
    /// A read from Y found nothing to read.
    pub waiting_y: Cycles,
    /// A write to X found no room, or the link not free.
    pub blocked_x: Cycles,
    /// A write to Y found no room, or the link not free.
    pub blocked_y: Cycles,
    /// After the last op.
    pub idle: Cycles,
}

impl CellStats {
    pub(super) fn waiting(&mut self, channel: Channel) -> &mut Cycles {
        match channel {
            Channel::X => &mut self.waiting_x,
            Channel::Y => &mut self.waiting_y,
        }
    }

    pub(super) fn blocked(&mut self, channel: Channel) -> &mut Cycles {
        match channel {
            Channel::X => &mut self.blocked_x,
            Channel::Y => &mut self.blocked_y,
        }
    }

    /// All cycles but the idle ones.
    pub fn active(&self) -> Cycles {
        let stalls = self.waiting_x + self.waiting_y + self.blocked_x + self.blocked_y;
        self.busy.total() + self.moving + stalls
    }
}

/// What one FIFO held. Occupancy is the number of words written and not yet read at the end of a cycle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoStats {
    /// `X0`, `Y1`, ..., by the cell that reads it; `Yhost`.
    pub name: String,
    /// How many words it can hold.
    pub capacity: Words,
    /// How many words were written to it.
    pub words: Words,
    /// The highest occupancy.
    pub max: Words,
    /// The sum of the occupancies of all cycles, in words times cycles.
    pub word_cycles: u64,
    /// Cycles at whose end it was full.
    pub full: Cycles,
    /// Cycles at whose end it was empty.
    pub empty: Cycles,
}

impl FifoStats {
    /// The mean occupancy, in words, over a run of `cycles` cycles.
    pub fn mean(&self, cycles: Cycles) -> f64 {
        if cycles.0 == 0 { 0.0 } else { self.word_cycles as f64 / cycles.0 as f64 }
    }
}
