//! What is told of an image on a hypercube.

use serde::Serialize;
use serde_json::{Map, Value};

use super::bottleneck;
use super::links::{self, LinkJson};
use super::plot::{Caption, RegionMap};
use super::stats::{Configuration, RulesJson, station};
use super::summary::{self, Rows, grouped, percent, plural, time};
use super::why::{self, PathJson};
use crate::geometry::regions::Rectangle;
use crate::host::shading::RayKind;
use crate::machine::Cycles;
use crate::measure::{Clock, StateTimes};
use crate::model::Bounds;
use crate::program::cube::{MessageKind, Phases};
use crate::run::{
    CellCuts, CubeMode, CubeOutcome, CubeScene, CubeSetup, CubeSpec, Distribution, FlowKind, Grant, Grids,
};

/// The time of all nodes, by what it went to: they add up to the nodes' number times the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// What the pixels take on one node that has all of the scene.
    pub one_node: Cycles,
    /// What they take beyond that, as rays enter several regions.
    pub regions: Cycles,
    /// On sending and taking messages.
    pub messages: Cycles,
    /// On pages: looking them up, serving them, waiting for them.
    pub pages: Cycles,
    /// Waiting for room in a queue.
    pub blocked: Cycles,
    /// Waiting for work while there was more to come.
    pub waiting: Cycles,
    /// With nothing left to do.
    pub tail: Cycles,
}

impl Losses {
    /// Those of a run.
    pub fn new(outcome: &CubeOutcome) -> Losses {
        let nodes = &outcome.stats.stations[..outcome.parts.len()];
        let all = StateTimes::sum(nodes);
        let states = &outcome.stats.topology.states;
        let of = |names: &[&str]| states.sum(&all, |state| names.contains(&state.name.as_str()));
        let work = of(&["grid", "slabs", "intersection", "shading", "pixels"]);
        Losses {
            // With grids of their own regions can have less work than one node.
            one_node: outcome.one_node.min(work),
            regions: Cycles(work.0.saturating_sub(outcome.one_node.0)),
            messages: of(&["sending", "receiving"]),
            pages: of(&["lookup", "serving", "waiting page"]),
            blocked: of(&["blocked"]),
            waiting: of(&["waiting"]),
            tail: of(&["idle"]),
        }
    }

    /// Each with its name, in the order of reports.
    pub fn named(&self) -> [(&'static str, Cycles); 7] {
        [
            ("one node's work", self.one_node),
            ("entering regions", self.regions),
            ("messages", self.messages),
            ("pages", self.pages),
            ("blocked", self.blocked),
            ("waiting", self.waiting),
            ("tail", self.tail),
        ]
    }
}

/// How many times as fast a run is as one node.
pub fn speed_up(outcome: &CubeOutcome) -> f64 {
    match outcome.stats.cycles {
        Cycles(0) => 1.0,
        cycles => outcome.one_node.0 as f64 / cycles.0 as f64,
    }
}

/// The share of its nodes' number that it is as many times as fast.
pub fn efficiency(outcome: &CubeOutcome) -> f64 {
    speed_up(outcome) / outcome.parts.len().max(1) as f64
}

/// What people read of an image on a hypercube.
pub fn text(setup: &CubeSetup, outcome: &CubeOutcome) -> String {
    let clock = setup.machine.clock;
    let mut lines = vec![
        title(setup),
        machine_line(&setup.spec),
        shares(setup, outcome),
        phases(&outcome.phases, clock),
        summary::speed(&outcome.stats, clock),
        gain(outcome, clock),
    ];
    lines.push(at_least(&setup.bounds(outcome), clock));
    lines.extend(queues(setup, outcome));
    let links = summary::text(links::rows(&outcome.stats, clock));
    let parts = [losses(outcome), messages(outcome, clock), links, summary::cells(&outcome.stats, &[])];
    let (head, verdict) = (summary::prose(&lines.join("\n")), summary::prose(&sentence(setup, outcome)));
    let why = outcome.observed.path.as_ref().map(|path| format!("\n{}", why::text(path, false))).unwrap_or_default();
    format!("{head}\n\n{}\n{verdict}\n{why}", parts.join("\n"))
}

/// The regions, if the nodes have any.
pub fn region_map<'a>(setup: &'a CubeSetup, outcome: &'a CubeOutcome) -> Option<RegionMap<'a>> {
    setup.spec.regions?;
    let cut = &setup.scene.cut;
    let cells = (cut.regions.plane().size(), cut.cells.as_slice());
    let (rectangles, sent) = (cut.regions.rectangles(), outcome.seen.sent.as_slice());
    let owners = (setup.spec.size, outcome.owners.as_slice());
    Some(RegionMap { cells, rectangles, node_of: &outcome.node_of, sent, owners, links: &outcome.stats.links })
}

/// What runs, and on what machine.
pub fn caption(setup: &CubeSetup) -> Caption {
    Caption { title: title(setup), machine: machine_line(&setup.spec), partition: None }
}

fn title(setup: &CubeSetup) -> String {
    let CubeSetup { spec, scene, .. } = setup;
    format!(
        "image of {} ({}) on {} {}: {}, {}",
        scene.name,
        plural(scene.polygons as u64, "polygon"),
        plural(spec.machine.nodes as u64, "node"),
        means(spec),
        plural(spec.size.pixels() as u64, "pixel"),
        plural(scene.graph.rays.len() as u64, "ray"),
    )
}

/// How the nodes have the scene.
pub(super) fn means(spec: &CubeSpec) -> &'static str {
    match spec.mode() {
        CubeMode::Regions => "with a region each",
        CubeMode::SharedMemory => "with a shared memory",
    }
}

