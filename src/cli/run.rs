//! The main job: a scene, an array program and a machine, run.

use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::host::image;
use pcs_sim::measure::{Clock, Measured, Observed, Shape, When};
use pcs_sim::report::account::{self, cell_names};
use pcs_sim::report::graphs::{self as told, Gathered, Graphs};
use pcs_sim::report::losses::Losses;
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::{bottleneck, hits};
use pcs_sim::run::{self, Layers, Outcome, OutputFile, PlannedRun, RunSpec, Setup, Shuffled, Watching, Workers, moot};
use pcs_sim::seam::activity_trace::{Form, TraceWriter};

use super::args::{RunArgs, Typed};
use super::graphs::{self, GraphFiles};
use super::views::{Seen, Views};
use super::watch::{Live, Watch};
use super::{Failure, Told, outputs, print, progress};

/// The files that a run writes.
struct Outputs {
    stats: Option<OutputFile>,
    hits: Option<OutputFile>,
    ops: Option<OutputFile>,
    image: Option<OutputFile>,
    graphs: Option<GraphFiles>,
    views: Views,
}

/// `pcs-sim [--mode ...] [...]`
pub fn run(args: &RunArgs, typed: &Typed, told: Told) -> Result<(), Failure> {
    let options = args.asked.options(typed);
    let base = args.config.as_deref().map(RunSpec::read).transpose()?;
    let run = PlannedRun::new(RunSpec::of_rays(&options, base)?)?;
    moot::check_run(&options, &run.spec)?;
    let mut files = open_outputs(args, &run.spec)?;
    let (workers, form) = (workers(args.tracing.threads), args.tracing.ops_form.into());
    let spinner = progress::waiting("preparing the scene");
    let setup = outputs::reading(&named(args), || Setup::new(run, &mut Layers::default(), &workers.cancel))?;
    spinner.finish_and_clear();
    notes(&setup);
    let moment = told.moment(setup.machine.spec.clock())?;
    let mut gathered = files.graphs.is_some().then(|| Gathered::new(&setup));
    let watched = (workers, args.results.watch, form);
    let (outcome, losses) = simulate(&setup, watched, moment, (&mut files, gathered.as_mut()))?;
    let of_line = |(files, gathered): (&GraphFiles, _)| {
        told::of_line(&setup, gathered, (&outcome.stats, &outcome.observed), files.asked())
    };
    let graphs = files.graphs.as_ref().zip(gathered.as_ref()).map(of_line).transpose()?;
    let (names, losses) = (cell_names(&setup.workload), losses.as_ref());
    let seen = (&outcome.observed, setup.machine.spec.clock());
    print(&report(account::head(&setup, &outcome), told, (&outcome.stats, losses, &names), seen)?)?;
    let written = write_outputs(&setup, (&outcome, losses), graphs, files)?;
    print(&outputs::list(&written))
}

/// The threads to use: so many, or one a core.
pub fn workers(count: Option<u16>) -> Workers {
    count.map_or_else(Workers::on_all_cores, |count| Workers::new(count.into()))
}

/// The results that are asked for.
fn named(args: &RunArgs) -> [Option<&PathBuf>; 6] {
    [
        args.results.stats.as_ref(),
        args.tracing.hits.as_ref(),
        args.tracing.ops.as_ref(),
        args.image.as_ref(),
        args.views.page.as_ref(),
        args.views.trace.as_ref(),
    ]
}

fn open_outputs(args: &RunArgs, spec: &RunSpec) -> Result<Outputs, InputError> {
    let inputs = [
        Some(Path::new(&spec.scene)),
        spec.rays.as_deref(),
        args.asked.program.program.as_deref(),
        args.asked.machine_file.machine.as_deref(),
        args.config.as_deref(),
    ];
    outputs::check_distinct(&named(args), &inputs)?;
    graphs::check(&args.graph, spec.size)?;
    outputs::check_png(args.image.as_deref())?;
    let open = |path: &Option<PathBuf>| outputs::open(path.as_deref(), args.results.force);
    Ok(Outputs {
        stats: open(&args.results.stats)?,
        hits: open(&args.tracing.hits)?,
        ops: open(&args.tracing.ops)?,
        image: open(&args.image)?,
        graphs: GraphFiles::open(&args.graph, args.results.force)?,
        views: Views::open(&args.views, args.results.force)?,
    })
}

