//! The main job: a scene, an array program and a machine, run.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;
use pcs_sim::error::InputError;
use pcs_sim::host::image;
use pcs_sim::host::order::Order;
use pcs_sim::machine::{Machine, MachineSpec};
use pcs_sim::measure::{Actor, Clock, Measured, Observed, When};
use pcs_sim::program::{Kernel, Workload};
use pcs_sim::report::losses::Losses;
use pcs_sim::report::plot::Caption;
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::summary::{self, grouped};
use pcs_sim::report::{bottleneck, hits, moment, stats, why};
use pcs_sim::run::{self, Layers, Outcome, OutputFile, PlannedRun, Prepared, RunSpec, Shuffled, Watching, Workers};
use pcs_sim::scene::Scene;
use pcs_sim::seam::activity_trace::{Form, TraceWriter};

use super::args::{RunArgs, Typed};
use super::views::{Seen, Views};
use super::watch::{Live, Watch};
use super::{Failure, Told, moot_flags, outputs, print, progress};

/// The files that a run writes.
struct Outputs {
    stats: Option<OutputFile>,
    hits: Option<OutputFile>,
    ops: Option<OutputFile>,
    image: Option<OutputFile>,
    views: Views,
}

/// What a run is made of.
struct Setup {
    spec: RunSpec,
    scene: Arc<Scene>,
    machine: Machine,
    prepared: Arc<Prepared>,
    workload: Workload,
}

/// `pcs-sim [--mode ...] [...]`
pub fn run(args: &RunArgs, typed: &Typed, told: Told) -> Result<(), Failure> {
    let options = args.options(typed);
    let base = args.config.as_deref().map(RunSpec::read).transpose()?;
    if base.as_ref().is_some_and(|base| base.image.is_some()) {
        let error = InputError::new("the configuration is that of a whole image");
        return Err(error.help("`pcs-sim image --config FILE` makes it again").into());
    }
    let run = PlannedRun::new(RunSpec::new(&options, base)?)?;
    moot_flags::check_run(&options, &run.spec)?;
    let mut files = open_outputs(args, &run.spec)?;
    let (workers, form) = (workers(args.tracing.threads), args.tracing.ops_form.into());
    let spinner = progress::waiting("preparing the scene");
    let mut layers = Layers::default();
    let workload = layers.workload(&run, &workers.cancel)?;
    workload.check(&run.machine.spec)?;
    let (scene, prepared) = (layers.scene(&run)?, layers.prepared(&run)?);
    spinner.finish_and_clear();
    let PlannedRun { spec, machine, .. } = run;
    let setup = Setup { spec, scene, machine, prepared, workload };
    notes(&setup);
    let moment = told.moment(setup.machine.spec.clock())?;
    let (outcome, losses) = simulate(&setup, (workers, args.results.watch, form), moment, &mut files)?;
    let (names, losses) = (cell_names(&setup.workload), losses.as_ref());
    let seen = (&outcome.observed, setup.machine.spec.clock());
    print(&report(head(&setup, &outcome), told, (&outcome.stats, losses, &names), seen)?)?;
    let written = write_outputs(&setup, &outcome, losses, files)?;
    print(&outputs::list(&written))
}

/// The threads to use: so many, or one a core.
pub fn workers(count: Option<u16>) -> Workers {
    count.map_or_else(Workers::on_all_cores, |count| Workers::new(count.into()))
}

fn open_outputs(args: &RunArgs, spec: &RunSpec) -> Result<Outputs, InputError> {
    let named = [
        args.results.stats.as_ref(),
        args.tracing.hits.as_ref(),
        args.tracing.ops.as_ref(),
        args.image.as_ref(),
        args.views.page.as_ref(),
        args.views.trace.as_ref(),
    ];
    let inputs = [
        Some(Path::new(&spec.scene)),
        spec.rays.as_deref(),
        args.program.program.as_deref(),
        args.machine_file.machine.as_deref(),
        args.config.as_deref(),
    ];
    outputs::check_distinct(&named, &inputs)?;
    let open = |path: &Option<PathBuf>| outputs::open(path.as_deref(), args.results.force);
    Ok(Outputs {
        stats: open(&args.results.stats)?,
        hits: open(&args.tracing.hits)?,
        ops: open(&args.tracing.ops)?,
        image: open(&args.image)?,
        views: Views::open(&args.views, args.results.force)?,
    })
}

