//! What a farm tells beside what any machine does: its speed-up, its buses, its statistics.

use serde::Serialize;
use serde_json::{Map, Value};

use super::bottleneck;
use super::plot::Caption;
use super::stats::{Configuration, station};
use super::summary::{self, Rows, percent, plural, prose, time};
use super::why::{self, PathJson};
use crate::machine::{Capitan, CapitanFile, Cycles};
use crate::measure::LinkStats;
use crate::program::farm::{HandOut, SceneBy, UNITS};
use crate::program::work;
use crate::run::{FarmOutcome, FarmScene, FarmSetup, FarmSpec};
use crate::seam::Unit;

/// What people read of a farm.
pub fn text(setup: &FarmSetup, outcome: &FarmOutcome) -> String {
    let lines = [
        title(setup, outcome),
        machine_line(&setup.spec.machine),
        shares(&setup.spec),
        summary::speed(&outcome.stats, Capitan::CLOCK),
        gain(outcome),
        buses(outcome),
    ];
    let tasks = summary::cells(&outcome.stats, &[]);
    let (head, verdict) = (prose(&lines.join("\n")), prose(&bottleneck::sentence(&outcome.stats)));
    let why = outcome.observed.path.as_ref().map(|path| format!("\n{}", why::text(path, false))).unwrap_or_default();
    format!("{head}\n\n{tasks}\n{verdict}\n{why}")
}

/// What people read of farms of several numbers of workers: a row for each, and what limits most of them.
pub fn compared(setup: &FarmSetup, outcomes: &[FarmOutcome]) -> String {
    let last = outcomes.last().map_or(String::new(), |last| {
        format!("With {}: {}\n", plural(last.workers as u64, "worker"), bottleneck::sentence(&last.stats))
    });
    let fewest = outcomes.first().map_or(0, |first| first.workers);
    let shares = shares(&setup.spec);
    let title = format!("farm of {fewest} to {} workers: {}", setup.spec.tasks, what(setup));
    let head = prose(&format!("{title}\n{}\n{shares}", machine_line(&setup.spec.machine)));
    format!("{head}\n\n{}\n{}", table(outcomes), prose(&last))
}

/// What runs, and on what machine.
pub fn caption(setup: &FarmSetup, outcome: &FarmOutcome) -> Caption {
    Caption { title: title(setup, outcome), partition: None, machine: machine_line(&setup.spec.machine) }
}

/// What runs, in one line.
fn title(setup: &FarmSetup, outcome: &FarmOutcome) -> String {
    format!("farm of {}: {}", plural(outcome.workers as u64, "worker"), what(setup))
}

/// Scene, image and work items.
fn what(setup: &FarmSetup) -> String {
    let FarmSetup { spec, scene, items, .. } = setup;
    let polygons = scene.polygons.map_or(String::new(), |count| format!(" ({})", plural(count as u64, "polygon")));
    let (pixels, items) = (plural(spec.size.pixels() as u64, "pixel"), plural(items.len() as u64, items.noun));
    format!("scene {}{polygons}, {pixels} in {items}", scene.name)
}

/// The machine in one line.
fn machine_line(machine: &CapitanFile) -> String {
    format!(
        "machine: {} of {} kbyte, {} of {} Mbyte/s, {} ms a message",
        plural(machine.processors as u64, "processor"),
        machine.memory_kbyte,
        // A word of its own plural.
        if machine.buses == 1 { "1 bus".to_owned() } else { format!("{} buses", machine.buses) },
        machine.bus_mb_s,
        machine.message_ms,
    )
}

/// How scene and work are shared, in one line.
fn shares(spec: &FarmSpec) -> String {
    let scene = match spec.scene_by {
        SceneBy::Copies => "a copy for each task",
        SceneBy::Broadcast => "broadcast to all tasks",
    };
    let noun = spec.items.noun();
    let work = match spec.hand_out {
        HandOut::Request => format!("a {noun} for the worker that asks"),
        HandOut::Dealt => format!("{noun}s dealt beforehand"),
    };
    format!("shared out: the scene, {scene}; {work}")
}

/// How many times as fast a farm is as with a single worker.
pub fn speed_up(outcome: &FarmOutcome) -> f64 {
    ratio(outcome.one_worker, outcome.stats.cycles)
}

/// The share of its workers' number that it is as many times as fast.
pub fn efficiency(outcome: &FarmOutcome) -> f64 {
    speed_up(outcome) / outcome.workers.max(1) as f64
}

