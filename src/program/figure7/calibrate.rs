//! Fitting the instructions' cycles to Figure 7.
//!
//! Each of the six numbers is a sum over the classes of instructions: how many of a class, times what one costs. The counts
//! are those of the ops of one run. Six numbers do not fix ten costs: the fit looks,
//! among whole numbers within [`BOUNDS`], for those with the least squares of the six relative differences, and with a far
//! lesser weight of the relative distance from what is typical.

use std::path::PathBuf;

use crate::isa::kernels::{KERNELS, float_wait, unit};
use crate::isa::{Class, InstructionCycles, Processor};
use crate::machine::MachineSpec;
use crate::seam::{Activity, Unit, Vocabulary};

use super::{MeasureError, NUMBERS, mix};
use crate::program::cells::{Annex, CellOptions};

/// What a class of instructions can have cost in 1988, in ns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The class.
    pub class: Class,
    /// The least time.
    pub least_ns: f64,
    /// The typical time.
    pub typical_ns: f64,
    /// The most time.
    pub most_ns: f64,
    /// Why.
    pub why: &'static str,
}

/// The bounds of all classes. The measure is CMU's Warp, of the same time and kind: cycles of 200 ns, floating-point units
/// with pipelines of five cycles, 10 MFLOPS a cell.
pub const BOUNDS: [Bound; 10] = [
    bound(Class::Integer, 50.0, 100.0, 200.0, "at the most one of Warp's cycles"),
    bound(
        Class::Multiply,
        400.0,
        1000.0,
        2000.0,
        "no array multiplier for integers: shifts and adds, a bit or two at a time",
    ),
    bound(Class::Divide, 800.0, 2000.0, 4000.0, "the same with trial subtractions"),
    bound(Class::Load, 100.0, 200.0, 400.0, "dynamic memory of a million words"),
    bound(Class::Store, 100.0, 200.0, 400.0, "the same"),
    bound(Class::FloatAdd, 100.0, 200.0, 400.0, "a result a cycle from a pipeline that programs keep filled"),
    bound(Class::FloatMultiply, 100.0, 200.0, 400.0, "the same"),
    bound(Class::FloatDivide, 400.0, 1000.0, 2000.0, "iterated multiplications, each through the pipeline"),
    bound(
        Class::FloatCompare,
        400.0,
        1000.0,
        1600.0,
        "its outcome is needed outside: the whole pipeline of five cycles must pass",
    ),
    bound(Class::Branch, 100.0, 200.0, 600.0, "a cycle or two of the sequencer"),
];

/// A time as whole cycles of a machine, at least one.
pub fn whole_cycles(ns: f64, spec: &MachineSpec) -> u32 {
    (ns / spec.clock_ns).round().max(1.0) as u32
}

const fn bound(class: Class, least_ns: f64, typical_ns: f64, most_ns: f64, why: &'static str) -> Bound {
    Bound { class, least_ns, typical_ns, most_ns, why }
}

/// The weight of being typical, against that of the six numbers.
const TYPICAL_WEIGHT: f64 = 1e-3;

/// How many instructions of each class are behind each of the six numbers.
pub(super) type Classes = [[f64; Class::ALL.len()]; NUMBERS.len()];

/// What is behind each of the six numbers.
pub(super) struct Counts {
    /// Instructions.
    pub classes: Classes,
    /// Waits for floating-point results, where these have a latency.
    pub waits: [f64; NUMBERS.len()],
}

/// The instructions' cycles on a machine that come nearest to Figure 7, for the programs of a folder or the standard ones.
///
/// # Errors
///
/// If the programs have a mistake, or do what no program may.
pub fn calibrate(spec: &MachineSpec, folder: Option<PathBuf>) -> Result<InstructionCycles, MeasureError> {
    let classes = classes(folder)?;
    let goal = NUMBERS.map(|number| number.paper_us * 1e3 / spec.clock_ns);
    let cycles = |ns: f64| f64::from(whole_cycles(ns, spec));
    let badness = |costs: &[f64; Class::ALL.len()]| {
        let number =
            |row: &[f64; Class::ALL.len()]| row.iter().zip(costs).map(|(count, cost)| count * cost).sum::<f64>();
        let misfit: f64 = classes.iter().zip(goal).map(|(row, goal)| (number(row) / goal - 1.0).powi(2)).sum();
        let strange: f64 =
            costs.iter().zip(BOUNDS).map(|(cost, bound)| (cost / cycles(bound.typical_ns) - 1.0).powi(2)).sum();
        misfit + TYPICAL_WEIGHT * strange
    };
    let costs = descend(BOUNDS.map(|bound| cycles(bound.typical_ns)), badness, |class, cost| {
        (cycles(BOUNDS[class].least_ns)..=cycles(BOUNDS[class].most_ns)).contains(&cost)
    });
    let mut fitted = InstructionCycles::default();
    BOUNDS.iter().zip(costs).for_each(|(bound, cost)| fitted.set(bound.class, cost as u32));
    Ok(fitted)
}

/// Changes one, two or three costs by a few cycles at a time, as long as that makes them better.
fn descend<const N: usize>(
    mut costs: [f64; N],
    badness: impl Fn(&[f64; N]) -> f64,
    allowed: impl Fn(usize, f64) -> bool,
) -> [f64; N] {
    const STEPS: [f64; 5] = [0.0, -1.0, 1.0, -2.0, 2.0];
    let mut best = badness(&costs);
    loop {
        let before = best;
        for [i, j, k] in triples(N) {
            let from = costs;
            for change in (0..STEPS.len().pow(3)).map(|n| [STEPS[n % 5], STEPS[n / 5 % 5], STEPS[n / 25]]) {
                let mut tried = from;
                [i, j, k].into_iter().zip(change).for_each(|(class, step)| tried[class] += step);
                if [i, j, k].into_iter().all(|class| allowed(class, tried[class])) && badness(&tried) < best {
                    (costs, best) = (tried, badness(&tried));
                }
            }
        }
        if best >= before {
            return costs;
        }
    }
}

fn triples(count: usize) -> impl Iterator<Item = [usize; 3]> {
    let above = move |from: usize| from + 1..count;
    (0..count).flat_map(move |i| above(i).flat_map(move |j| above(j).map(move |k| [i, j, k])))
}

/// How many instructions of each class are behind each of the six numbers.
pub(super) fn classes(folder: Option<PathBuf>) -> Result<Classes, MeasureError> {
    Ok(counts(folder)?.classes)
}

/// What is behind each of the six numbers. All prices are open, so this is one run.
pub(super) fn counts(folder: Option<PathBuf>) -> Result<Counts, MeasureError> {
    let options = CellOptions {
        cycles: InstructionCycles { float_latency: Some(0), ..InstructionCycles::default() },
        folder,
        instruction_limit: Processor::INSTRUCTION_LIMIT,
        annex: Annex::default(),
    };
    let mix = mix(Some(&options))?;
    let count = |row: &[f64; Vocabulary::MOST_UNITS], unit: &dyn Fn(Activity) -> Unit| {
        (0..KERNELS.len()).map(|kernel| row[unit(Activity(kernel as u8)).0 as usize]).sum()
    };
    let classes = mix.map(|row| Class::ALL.map(|class| count(&row, &|kernel| unit(kernel, class))));
    Ok(Counts { classes, waits: mix.map(|row| count(&row, &float_wait)) })
}
