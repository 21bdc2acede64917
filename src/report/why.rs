//! Why a run took as long as it did: its critical path in words, tables and JSON.

use std::collections::BTreeMap;

use serde::Serialize;

use super::summary::{Rows, WIDTH, aligned_with, grouped, percent, plural, prose, table, time, wrapped};
use crate::isa::kernels::FLOAT_LATENCY;
use crate::machine::Capitan;
use crate::measure::{Actor, Cause, CriticalPath, PathPart, PathUnit, Shape};
use crate::quantities::Cycles;

/// Parts that the sentence names.
const NAMED: usize = 3;

/// One part in so many is worth naming.
const LEAST_NAMED: u64 = 1000;

/// Cells that the table names; the others are one row.
const MOST_CELLS: usize = 16;

/// One of the machine's times, or what has no price, on a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimeOnPath {
    /// Its name: of a unit of work that of the machine's file, else `cycles_a_word`, `latency_cycles`, `moving` or `slot`.
    pub name: String,
    /// What it is, in words.
    pub label: String,
    /// The cell it is taken in, or whose FIFO it is about, if they are told apart.
    pub at: Option<Actor>,
    /// Whether it could be another: moving a word and freeing a slot take a cycle each, whatever the machine.
    pub varies: bool,
    /// Cycles of one; on average, where they differ.
    pub each: Cycles,
    /// How often it lies on the path: the change of the run's cycles for a change of its own by one.
    pub count: u64,
    /// All of them.
    pub cycles: Cycles,
}

impl TimeOnPath {
    /// How it is said where it is: FIFOs are about words that come, buses about messages that go.
    fn side(&self) -> &'static str {
        match self.name.as_str() {
            LATENCY | WIRE | SLOT => "into",
            BUS => "from",
            _ => "in",
        }
    }
}

/// The names of what is no unit of work.
const MOVE: &str = "moving";
const LATENCY: &str = "latency_cycles";
const WIRE: &str = "cycles_a_word";
const SLOT: &str = "slot";
/// That of a message on a bus.
const BUS: &str = "bus_message";

/// The times on a path, the longest first; `by_cell` tells those of each cell apart.
pub fn times(path: &CriticalPath, by_cell: bool) -> Vec<TimeOnPath> {
    let mut times: BTreeMap<(String, Option<Actor>), TimeOnPath> = BTreeMap::new();
    for part in path.parts() {
        let at = by_cell.then_some(part.at);
        let name = name(path, part.cause);
        let entry = times.entry((name.clone(), at)).or_insert_with(|| TimeOnPath {
            label: label(&name),
            name,
            at,
            varies: !matches!(part.cause, Cause::Move | Cause::Slot(_)),
            each: match part.cause {
                Cause::Work(unit) => path.units[unit].cycles,
                _ => Cycles(0),
            },
            count: 0,
            cycles: Cycles(0),
        });
        entry.count += part.count;
        entry.cycles += part.cycles;
    }
    let mut times: Vec<TimeOnPath> = times.into_values().collect();
    times.iter_mut().filter(|time| time.count > 0).for_each(|time| time.each = Cycles(time.cycles.0 / time.count));
    times.sort_by_key(|time| std::cmp::Reverse(time.cycles));
    times
}

/// The FIFO that a cause is about, if it is about one.
pub fn fifo_of(path: &CriticalPath, cause: Cause) -> Option<&str> {
    match cause {
        Cause::Work(_) | Cause::Move => None,
        Cause::Latency(fifo) | Cause::Wire(fifo) | Cause::Slot(fifo) => Some(&path.topology.fifos[fifo].name),
    }
}

/// The name of a cause: of a unit of work that of the machine's file, else `cycles_a_word`, `latency_cycles`, `moving` or `slot`.
pub fn name(path: &CriticalPath, cause: Cause) -> String {
    match cause {
        Cause::Work(unit) => path.units[unit].name.clone(),
        Cause::Move => MOVE.to_owned(),
        Cause::Latency(_) => LATENCY.to_owned(),
        Cause::Wire(_) => WIRE.to_owned(),
        Cause::Slot(_) => SLOT.to_owned(),
    }
}

