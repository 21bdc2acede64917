//! A replay, ready: a recorded trace, the machine, and what the trace's units of work cost there.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::moot;
use super::options::RunOptions;
use super::shuffled::Shuffled;
use super::spec::{ReplaySpec, machine_file};
use super::timed::{RunError, TakeBatch, Watching, replay_watched};
use crate::cancel::Cancel;
use crate::error::InputError;
use crate::isa::kernels::FLOAT_LATENCY;
use crate::isa::{Class, InstructionCycles};
use crate::machine::{Array, Machine, MachineFile, Observed};
use crate::measure::Measured;
use crate::program::work;
use crate::quantities::Cycles;
use crate::seam::activity_trace::{ActivityTrace, Form};
use crate::seam::{Costs, Vocabulary};

/// A trace that can be timed, any number of times.
#[derive(Debug)]
pub struct Replay {
    /// What is replayed.
    pub spec: ReplaySpec,
    /// On what.
    pub machine: Machine,
    /// The trace.
    pub trace: ActivityTrace,
    /// What its units of work cost.
    pub costs: Costs,
}

impl Replay {
    /// The trace that a replay is of: `ops`, or that of `base`. Empty if there is neither.
    pub fn ops_of(ops: Option<&Path>, base: Option<&ReplaySpec>) -> PathBuf {
        ops.or(base.map(|base| base.ops.as_path())).unwrap_or(Path::new("")).to_owned()
    }

    /// Opens the trace `ops`, or that of `base`, for `machine`, or that of `base`, with the changes of `options`.
    ///
    /// # Errors
    ///
    /// If a file cannot be read, if the machine is impossible, and if an option is without effect.
    pub fn new(
        ops: Option<&Path>,
        options: &RunOptions,
        base: Option<&ReplaySpec>,
        machine: Option<MachineFile>,
    ) -> Result<Replay, InputError> {
        let is_named = machine.is_some() || options.machine_file.machine.is_some();
        let file = machine_file(options, machine.as_ref().or(base.map(|base| &base.machine)))?;
        let machine = file.build()?;
        let ops = Replay::ops_of(ops, base);
        let trace = ActivityTrace::open(&ops, &work::cycles_vocabulary())?;
        let costs = costs((options, is_named), base, &machine, &trace)?;
        let unit_cycles = match trace.form() {
            Form::Units => costs.by_name().map(|(name, cycles)| (name.to_owned(), cycles.0)).collect(),
            Form::Cycles => BTreeMap::new(),
        };
        let spec = ReplaySpec { version: env!("CARGO_PKG_VERSION").to_owned(), ops, unit_cycles, machine: file };
        Ok(Replay { spec, machine, trace, costs })
    }

    /// Times the trace, and keeps what another order of its rays is timed by. `observe` sees the array after each batch.
    ///
    /// # Errors
    ///
    /// If the trace is none of such an array's or cannot be read again, if the array can go no further, and if it is told
    /// to stop.
    pub fn time(
        &mut self,
        watching: &Watching,
        cancel: &Cancel,
        observe: impl FnMut(&Array),
    ) -> Result<(Measured, Observed, Shuffled), RunError<Infallible>> {
        let Replay { machine, trace, costs, .. } = self;
        let cells = trace.cells();
        let mut shuffled = Shuffled::new(cells);
        let feed = |take: &mut TakeBatch<'_, Infallible>| {
            shuffled = Shuffled::new(cells);
            trace.for_each_batch(|batch| {
                shuffled.take(&batch);
                take(Arc::new(batch))
            })
        };
        let (stats, observed) = replay_watched((&machine.spec, watching), (costs, cells), cancel, feed, observe)?;
        Ok((stats, observed, shuffled))
    }
}

/// What the trace's units cost: what they did when it was recorded, or in the replay that is repeated, but for what the
/// machine's file and the options say.
fn costs(
    (options, is_named): (&RunOptions, bool),
    base: Option<&ReplaySpec>,
    machine: &Machine,
    trace: &ActivityTrace,
) -> Result<Costs, InputError> {
    let recorded = trace.costs();
    if trace.form() == Form::Cycles {
        moot::check_replay_of_cycles(options)?;
        return Ok(recorded.clone());
    }
    if is_named {
        check_waits(recorded.vocabulary(), machine.instructions.as_ref())?;
    }
    let asked = |name: &str| is_named || moot::prices(options, name);
    let price = |name: &str| work::price(name, &machine.times, machine.instructions.as_ref());
    Ok(Costs::new(recorded.vocabulary().clone(), |unit| {
        let name = recorded.vocabulary().unit(unit).map_or("", |unit| unit.name.as_str());
        let before = base.and_then(|base| base.unit_cycles.get(name)).map(|&cycles| Cycles(cycles));
        price(name).filter(|_| asked(name)).or(before).unwrap_or(recorded.of(unit))
    }))
}

/// Refuses a machine whose floating-point results have a latency, for a trace of instructions that does not count what waits for
/// them.
pub(super) fn check_waits(recorded: &Vocabulary, instructions: Option<&InstructionCycles>) -> Result<(), InputError> {
    let waits = instructions.and_then(|cycles| cycles.float_latency).is_some_and(|latency| latency > 0);
    let has = |name: &str| recorded.units.iter().any(|unit| unit.name == name);
    if !waits || has(FLOAT_LATENCY) || !has(Class::FloatAdd.name()) {
        return Ok(());
    }
    let error = InputError::new(
        "the trace counts no waits for floating-point results, which have a float_latency on this machine",
    );
    Err(error.help("record it on a machine with a float_latency; 0 will do"))
}
