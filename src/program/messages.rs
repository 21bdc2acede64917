//! The messages between the host and the cells, and their words (32 bits each).

use super::work::MESSAGE;
use crate::seam::{OpKind, OpStream};

/// RAY, on X: id, origin x y z, direction x y z, t_max.
pub const RAY_WORDS: u64 = 8;

/// Sub-volumes that a word of a RAY with a mask tells of, a bit each, behind its other words.
pub const MASK_BITS: u64 = 32;

/// CANDIDATE, on Y: a polygon's index; END, behind the last one, is as long.
pub const CANDIDATE_WORDS: u64 = 1;

/// HIT, on Y: the ray's id, the polygon's index, t, alpha, beta.
pub const HIT_WORDS: u64 = 5;

/// VOXEL, on Y, and the WORD on Z that answers it: see [stop words](super::ArrayProgram::stop_words).
pub const VOXEL_WORDS: u64 = 1;

/// Whether it takes who sends or takes a message time, beside that of its words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Messaging {
    pub takes_time: bool,
}

impl Messaging {
    /// A message of so many words is taken: when it has come, there is work on it.
    #[inline(always)]
    pub fn take(self, cell: &mut OpStream, kind: OpKind, words: u64) {
        cell.push(kind, words);
        if self.takes_time {
            cell.push(OpKind::Work(MESSAGE), 1);
        }
    }

    /// A message of so many words is sent: there is work on it, and then it goes.
    #[inline(always)]
    pub fn send(self, cell: &mut OpStream, kind: OpKind, words: u64) {
        if self.takes_time {
            cell.push(OpKind::Work(MESSAGE), 1);
        }
        cell.push(kind, words);
    }

    /// A message on X is passed on, if there is a neighbour: word by word as it comes, or where it takes time, as a whole.
    pub fn pass(self, cell: &mut OpStream, words: u64, has_neighbor: bool) {
        if !self.takes_time {
            return cell.push(OpKind::PassX, words);
        }
        self.take(cell, OpKind::ReadX, words);
        if has_neighbor {
            self.send(cell, OpKind::WriteX, words);
        }
    }
}
