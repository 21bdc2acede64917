//! Sweeps.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use pcs_sim::report::table;
use pcs_sim::run::RecordingMemory;
use pcs_sim::sweep::{Record, Sweep, Unrecorded};
use pyo3::prelude::*;

use crate::calls::crew;
use crate::request::{is_path, json};
use crate::table::Table;
use crate::trouble::{Trouble, output, wrong};
use crate::work::{Task, work};

/// Runs every combination of parameters, and gives one table: a row a run, the parameters first.
///
/// `sweep` is a file as `pcs-sim sweep` takes it, or a dict: for each parameter a value, a list of values, or a range as
/// {"from": 1, "to": 64, "times": 2}. With `table` the rows go to TABLE.csv and TABLE.parquet as points finish, and a
/// sweep that was stopped goes on where it was; one that is done is not run again. A point that fails says why in the
/// column `error`. `recording_memory` is the memory that a recording may take, which points share, such as "8GB"; points of a
/// larger one are timed while its rays are traced.
#[pyfunction]
#[pyo3(name = "sweep", signature = (sweep, *, table=None, force=false, threads=None, recording_memory=None, progress=None))]
pub fn sweep(
    py: Python<'_>,
    sweep: &Bound<'_, PyAny>,
    table: Option<PathBuf>,
    force: bool,
    threads: Option<i64>,
    recording_memory: Option<String>,
    progress: Option<bool>,
) -> PyResult<Table> {
    let read = match is_path(sweep) {
        true => Sweep::read(&sweep.extract::<PathBuf>()?),
        false => Sweep::from_json(json(py, sweep)?, |_, _| Ok(())),
    };
    let sweep = read.map_err(|error| Trouble::from(error).raise(py))?;
    let memory = recording_memory.map(|text| text.parse::<RecordingMemory>().map_err(|expected| (text, expected)));
    let memory = memory
        .transpose()
        .map_err(|(text, expected)| wrong(py, format!("invalid value '{text}' for recording_memory: {expected}")))?;
    let rows = work(py, crew(py, threads, progress)?, "points", |task| match &table {
        Some(path) => recorded(&sweep, Record::open(&sweep, path, force)?, task, memory),
        None => in_memory(&sweep, task, memory),
    })?;
    let rows = rows.iter().map(Vec::as_slice).collect();
    Table::of_cells(&table::Table { columns: &sweep.columns(), rows })
}

/// The rows of a sweep that is recorded in files.
fn recorded(
    sweep: &Sweep,
    mut record: Record,
    task: &Task,
    memory: Option<RecordingMemory>,
) -> Result<Vec<Vec<String>>, Trouble> {
    task.set(record.done() as u64, sweep.points() as u64);
    record.run(sweep, &task.workers, fitting(task, memory), |_| task.add(1)).map_err(
        |unrecorded| match unrecorded {
            Unrecorded::Cancelled(cancelled) => cancelled.into(),
            Unrecorded::Unwritten(_) => output(unrecorded),
        },
    )?;
    Ok(record.table().rows.into_iter().map(<[String]>::to_vec).collect())
}

/// The memory for a recording: what was asked for, or what fits.
fn fitting(task: &Task, memory: Option<RecordingMemory>) -> RecordingMemory {
    memory.unwrap_or_else(|| RecordingMemory::fitting(task.workers.threads))
}

/// The rows of a sweep that no file keeps.
fn in_memory(sweep: &Sweep, task: &Task, memory: Option<RecordingMemory>) -> Result<Vec<Vec<String>>, Trouble> {
    let all: Vec<usize> = (0..sweep.points()).collect();
    task.set(0, sweep.points() as u64);
    let rows = Mutex::new(vec![Vec::new(); sweep.points()]);
    sweep.run(&all, &task.workers, fitting(task, memory), |index, results| {
        rows.lock().unwrap_or_else(PoisonError::into_inner)[index] = [sweep.point(index), results].concat();
        task.add(1);
    })?;
    Ok(rows.into_inner().unwrap_or_else(PoisonError::into_inner))
}
