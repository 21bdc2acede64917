//! Cycles and counts by place, cause and bin of time.

use std::ops::Range;

use crate::seam::{Channel, Unit, Vocabulary};

/// What cycles of a path are spent on, as a number below 128.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Code(pub u8);

impl Code {
    pub const MOVE: Code = Code(Vocabulary::MOST_UNITS as u8);

    pub fn work(unit: Unit) -> Code {
        Code(unit.0)
    }

    pub fn latency(channel: Channel) -> Code {
        Code(Code::MOVE.0 + 1 + channel as u8)
    }

    pub fn wire(channel: Channel) -> Code {
        Code(Code::MOVE.0 + 4 + channel as u8)
    }

    pub fn slot(channel: Channel) -> Code {
        Code(Code::MOVE.0 + 7 + channel as u8)
    }
}

/// Cycles of one cause, at one station, in one bin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Bin, station and cause, in the order in which they sort.
    key: u64,
    pub cycles: u64,
    pub count: u64,
}

/// Below a key's bin: station and cause.
const BIN: u32 = 32;
const STATION: u32 = 8;

impl Entry {
    fn key(bin: u64, station: usize, code: Code) -> u64 {
        bin << BIN | (station as u64) << STATION | code.0 as u64
    }

    pub fn bin(&self) -> usize {
        (self.key >> BIN) as usize
    }

    pub fn station(&self) -> usize {
        (self.key >> STATION) as usize & ((1 << (BIN - STATION)) - 1)
    }

    pub fn code(&self) -> Code {
        Code(self.key as u8)
    }

    /// The same with bins twice as wide.
    pub fn widen(&mut self) {
        let rest = self.key & ((1 << BIN) - 1);
        self.key = self.key >> (BIN + 1) << BIN | rest;
    }
}

/// Sorts entries and adds up those of one key.
pub(super) fn normalize(entries: &mut Vec<Entry>, from: usize) {
    entries[from..].sort_unstable_by_key(|entry| entry.key);
    let mut end = from;
    for index in from..entries.len() {
        let entry = entries[index];
        if end > from && entries[end - 1].key == entry.key {
            entries[end - 1].cycles += entry.cycles;
            entries[end - 1].count += entry.count;
        } else {
            entries[end] = entry;
            end += 1;
        }
    }
    entries.truncate(end);
}

/// Writes entries, adding up those of a bin as long as it stays in it.
#[derive(Debug)]
pub(super) struct Pen {
    pub entries: Vec<Entry>,
    /// The entries of the bin and the piece under way begin here.
    open: usize,
    piece: usize,
    bin: u64,
    /// A bin is 2^shift cycles wide.
    pub shift: u32,
}

impl Pen {
    /// For bins of 2^shift cycles.
    pub fn new(shift: u32) -> Pen {
        Pen { entries: Vec::new(), open: 0, piece: 0, bin: 0, shift }
    }

    /// Enters cycles `from..from + cycles`, in which something happened `count` times.
    pub fn add(&mut self, station: usize, code: Code, from: u64, cycles: u64, count: u64) {
        if count == 0 {
            return;
        }
        let last = (from + cycles.max(1) - 1) >> self.shift;
        let mut from = from;
        let mut left = cycles;
        while from >> self.shift < last {
            let part = ((from >> self.shift) + 1 << self.shift) - from;
            self.enter(from >> self.shift, station, code, part, 0);
            from += part;
            left -= part;
        }
        self.enter(last, station, code, left, count);
    }

    fn enter(&mut self, bin: u64, station: usize, code: Code, cycles: u64, count: u64) {
        if bin != self.bin {
            self.open = self.entries.len();
            self.bin = bin;
        }
        let key = Entry::key(bin, station, code);
        match self.entries[self.open..].iter_mut().find(|entry| entry.key == key) {
            Some(entry) => {
                entry.cycles += cycles;
                entry.count += count;
            }
            None => self.entries.push(Entry { key, cycles, count }),
        }
    }

    /// Ends a piece: what was entered since the last one ended.
    pub fn end_piece(&mut self) -> Range<u32> {
        let piece = self.piece as u32..self.entries.len() as u32;
        self.piece = self.entries.len();
        self.open = self.piece;
        piece
    }
}
