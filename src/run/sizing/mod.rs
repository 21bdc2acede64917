//! The fewest words that FIFOs need: a recorded run, timed again and again under other depths.
//!
//! No run gets slower if a FIFO gets deeper: the time of each word is the latest of a few earlier ones, and with a deeper FIFO one of
//! them comes earlier. So what is fast enough stays so with more words anywhere, and what is too slow stays so with fewer. The least
//! depth of a FIFO, the others as they are, is found by halving and by short steps down; and once it is found, it stays the least when
//! others become shallower. One pass over all FIFOs therefore ends with depths of which none can be lowered by itself.
//!
//! Only depths are tried at which some word would have had to wait: less than a FIFO holds if all are unlimited, and in each run that
//! is fast enough, no more than it came to hold there.

mod search;

use std::collections::BTreeSet;
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use self::search::Search;
use super::RunError;
use crate::cancel::Cancel;
use crate::error::InputError;
use crate::machine::{Cycles, FifoName, MachineFile, MachineSpec, Stuck, Words};
use crate::seam::{Costs, OpBatch};

/// A recorded run, to be timed under depths of all kinds.
#[derive(Clone, Copy, Debug)]
pub struct Recorded<'a> {
    /// What host and cells do.
    pub batches: &'a [Arc<OpBatch>],
    /// What units of work cost.
    pub costs: &'a Costs,
    /// The machine, whose FIFOs are sized.
    pub spec: &'a MachineSpec,
    /// What FIFOs of Z must hold at the least ([`Workload::least_z_words`](crate::program::Workload::least_z_words)).
    pub least_z_words: Words,
}

/// How fast machines are that are worth a look, each as the cycles that they may take more than with unlimited FIFOs, in
/// thousandths. At 1 % more the speed is 99 % at the least, and so on.
pub const SLOWER: [u64; 5] = [0, 1, 10, 50, 100];

/// Speeds in percent of that with unlimited FIFOs as the thousandths by which a run may be slower: each once, the fastest first. Those
/// of [`SLOWER`], if none is given.
///
/// # Errors
///
/// If a speed is none from 50 to 100 %, or has more than a decimal.
pub fn slower(percent: &[f64]) -> Result<Vec<u64>, InputError> {
    if percent.is_empty() {
        return Ok(SLOWER.to_vec());
    }
    let slower = |&percent: &f64| {
        let thousandths = (1000.0 - 10.0 * percent).round();
        let possible = (50.0..=100.0).contains(&percent) && (1000.0 - thousandths - 10.0 * percent).abs() < 1e-9;
        possible.then_some(thousandths as u64).ok_or_else(|| {
            let error = InputError::new(format!("a speed of {percent} % cannot be asked for"));
            error.help("speeds are from 50 to 100 %, with one decimal at the most")
        })
    };
    let all: BTreeSet<u64> = percent.iter().map(slower).collect::<Result<_, _>>()?;
    Ok(all.into_iter().collect())
}

/// The fewest words that were found for each speed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Front {
    /// The FIFOs that carry words, in the order of reports.
    pub fifos: Vec<FifoName>,
    /// What each must hold so that no word ever waits for room: with more, nothing changes. It is no more than can be simulated.
    pub unlimited: Depths,
    /// For each speed, the fastest first, depths of which none can be lowered by itself.
    pub points: Vec<Point>,
    /// All FIFOs as shallow as they can be, and what comes of it.
    pub least: (Vec<Words>, Fewer),
    /// How often the recording was timed.
    pub replays: u64,
}

/// Depths, and the time of the run with them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Depths {
    /// For each FIFO.
    pub words: Vec<Words>,
    /// Of the run.
    pub cycles: Cycles,
}

/// The fewest words for some speed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Point {
    /// By how many thousandths the run may take longer than with unlimited FIFOs.
    pub slower: u64,
    /// The depths.
    pub depths: Depths,
    /// For each FIFO, the run with one word fewer in that FIFO alone: none is as fast as is asked for. `None` where it holds the least
    /// already.
    pub fewer: Vec<Option<Fewer>>,
}

/// The run with too few words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fewer {
    /// It takes so long.
    Cycles(Cycles),
    /// It never ends.
    Stuck(Stuck),
}

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Searching {
    /// How often the recording has been timed.
    pub replays: u64,
    /// The points that are found.
    pub points: usize,
}

impl Depths {
    /// The cycles of a run that takes so many thousandths longer.
    fn slowed(&self, thousandths: u64) -> Cycles {
        let Cycles(cycles) = self.cycles;
        Cycles(cycles + (u128::from(cycles) * u128::from(thousandths) / 1000) as u64)
    }

    /// The words of all FIFOs together.
    pub fn total(&self) -> u64 {
        self.words.iter().map(|words| words.0).sum()
    }
}

impl Front {
    /// A machine with FIFOs of these depths.
    pub fn machine(&self, words: &[Words], like: &MachineFile) -> MachineFile {
        let depths = self.fifos.iter().zip(words).map(|(&fifo, words)| (fifo, words.0));
        MachineFile { fifo_words_of: depths.collect(), ..like.clone() }
    }
}

/// Sizes the FIFOs of a recorded run, on all cores, for some speeds ([`Point::slower`]). `note` is told after each run how far
/// that is.
///
/// # Errors
///
/// If the ops are none of such an array's, or never come to an end whatever the depths; and if it is told to stop.
pub fn size_fifos(
    recorded: Recorded<'_>,
    speeds: &[u64],
    cancel: &Cancel,
    note: impl Fn(Searching) + Sync,
) -> Result<Front, SizingError> {
    let (replays, found) = (AtomicU64::new(0), AtomicUsize::new(0));
    let timed = || {
        let replays = replays.fetch_add(1, Ordering::Relaxed) + 1;
        note(Searching { replays, points: found.load(Ordering::Relaxed) });
    };
    let mut search = Search::new(recorded, cancel, &timed);
    let unlimited = search.unlimited()?;
    let points = || {
        let mut points: Vec<Point> = Vec::new();
        for slower in speeds.iter().copied().collect::<BTreeSet<u64>>() {
            let faster = points.last().map(|point| point.depths.words.clone());
            let depths = search.fewest(&unlimited, slower, faster)?;
            points.push(Point { slower, fewer: search.one_fewer(&depths.words)?, depths });
            found.fetch_add(1, Ordering::Relaxed);
        }
        Ok::<_, SizingError>(points)
    };
    // The slowest run of all takes a while: beside the search, of which it is no part.
    let (points, least) = rayon::join(points, || search.fewer(&search.least));
    let (points, least) = (points?, (search.least.clone(), least?));
    let fifos = search.fifos.clone();
    Ok(Front { fifos, unlimited, points, least, replays: replays.load(Ordering::Relaxed) })
}

/// Why FIFOs cannot be sized.
pub type SizingError = RunError<Infallible>;
