//! The journal of a sweep: a line for each point that is done, so that a killed sweep can go on, and one that gets more
//! points runs no others.

use std::collections::{HashMap, HashSet};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use super::file::HALF;
use crate::error::InputError;

/// The results of the points that are done, in memory and in a file that outlives the process. As long as it is open, no
/// other process can open it.
#[derive(Debug)]
pub(super) struct Journal {
    file: File,
    heading: Heading,
    /// For each point, its results once it is done.
    results: Vec<Option<Vec<String>>>,
    /// What the file says already of points that failed, which are run again.
    failures: HashMap<String, Vec<String>>,
}

/// What a journal is for.
#[derive(Debug)]
pub(super) struct Heading {
    /// What all points have in common: the program's version, and what is told of a point.
    pub kind: String,
    /// What tells each point apart from all others: a [`Sweep::identity`](super::Sweep::identity).
    pub points: Vec<String>,
    /// How many cells a point's results have; the last tells why it failed.
    pub cells: usize,
}

/// Why a journal cannot be gone on with.
enum Refused {
    OtherSweep,
    OtherPoints(usize),
    Damaged(usize),
    Failed(std::io::Error),
}

impl From<std::io::Error> for Refused {
    fn from(error: std::io::Error) -> Refused {
        Refused::Failed(error)
    }
}

impl Journal {
    /// Opens the journal of a sweep, or starts one. Points that were not in it are to be run.
    ///
    /// With `force`, points that this sweep does not have are dropped; without, there must be none.
    pub fn open(path: &Path, heading: Heading, force: bool) -> Result<Journal, InputError> {
        let failed = |error: std::io::Error| InputError::in_file(path, format!("cannot be used: {error}"));
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::Error(error)) => return Err(failed(error)),
            Err(TryLockError::WouldBlock) => {
                let error = InputError::in_file(path, "another process is running this sweep");
                return Err(error.help("wait for it to end, or give the table another name"));
            }
        }
        let mut journal =
            Journal { file, results: vec![None; heading.points.len()], heading, failures: HashMap::new() };
        match journal.recover() {
            Ok(()) => Ok(journal),
            Err(Refused::OtherSweep | Refused::OtherPoints(_) | Refused::Damaged(_)) if force => {
                journal.start_anew().map_err(failed)?;
                Ok(journal)
            }
            Err(Refused::OtherSweep) => Err(other_sweep(path, "")),
            Err(Refused::OtherPoints(count)) => {
                let points =
                    if count == 1 { "1 of its points is".to_owned() } else { format!("{count} of its points are") };
                Err(other_sweep(path, &format!(": {points} not among these")))
            }
            Err(Refused::Damaged(line)) => {
                let error = InputError::in_file(path, format!("is no journal: line {line} makes no sense"));
                Err(error.help("give the table another name, or --force to start the sweep anew"))
            }
            Err(Refused::Failed(error)) => Err(failed(error)),
        }
    }

    /// Reads what is there, and cuts off a line that was being written when the process ended. Points that failed are to be run
    /// again, also where a file that they name has come or has changed since.
    fn recover(&mut self) -> Result<(), Refused> {
        let mut bytes = Vec::new();
        self.file.read_to_end(&mut bytes)?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        let mut lines = bytes[..whole].split_inclusive(|&byte| byte == b'\n');
        let Some(first) = lines.next() else { return Ok(self.start_anew()?) };
        let kind: String = serde_json::from_slice(first).map_err(|_| Refused::Damaged(1))?;
        if kind != self.heading.kind {
            return Err(Refused::OtherSweep);
        }
        // A value may stand twice among those of a parameter.
        let mut places: HashMap<&str, Vec<usize>> = HashMap::new();
        for (place, point) in self.heading.points.iter().enumerate() {
            places.entry(point).or_default().push(place);
        }
        let values: HashSet<&str> = self.heading.points.iter().filter_map(|point| point.get(..HALF)).collect();
        let is_known = |point: &str| point.get(..HALF).is_some_and(|point| values.contains(point));
        let mut of_others = 0;
        for (line, number) in lines.zip(2..) {
            let entry: Result<(&str, Vec<String>), _> = serde_json::from_slice(line);
            let entry = entry.ok().filter(|(_, results)| results.len() == self.heading.cells);
            let (point, results) = entry.ok_or(Refused::Damaged(number))?;
            let failed = results.last().is_some_and(|reason| !reason.is_empty());
            match places.get(point) {
                _ if failed && is_known(point) => drop(self.failures.insert(point.to_owned(), results)),
                Some(places) => places.iter().for_each(|&place| self.results[place] = Some(results.clone())),
                None => of_others += 1,
            }
        }
        if of_others > 0 {
            return Err(Refused::OtherPoints(of_others));
        }
        self.file.set_len(whole as u64)?;
        self.file.seek(SeekFrom::End(0))?;
        Ok(())
    }

    /// Writes the journal again: its heading, and the points that it shares with what was there.
    fn start_anew(&mut self) -> std::io::Result<()> {
        let mut lines = serde_json::to_string(&self.heading.kind)? + "\n";
        for (point, results) in self.heading.points.iter().zip(&self.results) {
            if let Some(results) = results {
                lines += &line(point, results)?;
            }
        }
        self.failures.clear();
        self.file.set_len(0)?;
        self.file.rewind()?;
        self.file.write_all(lines.as_bytes())
    }

    /// What tells each point apart from all others.
    pub fn points(&self) -> &[String] {
        &self.heading.points
    }

    /// Forgets that a point is done.
    pub fn forget(&mut self, index: usize) {
        self.results[index] = None;
    }

    /// Whether a point is done.
    pub fn has(&self, index: usize) -> bool {
        self.results[index].is_some()
    }

    /// Enters a point that is done: in one write, so that a kill loses at most its own line.
    pub fn enter(&mut self, index: usize, results: Vec<String>) -> std::io::Result<()> {
        let point = &self.heading.points[index];
        if self.failures.get(point) != Some(&results) {
            self.file.write_all(line(point, &results)?.as_bytes())?;
        }
        self.results[index] = Some(results);
        Ok(())
    }

    /// The results of the points that are done, with their numbers, in the order of the points.
    pub fn results(&self) -> impl Iterator<Item = (usize, &[String])> {
        self.results.iter().enumerate().filter_map(|(index, results)| Some((index, results.as_deref()?)))
    }
}

fn other_sweep(path: &Path, why: &str) -> InputError {
    let what = "is the journal of another sweep, or the files of this one changed";
    let error = InputError::in_file(path, format!("{what}{why}"));
    error.help("give the table another name, or --force to start this sweep in place of the other")
}

fn line(point: &str, results: &[String]) -> std::io::Result<String> {
    Ok(serde_json::to_string(&(point, results))? + "\n")
}
