//! A recording as signals that change, as waveform formats have it.

use std::ops::Range;

use super::Trace;
use crate::measure::{Actor, FifoInfo, FifoLevels, JobSpan, StateId, StateTimes, States, StationRecord};
use crate::quantities::{Cycles, Words};

/// A name for each state, by its number; waveform formats have no spaces in them.
pub struct StateNames([String; StateTimes::MOST_STATES]);

/// The signals of one party: what it does, and the FIFOs that it reads.
pub struct Scope {
    /// What it is called.
    pub title: String,
    /// The same as one word.
    pub name: String,
    /// What is in it.
    pub signals: Vec<Signal>,
}

/// One signal.
pub struct Signal {
    /// Its name.
    pub name: String,
    /// What its values are.
    pub kind: Kind,
}

/// What a signal's values are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Words.
    Text,
    /// Numbers of so many bits.
    Number(u32),
}

/// A signal's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value<'a> {
    /// A word.
    Text(&'a str),
    /// A number.
    Number(u64),
    /// No ray.
    Nothing,
}

/// A signal takes another value.
#[derive(Clone, Copy, Debug)]
pub struct Change<'a> {
    /// The first cycle with that value.
    pub at: Cycles,
    /// The signal, by its place among those of all scopes.
    pub signal: usize,
    /// The value.
    pub value: Value<'a>,
}

/// All signals, and their changes in the order of time, which begin with the first value of each.
#[derive(Default)]
pub struct Signals<'a> {
    /// The array from left to right.
    pub scopes: Vec<Scope>,
    /// What changes when.
    pub changes: Vec<Change<'a>>,
    count: usize,
}

impl StateNames {
    pub fn new(states: &States) -> StateNames {
        let name = |id: usize| states.get(StateId(id as u8)).map_or(String::new(), |state| word(&state.name));
        StateNames(std::array::from_fn(name))
    }

    fn of(&self, state: StateId) -> &str {
        self.0.get(state.0 as usize).map_or("", String::as_str)
    }
}

impl<'a> Signals<'a> {
    pub fn new(trace: &Trace<'_>, names: &'a StateNames) -> Signals<'a> {
        let recording = trace.recording;
        let window = &recording.window;
        let mut all = Signals::default();
        let job = &recording.topology.names.job;
        if let Some(host) = &recording.host {
            all.scope("host sends");
            all.activity(host, (job, window), names);
        }
        let levels = |all: &mut Signals<'a>, reader: Actor| {
            let fifos = recording.topology.inputs_of(reader);
            fifos.for_each(|fifo| all.levels(&recording.topology.fifos[fifo], &recording.fifos[fifo]));
        };
        for (index, cell) in recording.stations.iter().enumerate() {
            all.scope(&trace.station_name(index));
            levels(&mut all, Actor::Station(index));
            all.activity(cell, (job, window), names);
        }
        if recording.host.is_some() {
            all.scope("host reads");
            levels(&mut all, Actor::Host);
            all.jobs("hit", &recording.answers, window);
        }
        // Each signal's changes are in order, which makes this a merge.
        all.changes.sort_by_key(|change| change.at);
        all
    }

    fn scope(&mut self, name: &str) {
        self.scopes.push(Scope { title: name.to_owned(), name: word(name), signals: Vec::new() });
    }

    /// Adds a signal to the last scope, and returns its place. Viewers that show the last part of a name alone show the scope's, too.
    fn signal(&mut self, name: &str, kind: Kind) -> usize {
        if let Some(scope) = self.scopes.last_mut() {
            let name = format!("{}_{}", scope.name, word(name));
            scope.signals.push(Signal { name, kind });
        }
        self.count += 1;
        self.count - 1
    }

    fn levels(&mut self, info: &FifoInfo, fifo: &FifoLevels) {
        // What takes all has as many bits as it needs.
        let highest = || fifo.levels.iter().map(|(_, level)| *level).max().unwrap_or_default().max(Words(1));
        let most = info.capacity.unwrap_or_else(highest);
        let signal = self.signal(&info.name, Kind::Number(u64::BITS - most.0.leading_zeros()));
        let change = |&(at, Words(level))| Change { at, signal, value: Value::Number(level) };
        self.changes.extend(fifo.levels.iter().map(change));
    }

    fn activity(&mut self, record: &StationRecord, (job, window): (&str, &Range<Cycles>), names: &'a StateNames) {
        let signal = self.signal("state", Kind::Text);
        let mut last = None;
        for stretch in record.states.iter().filter(|stretch| last.replace(stretch.state) != Some(stretch.state)) {
            self.changes.push(Change { at: stretch.from, signal, value: Value::Text(names.of(stretch.state)) });
        }
        self.jobs(job, &record.jobs, window);
    }

    fn jobs(&mut self, name: &str, jobs: &[JobSpan], window: &Range<Cycles>) {
        let signal = self.signal(name, Kind::Number(u32::BITS));
        let mut free_from = window.start;
        for span in jobs {
            self.nothing(signal, free_from..span.from);
            self.changes.push(Change { at: span.from, signal, value: Value::Number(span.job as u64) });
            free_from = span.until;
        }
        self.nothing(signal, free_from..window.end);
    }

    fn nothing(&mut self, signal: usize, cycles: Range<Cycles>) {
        if !cycles.is_empty() {
            self.changes.push(Change { at: cycles.start, signal, value: Value::Nothing });
        }
    }
}

/// A name as one word.
fn word(name: &str) -> String {
    name.replace(|char: char| !char.is_ascii_alphanumeric(), "_")
}
