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

/// What a cell does in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CellState {
    /// Computes.
    Busy(Work),
    /// Moves a word.
    Moving,
    /// A read finds nothing.
    Waiting(Channel),
    /// A write finds no room, or the link not free.
    Blocked(Channel),
    /// Has done its last op.
    Idle,
}

impl CellState {
    /// All states, in the order in which reports name them.
    pub const ALL: [CellState; 10] = [
        CellState::Busy(Work::Grid),
        CellState::Busy(Work::Slabs),
        CellState::Busy(Work::Intersection),
        CellState::Busy(Work::Other),
        CellState::Moving,
        CellState::Waiting(Channel::X),
        CellState::Waiting(Channel::Y),
        CellState::Blocked(Channel::X),
        CellState::Blocked(Channel::Y),
        CellState::Idle,
    ];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            CellState::Busy(Work::Grid) => "grid",
            CellState::Busy(Work::Slabs) => "slabs",
            CellState::Busy(Work::Intersection) => "intersection",
            CellState::Busy(Work::Other) => "other",
            CellState::Moving => "moving",
            CellState::Waiting(Channel::X) => "waiting X",
            CellState::Waiting(Channel::Y) => "waiting Y",
            CellState::Blocked(Channel::X) => "blocked X",
            CellState::Blocked(Channel::Y) => "blocked Y",
            CellState::Idle => "idle",
        }
    }
}

impl CellStats {
    /// The cycles spent in a state.
    pub fn of(&self, state: CellState) -> Cycles {
        match state {
            CellState::Busy(work) => self.busy.of(work),
            CellState::Moving => self.moving,
            CellState::Waiting(Channel::X) => self.waiting_x,
            CellState::Waiting(Channel::Y) => self.waiting_y,
            CellState::Blocked(Channel::X) => self.blocked_x,
            CellState::Blocked(Channel::Y) => self.blocked_y,
            CellState::Idle => self.idle,
        }
    }

    #[inline(always)]
    pub(super) fn of_mut(&mut self, state: CellState) -> &mut Cycles {
        match state {
            CellState::Busy(work) => &mut self.busy.0[work as usize],
            CellState::Moving => &mut self.moving,
            CellState::Waiting(Channel::X) => &mut self.waiting_x,
            CellState::Waiting(Channel::Y) => &mut self.waiting_y,
            CellState::Blocked(Channel::X) => &mut self.blocked_x,
            CellState::Blocked(Channel::Y) => &mut self.blocked_y,
            CellState::Idle => &mut self.idle,
        }
    }

    /// Takes in the cycles of another cell, or of another time.
    pub(super) fn add(&mut self, other: &CellStats) {
        for state in CellState::ALL {
            *self.of_mut(state) += other.of(state);
        }
    }

    /// The cycles of some cells together.
    pub fn sum(cells: &[CellStats]) -> CellStats {
        let mut sum = CellStats::default();
        cells.iter().for_each(|cell| sum.add(cell));
        sum
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

/// The name of the FIFO of a channel of link `link` in an array of `cells` cells: `X0`, `Y1`, ..., `Yhost`.
pub(super) fn fifo_name(channel: Channel, link: usize, cells: usize) -> String {
    let reader = if link == cells { "host".to_owned() } else { link.to_string() };
    format!("{channel}{reader}")
}

impl FifoStats {
    /// The mean occupancy, in words, over a run of `cycles` cycles.
    pub fn mean(&self, cycles: Cycles) -> f64 {
        if cycles.0 == 0 { 0.0 } else { self.word_cycles as f64 / cycles.0 as f64 }
    }
}
