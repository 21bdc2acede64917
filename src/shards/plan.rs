//! What is to be done in shards, and by which program on which files.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::cut::{Part, lines_of, parts_of};
use crate::error::InputError;
use crate::input::reading::FileRead;
use crate::run::{RecordingMemory, RunSpec, Switch};
use crate::sweep::Sweep;

/// Work that is cut into shards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// The version of the program that planned it, which is the one that runs it.
    pub version: String,
    /// What tells this work apart from all other.
    pub key: String,
    /// The folder from which the names of files count.
    pub folder: PathBuf,
    /// What is made.
    pub work: Work,
    /// The files that it is made of, as they were when it was planned.
    pub files: Vec<FileRead>,
    /// How many shards there are.
    pub shards: usize,
    /// Threads of each.
    pub threads: u16,
    /// The memory for recordings in each, in bytes, if it was said.
    pub recording_memory: Option<u64>,
    /// Whether results that exist may be replaced.
    pub overwrite: bool,
}

/// What is made of all shards together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Work {
    /// The table of a sweep, which lies beside the plan.
    Sweep {
        /// Where the table goes.
        table: PathBuf,
    },
    /// An image without timing.
    Image {
        /// What it is of.
        spec: Box<RunSpec>,
        /// Where it goes.
        output: PathBuf,
    },
}

impl Plan {
    /// Whether this program, and the files that it sees, are those of the plan.
    ///
    /// # Errors
    ///
    /// If they are not: the error says which.
    pub fn check(&self) -> Result<(), InputError> {
        self.check_version()?;
        self.files.iter().try_for_each(|planned| {
            let bytes = std::fs::read(&planned.path).map_err(|error| InputError::unreadable(&planned.path, &error))?;
            let error = || InputError::in_file(&planned.path, "is not what it was when the shards were planned");
            let same = blake3::hash(&bytes).to_hex().as_str() == planned.digest;
            same.then_some(()).ok_or_else(|| error().help("put it back, or begin anew with --force"))
        })
    }

    /// Whether this program is the one that planned.
    pub fn check_version(&self) -> Result<(), InputError> {
        match self.version == VERSION {
            true => Ok(()),
            false => {
                let error = InputError::new(format!(
                    "the shards were planned by pcs-sim {}, and this is {VERSION}",
                    self.version
                ));
                Err(error.help("all machines must run the same program"))
            }
        }
    }
}

/// The version of this program.
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// How shards work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Manner {
    /// About how many there are.
    pub shards: usize,
    /// Threads of each.
    pub threads: u16,
    /// The memory for recordings in each, if it is said.
    pub memory: Option<RecordingMemory>,
    /// Whether results that exist may be replaced.
    pub overwrite: bool,
}

impl Plan {
    /// Plans points of a sweep whose table goes to `table`, and says what each shard has to do. The points are named by their
    /// [`Sweep::identity`].
    ///
    /// # Errors
    ///
    /// If the folder in which this process works cannot be told.
    pub fn of_sweep(
        sweep: &Sweep,
        points: &[(usize, &str)],
        table: &Path,
        manner: Manner,
    ) -> Result<(Plan, Vec<Part>), InputError> {
        let mut files: Vec<FileRead> = sweep.files().cloned().collect();
        files.sort();
        files.dedup();
        let mut key = blake3::Hasher::new();
        for (_, point) in points {
            key.update(point.as_bytes());
        }
        let parts = parts_of(sweep, points, manner.shards);
        let work = Work::Sweep { table: absolute(table)? };
        Ok((Plan::new(work, (key, files), parts.len(), manner)?, parts))
    }

    /// Plans an image that goes to `output` and is made of `files`, and says what each shard has to do.
    ///
    /// # Errors
    ///
    /// If it is timed, and if the folder in which this process works cannot be told.
    pub fn of_image(
        spec: &RunSpec,
        files: Vec<FileRead>,
        output: &Path,
        manner: Manner,
    ) -> Result<(Plan, Vec<Part>), InputError> {
        if spec.image.as_ref().is_none_or(|image| image.timing == Switch::On) {
            let error = InputError::new("an image that is timed is one array, and stays on one machine");
            return Err(error.help("with --timing off its lines can be made anywhere"));
        }
        let spec = Box::new(spec.clone());
        let mut key = blake3::Hasher::new();
        key.update(format!("{spec:?} {files:?}").as_bytes());
        let parts = lines_of(spec.size, manner.shards);
        let work = Work::Image { spec, output: absolute(output)? };
        Ok((Plan::new(work, (key, files), parts.len(), manner)?, parts))
    }

    fn new(
        work: Work,
        (key, files): (blake3::Hasher, Vec<FileRead>),
        shards: usize,
        manner: Manner,
    ) -> Result<Plan, InputError> {
        Ok(Plan {
            version: VERSION.to_owned(),
            key: key.finalize().to_hex()[..32].to_owned(),
            folder: absolute(Path::new("."))?,
            work,
            files,
            shards,
            threads: manner.threads,
            recording_memory: manner.memory.map(|memory| memory.0),
            overwrite: manner.overwrite,
        })
    }

    /// What is made of it all.
    pub fn result(&self) -> &Path {
        match &self.work {
            Work::Sweep { table } => table,
            Work::Image { output, .. } => output,
        }
    }
}

/// A name that is the same wherever a process works.
pub(super) fn absolute(path: &Path) -> Result<PathBuf, InputError> {
    let folder = std::env::current_dir().and_then(|folder| folder.canonicalize());
    let folder =
        folder.map_err(|error| InputError::new(format!("the folder of this process cannot be told: {error}")))?;
    let plain = folder.join(path.strip_prefix(".").unwrap_or(path));
    Ok(if path == Path::new(".") { folder } else { plain })
}
