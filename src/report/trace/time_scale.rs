//! Cycles as a trace counts time.

use crate::machine::Cycles;

/// A unit of time, and how many a cycle has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeScale {
    exponent: i8,
    ticks_per_cycle: f64,
}

impl TimeScale {
    /// The first unit of which a cycle is a whole number, or else the last. A unit is given as its power of ten in seconds.
    pub fn new(clock_ns: f64, exponents: &[i8]) -> TimeScale {
        let scale =
            |&exponent: &i8| TimeScale { exponent, ticks_per_cycle: clock_ns * 10f64.powi(-9 - exponent as i32) };
        let exact = exponents.iter().map(scale).find(TimeScale::is_exact);
        exact.or(exponents.last().map(scale)).unwrap_or(scale(&-9))
    }

    /// The unit, as its power of ten in seconds.
    pub fn exponent(&self) -> i8 {
        self.exponent
    }

    /// Whether a cycle is a whole number of units.
    pub fn is_exact(&self) -> bool {
        let ticks = self.ticks_per_cycle;
        (ticks - ticks.round()).abs() <= 1e-12 * ticks && ticks >= 1.0
    }

    /// When a cycle begins, to the nearest unit.
    pub fn start_of(&self, cycle: Cycles) -> u64 {
        if self.is_exact() {
            cycle.0.saturating_mul(self.ticks_per_cycle.round() as u64)
        } else {
            (cycle.0 as f64 * self.ticks_per_cycle).round() as u64
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarsest_exact_unit_is_chosen() {
        let exponents = [-9, -12, -15];
        for (clock_ns, exponent, at_seven) in [(50.0, -9, 350), (0.1, -12, 700), (33.25, -12, 232_750)] {
            let scale = TimeScale::new(clock_ns, &exponents);
            assert_eq!((scale.is_exact(), scale.exponent(), scale.start_of(Cycles(7))), (true, exponent, at_seven));
        }
        let third = TimeScale::new(100.0 / 3.0, &exponents);
        assert_eq!((third.is_exact(), third.exponent(), third.start_of(Cycles(2))), (false, -15, 66_666_667));
    }
}
