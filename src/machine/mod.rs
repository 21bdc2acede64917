//! The timing half: machines, which turn what is done into when it is done. A machine has [costs](crate::seam::Costs) for
//! units of work, and fills [`measure`](crate::measure) with what it saw.
//!
//! [`mod@line`] is the row of cells of the paper (§4.2); [`MachineFile`] describes PCS.

mod fifo_name;
pub mod line;
mod pcs;
mod spec;
mod times;

pub use fifo_name::FifoName;
pub use line::{Array, Observed, Stuck, StuckKind, Unfinished, Wait, WaitFor};
pub use pcs::{Machine, MachineFile, MachineOptions, TimesUs};
pub use spec::{LinkRate, MachineSpec, RateCounts};
pub use times::{HostTimes, KernelTimes, Times};

pub use crate::quantities::{Cycles, Words};
