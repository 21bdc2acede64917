//! What cycles are in time.

use crate::quantities::Cycles;

/// A machine's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Length of a cycle, in ns.
    pub cycle_ns: f64,
}

impl Clock {
    /// A number of cycles in seconds of simulated time.
    pub fn seconds(&self, cycles: Cycles) -> f64 {
        self.seconds_of(cycles.0 as f64)
    }

    /// The cycle that a time lies in, in seconds from the start of the run.
    pub fn cycle_at(&self, seconds: f64) -> Cycles {
        // A time that is a whole number of cycles is the start of one, though decimal fractions are not exact in binary.
        Cycles((seconds * 1e9 / self.cycle_ns + 1e-6) as u64)
    }

    /// A number of cycles that is no whole one, as a mean is, in seconds.
    pub fn seconds_of(&self, cycles: f64) -> f64 {
        // Divided, not multiplied by 1e-9, which is no binary fraction: 300 105 cycles of 50 ns are 0.01500525 s.
        cycles * self.cycle_ns / 1e9
    }
}
