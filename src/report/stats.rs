//! Statistics as JSON.

use serde::Serialize;

use super::bottleneck;
use super::kinds::RaysByKind;
use super::losses::Losses;
use super::why::PathJson;
use crate::host::rules::Rules;
use crate::measure::{Clock, CriticalPath, FifoInfo, FifoStats, Measured, State, StateKind, StateTimes};
use crate::program::messages::{Carried, CarriedByKind, MessageKind};
use crate::program::{CellMemory, Counts, Spared};
use crate::run::{CubeSpec, FarmSpec, ReplaySpec, RunSpec, Setup};
use crate::scene::solid;

/// What was run, beside its statistics: enough to run it again.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Configuration {
    /// A run, and what its scene came to.
    Run {
        /// The run.
        #[serde(flatten)]
        run: Box<RunSpec>,
        /// How many polygons the scene has.
        polygons: usize,
        /// Words that each cell's memory holds.
        memory: Vec<MemoryWords>,
        /// What each of its solids came to.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        solids: Vec<solid::Report>,
    },
    /// A replay.
    Replay(Box<ReplaySpec>),
    /// A farm.
    Farm(Box<FarmSpec>),
    /// An image on a hypercube.
    Cube(Box<CubeSpec>),
}

impl Configuration {
    /// What a run is made of.
    pub fn new(setup: &Setup) -> Configuration {
        let workload = &setup.workload;
        Configuration::Run {
            run: Box::new(setup.spec.clone()),
            polygons: workload.polygons().len(),
            memory: (0..workload.cells()).map(|cell| workload.memory_of(cell).into()).collect(),
            solids: setup.scene.solids.clone(),
        }
    }
}

/// A cell's memory, in words.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MemoryWords {
    grid: u64,
    slabs: u64,
    polygons: u64,
    program: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    rays: Option<u64>,
    total: u64,
}

impl From<CellMemory> for MemoryWords {
    fn from(memory: CellMemory) -> MemoryWords {
        let CellMemory { grid, slabs, polygons, program, rays } = memory;
        MemoryWords {
            grid: grid.0,
            slabs: slabs.0,
            polygons: polygons.0,
            program: program.0,
            rays: Some(rays.0).filter(|&words| words > 0),
            total: memory.total().0,
        }
    }
}

#[derive(Serialize)]
struct Report<'a> {
    cycles: u64,
    seconds: f64,
    rays: u64,
    rays_per_second: f64,
    cells: Vec<Cell>,
    fifos: Vec<Fifo<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    counts: Option<CountsJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    refined_pixels: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rays_by_kind: Option<&'a RaysByKind>,
    #[serde(skip_serializing_if = "Option::is_none")]
    messages: Option<Messages>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rules: Option<RulesJson>,
    bottleneck: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    losses: Option<&'a Losses>,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<PathJson>,
    configuration: &'a Configuration,
}

/// A station's cycles by state: `busy` by activity, then `moving`, `waiting_x`, ..., `idle`.
type Cell = serde_json::Map<String, serde_json::Value>;

#[derive(Serialize)]
struct Fifo<'a> {
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    capacity: Option<u64>,
    words: u64,
    max: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    enough: Option<u64>,
    mean: f64,
    full: f64,
    empty: f64,
}

#[derive(Serialize)]
struct CountsJson {
    voxels: u64,
    slab_tests: u64,
    intersection_tests: u64,
    hits: u64,
}

/// A station's cycles by state.
pub(super) fn station(run: &Measured, times: &StateTimes) -> Cell {
    let states = &run.topology.states;
    let spent = |state: &State| (state.key(), times.of(state.id).0.into());
    let busy: Cell = states.all().iter().filter(|state| state.kind == StateKind::Works).map(spent).collect();
    let others = states.used().filter(|state| state.kind != StateKind::Works).map(spent);
    std::iter::once(("busy".to_owned(), busy.into())).chain(others).collect()
}

