//! `pcs-sim sweep SWEEP.ron`: many runs, and one table of them.

mod latest;
mod plots;

use std::path::{Path, PathBuf};

use pcs_sim::run::Workers;
use pcs_sim::sweep::{Record, Sweep};

use super::args::SweepArgs;
use super::{Failure, outputs, print, progress};
use latest::Latest;
use plots::Plots;

/// Runs the points that are not done yet; the table grows as they finish.
pub fn sweep(args: &SweepArgs) -> Result<(), Failure> {
    let sweep = Sweep::read(&args.sweep)?;
    let table = ["csv", "parquet", "journal"].map(|ending| args.table.with_extension(ending));
    let inputs = sweep.files().iter().map(|file| Some(file.path.as_path()));
    let inputs: Vec<Option<&Path>> = inputs.chain([Some(args.sweep.as_path())]).collect();
    outputs::check_distinct(&table.each_ref().map(Some), &inputs)?;
    let plots = Plots::open(args, &sweep.columns())?;
    let mut record = Record::open(&sweep, &sweep.columns(), &args.table, args.force)?;
    let todo = sweep.points() - record.done();
    let bar = progress::points(sweep.points() as u64);
    bar.set_position(record.done() as u64);
    bar.reset_eta();
    let mut latest = Latest::new(&sweep, &bar, args.watch);
    let ended = record.run(&sweep, &Workers::on_all_cores(), |row| {
        latest.add(row);
        bar.inc(1);
    });
    ended.map_err(|unrecorded| Failure::Output(unrecorded.to_string()))?;
    bar.finish_and_clear();
    let mut written: Vec<PathBuf> = record.table_paths().map(PathBuf::from).into();
    plots.write(&sweep, &record.table(), &mut written)?;
    print(&format!("{} points, {} of them done now\n{}", sweep.points(), todo, outputs::list(&written)))
}