pub(super) fn machine_line(spec: &CubeSpec) -> String {
    let machine = &spec.machine;
    format!(
        "machine: hypercube of {} of {} kbyte, cycle {} ns, short message {} µs, long {} µs, {} µs a byte",
        plural(machine.nodes as u64, "node"),
        machine.node_kbyte,
        machine.clock_ns,
        machine.short_us,
        machine.long_us,
        machine.byte_us
    )
}

/// How the work is shared, in one line.
fn shares(setup: &CubeSetup, outcome: &CubeOutcome) -> String {
    let CubeSetup { spec, scene, .. } = setup;
    let Some(regions) = &spec.regions else {
        let uses = scene.graph.pages.as_ref();
        let (pages, bytes) = uses.map_or((0, 0), |uses| (uses.pages, uses.page_bytes));
        let pixels = match setup.spec.distribution {
            Distribution::Lines => "lines of pixels in turn",
            Distribution::Tiles => "tiles of 8 x 8 pixels as nodes ask for them",
        };
        return format!("shared out: {} of {bytes} bytes; {pixels}", plural(pages.into(), "page"));
    };
    let [across, down] = scene.cut.regions.plane().size();
    let flow = match regions.flow {
        FlowKind::Unlimited => "unlimited queues".to_owned(),
        FlowKind::Block => format!("queues of {} that block", plural(outcome.slots.unwrap_or(0) as u64, "ray")),
        FlowKind::Window => format!("{} under way", plural(regions.window.unwrap_or(0) as u64, "pixel")),
        FlowKind::Classes => {
            let how = if regions.grant == Grant::Handshake { ", asked for" } else { "" };
            format!("{} by rank{how}", plural(outcome.slots.unwrap_or(0) as u64, "slot"))
        }
    };
    format!(
        "shared out: {} x {} cells{} by {}; {}mapping {}; {flow}; termination by {}",
        across,
        down,
        match regions.cell_cuts {
            CellCuts::Equal => "",
            CellCuts::Quantiles => " of equal parts of the work",
            CellCuts::Pyramids => " on the screen",
        },
        plural(scene.cut.sampled as u64, "sampled pixel"),
        if regions.grids == Grids::Own { "grids of their own; " } else { "" },
        regions.mapping.name(),
        regions.termination.name(),
    )
}

fn phases(phases: &Phases, clock: Clock) -> String {
    let Phases { loaded, subdivided } = *phases;
    let seconds = |cycles: Cycles| time(clock.seconds(cycles));
    format!("before: loading {}, subdividing {}", seconds(loaded), seconds(Cycles(subdivided.0 - loaded.0)))
}

/// Speed-up and efficiency, in a line.
pub fn gain(outcome: &CubeOutcome, clock: Clock) -> String {
    format!(
        "{:.2} times as fast as one node ({}), efficiency {:.1} %",
        speed_up(outcome),
        time(clock.seconds(outcome.one_node)),
        100.0 * efficiency(outcome),
    )
}

/// What a run takes at the least, and why, in a line.
pub fn at_least(bounds: &Bounds, clock: Clock) -> String {
    let seconds = |cycles: Cycles| time(clock.seconds(cycles));
    let busiest = bounds.busiest().map(|(node, work)| format!("the work of node {node} takes {}, ", seconds(work)));
    format!(
        "at least {}: {}an equal part of all work {}, the longest chain of a pixel {}",
        seconds(bounds.least()),
        busiest.unwrap_or_default(),
        seconds(bounds.equal),
        seconds(bounds.chain),
    )
}

