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
    /// What the cell had spent when something was last entered. All that it has spent since lies in the bin under way.
    entered: StateTimes,
}

impl Watcher for &mut CellLane {
    #[inline(always)]
    fn spent(&mut self, state: StateId, from: u64, cycles: u64, before: &StateTimes) {
        if self.timeline.within(from + cycles).is_none() {
            self.leave_bin(state, from, cycles, before);
        }
    }
}

impl CellLane {
    pub fn new(bins: usize) -> CellLane {
        CellLane { timeline: Timeline::new(bins), entered: StateTimes::default() }
    }

    /// Enters what the cell had spent before, and what it then spent in one state beyond the bin under way.
    #[cold]
    #[inline(never)]
    fn leave_bin(&mut self, state: StateId, from: u64, cycles: u64, before: &StateTimes) {
        self.enter(before);
        self.timeline.cut(from, from + cycles, |bin, from, to| *bin.of_mut(state) += Cycles(to - from));
        *self.entered.of_mut(state) += Cycles(cycles);
    }

    /// Enters what the cell has spent in the bin under way.
    fn enter(&mut self, times: &StateTimes) {
        self.timeline.under_way().add(&times.since(&self.entered));
        self.entered = *times;
    }

    /// The bins of a run of `cycles` cycles, in which the cell ended its last op just before cycle `clock` and has spent `times`.
    pub fn finish(mut self, (clock, times): (u64, &StateTimes), cycles: u64) -> Vec<StateTimes> {
        self.enter(times);
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
