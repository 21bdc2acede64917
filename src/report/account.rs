//! What people read of a run: what ran, on what machine, how fast, and where the time went.

use std::path::Path;

use super::bottleneck;
use super::kinds::{self, RaysByKind};
use super::losses::Losses;
use super::moment;
use super::plot::Caption;
use super::prediction::{self, Row};
use super::stats::{self, Configuration, Counted};
use super::summary::{self, grouped, plural};
use super::why;
use crate::error::InputError;
use crate::host::color_table::{Color, ColorError, ColorTable, Palette};
use crate::host::order::Order;
use crate::host::shading::RayKind;
use crate::machine::{Machine, MachineSpec};
use crate::measure::{Actor, Clock, CriticalPath, Measured, Observed};
use crate::program::{Kernel, Workload};
use crate::run::{Forecast, KindCounts, Outcome, Rendered, Replay, RunSpec, Setup, Timing};
use crate::scene::Scene;

/// What runs, in one line: a run of primary rays.
pub fn title(setup: &Setup) -> String {
    let Setup { spec, scene, prepared, workload, .. } = setup;
    run_title(spec, scene, workload, prepared.rays.len())
}

/// The same of a run that is described, laid out, and has so many rays.
pub fn run_title(spec: &RunSpec, scene: &Scene, workload: &Workload, rays: usize) -> String {
    let RunSpec { program, order, .. } = spec;
    format!(
        "{} on {} in {} of {}: scene {} ({}), {}{}",
        program.name,
        plural(workload.cells() as u64, "cell"),
        plural(workload.groups() as u64, "group"),
        program.stages.len(),
        scene.name,
        plural(workload.polygons().len() as u64, "polygon"),
        plural(rays as u64, "ray"),
        in_order(*order),
    )
}

/// What runs, in one line: a whole image.
pub fn image_title(setup: &Setup, rendered: &Rendered) -> String {
    let Setup { spec: RunSpec { program, order, .. }, scene, workload, .. } = setup;
    let rays: u64 = rendered.kinds.iter().map(|kind| kind.rays).sum();
    let polygons = plural(workload.polygons().len() as u64, "polygon");
    let per_pixel = rays as f64 / rendered.pixels.len().max(1) as f64;
    let what = format!("scene {} ({polygons}), {}, {per_pixel:.2} a pixel", scene.name, plural(rays, "ray"));
    if rendered.timing.is_none() {
        return format!("image without timing: {what}");
    }
    let (cells, groups) = (plural(workload.cells() as u64, "cell"), plural(workload.groups() as u64, "group"));
    let (name, order) = (&program.name, in_order(*order));
    format!("{name} on {cells} in {groups} of {}: {what}{order}", program.stages.len())
}

/// What runs, in one line: a replay.
pub fn replay_title(replay: &Replay) -> String {
    let Replay { spec, trace, .. } = replay;
    let (cells, rays) = (plural(trace.cells() as u64, "cell"), plural(trace.jobs(), "ray"));
    format!("replay of {} on {cells}: {rays}", spec.ops.display())
}

/// What pictures of a run with that title tell of it.
pub fn caption(title: String, setup: &Setup) -> Caption {
    let Setup { spec: RunSpec { program, .. }, workload, machine, .. } = setup;
    let partition = (workload.groups() > 1).then(|| program.partition.to_string());
    Caption { title, partition, machine: machine_line(&machine.spec) }
}

/// What pictures of a replay tell of it.
pub fn replay_caption(replay: &Replay) -> Caption {
    Caption { title: replay_title(replay), partition: None, machine: machine_line(&replay.machine.spec) }
}

/// The same of a trace whose FIFOs are sized.
pub fn sized_trace_title(replay: &Replay) -> String {
    let Replay { spec, trace, .. } = replay;
    let (cells, rays) = (plural(trace.cells() as u64, "cell"), plural(trace.jobs(), "ray"));
    format!("{} on {cells}: {rays}", spec.ops.display())
}

/// What people read of a run of primary rays.
pub fn text(setup: &Setup, outcome: &Outcome, losses: Option<&Losses>) -> String {
    let (names, clock) = (cell_names(&setup.workload), setup.machine.spec.clock());
    let path = outcome.observed.path.as_ref();
    format!("{}\n{}", head(setup, outcome), body((&outcome.stats, path), losses, &names, clock))
}

