//! What an array has done so far, while it is at work.

use super::stats::{CellStats, FifoStats};
use super::units::Cycles;

/// The statistics of an array that is not done. Each cell and each FIFO has come to a cycle of its own; two of these tell
/// what happened between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SoFar {
    /// The first cycle after the host's last read.
    pub cycles: Cycles,
    /// Messages that have come back to the host.
    pub returned: u64,
    /// Each cell's cycles up to its own clock, from left to right. None of them is idle.
    pub cells: Vec<CellStats>,
    /// Each FIFO's statistics, in the order of [`super::RunStats::fifos`], and the cycle up to which they go.
    pub fifos: Vec<(FifoStats, Cycles)>,
}
