//! `pcs-sim farm SCENE`: a master and workers that share an image, on CAPITAN.

use std::convert::Infallible;
use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::machine::Capitan;
use pcs_sim::measure::Shape;
use pcs_sim::report::farm as told;
use pcs_sim::report::stats::Configuration;
use pcs_sim::run::{FarmOutcome, FarmSetup, FarmSpec, OutputFile, moot};

use super::args::Typed;
use super::farm_args::FarmArgs;
use super::run::workers;
use super::views::{Seen, Views};
use super::{Failure, outputs, print, progress};

/// `pcs-sim farm SCENE [...]`
pub fn farm(args: &FarmArgs, typed: &Typed) -> Result<(), Failure> {
    let options = args.options(typed);
    let spec = FarmSpec::new(&options, args.config.as_deref().map(FarmSpec::read).transpose()?)?;
    moot::check_farm(&options, &spec)?;
    let fewest = options.farm.tasks.map_or(spec.tasks, |range| range.first);
    let (stats, views) = open_outputs(args, &spec, fewest)?;
    let bar = progress::samples();
    bar.set_length(spec.samples() as u64);
    let setup = outputs::reading(&named(args), || {
        let setup = FarmSetup::new(spec, &workers(args.threads), |done| {
            bar.set_position(done as u64);
            Ok::<_, Infallible>(())
        });
        setup.map_err(Failure::from)
    })?;
    bar.finish_and_clear();
    setup.notes().for_each(super::note);
    if fewest < setup.spec.tasks {
        return print(&compared(&setup, fewest)?);
    }
    let outcome = run(&setup, setup.spec.tasks, &views)?;
    print(&told::text(&setup, &outcome))?;
    let written = write_outputs(&setup, &outcome, stats, views)?;
    print(&outputs::list(&written))
}

/// The result files that are asked for.
fn named(args: &FarmArgs) -> [Option<&PathBuf>; 3] {
    [args.stats.as_ref(), args.views.page.as_ref(), args.views.trace.as_ref()]
}

fn open_outputs(args: &FarmArgs, spec: &FarmSpec, fewest: usize) -> Result<(Option<OutputFile>, Views), InputError> {
    let asked = named(args).iter().any(Option::is_some) || args.views.plot.is_some() || args.views.why;
    if fewest < spec.tasks && asked {
        let error = InputError::new("statistics and views are of one number of workers, not of a range");
        return Err(error.help("ask for one number of --tasks; `pcs-sim sweep` makes tables of many"));
    }
    if args.views.enough {
        let error = InputError::new("--enough is about cells in a row, and the depths of their FIFOs");
        return Err(error.help("leave it out"));
    }
    let inputs = [Some(Path::new(&spec.scene)), args.farm.machine.as_deref(), args.config.as_deref()];
    outputs::check_distinct(&named(args), &inputs)?;
    Ok((outputs::open(args.stats.as_deref(), args.force)?, Views::open(&args.views, args.force)?))
}

fn run(setup: &FarmSetup, tasks: usize, views: &Views) -> Result<FarmOutcome, Failure> {
    let spinner = progress::waiting("running the tasks");
    let outcome = setup.run(tasks, &views.watching(Shape::Farm), &Cancel::default());
    spinner.finish_and_clear();
    Ok(outcome?)
}

/// A row for each number of workers, and what limits most of them.
fn compared(setup: &FarmSetup, fewest: usize) -> Result<String, Failure> {
    let outcomes = (fewest..=setup.spec.tasks).map(|tasks| run(setup, tasks, &Views::none()));
    Ok(told::compared(setup, &outcomes.collect::<Result<Vec<_>, _>>()?))
}

fn write_outputs(
    setup: &FarmSetup,
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
        caption: &told::caption(setup, outcome),
        clock: Capitan::CLOCK,
        stats: &outcome.stats,
        observed: &outcome.observed,
        cell_names: &[],
        losses: None,
        configuration: &configuration,
        image: None,
        regions: None,
        setup: None,
    };
    views.write(&seen, &mut written)?;
    Ok(written)
}