/// What ran, and how fast.
pub fn head(setup: &Setup, outcome: &Outcome) -> String {
    let Setup { machine, prepared, workload, .. } = setup;
    let (spec, rays) = (&machine.spec, prepared.rays.len());
    let hits = outcome.counts.hits;
    let mut lines = vec![title(setup), machine_line(spec), summary::speed(&outcome.stats, spec.clock())];
    if prepared.screen.is_some() {
        lines.push(samples_line(prepared.count() as u64, rays as u64, hits));
    }
    lines.extend([
        format!(
            "{} hit ({:.1} %); {} voxels, {} slabs tests and {} intersection tests a ray",
            plural(hits, "ray"),
            100.0 * hits as f64 / rays.max(1) as f64,
            per_ray(outcome.counts.voxels, rays),
            per_ray(outcome.counts.slab_tests, rays),
            per_ray(outcome.counts.intersection_tests, rays),
        ),
        memory_line(workload) + "\n",
    ]);
    summary::prose(&lines.join("\n"))
}

/// Where the cycles of the cells went, what the FIFOs held, what limits the machine, and why it took as long if that is known.
pub fn body(
    (stats, path): (&Measured, Option<&CriticalPath>),
    losses: Option<&Losses>,
    names: &[String],
    clock: Clock,
) -> String {
    let why = path.map(|path| format!("\n{}", why::text(path, false))).unwrap_or_default();
    let verdict = summary::prose(&verdict(stats, losses, clock));
    format!("{}\n{}\n{verdict}\n{why}", summary::cells(stats, names), summary::fifos(stats))
}

/// What ran, as `head` has it, and why it took as long.
pub fn why_text(head: &str, stats: &Measured, observed: &Observed, by_cell: bool) -> String {
    let why = observed.path.as_ref().map(|path| format!("\n{}", why::text(path, by_cell))).unwrap_or_default();
    let enough = stats.fifos.iter().any(|fifo| fifo.enough.is_some());
    let fifos = if enough { format!("\n{}", summary::fifos(stats)) } else { String::new() };
    format!("{head}{why}{fifos}")
}

/// What ran, and what somebody did in the moment that was looked for.
///
/// # Errors
///
/// If there is no such cell, or no such moment.
pub fn moment_text(
    head: &str,
    stats: &Measured,
    (observed, clock): (&Observed, Clock),
    actor: Actor,
) -> Result<String, InputError> {
    let cells = stats.stations.len();
    if let Actor::Station(cell) = actor
        && cell >= cells
    {
        let error = InputError::new(format!("there is no cell {cell}: the array has {cells}"));
        return Err(error.help("cells are counted from 0, from left to right"));
    }
    let (Some(path), Some(snapshot)) = (&observed.path, &observed.snapshot) else {
        let error = InputError::new(format!("{actor} does nothing for that ray"));
        return Err(error.help(format!("rays are counted from 0; this run has {}", stats.jobs)));
    };
    if snapshot.at >= stats.cycles {
        let error = InputError::new(format!("the run is over before cycle {}", snapshot.at.0));
        return Err(error.help(format!("its last cycle is {}", stats.cycles.0.saturating_sub(1))));
    }
    Ok(format!("{head}\n{}", moment::text(path, snapshot, actor, clock)))
}

/// Of how many samples rays were sent, and of how many of these hit.
fn samples_line(samples: u64, sent: u64, hits: u64) -> String {
    let share = 100.0 * sent as f64 / samples.max(1) as f64;
    format!("{}, {} sent ({share:.1} %), of these {} hit", plural(samples, "sample"), grouped(sent), grouped(hits))
}

/// What an image's samples came to, if they were not all alike.
fn sampling_lines(setup: &Setup, rendered: &Rendered) -> String {
    let KindCounts { rays, hits, .. } = rendered.kinds[RayKind::Primary as usize];
    let sent = setup.prepared.screen.is_some().then(|| samples_line(rendered.samples, rays, hits));
    let refined = setup.image().adaptive.then(|| {
        let (refined, pixels) = (rendered.refined.len(), rendered.pixels.len());
        let share = 100.0 * refined as f64 / pixels.max(1) as f64;
        format!("{} of {} oversampled ({share:.1} %)", grouped(refined as u64), plural(pixels as u64, "pixel"))
    });
    sent.into_iter().chain(refined).map(|line| format!("\n{line}")).collect()
}

