//! The rays of a run in a random order, timed again: what is left of its losses if neighbours in the order have nothing in
//! common.

use std::convert::Infallible;

use super::timed::{Watching, replay_watched};
use super::{Cancel, RunError};
use crate::machine::MachineSpec;
use crate::measure::{Measured, StateTimes};
use crate::random;
use crate::seam::{Costs, Op, OpBatch, OpKind, OpStream};

/// Keeps what host and cells do for the rays of a run: for all of them as long as that is no more than [`Shuffled::MOST`], else for
/// as many as that is, drawn at random.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use pcs_sim::run::{self, Cancel, RunOptions, RunSpec, Shuffled, Workers};
///
/// let mut options = RunOptions::default();
/// for (name, value) in [("scene", "room"), ("size", "24x24"), ("mode", "broadcast"), ("cells", "4")] {
///     options.set(name, value)?;
/// }
/// let spec = RunSpec::new(&options, None)?;
/// let machine = spec.machine.build()?;
/// let scene = spec.load_scene()?;
/// let rays = spec.load_rays(&scene)?;
/// let workload = spec.lay_out(&scene, &machine, &rays)?;
/// let mut shuffled = Shuffled::new(workload.cells());
/// let outcome = run::run(&workload, &machine.spec, &rays, &Workers::new(2), |batch| {
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
    /// How many cells there are, and the host.
    streams: usize,
    /// What is done for the rays that are kept, one after the other: by the host, then by each cell from left to right.
    ops: Vec<Op>,
    /// Where each of these streams ends.
    ends: Vec<usize>,
    /// For each ray that is kept, its number in the random order.
    keys: Vec<u64>,
    /// Rays with larger ones are not kept.
    largest: u64,
    /// How many rays have been seen.
    rays: u64,
    /// Whether the host waits for hits.
    waits: bool,
    /// Whether some batch had no whole rays, so that nothing can be said.
    torn: bool,
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
    /// The most ops, and ends of streams, that are kept: some 40 Mbyte.
    pub const MOST: usize = 1 << 22;

    /// Keeps nothing yet of a run on so many cells.
    pub fn new(cells: usize) -> Shuffled {
        Shuffled {
            streams: cells + 1,
            ops: Vec::new(),
            ends: Vec::new(),
            keys: Vec::new(),
            largest: u64::MAX,
            rays: 0,
            waits: false,
            torn: false,
        }
    }

    /// Takes the run's next ops.
    pub fn take(&mut self, batch: &OpBatch) {
        let lines = batch.host.lines().len();
        self.torn |= batch.cells.len() + 1 != self.streams || batch.cells.iter().any(|cell| cell.lines().len() != lines);
        if !self.torn {
            (0..lines).for_each(|line| self.take_ray(batch, line));
        }
    }

    fn take_ray(&mut self, batch: &OpBatch, line: usize) {
        // With the first ray stands what the cells do before any: it stays the first.
        let key = if self.rays == 0 { 0 } else { random::of_item(SEED, self.rays) };
        self.rays += 1;
        if key > self.largest {
            return;
        }
        self.keys.push(key);
        let kept = self.ops.len();
        self.ops.extend(batch.host.line(line).iter().filter(|op| op.kind() != OpKind::Await));
        self.waits |= self.ops.len() - kept < batch.host.line(line).len();
        self.ends.push(self.ops.len());
        for cell in &batch.cells {
            self.ops.extend_from_slice(cell.line(line));
            self.ends.push(self.ops.len());
        }
        while self.ops.len() + self.ends.len() > Shuffled::MOST && self.keys.len() > 1 {
            self.halve();
        }
    }

    /// Drops about every second ray.
    fn halve(&mut self) {
        self.largest /= 2;
        let mut kept = Shuffled { largest: self.largest, ..Shuffled::new(self.streams - 1) };
        for ray in (0..self.keys.len()).filter(|&ray| self.keys[ray] <= self.largest) {
            kept.keys.push(self.keys[ray]);
            for stream in 0..self.streams {
                kept.ops.extend_from_slice(self.stream(ray, stream));
                kept.ends.push(kept.ops.len());
            }
        }
        let Shuffled { ops, ends, keys, .. } = kept;
        (self.ops, self.ends, self.keys) = (ops, ends, keys);
    }

    fn stream(&self, ray: usize, stream: usize) -> &[Op] {
        let index = ray * self.streams + stream;
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.ops[start..self.ends[index]]
    }

    /// How many rays are kept.
    pub fn kept(&self) -> usize {
        self.keys.len()
    }

    /// Times the rays that are kept, all but the first in a random order. The host waits for no hits.
    ///
    /// `None` if they cannot be told apart, as in a trace whose lines are not sorted by rays, or if they do not come to an end without
    /// the others.
    pub fn time(&self, spec: &MachineSpec, costs: &Costs, cancel: &Cancel) -> Option<Reordered> {
        if self.torn || self.keys.is_empty() {
            return None;
        }
        let mut order: Vec<usize> = (0..self.keys.len()).collect();
        order.sort_by_key(|&ray| self.keys[ray]);
        let mut first = None;
        let timed = replay_watched::<Infallible>(
            (spec, &Watching::default()),
            (costs, self.streams - 1),
            cancel,
            |take| {
                let mut batch = OpBatch::default();
                let (alone, rest) = order.split_at(1);
                [alone].into_iter().chain(rest.chunks(BATCH)).try_for_each(|rays| {
                    self.fill(&mut batch, rays);
                    batch = take(std::mem::take(&mut batch))?;
                    Ok::<_, RunError<Infallible>>(())
                })
            },
            |array| {
                first.get_or_insert_with(|| array.so_far().stations);
            },
        );
        let (stats, _) = timed.ok()?;
        Some(Reordered { stats, first: first?, waits: self.waits })
    }

    /// Fills an empty batch with some of the rays that are kept.
    fn fill(&self, batch: &mut OpBatch, rays: &[usize]) {
        batch.cells.resize_with(self.streams - 1, OpStream::default);
        for &ray in rays {
            batch.host.push_line(ray as u32, self.stream(ray, 0));
            for (cell, stream) in batch.cells.iter_mut().zip(1..) {
                cell.push_line(ray as u32, self.stream(ray, stream));
            }
        }
    }
}