/// What the user should know before the figures: what had to be rounded, cut or assumed.
fn notes(setup: &Setup) {
    for note in setup.machine.notes.iter().chain(&setup.scene.notes) {
        eprintln!("note: {note}");
    }
}

fn simulate(
    setup: &Setup,
    (workers, watch, form): (Workers, bool, Form),
    moment: Option<When>,
    files: &mut Outputs,
) -> Result<(Outcome, Option<Losses>), Failure> {
    let spec = &setup.machine.spec;
    let mut live = Live::new(
        progress::rays(setup.prepared.rays.len() as u64),
        watch.then(|| Watch::new(spec.clock(), cell_names(&setup.workload))),
    );
    let failed = |error: std::io::Error| format!("cannot write the ops: {error}");
    let Outputs { ops, views, .. } = files;
    let (cells, costs) = (setup.workload.cells(), setup.workload.costs());
    let writer = ops.as_mut().map(|file| TraceWriter::new(file, cells, costs.clone(), form));
    let mut writer = writer.transpose().map_err(|error| Failure::Output(failed(error)))?;
    let watched = (spec, &Watching { moment, ..views.watching() });
    let mut shuffled = Shuffled::new(cells);
    let outcome = run::run_watched(&setup.workload, watched, &setup.prepared.rays, &workers, |batch, array| {
        shuffled.take(&batch.ops);
        live.inc(batch.hits.len() as u64);
        live.show(array);
        writer.as_mut().map_or(Ok(()), |writer| writer.write(&batch.ops)).map_err(failed)
    });
    live.finish();
    let outcome = outcome?;
    let losses = bottleneck::losses(&outcome.stats, || shuffled.time(spec, costs, &workers.cancel));
    Ok((outcome, losses))
}

/// What people read of a run: what ran, as `head` has it, and what is to be told of where its time went.
pub fn report(
    head: String,
    told: Told,
    (stats, losses, names): (&Measured, Option<&Losses>, &[String]),
    (observed, clock): (&Observed, Clock),
) -> Result<String, InputError> {
    let path = observed.path.as_ref();
    let why = |by_cell: bool| path.map(|path| format!("\n{}", why::text(path, by_cell))).unwrap_or_default();
    match told {
        Told::Moment(actor, _) => Ok(head + "\n" + &moment(stats, (observed, clock), actor)?),
        Told::Why { by_cell } => Ok(head + &why(by_cell)),
        Told::All => Ok(format!(
            "{head}\n{}\n{}\n{}\n{}",
            summary::cells(stats, names),
            summary::fifos(stats),
            verdict(stats, losses, clock),
            why(false),
        )),
    }
}

/// What somebody did in the moment that was looked for.
fn moment(stats: &Measured, (observed, clock): (&Observed, Clock), actor: Actor) -> Result<String, InputError> {
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
    Ok(moment::text(path, snapshot, actor, clock))
}

/// What ran, and how fast.
fn head(setup: &Setup, outcome: &Outcome) -> String {
    let Setup { machine, prepared, workload, .. } = setup;
    let (spec, rays) = (&machine.spec, prepared.rays.len());
    let hits = outcome.counts.hits;
    let mut lines = vec![
        title(setup),
        machine_line(spec),
        summary::speed(&outcome.stats, spec.clock()),
        format!(
            "{} rays hit ({:.1} %); {} voxels, {} slabs tests and {} intersection tests a ray",
            grouped(hits),
            100.0 * hits as f64 / rays.max(1) as f64,
            per_ray(outcome.counts.voxels, rays),
            per_ray(outcome.counts.slab_tests, rays),
            per_ray(outcome.counts.intersection_tests, rays),
        ),
    ];
    lines.push(memory_line(workload) + "\n");
    lines.join("\n")
}

/// What limits the machine, and where it is worth a word, to what it loses its time.
pub fn verdict(stats: &Measured, losses: Option<&Losses>, clock: Clock) -> String {
    let lost = losses.map(|losses| format!("\n{}", losses.sentence(stats, clock))).unwrap_or_default();
    format!("{}{lost}", bottleneck::sentence(stats))
}

