//! A whole run: the functional half on all threads, ahead of the timing half that takes its ops in order.

use std::ops::Range;
use std::sync::Arc;

use super::{TracedBatch, Workers, trace};
use crate::cancel::{Cancel, Cancelled};
use crate::error::InputError;
use crate::geometry::{Hit, Ray};
use crate::isa::Fault;
use crate::machine::events::Standstill;
use crate::machine::{Array, Cycles, MachineSpec, Observed, Stuck, Unfinished};
use crate::measure::{CriticalPath, Measured, Recording, When};
use crate::program::{Counts, NotLaidOut, Workload};
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

/// What of an array is watched over time, beside what is always measured.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Watching {
    /// Whether a profile is asked for.
    pub profile: bool,
    /// The cycles of which a recording is asked for.
    pub recording: Option<Range<Cycles>>,
    /// Whether the critical path is asked for.
    pub path: bool,
    /// The cycle that is to be looked at, if one is; the path is then found too.
    pub moment: Option<When>,
    /// Whether each FIFO's depth is asked for from which nothing changes any more.
    pub enough: bool,
    /// Whether it is asked for when each job was begun and done.
    pub spans: bool,
}

impl Watching {
    /// What is to be watched in a second run, if the cycle to be looked at had to be found first.
    fn again(&self, observed: &Observed) -> Option<Watching> {
        let at = observed.looked_at.filter(|_| observed.snapshot.is_none())?;
        Some(Watching { moment: Some(When::Cycle(at)), ..self.clone() })
    }

