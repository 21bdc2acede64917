//! Figure 7 by two constants: what an instruction takes, and what a wait for a floating-point result does.

use std::path::PathBuf;

use super::calibrate::{Counts, counts, whole_cycles};
use super::{MeasureError, NUMBERS};
use crate::isa::{Class, InstructionCycles};
use crate::machine::MachineSpec;

/// The two constants that come nearest to all six numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoConstants {
    /// Cycles of an instruction.
    pub instruction: u32,
    /// Cycles of a wait for a floating-point result.
    pub latency: u32,
    /// The six numbers that they make, in cycles.
    pub numbers: [f64; NUMBERS.len()],
    /// By how much the worst of these is off, as a fraction of the paper's.
    pub off: f64,
}

/// The longest that are tried, in ns: of an instruction, and of a wait.
const LONGEST_NS: [f64; 2] = [400.0, 4000.0];

/// Whether a class is done step by step, so that one instruction of it is none of the others'.
fn is_iterated(class: Class) -> bool {
    matches!(class, Class::Multiply | Class::Divide | Class::FloatDivide)
}

/// The whole cycles that come nearest to Figure 7, for the programs of a folder or the standard ones. Multiplications of integers
/// and divisions cost what they do in `cycles`.
///
/// # Errors
///
/// If the programs have a mistake, or do what no program may.
pub fn two_constants(
    spec: &MachineSpec,
    cycles: &InstructionCycles,
    folder: Option<PathBuf>,
) -> Result<TwoConstants, MeasureError> {
    let counts = counts(folder)?;
    let [longest, latest] = LONGEST_NS.map(|ns| whole_cycles(ns, spec));
    let pairs = (1..=longest).flat_map(|instruction| (0..=latest).map(move |latency| (instruction, latency)));
    let tried = pairs.map(|pair| made(spec, cycles, &counts, pair));
    let best = tried.min_by(|one, other| one.off.total_cmp(&other.off));
    Ok(best.unwrap_or_else(|| made(spec, cycles, &counts, (1, 0))))
}

/// What two constants make of Figure 7.
fn made(
    spec: &MachineSpec,
    cycles: &InstructionCycles,
    counts: &Counts,
    (instruction, latency): (u32, u32),
) -> TwoConstants {
    let cost = |class: Class| if is_iterated(class) { cycles.of(class) } else { instruction };
    let number = |place: usize| {
        let row = Class::ALL.iter().zip(counts.classes[place]);
        let executed: f64 = row.map(|(&class, count)| count * f64::from(cost(class))).sum();
        executed + counts.waits[place] * f64::from(latency)
    };
    let numbers: [f64; NUMBERS.len()] = std::array::from_fn(number);
    let off = |(made, paper): (f64, f64)| (made * spec.clock_ns / (paper * 1e3) - 1.0).abs();
    let off = numbers.into_iter().zip(NUMBERS.map(|number| number.paper_us)).map(off).fold(0.0, f64::max);
    TwoConstants { instruction, latency, numbers, off }
}
