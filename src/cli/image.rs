//! `pcs-sim image SCENE -o FILE`: a whole image, with the host and the array in a closed loop.

use std::convert::Infallible;
use std::io::Write;
use std::path::{Path, PathBuf};

use glam::Vec3;
use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::geometry::Hit;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::color_table::{Color, ColorError, ColorTable, Palette};
use pcs_sim::host::image;
use pcs_sim::host::rules::Rules;
use pcs_sim::host::screen::{self, ScreenRectangles};
use pcs_sim::measure::Shape;
use pcs_sim::report::account::{self, cell_names};
use pcs_sim::report::graphs::{self as told, Gathered, Graphs};
use pcs_sim::report::losses::Losses;
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::summary::plural;
use pcs_sim::report::{bottleneck, hits};
use pcs_sim::run::{
    self, Layers, OutputFile, PlannedRun, Rendered, RunSpec, Seen, Setup, Shuffled, Switch, Timed, Timing, moot, noting,
};
use pcs_sim::seam::activity_trace::TraceWriter;

use super::args::{ImageArgs, Typed};
use super::graphs::{self, GraphFiles};
use super::run::{notes, workers};
use super::views::{self, Views};
use super::watch::{Live, Watch};
use super::{Failure, outputs, print, progress, shards};

/// What the image can be written as.
#[derive(Clone, Copy, PartialEq)]
pub enum Format {
    Png,
    /// With a table of so many colours.
    Indexed(usize, Palette),
    Pfm,
}

/// How images are named.
pub const IMAGES_END: &str = "images end in .png or .pfm; -.png and -.pfm are standard output";

/// The files that the command writes.
struct Outputs {
    image: Option<OutputFile>,
    refined: Option<OutputFile>,
    stats: Option<OutputFile>,
    hits: Option<OutputFile>,
    ops: Option<OutputFile>,
    graphs: Option<GraphFiles>,
    views: Views,
}

/// Makes the image.
pub fn image(args: &ImageArgs, typed: &Typed) -> Result<(), Failure> {
    let format = format(args)?;
    let engine = args.engine.engine()?;
    let options = args.options(typed);
    let base = args.config.as_deref().map(RunSpec::read).transpose()?;
    let run = PlannedRun::new(RunSpec::of_image(&options, base)?)?;
    check_files(args, &run.spec)?;
    moot::check_image(&options, &run.spec)?;
    let truth = args.against.as_deref().map(|path| truth(path, run.spec.size)).transpose()?;
    let mut files = open_outputs(args, &run.spec)?;
    let spinner = progress::waiting("preparing the scene");
    let layers = &mut Layers::default();
    let read = || outputs::reading(&named(args), || Setup::new(run, layers, &Cancel::default()));
    let (setup, inputs) = noting(read);
    let setup = setup?;
    spinner.finish_and_clear();
    notes(&setup);
    if args.check_rules {
        check_rules(args, &setup)?;
    }
    let mut found = Vec::new();
    let mut gathered = files.graphs.is_some().then(|| Gathered::new(&setup));
    let (rendered, losses) = match engine {
        None => render(args, &setup, &mut files, (&mut found, gathered.as_mut()))?,
        Some(engine) => match shards::image(&engine, args, &setup.spec, inputs)? {
            Some(rendered) => (rendered, None),
            None => return Ok(()),
        },
    };
    let timed = rendered.timing.as_ref().zip(files.graphs.as_ref()).zip(gathered.as_ref());
    let of_line = |((timing, files), gathered): ((&Timing, &GraphFiles), _)| {
        told::of_line(&setup, gathered, (&timing.stats, &timing.observed), files.asked())
    };
    let graphs = timed.map(of_line).transpose()?;
    print(&account::image_text(&setup, &rendered, losses.as_ref()))?;
    let pixels = image::on_screen(&rendered.pixels);
    if let (Some(truth), Some(path)) = (truth, &args.against) {
        print(&account::difference_line(&ColorError::between(pixels.iter().copied(), &truth), path))?;
    }
    if let Format::Indexed(most, palette) = format {
        print(&account::colors_line(&ColorTable::new(&pixels, most, palette), palette, &pixels))?;
    }
    let made = (&rendered, losses.as_ref());
    let traced = (&found[..], graphs);
    let written = write_outputs((format, args.show_rectangles), &setup, made, traced, files)?;
    print(&outputs::list(&written))
}

