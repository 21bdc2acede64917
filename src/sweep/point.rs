//! One point of a sweep, and what it shares with others.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::fmt::Display;

use super::parameters::IMAGE;
use crate::cancel::Cancel;
use crate::host::screen::Screen;
use crate::measure::{Measured, StateKind, StateTimes};
use crate::program::{Counts, Workload};
use crate::quantities::Cycles;
use crate::report::table::{Column, Kind};
use crate::run::{
    self, ImageSpec, Layers, Picture, PlannedRun, RunOptions, RunSpec, Switch, Timed, Traced, Watching, Workers,
};
use crate::scene::Scene;

/// What the table tells of a point, behind its parameters. `grid_us` to `idle_us` are what all cells together spend on a
/// ray in each state; they add up to `array_cells` times `us_per_ray`, but for what the cells' programs do beside the kernels.
pub const COLUMNS: [Column<'static>; 27] = [
    Column::new("array_cells", Kind::Whole, "cells of the array"),
    Column::new("polygons", Kind::Whole, "polygons of the scene"),
    Column::new("placed_polygons", Kind::Whole, "polygons of all sub-volumes together"),
    Column::new("ray_count", Kind::Whole, "rays"),
    Column::new("cycles", Kind::Whole, "simulated time (cycles)"),
    Column::new("seconds", Kind::Number, "simulated time (s)"),
    Column::new("rays_per_second", Kind::Number, "rays a second of simulated time"),
    Column::new("us_per_ray", Kind::Number, "simulated time (µs a ray)"),
    Column::new("hits", Kind::Whole, "rays that hit"),
    Column::new("voxels", Kind::Whole, "voxels visited"),
    Column::new("slab_tests", Kind::Whole, "slabs tests"),
    Column::new("intersection_tests", Kind::Whole, "intersection tests"),
    Column::new("grid_us", Kind::Number, "time of all cells on the grid (µs a ray)"),
    Column::new("slabs_us", Kind::Number, "time of all cells on slabs tests (µs a ray)"),
    Column::new("intersection_us", Kind::Number, "time of all cells on intersection tests (µs a ray)"),
    Column::new("moving_us", Kind::Number, "time of all cells moving words (µs a ray)"),
    Column::new("waiting_us", Kind::Number, "time of all cells waiting for words (µs a ray)"),
    Column::new("blocked_us", Kind::Number, "time of all cells blocked (µs a ray)"),
    Column::new("idle_us", Kind::Number, "time of all cells with nothing left to do (µs a ray)"),
    Column::new("mean_works", Kind::Number, "share of the time that a cell works, mean of all cells"),
    Column::new("busiest_cell", Kind::Whole, "number of the busiest cell"),
    Column::new("busiest_cell_works", Kind::Number, "share of the time that the busiest cell works"),
    Column::new("busiest_link_words", Kind::Whole, "words through the busiest link"),
    Column::new("fullest_fifo", Kind::Text, "fullest FIFO"),
    Column::new("fullest_fifo_words", Kind::Whole, "most that a FIFO held (words)"),
    Column::new("fullest_memory_words", Kind::Whole, "most that a cell's memory holds (words)"),
    Column::new("error", Kind::Text, "why the point failed"),
];

/// What a point gives.
pub struct Outcome {
    stats: Measured,
    counts: Counts,
    seconds: f64,
    polygons: usize,
    placed_polygons: usize,
    memory_words: u64,
}

