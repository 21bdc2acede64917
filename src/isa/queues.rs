//! The words that cells read and write, without a clock.

use super::executable::{Moves, is_x};
use super::register::Queue;

/// The words that come to a cell, and those that it has written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Queues {
    /// X and Y of the cell: all words that have come.
    pub x: Vec<u32>,
    /// The same on Y.
    pub y: Vec<u32>,
    /// How many words of [`Queues::x`] it has read.
    pub x_read: usize,
    /// How many words of [`Queues::y`] it has read.
    pub y_read: usize,
    /// What it has written to the right neighbour's X, words passed on among them.
    pub x_out: Vec<u32>,
    /// What it has written to the right neighbour's Y.
    pub y_out: Vec<u32>,
}

impl Queues {
    /// The first queue that has too few words for an instruction that reads some.
    #[inline]
    pub(super) fn missing(&self, moves: &Moves) -> Option<Queue> {
        let (mut x, mut y) = (self.x.len() - self.x_read, self.y.len() - self.y_read);
        if x.min(y) >= moves.reads.len() {
            return None;
        }
        moves.reads.into_iter().flatten().find(|&queue| {
            let left = if is_x(queue) { &mut x } else { &mut y };
            let enough = left.checked_sub(1);
            *left = enough.unwrap_or(0);
            enough.is_none()
        })
    }

    /// The next word from X, which must be there.
    pub(super) fn next_x(&mut self) -> u32 {
        let word = self.x.get(self.x_read).copied().unwrap_or(0);
        self.x_read += 1;
        word
    }

    /// The next word from Y, which must be there.
    pub(super) fn next_y(&mut self) -> u32 {
        let word = self.y.get(self.y_read).copied().unwrap_or(0);
        self.y_read += 1;
        word
    }

    /// Empties all queues, and lets these words come on X.
    pub fn restart(&mut self, x: &[u32]) {
        for words in [&mut self.x, &mut self.y, &mut self.x_out, &mut self.y_out] {
            words.clear();
        }
        (self.x_read, self.y_read) = (0, 0);
        self.x.extend_from_slice(x);
    }

    /// A queue with words that have not been read, and how many.
    pub fn unread(&self) -> Option<(Queue, usize)> {
        let (x, y) = (self.x.len() - self.x_read, self.y.len() - self.y_read);
        if x > 0 { Some((Queue::X, x)) } else { (y > 0).then_some((Queue::Y, y)) }
    }

    /// Makes what the cell has written what comes to its right neighbour.
    pub fn hand_on(&mut self) {
        std::mem::swap(&mut self.x, &mut self.x_out);
        std::mem::swap(&mut self.y, &mut self.y_out);
        (self.x_read, self.y_read) = (0, 0);
        self.x_out.clear();
        self.y_out.clear();
    }
}