/// Holds the image's rays against themselves without rules, and fails if anything differs.
fn check_rules(args: &ImageArgs, setup: &Setup) -> Result<(), Failure> {
    let bar = progress::samples();
    let checked = run::check_rules(&setup.picture(), &workers(args.tracing.threads), |seen| {
        if let Seen::Samples { done, of, .. } = seen {
            bar.set_length(*of as u64);
            bar.set_position(*done as u64);
        }
        Ok::<_, Infallible>(())
    });
    bar.finish_and_clear();
    let rays = checked?.map_err(|broken| Failure::Output(broken.to_string()))?;
    let rules = setup.image().rules;
    print(&format!("rules {rules}: all {} hit as they do without, to the bit\n\n", plural(rays as u64, "ray")))
}

/// The pixels that the image is held against, as a screen has them.
fn truth(path: &Path, size: ImageSize) -> Result<Vec<Color>, InputError> {
    let (found, pixels) = image::read_pfm(path)?;
    if found != size {
        let (found, size) = (String::from(found), String::from(size));
        return Err(
            InputError::in_file(path, format!("is {found}, and the image {size}")).help("make both of one size")
        );
    }
    Ok(image::on_screen(&pixels))
}

/// What the image is written as, by its name and by the colours that are asked for.
fn format(args: &ImageArgs) -> Result<Format, InputError> {
    match (Format::of(&args.output), args.colors) {
        (Some(Format::Png), Some(most)) if !args.engine.detach => Ok(Format::Indexed(most as usize, args.palette)),
        (Some(Format::Pfm), Some(_)) => {
            Err(InputError::new("--colors makes a table of colours, and PFM has none")
                .help("leave it out, or write a PNG"))
        }
        (Some(_), Some(_)) if args.engine.detach => {
            Err(InputError::new("--colors needs the whole image, and with --detach it is joined later")
                .help("leave out one of the two"))
        }
        (Some(format), _) => Ok(format),
        (None, _) => Err(InputError::in_file(&args.output, "is no name of an image").help(IMAGES_END)),
    }
}

impl Format {
    /// What an image of that name is written as.
    pub fn of(name: &Path) -> Option<Format> {
        match name.extension()?.to_string_lossy().to_lowercase().as_str() {
            "png" => Some(Format::Png),
            "pfm" => Some(Format::Pfm),
            _ => None,
        }
    }
}

/// Writes an image, if there is a file for it.
pub fn write_image(
    file: Option<OutputFile>,
    format: Format,
    size: ImageSize,
    pixels: &[Vec3],
    written: &mut Vec<PathBuf>,
) -> Result<(), Failure> {
    outputs::finish(file, written, |file| match format {
        Format::Png => image::write_png(file, size, pixels).map_err(|error| error.to_string()),
        Format::Indexed(most, palette) => {
            let table = ColorTable::new(&image::on_screen(pixels), most, palette);
            image::write_indexed_png(file, size, &table).map_err(|error| error.to_string())
        }
        Format::Pfm => image::write_pfm(file, size, pixels).map_err(|error| error.to_string()),
    })
}

/// Refuses results of the machine without a machine.
fn check_files(args: &ImageArgs, spec: &RunSpec) -> Result<(), InputError> {
    let files = [
        ("--stats", args.results.stats.is_some()),
        ("--hits", args.tracing.hits.is_some()),
        ("--ops", args.tracing.ops.is_some()),
        ("--graphs", args.graph.graphs.is_some()),
        ("--plot", args.views.plot.is_some()),
        ("--page", args.views.page.is_some()),
        ("--trace", args.views.trace.is_some()),
        ("--why", args.views.why),
        ("--enough", args.views.enough),
    ];
    let image = spec.image.clone().unwrap_or_default();
    if args.check_rules && image.rules == Rules::default() {
        let error = InputError::new("--check-rules has no rules to check");
        return Err(error.help("leave it out, or ask for --rules"));
    }
    let whole = [
        ("--check-rules", args.check_rules),
        ("--refined", args.refined.is_some()),
        ("--against", args.against.is_some()),
        ("--show-rectangles", args.show_rectangles),
    ];
    if let Some((flag, _)) = whole.into_iter().find(|(_, typed)| *typed && args.engine.detach) {
        let error = InputError::new(format!("{flag} needs the whole image, and with --detach it is joined later"));
        return Err(error.help("leave out one of the two"));
    }
    if args.refined.is_some() && !image.adaptive {
        let error = InputError::new("--refined is about adaptive sampling, and all pixels have the same samples");
        return Err(error.help("leave it out, or ask for --adaptive"));
    }
    if args.show_rectangles && spec.screen_rectangles == ScreenRectangles::Off {
        let error = InputError::new("--show-rectangles has none to show");
        return Err(error.help("leave it out, or ask for --screen-rectangles"));
    }
    outputs::check_hits(args.tracing.hits.as_deref(), image.rules)?;
    let untimed = image.timing == Switch::Off;
    match files.iter().find(|(_, typed)| *typed && untimed) {
        Some((flag, _)) => {
            Err(InputError::new(format!("{flag} {}", moot::WITHOUT_TIMING)).help("leave out one of the two"))
        }
        None => Ok(()),
    }
}

