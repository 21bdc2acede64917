//! Who works on a run, and how they are told to stop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The threads that work on something. What comes out does not depend on how many they are.
#[derive(Clone, Debug)]
pub struct Workers {
    /// How many threads, the one that asks included.
    pub threads: usize,
    /// Tells them to stop.
    pub cancel: Cancel,
}

impl Workers {
    /// So many threads, which nobody stops.
    pub fn new(threads: usize) -> Workers {
        Workers { threads, cancel: Cancel::default() }
    }

    /// A thread for each core.
    pub fn on_all_cores() -> Workers {
        Workers::new(std::thread::available_parallelism().map_or(1, |cores| cores.get()))
    }
}

/// A way to stop what takes long, from any thread. Clones stop the same work.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

/// The work was told to stop, and has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before the end, as it was told to")]
pub struct Cancelled;

impl Cancel {
    /// Stops the work, as soon as it comes to its next batch. Nothing that is stopped goes on again.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Fails once the work has been stopped.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.0.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }
}
