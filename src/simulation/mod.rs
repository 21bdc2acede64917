//! A whole run: the functional half on all threads, ahead of the timing half that takes its ops in order.

mod ahead;
mod closed_loop;
mod render;
mod trees;

pub use closed_loop::{HostRules, Policy};
pub use render::{KindLatencies, Picture, Rendered, Seen, Timing, render};
pub use trees::{ByKind, KindCounts};

use std::ops::RangeInclusive;

use crate::error::InputError;
use crate::geometry::{Hit, Ray};
use crate::isa::Fault;
use crate::machine::{Array, Cycles, MachineSpec, Observed, Stuck, Unfinished};
use crate::measure::Measured;
use crate::program::{Counts, Tracer, Workload};
use crate::seam::{BatchError, Costs, OpBatch};

/// What a run gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Where every cycle and word went.
    pub stats: Measured,
    /// How often the kernels did their work.
    pub counts: Counts,
    /// Each ray's first hit, in the order of the rays.
    pub hits: Vec<Hit>,
    /// What the array's observers saw.
    pub observed: Observed,
}

/// Some consecutive rays, traced.
#[derive(Debug, Default)]
pub struct TracedBatch {
    /// What the host and every cell do for them.
    pub ops: OpBatch,
    /// Their hits.
    pub hits: Vec<Hit>,
    /// What was counted on them.
    pub counts: Counts,
    /// The first fault of a cell's program on them.
    pub fault: Option<Fault>,
}

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError<E> {
    /// The array can go no further.
    #[error(transparent)]
    Stuck(#[from] Stuck),
    /// A cell's program cannot go on.
    #[error(transparent)]
    Fault(#[from] Fault),
    /// The array program does not go with what is to be run.
    #[error(transparent)]
    Unfit(#[from] InputError),
    /// The ops are none of such an array's.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// `observe` failed.
    #[error("{0}")]
    Observer(E),
}

/// Runs rays through an array: every cycle is accounted for, and the outcome does not depend on `threads`.
///
/// `observe` sees each batch of rays, in order, before it is timed: for progress, or to keep the ops.
pub fn run<E>(
    workload: &Workload,
    spec: &MachineSpec,
    rays: &[Ray],
    threads: usize,
    mut observe: impl FnMut(&TracedBatch) -> Result<(), E>,
) -> Result<Outcome, RunError<E>> {
    workload.check(spec)?;
    run_in(Array::new(spec, workload.costs(), workload.cells()), workload, rays, threads, |batch, _| observe(batch))
}

/// The same in an array of the caller's, which may have observers. `observe` sees it as it is before the batch.
pub fn run_in<E>(
    mut array: Array,
    workload: &Workload,
    rays: &[Ray],
    threads: usize,
    mut observe: impl FnMut(&TracedBatch, &Array) -> Result<(), E>,
) -> Result<Outcome, RunError<E>> {
    let mut counts = Counts::default();
    let mut hits = Vec::with_capacity(rays.len());
    trace(workload, rays, threads, |mut batch| {
        batch.fault.take().map_or(Ok(()), Err)?;
        observe(&batch, &array).map_err(RunError::Observer)?;
        counts += batch.counts;
        hits.append(&mut batch.hits);
        array.feed(std::mem::take(&mut batch.ops))?;
        array.run()?;
        batch.ops = array.take_spent().unwrap_or_default();
        Ok::<_, RunError<E>>(batch)
    })?;
    let (stats, observed) = array.finish_observed().map_err(|unfinished| match unfinished {
        Unfinished::Stuck(stuck) => stuck,
        // No array program has a cell work on after the last hit has left the array.
        Unfinished::Outlived(cycles) => unreachable!("a cell outlived the last hit in cycle {cycles}"),
    })?;
    Ok(Outcome { stats, counts, hits, observed })
}

/// Times a trace: `feed` hands it, from its start, batch by batch to the function that it is given. It is called again if
/// some cell works on after the host has read its last word, which ends the statistics.
pub fn replay<E: From<Stuck> + From<BatchError>>(
    spec: &MachineSpec,
    costs: &Costs,
    cells: usize,
    feed: impl FnMut(&mut dyn FnMut(OpBatch) -> Result<(), E>) -> Result<(), E>,
) -> Result<Measured, E> {
    Ok(replay_in(|limit| Array::until(spec, costs, cells, limit), feed, |_| ())?.0)
}

/// The same in arrays that `array` makes, for the limit that it is given, and what their observers saw.
/// `observe` sees the array after each batch.
pub fn replay_in<E: From<Stuck> + From<BatchError>>(
    array: impl Fn(Cycles) -> Array,
    mut feed: impl FnMut(&mut dyn FnMut(OpBatch) -> Result<(), E>) -> Result<(), E>,
    mut observe: impl FnMut(&Array),
) -> Result<(Measured, Observed), E> {
    let mut attempt = |limit: Cycles| {
        let mut array = array(limit);
        feed(&mut |batch| {
            array.feed(batch)?;
            array.run()?;
            observe(&array);
            Ok(())
        })?;
        Ok::<_, E>(array.finish_observed())
    };
    let mut result = attempt(Cycles(u64::MAX))?;
    if let Err(Unfinished::Outlived(cycles)) = result {
        result = attempt(cycles)?;
    }
    result.map_err(|unfinished| match unfinished {
        Unfinished::Stuck(stuck) => stuck.into(),
        Unfinished::Outlived(cycles) => unreachable!("nothing happens after the limit of {cycles}"),
    })
}

/// The functional half alone: traces the rays in batches on all threads and hands the batches to `take` in order. `take`
/// gives back a batch whose memory may be used again.
pub fn trace<E>(
    workload: &Workload,
    rays: &[Ray],
    threads: usize,
    take: impl FnMut(TracedBatch) -> Result<TracedBatch, E>,
) -> Result<(), E> {
    let per_batch = (BATCH_LINES / workload.cells()).clamp(*RAYS_PER_BATCH.start(), *RAYS_PER_BATCH.end());
    let first = |index: usize| index * per_batch;
    let make = |tracer: &mut Tracer<'_>, index: usize, mut batch: TracedBatch| {
        batch.reset(workload.cells());
        if index == 0 {
            batch.ops = workload.opening();
        }
        let some = &rays[first(index)..rays.len().min(first(index + 1))];
        for (id, ray) in (first(index) as u32..).zip(some) {
            batch.hits.push(tracer.trace(id, rays.len(), ray, &mut batch.ops));
        }
        batch.counts = std::mem::take(&mut tracer.counts);
        batch.fault = tracer.fault.take();
        batch
    };
    ahead::in_order(rays.len().div_ceil(per_batch), threads, || Tracer::new(workload), make, take)
}

/// Lines of ops (one a ray and cell) that a batch has at about the most: small enough to stay in a core's cache.
const BATCH_LINES: usize = 4096;

/// Rays of a batch, whatever the number of cells: fewer are not worth handing over between threads, and with more of them
/// short runs would keep one thread busy and the others not.
const RAYS_PER_BATCH: RangeInclusive<usize> = 16..=1024;

impl TracedBatch {
    /// Empties the batch, for an array of `cells` cells.
    fn reset(&mut self, cells: usize) {
        if self.ops.cells.len() != cells {
            self.ops = OpBatch::new(cells);
        }
        self.ops.clear();
        self.hits.clear();
    }
}
