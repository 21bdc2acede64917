//! What holds a cell up.

use super::states::{blocked, waiting};
use crate::measure::StateId;
use crate::seam::Channel;

/// What a cell, or the host, waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hold {
    /// A word that it reads.
    Word(Channel),
    /// A place in the FIFO that it writes to.
    Slot(Channel),
    /// The wire to that FIFO.
    Wire(Channel),
    /// An answer, of the host.
    Answer,
}

/// A wait that is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Held {
    /// The first cycle after it, in which it goes on.
    pub until: u64,
    /// The op that waited, by its place in its batch.
    pub op: usize,
    /// How much of the op was left to do.
    pub left: u64,
    /// What it waited for: of several things, the last.
    pub by: Hold,
    /// Whether it is over only because no more cycles are simulated.
    pub is_cut: bool,
}

impl Hold {
    /// The state of a cell that waits for it.
    #[inline(always)]
    pub fn state(self) -> StateId {
        match self {
            Hold::Word(channel) => waiting(channel),
            Hold::Slot(channel) | Hold::Wire(channel) => blocked(channel),
            Hold::Answer => waiting(Channel::Y),
        }
    }
}