    /// An array that is watched so, in which nothing happens in cycle `limit` or later.
    pub(super) fn array(&self, spec: &MachineSpec, costs: &Costs, cells: usize, limit: Cycles) -> Array {
        let array = Array::until(spec, costs, cells, limit);
        let array = if self.profile { array.probed() } else { array };
        let array = if self.enough { array.beside_unlimited(spec, costs) } else { array };
        let array = if self.spans { array.noting_spans() } else { array };
        let explained = self.path || self.moment.is_some();
        let array = if explained { array.explained(CriticalPath::MOST_OPS) } else { array };
        let array = match self.moment {
            Some(when) => array.looking_at(when),
            None => array,
        };
        match &self.recording {
            Some(window) => array.recorded(window.clone(), Recording::MOST_EVENTS),
            None => array,
        }
    }
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
    /// The tasks of a farm can go no further.
    #[error(transparent)]
    Standstill(#[from] Standstill),
    /// The nodes of a hypercube can go no further.
    #[error(transparent)]
    Nodes(#[from] crate::program::cube::Stuck),
    /// The ops are none of such an array's.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// Some cell works on after the host of an image has read its last word, so that its statistics have no end.
    #[error("some cell works on after the host has read the last hit in cycle {0}, which ends an image")]
    Outlived(Cycles),
    /// It was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// `observe` failed.
    #[error("{0}")]
    Observer(E),
}

impl<E> From<NotLaidOut> for RunError<E> {
    fn from(not: NotLaidOut) -> RunError<E> {
        match not {
            NotLaidOut::Unfit(error) => RunError::Unfit(error),
            NotLaidOut::Cancelled(cancelled) => RunError::Cancelled(cancelled),
        }
    }
}

impl<E> From<Unfinished> for RunError<E> {
    fn from(unfinished: Unfinished) -> RunError<E> {
        match unfinished {
            Unfinished::Stuck(stuck) => RunError::Stuck(stuck),
            Unfinished::Outlived(cycles) => RunError::Outlived(cycles),
        }
    }
}

/// No limit to the cycles of an array.
pub(super) const UNLIMITED: Cycles = Cycles(u64::MAX);

/// Runs rays through an array: every cycle is accounted for, and the outcome does not depend on the number of threads.
///
/// `observe` sees each batch of rays once, in order, before it is timed: for progress, or to keep the ops.
///
/// # Errors
///
/// If the machine cannot run the workload ([`Workload::check`]); if the array or a cell's program cannot go on; if
/// `observe` fails; and if it is told to stop.
pub fn run<E>(
    workload: &Workload,
    spec: &MachineSpec,
    rays: &[Ray],
    workers: &Workers,
    mut observe: impl FnMut(&TracedBatch) -> Result<(), E>,
) -> Result<Outcome, RunError<E>> {
    run_watched(workload, (spec, &Watching::default()), rays, workers, |batch, _| observe(batch))
}

/// The same in an array that is watched over time. `observe` sees it as it is before the batch.
pub fn run_watched<E>(
    workload: &Workload,
    (spec, watching): (&MachineSpec, &Watching),
    rays: &[Ray],
    workers: &Workers,
    mut observe: impl FnMut(&TracedBatch, &Array) -> Result<(), E>,
) -> Result<Outcome, RunError<E>> {
    workload.check(spec)?;
    let array = |watching: &Watching, limit| watching.array(spec, workload.costs(), workload.cells(), limit);
    let (mut counts, mut hits) = (Counts::default(), Vec::with_capacity(rays.len()));
    let mut result = run_in(array(watching, UNLIMITED), workload, rays, workers, |batch, array| {
        observe(batch, array).map_err(RunError::Observer)?;
        counts += batch.counts;
        hits.append(&mut batch.hits);
        Ok(())
    })?;
    // The statistics end with the last hit, whatever a cell does after it.
    let mut limit = UNLIMITED;
    if let Err(Unfinished::Outlived(cycles)) = result {
        limit = cycles;
        result = run_in(array(watching, limit), workload, rays, workers, |_, _| Ok(()))?;
    }
    if let Some(again) = result.as_ref().ok().and_then(|(_, observed)| watching.again(observed)) {
        result = run_in(array(&again, limit), workload, rays, workers, |_, _| Ok(()))?;
    }
    let (stats, observed) = result?;
    Ok(Outcome { stats, counts, hits, observed })
}

/// What an array has measured at its end, if it has come to one.
type Ended = Result<(Measured, Observed), Unfinished>;

/// Traces rays and times them in a new array.
fn run_in<E>(
    mut array: Array,
    workload: &Workload,
    rays: &[Ray],
    workers: &Workers,
    mut take: impl FnMut(&mut TracedBatch, &Array) -> Result<(), RunError<E>>,
) -> Result<Ended, RunError<E>> {
    trace(workload, rays, workers, |mut batch| {
        workers.cancel.check()?;
        batch.fault.take().map_or(Ok(()), Err)?;
        take(&mut batch, &array)?;
        array.feed(std::mem::take(&mut batch.ops))?;
        array.run()?;
        batch.ops = array.take_spent().unwrap_or_default();
        Ok::<_, RunError<E>>(batch)
    })?;
    Ok(array.finish_observed())
}

/// Takes the next batch of ops.
pub type TakeBatch<'a, E> = dyn FnMut(Arc<OpBatch>) -> Result<(), RunError<E>> + 'a;

/// Times ops: `feed` hands them, from their start, batch by batch to the function that it is given. `feed` is called again if some
/// cell works on after the host has read its last word, which ends the statistics.
///
/// # Errors
///
/// If the ops are none of such an array's, or never come to an end; if the machine has depths for FIFOs that are none of the array's; if
/// `feed` fails.
pub fn replay<E>(
    spec: &MachineSpec,
    costs: &Costs,
    cells: usize,
    cancel: &Cancel,
    feed: impl FnMut(&mut TakeBatch<'_, E>) -> Result<(), RunError<E>>,
) -> Result<Measured, RunError<E>> {
    Ok(replay_watched((spec, &Watching::default()), (costs, cells), cancel, feed, |_| ())?.0)
}

/// The same in an array that is watched over time. `observe` sees it after each batch.
pub fn replay_watched<E>(
    (spec, watching): (&MachineSpec, &Watching),
    (costs, cells): (&Costs, usize),
    cancel: &Cancel,
    mut feed: impl FnMut(&mut TakeBatch<'_, E>) -> Result<(), RunError<E>>,
    mut observe: impl FnMut(&Array),
) -> Result<(Measured, Observed), RunError<E>> {
    spec.check_fifos(cells)?;
    let mut attempt = |watching: &Watching, limit: Cycles| {
        let mut array = watching.array(spec, costs, cells, limit);
        feed(&mut |batch| {
            cancel.check()?;
            array.feed(batch)?;
            array.run()?;
            observe(&array);
            // Its memory is given back, as nothing here fills another.
            drop(array.take_spent());
            Ok(())
        })?;
        Ok::<_, RunError<E>>(array.finish_observed())
    };
    let mut limit = UNLIMITED;
    let mut result = attempt(watching, limit)?;
    if let Err(Unfinished::Outlived(cycles)) = result {
        limit = cycles;
        result = attempt(watching, limit)?;
    }
    if let Some(again) = result.as_ref().ok().and_then(|(_, observed)| watching.again(observed)) {
        result = attempt(&again, limit)?;
    }
    Ok(result?)
}