impl<'a> Fifo<'a> {
    fn new(info: &'a FifoInfo, stats: &FifoStats, run: &Measured) -> Fifo<'a> {
        Fifo {
            name: &info.name,
            capacity: info.capacity.map(|words| words.0),
            words: stats.words.0,
            max: stats.max.0,
            enough: stats.enough.map(|words| words.0),
            mean: stats.mean(run.cycles),
            full: run.share(stats.full),
            empty: run.share(stats.empty),
        }
    }
}

/// What each rule spared, of those that hold.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct RulesJson {
    #[serde(skip_serializing_if = "Option::is_none")]
    own: Option<OwnJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    a4b: Option<A4bJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    a4c: Option<A4cJson>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct OwnJson {
    slab_tests: u64,
    intersection_tests: u64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct A4bJson {
    rays_not_sent: u64,
    object_tests: u64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct A4cJson {
    rays_not_sent: u64,
    polygon_tests: u64,
}

impl RulesJson {
    /// `None` where there are no rules.
    pub fn new(rules: Rules, spared: &Spared) -> Option<RulesJson> {
        let Spared { slab_tests, intersection_tests, lit_rays, object_tests, shaded_rays, polygon_tests } = *spared;
        (rules != Rules::default()).then_some(RulesJson {
            own: rules.own.then_some(OwnJson { slab_tests, intersection_tests }),
            a4b: rules.a4b.then_some(A4bJson { rays_not_sent: lit_rays, object_tests }),
            a4c: rules.a4c.then_some(A4cJson { rays_not_sent: shaded_rays, polygon_tests }),
        })
    }
}

/// What FIFOs carried, by the four kinds of messages.
type Messages = serde_json::Map<String, serde_json::Value>;

fn messages(carried: &CarriedByKind) -> Messages {
    let kind = |kind: MessageKind| {
        let Carried { sent, words } = carried[kind as usize];
        (kind.key(), serde_json::json!({"sent": sent, "words": words}))
    };
    MessageKind::ALL.into_iter().map(kind).collect()
}

/// What was counted on a run's rays. A replay has none of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted<'a> {
    /// How often the kernels did their work.
    pub counts: Option<&'a Counts>,
    /// An image's rays by kind.
    pub kinds: Option<&'a RaysByKind>,
    /// How many samples were taken, where not all of them had a ray.
    pub samples: Option<u64>,
    /// Of how many pixels there were more samples, where adaptive sampling says which.
    pub refined_pixels: Option<u64>,
    /// What the FIFOs carried, by kind.
    pub messages: Option<CarriedByKind>,
    /// The rules that the host went by.
    pub rules: Rules,
}

/// The statistics of a run as indented JSON.
pub fn to_json(
    (run, path): (&Measured, Option<&CriticalPath>),
    clock: Clock,
    losses: Option<&Losses>,
    counted: Counted<'_>,
    configuration: &Configuration,
) -> serde_json::Result<String> {
    let seconds = clock.seconds(run.cycles);
    let fifos = run.topology.fifos.iter().zip(&run.fifos);
    let report = Report {
        cycles: run.cycles.0,
        seconds,
        rays: run.jobs,
        rays_per_second: if seconds > 0.0 { run.jobs as f64 / seconds } else { 0.0 },
        cells: run.stations.iter().map(|times| station(run, times)).collect(),
        fifos: fifos.map(|(info, stats)| Fifo::new(info, stats, run)).collect(),
        counts: counted.counts.map(|counts| CountsJson {
            voxels: counts.voxels,
            slab_tests: counts.slab_tests,
            intersection_tests: counts.intersection_tests,
            hits: counts.hits,
        }),
        samples: counted.samples,
        refined_pixels: counted.refined_pixels,
        rays_by_kind: counted.kinds,
        messages: counted.messages.as_ref().map(messages),
        rules: counted.counts.and_then(|counts| RulesJson::new(counted.rules, &counts.spared)),
        bottleneck: bottleneck::sentence(run),
        losses,
        why: path.map(PathJson::new),
        configuration,
    };
    serde_json::to_string_pretty(&report).map(|json| json + "\n")
}
