//! The timing half: machines, which turn what is done into when it is done. A machine has [costs](crate::seam::Costs) for
//! units of work, and fills [`measure`](crate::measure) with what it saw.
//!
//! [`mod@line`] is the row of cells of the paper (§4.2); [`MachineFile`] describes PCS. [`events`] has tasks that act in the
//! order of time; [`CapitanFile`] describes such a machine.

mod capitan;
mod chains;
pub mod events;
mod fifo_name;
mod file;
mod ipsc2;
pub mod line;
mod pcs;
mod spec;
mod timeline;
mod times;

pub use capitan::{Capitan, CapitanFile, CapitanOptions, ProcessorTimesUs, TaskCosts};
pub use fifo_name::FifoName;
pub use ipsc2::{Ipsc2, Ipsc2File, Ipsc2Options, MessageTimes, NodeCosts, NodeTimesUs};
pub use line::{Array, Stuck, StuckKind, Unfinished, Wait, WaitFor};
pub use pcs::{Machine, MachineFile, MachineOptions, TimesUs};
pub use spec::{LinkRate, MachineSpec, RateCounts};
pub use times::{HostTimes, KernelTimes, Times};

pub use crate::measure::Observed;
pub use crate::quantities::{Cycles, Words};
