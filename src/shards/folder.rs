//! The folder that all machines see: the plan, what each shard has to do, what it found.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::cut::Part;
use super::engine::Job;
use super::plan::{self, Plan};
use super::shard::Found;
use crate::error::InputError;

/// A folder of shards. Each of its files is put in its place in one step, so that whoever reads it reads all of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folder(PathBuf);

/// As long as it is held, nobody else joins the shards of a folder.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

/// The folders in it.
const FOLDERS: [&str; 4] = ["parts", "results", "refused", "logs"];

impl Folder {
    /// The folder beside a result.
    pub fn beside(result: &Path) -> Result<Folder, InputError> {
        plan::absolute(&result.with_extension("shards")).map(Folder)
    }

    /// A folder that has shards.
    ///
    /// # Errors
    ///
    /// If it has none.
    pub fn open(path: &Path) -> Result<(Folder, Plan), InputError> {
        let folder = Folder(plan::absolute(path)?);
        match folder.plan()? {
            Some(plan) => Ok((folder, plan)),
            None => {
                let error = InputError::in_file(path, "is no folder of shards");
                Err(error.help("`pcs-sim sweep FILE -o TABLE.csv --engine ...` makes TABLE.shards"))
            }
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// The place of a file in it.
    pub(super) fn place(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// What is planned in it, if anything is.
    pub fn plan(&self) -> Result<Option<Plan>, InputError> {
        read(&self.place("plan.json"))
    }

    /// Begins anew: what a plan of before had in the folder is removed.
    ///
    /// # Errors
    ///
    /// If something else is in it, and if it cannot be written.
    pub fn begin(&self, plan: &Plan, parts: &[Part], sweep: Option<&str>) -> Result<(), InputError> {
        let failed = |error: io::Error| InputError::in_file(&self.0, format!("cannot be written: {error}"));
        if !self.place("plan.json").exists() && self.has_others().map_err(failed)? {
            let error = InputError::in_file(&self.0, "is there already, and is no folder of shards");
            return Err(error.help("remove it, or give the result another name"));
        }
        for name in FOLDERS {
            let _ = std::fs::remove_dir_all(self.place(name));
        }
        let _ = std::fs::remove_file(self.place("job.json"));
        for name in FOLDERS {
            std::fs::create_dir_all(self.place(name)).map_err(failed)?;
        }
        for (number, part) in parts.iter().enumerate() {
            write(&self.place(&format!("parts/{number}.json")), part).map_err(failed)?;
        }
        if let Some(sweep) = sweep {
            put(&self.sweep_file(), sweep.as_bytes()).map_err(failed)?;
        }
        write(&self.place("plan.json"), plan).map_err(failed)
    }

    /// Whether it has anything but a lock.
    fn has_others(&self) -> io::Result<bool> {
        match std::fs::read_dir(&self.0) {
            Ok(mut entries) => Ok(entries.any(|entry| entry.is_ok_and(|entry| entry.file_name() != "lock"))),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// The sweep, its ranges written out.
    pub fn sweep_file(&self) -> PathBuf {
        self.place("sweep.ron")
    }

    /// What a shard has to do.
    pub fn part(&self, number: usize) -> Result<Part, InputError> {
        let place = self.place(&format!("parts/{number}.json"));
        read(&place)?.ok_or_else(|| InputError::in_file(&place, "is missing: there is no such shard"))
    }

    /// Where the results of a shard are.
    pub fn results(&self, number: usize) -> PathBuf {
        self.place(&format!("results/{number}.json"))
    }

    /// What a shard has found by now.
    pub fn found(&self, number: usize) -> Result<Option<Found>, InputError> {
        read(&self.results(number))
    }

    /// Keeps what a shard has found by now.
    pub(super) fn keep_found(&self, number: usize, found: &Found) -> io::Result<()> {
        write(&self.results(number), found)
    }

    /// Why a shard refused to run, if it did the last time.
    pub fn refusal(&self, number: usize) -> Option<String> {
        std::fs::read_to_string(self.place(&format!("refused/{number}.txt"))).ok()
    }

    /// Keeps why a shard refuses to run, or that it does not.
    pub fn keep_refusal(&self, number: usize, reason: Option<&str>) -> io::Result<()> {
        let place = self.place(&format!("refused/{number}.txt"));
        match reason {
            Some(reason) => put(&place, reason.as_bytes()),
            None if place.exists() => std::fs::remove_file(place),
            None => Ok(()),
        }
    }

    /// Where a shard writes what it says.
    pub fn log(&self, number: usize) -> PathBuf {
        self.place(&format!("logs/{number}.log"))
    }

    /// What was started last.
    pub fn job(&self) -> Result<Option<Job>, InputError> {
        read(&self.place("job.json"))
    }

    /// Keeps what was started.
    pub(super) fn keep_job(&self, job: &Job) -> io::Result<()> {
        write(&self.place("job.json"), job)
    }

    /// Writes a script that people can read.
    pub(super) fn keep_script(&self, name: &str, text: &str) -> io::Result<PathBuf> {
        let place = self.place(name);
        put(&place, text.as_bytes())?;
        Ok(place)
    }

    /// Whether all that the last job found has been joined.
    pub fn is_joined(&self) -> bool {
        self.place("joined").exists()
    }

    /// Keeps that it has.
    pub fn keep_joined(&self) -> io::Result<()> {
        put(&self.place("joined"), b"joined\n")
    }

    /// Lets nobody else join the shards. `None` if somebody does.
    pub fn lock(&self) -> Result<Option<Lock>, InputError> {
        let failed = |error: io::Error| InputError::in_file(&self.0, format!("cannot be used: {error}"));
        std::fs::create_dir_all(&self.0).map_err(failed)?;
        let place = self.place("lock");
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(place).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Lock { _file: file })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) => Err(failed(error)),
        }
    }
}

/// Reads a file that may be missing.
fn read<T: DeserializeOwned>(place: &Path) -> Result<Option<T>, InputError> {
    let bytes = match std::fs::read(place) {
        Ok(bytes) => bytes,
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
            return Ok(None);
        }
        Err(error) => return Err(InputError::unreadable(place, &error)),
    };
    let parsed = serde_json::from_slice(&bytes);
    parsed.map(Some).map_err(|error| InputError::in_file(place, format!("is no such file of shards: {error}")))
}

fn write(place: &Path, value: &impl Serialize) -> io::Result<()> {
    put(place, &serde_json::to_vec(value)?)
}

/// Puts a whole file in its place. Two that do so at once do not disturb each other.
fn put(place: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = place.parent().unwrap_or(Path::new("."));
    let mut part = tempfile::Builder::new().prefix(".part-").tempfile_in(folder)?;
    part.write_all(bytes)?;
    part.as_file().sync_all()?;
    crate::run::make_readable(part.path())?;
    part.persist(place).map(drop).map_err(|error| error.error)
}