/// The results that are asked for.
fn named(args: &ImageArgs) -> [Option<&PathBuf>; 7] {
    [
        Some(&args.output),
        args.refined.as_ref(),
        args.results.stats.as_ref(),
        args.tracing.hits.as_ref(),
        args.tracing.ops.as_ref(),
        args.views.page.as_ref(),
        args.views.trace.as_ref(),
    ]
}

fn open_outputs(args: &ImageArgs, spec: &RunSpec) -> Result<Outputs, InputError> {
    let (stats, hits, ops) = (args.results.stats.as_ref(), args.tracing.hits.as_ref(), args.tracing.ops.as_ref());
    let inputs = [
        Some(Path::new(&spec.scene)),
        args.program.program.as_deref(),
        args.machine_file.machine.as_deref(),
        args.config.as_deref(),
        args.against.as_deref(),
    ];
    outputs::check_distinct(&named(args), &inputs)?;
    outputs::check_png(args.refined.as_deref())?;
    graphs::check(&args.graph, spec.size)?;
    let open = |path: Option<&PathBuf>| outputs::open(path.map(PathBuf::as_path), args.results.force);
    Ok(Outputs {
        image: open(Some(&args.output))?,
        refined: open(args.refined.as_ref())?,
        stats: open(stats)?,
        hits: open(hits)?,
        ops: open(ops)?,
        graphs: GraphFiles::open(&args.graph, args.results.force)?,
        views: Views::open(&args.views, args.results.force)?,
    })
}

fn render(
    args: &ImageArgs,
    setup: &Setup,
    files: &mut Outputs,
    (found, mut gathered): (&mut Vec<Hit>, Option<&mut Gathered>),
) -> Result<(Rendered, Option<Losses>), Failure> {
    let (picture, image) = (setup.picture(), setup.image());
    let (cells, costs) = (setup.workload.cells(), setup.workload.costs());
    let timed = (image.timing == Switch::On).then(|| Timed {
        spec: &setup.machine.spec,
        rules: image.host_rules(setup.spec.order),
        watching: graphs::watching(files.graphs.as_ref(), files.views.watching(Shape::Line)),
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
            array.into_iter().for_each(|array| live.show(|| array.so_far()));
            Ok(())
        }
        Seen::Grown(trees, pixels) => {
            gathered.iter_mut().for_each(|gathered| gathered.take_trees(trees, pixels));
            Ok(())
        }
        Seen::Sent(ops, hit, ray) => {
            gathered.iter_mut().for_each(|gathered| gathered.take_sent(ray));
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

fn write_outputs(
    (format, shows_rectangles): (Format, bool),
    setup: &Setup,
    (rendered, losses): (&Rendered, Option<&Losses>),
    (found, graphs): (&[Hit], Option<Graphs>),
    files: Outputs,
) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let (size, pixels) = (setup.spec.size, &rendered.pixels);
    if shows_rectangles {
        let polygons = setup.workload.polygons();
        let rectangles = screen::rectangles(&setup.scene, polygons, size, setup.spec.screen_rectangles);
        write_image(files.image, format, size, &image::outlined(pixels, size, &rectangles), &mut written)?;
    } else {
        write_image(files.image, format, size, pixels, &mut written)?;
    }
    outputs::finish(files.refined, &mut written, |file| image::write_mask(file, size, &rendered.refined))?;
    if let Some(timing) = &rendered.timing {
        let configuration = Configuration::new(setup);
        outputs::finish(files.stats, &mut written, |file| {
            file.write_all(account::image_stats_json(setup, rendered, timing, losses)?.as_bytes())
        })?;
        if let (Some(files), Some(graphs)) = (files.graphs, graphs) {
            files.write(&graphs, &mut written)?;
        }
        let spec = &setup.machine.spec;
        let mut png = Vec::new();
        if files.views.show_image() {
            image::write_png(&mut png, size, pixels)
                .map_err(|error| Failure::Output(format!("the picture cannot be made: {error}")))?;
        }
        let seen = views::Seen {
            caption: &account::caption(account::image_title(setup, rendered), setup),
            clock: spec.clock(),
            stats: &timing.stats,
            losses,
            observed: &timing.observed,
            cell_names: &cell_names(&setup.workload),
            configuration: &configuration,
            image: Some(&png),
            regions: None,
            setup: Some(setup),
        };
        files.views.write(&seen, &mut written)?;
    }
    outputs::finish(files.hits, &mut written, |file| hits::write(file, setup.workload.polygons(), found))?;
    outputs::finish(files.ops, &mut written, |_| Ok::<(), std::io::Error>(()))?;
    Ok(written)
}
