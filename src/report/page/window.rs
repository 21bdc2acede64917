//! The cycles of a run that a page holds one by one, packed: what the page's script tells a moment from.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::measure::{Actor, FifoInfo, FifoLevels, JobSpan, Recording, StateKind, StationRecord, Topology, Toward};
use crate::quantities::{Cycles, Words};

/// Stretches, jobs and levels that a page holds at the most, whatever the length of the run: about half a megabyte.
const MOST_EVENTS: usize = 150_000;

/// A window of a run. All times are in cycles; `from` is the first cycle, `until` the one after the last.
#[derive(Serialize)]
pub struct Window<'a> {
    from: u64,
    until: u64,
    states: Vec<State<'a>>,
    host: Option<Station>,
    /// When the host read the answers.
    answers: Packed,
    stations: Vec<Station>,
    fifos: Vec<Fifo>,
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
}

#[derive(Serialize)]
struct Fifo {
    from: Option<usize>,
    to: Option<usize>,
    group: String,
    /// For each change the cycles since the last one, and the words that it is more or less; the first from nothing.
    levels: Packed,
    jobs: Packed,
}

/// Whole numbers in as few bytes as they need, seven bits each, the lowest first; in base 64. Those that may be negative are
/// folded: 0, -1, 1, -2, ... are 0, 1, 2, 3, ...
#[derive(Serialize)]
struct Packed(String);

impl<'a> Window<'a> {
    /// The beginning of a recording.
    pub fn new(recording: &'a Recording) -> Window<'a> {
        let Recording { window, topology, .. } = recording;
        let range = window.start..recording.end_of_beginning(MOST_EVENTS).max(window.start);
        let station =
            |record: &StationRecord| Station {
                states: Packed::new(
                    record.states.iter().filter(|stretch| stretch.from < range.end).flat_map(|stretch| {
                        [u64::from(stretch.state.0), stretch.until.min(range.end).0 - stretch.from.0]
                    }),
                ),
                jobs: Packed::jobs(&record.jobs, (range.start, range.end)),
            };
        let fifo = |(info, held): (&FifoInfo, &FifoLevels)| Fifo {
            from: place(info.from),
            to: place(info.to),
            group: info.group.clone(),
            levels: Packed::levels(&held.levels, (range.start, range.end)),
            jobs: Packed::jobs(&held.jobs, (range.start, range.end)),
        };
        Window {
            from: range.start.0,
            until: range.end.0,
            states: states(topology),
            host: recording.host.as_ref().map(station),
            answers: Packed::jobs(&recording.answers, (range.start, range.end)),
            stations: recording.stations.iter().map(station).collect(),
            fifos: topology.fifos.iter().zip(&recording.fifos).map(fifo).collect(),
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

fn folded(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}

impl Packed {
    fn new(numbers: impl Iterator<Item = u64>) -> Packed {
        let mut bytes = Vec::new();
        for mut number in numbers {
            while number > 0x7f {
                bytes.push(number as u8 | 0x80);
                number >>= 7;
            }
            bytes.push(number as u8);
        }
        Packed(STANDARD.encode(bytes))
    }

    /// For each job its number against the one before it, when it began after that had, and how long it took.
    fn jobs(jobs: &[JobSpan], (start, end): (Cycles, Cycles)) -> Packed {
        let (mut job, mut from) = (0, start);
        Packed::new(jobs.iter().filter(|span| span.from < end).flat_map(|span| {
            let numbers =
                [folded(i64::from(span.job) - job), span.from.0 - from.0, span.until.min(end).0 - span.from.0];
            (job, from) = (i64::from(span.job), span.from);
            numbers
        }))
    }

    fn levels(levels: &[(Cycles, Words)], (start, end): (Cycles, Cycles)) -> Packed {
        let (mut at, mut level) = (start, Words(0));
        Packed::new(levels.iter().filter(|change| change.0 < end).flat_map(|&(next, words)| {
            let numbers = [next.0 - at.0, folded(words.0 as i64 - level.0 as i64)];
            (at, level) = (next, words);
            numbers
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_as_few_bytes_as_they_need() {
        let packed = Packed::new([0, 127, 128, 300].into_iter());
        assert_eq!(STANDARD.decode(packed.0).unwrap(), [0, 127, 0x80, 1, 0xac, 2]);
        assert_eq!([0, -1, 1, -2, i64::MAX].map(folded), [0, 1, 2, 3, u64::MAX - 1]);
    }
}
