//! The journal of a sweep: a line for each point that is done, so that a killed sweep can go on.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use crate::error::InputError;

/// The rows of the points that are done, in memory and in a file that outlives the process. As long as it is open, no
/// other process can open it.
#[derive(Debug)]
pub(super) struct Journal {
    file: File,
    /// For each point, its row once it is done.
    rows: Vec<Option<Vec<String>>>,
}

/// What a journal is for.
#[derive(Debug)]
pub(super) struct Heading {
    /// Tells the sweep apart from all others.
    pub identity: String,
    /// How many points it has.
    pub points: usize,
    /// How many cells a row has.
    pub columns: usize,
}

/// Why a journal cannot be gone on with.
enum Refused {
    OtherSweep,
    Damaged(usize),
    Failed(std::io::Error),
}

impl From<std::io::Error> for Refused {
    fn from(error: std::io::Error) -> Refused {
        Refused::Failed(error)
    }
}

impl Journal {
    /// Opens the journal of a sweep, or starts one. With `force`, another sweep's journal makes room for this one's.
    pub fn open(path: &Path, heading: &Heading, force: bool) -> Result<Journal, InputError> {
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
        let mut journal = Journal { file, rows: vec![None; heading.points] };
        match journal.recover(heading) {
            Ok(()) => Ok(journal),
            Err(Refused::OtherSweep | Refused::Damaged(_)) if force => {
                journal.start_anew(heading).map_err(failed)?;
                Ok(journal)
            }
            Err(Refused::OtherSweep) => {
                let error =
                    InputError::in_file(path, "is the journal of another sweep, or the files of this one changed");
                Err(error.help("give the table another name, or --force to start this sweep in place of the other"))
            }
            Err(Refused::Damaged(line)) => {
                let error = InputError::in_file(path, format!("is no journal: line {line} makes no sense"));
                Err(error.help("give the table another name, or --force to start the sweep anew"))
            }
            Err(Refused::Failed(error)) => Err(failed(error)),
        }
    }

    /// Reads what is there, and cuts off a line that was being written when the process ended.
    fn recover(&mut self, heading: &Heading) -> Result<(), Refused> {
        let mut bytes = Vec::new();
        self.file.read_to_end(&mut bytes)?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        let mut lines = bytes[..whole].split_inclusive(|&byte| byte == b'\n');
        let Some(first) = lines.next() else { return Ok(self.start_anew(heading)?) };
        let identity: String = serde_json::from_slice(first).map_err(|_| Refused::Damaged(1))?;
        if identity != heading.identity {
            return Err(Refused::OtherSweep);
        }
        for (line, number) in lines.zip(2..) {
            let entry: Result<(usize, Vec<String>), _> = serde_json::from_slice(line);
            let fits = |(index, row): &(usize, Vec<String>)| *index < self.rows.len() && row.len() == heading.columns;
            let (index, row) = entry.ok().filter(fits).ok_or(Refused::Damaged(number))?;
            self.rows[index] = Some(row);
        }
        self.file.set_len(whole as u64)?;
        self.file.seek(SeekFrom::End(0))?;
        Ok(())
    }

    fn start_anew(&mut self, heading: &Heading) -> std::io::Result<()> {
        self.rows.fill(None);
        self.file.set_len(0)?;
        self.file.rewind()?;
        let line = serde_json::to_string(&heading.identity)? + "\n";
        self.file.write_all(line.as_bytes())
    }

    /// Whether a point is done.
    pub fn has(&self, index: usize) -> bool {
        self.rows[index].is_some()
    }

    /// Enters a point that is done: in one write, so that a kill loses at most its own line.
    pub fn enter(&mut self, index: usize, row: Vec<String>) -> std::io::Result<()> {
        let line = serde_json::to_string(&(index, &row))? + "\n";
        self.file.write_all(line.as_bytes())?;
        self.rows[index] = Some(row);
        Ok(())
    }

    /// The rows of the points that are done, in the order of the points.
    pub fn rows(&self) -> impl Iterator<Item = &[String]> {
        self.rows.iter().flatten().map(Vec::as_slice)
    }
}
