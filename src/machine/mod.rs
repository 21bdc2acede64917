//! The timing half: cells, links and FIFOs, in cycles. Ops go in, cycles come out; what the ops are for is not known here.
//!
//! # Guarantees
//!
//! - **Exact.** Every figure is what a model that ticks every cycle would count, to the last cycle (the tests keep such a
//!   model and compare every field).
//! - **Deterministic.** A trace and a [`MachineSpec`] fix every figure; neither threads nor the sizes of the batches do.
//!
//! # How it gets there without ticking
//!
//! Every read and every write blocks, so the cycle of each word follows from a few earlier ones: a read of word *j* comes
//! no earlier than its write plus the latency, a write of word *j* no earlier than the read of word *j - capacity* plus
//! one, and neither earlier than what its own cell did before. Each cell has a clock of its own and runs on until it
//! needs a time that its neighbour has not worked out yet.

mod array;
mod cell;
mod fifo;
mod observers;
mod op;
mod pcs;
mod probe;
mod profile;
mod recorder;
mod recording;
mod so_far;
mod spec;
mod stats;
mod stuck;
mod times;
mod units;

pub use array::{Array, Unfinished};
pub use observers::Observed;
pub use op::{Op, OpBatch, OpKind, OpLine, OpStream, Work};
pub use pcs::{Machine, MachineFile, MachineOptions, TimesUs};
pub use profile::{FifoBin, FifoProfile, Latency, Profile};
pub use recording::{Activity, FifoLevels, Recording, Stretch, Visit};
pub use so_far::SoFar;
pub use spec::{LinkRate, MachineSpec, RateCounts};
pub use stats::{Busy, CellState, CellStats, FifoStats, RunStats};
pub use stuck::{Party, Stuck, StuckKind, Wait, WaitFor};
pub use times::{HostTimes, KernelTimes, Times};
pub use units::{Cycles, Words};

/// The channels between neighbours: X and Y lead to the right (§4.2: "two input FIFOs"), Z leads to the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    /// Carries the rays.
    X,
    /// Carries candidates and hits.
    Y,
    /// Leads from a cell to its left neighbour, on a wire of its own, for programs that need it. Beyond the paper.
    Z,
}

impl std::fmt::Display for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Channel::X => "X",
            Channel::Y => "Y",
            Channel::Z => "Z",
        })
    }
}
