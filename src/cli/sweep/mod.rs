//! `pcs-sim sweep SWEEP.ron`: many runs, and one table of them.

mod latest;
mod plots;

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use pcs_sim::report::table::Column;
use pcs_sim::run::Workers;
use pcs_sim::sweep::{Record, Sweep};

use super::args::SweepArgs;
use super::{Failure, outputs, print, progress};
use latest::Latest;
use plots::Plots;

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
    let ended = sweep.run(&todo, &Workers::on_all_cores(), |index, results| {
        let row = [sweep.point(index), results].concat();
        let mut guard = state.lock().unwrap_or_else(PoisonError::into_inner);
        let (record, latest, written) = &mut *guard;
        latest.add(&row);
        if written.is_ok() {
            *written = record.enter(index, row);
        }
        bar.inc(1);
    });
    let (_, _, written) = state.into_inner().unwrap_or_else(PoisonError::into_inner);
    ended.map_err(|cancelled| Failure::Output(cancelled.to_string()))?;
    written.and_then(|()| record.write_table()).map_err(failed)?;
    bar.finish_and_clear();
    let mut written: Vec<PathBuf> = record.table_paths().map(PathBuf::from).into();
    plots.write(&sweep, &record.table(), &mut written)?;
    print(&format!("{} points, {} of them done now\n{}", sweep.points(), todo.len(), outputs::list(&written)))
}

/// The columns of the table: the parameters, then the results.
fn columns(sweep: &Sweep) -> Vec<Column<'static>> {
    sweep.parameters.iter().map(|parameter| parameter.column).chain(sweep.results().iter().copied()).collect()
}