/// What a cause is, in words; a unit of work by its name.
pub(super) fn label(name: &str) -> String {
    match name {
        MOVE => "moving words".to_owned(),
        LATENCY => "latency".to_owned(),
        WIRE => "the wires, a word".to_owned(),
        SLOT => "full FIFOs".to_owned(),
        BUS => "the buses, a message".to_owned(),
        "fixed_ms" => "spent once".to_owned(),
        "per_cap_ms" => "copying the scene".to_owned(),
        "message_ms" => "sending a message".to_owned(),
        "segment_ms" => "set-up of a work item".to_owned(),
        "pixel_ms" => "a pixel".to_owned(),
        "color_ms" => "taking a colour".to_owned(),
        "shade_hit" => "shading a hit".to_owned(),
        "pixel_us" => "beginning a pixel".to_owned(),
        "lookup_us" => "looking pages up".to_owned(),
        "serve_us" => "serving a page".to_owned(),
        "links" => "the links, a message".to_owned(),
        FLOAT_LATENCY => "floating-point latency".to_owned(),
        "way" => "a message's way".to_owned(),
        other if of_message(other).is_some() => of_message(other).unwrap_or_default(),
        other => match other.split_once('_') {
            Some((kernel @ ("grid" | "slabs" | "intersection"), "start")) => format!("{kernel}, start"),
            Some((kernel @ ("grid" | "slabs" | "intersection" | "host"), "voxel" | "polygon" | "ray" | "hit")) => {
                format!("{kernel}, a {}", &other[kernel.len() + 1..])
            }
            _ => other.to_owned(),
        },
    }
}

/// What it is to send or to take messages of a kind.
fn of_message(name: &str) -> Option<String> {
    let (what, kind) = name.split_once('_')?;
    let does = match what {
        "send" => "sending",
        "take" => "taking",
        _ => return None,
    };
    let messages = match kind {
        "real_object" => "pages",
        "virtual_object" => "rays",
        "calculation" => "results and pixels",
        "information" => "information",
        _ => return None,
    };
    Some(format!("{does} {messages}"))
}

/// What a station does that does a unit of work.
fn doing(path: &CriticalPath, unit: &PathUnit) -> String {
    match unit.name.as_str() {
        "grid_start" => "the grid's starts".to_owned(),
        "grid_voxel" => "the grid's steps".to_owned(),
        "slabs_start" => "the slabs' starts".to_owned(),
        "slabs_polygon" => "slabs tests".to_owned(),
        "intersection_start" => "the intersection's starts".to_owned(),
        "intersection_polygon" => "intersection tests".to_owned(),
        "host_ray" => "work on rays".to_owned(),
        "host_hit" | "shade_hit" => "shading".to_owned(),
        "fixed_ms" => "what is spent once".to_owned(),
        "per_cap_ms" => "copies of the scene".to_owned(),
        "message_ms" => "sending messages".to_owned(),
        "segment_ms" => format!("set-ups of {}s", path.topology.names.job),
        "pixel_ms" => "pixels".to_owned(),
        "color_ms" => "taking colours".to_owned(),
        "message" => "messages".to_owned(),
        FLOAT_LATENCY => format!("waits of {} instructions", activity(path, unit)),
        BUS => "messages on the buses".to_owned(),
        "pixel_us" => "beginning pixels".to_owned(),
        "lookup_us" | "serve_us" => label(&unit.name).replace("a page", "pages"),
        "links" | "way" => "messages under way".to_owned(),
        other if of_message(other).is_some() => label(other),
        other => {
            let activity = activity(path, unit);
            if other.ends_with("_cycle") { activity.to_owned() } else { format!("{activity} instructions") }
        }
    }
}

/// What a station is busy with that does a unit of work.
fn activity<'a>(path: &'a CriticalPath, unit: &PathUnit) -> &'a str {
    path.topology.states.get(unit.state).map_or("other", |state| state.name.as_str())
}

/// Who somebody is, on a path: `cell 3`, `the host`, or a name of its own.
fn place(path: &CriticalPath, at: Actor) -> String {
    match at {
        Actor::Host => at.to_string(),
        Actor::Station(index) => path.topology.station(index),
    }
}

/// What the lengths of parts are called.
fn lengths(path: &CriticalPath) -> &'static str {
    if path.topology.shape == Shape::Farm { "time" } else { "cycles" }
}

/// A length: in cycles, which of a farm are nanoseconds, and are told as times.
fn length(path: &CriticalPath, cycles: Cycles) -> String {
    if path.topology.shape == Shape::Farm { time(Capitan::CLOCK.seconds(cycles)) } else { grouped(cycles.0) }
}

/// The length of a path.
fn whole(path: &CriticalPath) -> String {
    if path.topology.shape == Shape::Farm { length(path, path.cycles) } else { plural(path.cycles.0, "cycle") }
}

