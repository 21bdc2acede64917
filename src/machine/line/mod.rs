//! A line of cells: cells, links and FIFOs, in cycles. Ops go in, cycles come out; what the ops are for is not known here.
//!
//! # Guarantees
//!
//! - **Exact.** Every figure is what a model that ticks every cycle would count, to the last cycle (the tests keep such a
//!   model and compare every field).
//! - **Deterministic.** Ops, [costs](crate::seam::Costs) and a [`MachineSpec`](super::MachineSpec) fix every figure; neither
//!   threads nor the sizes of the batches do.
//!
//! # How it gets there without ticking
//!
//! Every read and every write blocks, so the cycle of each word follows from a few earlier ones: a read of word *j* comes
//! no earlier than its write plus the latency, a write of word *j* no earlier than the read of word *j - capacity* plus
//! one, and neither earlier than what its own cell did before. Each cell has a clock of its own and runs on until it
//! needs a time that its neighbour has not worked out yet.

mod array;
mod causes;
mod cell;
mod cursor;
mod departures;
mod fifo;
mod hold;
mod link;
mod observers;
mod prices;
mod probe;
mod recorder;
mod states;
mod stuck;
mod unlimited;
mod watcher;

pub use array::{Array, Unfinished};
pub use states::{IDLE, MOVING, blocked, waiting, working};
pub use stuck::{Stuck, StuckKind, Wait, WaitFor};
