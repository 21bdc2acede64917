//! The seam between the two halves: what is done, in units of work and words, without a clock and without a price.
//!
//! The functional half writes [ops](Op) in streams, one a station; the timing half takes them. An op counts units of work or
//! words: what a unit takes is in the machine's table of [`Costs`]. So a machine with other times, another clock, other
//! links or FIFOs does the very same ops, and a recorded trace of them ([`activity_trace`]) can be timed under any.
//!
//! What the units are, and what a station can be said to be busy with, the functional half tells in a [`Vocabulary`]. A
//! *job* is what the host sends into the array, and of which an answer comes back: a ray.

pub mod activity_trace;
mod batch;
mod channel;
mod costs;
mod op;
mod vocabulary;

pub use batch::{BatchError, OpBatch};
pub use channel::Channel;
pub use costs::Costs;
pub use op::{Op, OpKind, OpLine, OpStream};
pub use vocabulary::{Activity, Unit, UnitOfWork, Vocabulary};

/// The largest number of cells of an array.
pub const MOST_CELLS: usize = 4096;
