//! The rays of a run in a random order, timed again: what is left of its losses if neighbours in the order have nothing in
//! common.

use std::convert::Infallible;
use std::sync::Arc;

use super::timed::{Watching, replay_watched};
use crate::cancel::Cancel;
use crate::machine::MachineSpec;
use crate::measure::{Measured, StateTimes};
use crate::random;
use crate::seam::{Costs, Op, OpBatch, OpKind};

/// Keeps what host and cells do for the rays of a run: for all of them as long as that is no more than [`Shuffled::MOST`], else for
/// as many as that is, drawn at random.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use pcs_sim::cancel::Cancel;
/// use pcs_sim::run::{self, Layers, PlannedRun, RunOptions, RunSpec, Shuffled, Workers};
///
/// let mut options = RunOptions::default();
/// for (name, value) in [("scene", "room"), ("size", "24x24"), ("mode", "broadcast"), ("cells", "4")] {
///     options.set(name, value)?;
/// }
/// let (planned, mut layers) = (PlannedRun::new(RunSpec::new(&options, None)?)?, Layers::default());
/// let workload = layers.workload(&planned, &Cancel::default())?;
/// let (rays, machine) = (&layers.prepared(&planned)?.rays, &planned.machine);
/// let mut shuffled = Shuffled::new(workload.cells());
/// let outcome = run::run(&workload, &machine.spec, rays, &Workers::new(2), |batch| {
///     shuffled.take(&batch.ops);
///     Ok::<(), std::io::Error>(())
/// })?;
/// let other = shuffled.time(&machine.spec, workload.costs(), &Cancel::default()).ok_or("it must end")?;
/// assert_eq!(other.stats.jobs, outcome.stats.jobs);
/// let works = |run: &pcs_sim::measure::Measured| run.topology.states.works(&run.stations[0]);
/// assert_eq!(works(&other.stats), works(&outcome.stats));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Shuffled {
    /// What the host does for the rays that are kept, then what each cell does, from left to right.
    streams: Vec<Kept>,
    /// The largest number in the random order that is kept.
    largest: u64,
    /// Whether the host waits for hits.
    waits: bool,
}

/// What one stream keeps.
#[derive(Debug, Default)]
struct Kept {
    ops: Vec<Op>,
    lines: Vec<KeptLine>,
    /// How many lines have been seen.
    seen: u64,
}

/// What is kept of a ray.
#[derive(Clone, Copy, Debug)]
struct KeptLine {
    /// Its number in the random order.
    key: u64,
    job: u32,
    /// Where its ops end.
    end: usize,
}

/// A run whose rays came in a random order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reordered {
    /// Where every cycle and word went.
    pub stats: Measured,
    /// Where each cell's cycles went until it had done the first ray.
    pub first: Vec<StateTimes>,
    /// Whether the host waited for hits, and was not let wait here.
    pub waits: bool,
}

/// The seed of the order.
const SEED: u64 = 0;

/// Rays that are timed together.
const BATCH: usize = 256;

impl Shuffled {
    /// The most ops and lines that are kept: some 8 Mbyte.
    pub const MOST: usize = 1 << 20;

    /// Keeps nothing yet of a run on so many cells.
    pub fn new(cells: usize) -> Shuffled {
        Shuffled { streams: (0..=cells).map(|_| Kept::default()).collect(), largest: u64::MAX, waits: false }
    }

    /// Takes the run's next ops.
    pub fn take(&mut self, batch: &OpBatch) {
        let waits = |op: &Op| op.kind() == OpKind::Await;
        for (job, ops) in batch.host.lines() {
            self.waits |= ops.iter().any(waits);
            self.streams[0].take(self.largest, job, ops.iter().copied().filter(|op| !waits(op)));
        }
        for (kept, cell) in self.streams[1..].iter_mut().zip(&batch.cells) {
            cell.lines().for_each(|(job, ops)| kept.take(self.largest, job, ops.iter().copied()));
        }
        while self.streams.iter().map(Kept::len).sum::<usize>() > Shuffled::MOST && self.largest > 0 {
            self.largest /= 2;
            self.streams.iter_mut().for_each(|kept| kept.thin(self.largest));
        }
    }

    /// Times the rays that are kept, all but the first in a random order. The host waits for no hits.
    ///
    /// `None` if the streams do not have the same rays in the same order, or if those that are kept do not come to an end without the
    /// others.
    pub fn time(&self, spec: &MachineSpec, costs: &Costs, cancel: &Cancel) -> Option<Reordered> {
        let lines = &self.streams[0].lines;
        let same = |kept: &Kept| kept.lines.iter().map(|line| line.job).eq(lines.iter().map(|line| line.job));
        if lines.is_empty() || !self.streams.iter().all(same) {
            return None;
        }
        let mut order: Vec<usize> = (0..lines.len()).collect();
        order.sort_by_key(|&ray| lines[ray].key);
        let mut first = None;
        let timed = replay_watched::<Infallible>(
            (spec, &Watching::default()),
            (costs, self.streams.len() - 1),
            cancel,
            |take| {
                let (alone, rest) = order.split_at(1);
                [alone].into_iter().chain(rest.chunks(BATCH)).try_for_each(|rays| take(Arc::new(self.batch(rays))))
            },
            |array| {
                first.get_or_insert_with(|| array.so_far().stations);
            },
        );
        let (stats, _) = timed.ok()?;
        Some(Reordered { stats, first: first?, waits: self.waits })
    }

    /// Some of the rays that are kept, as a batch.
    fn batch(&self, rays: &[usize]) -> OpBatch {
        let mut batch = OpBatch::new(self.streams.len() - 1);
        for &ray in rays {
            let streams = std::iter::once(&mut batch.host).chain(&mut batch.cells);
            streams.zip(&self.streams).for_each(|(stream, kept)| stream.push_line(ray as u32, kept.line(ray)));
        }
        batch
    }
}

impl Kept {
    /// Takes the next ray, unless its number in the random order is too large.
    fn take(&mut self, largest: u64, job: u32, ops: impl Iterator<Item = Op>) {
        // With the first ray stands what the cells do before any: it stays the first.
        let key = if self.seen == 0 { 0 } else { random::of_item(SEED, self.seen) };
        self.seen += 1;
        if key <= largest {
            self.ops.extend(ops);
            self.lines.push(KeptLine { key, job, end: self.ops.len() });
        }
    }

    /// Drops the rays with larger numbers.
    fn thin(&mut self, largest: u64) {
        let mut thinned = Kept { seen: self.seen, ..Kept::default() };
        for (ray, line) in self.lines.iter().enumerate().filter(|(_, line)| line.key <= largest) {
            thinned.ops.extend_from_slice(self.line(ray));
            thinned.lines.push(KeptLine { end: thinned.ops.len(), ..*line });
        }
        *self = thinned;
    }

    fn len(&self) -> usize {
        self.ops.len() + self.lines.len()
    }

    fn line(&self, ray: usize) -> &[Op] {
        let start = if ray == 0 { 0 } else { self.lines[ray - 1].end };
        &self.ops[start..self.lines[ray].end]
    }
}
