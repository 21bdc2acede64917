//! Statistics as JSON.

use serde::Serialize;

use super::bottleneck;
use super::kinds::RaysByKind;
use crate::machine::{CellStats, Cycles, FifoStats, MachineSpec, RunStats, Work};
use crate::program::{CellMemory, Counts, Workload};
use crate::run::RunSpec;

/// What was run, beside its statistics: enough to run it again, and what its scene came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Configuration {
    /// The run.
    #[serde(flatten)]
    pub run: RunSpec,
    /// How many polygons the scene has.
    pub polygons: usize,
    /// Words that each cell's memory holds.
    pub memory: Vec<MemoryWords>,
}

impl Configuration {
    /// What a run is made of.
    pub fn new(run: &RunSpec, workload: &Workload) -> Configuration {
        Configuration {
            run: run.clone(),
            polygons: workload.polygons().len(),
            memory: (0..workload.cells()).map(|cell| workload.memory_of(cell).into()).collect(),
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
    rays_by_kind: Option<&'a RaysByKind>,
    bottleneck: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    configuration: Option<&'a Configuration>,
}

#[derive(Serialize)]
struct Cell {
    busy: Busy,
    moving: u64,
    waiting_x: u64,
    waiting_y: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    waiting_z: Option<u64>,
    blocked_x: u64,
    blocked_y: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    blocked_z: Option<u64>,
    idle: u64,
}

#[derive(Serialize)]
struct Busy {
    grid: u64,
    slabs: u64,
    intersection: u64,
    other: u64,
}

#[derive(Serialize)]
struct Fifo<'a> {
    name: &'a str,
    capacity: u64,
    words: u64,
    max: u64,
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

impl Cell {
    fn new(stats: &CellStats, run: &RunStats) -> Cell {
        let busy = |work| stats.busy.of(work).0;
        let on_z = |cycles: Cycles| run.sends_back().then_some(cycles.0);
        Cell {
            busy: Busy {
                grid: busy(Work::Grid),
                slabs: busy(Work::Slabs),
                intersection: busy(Work::Intersection),
                other: busy(Work::Other),
            },
            moving: stats.moving.0,
            waiting_x: stats.waiting_x.0,
            waiting_y: stats.waiting_y.0,
            waiting_z: on_z(stats.waiting_z),
            blocked_x: stats.blocked_x.0,
            blocked_y: stats.blocked_y.0,
            blocked_z: on_z(stats.blocked_z),
            idle: stats.idle.0,
        }
    }
}

impl<'a> Fifo<'a> {
    fn new(stats: &'a FifoStats, run: &RunStats) -> Fifo<'a> {
        let share = |cycles: u64| if run.cycles.0 == 0 { 0.0 } else { cycles as f64 / run.cycles.0 as f64 };
        Fifo {
            name: &stats.name,
            capacity: stats.capacity.0,
            words: stats.words.0,
            max: stats.max.0,
            mean: stats.mean(run.cycles),
            full: share(stats.full.0),
            empty: share(stats.empty.0),
        }
    }
}

/// The statistics of a run as indented JSON. A replay has no counts and no configuration.
pub fn to_json(
    stats: &RunStats,
    spec: &MachineSpec,
    counts: Option<&Counts>,
    configuration: Option<&Configuration>,
) -> serde_json::Result<String> {
    json(stats, spec, counts, None, configuration)
}

/// The same for an image, with its rays by kind.
pub fn image_to_json(
    stats: &RunStats,
    spec: &MachineSpec,
    counts: &Counts,
    kinds: &RaysByKind,
    configuration: &Configuration,
) -> serde_json::Result<String> {
    json(stats, spec, Some(counts), Some(kinds), Some(configuration))
}

fn json(
    stats: &RunStats,
    spec: &MachineSpec,
    counts: Option<&Counts>,
    rays_by_kind: Option<&RaysByKind>,
    configuration: Option<&Configuration>,
) -> serde_json::Result<String> {
    let seconds = spec.seconds(stats.cycles);
    let report = Report {
        cycles: stats.cycles.0,
        seconds,
        rays: stats.rays,
        rays_per_second: if seconds > 0.0 { stats.rays as f64 / seconds } else { 0.0 },
        cells: stats.cells.iter().map(|cell| Cell::new(cell, stats)).collect(),
        fifos: stats.fifos.iter().map(|fifo| Fifo::new(fifo, stats)).collect(),
        counts: counts.map(|counts| CountsJson {
            voxels: counts.voxels,
            slab_tests: counts.slab_tests,
            intersection_tests: counts.intersection_tests,
            hits: counts.hits,
        }),
        rays_by_kind,
        bottleneck: bottleneck::sentence(stats, spec),
        configuration,
    };
    serde_json::to_string_pretty(&report).map(|json| json + "\n")
}
