//! What is known of a sweep, in files: the table in two formats, which grows as points finish, and the journal.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::journal::{Heading, Journal};
use super::{Account, Sweep};
use crate::cancel::Cancelled;
use crate::error::InputError;
use crate::report::table::{self, Column, Table};
use crate::run::{RecordingMemory, Workers};

/// The table of a sweep under way, and its files.
///
/// - A point that has been entered is never lost or repeated, whenever the process is killed.
/// - The table's files are always whole: rows of the points that are done, in the order of the points. They are brought
///   up to date some times a second, and at the end.
/// - As long as a record is open, no other process can open it.
#[derive(Debug)]
pub struct Record {
    places: Places,
    columns: Vec<Column<'static>>,
    /// The rows of the points that are done, with their numbers, in the order of the points.
    rows: BTreeMap<usize, Vec<String>>,
    /// The sweep as a file says it.
    sweep: String,
    journal: Journal,
    /// When the table may be written next: writing it takes a small share of the time, however long it is.
    due: Instant,
}

/// Where the files are: one name with an ending each.
#[derive(Debug)]
struct Places {
    csv: PathBuf,
    parquet: PathBuf,
    /// What the table is of, for CSV, in which it cannot be told.
    sweep: PathBuf,
    journal: PathBuf,
}

/// Why the points of a sweep are not all in its record.
#[derive(Debug, thiserror::Error)]
pub enum Unrecorded {
    /// It was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A file could not be written.
    #[error("the table cannot be written: {0}")]
    Unwritten(#[from] std::io::Error),
}

/// The table is written no more often.
const SHORTEST_PAUSE: Duration = Duration::from_millis(250);
/// What must pass before the table is written again, as a multiple of the time that it took.
const PAUSE_FACTOR: u32 = 20;

impl Record {
    /// Opens the record of a sweep, or starts one. `path` names the table, as `.csv` or `.parquet`.
    ///
    /// Points that failed are to be run again.
    ///
    /// Fails if there are such files of something else and `force` was not asked for, and if another process has it open.
    pub fn open(sweep: &Sweep, path: &Path, force: bool) -> Result<Record, InputError> {
        let places = Places::new(path)?;
        let begun = std::fs::metadata(&places.journal).is_ok_and(|journal| journal.len() > 0);
        if !force && !begun {
            places.check_free()?;
        }
        let results = sweep.results();
        let names: Vec<&str> = results.iter().map(|column| column.name).collect();
        let kind = format!("{} {}", env!("CARGO_PKG_VERSION"), names.join(" "));
        let points = (0..sweep.points()).into_par_iter().map(|index| sweep.identity(index)).collect();
        let journal = Journal::open(&places.journal, Heading { kind, points, cells: results.len() }, force)?;
        let row = |(index, results): (usize, &[String])| (index, [&sweep.point(index), results].concat());
        let rows = journal.results().map(row).collect();
        Ok(Record { places, columns: sweep.columns(), rows, sweep: sweep.text(), journal, due: Instant::now() })
    }

    /// Runs the points that are not done, and enters each as it is; `seen` is told of its row. The table's files are up to
    /// date in the end. Returns what is to be said of the points that were run.
    ///
    /// # Errors
    ///
    /// If it is told to stop, and if a file cannot be written.
    pub fn run(
        &mut self,
        sweep: &Sweep,
        workers: &Workers,
        memory: RecordingMemory,
        mut seen: impl FnMut(&[String]) + Send,
    ) -> Result<Account, Unrecorded> {
        let todo: Vec<usize> = self.todo().map(|(index, _)| index).collect();
        let state = Mutex::new((&mut *self, &mut seen, Ok(())));
        let ended = sweep.run(&todo, workers, memory, |index, results| {
            let row = [sweep.point(index), results.clone()].concat();
            let mut guard = state.lock().unwrap_or_else(PoisonError::into_inner);
            let (record, seen, written) = &mut *guard;
            seen(&row);
            if written.is_ok() {
                *written = record.enter(index, results, row);
            }
        });
        let (_, _, written) = state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let account = ended?;
        written.and_then(|()| self.write_table())?;
        Ok(account)
    }

