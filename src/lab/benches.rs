//! The layers of the last runs, of any tab, for the next ones to take what they can of them.

use std::sync::{Mutex, MutexGuard, PoisonError};

use pcs_sim::run::{Layers, PlannedRun, RecordingMemory};

/// How many runs' layers are kept. Those that they share are kept once.
const MOST: usize = 6;

/// What runs may take that are kept, and what those may record that go on, whatever is free.
const MOST_BYTES: u64 = 1 << 29;

/// Layers of runs, those used last being last. They do not grow beyond a bound, whatever is asked for.
#[derive(Debug)]
pub struct Benches {
    kept: Mutex<Vec<Layers>>,
    /// What runs that go on may record.
    promised: Mutex<u64>,
    /// What either may take.
    bytes: u64,
}

/// What a run that goes on may record. When it is over others may.
pub struct Room<'a> {
    benches: &'a Benches,
    /// The memory that there is for it.
    pub memory: RecordingMemory,
}

impl Benches {
    /// None yet, in what memory is free.
    pub fn new(threads: usize) -> Benches {
        let RecordingMemory(free) = RecordingMemory::fitting(threads);
        Benches { kept: Mutex::default(), promised: Mutex::default(), bytes: (free / 2).min(MOST_BYTES) }
    }

    /// Room for what a run's cells do: half of what others that go on have left.
    pub fn room(&self) -> Room<'_> {
        let mut promised = lock(&self.promised);
        let bytes = (self.bytes - *promised) / 2;
        *promised += bytes;
        Room { benches: self, memory: RecordingMemory(bytes) }
    }

    /// The layers that a run shares most with.
    pub fn layers(&self, run: &PlannedRun) -> Layers {
        let kept = lock(&self.kept);
        let best = kept.iter().rev().max_by_key(|layers| layers.shared(run));
        best.filter(|layers| layers.shared(run) > 0).cloned().unwrap_or_default()
    }

    /// Keeps those of a run.
    pub fn keep(&self, run: &PlannedRun, layers: Layers) {
        let mut kept = lock(&self.kept);
        // Others are wanted for a recording that these have not, or for a scene.
        kept.retain(|others| others.kept(run).is_none() && (others.has_recording() || others.shared(run) == 0));
        kept.push(layers);
        while kept.len() > MOST || Layers::bytes(&kept) > self.bytes {
            kept.remove(0);
        }
    }
}

impl Drop for Room<'_> {
    fn drop(&mut self) {
        let RecordingMemory(bytes) = self.memory;
        *lock(&self.benches.promised) -= bytes;
    }
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcs_sim::run::{RunOptions, RunSpec, Watching, Workers};

    fn planned(size: &str, grid_coefficient: &str) -> PlannedRun {
        let mut options = RunOptions::default();
        for (name, value) in [("scene", "tetra"), ("size", size), ("grid_coefficient", grid_coefficient)] {
            options.set(name, value).unwrap();
        }
        PlannedRun::new(RunSpec::new(&options, None).unwrap()).unwrap()
    }

    fn run(benches: &Benches, planned: &PlannedRun) -> Layers {
        let mut layers = benches.layers(planned);
        let room = benches.room();
        let watched = (&Workers::new(1), room.memory);
        layers.run(planned, &Watching::default(), watched, |_, _| ()).unwrap();
        layers
    }

    #[test]
    fn what_is_kept_has_a_bound_and_what_runs_share_is_counted_once() {
        let large = Benches { kept: Mutex::default(), promised: Mutex::default(), bytes: 1 << 29 };
        let layers = run(&large, &planned("8x8", "50"));
        let bytes = Layers::bytes(std::slice::from_ref(&layers));
        assert_eq!(Layers::bytes(&[layers.clone(), layers.clone()]), bytes);
        // 4 096 polygons of three corners, and 50 voxels for each.
        assert!(bytes > 4096 * (3 * 12 + 50 * 4), "{bytes}");

        let small = Benches { kept: Mutex::default(), promised: Mutex::default(), bytes: 2 * bytes };
        for coefficient in ["50", "49", "48", "47", "46"] {
            let planned = planned("8x8", coefficient);
            let layers = run(&small, &planned);
            small.keep(&planned, layers);
            let kept = lock(&small.kept);
            assert!(!kept.is_empty() && Layers::bytes(&kept) <= small.bytes);
        }
        let larger = planned("8x8", "400");
        let layers = run(&small, &larger);
        assert!(Layers::bytes(std::slice::from_ref(&layers)) > small.bytes);
        small.keep(&larger, layers);
        assert!(lock(&small.kept).is_empty(), "what is larger than all that may be kept is not");
    }

    #[test]
    fn runs_that_go_on_together_share_a_bound() {
        let benches = Benches { kept: Mutex::default(), promised: Mutex::default(), bytes: 1000 };
        let rooms: Vec<Room<'_>> = (0..40).map(|_| benches.room()).collect();
        assert_eq!(rooms[..3].iter().map(|room| room.memory.0).collect::<Vec<_>>(), [500, 250, 125]);
        assert!(rooms.iter().map(|room| room.memory.0).sum::<u64>() <= 1000);
        drop(rooms);
        assert_eq!(benches.room().memory, RecordingMemory(500));
    }
}
