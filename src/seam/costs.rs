//! What units of work cost: the machine's part of an op.

use std::sync::Arc;

use super::{Activity, Unit, Vocabulary};
use crate::quantities::Cycles;

/// A vocabulary with a price for each unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Costs {
    vocabulary: Arc<Vocabulary>,
    cycles: Vec<Cycles>,
}

impl Costs {
    /// The most cycles of a unit, so that no sum of them leaves 64 bits.
    pub const MOST: Cycles = Cycles(1_000_000_000);

    /// A vocabulary whose units cost what `price` says.
    pub fn new(vocabulary: Arc<Vocabulary>, price: impl FnMut(Unit) -> Cycles) -> Costs {
        let units = (0..vocabulary.units.len()).map(|unit| Unit(unit as u8));
        let cycles = units.map(price).map(|cycles| cycles.min(Costs::MOST)).collect();
        Costs { vocabulary, cycles }
    }

    /// The units.
    pub fn vocabulary(&self) -> &Arc<Vocabulary> {
        &self.vocabulary
    }

    /// What a unit costs; nothing if the vocabulary has no such unit.
    #[inline]
    pub fn of(&self, unit: Unit) -> Cycles {
        self.cycles.get(unit.0 as usize).copied().unwrap_or_default()
    }

    /// Each unit's name and what it costs.
    pub fn by_name(&self) -> impl Iterator<Item = (&str, Cycles)> {
        self.vocabulary.units.iter().map(|unit| unit.name.as_str()).zip(self.cycles.iter().copied())
    }

    /// What a unit belongs to.
    pub fn activity(&self, unit: Unit) -> Activity {
        self.vocabulary.unit(unit).map_or(Activity(0), |unit| unit.activity)
    }
}
