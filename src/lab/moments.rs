//! Moments of a run, for who steps through it: other cycles than the page holds, the next in which something comes to pass, and what
//! single rays come to. The run is timed again from what its cells did, if that is at hand.

use std::convert::Infallible;
use std::ops::Range;
use std::sync::Arc;

use axum::extract::{Path, Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use pcs_sim::error::InputError;
use pcs_sim::measure::{Actor, FifoLevels, JobSpan, Recording, StateKind, StationRecord, When};
use pcs_sim::quantities::{Cycles, Words};
use pcs_sim::report::page;
use pcs_sim::run::{Outcome, RunError, Setup, Watching, Workers};

use super::Lab;
use super::request::{Asked, Pairs};
use super::streams::whole;

/// `GET /window/FROM/UNTIL?...`: these cycles one by one, or as many of them as a page holds.
pub async fn window(
    State(lab): State<Arc<Lab>>,
    Path((from, until)): Path<(u64, u64)>,
    Query(pairs): Query<Pairs>,
) -> Response {
    answered(lab, pairs, move |run| run.window(Cycles(from)..Cycles(until))).await
}

/// `GET /find/AFTER/WHAT...?...`: the next cycle in which that comes to pass, or nothing.
pub async fn find(
    State(lab): State<Arc<Lab>>,
    Path((after, what)): Path<(u64, String)>,
    Query(pairs): Query<Pairs>,
) -> Response {
    answered(lab, pairs, move |run| {
        let words: Vec<&str> = what.split('/').collect();
        let sought = Sought::new(&words).ok_or_else(|| InputError::new(format!("no moment is called {what}")))?;
        let found = run.find(sought, Cycles(after))?;
        Ok(found.map_or("null".to_owned(), |cycle| cycle.0.to_string()))
    })
    .await
}

/// `GET /ray/X/Y?...`: the number of a pixel's ray in the order in which they are sent, or nothing.
pub async fn ray(State(lab): State<Arc<Lab>>, Path((x, y)): Path<(u32, u32)>, Query(pairs): Query<Pairs>) -> Response {
    answered(lab, pairs, move |run| {
        let setup = run.setup()?;
        let size = setup.spec.size;
        let pixel = (x < size.width && y < size.height).then(|| (x + size.width * y) as usize);
        let place = (0..setup.prepared.rays.len()).position(|place| Some(setup.prepared.number(place)) == pixel);
        Ok(place.map_or("null".to_owned(), |place| place.to_string()))
    })
    .await
}

/// `GET /look/RAY?...`: a ray's way through the scene.
pub async fn look(State(lab): State<Arc<Lab>>, Path(ray): Path<u32>, Query(pairs): Query<Pairs>) -> Response {
    answered(lab, pairs, move |run| told(page::look(&run.setup()?, ray))).await
}

/// `GET /instructions/CELL/RAY?...`: the instructions that a cell executes for a ray.
pub async fn instructions(
    State(lab): State<Arc<Lab>>,
    Path((cell, ray)): Path<(usize, u32)>,
    Query(pairs): Query<Pairs>,
) -> Response {
    answered(lab, pairs, move |run| {
        let setup = run.setup()?;
        match cell < setup.workload.cells() {
            true => told(page::instructions(&setup, cell, ray)),
            false => Ok("null".to_owned()),
        }
    })
    .await
}

/// What is asked of a run, as JSON.
type Told = Result<String, RunError<Infallible>>;

fn told(made: Result<String, page::PageError>) -> Told {
    made.map_err(|error| InputError::new(error.to_string()).into())
}

async fn answered(lab: Arc<Lab>, pairs: Pairs, ask: impl FnOnce(&mut Run<'_>) -> Told + Send + 'static) -> Response {
    whole(lab.turns.clone(), move |cancel| {
        let asked = Asked::new(&lab, &pairs);
        let told = asked.map_err(RunError::from).and_then(|asked| {
            let workers = Workers { threads: lab.threads, cancel };
            ask(&mut Run { lab: &lab, asked: &asked, workers })
        });
        match told {
            Ok(json) => ([(header::CONTENT_TYPE, "application/json")], json).into_response(),
            Err(error) => (StatusCode::UNPROCESSABLE_ENTITY, lab.failure(error)).into_response(),
        }
    })
    .await
}

/// A run of which something is asked.
struct Run<'a> {
    lab: &'a Lab,
    asked: &'a Asked,
    workers: Workers,
}

impl Run<'_> {
    fn setup(&mut self) -> Result<Setup, RunError<Infallible>> {
        let planned = &self.asked.planned;
        let mut layers = self.lab.benches.layers(planned);
        Ok(Setup::new(planned.clone(), &mut layers, &self.workers.cancel)?)
    }

    /// Runs it again, watched.
    fn watched(&mut self, watching: &Watching) -> Result<Outcome, RunError<Infallible>> {
        let planned = &self.asked.planned;
        let mut layers = self.lab.benches.layers(planned);
        let room = self.lab.benches.room();
        let outcome = layers.run(planned, watching, (&self.workers, room.memory), |_, _| ());
        self.lab.benches.keep(planned, layers);
        outcome
    }

    /// Some cycles of it, as many as are recorded at once.
    fn recorded(&mut self, cycles: Range<Cycles>) -> Result<Recording, RunError<Infallible>> {
        let outcome = self.watched(&Watching { recording: Some(cycles), ..Watching::default() })?;
        let recording = outcome.observed.recording;
        recording.ok_or_else(|| InputError::new("nothing was recorded").into())
    }

    fn window(&mut self, cycles: Range<Cycles>) -> Told {
        if cycles.is_empty() {
            return Err(InputError::new("a window has at least one cycle").into());
        }
        told(page::window(&self.recorded(cycles)?))
    }

    /// The first cycle after one in which something comes to pass; of a ray the one in which it does.
    fn find(&mut self, sought: Sought<'_>, after: Cycles) -> Result<Option<Cycles>, RunError<Infallible>> {
        if let Sought::Ray(job, place) = sought {
            return self.arrival(job, place);
        }
        let mut from = after;
        for _ in 0..MOST_WINDOWS {
            let recording = self.recorded(from..Cycles(u64::MAX))?;
            if let Some(found) = sought.first_in(&recording, from) {
                return Ok(Some(found));
            }
            if recording.window.end >= recording.cycles || recording.window.end.0 <= from.0 + 1 {
                return Ok(None);
            }
            // What holds in the last cycle has not begun in the next.
            from = Cycles(recording.window.end.0 - 1);
        }
        Ok(None)
    }

    /// When a ray comes somewhere: it is looked for about a cycle in which its cell is at it.
    fn arrival(&mut self, job: u32, place: Place) -> Result<Option<Cycles>, RunError<Infallible>> {
        let setup = self.setup()?;
        let station = match place {
            Place::Sent => 0,
            Place::Cell(cell) => cell,
            Place::Back => setup.workload.cells() - 1,
        };
        if station >= setup.workload.cells() || job as usize >= setup.prepared.rays.len() {
            return Ok(None);
        }
        let watching = Watching { moment: Some(When::Job { station, job }), ..Watching::default() };
        let Some(about) = self.watched(&watching)?.observed.looked_at else { return Ok(None) };
        for reach in (0..MOST_WINDOWS).map(|times| FIRST_REACH << times) {
            let recording = self.recorded(Cycles(about.0.saturating_sub(reach))..Cycles(u64::MAX))?;
            let span = place.spans(&recording).iter().find(|span| span.job == job);
            let is_cut = |span: &&JobSpan| span.from == recording.window.start && recording.window.start > Cycles(0);
            if let Some(span) = span.filter(|span| !is_cut(span)) {
                return Ok(Some(span.from));
            }
            if recording.window.start == Cycles(0) {
                return Ok(None);
            }
        }
        Ok(None)
    }
}