fn ratio(a: Cycles, b: Cycles) -> f64 {
    if b.0 == 0 { 1.0 } else { a.0 as f64 / b.0 as f64 }
}

fn seconds(cycles: Cycles) -> f64 {
    Capitan::CLOCK.seconds(cycles)
}

/// Speed-up, efficiency, and what one program on one processor would have taken, in a line.
pub fn gain(outcome: &FarmOutcome) -> String {
    format!(
        "{:.2} times as fast as one worker (efficiency {:.1} %), {:.2} times as one program on one such processor ({})",
        speed_up(outcome),
        100.0 * efficiency(outcome),
        ratio(outcome.one_program, outcome.stats.cycles),
        time(seconds(outcome.one_program)),
    )
}

/// How long the buses were busy, in a line.
pub fn buses(outcome: &FarmOutcome) -> String {
    let share = |bus: &LinkStats| percent(bus.busy, outcome.stats.cycles);
    let shares: Vec<String> = outcome.stats.links.iter().map(share).collect();
    format!("the buses carry messages for {} of the time", shares.join(", "))
}

/// A row for each number of workers.
pub fn table(outcomes: &[FarmOutcome]) -> String {
    let row = |outcome: &FarmOutcome| {
        let workers = &outcome.stats.stations[2..];
        let states = &outcome.stats.topology.states;
        let computing: Cycles = workers.iter().flat_map(|times| states.by_activity(times)).map(|(_, time)| time).sum();
        vec![
            outcome.workers.to_string(),
            time(seconds(outcome.stats.cycles)),
            format!("{:.2}", speed_up(outcome)),
            format!("{:.1} %", 100.0 * efficiency(outcome)),
            percent(computing, Cycles(outcome.stats.cycles.0 * workers.len() as u64)),
        ]
    };
    summary::text(Rows {
        header: ["workers", "time", "speed-up", "efficiency", "computing"].map(str::to_owned).to_vec(),
        rows: outcomes.iter().map(row).collect(),
    })
}

#[derive(Serialize)]
struct Report<'a> {
    cycles: u64,
    seconds: f64,
    workers: usize,
    speed_up: f64,
    efficiency: f64,
    one_worker_seconds: f64,
    one_program_seconds: f64,
    pixels: usize,
    items: usize,
    scene_bytes: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    polygons: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    counts: Option<Map<String, Value>>,
    tasks: Vec<Map<String, Value>>,
    buses: Vec<Bus>,
    bottleneck: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<PathJson>,
    configuration: &'a Configuration,
}

#[derive(Serialize)]
struct Bus {
    busy: u64,
}

/// The statistics of a farm as indented JSON. Times of tasks and buses are in ns.
pub fn to_json(outcome: &FarmOutcome, scene: &FarmScene, configuration: &Configuration) -> serde_json::Result<String> {
    let stats = &outcome.stats;
    let task = |(index, times)| {
        let name = std::iter::once(("name".to_owned(), stats.topology.station(index).into()));
        name.chain(station(stats, times)).collect()
    };
    let report = Report {
        cycles: stats.cycles.0,
        seconds: seconds(stats.cycles),
        workers: outcome.workers,
        speed_up: speed_up(outcome),
        efficiency: efficiency(outcome),
        one_worker_seconds: seconds(outcome.one_worker),
        one_program_seconds: seconds(outcome.one_program),
        pixels: scene.pixels.size.pixels(),
        items: outcome.items,
        scene_bytes: scene.bytes,
        polygons: scene.polygons,
        counts: scene.counts().map(|counts| by_name(&counts)),
        tasks: stats.stations.iter().enumerate().map(task).collect(),
        buses: stats.links.iter().map(|bus| Bus { busy: bus.busy.0 }).collect(),
        bottleneck: bottleneck::sentence(stats),
        why: outcome.observed.path.as_ref().map(PathJson::new),
        configuration,
    };
    serde_json::to_string_pretty(&report).map(|json| json + "\n")
}

/// The counts of units of work, by their names.
fn by_name(counts: &[u64; UNITS]) -> Map<String, Value> {
    let vocabulary = work::vocabulary(false);
    let named = counts.iter().enumerate().filter(|(_, count)| **count > 0);
    let named =
        named.filter_map(|(unit, &count)| Some((vocabulary.unit(Unit(unit as u8))?.name.clone(), count.into())));
    named.collect()
}