/// The run whose parameters have these values.
pub fn planned(values: impl Iterator<Item = (&'static str, String)>) -> Result<PlannedRun, String> {
    let (mut options, mut image) = (RunOptions::default(), None);
    for (name, value) in values {
        match name == IMAGE.name {
            true => image = Some(value == "true"),
            false => options.set(name, &value).map_err(reason)?,
        }
    }
    let mut of_images = RunOptions::image_parameters().map(|known| known.name).chain(["host_hit_us"]);
    let of_image = of_images.find(|name| options.has(name));
    let spec = match (image, of_image) {
        (Some(false), Some(name)) => return Err(format!("{name} is for images, and image is false")),
        (Some(true), _) | (None, Some(_)) => image_spec(&options),
        (Some(false) | None, None) => RunSpec::new(&options, None).map_err(reason),
    }?;
    PlannedRun::new(spec).map_err(reason)
}

/// Runs a point that shares its ops with no other.
pub fn run(point: &PlannedRun, layers: &mut Layers, workers: &Workers) -> Result<Outcome, String> {
    let workload = &layers.workload(point, &workers.cancel).map_err(reason)?;
    if let Some(image) = &point.spec.image {
        let screen = layers.prepared(point).map_err(reason)?;
        let scene = layers.scene(point).map_err(reason)?;
        return render(point, image, (&scene, workload, screen.screen.as_ref()), workers);
    }
    let rays = &layers.prepared(point).map_err(reason)?.rays;
    let outcome = run::run(workload, &point.machine.spec, rays, workers, |_| Ok::<_, Infallible>(()));
    let outcome = outcome.map_err(reason)?;
    Ok(Outcome::new(point, workload, outcome.stats, outcome.counts))
}

/// Makes a point's image.
fn render(
    point: &PlannedRun,
    image: &ImageSpec,
    (scene, workload, screen): (&Scene, &Workload, Option<&Screen>),
    workers: &Workers,
) -> Result<Outcome, String> {
    let (size, sampling, limits) = (point.spec.size, image.sampling(), image.limits());
    let picture = Picture { scene, workload, size, sampling, limits, screen, rules: image.rules };
    let timed =
        Timed { spec: &point.machine.spec, rules: image.host_rules(point.spec.order), watching: Watching::default() };
    let rendered = run::render(&picture, Some(timed), workers, |_| Ok::<_, Infallible>(())).map_err(reason)?;
    let timing = rendered.timing.ok_or("the image was not timed")?;
    Ok(Outcome::new(point, workload, timing.stats, rendered.counts))
}

/// Times a point whose ops are there.
pub fn time(point: &PlannedRun, traced: &Traced, cancel: &Cancel) -> Result<Measured, String> {
    traced.time(&point.machine, &Watching::default(), cancel).map(|(stats, _)| stats).map_err(reason)
}

/// What an image is whose array is timed.
fn image_spec(options: &RunOptions) -> Result<RunSpec, String> {
    if options.has("rays") {
        return Err("the rays of an image are a camera's, not a file's".to_owned());
    }
    let spec = RunSpec::of_image(options, None).map_err(reason)?;
    if spec.image.as_ref().is_some_and(|image| image.timing == Switch::Off) {
        return Err("timing is off, and the table is about nothing else".to_owned());
    }
    Ok(spec)
}

/// A failure, in the words of a table.
pub fn reason(error: impl Display) -> String {
    error.to_string()
}

impl Outcome {
    /// What was measured in a point's array.
    pub fn new(point: &PlannedRun, workload: &Workload, stats: Measured, counts: Counts) -> Outcome {
        let seconds = point.machine.spec.seconds(stats.cycles);
        let memory = (0..workload.cells()).map(|cell| workload.memory_of(cell).total().0).max();
        let (polygons, memory_words) = (workload.polygons().len(), memory.unwrap_or(0));
        let placed_polygons = workload.placed_polygons();
        Outcome { stats, counts, seconds, polygons, placed_polygons, memory_words }
    }

    /// A cell for each of [`COLUMNS`].
    pub fn results(&self) -> Vec<String> {
        let Outcome { stats, counts, seconds, polygons, placed_polygons, memory_words } = self;
        let states = &stats.topology.states;
        let count = stats.stations.len();
        let work = |cell: usize| states.works(&stats.stations[cell]).0;
        let busiest = stats.busiest().unwrap_or(0);
        let fullest = stats.topology.fifos.iter().zip(&stats.fifos).rev().max_by_key(|(_, fifo)| fifo.max);
        let cycles = stats.cycles.0.max(1) as f64;
        let all_work: u64 = (0..count).map(work).sum();
        let rate = if *seconds > 0.0 { stats.jobs as f64 / seconds } else { 0.0 };
        let all = StateTimes::sum(&stats.stations);
        let kind = |kind: StateKind| self.us_a_ray(states.sum(&all, |state| state.kind == kind));
        let activity =
            |name: &str| self.us_a_ray(states.sum(&all, |state| state.kind == StateKind::Works && state.name == name));
        vec![
            count.to_string(),
            polygons.to_string(),
            placed_polygons.to_string(),
            stats.jobs.to_string(),
            stats.cycles.0.to_string(),
            seconds.to_string(),
            rate.to_string(),
            self.us_a_ray(stats.cycles),
            counts.hits.to_string(),
            counts.voxels.to_string(),
            counts.slab_tests.to_string(),
            counts.intersection_tests.to_string(),
            activity("grid"),
            activity("slabs"),
            activity("intersection"),
            kind(StateKind::Moves),
            kind(StateKind::Waits),
            kind(StateKind::Blocked),
            kind(StateKind::Idle),
            (all_work as f64 / cycles / count as f64).to_string(),
            busiest.to_string(),
            (work(busiest) as f64 / cycles).to_string(),
            busiest_link_words(stats).to_string(),
            fullest.map(|(info, _)| info.name.clone()).unwrap_or_default(),
            fullest.map(|(_, fifo)| fifo.max.0.to_string()).unwrap_or_default(),
            memory_words.to_string(),
            String::new(),
        ]
    }

    /// Cycles as µs a ray, to a tenth of a nanosecond.
    fn us_a_ray(&self, cycles: Cycles) -> String {
        let us = 1e6 * self.seconds * cycles.0 as f64 / self.stats.cycles.0.max(1) as f64;
        let rounded = (1e4 * us / self.stats.jobs.max(1) as f64).round() / 1e4;
        rounded.to_string()
    }
}

/// Words through the link between two neighbours, host included, through which most go: both channels together.
fn busiest_link_words(stats: &Measured) -> u64 {
    let mut words = BTreeMap::new();
    for (info, fifo) in stats.topology.fifos.iter().zip(&stats.fifos) {
        *words.entry((info.from, info.to)).or_insert(0) += fifo.words.0;
    }
    words.into_values().max().unwrap_or(0)
}