/// What people read of a whole image.
pub fn image_text(setup: &Setup, rendered: &Rendered, losses: Option<&Losses>) -> String {
    let title = summary::prose(&(image_title(setup, rendered) + &sampling_lines(setup, rendered)));
    let Some(timing) = &rendered.timing else {
        return format!("{title}\n\n{}\n", kinds::kinds(&rendered.kinds, None));
    };
    let (spec, stats) = (&setup.machine.spec, &timing.stats);
    let path = timing.observed.path.as_ref();
    let why = path.map(|path| format!("\n{}{}", why::text(path, false), why::OF_AN_IMAGE)).unwrap_or_default();
    let lines = [machine_line(spec), summary::speed(stats, spec.clock()), memory_line(&setup.workload)];
    [
        title,
        summary::prose(&lines.join("\n")),
        format!("\n{}", kinds::kinds(&rendered.kinds, Some((timing, spec.clock())))),
        summary::cells(stats, &cell_names(&setup.workload)),
        summary::fifos(stats),
        format!("{}\n{why}", summary::prose(&verdict(stats, losses, spec.clock()))),
    ]
    .join("\n")
}

/// How far a picture is off from the one in a file, in one line.
pub fn difference_line(error: &ColorError, truth: &Path) -> String {
    let ColorError { mean_square, largest } = error;
    summary::prose(&format!(
        "off from {} by {largest:.1} of 255 at most, mean square {mean_square:.3} a pixel\n\n",
        truth.display()
    ))
}

/// How far a picture of few colours is off, in one line.
pub fn colors_line(table: &ColorTable, palette: Palette, pixels: &[Color]) -> String {
    let ColorError { mean_square, largest } = table.error(pixels);
    let octree = match (table.level, table.bound()) {
        (Some(level), Some(bound)) => format!("; octree of level {level}, which is off by at most {bound:.1}"),
        _ => String::new(),
    };
    summary::prose(&format!(
        "{} by {}: off by {largest:.1} of 255 at most, mean square {mean_square:.2} a pixel{octree}\n\n",
        plural(table.colors.len() as u64, "colour"),
        palette.name(),
    ))
}

/// What people read of a replay.
pub fn replay_text(replay: &Replay, seen: (&Measured, Option<&CriticalPath>), losses: Option<&Losses>) -> String {
    format!("{}\n{}", replay_head(replay, seen.0), body(seen, losses, &[], replay.machine.spec.clock()))
}

/// What was replayed, and how fast.
pub fn replay_head(replay: &Replay, stats: &Measured) -> String {
    let spec = &replay.machine.spec;
    summary::prose(&format!(
        "{}\n{}\n{}\n",
        replay_title(replay),
        machine_line(spec),
        summary::speed(stats, spec.clock())
    ))
}

/// What people read of a prediction: `rows` are its quantities, with those of the run or without.
pub fn model_text((scene, spec, machine): (&Scene, &RunSpec, &Machine), forecast: &Forecast, rows: &[Row]) -> String {
    let (polygons, rays) = (forecast.polygons, forecast.rays);
    let program = &spec.program;
    let title = format!(
        "{} on {} in {} of {}, grid coefficient {}: scene {} ({}), {}{}",
        program.name,
        plural(program.cells() as u64, "cell"),
        plural(program.groups as u64, "group"),
        program.stages.len(),
        program.grid_coefficient,
        scene.name,
        plural(polygons as u64, "polygon"),
        plural(rays as u64, "ray"),
        in_order(spec.order),
    );
    let head = format!("{title}\n{}", machine_line(&machine.spec));
    let sentences = summary::prose(&prediction::sentences(forecast));
    format!("{}\n\n{}\n{sentences}", summary::prose(&head), prediction::to_table(rows))
}

/// The statistics of a run of primary rays, as JSON.
pub fn stats_json(setup: &Setup, outcome: &Outcome, losses: Option<&Losses>) -> serde_json::Result<String> {
    let configuration = Configuration::new(setup);
    let seen = (&outcome.stats, outcome.observed.path.as_ref());
    let counted = Counted {
        counts: Some(&outcome.counts),
        samples: setup.prepared.screen.as_ref().map(|_| setup.prepared.count() as u64),
        messages: Some(setup.workload.messages(&outcome.stats)),
        ..Counted::default()
    };
    stats::to_json(seen, setup.machine.spec.clock(), losses, counted, &configuration)
}