/// A part of a path, in words: `the grid's steps in cell 0`, `X4, full until cell 4 reads`.
fn phrase(path: &CriticalPath, part: &PathPart) -> String {
    let fifo = |fifo: usize| &path.topology.fifos[fifo].name;
    match part.cause {
        // Which of the workers it is at a time says nothing.
        Cause::Work(unit) if path.topology.shape == Shape::Farm => doing(path, &path.units[unit]),
        Cause::Work(unit) => format!("{} in {}", doing(path, &path.units[unit]), place(path, part.at)),
        Cause::Move => format!("moving words in {}", place(path, part.at)),
        Cause::Latency(place) => format!("the way into {}", fifo(place)),
        Cause::Wire(place) => format!("the wire into {}", fifo(place)),
        Cause::Slot(fifo) => {
            format!(
                "{}, full until {} reads",
                path.topology.fifos[fifo].name,
                place(path, path.topology.fifos[fifo].to)
            )
        }
    }
}

/// What the path is made of, for the most part: its longest parts, and the others together.
pub fn sentence(path: &CriticalPath) -> String {
    let mut phrases: BTreeMap<String, Cycles> = BTreeMap::new();
    path.parts().iter().for_each(|part| *phrases.entry(phrase(path, part)).or_default() += part.cycles);
    let mut phrases: Vec<(String, Cycles)> = phrases.into_iter().filter(|entry| entry.1 > Cycles(0)).collect();
    phrases.sort_by_key(|entry| std::cmp::Reverse(entry.1));
    let is_told = |cycles: Cycles| cycles.0.saturating_mul(LEAST_NAMED) >= path.cycles.0;
    let named = phrases.iter().take(NAMED).take_while(|entry| is_told(entry.1)).count();
    let rest: Cycles = phrases[named..].iter().map(|entry| entry.1).sum();
    let others = [("other causes".to_owned(), rest)];
    let told = phrases[..named].iter().chain(others.iter().filter(|entry| named == 0 || is_told(entry.1)));
    told.map(|(phrase, cycles)| format!("{} {phrase}", percent(*cycles, path.cycles))).collect::<Vec<_>>().join("; ")
}

/// The times on the path: a row each. What a tenth less saves is so much at the most.
pub fn time_rows(path: &CriticalPath, by_cell: bool) -> Rows {
    let row = |time: TimeOnPath| {
        let saved = percent(time.cycles, Cycles(path.cycles.0.saturating_mul(10)));
        vec![
            time.at.map_or(time.label.clone(), |at| format!("{} {} {}", time.label, time.side(), place(path, at))),
            length(path, time.cycles),
            percent(time.cycles, path.cycles),
            grouped(time.count),
            length(path, time.each),
            if time.varies { saved } else { String::new() },
        ]
    };
    Rows {
        header: ["cause", lengths(path), "share", "times", "each", "10 % less saves"].map(str::to_owned).to_vec(),
        rows: times(path, by_cell).into_iter().map(row).collect(),
    }
}

/// Where the path is: a row a cell, the one that it is in longest first, and what it is in it for. A FIFO belongs to its
/// reader.
pub fn place_rows(path: &CriticalPath) -> Rows {
    let mut places: BTreeMap<Actor, (Cycles, BTreeMap<String, Cycles>)> = BTreeMap::new();
    for part in path.parts() {
        let place = places.entry(part.at).or_default();
        place.0 += part.cycles;
        *place.1.entry(label(&name(path, part.cause))).or_default() += part.cycles;
    }
    let mut places: Vec<_> = places.into_iter().filter(|(_, (cycles, _))| *cycles > Cycles(0)).collect();
    places.sort_by_key(|(_, (cycles, _))| std::cmp::Reverse(*cycles));
    let share = |cycles: Cycles| percent(cycles, path.cycles);
    let mostly = |causes: &BTreeMap<String, Cycles>| {
        let mut causes: Vec<(&String, &Cycles)> = causes.iter().collect();
        causes.sort_by_key(|(_, cycles)| std::cmp::Reverse(**cycles));
        causes.iter().take(NAMED).map(|(label, cycles)| format!("{label} {}", share(**cycles))).collect::<Vec<_>>()
    };
    let row = |(at, (cycles, causes)): &(Actor, (Cycles, BTreeMap<String, Cycles>))| {
        vec![place(path, *at), length(path, *cycles), share(*cycles), mostly(causes).join("; ")]
    };
    let mut rows: Vec<Vec<String>> = places.iter().take(MOST_CELLS).map(row).collect();
    let others = &places[rows.len()..];
    if !others.is_empty() {
        let cycles: Cycles = others.iter().map(|(_, (cycles, _))| *cycles).sum();
        rows.push(vec![plural(others.len() as u64, "other"), length(path, cycles), share(cycles), String::new()]);
    }
    Rows { header: ["where", lengths(path), "share", "mostly"].map(str::to_owned).to_vec(), rows }
}