    /// Enters what another process found of points, each named by its [`Sweep::identity`]; `seen` is told of each row that is new.
    /// Points that the sweep does not have are left out.
    ///
    /// # Errors
    ///
    /// If a file cannot be written.
    pub fn take<'a>(
        &mut self,
        sweep: &Sweep,
        found: impl IntoIterator<Item = (&'a str, &'a [String])>,
        mut seen: impl FnMut(&[String]),
    ) -> std::io::Result<()> {
        let found: HashMap<&str, &[String]> = found.into_iter().collect();
        for index in 0..sweep.points() {
            let Some(results) = found.get(self.journal.points()[index].as_str()).filter(|_| !self.has(index)) else {
                continue;
            };
            let row = [&sweep.point(index), *results].concat();
            seen(&row);
            self.enter(index, results.to_vec(), row)?;
        }
        Ok(())
    }

    /// Takes the points that failed for points that are not done, which are run again.
    pub fn forget_failures(&mut self) {
        let failed = self.rows.iter().filter(|(_, row)| row.last().is_some_and(|reason| !reason.is_empty()));
        for index in failed.map(|(index, _)| *index).collect::<Vec<_>>() {
            self.rows.remove(&index);
            self.journal.forget(index);
        }
    }

    /// Tells in the table why a point is not done. It is run when the sweep goes on.
    pub fn miss(&mut self, sweep: &Sweep, index: usize, reason: &str) {
        self.rows.insert(index, [sweep.point(index), sweep.failed(reason.to_owned())].concat());
    }

    /// The points that are not done, each with its [`Sweep::identity`].
    pub fn todo(&self) -> impl Iterator<Item = (usize, &str)> {
        let points = self.journal.points().iter().enumerate();
        points.filter(|(index, _)| !self.has(*index)).map(|(index, point)| (index, point.as_str()))
    }

    /// How many points are done, those that failed among them.
    pub fn done(&self) -> usize {
        self.rows.len()
    }

    /// Why points failed, in their order.
    pub fn failures(&self) -> impl Iterator<Item = &str> {
        self.rows.values().filter_map(|row| row.last()).map(String::as_str).filter(|reason| !reason.is_empty())
    }

    /// Whether a point is done.
    pub fn has(&self, index: usize) -> bool {
        self.journal.has(index)
    }

    /// Enters a point that is done.
    fn enter(&mut self, index: usize, results: Vec<String>, row: Vec<String>) -> std::io::Result<()> {
        self.journal.enter(index, results)?;
        self.rows.insert(index, row);
        if Instant::now() < self.due {
            return Ok(());
        }
        let start = Instant::now();
        self.write_table()?;
        self.due = Instant::now() + (PAUSE_FACTOR * start.elapsed()).max(SHORTEST_PAUSE);
        Ok(())
    }

    /// Brings the table's files up to date.
    pub fn write_table(&self) -> std::io::Result<()> {
        let table = self.table();
        replace(&self.places.csv, |file| table::write_csv(file, &table).map_err(std::io::Error::other))?;
        replace(&self.places.parquet, |file| {
            table::write_parquet(file, &table, &[("pcs_sim.sweep", &self.sweep)]).map_err(std::io::Error::other)
        })?;
        replace(&self.places.sweep, |file| {
            write!(
                file,
                "// Made by pcs-sim {}: the sweep of the table beside it.\n{}",
                env!("CARGO_PKG_VERSION"),
                self.sweep
            )
        })
    }

    /// The points that are done.
    pub fn table(&self) -> Table<'_> {
        Table { columns: &self.columns, rows: self.rows.values().map(Vec::as_slice).collect() }
    }

    /// Where the table is, as CSV and as Parquet, and what it is of.
    pub fn table_paths(&self) -> [&Path; 3] {
        [&self.places.csv, &self.places.parquet, &self.places.sweep]
    }
}

impl Places {
    fn new(path: &Path) -> Result<Places, InputError> {
        table::check_name(path)?;
        let with = |ending| path.with_extension(ending);
        let [csv, parquet, journal] = ["csv", "parquet", "journal"].map(with);
        Ok(Places { csv, parquet, sweep: with("sweep.ron"), journal })
    }

    fn check_free(&self) -> Result<(), InputError> {
        match [&self.csv, &self.parquet, &self.sweep].into_iter().find(|path| path.exists()) {
            Some(path) => {
                let error = InputError::in_file(path, "the file exists already");
                Err(error.help("give another name, or --force to replace it"))
            }
            None => Ok(()),
        }
    }
}

/// Writes a file beside its place, then puts it there.
fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) -> std::io::Result<()> {
    let mut part = path.to_owned().into_os_string();
    part.push(".part");
    let mut file = BufWriter::new(File::create(&part)?);
    write(&mut file)?;
    file.flush()?;
    std::fs::rename(part, path)
}