/// The statistics of a whole image that was timed, as JSON.
pub fn image_stats_json(
    setup: &Setup,
    rendered: &Rendered,
    timing: &Timing,
    losses: Option<&Losses>,
) -> serde_json::Result<String> {
    let configuration = Configuration::new(setup);
    let kinds = RaysByKind::new(&rendered.kinds, timing);
    let seen = (&timing.stats, timing.observed.path.as_ref());
    let counted = Counted {
        counts: Some(&rendered.counts),
        kinds: Some(&kinds),
        samples: setup.prepared.screen.as_ref().map(|_| rendered.samples),
        refined_pixels: setup.image().adaptive.then_some(rendered.refined.len() as u64),
        messages: Some(setup.workload.messages(&timing.stats)),
        rules: setup.image().rules,
    };
    stats::to_json(seen, setup.machine.spec.clock(), losses, counted, &configuration)
}

/// The statistics of a replay, as JSON.
pub fn replay_stats_json(
    replay: &Replay,
    seen: (&Measured, Option<&CriticalPath>),
    losses: Option<&Losses>,
) -> serde_json::Result<String> {
    let configuration = Configuration::Replay(Box::new(replay.spec.clone()));
    stats::to_json(seen, replay.machine.spec.clock(), losses, Counted::default(), &configuration)
}

/// What limits the machine, and where it is worth a word, to what it loses its time.
pub fn verdict(stats: &Measured, losses: Option<&Losses>, clock: Clock) -> String {
    let lost = losses.map(|losses| format!("\n{}", losses.sentence(stats, clock))).unwrap_or_default();
    format!("{}{lost}", bottleneck::sentence(stats))
}

/// Names the order of the rays in a title, if it is not the usual one.
fn in_order(order: Order) -> String {
    if order == Order::Raster { String::new() } else { format!(", in the order {order}") }
}

/// The machine in one line.
pub fn machine_line(spec: &MachineSpec) -> String {
    let own = match spec.own_words.len() {
        0 => String::new(),
        count => format!(" ({count} with depths of their own)"),
    };
    format!(
        "machine: {} ns a cycle, {}-word FIFOs{own}, {} Mbyte/s links ({}), latency {}",
        spec.clock_ns,
        spec.fifo_words.0,
        spec.link_mb_s,
        match spec.link_rate().cycles_per_word {
            1 => "a word a cycle".to_owned(),
            cycles => format!("a word in {cycles} cycles"),
        },
        spec.latency,
    )
}

/// The fullest cell's memory, in one line; of cells that run programs, with its parts.
fn memory_line(workload: &Workload) -> String {
    let largest = (0..workload.cells()).map(|cell| (workload.memory_of(cell).total(), std::cmp::Reverse(cell))).max();
    let (words, std::cmp::Reverse(cell)) = largest.unwrap_or_default();
    let line = format!("memory: {} words in the fullest cell, {cell}", grouped(words.0));
    if workload.cell_options().is_none() {
        return line;
    }
    let memory = workload.memory_of(cell);
    format!(
        "{line}: grid {} (equation 4), slabs {} (equation 6), planes and vertices {}, program and its tables {}",
        grouped(memory.grid.0),
        grouped(memory.slabs.0),
        grouped(memory.polygons.0),
        grouped(memory.program.0),
    )
}

/// What each cell runs.
pub fn cell_names(workload: &Workload) -> Vec<String> {
    (0..workload.cells()).map(|cell| kernel_names(workload.kernels_of(cell))).collect()
}

/// What a cell runs, in a word or two.
fn kernel_names(kernels: &[Kernel]) -> String {
    let name = |kernel: &Kernel| match kernel {
        Kernel::Grid => "grid",
        Kernel::Slabs => "slabs",
        Kernel::Intersection => "intersection",
    };
    if kernels.len() == 3 { "all".to_owned() } else { kernels.iter().map(name).collect::<Vec<_>>().join("+") }
}

fn per_ray(count: u64, rays: usize) -> String {
    format!("{:.2}", count as f64 / rays.max(1) as f64)
}
