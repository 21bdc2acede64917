//! The cycles of a run that a page holds one by one, packed: what the page's script tells a moment from.

use serde::Serialize;

use super::packed::{Packed, folded};
use crate::measure::{Actor, FifoInfo, FifoLevels, OpSpan, Recording, StateKind, StationRecord, Topology, Toward};
use crate::quantities::Cycles;
use crate::seam::Op;

/// Stretches, jobs, ops and moves of words that a page holds at the most, whatever the length of the run: about half a megabyte.
const MOST_EVENTS: usize = 200_000;

/// The letters of ops that move words or wait, in the order of their codes.
const MOVES: &str = "xiorwabz";

/// A window of a run. All times are in cycles; `from` is the first cycle, `until` the one after the last.
#[derive(Serialize)]
pub struct Window<'a> {
    from: u64,
    until: u64,
    /// Length of the run.
    cycles: u64,
    states: Vec<State<'a>>,
    /// Units of work, in the order of their codes.
    units: Vec<Unit<'a>>,
    host: Option<Station>,
    /// When the host read the answers.
    answers: Packed,
    stations: Vec<Station>,
    fifos: Vec<Fifo<'a>>,
}

/// A state by its place, which is its number.
#[derive(Serialize)]
struct State<'a> {
    name: &'a str,
    kind: &'static str,
    /// The group of FIFOs at which it stands, and whether it is their reader.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<&'a str>,
    reads: bool,
}

#[derive(Serialize)]
struct Station {
    /// For each stretch its state and its length, without a gap.
    states: Packed,
    jobs: Packed,
    /// For each op its code, twice, and one more if it is the first of a line; then, if it is, the line's job and one, or 0 for
    /// none, against the line before; its count; and how many cycles it takes from the start of the window on.
    ops: Packed,
    /// How many cycles the first op has taken before that, and how many words it has moved.
    early: [u64; 2],
}

#[derive(Serialize)]
struct Unit<'a> {
    name: &'a str,
    cycles: u64,
}

#[derive(Serialize)]
struct Fifo<'a> {
    name: &'a str,
    capacity: u64,
    from: Option<usize>,
    to: Option<usize>,
    group: String,
    jobs: Packed,
    /// How many words are inside at the start.
    inside: u64,
    /// Whose the words are, from the oldest of these on: the job and one, or 0 for none, against the words before; how many.
    words: Packed,
    writes: Packed,
    reads: Packed,
}

/// The end of what a page holds of a recording.
pub fn end(recording: &Recording) -> Cycles {
    recording.end_of_beginning(MOST_EVENTS).max(recording.window.start)
}

impl<'a> Window<'a> {
    /// The beginning of a recording.
    pub fn new(recording: &'a Recording) -> Window<'a> {
        let Recording { window, topology, .. } = recording;
        let range = window.start..end(recording);
        let ends = (range.start, range.end);
        let fifos = topology.fifos.iter().zip(&recording.fifos);
        Window {
            from: range.start.0,
            until: range.end.0,
            cycles: recording.cycles.0,
            states: states(topology),
            units: recording.units.iter().map(|unit| Unit { name: &unit.name, cycles: unit.cycles.0 }).collect(),
            host: recording.host.as_ref().map(|host| Station::new(host, ends)),
            answers: Packed::jobs(&recording.answers, ends),
            stations: recording.stations.iter().map(|station| Station::new(station, ends)).collect(),
            fifos: fifos.map(|(info, held)| Fifo::new(info, held, ends)).collect(),
        }
    }
}

impl Station {
    fn new(record: &StationRecord, ends: (Cycles, Cycles)) -> Station {
        let (start, end) = ends;
        let states = record.states.iter().filter(|stretch| stretch.from < end);
        let early = record.ops.first().map(|op| [start.0.saturating_sub(op.from.0), op.before.into()]);
        Station {
            states: Packed::new(
                states.flat_map(|stretch| [u64::from(stretch.state.0), stretch.until.min(end).0 - stretch.from.0]),
            ),
            jobs: Packed::jobs(&record.jobs, ends),
            ops: ops(&record.ops, ends),
            early: early.unwrap_or_default(),
        }
    }
}

/// A station's ops, packed.
fn ops(ops: &[OpSpan], (start, end): (Cycles, Cycles)) -> Packed {
    let (mut line, mut last) = (None, 0);
    let inside = ops.iter().filter(|span| span.from < end);
    Packed::new(inside.flat_map(|span| {
        let is_new = line != Some(span.job);
        let job = numbered(span.job);
        let first = is_new.then(|| folded(job - last));
        (line, last) = (Some(span.job), job);
        let length = span.until.min(end).0 - span.from.max(start).0;
        let head = [2 * code(span.op) + u64::from(is_new)].into_iter().chain(first);
        head.chain([span.op.count().into(), length])
    }))
}

/// What an op is: a letter's place, or behind these a unit's.
fn code(op: Op) -> u64 {
    let letter = op.kind().letter().and_then(|letter| MOVES.find(letter));
    letter.map_or(op.unit().map_or(0, |unit| MOVES.len() as u64 + u64::from(unit.0)), |place| place as u64)
}

/// A job and one, or 0 for none.
fn numbered(job: Option<u32>) -> i64 {
    job.map_or(0, |job| i64::from(job) + 1)
}

impl<'a> Fifo<'a> {
    fn new(info: &'a FifoInfo, held: &FifoLevels, ends: (Cycles, Cycles)) -> Fifo<'a> {
        let inside = held.words.iter().map(|words| words.count).sum::<u64>() - held.writes.len() as u64;
        let mut left = inside + held.writes.partition_point(|&time| time < ends.1) as u64;
        let mut last = 0;
        let words = held.words.iter().map_while(|words| {
            let count = words.count.min(left);
            left -= count;
            let job = numbered(words.job);
            let numbers = [folded(job - last), count];
            last = job;
            (count > 0).then_some(numbers)
        });
        Fifo {
            name: &info.name,
            capacity: info.capacity.unwrap_or_default().0,
            from: place(info.from),
            to: place(info.to),
            group: info.group.clone(),
            jobs: Packed::jobs(&held.jobs, ends),
            inside,
            words: Packed::new(words.flatten()),
            writes: Packed::times(&held.writes, ends),
            reads: Packed::times(&held.reads, ends),
        }
    }
}

/// All states in the order of their numbers; a number without a state has an empty one.
fn states(topology: &Topology) -> Vec<State<'_>> {
    let all = topology.states.all();
    let most = all.iter().map(|state| state.id.0).max().unwrap_or(0);
    let of = |number: u8| {
        let state = all.iter().find(|state| state.id.0 == number);
        let at = state.and_then(|state| state.stands_at.as_ref());
        State {
            name: state.map_or("", |state| &state.name),
            kind: state.map_or("idle", |state| kind(state.kind)),
            at: at.map(|(group, _)| group.as_str()),
            reads: state.is_some_and(|state| state.kind == StateKind::Waits)
                || at.is_some_and(|at| at.1 == Toward::Upstream),
        }
    };
    (0..=most).map(of).collect()
}

fn kind(kind: StateKind) -> &'static str {
    match kind {
        StateKind::Works => "works",
        StateKind::Moves => "moves",
        StateKind::Waits => "waits",
        StateKind::Blocked => "blocked",
        StateKind::Idle => "idle",
    }
}

/// A station's place; none is the host's.
fn place(actor: Actor) -> Option<usize> {
    match actor {
        Actor::Host => None,
        Actor::Station(station) => Some(station),
    }
}
