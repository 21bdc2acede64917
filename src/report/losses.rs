//! What is lost against the busiest cell's work, and to what.

use super::summary::{percent, time};
use crate::measure::{Clock, Measured, StateKind, StateTimes};
use crate::quantities::Cycles;
use crate::run::Reordered;

/// A share of the run that is worth a word.
pub(super) const NOTABLE: f64 = 0.10;

/// The cycles of a run in which its busiest cell does not work, by what would give them back. They sum to what that cell lacks to the
/// run.
///
/// Held against it is the same work in a random order of the rays, timed as exactly: what that takes less is due to the order, what it
/// still loses is not. Of that, the cell spends some before it has done its first ray and after its last; the rest is lost as the work
/// of a ray is uneven over the cells and from ray to ray, and FIFOs are as deep as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Losses {
    /// The cell that works most.
    pub cell: usize,
    /// Cycles that another order of the rays gives back.
    pub order: Cycles,
    /// Cycles that are lost in any order as rays differ.
    pub variance: Cycles,
    /// Cycles in which the cell has no first ray yet, or no further one.
    pub first_and_last: Cycles,
    /// Cycles of the same rays in a random order.
    pub shuffled: Cycles,
    /// Whether the host waits for hits, and the order's part is that of waiting, too.
    #[serde(skip)]
    waits: bool,
}

impl Losses {
    /// Those of a run, of which some or all rays were timed in a random order.
    pub fn new(run: &Measured, other: &Reordered) -> Option<Losses> {
        let cell = run.busiest()?;
        let works = |run: &Measured, times: &StateTimes| run.topology.states.works(times).0;
        let (work, work_there) = (works(run, &run.stations[cell]), works(&other.stats, &other.stats.stations[cell]));
        let lost = run.cycles.0.saturating_sub(work);
        let lost_there = other.stats.cycles.0.saturating_sub(work_there);
        let states = &other.stats.topology.states;
        let (first, times) = (&other.first[cell], &other.stats.stations[cell]);
        let before = states.waits(first).0 + states.blocked(first).0;
        let after = states.sum(times, |state| state.kind == StateKind::Idle).0;
        let ends_there = (before + after).min(lost_there);
        let ends = ends_there.min(lost);
        // A sample's loss is that of all rays in the proportion of their work.
        let of_all = |cycles: u64| (u128::from(cycles) * u128::from(work) / u128::from(work_there.max(1))) as u64;
        let variance_of_any = of_all(lost_there - ends_there);
        let variance = variance_of_any.min(lost - ends);
        Some(Losses {
            cell,
            order: Cycles(lost - ends - variance),
            variance: Cycles(variance),
            first_and_last: Cycles(ends),
            shuffled: Cycles(work + ends_there + variance_of_any),
            waits: other.waits,
        })
    }

    /// All of them.
    pub fn all(&self) -> Cycles {
        self.order + self.variance + self.first_and_last
    }

    /// What is lost to what, in a sentence or two.
    pub fn sentence(&self, run: &Measured, clock: Clock) -> String {
        let part = |cycles: Cycles| percent(cycles, run.cycles);
        let waiting = if self.waits { [" and to waiting for hits", ", without waiting for hits,"] } else { [""; 2] };
        let lost = format!(
            "Lost against the work of cell {}: {} of the time; {} to the order of the rays{}, {} to work that varies from ray to ray, \
             {} to the first and the last rays.",
            self.cell,
            part(self.all()),
            part(self.order),
            waiting[0],
            part(self.variance),
            part(self.first_and_last),
        );
        if run.share(self.order) <= NOTABLE {
            return lost;
        }
        let shuffled = time(clock.seconds(self.shuffled));
        format!("{lost} In a random order (--order shuffle:SEED){} they would take about {shuffled}.", waiting[1])
    }
}