/// What the figures mean.
fn meaning(path: &CriticalPath) -> String {
    let text = match path.topology.shape {
        Shape::Line => {
            "Each cycle of the run has one cause on this chain, which ends with the last hit. A time that is 10 % less saves so \
             much as long as the chain stays a longest one, and never more; one that is 10 % more costs no less."
        }
        Shape::Farm => {
            "Each nanosecond of the run has one cause on this chain, which ends with what is done last. A time that is 10 % less \
             saves so much as long as the chain stays a longest one and all come in the order in which they did: who asks first, \
             whose message is first on a bus. In another order it may be less or more."
        }
        Shape::Cube => {
            "Each cycle of the run has one cause on this chain, which ends with the last pixels at the host: who waited, waited for \
             what the chain tells. A time that is 10 % less saves so much as long as the chain stays a longest one and all come in \
             the order in which they did: whose ray comes first, who gets a slot. In another order it may be less or more."
        }
    };
    wrapped(text, WIDTH) + "\n"
}

/// What its savings are subject to, in a sentence.
pub fn subject_to(path: &CriticalPath) -> &'static str {
    match path.topology.shape {
        Shape::Line => {
            "What 10 % less of a time saves, it saves while the critical path stays a longest chain, and never more."
        }
        Shape::Farm | Shape::Cube => {
            "What 10 % less of a time saves, it saves while the critical path stays a longest chain and all come in the order in \
             which they did."
        }
    }
}

/// What an image's path does not tell, in a line.
pub const OF_AN_IMAGE: &str = "
The host's order depends on the clock: this holds for the rays in the order in
which it sent them, as a replay of the ops keeps it.
";

/// All that people read of a path.
pub fn text(path: &CriticalPath, by_cell: bool) -> String {
    format!(
        "{}\n{}\n{}\n{}",
        prose(&format!("why {}: {}", whole(path), sentence(path))),
        meaning(path),
        figures(time_rows(path, by_cell), &[]),
        figures(in_lines(place_rows(path)), &[3]),
    )
}

/// The columns that the causes of a place have.
const CAUSES_WIDTH: usize = 42;

/// The same rows, their causes in as many lines as they need.
fn in_lines(mut rows: Rows) -> Rows {
    rows.rows.iter_mut().filter_map(|row| row.last_mut()).for_each(|causes| *causes = wrapped(causes, CAUSES_WIDTH));
    rows
}

/// A table as text, with columns of text to the left.
fn figures(rows: Rows, texts: &[usize]) -> String {
    let header: Vec<&str> = rows.header.iter().map(String::as_str).collect();
    let mut table = table(&header);
    table.add_rows(rows.rows);
    aligned_with(table, texts)
}

/// A path as statistics have it.
#[derive(Debug, Serialize)]
pub struct PathJson {
    sentence: String,
    times: Vec<TimeJson>,
    parts: Vec<PartJson>,
}

#[derive(Debug, Serialize)]
struct TimeJson {
    time: String,
    count: u64,
    each: u64,
    cycles: u64,
    share: f64,
}

#[derive(Debug, Serialize)]
struct PartJson {
    at: String,
    cause: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    fifo: Option<String>,
    count: u64,
    cycles: u64,
}

impl PathJson {
    /// What statistics tell of a path.
    pub fn new(path: &CriticalPath) -> PathJson {
        let share = |cycles: Cycles| if path.cycles.0 == 0 { 0.0 } else { cycles.0 as f64 / path.cycles.0 as f64 };
        let time = |time: TimeOnPath| TimeJson {
            share: share(time.cycles),
            time: time.name,
            count: time.count,
            each: time.each.0,
            cycles: time.cycles.0,
        };
        let part = |part: PathPart| PartJson {
            at: match part.at {
                Actor::Host => "host".to_owned(),
                Actor::Station(station) => path.topology.station_number(station),
            },
            cause: name(path, part.cause),
            fifo: fifo_of(path, part.cause).map(str::to_owned),
            count: part.count,
            cycles: part.cycles.0,
        };
        PathJson {
            sentence: sentence(path),
            times: times(path, false).into_iter().map(time).collect(),
            parts: path.parts().into_iter().map(part).collect(),
        }
    }
}
