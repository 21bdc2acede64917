//! `pcs-sim image SCENE -o FILE`: a whole image, with the host and the array in a closed loop.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::geometry::Hit;
use pcs_sim::host::image;
use pcs_sim::machine::Machine;
use pcs_sim::program::Workload;
use pcs_sim::report::kinds::{self, RaysByKind};
use pcs_sim::report::losses::Losses;
use pcs_sim::report::plot::Caption;
use pcs_sim::report::stats::{self, Configuration};
use pcs_sim::report::summary::{self, grouped};
use pcs_sim::report::{bottleneck, hits, why};
use pcs_sim::run::{
    self, ImageSpec, Layers, OutputFile, Picture, PlannedRun, Rendered, RunSpec, Seen, Shuffled, Switch, Timed, Timing,
};
use pcs_sim::scene::Scene;
use pcs_sim::seam::activity_trace::TraceWriter;

use super::args::{ImageArgs, Typed};
use super::run::{cell_names, in_order, machine_line, memory_line, plural, verdict, workers};
use super::views::{self, Views};
use super::watch::{Live, Watch};
use super::{Failure, moot_flags, outputs, print, progress};

/// What the image can be written as.
#[derive(Clone, Copy, PartialEq)]
enum Format {
    Png,
    Pfm,
}

/// The files that the command writes.
struct Outputs {
    image: Option<OutputFile>,
    stats: Option<OutputFile>,
    hits: Option<OutputFile>,
    ops: Option<OutputFile>,
    views: Views,
}

/// What an image is made of.
struct Setup {
    spec: RunSpec,
    image: ImageSpec,
    scene: Arc<Scene>,
    machine: Machine,
    workload: Workload,
}

/// Makes the image.
pub fn image(args: &ImageArgs, typed: &Typed) -> Result<(), Failure> {
    let format = format(args)?;
    let options = args.options(typed);
    let base = args.config.as_deref().map(RunSpec::read).transpose()?;
    let run = PlannedRun::new(RunSpec::of_image(&options, base)?)?;
    let image = run.spec.image.clone().unwrap_or_default();
    moot_flags::check_image(args, &options, &run.spec, &image)?;
    let mut files = open_outputs(args, &run.spec)?;
    let spinner = progress::waiting("preparing the scene");
    let mut layers = Layers::default();
    let workload = layers.workload(&run, &Cancel::default())?;
    workload.check(&run.machine.spec)?;
    let scene = layers.scene(&run)?;
    spinner.finish_and_clear();
    let PlannedRun { spec, machine, .. } = run;
    let setup = Setup { spec, image, scene, machine, workload };
    setup.machine.notes.iter().chain(&setup.scene.notes).for_each(|note| eprintln!("note: {note}"));
    let mut found = Vec::new();
    let (rendered, losses) = render(args, &setup, &mut files, &mut found)?;
    print(&report(&setup, &rendered, losses.as_ref()))?;
    let written = write_outputs(format, &setup, (&rendered, losses.as_ref()), &found, files)?;
    print(&outputs::list(&written))
}

fn format(args: &ImageArgs) -> Result<Format, InputError> {
    let extension = args.output.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("png") => Ok(Format::Png),
        Some("pfm") => Ok(Format::Pfm),
        _ => Err(InputError::in_file(&args.output, "is no name of an image").help("images end in .png or .pfm")),
    }
}

fn open_outputs(args: &ImageArgs, spec: &RunSpec) -> Result<Outputs, InputError> {
    let (stats, hits, ops) = (args.results.stats.as_ref(), args.tracing.hits.as_ref(), args.tracing.ops.as_ref());
    let inputs = [
        Some(Path::new(&spec.scene)),
        args.program.program.as_deref(),
        args.machine_file.machine.as_deref(),
        args.config.as_deref(),
    ];
    outputs::check_distinct(
        &[Some(&args.output), stats, hits, ops, args.views.page.as_ref(), args.views.trace.as_ref()],
        &inputs,
    )?;
    let open = |path: Option<&PathBuf>| outputs::open(path.map(PathBuf::as_path), args.results.force);
    Ok(Outputs {
        image: open(Some(&args.output))?,
        stats: open(stats)?,
        hits: open(hits)?,
        ops: open(ops)?,
        views: Views::open(&args.views, args.results.force)?,
    })
}

