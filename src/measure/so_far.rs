//! What a machine has done so far, while it is at work.

use std::sync::Arc;

use super::state::StateTimes;
use super::stats::FifoStats;
use super::topology::Topology;
use crate::quantities::Cycles;

/// The statistics of a machine that is not done. Each station and each FIFO has come to a cycle of its own; two of these tell
/// what happened between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SoFar {
    /// What the figures are of.
    pub topology: Arc<Topology>,
    /// The first cycle after the host's last read; of tasks that act in the order of time, the cycle that they have come to.
    pub cycles: Cycles,
    /// Messages that have come back to the host; of tasks, jobs that are done.
    pub returned: u64,
    /// Each station's cycles up to its own clock. None of a line's is idle.
    pub stations: Vec<StateTimes>,
    /// Each FIFO's statistics, and the cycle up to which they go.
    pub fifos: Vec<(FifoStats, Cycles)>,
}