/// What the user should know before the figures: what had to be rounded, cut or assumed.
pub fn notes(setup: &Setup) {
    setup.notes().for_each(super::note);
}

fn simulate(
    setup: &Setup,
    (workers, watch, form): (Workers, bool, Form),
    moment: Option<When>,
    (files, mut gathered): (&mut Outputs, Option<&mut Gathered>),
) -> Result<(Outcome, Option<Losses>), Failure> {
    let spec = &setup.machine.spec;
    let mut live = Live::new(
        progress::rays(setup.prepared.rays.len() as u64),
        watch.then(|| Watch::new(spec.clock(), cell_names(&setup.workload))),
    );
    let failed = |error: std::io::Error| format!("cannot write the ops: {error}");
    let Outputs { ops, views, graphs, .. } = files;
    let (cells, costs) = (setup.workload.cells(), setup.workload.costs());
    let writer = ops.as_mut().map(|file| TraceWriter::new(file, cells, costs.clone(), form));
    let mut writer = writer.transpose().map_err(|error| Failure::Output(failed(error)))?;
    let watching = graphs::watching(graphs.as_ref(), views.watching(Shape::Line));
    let watched = (spec, &Watching { moment, ..watching });
    let mut shuffled = Shuffled::new(cells);
    let outcome = run::run_watched(&setup.workload, watched, &setup.prepared.rays, &workers, |batch, array| {
        shuffled.take(&batch.ops);
        gathered.iter_mut().for_each(|gathered| gathered.take_batch(batch, setup));
        live.inc(batch.hits.len() as u64);
        live.show(|| array.so_far());
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
    match told {
        Told::Moment(actor, _) => account::moment_text(&head, stats, (observed, clock), actor),
        Told::Why { by_cell } => Ok(account::why_text(&head, stats, observed, by_cell)),
        Told::All => Ok(head + "\n" + &account::body((stats, observed.path.as_ref()), losses, names, clock)),
    }
}

fn write_outputs(
    setup: &Setup,
    (outcome, losses): (&Outcome, Option<&Losses>),
    graphs: Option<Graphs>,
    files: Outputs,
) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let polygons = setup.workload.polygons();
    let configuration = Configuration::new(setup);
    outputs::finish(files.stats, &mut written, |file| {
        file.write_all(account::stats_json(setup, outcome, losses)?.as_bytes())
    })?;
    outputs::finish(files.hits, &mut written, |file| hits::write(file, polygons, &setup.by_number(&outcome.hits)))?;
    outputs::finish(files.ops, &mut written, |_| Ok::<(), std::io::Error>(()))?;
    outputs::finish(files.image, &mut written, |file| {
        image::write_png(file, setup.spec.size, &setup.preview(&outcome.hits))
    })?;
    if let (Some(files), Some(graphs)) = (files.graphs, graphs) {
        files.write(&graphs, &mut written)?;
    }
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
    let caption = &account::caption(account::title(setup), setup);
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
        regions: None,
        setup: Some(setup),
    };
    views.write(&seen, written)
}

/// The traced picture, if a view shows it and the rays are those of a picture.
fn page_image(setup: &Setup, outcome: &Outcome, views: &Views) -> Result<Option<Vec<u8>>, Failure> {
    if !views.show_image() || setup.spec.rays.is_some() {
        return Ok(None);
    }
    let mut png = Vec::new();
    image::write_png(&mut png, setup.spec.size, &setup.preview(&outcome.hits))
        .map_err(|error| Failure::Output(format!("the picture cannot be made: {error}")))?;
    Ok(Some(png))
}