/// Windows that are looked through for a moment, at the most.
const MOST_WINDOWS: usize = 24;

/// Cycles before one in which a ray is somewhere that are looked through first for when it came there.
const FIRST_REACH: u64 = 4096;

/// Something that comes to pass.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sought<'a> {
    /// A FIFO gets full, or empty.
    Level { fifo: &'a str, is_full: bool },
    /// Somebody comes into a state.
    State { actor: Actor, kind: StateKind },
    /// A ray comes somewhere.
    Ray(u32, Place),
}

/// Where a ray comes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// The host sends it.
    Sent,
    /// A cell begins with it.
    Cell(usize),
    /// The host reads its hit.
    Back,
}

impl Place {
    fn spans(self, recording: &Recording) -> &[JobSpan] {
        match self {
            Place::Sent => recording.host.as_ref().map_or(&[], |host| &host.jobs),
            Place::Cell(cell) => recording.stations.get(cell).map_or(&[], |station| &station.jobs),
            Place::Back => &recording.answers,
        }
    }
}

impl<'a> Sought<'a> {
    /// What words name: `X1 full`, `cell 2 waits`, `host blocked`, `ray 17`, `ray 17 cell 3`, `ray 17 back`.
    fn new(words: &[&'a str]) -> Option<Sought<'a>> {
        let kind = |word: &str| match word {
            "waits" => Some(StateKind::Waits),
            "blocked" => Some(StateKind::Blocked),
            "works" => Some(StateKind::Works),
            "moves" => Some(StateKind::Moves),
            _ => None,
        };
        match *words {
            ["ray", ray] => Some(Sought::Ray(ray.parse().ok()?, Place::Sent)),
            ["ray", ray, "back"] => Some(Sought::Ray(ray.parse().ok()?, Place::Back)),
            ["ray", ray, "cell", cell] => Some(Sought::Ray(ray.parse().ok()?, Place::Cell(cell.parse().ok()?))),
            ["host", state] => Some(Sought::State { actor: Actor::Host, kind: kind(state)? }),
            ["cell", cell, state] => {
                Some(Sought::State { actor: Actor::Station(cell.parse().ok()?), kind: kind(state)? })
            }
            [fifo, "full"] => Some(Sought::Level { fifo, is_full: true }),
            [fifo, "empty"] => Some(Sought::Level { fifo, is_full: false }),
            _ => None,
        }
    }

    /// The first cycle of a recording after one in which it begins to hold.
    fn first_in(self, recording: &Recording, after: Cycles) -> Option<Cycles> {
        match self {
            Sought::Level { fifo, is_full } => {
                let at = recording.topology.fifos.iter().position(|info| info.name.eq_ignore_ascii_case(fifo))?;
                let wanted = if is_full { recording.topology.fifos[at].capacity? } else { Words(0) };
                let FifoLevels { levels, .. } = recording.fifos.get(at)?;
                begins(levels.iter().map(|&(from, words)| (from, words == wanted)), after)
            }
            Sought::State { actor, kind } => {
                let StationRecord { states, .. } = match actor {
                    Actor::Host => recording.host.as_ref()?,
                    Actor::Station(station) => recording.stations.get(station)?,
                };
                let kinds = &recording.topology.states;
                let is_of = |id| kinds.all().iter().any(|state| state.id == id && state.kind == kind);
                begins(states.iter().map(|stretch| (stretch.from, is_of(stretch.state))), after)
            }
            Sought::Ray(..) => None,
        }
    }
}

/// The first time after a cycle from which something holds that did not before.
fn begins(times: impl Iterator<Item = (Cycles, bool)>, after: Cycles) -> Option<Cycles> {
    let mut held = false;
    for (from, holds) in times {
        if holds && !held && from > after {
            return Some(from);
        }
        held = holds;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_have_names() {
        assert_eq!(Sought::new(&["X1", "full"]), Some(Sought::Level { fifo: "X1", is_full: true }));
        let waits = Sought::State { actor: Actor::Station(2), kind: StateKind::Waits };
        assert_eq!(Sought::new(&["cell", "2", "waits"]), Some(waits));
        assert_eq!(Sought::new(&["ray", "17", "cell", "3"]), Some(Sought::Ray(17, Place::Cell(3))));
        let others: [&[&str]; 5] = [&[], &["ray"], &["ray", "x"], &["cell", "2"], &["cell", "2", "sleeps"]];
        assert!(others.iter().all(|words| Sought::new(words).is_none()));
    }

    #[test]
    fn what_holds_already_does_not_begin() {
        let times = [(0, true), (3, true), (5, false), (8, true), (9, true), (12, false), (20, true)];
        let after = |cycle| begins(times.iter().map(|&(from, holds)| (Cycles(from), holds)), Cycles(cycle));
        assert_eq!([0, 7, 8, 19, 20].map(after), [Some(8), Some(8), Some(20), Some(20), None].map(|c| c.map(Cycles)));
    }
}
