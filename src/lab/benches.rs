//! The layers of the last runs, of any tab, for the next ones to take what they can of them.

use std::sync::{Mutex, MutexGuard, PoisonError};

use pcs_sim::run::{Layers, PlannedRun, RecordingMemory};

/// How many runs' layers are kept. Those that they share are kept once.
const MOST: usize = 6;

/// What recordings may take at the most, whatever is free.
const MOST_BYTES: u64 = 1 << 30;

/// Layers of runs, those used last being last. They do not grow beyond a bound, whatever is asked for.
#[derive(Debug)]
pub struct Benches {
    kept: Mutex<Vec<Layers>>,
    bytes: u64,
}

impl Benches {
    /// None yet, in what memory is free.
    pub fn new(threads: usize) -> Benches {
        let RecordingMemory(free) = RecordingMemory::fitting(threads);
        Benches { kept: Mutex::default(), bytes: free.min(MOST_BYTES) }
    }

    /// What a run may keep of what its cells do.
    pub fn memory(&self) -> RecordingMemory {
        RecordingMemory(self.bytes / 2)
    }

    /// The layers that a run shares most with.
    pub fn layers(&self, run: &PlannedRun) -> Layers {
        let kept = self.lock();
        let best = kept.iter().rev().max_by_key(|layers| layers.shared(run));
        best.filter(|layers| layers.shared(run) > 0).cloned().unwrap_or_default()
    }

    /// Keeps those of a run.
    pub fn keep(&self, run: &PlannedRun, layers: Layers) {
        let mut kept = self.lock();
        // Others are wanted for a recording that these have not, or for a scene.
        kept.retain(|others| others.kept(run).is_none() && (others.recorded() > 0 || others.shared(run) == 0));
        kept.push(layers);
        let bytes = |kept: &[Layers]| kept.iter().map(Layers::recorded).sum::<u64>();
        while kept.len() > MOST || (kept.len() > 1 && bytes(&kept) > self.bytes) {
            kept.remove(0);
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Layers>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
