//! Colours with one meaning each, in plots and on pages alike: the palette of Okabe and Ito, which colour-blind readers can
//! tell apart.

use crate::machine::{CellState, Channel, Work};

/// Red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

/// Amounts: what a FIFO holds on average, rays that are done, how much a cell works. Colours are for states.
pub const AMOUNT: Rgb = Rgb(55, 65, 95);
/// From the lowest to the highest amount.
pub const RANGE: Rgb = Rgb(168, 178, 208);
/// A FIFO that is full, which blocks its writer.
pub const FULL: Rgb = Rgb(213, 94, 0);

/// Lines that differ in what a caption says: blue, vermilion, green, orange, sky blue, purple, black.
pub const LINES: [Rgb; 7] = [
    Rgb(0, 114, 178),
    Rgb(213, 94, 0),
    Rgb(0, 158, 115),
    Rgb(230, 159, 0),
    Rgb(86, 180, 233),
    Rgb(204, 121, 167),
    Rgb(0, 0, 0),
];

/// The colour of what a cell does.
pub fn of_state(state: CellState) -> Rgb {
    match state {
        CellState::Busy(Work::Grid) => Rgb(0, 114, 178),
        CellState::Busy(Work::Slabs) => Rgb(0, 158, 115),
        CellState::Busy(Work::Intersection) => Rgb(86, 180, 233),
        CellState::Busy(Work::Other) => Rgb(204, 121, 167),
        CellState::Moving => Rgb(0, 0, 0),
        CellState::Waiting(Channel::X) => Rgb(240, 228, 66),
        CellState::Waiting(Channel::Y) => Rgb(250, 243, 176),
        CellState::Waiting(Channel::Z) => Rgb(196, 180, 60),
        CellState::Blocked(Channel::X) => Rgb(213, 94, 0),
        CellState::Blocked(Channel::Y) => Rgb(230, 159, 0),
        CellState::Blocked(Channel::Z) => Rgb(150, 62, 0),
        CellState::Idle => Rgb(225, 225, 225),
    }
}

impl std::fmt::Display for Rgb {
    /// As in CSS.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}
