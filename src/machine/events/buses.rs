//! Buses that all tasks share.

use super::network::Passage;
use crate::measure::{LinkMessages, LinkStats};
use crate::quantities::Cycles;

/// Some buses of one rate. A message takes the bus that is free first, in the order in which messages are ready to go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Buses {
    /// Thousandths of a cycle that a byte takes.
    byte: u64,
    /// For each bus, when it is free.
    free: Vec<u64>,
    /// For each bus, how long it was busy, and with what.
    busy: Vec<(u64, LinkMessages)>,
}

impl Buses {
    /// So many buses, at least one, that carry a byte in so many thousandths of a cycle.
    pub fn new(count: usize, byte_millicycles: u64) -> Buses {
        let count = count.max(1);
        Buses { byte: byte_millicycles, free: vec![0; count], busy: vec![Default::default(); count] }
    }

    /// Thousandths of a cycle that a byte takes.
    pub fn byte_millicycles(&self) -> u64 {
        self.byte
    }

    /// Cycles for which a message has a bus, rounded up.
    pub fn time(&self, bytes: u64) -> Cycles {
        Cycles((u128::from(bytes) * u128::from(self.byte)).div_ceil(1000) as u64)
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.free.len()
    }

    /// Takes a message that is ready to go.
    pub(super) fn carry(&mut self, ready: u64, bytes: u64) -> Passage {
        let time = self.time(bytes).0;
        let first = (0..self.free.len()).min_by_key(|&bus| self.free[bus]).unwrap_or(0);
        let starts = ready.max(self.free[first]);
        self.free[first] = starts + time;
        let (busy, messages) = &mut self.busy[first];
        *busy += time;
        messages.sent += 1;
        messages.bytes += bytes;
        messages.waited += Cycles(starts - ready);
        Passage { bus: first, starts, free: starts + time, arrives: starts + time }
    }

    /// How long each bus was busy, and with what.
    pub(super) fn stats(&self) -> Vec<LinkStats> {
        let stats = |&(busy, messages): &(u64, LinkMessages)| LinkStats {
            from: None,
            into: None,
            busy: Cycles(busy),
            read: Cycles(busy),
            messages: Some(messages),
        };
        self.busy.iter().map(stats).collect()
    }
}
