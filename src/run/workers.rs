//! Who works on a run.

use crate::cancel::Cancel;

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
