//! `pcs-sim sweep SWEEP.ron`: many runs, and one table of them.

mod latest;
mod plots;

use std::path::{Path, PathBuf};

use pcs_sim::report::account::plural;
use pcs_sim::sweep::{Note, Record, Sweep};

use super::args::SweepArgs;
use super::run::workers;
use super::{Failure, note, outputs, print, progress};
use latest::Latest;
use plots::Plots;

/// Kinds of failures and of roundings that are told; the table has the others.
const TOLD: usize = 5;

/// Runs the points that are not done yet; the table grows as they finish.
pub fn sweep(args: &SweepArgs) -> Result<(), Failure> {
    let sweep = Sweep::read(&args.sweep)?;
    match &args.table {
        Some(table) => run(args, &sweep, table),
        None => print(&format!("{}\n", points(sweep.points()))),
    }
}

fn run(args: &SweepArgs, sweep: &Sweep, table: &Path) -> Result<(), Failure> {
    let results = ["csv", "parquet", "sweep.ron", "journal"].map(|ending| table.with_extension(ending));
    let inputs: Vec<Option<&Path>> = sweep.files().chain([args.sweep.as_path()]).map(Some).collect();
    outputs::check_distinct(&results.each_ref().map(Some), &inputs)?;
    let plots = Plots::open(args, table, &sweep.columns())?;
    let mut record = Record::open(sweep, table, args.force)?;
    let before = record.done();
    let bar = progress::points(sweep.points() as u64);
    bar.set_position(before as u64);
    bar.reset_eta();
    let mut latest = Latest::new(sweep, &bar, args.watch);
    let ended = record.run(sweep, &workers(args.threads), |row| {
        latest.add(row);
        bar.inc(1);
    });
    let notes = ended.map_err(|unrecorded| Failure::Output(unrecorded.to_string()))?;
    bar.finish_and_clear();
    tell(&notes);
    let mut written: Vec<PathBuf> = record.table_paths().map(PathBuf::from).into();
    plots.write(&record.table(), &mut written)?;
    print(&format!("{}{}", account(&record, before), outputs::list(&written)))?;
    match record.failures().count() {
        failed if failed > 0 && !args.accept_failures => {
            let share = format!("{failed} of {} failed", points(sweep.points()));
            let help = "the column `error` says why; --accept-failures takes such a table for a success";
            Err(Failure::Output(format!("{share}: {help}")))
        }
        _ => Ok(()),
    }
}

/// What had to be rounded.
fn tell(notes: &[Note]) {
    for Note { text, points: count } in notes.iter().take(TOLD) {
        note(format!("{text} (in {})", points(*count)));
    }
    if notes.len() > TOLD {
        let others = notes.len() - TOLD;
        note(format!("so were {others} other values; the table has what was simulated beside what was asked for"));
    }
}

/// How many points are done and how many failed, with the first reasons.
fn account(record: &Record, before: usize) -> String {
    let (all, failed) = (record.done(), record.failures().count());
    let mut text = format!("{}: {} done", points(all), all - failed);
    if failed > 0 {
        text += &format!(", {failed} failed");
    }
    if before > 0 {
        text += &format!(" ({} now)", all - before);
    }
    text += "\n";
    let mut reasons: Vec<(&str, usize)> = Vec::new();
    for reason in record.failures() {
        match reasons.iter().position(|(known, _)| *known == reason) {
            Some(place) => reasons[place].1 += 1,
            None if reasons.len() < TOLD => reasons.push((reason, 1)),
            None => {}
        }
    }
    for (reason, count) in &reasons {
        text += &format!("  {count} failed: {reason}\n");
    }
    match failed - reasons.iter().map(|(_, count)| count).sum::<usize>() {
        0 => text,
        others => text + &format!("  {others} failed for other reasons\n"),
    }
}

/// `1 point`, `2 points`.
fn points(count: usize) -> String {
    plural(count, "point")
}
