//! What a node can be at.

use crate::measure::{Names, Shape, State, StateId, StateKind, States, Topology};

/// Walks the grid.
pub const GRID: StateId = StateId(0);
/// Tests against slabs.
pub const SLABS: StateId = StateId(1);
/// Tests for intersection.
pub const INTERSECTION: StateId = StateId(2);
/// Shades a hit.
pub const SHADING: StateId = StateId(3);
/// Begins a pixel.
pub const PIXELS: StateId = StateId(4);
/// Looks pages of others up.
pub const LOOKUP: StateId = StateId(5);
/// Serves others with pages.
pub const SERVING: StateId = StateId(6);
/// Is at work on a message to be sent.
pub const SENDING: StateId = StateId(7);
/// Takes a message.
pub const RECEIVING: StateId = StateId(8);
/// Has a ray for which a queue has no room.
pub const BLOCKED: StateId = StateId(9);
/// Waits for a page.
pub const WAITING_PAGE: StateId = StateId(10);
/// Waits for anything to do.
pub const WAITING: StateId = StateId(11);
/// Has nothing to do any more.
pub const IDLE: StateId = StateId(12);

/// A machine of so many nodes and the host, whose jobs are legs of rays (of whole rays, if they are not sent).
pub fn topology(nodes: usize, job: &str) -> Topology {
    let state = |(id, name, letter, kind): (StateId, &str, char, StateKind)| State {
        id,
        name: name.to_owned(),
        letter,
        kind,
        stands_at: None,
        used: true,
    };
    let all = [
        (GRID, "grid", 'g', StateKind::Works),
        (SLABS, "slabs", 's', StateKind::Works),
        (INTERSECTION, "intersection", 'n', StateKind::Works),
        (SHADING, "shading", 'h', StateKind::Works),
        (PIXELS, "pixels", 'p', StateKind::Works),
        (LOOKUP, "lookup", 'l', StateKind::Works),
        (SERVING, "serving", 'v', StateKind::Moves),
        (SENDING, "sending", '>', StateKind::Moves),
        (RECEIVING, "receiving", '<', StateKind::Moves),
        (BLOCKED, "blocked", '!', StateKind::Blocked),
        (WAITING_PAGE, "waiting page", ':', StateKind::Waits),
        (WAITING, "waiting", '.', StateKind::Waits),
        (IDLE, "idle", ' ', StateKind::Idle),
    ];
    let names = Names {
        machine: "hypercube".to_owned(),
        station: "node".to_owned(),
        stations: (0..nodes).map(|node| format!("node {node}")).chain(["host".to_owned()]).collect(),
        fifo: "queue".to_owned(),
        word: "ray".to_owned(),
        job: job.to_owned(),
        job_time: "from when a node begins them until they are done".to_owned(),
    };
    let states = States::new(all.into_iter().map(state));
    Topology { shape: Shape::Cube, stations: nodes + 1, fifos: Vec::new(), states, names }
}
