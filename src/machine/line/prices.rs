//! What a unit of work is to a cell: cycles, and a state.

use super::states::working;
use crate::measure::StateId;
use crate::seam::{Costs, Unit, Vocabulary};

/// The machine's costs, laid out to be looked up at each op.
#[derive(Debug)]
pub struct Prices([(u64, StateId); Vocabulary::MOST_UNITS]);

impl Prices {
    pub fn new(costs: &Costs) -> Prices {
        let price = |unit: usize| {
            let unit = Unit(unit as u8);
            (costs.of(unit).0, working(costs.activity(unit)))
        };
        Prices(std::array::from_fn(price))
    }

    /// Cycles of a unit, and the state of a cell that works on it.
    #[inline(always)]
    pub fn of(&self, unit: Unit) -> (u64, StateId) {
        self.0[unit.0 as usize % Vocabulary::MOST_UNITS]
    }
}
