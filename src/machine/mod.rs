//! The timing half: machines, which turn what is done into when it is done. A machine has [costs](crate::seam::Costs) for
//! units of work, and fills [`measure`](crate::measure) with what it saw.
//!
//! [`line`] is the row of cells of the paper (§4.2).

pub mod line;
mod spec;

pub use line::{Array, Observed, Stuck, StuckKind, Unfinished, Wait, WaitFor};
pub use spec::{LinkRate, MachineSpec, RateCounts};

pub use crate::quantities::{Cycles, Words};
