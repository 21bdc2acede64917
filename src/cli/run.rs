//! The main job: a scene, an array program and a machine, run.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pcs_sim::error::InputError;
use pcs_sim::host::image;
use pcs_sim::machine::{Machine, MachineSpec};
use pcs_sim::program::{Kernel, Workload};
use pcs_sim::report::plot::Caption;
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::summary::{self, grouped};
use pcs_sim::report::{bottleneck, hits, stats};
use pcs_sim::run::{self, Layers, Outcome, OutputFile, PlannedRun, Prepared, RunSpec, Workers};
use pcs_sim::scene::Scene;
use pcs_sim::seam::activity_trace::{Form, TraceWriter};

use super::args::{RunArgs, Typed};
use super::views::{Seen, Views};
use super::watch::{Live, Watch};
use super::{Failure, moot_flags, outputs, print, progress};

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
pub fn run(args: &RunArgs, typed: &Typed) -> Result<(), Failure> {
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
    let outcome = simulate(&setup, (workers, args.results.watch, form), &mut files)?;
    print(&report(&setup, &outcome))?;
    let written = write_outputs(&setup, &outcome, files)?;
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
        super::note(note);
    }
}

fn simulate(
    setup: &Setup,
    (workers, watch, form): (Workers, bool, Form),
    files: &mut Outputs,
) -> Result<Outcome, Failure> {
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
    let watched = (spec, &views.watching());
    let outcome = run::run_watched(&setup.workload, watched, &setup.prepared.rays, &workers, |batch, array| {
        live.inc(batch.hits.len() as u64);
        live.show(array);
        writer.as_mut().map_or(Ok(()), |writer| writer.write(&batch.ops)).map_err(failed)
    });
    live.finish();
    Ok(outcome?)
}

fn report(setup: &Setup, outcome: &Outcome) -> String {
    let Setup { machine, prepared, workload, .. } = setup;
    let (spec, rays) = (&machine.spec, prepared.rays.len());
    let hits = outcome.counts.hits;
    let names = cell_names(workload);
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
    lines.push(memory_line(workload));
    format!(
        "{}\n\n{}\n{}\n{}\n",
        lines.join("\n"),
        summary::cells(&outcome.stats, &names),
        summary::fifos(&outcome.stats),
        bottleneck::sentence(&outcome.stats),
    )
}

/// What runs, in one line.
fn title(setup: &Setup) -> String {
    let Setup { spec: RunSpec { program, .. }, scene, prepared, workload, .. } = setup;
    format!(
        "{} on {} cells in {} of {}: scene {} ({} polygons), {} rays",
        program.name,
        workload.cells(),
        plural(workload.groups(), "group"),
        program.stages.len(),
        scene.name,
        grouped(workload.polygons().len() as u64),
        grouped(prepared.rays.len() as u64),
    )
}

/// The machine in one line.
pub fn machine_line(spec: &MachineSpec) -> String {
    format!(
        "machine: {} ns a cycle, {}-word FIFOs, {} Mbyte/s links ({}), latency {}",
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

fn write_outputs(setup: &Setup, outcome: &Outcome, files: Outputs) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let polygons = setup.workload.polygons();
    let configuration = Configuration::new(&setup.spec, &setup.workload);
    outputs::finish(files.stats, &mut written, |file| {
        let spec = &setup.machine.spec;
        let json = stats::to_json(&outcome.stats, spec.clock(), Some(&outcome.counts), &configuration)?;
        file.write_all(json.as_bytes())
    })?;
    outputs::finish(files.hits, &mut written, |file| hits::write(file, polygons, &outcome.hits))?;
    outputs::finish(files.ops, &mut written, |_| Ok::<(), std::io::Error>(()))?;
    outputs::finish(files.image, &mut written, |file| {
        let pixels = image::preview(&setup.scene, polygons, &setup.prepared.rays, &outcome.hits);
        image::write_png(file, setup.spec.size, &pixels)
    })?;
    write_views(setup, outcome, &configuration, files.views, &mut written)?;
    Ok(written)
}

fn write_views(
    setup: &Setup,
    outcome: &Outcome,
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
    let (polygons, mut png) = (setup.workload.polygons(), Vec::new());
    let pixels = image::preview(&setup.scene, polygons, &setup.prepared.rays, &outcome.hits);
    image::write_png(&mut png, setup.spec.size, &pixels)
        .map_err(|error| Failure::Output(format!("the picture cannot be made: {error}")))?;
    Ok(Some(png))
}

/// What each cell runs.
pub fn cell_names(workload: &Workload) -> Vec<String> {
    (0..workload.cells()).map(|cell| kernel_names(workload.kernels_of(cell))).collect()
}
