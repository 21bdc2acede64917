//! What a recorded run takes on the machines that make Figure 7 as well: how far what is not determined matters.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;

use super::replayed::check_waits;
use super::timed::{RunError, TakeBatch, replay};
use crate::cancel::Cancel;
use crate::error::InputError;
use crate::isa::kernels::FLOAT_LATENCY;
use crate::isa::{Class, InstructionCycles};
use crate::machine::Machine;
use crate::program::figure7::fits::{Fit, WITHIN_PERCENT};
use crate::quantities::Cycles;
use crate::seam::activity_trace::{ActivityTrace, Form};
use crate::seam::{Costs, OpStream};

/// A recorded run of cells that run programs, and of the machines seen so far those on which its busiest cell works least and most.
#[derive(Debug)]
pub struct Fitting<'a> {
    trace: &'a mut ActivityTrace,
    machine: &'a Machine,
    /// What each cell does.
    cells: Vec<Work>,
    /// For each of [`WITHIN_PERCENT`].
    extremes: Vec<Extremes>,
}

/// The least and the most cycles of a run, of some machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// The machines are within that of Figure 7, in percent.
    pub percent: u32,
    /// Cycles on the machine on which the busiest cell works least, and on the one on which it works most. `None` if there is no machine.
    pub cycles: Option<(Cycles, Cycles)>,
}

/// What a cell does in a run: its instructions by their classes, their waits for floating-point results, and the cycles that hang
/// on none.
#[derive(Clone, Copy, Debug, Default)]
struct Work {
    instructions: [u64; Class::ALL.len()],
    waits: u64,
    other: u64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Extremes {
    least: Option<(u64, InstructionCycles)>,
    most: Option<(u64, InstructionCycles)>,
}

impl Work {
    fn take(&mut self, stream: &OpStream, costs: &Costs) {
        for op in stream.ops() {
            let count = u64::from(op.count());
            let Some(unit) = op.unit() else {
                self.other += count;
                continue;
            };
            let name = costs.vocabulary().unit(unit).map_or("", |unit| unit.name.as_str());
            match Class::ALL.into_iter().find(|class| class.name() == name) {
                Some(class) => self.instructions[class as usize] += count,
                None if name == FLOAT_LATENCY => self.waits += count,
                None => self.other += count * costs.of(unit).0,
            }
        }
    }

    fn cycles(&self, costs: &InstructionCycles) -> u64 {
        let of = |&class: &Class| self.instructions[class as usize] * u64::from(costs.of(class));
        let waits = self.waits * u64::from(costs.float_latency.unwrap_or(0));
        self.other + waits + Class::ALL.iter().map(of).sum::<u64>()
    }
}

impl<'a> Fitting<'a> {
    /// Of a run that was recorded, on a machine whose instructions may cost other than they did.
    ///
    /// # Errors
    ///
    /// If the trace cannot be read again, is of cells that take Figure 7's times, or counts no waits that the machine has.
    pub fn new(trace: &'a mut ActivityTrace, machine: &'a Machine) -> Result<Fitting<'a>, InputError> {
        let costs = trace.costs().clone();
        let mut cells = vec![Work::default(); trace.cells()];
        trace.for_each_batch(|batch| {
            cells.iter_mut().zip(&batch.cells).for_each(|(work, stream)| work.take(stream, &costs));
            Ok::<_, InputError>(())
        })?;
        let runs_programs = cells.iter().any(|work| work.instructions != [0; Class::ALL.len()]);
        if trace.form() == Form::Cycles || !runs_programs {
            let error = InputError::new("the trace is of cells that execute no instructions: Figure 7 fixes its times");
            return Err(error.help("record one with --cells-run programs --ops FILE"));
        }
        check_waits(costs.vocabulary(), machine.instructions.as_ref())?;
        Ok(Fitting { trace, machine, cells, extremes: vec![Extremes::default(); WITHIN_PERCENT.len()] })
    }

    /// Sees a machine that fits.
    pub fn take(&mut self, fit: &Fit) {
        let work = self.cells.iter().map(|cell| cell.cycles(&fit.cycles)).max().unwrap_or(0);
        for (extremes, percent) in self.extremes.iter_mut().zip(WITHIN_PERCENT) {
            if !fit.is_within(percent) {
                continue;
            }
            let Extremes { least, most } = extremes;
            if least.is_none_or(|(before, _)| work < before) {
                *least = Some((work, fit.cycles));
            }
            if most.is_none_or(|(before, _)| work > before) {
                *most = Some((work, fit.cycles));
            }
        }
    }

    /// Times the run on the machine as it is, and on those two for each of [`WITHIN_PERCENT`].
    ///
    /// # Errors
    ///
    /// If the machine has no costs of instructions, if the trace cannot be read again, and if the array can go no further.
    pub fn times(mut self, cancel: &Cancel) -> Result<(Option<Cycles>, Vec<Range>), RunError<Infallible>> {
        let here = self.machine.instructions.map(|cycles| self.time(&cycles, cancel)).transpose()?;
        let mut known: BTreeMap<[u32; Class::ALL.len()], Cycles> = BTreeMap::new();
        let mut ranges = Vec::new();
        for (extremes, percent) in self.extremes.clone().into_iter().zip(WITHIN_PERCENT) {
            let mut time = |found: Option<(u64, InstructionCycles)>| {
                let Some((_, costs)) = found else { return Ok(None) };
                let key = Class::ALL.map(|class| costs.of(class));
                if let Some(&cycles) = known.get(&key) {
                    return Ok(Some(cycles));
                }
                let cycles = self.time(&costs, cancel)?;
                known.insert(key, cycles);
                Ok::<_, RunError<Infallible>>(Some(cycles))
            };
            ranges.push(Range { percent, cycles: time(extremes.least)?.zip(time(extremes.most)?) });
        }
        Ok((here, ranges))
    }

    fn time(&mut self, instructions: &InstructionCycles, cancel: &Cancel) -> Result<Cycles, RunError<Infallible>> {
        let Fitting { trace, machine, .. } = self;
        let recorded = trace.costs().clone();
        let price = |unit| instructions.of_unit(&recorded.vocabulary().unit(unit)?.name);
        let costs = Costs::new(recorded.vocabulary().clone(), |unit| {
            price(unit).map_or(recorded.of(unit), |cycles| Cycles(cycles.into()))
        });
        let cells = trace.cells();
        let feed = |take: &mut TakeBatch<'_, Infallible>| trace.for_each_batch(|batch| take(Arc::new(batch)));
        Ok(replay(&machine.spec, &costs, cells, cancel, feed)?.cycles)
    }
}
