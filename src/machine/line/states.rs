//! The states of a cell.

use crate::measure::{State, StateId, StateKind, States, Toward};
use crate::seam::{Activity, Channel, Vocabulary};

/// Moves a word: reads one, writes one, or both at once.
pub const MOVING: StateId = StateId(Vocabulary::MOST_ACTIVITIES as u8);
/// Has done its last op.
pub const IDLE: StateId = StateId(MOVING.0 + 7);

/// Works.
pub const fn working(activity: Activity) -> StateId {
    StateId(activity.0)
}

/// A read finds nothing.
#[inline(always)]
pub const fn waiting(channel: Channel) -> StateId {
    StateId(MOVING.0 + 1 + channel as u8)
}

/// Whether a cell in that state waits for a word.
#[inline]
pub fn is_waiting(state: StateId) -> bool {
    (MOVING.0 + 1..MOVING.0 + 4).contains(&state.0)
}

/// A write finds no room, or the wire not free.
#[inline(always)]
pub const fn blocked(channel: Channel) -> StateId {
    StateId(MOVING.0 + 4 + channel as u8)
}

/// All states of the cells of an array whose ops have that vocabulary; those of Z are named only where Z is in use.
pub fn states(vocabulary: &Vocabulary, uses_z: bool) -> States {
    let works = vocabulary.activities.iter().zip(0..).map(|((letter, name), activity)| State {
        id: working(Activity(activity)),
        name: name.clone(),
        letter: *letter,
        kind: StateKind::Works,
        stands_at: None,
        used: true,
    });
    let plain =
        |id, name: &str, letter, kind| State { id, name: name.to_owned(), letter, kind, stands_at: None, used: true };
    let channels = || Channel::ALL.into_iter();
    // Words come from the left and room from the right; on Z it is the other way round.
    let sides = |channel, here, other| if channel == Channel::Z { other } else { here };
    let at_fifo = |id, what: &str, letter, kind, channel: Channel, side| State {
        id,
        name: format!("{what} {channel}"),
        letter,
        kind,
        stands_at: Some((channel.to_string(), side)),
        used: uses_z || channel != Channel::Z,
    };
    let waits = channels().map(|channel| {
        let side = sides(channel, Toward::Upstream, Toward::Downstream);
        at_fifo(waiting(channel), "waiting", '.', StateKind::Waits, channel, side)
    });
    let blocks = channels().map(|channel| {
        let side = sides(channel, Toward::Downstream, Toward::Upstream);
        at_fifo(blocked(channel), "blocked", '!', StateKind::Blocked, channel, side)
    });
    let moves = plain(MOVING, "moving", 'm', StateKind::Moves);
    let idle = plain(IDLE, "idle", ' ', StateKind::Idle);
    States::new(works.chain([moves]).chain(waits).chain(blocks).chain([idle]))
}
