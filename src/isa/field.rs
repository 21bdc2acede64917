//! The fields of an instruction word.

use std::ops::{Range, RangeInclusive};

use bitvec::field::BitField;
use bitvec::order::Lsb0;
use bitvec::view::BitView;

/// A field of an instruction word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Field {
    /// Which instruction.
    Opcode,
    /// The first register that is written down.
    First,
    /// The second.
    Second,
    /// The third.
    Third,
    /// A signed constant or distance behind two registers.
    Short,
    /// A signed constant or distance behind one register or none.
    Long,
}

impl Field {
    /// The bits that it takes, counted from the lowest.
    pub const fn bits(self) -> Range<usize> {
        match self {
            Field::Opcode => 24..32,
            Field::First => 18..24,
            Field::Second => 12..18,
            Field::Third => 6..12,
            Field::Short => 0..12,
            Field::Long => 0..18,
        }
    }

    /// What a signed constant in it can be.
    pub fn range(self) -> RangeInclusive<i64> {
        let half = 1i64 << (self.bits().len() - 1);
        -half..=half - 1
    }

    pub(super) fn get(self, word: u32) -> u32 {
        word.view_bits::<Lsb0>()[self.bits()].load_le()
    }

    pub(super) fn get_signed(self, word: u32) -> i32 {
        word.view_bits::<Lsb0>()[self.bits()].load_le()
    }

    pub(super) fn set(self, word: &mut u32, value: u32) {
        word.view_bits_mut::<Lsb0>()[self.bits()].store_le(value);
    }
}
