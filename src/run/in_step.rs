//! Rays traced once and timed on many machines in step with it, for recordings that find no room in memory.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;

use rayon::prelude::*;

use super::Workers;
use super::layers::{Layers, PlannedRun, costs_on};
use super::recording_memory::RecordingMemory;
use super::timed::{RunError, UNLIMITED, Watching};
use super::trace::trace;
use crate::geometry::Ray;
use crate::machine::{Array, Cycles, Machine};
use crate::measure::Measured;
use crate::program::{Counts, Workload};
use crate::seam::OpBatch;

/// What rays come to on several machines.
#[derive(Debug)]
pub struct InStep {
    /// What the arrays had to do.
    pub workload: Workload,
    /// What was counted.
    pub counts: Counts,
    /// What was measured on each machine, or why it could go no further.
    pub times: Vec<Result<Measured, RunError<Infallible>>>,
    /// How often the rays were traced.
    pub rounds: usize,
}

/// What an array takes beside its FIFOs and its answers, about: the batches on their way through it, in bytes.
const BATCHES_BYTES: u64 = 1 << 20;

/// A machine that has not been timed yet: its number, and the cycle in which its statistics end, if that is known.
#[derive(Clone, Copy)]
struct Todo {
    machine: usize,
    limit: Cycles,
}

/// One of the arrays.
struct Lane {
    of: Todo,
    array: Array,
    failed: Option<RunError<Infallible>>,
}

impl Layers {
    /// Times a run on machines that all have its [`Keys::traced`](super::Keys): as [`Traced::time`](super::Traced::time)
    /// does on each, but without a recording. Each batch of rays goes to all arrays as soon as it is traced; where there are more
    /// of these than the memory has room for, the rays are traced again for the next.
    ///
    /// # Errors
    ///
    /// As [`Layers::traced`].
    pub fn timed_in_step(
        &mut self,
        run: &PlannedRun,
        machines: &[&Machine],
        workers: &Workers,
        memory: RecordingMemory,
    ) -> Result<InStep, RunError<Infallible>> {
        let workload = self.workload(run, &workers.cancel)?;
        let rays = &self.prepared(run)?.rays;
        let checked = |machine: &&Machine| {
            workload.check(&machine.spec)?;
            machine.spec.check_fifos(workload.cells()).map_err(RunError::from)
        };
        let mut times: Vec<_> = machines.iter().map(|machine| checked(machine).err().map(Err)).collect();
        let mut todo: VecDeque<Todo> = (0..machines.len())
            .filter(|&machine| times[machine].is_none())
            .map(|machine| Todo { machine, limit: UNLIMITED })
            .collect();
        let (mut counts, mut rounds) = (Counts::default(), 0);
        // A fault of a cell's program is told even if no machine can run the ops.
        while rounds == 0 || !todo.is_empty() {
            let mut lanes = lanes(&mut todo, machines, &workload, (rays.len(), workers.threads, memory));
            counts = pass(&workload, rays, &mut lanes, workers)?;
            rounds += 1;
            for Lane { of, array, failed, .. } in lanes {
                match failed.map_or_else(|| array.finish().map_err(RunError::from), Err) {
                    // The statistics end with the last hit, whatever a cell does after it.
                    Err(RunError::Outlived(limit)) if of.limit == UNLIMITED => todo.push_back(Todo { limit, ..of }),
                    ended => times[of.machine] = Some(ended),
                }
            }
        }
        Ok(InStep { workload, counts, times: times.into_iter().flatten().collect(), rounds })
    }
}

/// The arrays that the next round has room for: at least one a thread.
fn lanes(
    todo: &mut VecDeque<Todo>,
    machines: &[&Machine],
    workload: &Workload,
    (rays, threads, memory): (usize, usize, RecordingMemory),
) -> Vec<Lane> {
    let (mut lanes, mut bytes) = (Vec::new(), 0);
    while let Some(of) = todo.pop_front() {
        let machine = machines[of.machine];
        let costs = &costs_on(machine, workload);
        let array = Watching::default().array(&machine.spec, costs, workload.cells(), of.limit);
        bytes += array.bytes() + BATCHES_BYTES + (rays * size_of::<u64>()) as u64;
        if bytes > memory.0 && lanes.len() >= threads {
            todo.push_front(of);
            break;
        }
        lanes.push(Lane { of, array, failed: None });
    }
    lanes
}

/// Traces the rays once, and takes all arrays through their ops.
fn pass(
    workload: &Workload,
    rays: &[Ray],
    lanes: &mut [Lane],
    workers: &Workers,
) -> Result<Counts, RunError<Infallible>> {
    let mut counts = Counts::default();
    trace(workload, rays, workers, |mut batch| {
        workers.cancel.check()?;
        batch.fault.take().map_or(Ok(()), Err)?;
        counts += batch.counts;
        let ops = Arc::new(std::mem::take(&mut batch.ops));
        lanes.par_iter_mut().for_each(|lane| lane.take(&ops));
        batch.ops = Arc::try_unwrap(ops).unwrap_or_default();
        Ok::<_, RunError<Infallible>>(batch)
    })?;
    Ok(counts)
}

impl Lane {
    /// Works out the times of the next ops, unless the array can go no further.
    fn take(&mut self, ops: &Arc<OpBatch>) {
        if self.failed.is_some() {
            return;
        }
        let fed = self.array.feed(Arc::clone(ops)).map_err(RunError::from);
        self.failed = fed.and_then(|()| Ok(self.array.run()?)).err();
        // What it was the last to have is not filled again.
        drop(self.array.take_spent());
    }
}
