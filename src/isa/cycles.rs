//! What instructions cost.

use serde::{Deserialize, Serialize};

use super::kernels::FLOAT_LATENCY;
use super::table::Class;

/// Cycles of an instruction of each class. The words that it moves take a cycle each beside that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstructionCycles {
    /// [`Class::Integer`].
    pub integer: u32,
    /// [`Class::Multiply`].
    pub multiply: u32,
    /// [`Class::Divide`].
    pub divide: u32,
    /// [`Class::Load`].
    pub load: u32,
    /// [`Class::Store`].
    pub store: u32,
    /// [`Class::FloatAdd`].
    pub float_add: u32,
    /// [`Class::FloatMultiply`].
    pub float_multiply: u32,
    /// [`Class::FloatDivide`].
    pub float_divide: u32,
    /// [`Class::FloatCompare`].
    pub float_compare: u32,
    /// [`Class::Branch`].
    pub branch: u32,
    /// Cycles that an instruction waits for a floating-point result that is still in the pipeline. `None` for a unit whose
    /// instructions have their results when they end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub float_latency: Option<u32>,
}

impl InstructionCycles {
    /// The most cycles of an instruction, and of a wait.
    pub const MOST: u32 = 10_000;

    /// Cycles of a class.
    pub fn of(&self, class: Class) -> u32 {
        let mut copy = *self;
        *copy.slot(class)
    }

    /// Cycles of a unit of work, by its name: of a class, or of a wait for a floating-point result. `None` if it is neither.
    pub fn of_unit(&self, name: &str) -> Option<u32> {
        if name == FLOAT_LATENCY {
            return Some(self.float_latency.unwrap_or(0));
        }
        let class = Class::ALL.into_iter().find(|class| class.name() == name)?;
        Some(self.of(class))
    }

    /// Whether waits for floating-point results are counted.
    pub fn counts_waits(&self) -> bool {
        self.float_latency.is_some()
    }

    /// Changes the cycles of a class.
    pub fn set(&mut self, class: Class, cycles: u32) {
        *self.slot(class) = cycles;
    }

    fn slot(&mut self, class: Class) -> &mut u32 {
        match class {
            Class::Integer => &mut self.integer,
            Class::Multiply => &mut self.multiply,
            Class::Divide => &mut self.divide,
            Class::Load => &mut self.load,
            Class::Store => &mut self.store,
            Class::FloatAdd => &mut self.float_add,
            Class::FloatMultiply => &mut self.float_multiply,
            Class::FloatDivide => &mut self.float_divide,
            Class::FloatCompare => &mut self.float_compare,
            Class::Branch => &mut self.branch,
        }
    }
}
