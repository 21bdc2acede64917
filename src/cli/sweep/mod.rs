//! `pcs-sim sweep SWEEP.ron`: many runs, and one table of them.

mod point;

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use clap::Parser;
use pcs_sim::error::InputError;
use pcs_sim::report::files::OutputFile;
use pcs_sim::sweep::{Journal, Sweep};
use rayon::prelude::*;

use super::args::{Cli, RunArgs, SweepArgs};
use super::{Failure, outputs, print, progress};
use point::{Recording, Scenes, Setting};

/// Runs the points that are not done yet, and writes the table once all are.
pub fn sweep(args: &SweepArgs) -> Result<(), Failure> {
    let sweep = Sweep::read(&args.sweep)?;
    drop(OutputFile::create(&args.table, args.force)?);
    let points: Vec<Result<RunArgs, String>> = sweep.points.iter().map(|point| flags(&sweep, point)).collect();
    let mut journal = open_journal(args, &sweep)?;
    let failed = |error: std::io::Error| Failure::Output(format!("the journal cannot be written: {error}"));
    let todo: Vec<usize> = (0..points.len()).filter(|&index| !journal.has(index)).collect();
    let bar = progress::points(points.len() as u64);
    bar.set_position((points.len() - todo.len()) as u64);
    let done = Mutex::new((&mut journal, Ok(())));
    run_all(&points, &todo, |index, result| {
        let row = [sweep.points[index].clone(), point::columns(result)].concat();
        let mut guard = done.lock().unwrap_or_else(PoisonError::into_inner);
        let (journal, state) = &mut *guard;
        if state.is_ok() {
            *state = journal.enter(index, row);
        }
        bar.inc(1);
    });
    let (_, state) = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    state.map_err(failed)?;
    bar.finish_and_clear();
    let mut written = Vec::new();
    let table = OutputFile::create(&args.table, args.force)?;
    outputs::finish(Some(table), &mut written, |file| write_table(file, &sweep, &journal))?;
    journal.remove().map_err(failed)?;
    print(&format!("{} points, {} of them done now\n{}", points.len(), todo.len(), outputs::list(&written)))
}

/// The flags that a point stands for.
fn flags(sweep: &Sweep, point: &[String]) -> Result<RunArgs, String> {
    let flag = |(name, value): (&&str, &String)| match (*name, value.as_str()) {
        ("mailbox", "true") => Some("--mailbox".to_owned()),
        ("mailbox", "false") => None,
        _ => Some(format!("--{}={value}", name.replace('_', "-"))),
    };
    let flags = sweep.names.iter().zip(point).filter_map(flag);
    let cli = Cli::try_parse_from(std::iter::once("pcs-sim".to_owned()).chain(flags));
    cli.map(|cli| cli.run).map_err(|error| {
        let text = error.to_string();
        text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
    })
}

fn open_journal(args: &SweepArgs, sweep: &Sweep) -> Result<Journal, InputError> {
    let mut path = args.table.clone().into_os_string();
    path.push(".journal");
    let heading = format!("{} {:?} {:?}", env!("CARGO_PKG_VERSION"), sweep.names, sweep.points);
    Journal::open(&PathBuf::from(path), &heading, sweep.points.len())
}

/// Runs the points: those that do the same work one after the other, so that its ops are worked out and held once.
fn run_all(
    points: &[Result<RunArgs, String>],
    todo: &[usize],
    done: impl Fn(usize, Result<point::Outcome, String>) + Sync,
) {
    let mut kinds: Vec<(Setting, Vec<usize>)> = Vec::new();
    for &index in todo {
        match points[index].as_ref().map_err(String::clone).and_then(Setting::new) {
            Err(reason) => done(index, Err(reason)),
            Ok(setting) => match kinds.iter_mut().find(|(other, _)| other.does_the_same_work(&setting)) {
                Some((_, same)) => same.push(index),
                None => kinds.push((setting, vec![index])),
            },
        }
    }
    let mut scenes = Scenes::default();
    for (setting, same) in &kinds {
        let recording = scenes.get(setting).and_then(|scene| Recording::new(setting, &scene));
        same.par_iter().for_each(|&index| {
            let setting = points[index].as_ref().map_err(String::clone).and_then(Setting::new);
            let recording = recording.as_ref().map_err(String::clone);
            done(index, setting.and_then(|setting| recording?.time(&setting)));
        });
    }
}

fn write_table(out: &mut OutputFile, sweep: &Sweep, journal: &Journal) -> csv::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(sweep.names.iter().chain(&point::COLUMNS))?;
    journal.rows().try_for_each(|row| table.write_record(row))?;
    Ok(table.flush()?)
}
