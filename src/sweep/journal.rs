//! The journal of a sweep: a line for each point that is done, so that a killed sweep can go on.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::InputError;

/// The rows of the points that are done, in memory and in a file that outlives the process.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// For each point, its row once it is done.
    rows: Vec<Option<Vec<String>>>,
}

impl Journal {
    /// Opens the journal of a sweep, or starts one. `heading` tells the sweep apart from all others.
    pub fn open(path: &Path, heading: &str, points: usize) -> Result<Journal, InputError> {
        let failed = |error: std::io::Error| InputError::in_file(path, format!("cannot be used: {error}"));
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        let mut journal = Journal { path: path.to_owned(), file, rows: vec![None; points] };
        journal.recover(heading).map_err(failed)?.then_some(journal).ok_or_else(|| {
            let error = InputError::in_file(path, "is the journal of another sweep");
            error.help("remove it to start this one, or give the table another name")
        })
    }

    /// Reads what is there, and cuts off a line that was being written when the process ended. False if it is another
    /// sweep's.
    fn recover(&mut self, heading: &str) -> std::io::Result<bool> {
        let mut text = String::new();
        self.file.read_to_string(&mut text)?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        self.file.set_len(whole as u64)?;
        self.file.seek(SeekFrom::End(0))?;
        let mut lines = text[..whole].lines();
        match lines.next() {
            None => writeln!(self.file, "{}", serde_json::to_string(heading)?)?,
            Some(line) if serde_json::from_str::<String>(line)? == heading => {}
            Some(_) => return Ok(false),
        }
        for line in lines {
            let (index, row): (usize, Vec<String>) = serde_json::from_str(line)?;
            if let Some(place) = self.rows.get_mut(index) {
                *place = Some(row);
            }
        }
        Ok(true)
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
    pub fn rows(&self) -> impl Iterator<Item = &Vec<String>> {
        self.rows.iter().flatten()
    }

    /// Removes the file: the table has all that it had.
    pub fn remove(self) -> std::io::Result<()> {
        std::fs::remove_file(self.path)
    }
}
