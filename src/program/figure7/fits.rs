//! All machines that make Figure 7 as well: six numbers do not fix nine costs.

use std::path::PathBuf;

use super::calibrate::{BOUNDS, Classes, classes, whole_cycles};
use super::{MeasureError, NUMBERS};
use crate::isa::{Class, InstructionCycles};
use crate::machine::MachineSpec;

/// How far all six numbers may be off, in percent.
pub const WITHIN_PERCENT: [u32; 4] = [1, 2, 5, 10];

/// The machines whose instructions cost whole cycles within [`BOUNDS`], and all of whose numbers are so near.
#[derive(Clone, Debug, PartialEq)]
pub struct Within {
    /// As near as that, in percent.
    pub percent: u32,
    /// How many they are.
    pub machines: u64,
    /// For each class, in the order of [`Class::ALL`], the least and the most cycles of any of them. `None` if no number hangs on it,
    /// or if there is no machine.
    pub ranges: [Option<(u32, u32)>; Class::ALL.len()],
}

/// A machine that fits, and by how much its worst number is off, as a fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// What its instructions cost. A class on which no number hangs has its typical cost.
    pub cycles: InstructionCycles,
    /// By how much the worst of its numbers is off, as a fraction of the paper's.
    pub off: f64,
}

impl Fit {
    /// Whether all of its numbers are as near as that.
    pub fn is_within(&self, percent: u32) -> bool {
        self.off <= f64::from(percent) / 100.0 + ROUNDING
    }
}

/// Counts the machines that fit, for the programs of a folder or the standard ones: for each of [`WITHIN_PERCENT`] how many, and what their
/// costs can be. `visit` sees each that is within the last of these.
///
/// # Errors
///
/// If the programs have a mistake, or do what no program may.
pub fn fits(
    spec: &MachineSpec,
    folder: Option<PathBuf>,
    mut visit: impl FnMut(Fit),
) -> Result<Vec<Within>, MeasureError> {
    let search = Search::new(spec, &classes(folder)?, WITHIN_PERCENT[WITHIN_PERCENT.len() - 1]);
    let none = |percent| Within { percent, machines: 0, ranges: [None; Class::ALL.len()] };
    let mut all = WITHIN_PERCENT.map(none);
    search.each(&mut |fit| {
        all.iter_mut()
            .filter(|within| fit.is_within(within.percent))
            .for_each(|within| within.take(&search, &fit.cycles));
        visit(fit);
    });
    Ok(all.into())
}

/// Sums of fractions are off by that at the most.
const ROUNDING: f64 = 1e-9;

impl Within {
    fn take(&mut self, search: &Search, cycles: &InstructionCycles) {
        self.machines += 1;
        for column in &search.columns {
            let cost = cycles.of(column.class);
            let (least, most) = self.ranges[column.class as usize].get_or_insert((cost, cost));
            (*least, *most) = ((*least).min(cost), (*most).max(cost));
        }
    }
}

/// The six numbers, each as a part of the paper's.
type Parts = [f64; NUMBERS.len()];

/// A class that numbers hang on.
struct Column {
    class: Class,
    /// What a cycle more of it adds to each number.
    each: Parts,
    least: u32,
    most: u32,
    /// What this class and all behind it add at the least and at the most.
    rest: [Parts; 2],
}

/// A search through all costs, class by class, that turns back where what is left can no longer come near.
struct Search {
    columns: Vec<Column>,
    typical: InstructionCycles,
    off: f64,
}

