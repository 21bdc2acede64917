//! The machine's parameters, as data.

use std::collections::BTreeMap;

use super::FifoName;
use crate::error::InputError;
use crate::measure::Clock;
use crate::quantities::{Cycles, Words};

/// An array's clock, links and FIFOs (§4.2, and the readings that the machine file explains).
#[derive(Clone, Debug, PartialEq)]
pub struct MachineSpec {
    /// Length of a cycle, in ns.
    pub clock_ns: f64,
    /// Size of a word, in bytes.
    pub word_bytes: u32,
    /// Words that each input FIFO holds (§4.2: 512).
    pub fifo_words: Words,
    /// Rate of a link, in 10^6 bytes a second (§4.2: 80).
    pub link_mb_s: f64,
    /// What that rate counts.
    pub rate_counts: RateCounts,
    /// Cycles from the write of a word to the first in which it can be read, at least 1.
    pub latency: Cycles,
    /// Words of memory of a cell; unlimited if `None`.
    pub memory_words: Option<Words>,
    /// Words that the FIFOs of X, Y and Z hold, where that is not `fifo_words`.
    pub channel_words: [Option<Words>; 3],
    /// Words that single FIFOs hold, whatever the others of their channel do.
    pub own_words: BTreeMap<FifoName, Words>,
}

/// What a link's rate counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum RateCounts {
    /// The words of both channels together.
    Link,
    /// The words of each channel by itself.
    Channel,
}

impl std::str::FromStr for RateCounts {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<RateCounts, &'static str> {
        match text.to_ascii_lowercase().as_str() {
            "link" => Ok(RateCounts::Link),
            "channel" => Ok(RateCounts::Channel),
            _ => Err("expected link or channel"),
        }
    }
}

/// A link's rate in cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkRate {
    /// Cycles from one word to the next, rounded up: from 1 to [`MachineSpec::MAX_WORD_CYCLES`].
    pub cycles_per_word: u64,
    /// Between which words.
    pub counts: RateCounts,
}

impl Default for MachineSpec {
    /// PCS: 50 ns, 32-bit words, 512-word FIFOs, 80 Mbyte/s a link.
    fn default() -> Self {
        MachineSpec {
            clock_ns: 50.0,
            word_bytes: 4,
            fifo_words: Words(512),
            link_mb_s: 80.0,
            rate_counts: RateCounts::Link,
            latency: Cycles(1),
            memory_words: None,
            channel_words: [None; 3],
            own_words: BTreeMap::new(),
        }
    }
}

impl MachineSpec {
    /// The largest FIFO that can be simulated, in words.
    pub const MAX_FIFO_WORDS: u64 = 1 << 20;

    /// The longest latency that can be simulated, in cycles.
    pub const MAX_LATENCY_CYCLES: u64 = 1_000_000;

    /// The slowest link that can be simulated, in cycles a word, so that no clock leaves 64 bits.
    pub const MAX_WORD_CYCLES: u64 = 1_000_000;

    /// Words that a FIFO holds, from 1 to [`MachineSpec::MAX_FIFO_WORDS`]: as many as its own entry says, else its channel's,
    /// else that of all.
    pub fn fifo_words_of(&self, fifo: FifoName) -> Words {
        let own = self.own_words.get(&fifo).copied();
        let words = own.or(self.channel_words[fifo.channel as usize]).unwrap_or(self.fifo_words);
        Words(words.0.clamp(1, Self::MAX_FIFO_WORDS))
    }

    /// Fails if a FIFO has a depth of its own that a row of so many cells has not.
    pub fn check_fifos(&self, cells: usize) -> Result<(), InputError> {
        let Some(name) = self.own_words.keys().find(|name| !name.is_among(cells)) else { return Ok(()) };
        let row = if cells == 1 { "of 1 cell".to_owned() } else { format!("of {cells} cells") };
        let error =
            InputError::new(format!("the machine gives FIFO {name} a depth of its own, and a row {row} has none such"));
        Err(error.help("take it out of fifo_words_of, or run as many cells as the machine is made for"))
    }

    /// Cycles from the write of a word to its first read, from 1 to [`MachineSpec::MAX_LATENCY_CYCLES`].
    pub fn link_latency(&self) -> Cycles {
        Cycles(self.latency.0.clamp(1, Self::MAX_LATENCY_CYCLES))
    }

    /// The rate of a link in cycles.
    pub fn link_rate(&self) -> LinkRate {
        let exact = self.exact_cycles_per_word();
        LinkRate { cycles_per_word: round_up(exact).clamp(1, Self::MAX_WORD_CYCLES), counts: self.rate_counts }
    }

    /// Cycles from one word to the next as the rate has it, before it is rounded up.
    pub fn exact_cycles_per_word(&self) -> f64 {
        let word_ns = self.word_bytes as f64 / self.link_mb_s * 1e3;
        word_ns / self.clock_ns
    }

    /// A time in µs as cycles, rounded up, and whether it had to be rounded.
    pub fn cycles_of_us(&self, us: f64) -> (Cycles, bool) {
        let exact = us * 1e3 / self.clock_ns;
        let cycles = round_up(exact);
        (Cycles(cycles), !is_whole(exact))
    }

    /// A number of cycles in seconds of simulated time.
    pub fn seconds(&self, cycles: Cycles) -> f64 {
        self.clock().seconds(cycles)
    }

    /// The array's clock.
    pub fn clock(&self) -> Clock {
        Clock { cycle_ns: self.clock_ns }
    }

    /// Whether the link's rate is no whole number of cycles a word, and so had to be rounded.
    pub fn rounds_link_rate(&self) -> bool {
        !is_whole(self.exact_cycles_per_word()) || self.exact_cycles_per_word() < 1.0
    }
}

/// Decimal fractions are not exact in binary: 7.8 µs are 156 cycles of 50 ns, not 157.
fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() <= 1e-12 * value.abs()
}

fn round_up(value: f64) -> u64 {
    if is_whole(value) { value.round() as u64 } else { value.ceil() as u64 }
}
