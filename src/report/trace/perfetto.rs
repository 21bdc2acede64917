//! Perfetto's format: a track for the array and below it, in the array's order, one for each cell and a counter for each
//! FIFO; for other machines, whatever their topology has in place of these.
//!
//! A cell's track has a slice for each ray and inside it, and between rays, a slice for each state; one in which the cell waits
//! has in its arguments who waits for whom in its middle, down to one that works. Flows lead from where the host
//! begins to send a ray over where the cells begin it to where the host begins to read its HIT. Perfetto draws an arrow from the end of
//! what it leads from, and a cell begins a ray before the one before it has done with it: so they join marks without length, at the
//! starts of the slices, and none points back in time. Stations that send each other whole messages have such flows from
//! where each sets out to where it arrives.

use std::collections::BTreeSet;
use std::io::Write;

use super::Trace;
use super::time_scale::TimeScale;
use crate::measure::{
    Actor, FifoInfo, FifoLevels, JobSpan, MessageSpan, Names, Recording, Shape, State, StateId, StateKind,
    StationRecord, Stretch, Topology, Waits,
};
use crate::quantities::{Cycles, Words};
use crate::report::moment;

/// The parts of Perfetto's messages that a trace needs, with their numbers.
mod messages {
    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Packet {
        #[prost(uint64, optional, tag = "8")]
        pub timestamp: Option<u64>,
        #[prost(uint32, optional, tag = "10")]
        pub trusted_packet_sequence_id: Option<u32>,
        #[prost(message, optional, tag = "11")]
        pub event: Option<Event>,
        #[prost(message, optional, tag = "12")]
        pub interned: Option<Interned>,
        #[prost(uint32, optional, tag = "13")]
        pub sequence_flags: Option<u32>,
        #[prost(message, optional, tag = "60")]
        pub track: Option<Track>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Track {
        #[prost(uint64, optional, tag = "1")]
        pub uuid: Option<u64>,
        #[prost(string, optional, tag = "2")]
        pub name: Option<String>,
        #[prost(uint64, optional, tag = "5")]
        pub parent: Option<u64>,
        #[prost(message, optional, tag = "8")]
        pub counter: Option<Counter>,
        /// 3 orders the children by their ranks.
        #[prost(int32, optional, tag = "11")]
        pub order_of_children: Option<i32>,
        #[prost(int32, optional, tag = "12")]
        pub rank: Option<i32>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Counter {
        #[prost(string, optional, tag = "6")]
        pub unit_name: Option<String>,
        /// Counters with the same key have one scale.
        #[prost(string, optional, tag = "7")]
        pub scale: Option<String>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Event {
        #[prost(uint64, repeated, packed = "false", tag = "3")]
        pub categories: Vec<u64>,
        #[prost(message, repeated, tag = "4")]
        pub arguments: Vec<Argument>,
        /// 1 begins a slice, 2 ends one, 3 is a mark, 4 counts.
        #[prost(int32, optional, tag = "9")]
        pub kind: Option<i32>,
        #[prost(uint64, optional, tag = "10")]
        pub name_id: Option<u64>,
        #[prost(uint64, optional, tag = "11")]
        pub track: Option<u64>,
        #[prost(string, optional, tag = "23")]
        pub name: Option<String>,
        #[prost(int64, optional, tag = "30")]
        pub count: Option<i64>,
        #[prost(fixed64, repeated, packed = "false", tag = "47")]
        pub flows: Vec<u64>,
        #[prost(fixed64, repeated, packed = "false", tag = "48")]
        pub ending_flows: Vec<u64>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Argument {
        #[prost(uint64, optional, tag = "1")]
        pub name_id: Option<u64>,
        #[prost(uint64, optional, tag = "3")]
        pub value: Option<u64>,
        #[prost(string, optional, tag = "6")]
        pub text: Option<String>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Interned {
        #[prost(message, repeated, tag = "1")]
        pub categories: Vec<Name>,
        #[prost(message, repeated, tag = "2")]
        pub events: Vec<Name>,
        #[prost(message, repeated, tag = "3")]
        pub arguments: Vec<Name>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Name {
        #[prost(uint64, optional, tag = "1")]
        pub id: Option<u64>,
        #[prost(string, optional, tag = "2")]
        pub name: Option<String>,
    }
}

use messages::{Argument, Counter, Event, Interned, Name, Packet, Track};

const BEGIN: i32 = 1;
const END: i32 = 2;
const MARK: i32 = 3;
const COUNT: i32 = 4;

/// All packets are of one sequence, of which the first resets the names and the others need them.
const SEQUENCE: u32 = 1;
const RESETS_NAMES: u32 = 1;
const NEEDS_NAMES: u32 = 2;

/// Numbers of arguments: the places of their names, from 1. The first is a job's number.
const JOB: u64 = 1;
const CYCLE: u64 = 2;
const CYCLES: u64 = 3;
/// The middle of a wait, and who then waits for whom: a name for each line.
const WAIT: u64 = 4;
const CHAIN: [&str; moment::MOST_LINKS] = ["who 1", "who 2", "who 3", "who 4", "who 5", "who 6", "who 7", "who 8"];

/// What states are grouped into; likewise.
const CATEGORIES: [&str; 5] = ["busy", "moving", "waiting", "blocked", "idle"];

/// The array's track. Those below it have the numbers that follow, in their order.
const ARRAY: u64 = 1;
const BY_RANK: i32 = 3;

pub fn write(trace: &Trace<'_>, scale: TimeScale, out: &mut impl Write) -> std::io::Result<()> {
    let recording = trace.recording;
    let topology = &*recording.topology;
    let waits = Waits::new(recording);
    let mut writer = Writer { out, scale, topology, waits, buffer: Vec::new(), tracks: ARRAY };
    writer.describe(&trace.caption.title)?;
    if let Some(host) = &recording.host {
        writer.activity("host sends".to_owned(), (Actor::Host, host), Vec::new())?;
    }
    let mut marks = marks(recording);
    for (index, cell) in recording.stations.iter().enumerate() {
        let mut fifos = topology.inputs_of(Actor::Station(index));
        fifos.try_for_each(|fifo| writer.levels(&topology.fifos[fifo], &recording.fifos[fifo]))?;
        let marks = std::mem::take(&mut marks[index]);
        writer.activity(trace.station_name(index), (Actor::Station(index), cell), marks)?;
    }
    let mut fifos = topology.inputs_of(Actor::Host);
    fifos.try_for_each(|fifo| writer.levels(&topology.fifos[fifo], &recording.fifos[fifo]))?;
    if recording.host.is_some() {
        writer.hits(&recording.answers)?;
    }
    let capacities: BTreeSet<Words> = topology.fifos.iter().filter_map(|info| info.capacity).collect();
    capacities.into_iter().try_for_each(|capacity| writer.scale(capacity, recording.window.start))
}

/// For each station the marks of its messages, in the order of time: where one sets out, from which a flow leads to where it arrives.
fn marks(recording: &Recording) -> Vec<Vec<(Cycles, Event)>> {
    let mut marks = vec![Vec::new(); recording.stations.len()];
    // Behind the states' names are those of the ways of messages.
    let named = |way: usize, other: usize| Some((1 + recording.topology.states.all().len() + 2 * other + way) as u64);
    for (&MessageSpan { from, to, sent, arrived }, flow) in recording.messages.iter().zip(1..) {
        let is_held = recording.window.contains(&arrived);
        let flows = if is_held { vec![flow] } else { Vec::new() };
        let sets_out = Event { kind: Some(MARK), name_id: named(0, to), flows, ..Event::default() };
        let comes = Event { kind: Some(MARK), name_id: named(1, from), ending_flows: vec![flow], ..Event::default() };
        marks[from].push((sent, sets_out));
        if is_held {
            marks[to].push((arrived, comes));
        }
    }
    marks.iter_mut().for_each(|of_station: &mut Vec<(Cycles, Event)>| of_station.sort_by_key(|(at, _)| *at));
    marks
}

/// What messages to a station and from it are called.
fn ways(topology: &Topology, station: usize) -> [String; 2] {
    ["to", "from"].map(|way| format!("{way} {}", topology.station(station)))
}

struct Writer<'a, W> {
    out: &'a mut W,
    scale: TimeScale,
    topology: &'a Topology,
    waits: Waits<'a>,
    buffer: Vec<u8>,
    /// The number of the last track.
    tracks: u64,
}

impl<W: Write> Writer<'_, W> {
    fn packet(&mut self, packet: Packet) -> std::io::Result<()> {
        self.buffer.clear();
        let packet = Packet { trusted_packet_sequence_id: Some(SEQUENCE), ..packet };
        prost::encoding::message::encode(1, &packet, &mut self.buffer);
        self.out.write_all(&self.buffer)
    }

    /// The names that events refer to, and the array.
    fn describe(&mut self, title: &str) -> std::io::Result<()> {
        let ways: Vec<String> = (0..self.topology.stations).flat_map(|station| ways(self.topology, station)).collect();
        let states = self.topology.states.all().iter().map(|state| state.name.as_str());
        let events: Vec<&str> = states.chain(ways.iter().map(String::as_str)).collect();
        let names = |names: &[&str]| {
            let named = names.iter().zip(1..);
            named.map(|(&name, id)| Name { id: Some(id), name: Some(name.to_owned()) }).collect()
        };
        let arguments = [&[self.topology.names.job.as_str(), "cycle", "cycles", "in cycle"], &CHAIN[..]].concat();
        let interned =
            Interned { categories: names(&CATEGORIES), events: names(&events), arguments: names(&arguments) };
        let flags = Some(RESETS_NAMES | NEEDS_NAMES);
        self.packet(Packet { interned: Some(interned), sequence_flags: flags, ..Packet::default() })?;
        let name = Some(title.to_owned());
        let array = Track { uuid: Some(ARRAY), name, order_of_children: Some(BY_RANK), ..Track::default() };
        self.packet(Packet { track: Some(array), ..Packet::default() })
    }

    /// Adds a track, of slices or of a counter, and returns its number.
    fn track(&mut self, name: String, counter: Option<Counter>) -> std::io::Result<u64> {
        self.tracks += 1;
        let (uuid, rank) = (Some(self.tracks), Some(self.tracks as i32));
        let track = Track { uuid, name: Some(name), parent: Some(ARRAY), counter, rank, order_of_children: None };
        self.packet(Packet { track: Some(track), ..Packet::default() })?;
        Ok(self.tracks)
    }

    fn event(&mut self, at: Cycles, event: Event) -> std::io::Result<()> {
        let timestamp = Some(self.scale.start_of(at));
        self.packet(Packet { timestamp, event: Some(event), sequence_flags: Some(NEEDS_NAMES), ..Packet::default() })
    }

    /// The states, around those on a ray a slice for it, and in them marks of messages, which are in the order of time.
    fn activity(
        &mut self,
        name: String,
        (actor, record): (Actor, &StationRecord),
        marks: Vec<(Cycles, Event)>,
    ) -> std::io::Result<()> {
        let track = self.track(name, None)?;
        let mut marks = marks.into_iter().peekable();
        let mut jobs = record.jobs.iter().peekable();
        for stretch in &record.states {
            let span = jobs.peek().copied().filter(|span| span.from <= stretch.from);
            if let Some(span) = span.filter(|span| span.from == stretch.from) {
                self.begin_span(track, span, false)?;
            }
            let event = Event {
                kind: Some(BEGIN),
                track: Some(track),
                categories: vec![self.category(stretch.state)],
                name_id: Some(self.name_id(stretch.state)),
                arguments: span
                    .map(|span| argument(JOB, span.job as u64))
                    .into_iter()
                    .chain(self.chain(actor, stretch))
                    .collect(),
                ..Event::default()
            };
            self.event(stretch.from, event)?;
            while let Some((at, mark)) = marks.next_if(|(at, _)| *at <= stretch.until) {
                self.event(at, Event { track: Some(track), ..mark })?;
            }
            self.end(track, stretch.until)?;
            if span.is_some_and(|span| span.until <= stretch.until) {
                self.end(track, stretch.until)?;
                jobs.next();
            }
        }
        Ok(())
    }

    /// Who waits for whom in the middle of a wait.
    fn chain(&self, actor: Actor, stretch: &Stretch) -> Vec<Argument> {
        let middle = Cycles(stretch.from.0 + (stretch.until.0 - stretch.from.0) / 2);
        let is_wait = self.topology.states.get(stretch.state).is_some_and(|state| state.stands_at.is_some());
        let chain = if is_wait { self.waits.chain(actor, middle) } else { Vec::new() };
        if chain.first().is_none_or(|first| first.wait.is_none()) {
            return Vec::new();
        }
        let lines = moment::chain(self.topology, &chain).into_iter().zip(WAIT + 1..);
        let line = |(text, name)| Argument { name_id: Some(name), value: None, text: Some(text) };
        std::iter::once(argument(WAIT, middle.0)).chain(lines.map(line)).collect()
    }

    fn hits(&mut self, hits: &[JobSpan]) -> std::io::Result<()> {
        let track = self.track("host reads HITs".to_owned(), None)?;
        hits.iter().try_for_each(|hit| {
            self.begin_span(track, hit, true)?;
            self.end(track, hit.until)
        })
    }

    /// Begins the slice of a ray; the one of its HIT ends its flow.
    fn begin_span(&mut self, track: u64, span: &JobSpan, is_hit: bool) -> std::io::Result<()> {
        let arguments = [(JOB, span.job as u64), (CYCLE, span.from.0), (CYCLES, (span.until - span.from).0)];
        let name = format!("{} {}", if is_hit { "HIT" } else { &self.topology.names.job }, span.job);
        let event = Event {
            kind: Some(BEGIN),
            track: Some(track),
            name: Some(name.clone()),
            arguments: arguments.map(|(name, value)| argument(name, value)).to_vec(),
            ..Event::default()
        };
        self.event(span.from, event)?;
        if self.topology.shape != Shape::Line {
            return Ok(());
        }
        let flow = vec![span.job as u64 + 1];
        let (flows, ending_flows) = if is_hit { (Vec::new(), flow) } else { (flow, Vec::new()) };
        let (kind, track, name) = (Some(MARK), Some(track), Some(name));
        self.event(span.from, Event { kind, track, name, flows, ending_flows, ..Event::default() })
    }

    fn end(&mut self, track: u64, at: Cycles) -> std::io::Result<()> {
        self.event(at, Event { kind: Some(END), track: Some(track), ..Event::default() })
    }

    /// The number of a state's name: its place, from 1.
    fn name_id(&self, state: StateId) -> u64 {
        1 + self.topology.states.all().iter().position(|other| other.id == state).unwrap_or_default() as u64
    }

    /// The number of what a state is grouped into.
    fn category(&self, state: StateId) -> u64 {
        self.topology.states.get(state).map_or(0, |state: &State| match state.kind {
            StateKind::Works => 1,
            StateKind::Moves => 2,
            StateKind::Waits => 3,
            StateKind::Blocked => 4,
            StateKind::Idle => 5,
        })
    }

    /// A counter that stands at a capacity, so that the scale of the FIFOs with it goes from empty to full.
    fn scale(&mut self, capacity: Words, at: Cycles) -> std::io::Result<()> {
        let counter = Counter::new(Some(capacity), &self.topology.names);
        let track = self.track(format!("the scale of {}s of {capacity}", self.topology.names.fifo), Some(counter))?;
        let count = Some(capacity.0 as i64);
        self.event(at, Event { kind: Some(COUNT), track: Some(track), count, ..Event::default() })
    }

    fn levels(&mut self, info: &FifoInfo, fifo: &FifoLevels) -> std::io::Result<()> {
        let counter = Counter::new(info.capacity, &self.topology.names);
        let room = info.capacity.map_or(String::new(), |capacity| format!(" (of {capacity})"));
        let track = self.track(format!("{}{room}", info.name), Some(counter))?;
        fifo.levels.iter().try_for_each(|&(cycle, words)| {
            let count = Some(words.0 as i64);
            self.event(cycle, Event { kind: Some(COUNT), track: Some(track), count, ..Event::default() })
        })
    }
}

impl Counter {
    /// Of a FIFO. Those that take all have one scale.
    fn new(capacity: Option<Words>, names: &Names) -> Counter {
        let scale = capacity.map_or("all".to_owned(), |words| words.to_string());
        Counter { unit_name: Some(format!("{}s", names.word)), scale: Some(scale) }
    }
}

fn argument(name: u64, value: u64) -> Argument {
    Argument { name_id: Some(name), value: Some(value), text: None }
}
