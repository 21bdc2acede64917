//! The functional half of a run of primary rays: traced in batches on all threads.

use super::{Workers, ahead};
use crate::geometry::{Hit, Ray};
use crate::isa::Fault;
use crate::program::{Counts, Tracer, Workload};
use crate::seam::OpBatch;

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

/// The functional half alone: traces the rays in batches on all threads and hands the batches to `take` in order. `take`
/// gives back a batch whose memory may be used again.
pub fn trace<E>(
    workload: &Workload,
    rays: &[Ray],
    workers: &Workers,
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
    ahead::in_order(rays.len().div_ceil(per_batch), workers.threads, || Tracer::new(workload), make, take)
}

/// Lines of ops (one a ray and cell) that a batch has at about the most: small enough to stay in a core's cache.
pub(super) const BATCH_LINES: usize = 4096;

/// Rays of a batch, whatever the number of cells: fewer are not worth handing over between threads, and with more of them
/// short runs would keep one thread busy and the others not.
const RAYS_PER_BATCH: std::ops::RangeInclusive<usize> = 16..=1024;

impl TracedBatch {
    /// Empties the batch, for an array of `cells` cells.
    pub(super) fn reset(&mut self, cells: usize) {
        if self.ops.cells.len() != cells {
            self.ops = OpBatch::new(cells);
        }
        self.ops.clear();
        self.hits.clear();
    }
}
