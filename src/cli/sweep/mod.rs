//! `pcs-sim sweep SWEEP.ron`: many runs, and one table of them.

mod latest;
mod plots;
mod point;

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use clap::Parser;
use pcs_sim::report::table::Column;
use pcs_sim::sweep::{Record, Sweep};
use rayon::prelude::*;

use super::args::{Cli, RunArgs, SweepArgs};
use super::{Failure, outputs, print, progress};
use latest::Latest;
use plots::Plots;
use point::{Outcome, Recording, Setting, Stage};

/// Runs the points that are not done yet; the table grows as they finish.
pub fn sweep(args: &SweepArgs) -> Result<(), Failure> {
    let sweep = Sweep::read(&args.sweep)?;
    let plots = Plots::open(args, &columns(&sweep))?;
    let mut record = Record::open(&sweep, &columns(&sweep), &args.table, args.force)?;
    let failed = |error: std::io::Error| Failure::Output(format!("the table cannot be written: {error}"));
    let todo: Vec<usize> = (0..sweep.points()).filter(|&index| !record.has(index)).collect();
    let bar = progress::points(sweep.points() as u64);
    bar.set_position((sweep.points() - todo.len()) as u64);
    bar.reset_eta();
    let latest = Latest::new(&sweep, &bar, args.watch);
    let state = Mutex::new((&mut record, latest, Ok(())));
    run_all(&sweep, &todo, |index, result| {
        let row = [sweep.point(index), point::results(result)].concat();
        let mut guard = state.lock().unwrap_or_else(PoisonError::into_inner);
        let (record, latest, written) = &mut *guard;
        latest.add(&row);
        if written.is_ok() {
            *written = record.enter(index, row);
        }
        bar.inc(1);
    });
    let (_, _, written) = state.into_inner().unwrap_or_else(PoisonError::into_inner);
    written.and_then(|()| record.write_table()).map_err(failed)?;
    bar.finish_and_clear();
    let mut written: Vec<PathBuf> = record.table_paths().map(PathBuf::from).into();
    plots.write(&sweep, &record.table(), &mut written)?;
    print(&format!("{} points, {} of them done now\n{}", sweep.points(), todo.len(), outputs::list(&written)))
}

/// The columns of the table: the parameters, then the results.
fn columns(sweep: &Sweep) -> Vec<Column<'static>> {
    sweep.parameters.iter().map(|parameter| parameter.column).chain(point::COLUMNS).collect()
}

/// What is to be run for a point, or why it cannot be.
fn setting(sweep: &Sweep, index: usize) -> Result<Setting, String> {
    let flag = |(name, value): (&str, String)| match (name, value.as_str()) {
        ("mailbox", "true") => Some("--mailbox".to_owned()),
        ("mailbox", "false") => None,
        _ => Some(format!("--{}={value}", name.replace('_', "-"))),
    };
    let names = sweep.parameters.iter().map(|parameter| parameter.column.name);
    Setting::new(parse(names.zip(sweep.point(index)).filter_map(flag))?)
}

fn parse(flags: impl Iterator<Item = String>) -> Result<RunArgs, String> {
    let cli = Cli::try_parse_from(std::iter::once("pcs-sim".to_owned()).chain(flags));
    cli.map(|cli| cli.run).map_err(|error| {
        let text = error.to_string();
        text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
    })
}

/// Runs the points: those of a scene one after the other, and among them those that do the same work, so that a scene is
/// built once, and what its cells do is worked out once.
fn run_all(sweep: &Sweep, todo: &[usize], done: impl Fn(usize, Result<Outcome, String>) + Sync) {
    let settings: Vec<Result<Setting, String>> = todo.par_iter().map(|&index| setting(sweep, index)).collect();
    let mut possible = Vec::new();
    for (&index, setting) in todo.iter().zip(settings) {
        match setting {
            Ok(setting) => possible.push((index, setting)),
            Err(reason) => done(index, Err(reason)),
        }
    }
    let all = possible.iter().collect();
    for same_stage in by_key(all, Setting::stage_key) {
        let stage = same_stage[0].1.stage();
        for same_work in by_key(same_stage, Setting::work_key) {
            match &stage {
                Ok(stage) => run_same_work(stage, &same_work, &done),
                Err(reason) => same_work.iter().for_each(|point| done(point.0, Err(reason.clone()))),
            }
        }
    }
}

/// A point's number and what is to be run for it.
type Point = (usize, Setting);

fn run_same_work(stage: &Stage, points: &[&Point], done: &(impl Fn(usize, Result<Outcome, String>) + Sync)) {
    match (points[0].1.workload(stage), points) {
        (Err(reason), _) => points.iter().for_each(|(index, _)| done(*index, Err(reason.clone()))),
        (Ok(workload), [(index, setting)]) => done(*index, setting.run(&workload, stage.rays())),
        (Ok(workload), _) => {
            let recording = Recording::new(&workload, stage.rays());
            let time = |setting| recording.as_ref().map_err(String::clone)?.time(setting);
            points.par_iter().for_each(|(index, setting)| done(*index, time(setting)));
        }
    }
}

/// Puts points with the same key together, in the order in which the keys come first.
fn by_key(points: Vec<&Point>, key: impl Fn(&Setting) -> String) -> Vec<Vec<&Point>> {
    let mut places = HashMap::new();
    let mut groups: Vec<Vec<&Point>> = Vec::new();
    for point in points {
        let place = *places.entry(key(&point.1)).or_insert(groups.len());
        if place == groups.len() {
            groups.push(Vec::new());
        }
        groups[place].push(point);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Only what changes the ops is worked out again: no depth, rate, latency or memory.
    #[test]
    fn points_that_only_the_machine_tells_apart_share_their_ops() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("sweep.ron");
        let text = r#"(scene: ["room", "teapot"], mode: ["pipeline", "broadcast"], fifo_words: [4, 8], clock_ns: [50, 100],
            link_mb_s: [80, 40], latency_cycles: [1, 2], memory_words: [1000, 2000], rate_counts: ["link", "channel"])"#;
        std::fs::write(&file, text).unwrap();
        let sweep = Sweep::read(&file).unwrap();
        let points: Vec<Point> = (0..sweep.points()).map(|index| (index, setting(&sweep, index).unwrap())).collect();
        let stages = by_key(points.iter().collect(), Setting::stage_key);
        assert_eq!(stages.iter().map(Vec::len).collect::<Vec<_>>(), [128, 128]);
        let works = by_key(stages.into_iter().next().unwrap(), Setting::work_key);
        assert_eq!(works.iter().map(Vec::len).collect::<Vec<_>>(), [64; 2], "two modes");
        assert_eq!(works[0][0].0, 0);
    }
}