/// What queues held and links carried, in a line each.
fn queues(setup: &CubeSetup, outcome: &CubeOutcome) -> Vec<String> {
    let sent: u64 = outcome.seen.sent.iter().sum();
    let rays = setup.scene.graph.rays.len().max(1) as f64;
    let link = outcome.stats.links.iter().map(|link| link.busy).max().unwrap_or_default();
    let link = format!("busiest link: {} of the time", percent(link, outcome.stats.cycles));
    if setup.spec.regions.is_none() {
        let pages: u64 = outcome.seen.nodes.iter().map(|node| node.pages).sum();
        return vec![format!("pages fetched: {}; {link}", grouped(pages))];
    }
    let longest = outcome.stats.fifos.iter().map(|queue| queue.max.0).max().unwrap_or(0);
    let balance = |work: &[u64]| {
        let sum: u64 = work.iter().sum();
        work.iter().max().map_or(1.0, |&most| most as f64 * work.len() as f64 / sum.max(1) as f64)
    };
    let states = &outcome.stats.topology.states;
    let work = |times| states.by_activity(times).map(|(_, time)| time.0).sum::<u64>();
    let measured: Vec<u64> = outcome.stats.stations[..outcome.parts.len()].iter().map(work).collect();
    vec![
        format!(
            "work of the busiest node against the mean: {:.2} predicted, {:.2} measured",
            balance(&setup.scene.cut.predicted()),
            balance(&measured),
        ),
        format!("ray messages a ray: {:.2}; longest queue {}; {link}", sent as f64 / rays, plural(longest, "ray"),),
    ]
}

/// The losses as a table.
fn losses(outcome: &CubeOutcome) -> String {
    let whole = Cycles(outcome.stats.cycles.0 * outcome.parts.len() as u64);
    let named = Losses::new(outcome).named();
    let rows = named.iter().filter(|(_, time)| time.0 > 0);
    summary::text(Rows {
        header: ["time of all nodes", ""].map(str::to_owned).to_vec(),
        rows: rows.map(|(name, time)| vec![(*name).to_owned(), percent(*time, whole)]).collect(),
    })
}

/// The messages by kind as a table.
fn messages(outcome: &CubeOutcome, clock: Clock) -> String {
    let row = |kind: MessageKind| {
        let counts = &outcome.seen.messages[kind as usize];
        vec![
            kind.name().to_owned(),
            grouped(counts.sent),
            grouped(counts.bytes),
            format!("{:.2}", counts.hops as f64 / counts.sent.max(1) as f64),
            time(clock.seconds(counts.processor)),
        ]
    };
    summary::text(Rows {
        header: ["messages", "sent", "bytes", "links each", "processors' time"].map(str::to_owned).to_vec(),
        rows: MessageKind::ALL
            .into_iter()
            .filter(|&kind| outcome.seen.messages[kind as usize].sent > 0)
            .map(row)
            .collect(),
    })
}

/// A cell that has more than this share of a node's fair part of the work is what limits the speed-up.
const LARGE_CELL: f64 = 1.0;

/// What limits it, in a sentence.
pub fn sentence(setup: &CubeSetup, outcome: &CubeOutcome) -> String {
    let nodes = outcome.parts.len();
    let cells = &setup.scene.cut.cells;
    let (sum, most) = (cells.iter().sum::<u64>(), cells.iter().max().copied().unwrap_or(0));
    let share = if sum == 0 { 0.0 } else { most as f64 * nodes as f64 / sum as f64 };
    if setup.spec.regions.is_some() && nodes > 1 && share > LARGE_CELL {
        let percent = 100.0 * most as f64 / sum as f64;
        return format!(
            "One cell limits the speed-up: by the sub-sample it alone has {percent:.1} % of the work, and {nodes} nodes would need no \
             more than {:.1} % each; smaller cells (--cell-grid, or a larger --grid-coefficient) would let it be shared.",
            100.0 / nodes as f64
        );
    }
    bottleneck::sentence(&outcome.stats)
}

#[derive(Serialize)]
struct Report<'a> {
    cycles: u64,
    seconds: f64,
    nodes: usize,
    speed_up: f64,
    efficiency: f64,
    one_node_seconds: f64,
    at_least: AtLeast,
    phases: PhasesJson,
    pixels: usize,
    polygons: usize,
    rays: usize,
    rays_by_kind: Map<String, Value>,
    ray_messages: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    rules: Option<RulesJson>,
    losses: Map<String, Value>,
    messages: Map<String, Value>,
    tasks: Vec<Map<String, Value>>,
    links: Vec<LinkJson>,
    termination: Ended,
    bottleneck: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<PathJson>,
    configuration: &'a Configuration,
}

/// Cycles that the run takes at the least.
#[derive(Serialize)]
struct AtLeast {
    #[serde(skip_serializing_if = "Option::is_none")]
    busiest_node: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    busiest_work: Option<u64>,
    equal_part: u64,
    longest_chain: u64,
}

