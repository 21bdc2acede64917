//! What a unit of work is to a cell: cycles, and a state.

use super::states::working;
use crate::measure::{PathUnit, StateId};
use crate::quantities::Cycles;
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

    /// The units of a vocabulary that ops name, by their places.
    pub fn units(&self, vocabulary: &Vocabulary) -> Vec<PathUnit> {
        let end = vocabulary.units.iter().rposition(|unit| unit.used).map_or(0, |last| last + 1);
        let units = vocabulary.units[..end].iter().zip(0..);
        let priced = units.map(|(unit, place)| {
            let (cycles, state) = self.of(Unit(place));
            PathUnit { name: unit.name.clone(), state, cycles: Cycles(cycles) }
        });
        priced.collect()
    }
}
