//! What has been executed since the last time that it was counted up.

use super::executable::{UNCOUNTED, WAIT};

/// Numbers of instructions by class, of waits for floating-point results, and of the first events that a program counts: 16 bits each,
/// so that adding all of them up is four additions. A difference of two is right as well where either has grown too large.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally([u64; Tally::WORDS]);

impl Tally {
    /// The most instructions that one can count: each waits twice at most, and is each event once.
    pub const MOST: u64 = Tally::MASK >> 1;
    /// How many events it counts.
    pub const EVENTS: usize = Tally::IN_A_WORD;
    const WORDS: usize = 4;
    const IN_A_WORD: usize = 4;
    const BITS: u32 = 16;
    const MASK: u64 = (1 << Tally::BITS) - 1;

    /// Waits.
    pub fn waits(number: u64) -> Tally {
        Tally::at(WAIT.into(), number)
    }

    /// An instruction of a class.
    pub fn one(class: u8) -> Tally {
        if class == UNCOUNTED { Tally::default() } else { Tally::at(class.into(), 1) }
    }

    /// An event, which is one of the first.
    pub fn event(event: usize) -> Tally {
        Tally::at((Tally::WORDS - 1) * Tally::IN_A_WORD + event, 1)
    }

    fn at(place: usize, number: u64) -> Tally {
        let mut tally = Tally::default();
        tally.0[place / Tally::IN_A_WORD] = number << (place % Tally::IN_A_WORD * Tally::BITS as usize);
        tally
    }

    /// Both together.
    #[inline(always)]
    pub fn with(self, other: Tally) -> Tally {
        Tally(std::array::from_fn(|word| self.0[word].wrapping_add(other.0[word])))
    }

    /// Without some that are part of it, or will be.
    #[inline(always)]
    pub fn without(self, other: Tally) -> Tally {
        Tally(std::array::from_fn(|word| self.0[word].wrapping_sub(other.0[word])))
    }

    /// The classes of which there are instructions, and how many; waits behind them.
    #[inline(always)]
    pub fn for_each_class(self, mut take: impl FnMut(u8, u64)) {
        let [classes @ .., _] = self.0;
        for (word, numbers) in classes.into_iter().enumerate() {
            each(numbers, |place, number| take((word * Tally::IN_A_WORD + place) as u8, number));
        }
    }

    /// Takes the events out that have happened, and how often.
    #[inline(always)]
    pub fn take_events(&mut self, take: impl FnMut(usize, u64)) {
        let [.., events] = &mut self.0;
        each(std::mem::take(events), take);
    }
}

/// The numbers of a word that are not 0, and their places.
#[inline(always)]
fn each(mut word: u64, mut take: impl FnMut(usize, u64)) {
    while word != 0 {
        let place = word.trailing_zeros() / Tally::BITS;
        let number = word >> (place * Tally::BITS) & Tally::MASK;
        word -= number << (place * Tally::BITS);
        take(place as usize, number);
    }
}
