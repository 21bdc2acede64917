//! Who sees where a cell's cycles go.

use super::hold::Held;
use crate::measure::{StateId, StateTimes};

/// Sees where a cell's cycles go, all but those in which it moves a word or has nothing left to do. `()` sees nothing and
/// costs nothing.
pub(super) trait Watcher {
    /// The cell spent `cycles` cycles, from cycle `from` on, in one state, and `before` that so many in each.
    fn spent(&mut self, state: StateId, from: u64, cycles: u64, before: &StateTimes);

    /// The cell comes to an op, by its place in the batch, in that cycle; or goes on with it.
    #[inline(always)]
    fn began(&mut self, _op: usize, _cycle: u64) {}

    /// The cell waited for at least a cycle, in a state that it spent.
    #[inline(always)]
    fn held(&mut self, _: Held) {}
}

impl Watcher for () {
    #[inline(always)]
    fn spent(&mut self, _: StateId, _: u64, _: u64, _: &StateTimes) {}
}

impl<W: Watcher> Watcher for Option<W> {
    #[inline(always)]
    fn spent(&mut self, state: StateId, from: u64, cycles: u64, before: &StateTimes) {
        if let Some(watcher) = self {
            watcher.spent(state, from, cycles, before);
        }
    }

    #[inline(always)]
    fn began(&mut self, op: usize, cycle: u64) {
        if let Some(watcher) = self {
            watcher.began(op, cycle);
        }
    }

    #[inline(always)]
    fn held(&mut self, held: Held) {
        if let Some(watcher) = self {
            watcher.held(held);
        }
    }
}

/// Both see all.
impl<A: Watcher, B: Watcher> Watcher for (A, B) {
    #[inline(always)]
    fn spent(&mut self, state: StateId, from: u64, cycles: u64, before: &StateTimes) {
        self.0.spent(state, from, cycles, before);
        self.1.spent(state, from, cycles, before);
    }

    #[inline(always)]
    fn began(&mut self, op: usize, cycle: u64) {
        self.0.began(op, cycle);
        self.1.began(op, cycle);
    }

    #[inline(always)]
    fn held(&mut self, held: Held) {
        self.0.held(held);
        self.1.held(held);
    }
}
