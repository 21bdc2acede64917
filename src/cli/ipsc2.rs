//! `pcs-sim ipsc2 SCENE`, or `pcs-sim image SCENE --on ipsc2`: an image on the nodes of a hypercube.

use std::ffi::OsString;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::host::image;
use pcs_sim::measure::Shape;
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::{
    cube as told,
    graphs::{Graphs, of_cube},
    hits,
};
use pcs_sim::run::{CubeOutcome, CubeRunOptions, CubeSetup, CubeSpec, OutputFile, SceneOptions, moot};

use super::args::Typed;
use super::graphs::{self, GraphFiles};
use super::image::{Format, IMAGES_END, write_image};
use super::ipsc2_args::Ipsc2Args;
use super::run::workers;
use super::views::{Seen, Views};
use super::watch::{Live, Watch};
use super::{Failure, outputs, print, progress};

/// The files that the command writes.
struct Outputs {
    image: Option<(OutputFile, Format)>,
    stats: Option<OutputFile>,
    hits: Option<OutputFile>,
    tasks: Option<OutputFile>,
    graphs: Option<GraphFiles>,
    views: Views,
}

/// `pcs-sim ipsc2 SCENE [...]`
pub fn ipsc2(args: &Ipsc2Args, typed: &Typed) -> Result<(), Failure> {
    let options = args.options(typed);
    let (setup, files) = match tasks(args) {
        Some(path) => recorded(args, path, options)?,
        None => traced(args, &options)?,
    };
    setup.notes().for_each(super::note);
    let watch = args.watch.then(|| Watch::new(setup.machine.clock, Vec::new()));
    let mut live = Live::new(progress::waiting("running the nodes"), watch);
    let watching = graphs::watching(files.graphs.as_ref(), files.views.watching(Shape::Cube));
    let outcome = setup.run_shown(&watching, &Cancel::default(), |so_far| live.show(so_far));
    live.finish();
    let outcome = outcome?;
    let graphs = files.graphs.as_ref().map(|files| of_cube(&setup, &outcome, files.asked())).transpose()?;
    print(&told::text(&setup, &outcome))?;
    let written = write_outputs(&setup, (&outcome, graphs), files)?;
    print(&outputs::list(&written))
}

/// The file of tasks that is named in place of a scene, if one is.
fn tasks(args: &Ipsc2Args) -> Option<&Path> {
    args.scene.as_deref().map(Path::new).filter(|path| path.extension().is_some_and(|extension| extension == "tasks"))
}

/// An image whose scene is traced.
fn traced(args: &Ipsc2Args, options: &CubeRunOptions) -> Result<(CubeSetup, Outputs), Failure> {
    let spec = CubeSpec::new(options, args.config.as_deref().map(CubeSpec::read).transpose()?)?;
    moot::check_cube(options, &spec)?;
    outputs::check_hits(args.hits.as_deref(), spec.rules)?;
    graphs::check(&args.graph, spec.size)?;
    let files = open_outputs(args, Path::new(&spec.scene))?;
    let bar = progress::samples();
    bar.set_length(spec.samples() as u64);
    let setup = outputs::reading(&named(args), || {
        let keeps_hits = args.hits.is_some() || args.graph.graphs.is_some();
        let setup = CubeSetup::new(spec, keeps_hits, &workers(args.threads), |done| {
            bar.set_position(done as u64);
            Ok::<_, std::convert::Infallible>(())
        });
        setup.map_err(Failure::from)
    })?;
    bar.finish_and_clear();
    Ok((setup, files))
}

/// An image whose tasks were recorded.
fn recorded(args: &Ipsc2Args, path: &Path, options: CubeRunOptions) -> Result<(CubeSetup, Outputs), Failure> {
    let of_image = [
        ("-o", args.output.is_some()),
        ("--hits", args.hits.is_some()),
        ("--graphs", args.graph.graphs.is_some()),
        ("--config", args.config.is_some()),
    ];
    if let Some((flag, _)) = of_image.iter().find(|(_, typed)| *typed) {
        let error = InputError::new(format!("{flag} is about tracing a scene, and recorded tasks go without"));
        return Err(error.help("leave it out, or name the scene").into());
    }
    let options = CubeRunOptions { scene: SceneOptions::default(), ..options };
    let files = open_outputs(args, path)?;
    let setup = outputs::reading(&named(args), || CubeSetup::of_tasks(path, &options))?;
    moot::check_cube(&options, &setup.spec)?;
    Ok((setup, files))
}

/// The result files that are asked for.
fn named(args: &Ipsc2Args) -> [Option<&PathBuf>; 6] {
    [
        args.output.as_ref(),
        args.stats.as_ref(),
        args.hits.as_ref(),
        args.tasks.as_ref(),
        args.views.page.as_ref(),
        args.views.trace.as_ref(),
    ]
}

