//! What host and cells do, kept in memory to be timed under FIFOs of all depths.

use std::convert::Infallible;
use std::sync::Arc;

use super::timed::RunError;
use super::{PlannedRun, Recorded, Replay, Traced};
use crate::cancel::Cancel;
use crate::machine::{Machine, MachineFile, Words};
use crate::seam::{Costs, OpBatch};

/// The ops of a run that was traced, or of a trace that was read, with the machine whose FIFOs are sized.
#[derive(Debug)]
pub struct KeptOps {
    ops: Ops,
    costs: Costs,
    least_z_words: Words,
    /// The machine.
    pub machine: Machine,
    /// What its file has.
    pub file: MachineFile,
}

#[derive(Debug)]
enum Ops {
    Traced(Arc<Traced>),
    Read(Vec<Arc<OpBatch>>),
}

impl KeptOps {
    /// Those of a run that was traced.
    pub fn of_run(run: PlannedRun, traced: Arc<Traced>) -> KeptOps {
        let workload = traced.workload();
        KeptOps {
            costs: workload.costs().clone(),
            least_z_words: workload.least_z_words(),
            ops: Ops::Traced(traced),
            machine: run.machine,
            file: run.spec.machine,
        }
    }

    /// Reads all of a trace.
    ///
    /// # Errors
    ///
    /// If it cannot be read again, and if it is told to stop.
    pub fn of_trace(mut replay: Replay, cancel: &Cancel) -> Result<KeptOps, RunError<Infallible>> {
        let mut batches = Vec::new();
        replay.trace.for_each_batch(|batch| {
            cancel.check()?;
            batches.push(Arc::new(batch));
            Ok::<_, RunError<Infallible>>(())
        })?;
        let Replay { spec, machine, costs, .. } = replay;
        Ok(KeptOps { ops: Ops::Read(batches), costs, least_z_words: Words(1), machine, file: spec.machine })
    }

    /// The same, to be sized.
    pub fn recorded(&self) -> Recorded<'_> {
        let batches = match &self.ops {
            Ops::Traced(traced) => traced.batches(),
            Ops::Read(batches) => batches,
        };
        Recorded { batches, costs: &self.costs, spec: &self.machine.spec, least_z_words: self.least_z_words }
    }
}