impl AtLeast {
    fn new(bounds: &Bounds) -> AtLeast {
        let busiest = bounds.busiest();
        AtLeast {
            busiest_node: busiest.map(|(node, _)| node),
            busiest_work: busiest.map(|(_, work)| work.0),
            equal_part: bounds.equal.0,
            longest_chain: bounds.chain.0,
        }
    }
}

#[derive(Serialize)]
struct PhasesJson {
    load: f64,
    subdivide: f64,
}

#[derive(Serialize)]
struct Ended {
    true_end: u64,
    told_at: u64,
    probes: u64,
}

/// The statistics as indented JSON. Times are in cycles, but for those in seconds; losses are in percent.
pub fn to_json(setup: &CubeSetup, outcome: &CubeOutcome, configuration: &Configuration) -> serde_json::Result<String> {
    let (stats, clock) = (&outcome.stats, setup.machine.clock);
    let Phases { loaded, subdivided } = outcome.phases;
    let whole = stats.cycles.0 as f64 * outcome.parts.len() as f64;
    let share = |(name, time): (&str, Cycles)| {
        (name.replace("'s work", "").replace(' ', "_"), (100.0 * time.0 as f64 / whole).into())
    };
    let report = Report {
        cycles: stats.cycles.0,
        seconds: clock.seconds(stats.cycles),
        nodes: outcome.parts.len(),
        speed_up: speed_up(outcome),
        efficiency: efficiency(outcome),
        one_node_seconds: clock.seconds(outcome.one_node),
        at_least: AtLeast::new(&setup.bounds(outcome)),
        phases: PhasesJson { load: clock.seconds(loaded), subdivide: clock.seconds(Cycles(subdivided.0 - loaded.0)) },
        pixels: setup.spec.size.pixels(),
        polygons: setup.scene.polygons,
        rays: setup.scene.graph.rays.len(),
        rays_by_kind: rays_by_kind(&setup.scene),
        ray_messages: outcome.seen.sent.iter().sum(),
        rules: RulesJson::new(setup.spec.rules, &setup.scene.spared),
        losses: Losses::new(outcome).named().map(share).into_iter().collect(),
        messages: by_kind(outcome),
        tasks: (0..stats.stations.len()).map(|index| task(setup, outcome, index)).collect(),
        links: links::to_json(stats),
        termination: Ended {
            true_end: outcome.seen.true_end.0,
            told_at: outcome.seen.told_at.0,
            probes: outcome.seen.probes,
        },
        bottleneck: sentence(setup, outcome),
        why: outcome.observed.path.as_ref().map(PathJson::new),
        configuration,
    };
    serde_json::to_string_pretty(&report).map(|json| json + "\n")
}

fn rays_by_kind(scene: &CubeScene) -> Map<String, Value> {
    let kind = |kind: RayKind| {
        let (rays, hits) = scene.kinds[kind as usize];
        (kind.name().to_owned(), serde_json::json!({"rays": rays, "hits": hits}))
    };
    RayKind::ALL.into_iter().map(kind).collect()
}

fn by_kind(outcome: &CubeOutcome) -> Map<String, Value> {
    let kind = |kind: MessageKind| {
        let counts = &outcome.seen.messages[kind as usize];
        let value = serde_json::json!({
            "sent": counts.sent, "taken": counts.taken, "bytes": counts.bytes, "hops": counts.hops,
            "processor": counts.processor.0,
        });
        (kind.key(), value)
    };
    MessageKind::ALL.into_iter().map(kind).collect()
}

/// A node, or the host.
fn task(setup: &CubeSetup, outcome: &CubeOutcome, index: usize) -> Map<String, Value> {
    let stats = &outcome.stats;
    let mut task = Map::new();
    task.insert("name".to_owned(), stats.topology.station(index).into());
    task.extend(station(stats, &stats.stations[index]));
    if let (Some(seen), Some(part)) = (outcome.seen.nodes.get(index), outcome.parts.get(index)) {
        let region = outcome.node_of.iter().position(|&node| usize::from(node) == index);
        let cut = &setup.scene.cut.regions;
        let queue = stats.fifos.get(index).copied().unwrap_or_default();
        let predicted = region.and_then(|region| setup.scene.cut.predicted().get(region).copied());
        let more = serde_json::json!({
            "pixels": seen.pixels, "legs": seen.legs, "longest_queue": queue.max.0, "most_slots": seen.most_slots,
            "pages_fetched": seen.pages, "polygons": part.polygons, "bytes": part.holds, "predicted_work": predicted,
            "cells": region.filter(|_| setup.spec.regions.is_some()).and_then(|region| cut.rectangles().get(region)).map(Rectangle::cells),
            "mean_queue": queue.mean(stats.cycles), "full": queue.full.0,
        });
        if let Value::Object(more) = more {
            task.insert("counts".to_owned(), more.into());
        }
    }
    task
}
