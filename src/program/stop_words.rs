//! Stop words: the intersection's cell tells the grid's, voxel by voxel, to go on with the ray or to stop. Beyond the paper,
//! whose P1 walks on to the end of the volume long after P3 has found the hit.
//!
//! # Who says what
//!
//! Let W be how far the grid's cell may be ahead.
//!
//! - Behind a voxel's candidates the grid's cell sends VOXEL on Y, 1 word: the t at which the ray leaves the voxel, with its
//!   sign bit set, which tells it from polygons (END is a NaN). A filter's cell passes it on.
//! - The intersection's cell answers each VOXEL with WORD on Z, 1 word: 1 (stop) if its nearest hit lies inside that voxel
//!   or one before it on the ray, else 0 (go on). A filter's cell passes the words on to the left.
//! - After each VOXEL that it has sent, the grid's cell reads one WORD: the one for the voxel W - 1 before it. So it has
//!   read the word for voxel v - W before it walks voxel v. If that says stop, the ray ends here; END follows on Y as ever.
//! - A filter's cell between the two reads, after each VOXEL that it has passed on, the word for the voxel (W - 1) / 2
//!   before it (rounded down), so that the two halves of the way lag by as much, and passes it on.
//! - A cell that has seen a ray's stop takes the ray's later candidates from Y and does no more with them.
//!
//! # From ray to ray
//!
//! Every voxel has one word, and every word is read, in the order of the voxels of all rays: words of a ray that are still
//! on their way at its end are read during the next ones, as their first voxels' words, and change nothing there. So
//! nobody waits for a ray's last words, and what a cell does for a ray depends on that ray alone. To begin with, each cell
//! but a group's first writes as many words to the left as its left neighbour lags more than itself does; as many
//! stay unread in the end. [`StopWords::least_fifo_words`] is what they need to find room, and then nothing can ever block:
//! whoever waits for a word waits for the answer to a VOXEL that has been sent, with all candidates before it.

use super::messages::{Messaging, VOXEL_WORDS};
use crate::seam::{OpKind, OpStream};

/// The protocol between the cells of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StopWords {
    /// How many voxels the grid's cell may be ahead of the intersection's, at least 1.
    pub ahead: u32,
    /// A group's last stage, at least 1.
    pub last: usize,
}

impl StopWords {
    /// How many voxels behind the one that a stage has just done is the one whose word it then has.
    pub fn lag(&self, stage: usize) -> u32 {
        ((self.ahead - 1) as u64 * (self.last - stage) as u64 / self.last as u64) as u32
    }

    /// Words that a stage writes to its left neighbour before the first ray.
    pub fn head_start(&self, stage: usize) -> u64 {
        (self.lag(stage - 1) - self.lag(stage)) as u64
    }

    /// What each FIFO of Z must hold at the least.
    pub fn least_fifo_words(&self) -> u64 {
        (1..=self.last).map(|stage| self.head_start(stage)).max().unwrap_or(0).max(VOXEL_WORDS)
    }

    /// What the cells of a group do before the first ray.
    pub fn begin(&self, cells: &mut [OpStream]) {
        for (stage, cell) in cells.iter_mut().enumerate().skip(1).filter(|(stage, _)| self.head_start(*stage) > 0) {
            cell.push(OpKind::WriteZ, self.head_start(stage));
        }
    }

    /// What the cells of a group do at the end of a voxel.
    pub fn end_voxel(&self, cells: &mut [OpStream], messaging: Messaging) {
        for (stage, cell) in cells.iter_mut().enumerate() {
            if stage > 0 {
                messaging.take(cell, OpKind::ReadY, VOXEL_WORDS);
            }
            if stage < self.last {
                messaging.send(cell, OpKind::WriteY, VOXEL_WORDS);
                messaging.take(cell, OpKind::ReadZ, VOXEL_WORDS);
            }
            if stage > 0 {
                messaging.send(cell, OpKind::WriteZ, VOXEL_WORDS);
            }
        }
    }
}

/// How far a ray is in a group with stop words.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stopping {
    /// The number of the voxel under way, from 0.
    voxel: u32,
    /// The first voxel that was answered with stop.
    stop: Option<u32>,
}

impl Stopping {
    /// Whether a stage has seen the ray's stop, and so ignores the candidates of the voxel under way.
    #[inline]
    pub fn seen_by(&self, stage: usize, words: Option<StopWords>) -> bool {
        let (Some(stop), Some(words)) = (self.stop, words) else { return false };
        self.voxel > stop + words.lag(stage)
    }

    /// Goes on to the next voxel. `hit_inside` tells whether the nearest hit lies inside the one just done, or before it.
    pub fn end_voxel(&mut self, hit_inside: bool) {
        if hit_inside {
            self.stop.get_or_insert(self.voxel);
        }
        self.voxel += 1;
    }
}
