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
    /// `X0`, `X1`, ..., then `Y1`, `Y2`, ..., `Yhost`, each named after the cell that reads it; then those of `Z0`, `Z1`,
    /// ... that a word has passed through.
    pub fifos: Vec<FifoStats>,
}

impl RunStats {
    /// The states that reports show: all but those of Z, unless words went to the left.
    pub fn states(&self) -> impl Iterator<Item = CellState> {
        let with_z = self.sends_back();
        let is_z = |state| matches!(state, CellState::Waiting(Channel::Z) | CellState::Blocked(Channel::Z));
        CellState::ALL.into_iter().filter(move |&state| with_z || !is_z(state))
    }

    /// Whether any word went to the left, on Z.
    pub fn sends_back(&self) -> bool {
        self.fifos.last().is_some_and(|fifo| fifo.name.starts_with('Z'))
    }
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
    /// A read from Z found nothing to read.
    pub waiting_z: Cycles,
    /// A write to X found no room, or the link not free.
    pub blocked_x: Cycles,
    /// A write to Y found no room, or the link not free.
    pub blocked_y: Cycles,
    /// A write to Z found no room, or the link not free.
    pub blocked_z: Cycles,
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
    pub const ALL: [CellState; 12] = [
        CellState::Busy(Work::Grid),
        CellState::Busy(Work::Slabs),
        CellState::Busy(Work::Intersection),
        CellState::Busy(Work::Other),
        CellState::Moving,
        CellState::Waiting(Channel::X),
        CellState::Waiting(Channel::Y),
        CellState::Waiting(Channel::Z),
        CellState::Blocked(Channel::X),
        CellState::Blocked(Channel::Y),
        CellState::Blocked(Channel::Z),
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
            CellState::Waiting(Channel::Z) => "waiting Z",
            CellState::Blocked(Channel::X) => "blocked X",
            CellState::Blocked(Channel::Y) => "blocked Y",
            CellState::Blocked(Channel::Z) => "blocked Z",
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
            CellState::Waiting(Channel::Z) => self.waiting_z,
            CellState::Blocked(Channel::X) => self.blocked_x,
            CellState::Blocked(Channel::Y) => self.blocked_y,
            CellState::Blocked(Channel::Z) => self.blocked_z,
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
            CellState::Waiting(Channel::Z) => &mut self.waiting_z,
            CellState::Blocked(Channel::X) => &mut self.blocked_x,
            CellState::Blocked(Channel::Y) => &mut self.blocked_y,
            CellState::Blocked(Channel::Z) => &mut self.blocked_z,
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
        let waiting = self.waiting_x + self.waiting_y + self.waiting_z;
        let blocked = self.blocked_x + self.blocked_y + self.blocked_z;
        self.busy.total() + self.moving + waiting + blocked
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

/// The name of the FIFO of a channel of link `link`, which leads into cell `link`, in an array of `cells` cells: `X0`, `Y1`,
/// ..., `Yhost`; `Z0` belongs to link 1, as cell 0 reads it.
pub(super) fn fifo_name(channel: Channel, link: usize, cells: usize) -> String {
    let reader = if channel == Channel::Z { link.checked_sub(1) } else { Some(link).filter(|&link| link < cells) };
    reader.map_or_else(|| format!("{channel}host"), |reader| format!("{channel}{reader}"))
}

impl FifoStats {
    /// The mean occupancy, in words, over a run of `cycles` cycles.
    pub fn mean(&self, cycles: Cycles) -> f64 {
        if cycles.0 == 0 { 0.0 } else { self.word_cycles as f64 / cycles.0 as f64 }
    }
}
