//! Who sees where a cell's cycles go.

use crate::measure::StateId;

/// Sees where a cell's cycles go, all but those in which it moves a word or has nothing left to do. `()` sees nothing and
/// costs nothing.
pub(super) trait Watcher {
    /// The cell spent `cycles` cycles, from cycle `from` on, in one state.
    fn spent(&mut self, state: StateId, from: u64, cycles: u64);
}

impl Watcher for () {
    #[inline(always)]
    fn spent(&mut self, _: StateId, _: u64, _: u64) {}
}

impl<W: Watcher> Watcher for Option<W> {
    #[inline(always)]
    fn spent(&mut self, state: StateId, from: u64, cycles: u64) {
        if let Some(watcher) = self {
            watcher.spent(state, from, cycles);
        }
    }
}

/// Both see all.
impl<A: Watcher, B: Watcher> Watcher for (A, B) {
    #[inline(always)]
    fn spent(&mut self, state: StateId, from: u64, cycles: u64) {
        self.0.spent(state, from, cycles);
        self.1.spent(state, from, cycles);
    }
}
