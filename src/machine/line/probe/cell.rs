//! What a cell did over time.

use crate::machine::line::states::{IDLE, MOVING};
use crate::machine::line::watcher::Watcher;
use crate::machine::timeline::Timeline;
use crate::measure::{StateId, StateTimes};
use crate::quantities::Cycles;

/// Follows one cell.
#[derive(Debug)]
pub struct CellLane {
    timeline: Timeline<StateTimes>,
}

impl Watcher for &mut CellLane {
    #[inline(always)]
    fn spent(&mut self, state: StateId, from: u64, cycles: u64) {
        match self.timeline.within(from + cycles) {
            Some(bin) => *bin.of_mut(state) += Cycles(cycles),
            None => self.timeline.cut(from, from + cycles, |bin, from, to| *bin.of_mut(state) += Cycles(to - from)),
        }
    }
}

impl CellLane {
    pub fn new(bins: usize) -> CellLane {
        CellLane { timeline: Timeline::new(bins) }
    }

    /// The bins of a run of `cycles` cycles, in which the cell ended its last op just before cycle `clock`.
    pub fn finish(self, clock: u64, cycles: u64) -> Vec<StateTimes> {
        let (mut bins, width) = self.timeline.finish(cycles);
        for (bin, start) in bins.iter_mut().zip((0..).step_by(width as usize)) {
            let end = cycles.min(start + width);
            let ended = clock.clamp(start, end);
            // Every cycle up to the clock was spent in some way; those not entered moved a word.
            *bin.of_mut(MOVING) = Cycles(ended - start) - bin.total();
            *bin.of_mut(IDLE) = Cycles(end - ended);
        }
        bins
    }
}