fn open_outputs(args: &Ipsc2Args, scene: &Path) -> Result<Outputs, InputError> {
    if args.views.enough {
        let error = InputError::new("--enough is about cells in a row, and the depths of their FIFOs");
        return Err(error.help("leave it out; --flow and --queue-rays are about the queues of nodes"));
    }
    let inputs = [Some(scene), args.cube.machine.as_deref(), args.config.as_deref()];
    outputs::check_distinct(&named(args), &inputs)?;
    let image = |path: &PathBuf| {
        let wrong = || InputError::in_file(path, "is no name of an image").help(IMAGES_END);
        let format = Format::of(path).ok_or_else(wrong)?;
        Ok::<_, InputError>((outputs::create(path, args.force)?, format))
    };
    Ok(Outputs {
        image: args.output.as_ref().map(image).transpose()?,
        stats: outputs::open(args.stats.as_deref(), args.force)?,
        hits: outputs::open(args.hits.as_deref(), args.force)?,
        tasks: outputs::open(args.tasks.as_deref(), args.force)?,
        graphs: GraphFiles::open(&args.graph, args.force)?,
        views: Views::open(&args.views, args.force)?,
    })
}

fn write_outputs(
    setup: &CubeSetup,
    (outcome, graphs): (&CubeOutcome, Option<Graphs>),
    files: Outputs,
) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let (size, scene) = (setup.spec.size, &setup.scene);
    if let Some((file, format)) = files.image {
        write_image(Some(file), format, size, &scene.pixels, &mut written)?;
    }
    let configuration = Configuration::Cube(Box::new(setup.spec.clone()));
    outputs::finish(files.stats, &mut written, |file| {
        file.write_all(told::to_json(setup, outcome, &configuration)?.as_bytes())
    })?;
    if let Some(found) = &scene.found {
        outputs::finish(files.hits, &mut written, |file| hits::write(file, found.workload.polygons(), &found.hits))?;
    }
    if let (Some(files), Some(graphs)) = (files.graphs, graphs) {
        files.write(&graphs, &mut written)?;
    }
    outputs::finish(files.tasks, &mut written, |file| scene.write_tasks(&setup.spec, file))?;
    let mut png = Vec::new();
    let has_image = files.views.show_image() && !scene.pixels.is_empty();
    if has_image {
        let made = image::write_png(&mut png, size, &scene.pixels);
        made.map_err(|error| Failure::Output(format!("the picture cannot be made: {error}")))?;
    }
    let seen = Seen {
        caption: &told::caption(setup),
        clock: setup.machine.clock,
        stats: &outcome.stats,
        observed: &outcome.observed,
        cell_names: &[],
        losses: None,
        configuration: &configuration,
        image: has_image.then_some(&png),
        regions: told::region_map(setup, outcome),
        setup: None,
    };
    files.views.write(&seen, &mut written)?;
    Ok(written)
}

/// What was typed, with `--on ipsc2` as the command of that machine. Its nodes as a row of cells, which `--mode broadcast` asks for, are an
/// array like another.
pub fn spelled_out(mut typed: Vec<OsString>) -> Vec<OsString> {
    let is_array = |(_, mode): (Range<usize>, String)| matches!(mode.as_str(), "broadcast" | "pipeline" | "hybrid");
    let Some((place, _)) = flag(&typed, "on").filter(|(_, machine)| machine == "ipsc2") else { return typed };
    if flag(&typed, "mode").is_some_and(is_array) {
        return typed;
    }
    let command = match typed.get(1).and_then(|word| word.to_str()) {
        Some("calibrate") => "calibrate-ipsc2",
        Some("image") => "ipsc2",
        Some("model") => "model-ipsc2",
        // What was recorded of an array has ops, and is timed on a row of nodes.
        Some("replay") if typed.iter().any(|word| word.to_string_lossy().ends_with(".tasks")) => "ipsc2",
        Some(word) if word.starts_with('-') => {
            typed.drain(place);
            // A run without a command names its scene by a flag.
            if let Some((place, scene)) = flag(&typed, "scene") {
                typed.splice(place, [OsString::from(scene)]);
            }
            typed.insert(1, "ipsc2".into());
            return typed;
        }
        _ => return typed,
    };
    typed[1] = command.into();
    typed.drain(place);
    typed
}

/// Where a flag is typed, and its value.
fn flag(typed: &[OsString], name: &str) -> Option<(Range<usize>, String)> {
    let flag = format!("--{name}");
    typed.iter().enumerate().find_map(|(at, word)| {
        let rest = word.to_str()?.strip_prefix(&flag)?;
        match rest.strip_prefix('=') {
            Some(value) => Some((at..at + 1, value.to_owned())),
            None if rest.is_empty() => Some((at..at + 2, typed.get(at + 1)?.to_str()?.to_owned())),
            None => None,
        }
    })
}
