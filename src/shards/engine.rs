//! What starts the shards: programs that architects' clusters have. Nothing here schedules anything.

use std::io;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde::{Deserialize, Serialize};

use super::folder::Folder;
use super::plan::Plan;
use super::{parallel, slurm};
use crate::error::InputError;

/// What starts the shards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Engine {
    /// Slurm: an array of jobs.
    Slurm {
        /// Lines for the head of the script, as they are: `#SBATCH --partition=long`, `module load ...`.
        lines: Vec<String>,
    },
    /// GNU parallel, on this machine or on others by ssh.
    Parallel {
        /// Its arguments: hosts, for example.
        args: Vec<String>,
    },
}

/// How many shards may run at once; `None` for as many as the engine lets.
pub type AtOnce = Option<u32>;

/// What was started.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Job {
    /// Jobs of Slurm.
    Slurm {
        /// The array's number.
        array: String,
        /// The number of the job that joins the results when the array has ended.
        collector: String,
        /// The shards that it runs.
        shards: Vec<usize>,
    },
    /// A group of processes.
    Parallel {
        /// The machine that they were started on.
        host: String,
        /// The group's number.
        group: u32,
        /// The shards that it runs.
        shards: Vec<usize>,
    },
}

/// What became of a shard that was started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    Waiting,
    Running,
    /// It runs no more; why it may not be done.
    Ended(String),
}

impl Engine {
    /// Starts shards of a plan, and what joins them when they have ended.
    ///
    /// # Errors
    ///
    /// If there is no such engine here, or if it does not take them.
    pub fn start(&self, folder: &Folder, plan: &Plan, shards: &[usize], at_once: AtOnce) -> Result<Job, InputError> {
        let unwritten = |error: io::Error| InputError::in_file(folder.path(), format!("cannot be written: {error}"));
        for name in ["cancelled", "joined"] {
            let _ = std::fs::remove_file(folder.place(name));
        }
        let job = match self {
            Engine::Slurm { lines } => slurm::start(folder, plan, shards, (lines, at_once))?,
            Engine::Parallel { args } => parallel::start(folder, plan, shards, (args, at_once))?,
        };
        folder.keep_job(&job).map_err(unwritten)?;
        Ok(job)
    }

    /// Whether its program is there.
    pub fn check(&self) -> Result<(), InputError> {
        let (program, help) = match self {
            Engine::Slurm { .. } => ("sbatch", "--engine slurm is for machines from which jobs are submitted to Slurm"),
            Engine::Parallel { .. } => {
                ("parallel", "--engine parallel wants GNU parallel, which systems have packages of")
            }
        };
        let runs = call(program, &["--version"]).is_ok_and(|output| output.status.success());
        let error = || InputError::new(format!("there is no {program} here")).help(help);
        runs.then_some(()).ok_or_else(error)
    }
}

impl Job {
    /// Its name, for people.
    pub fn name(&self) -> String {
        match self {
            Job::Slurm { array, .. } => format!("Slurm's job {array}"),
            Job::Parallel { host, group, .. } => format!("GNU parallel, process {group} on {host}"),
        }
    }

    /// Whether some of it may still run.
    pub fn is_under_way(&self, folder: &Folder) -> bool {
        match self {
            Job::Slurm { array, .. } => slurm::is_under_way(array),
            Job::Parallel { host, group, .. } => parallel::is_under_way(folder, host, *group),
        }
    }

    /// Ends it. What was found stays.
    ///
    /// # Errors
    ///
    /// If it cannot be ended from here.
    pub fn cancel(&self, folder: &Folder) -> Result<(), InputError> {
        match self {
            Job::Slurm { array, collector, .. } => slurm::cancel(array, collector),
            Job::Parallel { host, group, .. } => parallel::cancel(folder, host, *group),
        }?;
        let noted = folder.keep_script("cancelled", "cancelled\n");
        noted.map(drop).map_err(|error| InputError::in_file(folder.path(), format!("cannot be written: {error}")))
    }

    /// What became of each of so many shards.
    pub(super) fn fates(&self, folder: &Folder, count: usize) -> Vec<Fate> {
        let (shards, mut known) = match self {
            Job::Slurm { array, shards, .. } => (shards, slurm::fates(folder, array, count)),
            Job::Parallel { host, group, shards } => (shards, parallel::fates(folder, (host, *group), count)),
        };
        let mut fates = vec![Fate::Ended("its shard was not run".to_owned()); count];
        for &shard in shards {
            if let (Some(fate), Some(known)) = (fates.get_mut(shard), known.get_mut(shard)) {
                std::mem::swap(fate, known);
            }
        }
        if folder.place("cancelled").exists() {
            let cancelled = || Fate::Ended("its shard was cancelled".to_owned());
            fates.iter_mut().filter(|fate| matches!(fate, Fate::Ended(_))).for_each(|fate| *fate = cancelled());
        }
        fates
    }
}

/// Calls a program, and takes what it says.
pub(super) fn call(program: &str, args: &[&str]) -> io::Result<Output> {
    Command::new(program).args(args).stdin(Stdio::null()).output()
}

/// A text that a shell takes for one word.
pub(super) fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

/// The command that does something with a folder, for scripts: `pcs-sim sweep ...`.
pub(super) fn command(what: &str, folder: &Path) -> Result<String, InputError> {
    let program = std::env::current_exe();
    let program = program.map_err(|error| InputError::new(format!("this program's file cannot be told: {error}")))?;
    Ok(format!("{} sweep {what} {}", quoted(&program.to_string_lossy()), quoted(&folder.to_string_lossy())))
}
