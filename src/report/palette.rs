//! Colours with one meaning each, in plots and on pages alike: the palette of Okabe and Ito, which colour-blind readers can
//! tell apart.

use crate::measure::{State, StateKind, States};

/// Red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

/// Amounts: what a FIFO holds on average, rays that are done, how much a cell works. Colours are for states.
pub const AMOUNT: Rgb = Rgb(55, 65, 95);
/// From the lowest to the highest amount.
pub const RANGE: Rgb = Rgb(168, 178, 208);
/// A FIFO that is full, which blocks its writer.
pub const FULL: Rgb = Rgb(213, 94, 0);

/// The way of an answer, beside that of what it is the answer to.
pub const ANSWER: Rgb = Rgb(0, 158, 115);

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

/// What a station works on, one after the other: blue, green, sky blue, purple, then more.
const WORKS: [Rgb; 8] = [
    Rgb(0, 114, 178),
    Rgb(0, 158, 115),
    Rgb(86, 180, 233),
    Rgb(204, 121, 167),
    Rgb(102, 102, 204),
    Rgb(136, 204, 170),
    Rgb(170, 120, 60),
    Rgb(230, 180, 210),
];
/// Black and grey: a station that moves words.
const MOVES: [Rgb; 2] = [Rgb(0, 0, 0), Rgb(120, 120, 120)];
/// Yellows: a station that waits.
pub const WAITS: [Rgb; 4] = [Rgb(240, 228, 66), Rgb(250, 243, 176), Rgb(196, 180, 60), Rgb(214, 206, 160)];
/// Reds: a station that is blocked.
const BLOCKED: [Rgb; 3] = [Rgb(213, 94, 0), Rgb(230, 159, 0), Rgb(150, 62, 0)];

/// The colour of a state: by its kind, and by its place among the states of that kind.
pub fn of_state(states: &States, state: &State) -> Rgb {
    let place = states.all().iter().filter(|other| other.kind == state.kind).position(|other| other.id == state.id);
    let of = |colors: &[Rgb]| colors[place.unwrap_or_default() % colors.len()];
    match state.kind {
        StateKind::Works => of(&WORKS),
        StateKind::Moves => of(&MOVES),
        StateKind::Waits => of(&WAITS),
        StateKind::Blocked => of(&BLOCKED),
        StateKind::Idle => Rgb(225, 225, 225),
    }
}

/// A colour as it is on white, and as it is on black: what would not be seen there is lighter, or darker.
pub fn on_both(color: Rgb) -> [String; 2] {
    let on_black = match color {
        AMOUNT => Rgb(160, 175, 220),
        RANGE => Rgb(74, 84, 116),
        Rgb(0, 0, 0) => Rgb(240, 240, 240),
        Rgb(225, 225, 225) => Rgb(66, 66, 70),
        other => other,
    };
    [color.to_string(), on_black.to_string()]
}

impl std::fmt::Display for Rgb {
    /// As in CSS.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}
