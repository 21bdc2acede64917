//! A page of two runs on one axis of time: both are done again as their configurations say, and watched.

use std::convert::Infallible;
use std::io::Write;
use std::path::Path;

use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::machine::Observed;
use pcs_sim::measure::{Clock, Measured};
use pcs_sim::quantities::Cycles;
use pcs_sim::report::account::{self, cell_names};
use pcs_sim::report::page::{self, Page};
use pcs_sim::report::plot::Caption;
use pcs_sim::report::stats::Configuration;
use pcs_sim::run::{
    self, Layers, OutputFile, PlannedRun, Replay, ReplaySpec, RunOptions, RunSpec, Setup, Timed, Watching, Workers,
};
use serde_json::Value;

use crate::cli::run::workers;
use crate::cli::{Failure, outputs, print, progress};

/// A run that was done again.
struct Again {
    caption: Caption,
    clock: Clock,
    stats: Measured,
    observed: Observed,
    cell_names: Vec<String>,
    configuration: Configuration,
}

/// Writes the page. `quiet`: standard output is a result's, and no place to tell of the file.
pub fn write(
    file: OutputFile,
    runs: [(&std::path::PathBuf, Value); 2],
    threads: Option<u16>,
    quiet: bool,
) -> Result<(), Failure> {
    let workers = workers(threads);
    let spinner = progress::waiting("running both again");
    let [a, b] = runs.map(|(path, stats)| again(path, stats, &workers));
    let (a, b) = (a?, b?);
    spinner.finish_and_clear();
    let end = [&a, &b].map(|run| run.clock.seconds(run.stats.cycles)).into_iter().fold(0.0, f64::max);
    let [a, b] = [a, b].map(|run| run.page(end));
    let unmade = |error: page::PageError| Failure::Output(error.to_string());
    let html = page::side_by_side(&a.map_err(unmade)?, &b.map_err(unmade)?).map_err(unmade)?;
    let mut written = Vec::new();
    outputs::finish(Some(file), &mut written, |file| file.write_all(html.as_bytes()))?;
    if quiet { Ok(()) } else { print(&outputs::list(&written)) }
}

/// Does a run again, of which there are statistics.
fn again(path: &Path, stats: Value, workers: &Workers) -> Result<Again, Failure> {
    let of_file =
        |error: InputError| InputError { place: error.place.or(InputError::in_file(path, "").place), ..error };
    let configuration = stats.get("configuration");
    let has = |field: &str| configuration.is_some_and(|configuration| configuration.get(field).is_some());
    if has("ops") {
        return replay(ReplaySpec::from_json(stats).map_err(of_file)?);
    }
    if has("tasks") {
        let error = InputError::in_file(path, "is of a farm, and the page shows arrays of cells");
        return Err(error.help("`pcs-sim farm --page` makes a page of each").into());
    }
    let setup = Setup::new(
        PlannedRun::new(RunSpec::from_json(stats).map_err(of_file)?)?,
        &mut Layers::default(),
        &workers.cancel,
    )?;
    if setup.spec.image.is_some() { image(&setup, workers) } else { rays(&setup, workers) }
}

fn watching() -> Watching {
    Watching { profile: true, ..Watching::default() }
}

fn rays(setup: &Setup, workers: &Workers) -> Result<Again, Failure> {
    let watched = (&setup.machine.spec, &watching());
    let outcome =
        run::run_watched(&setup.workload, watched, &setup.prepared.rays, workers, |_, _| Ok::<_, Infallible>(()))?;
    Ok(of_setup(setup, account::title(setup), outcome.stats, outcome.observed))
}

fn image(setup: &Setup, workers: &Workers) -> Result<Again, Failure> {
    let rules = setup.image().host_rules(setup.spec.order);
    let timed = Timed { spec: &setup.machine.spec, rules, watching: watching() };
    let mut rendered = run::render(&setup.picture(), Some(timed), workers, |_| Ok::<_, Infallible>(()))?;
    let title = account::image_title(setup, &rendered);
    let timing =
        rendered.timing.take().ok_or_else(|| InputError::new("an image without timing has no time to show"))?;
    Ok(of_setup(setup, title, timing.stats, timing.observed))
}

fn of_setup(setup: &Setup, title: String, stats: Measured, observed: Observed) -> Again {
    let spec = &setup.machine.spec;
    Again {
        caption: account::caption(title, setup),
        clock: spec.clock(),
        stats,
        observed,
        cell_names: cell_names(&setup.workload),
        configuration: Configuration::new(setup),
    }
}

fn replay(spec: ReplaySpec) -> Result<Again, Failure> {
    let mut replay = Replay::new(None, &RunOptions::default(), Some(&spec), None)?;
    let (stats, observed, _) = replay.time(&watching(), &Cancel::default(), |_| ())?;
    let spec = &replay.machine.spec;
    Ok(Again {
        caption: account::replay_caption(&replay),
        clock: spec.clock(),
        stats,
        observed,
        cell_names: Vec::new(),
        configuration: Configuration::Replay(Box::new(replay.spec.clone())),
    })
}

impl Again {
    /// Its page, with an axis of so many seconds.
    fn page(&self, seconds: f64) -> Result<String, page::PageError> {
        let cycles = Cycles((seconds / self.clock.seconds(Cycles(1))).round() as u64);
        let profile = self.observed.profile.as_ref().map(|profile| profile.extended(cycles));
        profile.map_or(Ok(String::new()), |profile| {
            page::html(&Page {
                caption: &self.caption,
                clock: self.clock,
                stats: &self.stats,
                losses: None,
                profile: &profile,
                // Rays on their way have a window of their own, and it is another in each run.
                recording: None,
                path: None,
                cell_names: &self.cell_names,
                configuration: &self.configuration,
                image: None,
                setup: None,
            })
        })
    }
}
