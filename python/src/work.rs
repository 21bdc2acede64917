//! Work that takes long: without the interpreter's lock, with progress, and stopped by Ctrl-C.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use pcs_sim::cancel::Cancel;
use pcs_sim::run::Workers;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::trouble::Trouble;

/// How often Python is asked for signals, and the bar is drawn.
const PAUSE: Duration = Duration::from_millis(50);

/// Work that is done earlier has no bar, unless one is asked for.
const BAR_AFTER: Duration = Duration::from_millis(500);

/// Who does the work, and who is told of it.
#[derive(Clone, Copy, Debug)]
pub struct Crew {
    /// How many threads; `None` for all cores.
    pub threads: Option<u16>,
    /// Whether a bar is drawn; `None` for one where somebody looks.
    pub progress: Option<bool>,
}

/// Work under way.
#[derive(Debug)]
pub struct Task {
    /// The threads that work on it.
    pub workers: Workers,
    done: AtomicU64,
    of: AtomicU64,
    ended: AtomicBool,
}

impl Task {
    /// So much is done of so much.
    pub fn set(&self, done: u64, of: u64) {
        self.of.store(of, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
    }

    /// So much more is done.
    pub fn add(&self, more: u64) {
        self.done.fetch_add(more, Ordering::Relaxed);
    }
}

/// Tells the thread that waits, however the work ends.
struct Ending<'a>(&'a Task, Thread);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.ended.store(true, Ordering::Release);
        self.1.unpark();
    }
}

/// Does some work on a thread of its own, and waits for it. `unit` is what its progress counts.
///
/// Fails as the work does, with what a signal's handler raises, and with a `RuntimeError` if the work panics.
pub fn work<T: Send>(
    py: Python<'_>,
    crew: Crew,
    unit: &str,
    job: impl FnOnce(&Task) -> Result<T, Trouble> + Send,
) -> PyResult<T> {
    let workers = match crew.threads {
        Some(threads) => Workers::new(threads.into()),
        None => Workers::on_all_cores(),
    };
    let (done, of, ended) = Default::default();
    let task = &Task { workers, done, of, ended };
    thread::scope(|scope| {
        let ending = Ending(task, thread::current());
        let worker = scope.spawn(move || {
            let _ending = ending;
            job(task)
        });
        let watched = watch(py, task, crew.progress, unit);
        if watched.is_err() {
            task.workers.cancel.cancel();
        }
        let result = py.detach(|| worker.join());
        watched?;
        match result {
            Ok(result) => result.map_err(|trouble| trouble.raise(py)),
            Err(_) => Err(PyRuntimeError::new_err("pcs_sim failed by a fault of its own: please report it")),
        }
    })
}

/// Waits until the work has ended, or a signal's handler raises something.
fn watch(py: Python<'_>, task: &Task, progress: Option<bool>, unit: &str) -> PyResult<()> {
    let start = Instant::now();
    let mut bar = Bar(None);
    while !task.ended.load(Ordering::Acquire) {
        py.detach(|| thread::park_timeout(PAUSE));
        py.check_signals()?;
        let of = task.of.load(Ordering::Relaxed);
        let due = progress == Some(true) || (progress.is_none() && start.elapsed() >= BAR_AFTER);
        if bar.0.is_none() && of > 0 && due {
            let helpers = py.import("pcs_sim._helpers")?;
            bar = Bar(Some(helpers.getattr("bar")?.call1((of, unit, progress))?));
        }
        bar.show(task.done.load(Ordering::Relaxed), of)?;
    }
    Ok(())
}

/// A progress bar, or nothing (or Python's None).
struct Bar<'py>(Option<Bound<'py, PyAny>>);

impl Bar<'_> {
    fn show(&self, done: u64, of: u64) -> PyResult<()> {
        match &self.0 {
            Some(bar) if !bar.is_none() => bar.call_method1("show", (done, of)).map(drop),
            _ => Ok(()),
        }
    }
}

impl Drop for Bar<'_> {
    fn drop(&mut self) {
        if let Some(bar) = self.0.as_ref().filter(|bar| !bar.is_none()) {
            // A bar that cannot be taken away is no reason to lose the work.
            let _ = bar.call_method0("close");
        }
    }
}

/// The same for what is soon done.
pub fn briefly<T: Send>(py: Python<'_>, job: impl FnOnce(&Cancel) -> Result<T, Trouble> + Send) -> PyResult<T> {
    work(py, Crew { threads: None, progress: Some(false) }, "", |task| job(&task.workers.cancel))
}