fn render(
    args: &ImageArgs,
    setup: &Setup,
    files: &mut Outputs,
    found: &mut Vec<Hit>,
) -> Result<(Rendered, Option<Losses>), Failure> {
    let picture = Picture {
        scene: &setup.scene,
        workload: &setup.workload,
        size: setup.spec.size,
        sampling: setup.image.sampling(),
        limits: setup.image.limits(),
    };
    let (cells, costs) = (setup.workload.cells(), setup.workload.costs());
    let timed = (setup.image.timing == Switch::On).then(|| Timed {
        spec: &setup.machine.spec,
        rules: setup.image.rules(setup.spec.order),
        watching: files.views.watching(),
    });
    let unwritable = |error: std::io::Error| format!("cannot write the ops: {error}");
    let form = args.tracing.ops_form.into();
    let writer = files.ops.as_mut().map(|file| TraceWriter::new(file, cells, costs.clone(), form));
    let mut writer = writer.transpose().map_err(|error| Failure::Output(unwritable(error)))?;
    let keeps_hits = files.hits.is_some();
    let watch = || Watch::new(setup.machine.spec.clock(), cell_names(&setup.workload));
    let mut live = Live::new(progress::samples(), args.results.watch.then(watch));
    let mut shuffled = Shuffled::new(cells);
    let workers = workers(args.tracing.threads);
    let result = run::render(&picture, timed, &workers, |seen| match seen {
        Seen::Samples { done, of, array } => {
            live.set(done as u64, of as u64);
            array.into_iter().for_each(|array| live.show(array));
            Ok(())
        }
        Seen::Sent(ops, hit) => {
            shuffled.take(ops);
            found.extend(keeps_hits.then_some(*hit));
            writer.as_mut().map_or(Ok(()), |writer| writer.write(ops)).map_err(unwritable)
        }
    });
    live.finish();
    let rendered = result?;
    let spec = &setup.machine.spec;
    let losses = |timing: &Timing| bottleneck::losses(&timing.stats, || shuffled.time(spec, costs, &workers.cancel));
    let losses = rendered.timing.as_ref().and_then(losses);
    Ok((rendered, losses))
}

/// What runs, in one line.
fn title(setup: &Setup, rendered: &Rendered) -> String {
    let Setup { spec: RunSpec { program, order, .. }, scene, workload, .. } = setup;
    let rays: u64 = rendered.kinds.iter().map(|kind| kind.rays).sum();
    let polygons = grouped(workload.polygons().len() as u64);
    let per_pixel = rays as f64 / rendered.pixels.len().max(1) as f64;
    let what = format!("scene {} ({polygons} polygons), {} rays, {per_pixel:.2} a pixel", scene.name, grouped(rays));
    if rendered.timing.is_none() {
        return format!("image without timing: {what}");
    }
    let groups = plural(workload.groups(), "group");
    let (name, cells, order) = (&program.name, workload.cells(), in_order(*order));
    format!("{name} on {cells} cells in {groups} of {}: {what}{order}", program.stages.len())
}

fn report(setup: &Setup, rendered: &Rendered, losses: Option<&Losses>) -> String {
    let title = title(setup, rendered);
    let Some(timing) = &rendered.timing else {
        return format!("{title}\n\n{}\n", kinds::kinds(&rendered.kinds, None));
    };
    let (spec, stats) = (&setup.machine.spec, &timing.stats);
    let path = timing.observed.path.as_ref();
    let why = path.map(|path| format!("\n{}{}", why::text(path, false), why::OF_AN_IMAGE)).unwrap_or_default();
    [
        title,
        machine_line(spec),
        summary::speed(stats, spec.clock()),
        memory_line(&setup.workload),
        format!("\n{}", kinds::kinds(&rendered.kinds, Some((timing, spec.clock())))),
        summary::cells(stats, &cell_names(&setup.workload)),
        summary::fifos(stats),
        format!("{}\n{why}", verdict(stats, losses, spec.clock())),
    ]
    .join("\n")
}

fn write_outputs(
    format: Format,
    setup: &Setup,
    (rendered, losses): (&Rendered, Option<&Losses>),
    found: &[Hit],
    files: Outputs,
) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let (size, pixels) = (setup.spec.size, &rendered.pixels);
    outputs::finish(files.image, &mut written, |file| match format {
        Format::Png => image::write_png(file, size, pixels).map_err(|error| error.to_string()),
        Format::Pfm => image::write_pfm(file, size, pixels).map_err(|error| error.to_string()),
    })?;
    if let Some(timing) = &rendered.timing {
        let configuration = Configuration::new(&setup.spec, &setup.workload);
        outputs::finish(files.stats, &mut written, |file| {
            let kinds = RaysByKind::new(&rendered.kinds, timing);
            let (spec, counts) = (&setup.machine.spec, &rendered.counts);
            let (path, clock) = (timing.observed.path.as_ref(), spec.clock());
            let counted = (counts, &kinds);
            let json = stats::image_to_json((&timing.stats, path), clock, losses, counted, &configuration)?;
            file.write_all(json.as_bytes())
        })?;
        let spec = &setup.machine.spec;
        let mut png = Vec::new();
        if files.views.show_image() {
            image::write_png(&mut png, size, pixels)
                .map_err(|error| Failure::Output(format!("the picture cannot be made: {error}")))?;
        }
        let seen = views::Seen {
            caption: &Caption { title: title(setup, rendered), machine: machine_line(spec) },
            clock: spec.clock(),
            stats: &timing.stats,
            losses,
            observed: &timing.observed,
            cell_names: &cell_names(&setup.workload),
            configuration: &configuration,
            image: Some(&png),
        };
        files.views.write(&seen, &mut written)?;
    }
    outputs::finish(files.hits, &mut written, |file| hits::write(file, setup.workload.polygons(), found))?;
    outputs::finish(files.ops, &mut written, |_| Ok::<(), std::io::Error>(()))?;
    Ok(written)
}