impl Search {
    fn new(spec: &MachineSpec, classes: &Classes, percent: u32) -> Search {
        let cycles = |ns: f64| whole_cycles(ns, spec);
        let column = |(index, &class): (usize, &Class)| {
            let bound = BOUNDS.iter().find(|bound| bound.class == class)?;
            let part = |number: usize| classes[number][index] * spec.clock_ns / (NUMBERS[number].paper_us * 1e3);
            let each: Parts = std::array::from_fn(part);
            let (least, most) = (cycles(bound.least_ns), cycles(bound.most_ns));
            each.iter().any(|&part| part != 0.0).then_some(Column { class, each, least, most, rest: [[0.0; 6]; 2] })
        };
        let mut columns: Vec<Column> = Class::ALL.iter().enumerate().filter_map(column).collect();
        // What moves a number most comes first: most ways then end early.
        let moves =
            |column: &Column| f64::from(column.most - column.least) * column.each.iter().copied().fold(0.0, f64::max);
        columns.sort_by(|a, b| moves(b).total_cmp(&moves(a)));
        let mut rest = [[0.0; NUMBERS.len()]; 2];
        for column in columns.iter_mut().rev() {
            for (rest, cost) in rest.iter_mut().zip([column.least, column.most]) {
                *rest = plus(rest, &column.each, cost);
            }
            column.rest = rest;
        }
        let mut typical = InstructionCycles::default();
        BOUNDS.iter().for_each(|bound| typical.set(bound.class, cycles(bound.typical_ns)));
        Search { columns, typical, off: f64::from(percent) / 100.0 + ROUNDING }
    }

    fn each(&self, visit: &mut impl FnMut(Fit)) {
        self.from(0, [0.0; NUMBERS.len()], self.typical, visit);
    }

    /// All costs of the classes from one on, where those before it have added up to so much.
    fn from(&self, place: usize, sums: Parts, mut cycles: InstructionCycles, visit: &mut impl FnMut(Fit)) {
        let Some(column) = self.columns.get(place) else {
            let off = sums.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max);
            return if off <= self.off {
                visit(Fit { cycles, off })
            };
        };
        let [at_least, at_most] = self.columns.get(place + 1).map_or([[0.0; NUMBERS.len()]; 2], |next| next.rest);
        for cost in column.least..=column.most {
            let sums = plus(&sums, &column.each, cost);
            if sums.iter().zip(at_least).any(|(sum, rest)| sum + rest > 1.0 + self.off) {
                break;
            }
            if sums.iter().zip(at_most).all(|(sum, rest)| sum + rest >= 1.0 - self.off) {
                cycles.set(column.class, cost);
                self.from(place + 1, sums, cycles, visit);
            }
        }
    }
}

fn plus(sums: &Parts, each: &Parts, cost: u32) -> Parts {
    std::array::from_fn(|number| sums[number] + each[number] * f64::from(cost))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against all costs that there are, of three classes that hang on each other.
    #[test]
    fn none_is_missed_and_none_is_counted_that_does_not_fit() {
        let spec = MachineSpec::default();
        let mut classes: Classes = [[0.0; Class::ALL.len()]; NUMBERS.len()];
        for (number, row) in classes.iter_mut().enumerate() {
            let goal = NUMBERS[number].paper_us * 1e3 / spec.clock_ns;
            (row[Class::Integer as usize], row[Class::Load as usize]) = (goal / 10.0, goal / 20.0);
            row[Class::FloatAdd as usize] = goal / (12.0 + number as f64);
        }
        let (mut found, mut all) = (Vec::new(), Vec::new());
        Search::new(&spec, &classes, 10).each(&mut |fit| found.push(fit.cycles));
        for (integer, load, add) in (1..=4).flat_map(|i| (2..=8).flat_map(move |l| (2..=8).map(move |a| (i, l, a)))) {
            let off = |number: usize| {
                let sum = f64::from(integer) / 10.0 + f64::from(load) / 20.0 + f64::from(add) / (12.0 + number as f64);
                (sum - 1.0).abs()
            };
            if (0..NUMBERS.len()).all(|number| off(number) <= 0.1 + ROUNDING) {
                all.push((integer, load, add));
            }
        }
        let mut found: Vec<_> = found.iter().map(|cycles| (cycles.integer, cycles.load, cycles.float_add)).collect();
        found.sort();
        assert!(!all.is_empty());
        assert_eq!(found, all);
    }
}