/// What runs, in one line.
fn title(setup: &Setup) -> String {
    let Setup { spec, scene, prepared, workload, .. } = setup;
    run_title(spec, scene, workload, prepared.rays.len())
}

/// The same of a run that is described, laid out, and has so many rays.
pub fn run_title(spec: &RunSpec, scene: &Scene, workload: &Workload, rays: usize) -> String {
    let RunSpec { program, order, .. } = spec;
    format!(
        "{} on {} cells in {} of {}: scene {} ({} polygons), {} rays{}",
        program.name,
        workload.cells(),
        plural(workload.groups(), "group"),
        program.stages.len(),
        scene.name,
        grouped(workload.polygons().len() as u64),
        grouped(rays as u64),
        in_order(*order),
    )
}

/// Names the order of the rays in a title, if it is not the usual one.
pub fn in_order(order: Order) -> String {
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
pub fn memory_line(workload: &Workload) -> String {
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

/// `1 group`, `2 groups`.
pub fn plural(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

fn write_outputs(
    setup: &Setup,
    outcome: &Outcome,
    losses: Option<&Losses>,
    files: Outputs,
) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let polygons = setup.workload.polygons();
    let configuration = Configuration::new(&setup.spec, &setup.workload);
    let path = outcome.observed.path.as_ref();
    outputs::finish(files.stats, &mut written, |file| {
        let spec = &setup.machine.spec;
        let seen = (&outcome.stats, path);
        let json = stats::to_json(seen, spec.clock(), losses, Some(&outcome.counts), &configuration)?;
        file.write_all(json.as_bytes())
    })?;
    let sequence = setup.spec.sequence(setup.prepared.rays.len());
    let found = sequence.by_number(&outcome.hits);
    outputs::finish(files.hits, &mut written, |file| hits::write(file, polygons, &found))?;
    outputs::finish(files.ops, &mut written, |_| Ok::<(), std::io::Error>(()))?;
    outputs::finish(files.image, &mut written, |file| {
        image::write_png(file, setup.spec.size, &preview(setup, outcome))
    })?;
    write_views(setup, (outcome, losses), &configuration, files.views, &mut written)?;
    Ok(written)
}

fn write_views(
    setup: &Setup,
    (outcome, losses): (&Outcome, Option<&Losses>),
    configuration: &Configuration,
    views: Views,
    written: &mut Vec<PathBuf>,
) -> Result<(), Failure> {
    let spec = &setup.machine.spec;
    let caption = &Caption { title: title(setup), machine: machine_line(spec) };
    let cell_names = &cell_names(&setup.workload);
    let image = page_image(setup, outcome, &views)?;
    let seen = Seen {
        caption,
        clock: spec.clock(),
        stats: &outcome.stats,
        losses,
        observed: &outcome.observed,
        cell_names,
        configuration,
        image: image.as_deref(),
    };
    views.write(&seen, written)
}

/// The traced picture, if a view shows it and the rays are those of a picture.
fn page_image(setup: &Setup, outcome: &Outcome, views: &Views) -> Result<Option<Vec<u8>>, Failure> {
    if !views.show_image() || setup.spec.rays.is_some() {
        return Ok(None);
    }
    let mut png = Vec::new();
    image::write_png(&mut png, setup.spec.size, &preview(setup, outcome))
        .map_err(|error| Failure::Output(format!("the picture cannot be made: {error}")))?;
    Ok(Some(png))
}

/// The picture of the primary rays' hits: its pixels, line by line.
fn preview(setup: &Setup, outcome: &Outcome) -> Vec<Vec3> {
    let Setup { spec, scene, prepared, workload, .. } = setup;
    let pixels = image::preview(scene, workload.polygons(), &prepared.rays, &outcome.hits);
    spec.sequence(prepared.rays.len()).by_number(&pixels)
}

/// What each cell runs.
pub fn cell_names(workload: &Workload) -> Vec<String> {
    (0..workload.cells()).map(|cell| kernel_names(workload.kernels_of(cell))).collect()
}
