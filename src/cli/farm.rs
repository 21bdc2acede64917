//! `pcs-sim farm SCENE`: a master and workers that share an image, on CAPITAN.

use std::convert::Infallible;
use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::machine::{Capitan, CapitanFile};
use pcs_sim::program::farm::{HandOut, Items, SceneBy};
use pcs_sim::report::plot::Caption;
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::summary::{self, grouped};
use pcs_sim::report::{bottleneck, farm as told};
use pcs_sim::run::{FarmOutcome, FarmScene, FarmSpec, OutputFile};

use super::args::{FarmArgs, Typed};
use super::run::{plural, workers};
use super::views::{Seen, Views};
use super::{Failure, moot_flags, outputs, print, progress};

/// What a farm is made of, whatever the number of its workers.
struct Setup {
    spec: FarmSpec,
    machine: Capitan,
    scene: FarmScene,
    items: Items,
}

/// `pcs-sim farm SCENE [...]`
pub fn farm(args: &FarmArgs, typed: &Typed) -> Result<(), Failure> {
    let options = args.options(typed);
    let spec = FarmSpec::new(&options, args.config.as_deref().map(FarmSpec::read).transpose()?)?;
    moot_flags::check_farm(&options, &spec)?;
    let fewest = options.farm.tasks.map_or(spec.tasks, |range| range.first);
    let machine = spec.machine.build()?;
    let (stats, views) = open_outputs(args, &spec, fewest)?;
    let bar = progress::samples();
    let samples = spec.rays.as_ref().map_or(1, |rays| rays.samples as usize).pow(2);
    bar.set_length((spec.size.pixels() * samples) as u64);
    let scene = spec.lay_out(&workers(args.threads), |done| {
        bar.set_position(done as u64);
        Ok::<_, Infallible>(())
    })?;
    bar.finish_and_clear();
    let items = spec.cut(&scene, &machine)?;
    machine.notes.iter().chain(&scene.notes).for_each(|note| eprintln!("note: {note}"));
    let setup = Setup { spec, machine, scene, items };
    if fewest < setup.spec.tasks {
        return print(&compared(&setup, fewest)?);
    }
    let outcome = run(&setup, setup.spec.tasks, &views)?;
    print(&report(&setup, &outcome))?;
    let written = write_outputs(&setup, &outcome, stats, views)?;
    print(&outputs::list(&written))
}

fn open_outputs(args: &FarmArgs, spec: &FarmSpec, fewest: usize) -> Result<(Option<OutputFile>, Views), InputError> {
    let files = [args.stats.as_ref(), args.views.page.as_ref(), args.views.trace.as_ref(), args.views.plot.as_ref()];
    if fewest < spec.tasks && files.iter().any(Option::is_some) {
        let error = InputError::new("statistics and views are of one number of workers, not of a range");
        return Err(error.help("ask for one number of --tasks; `pcs-sim sweep` makes tables of many"));
    }
    if args.views.why {
        let error = InputError::new("--why is about cells in a row, whose times do not depend on who comes first");
        return Err(error.help("leave it out; the states of the tasks tell what they wait for"));
    }
    let inputs = [Some(Path::new(&spec.scene)), args.farm.machine.as_deref(), args.config.as_deref()];
    outputs::check_distinct(&files[..3], &inputs)?;
    Ok((outputs::open(args.stats.as_deref(), args.force)?, Views::open(&args.views, args.force)?))
}

fn run(setup: &Setup, tasks: usize, views: &Views) -> Result<FarmOutcome, Failure> {
    let Setup { spec, machine, scene, items } = setup;
    let spec = FarmSpec { tasks, ..spec.clone() };
    let spinner = progress::waiting("running the tasks");
    let outcome = spec.run((scene, machine, items), &views.watching(), &Cancel::default());
    spinner.finish_and_clear();
    Ok(outcome?)
}

/// A row for each number of workers, and what limits most of them.
fn compared(setup: &Setup, fewest: usize) -> Result<String, Failure> {
    let outcomes: Vec<FarmOutcome> =
        (fewest..=setup.spec.tasks).map(|tasks| run(setup, tasks, &Views::none())).collect::<Result<_, _>>()?;
    let last = outcomes.last().map_or(String::new(), |last| {
        format!("With {}: {}\n", plural(last.workers, "worker"), bottleneck::sentence(&last.stats))
    });
    let shares = shares(&setup.spec);
    let title = format!("farm of {fewest} to {} workers: {}", setup.spec.tasks, what(setup));
    Ok(format!("{title}\n{}\n{shares}\n\n{}\n{last}", machine_line(&setup.spec.machine), told::table(&outcomes)))
}

fn report(setup: &Setup, outcome: &FarmOutcome) -> String {
    let lines = [
        title(setup, outcome),
        machine_line(&setup.spec.machine),
        shares(&setup.spec),
        summary::speed(&outcome.stats, Capitan::CLOCK),
        told::gain(outcome),
        told::buses(outcome),
    ];
    let tasks = summary::cells(&outcome.stats, &[]);
    format!("{}\n\n{tasks}\n{}\n", lines.join("\n"), bottleneck::sentence(&outcome.stats))
}

/// What runs, in one line.
fn title(setup: &Setup, outcome: &FarmOutcome) -> String {
    format!("farm of {}: {}", plural(outcome.workers, "worker"), what(setup))
}

/// Scene, image and work items.
fn what(setup: &Setup) -> String {
    let Setup { spec, scene, items, .. } = setup;
    let polygons = scene.polygons.map_or(String::new(), |count| format!(" ({} polygons)", grouped(count as u64)));
    let (pixels, count) = (grouped(spec.size.pixels() as u64), grouped(items.len() as u64));
    format!("scene {}{polygons}, {pixels} pixels in {count} {}s", scene.name, items.noun)
}

/// The machine in one line.
fn machine_line(machine: &CapitanFile) -> String {
    format!(
        "machine: {} processors of {} kbyte, {} buses of {} Mbyte/s, {} ms a message",
        machine.processors, machine.memory_kbyte, machine.buses, machine.bus_mb_s, machine.message_ms,
    )
}

/// How scene and work are shared, in one line.
fn shares(spec: &FarmSpec) -> String {
    let scene = match spec.scene_by {
        SceneBy::Copies => "a copy for each task",
        SceneBy::Broadcast => "broadcast to all tasks",
    };
    let noun = spec.items.noun();
    let work = match spec.hand_out {
        HandOut::Request => format!("a {noun} for the worker that asks"),
        HandOut::Dealt => format!("{noun}s dealt beforehand"),
    };
    format!("shared out: the scene, {scene}; {work}")
}

fn write_outputs(
    setup: &Setup,
    outcome: &FarmOutcome,
    stats: Option<OutputFile>,
    views: Views,
) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let configuration = Configuration::Farm(Box::new(setup.spec.clone()));
    outputs::finish(stats, &mut written, |file| {
        file.write_all(told::to_json(outcome, &setup.scene, &configuration)?.as_bytes())
    })?;
    let seen = Seen {
        caption: &Caption { title: title(setup, outcome), machine: machine_line(&setup.spec.machine) },
        clock: Capitan::CLOCK,
        stats: &outcome.stats,
        observed: &outcome.observed,
        cell_names: &[],
        losses: None,
        configuration: &configuration,
        image: None,
    };
    views.write(&seen, &mut written)?;
    Ok(written)
}
