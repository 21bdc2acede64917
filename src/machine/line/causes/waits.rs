//! The waits of a station that are over. On slow links each word of an op waits: such a row of waits is one entry.

use super::Stand;
use crate::machine::line::hold::{Held, Hold};

/// A row of waits for the words of one op, each of which waits as long after the one before it: mostly it has just one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waits {
    /// The first cycle after the last of them.
    until: u64,
    /// How many there are beside the last.
    more: u32,
    /// Cycles from the end of one to the end of the next; 0 if there is only one.
    step: u32,
    /// What was left of the op at the last.
    left: u32,
    batch: u32,
    op: u32,
    /// What they were for.
    pub by: Hold,
}

/// One of these: the first cycle after it, and its number in the row, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wait {
    /// The row, by its place.
    pub row: usize,
    pub number: u32,
}

impl Waits {
    pub fn new(batch: usize, held: Held) -> Waits {
        let Held { until, op, left, by, .. } = held;
        Waits { until, more: 0, step: 0, left: left as u32, batch: batch as u32, op: op as u32, by }
    }

    /// Adds a wait to the row, if it goes on like this. False if it does not.
    #[inline(always)]
    pub fn extend(&mut self, batch: usize, held: &Held) -> bool {
        let is_next = self.op as usize == held.op && self.left as u64 == held.left + 1 && self.by == held.by;
        let step = held.until - self.until;
        let goes_on = is_next && self.batch as usize == batch && (self.more == 0 || step == self.step as u64);
        if !goes_on || step > u32::MAX as u64 {
            return false;
        }
        (self.until, self.more, self.step, self.left) = (held.until, self.more + 1, step as u32, self.left - 1);
        true
    }

    /// The first cycle after the first of them.
    pub fn first(&self) -> u64 {
        self.until - self.more as u64 * self.step as u64
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        self.more + 1
    }

    /// The number of the last of them that is over at the beginning of a cycle, as the first is.
    pub fn last_before(&self, cycle: u64) -> u32 {
        if cycle >= self.until { self.more } else { ((cycle - self.first()) / self.step as u64) as u32 }
    }

    /// Where the station stood behind one of them.
    pub fn stand(&self, number: u32) -> Stand {
        let (later, step) = (self.more - number, self.step as u64);
        Stand {
            batch: self.batch as usize,
            op: self.op as usize,
            left: self.left as u64 + later as u64,
            clock: self.until - later as u64 * step,
        }
    }
}

/// The last wait that is over at the beginning of a cycle. It is looked for around row `near`, to the left in steps that double: who
/// goes back in time finds it beside the one before.
pub(super) fn last_before(waits: &[Waits], cycle: u64, near: usize) -> Option<Wait> {
    let is_over = |row: &Waits| row.first() <= cycle;
    let near = near.min(waits.len());
    // In the end the rows before `start` are over, and those from `end` on are not.
    let (mut start, mut end, mut step) = (near, near, 1);
    if waits.get(near).is_some_and(is_over) {
        end = waits.len();
    }
    while start > 0 && !is_over(&waits[start - 1]) {
        (start, end) = (start.saturating_sub(step), start - 1);
        step *= 2;
    }
    let row = (start + waits[start..end].partition_point(is_over)).checked_sub(1)?;
    Some(Wait { row, number: waits[row].last_before(cycle) })
}

/// The wait behind another, or the first.
pub(super) fn next_after(waits: &[Waits], last: Option<Wait>) -> Option<Wait> {
    let next = match last {
        None => Wait { row: 0, number: 0 },
        Some(Wait { row, number }) if number + 1 < waits[row].count() => Wait { row, number: number + 1 },
        Some(Wait { row, .. }) => Wait { row: row + 1, number: 0 },
    };
    (next.row < waits.len()).then_some(next)
}
