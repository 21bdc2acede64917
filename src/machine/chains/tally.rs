//! Cycles and counts by place, cause and bin of time.

use std::ops::Range;

use crate::seam::Unit;

/// What cycles of a path are spent on, as a number below 128, which each machine has its own of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code(pub u8);

impl Code {
    /// A unit of work.
    pub fn work(unit: Unit) -> Code {
        Code(unit.0)
    }
}

/// Cycles of one cause, at one station, in one bin.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
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
pub fn normalize(entries: &mut Vec<Entry>, from: usize) {
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

/// Writes entries, adding up those of one bin and one station as long as it stays with these.
#[derive(Debug)]
pub struct Pen {
    pub entries: Vec<Entry>,
    /// The piece under way begins here.
    piece: usize,
    /// The station and the bin that it is at, as the cycles of that.
    station: usize,
    cycles: Range<u64>,
    /// By cause, cycles and counts there that are no entries yet, and which of these are not 0.
    sums: [[u64; 2]; Pen::CODES],
    used: u128,
    /// A bin is 2^shift cycles wide.
    pub shift: u32,
}

impl Pen {
    const CODES: usize = 128;

    /// For bins of 2^shift cycles.
    pub fn new(shift: u32) -> Pen {
        Pen { entries: Vec::new(), piece: 0, station: 0, cycles: 0..0, sums: [[0; 2]; Pen::CODES], used: 0, shift }
    }

    /// What follows is of that station.
    #[inline]
    pub fn turn_to(&mut self, station: usize) {
        if station != self.station {
            self.flush();
            self.station = station;
        }
    }

    /// Enters cycles `from..from + cycles`, in which something happened `count` times.
    #[inline(always)]
    pub fn add(&mut self, code: Code, from: u64, cycles: u64, count: u64) {
        if self.cycles.start <= from && from + cycles <= self.cycles.end {
            self.enter(code, cycles, count);
        } else {
            self.cut(code, from, cycles, count);
        }
    }

    /// Cuts the cycles where bins meet.
    #[cold]
    fn cut(&mut self, code: Code, mut from: u64, mut cycles: u64, count: u64) {
        loop {
            self.flush();
            let start = from >> self.shift << self.shift;
            self.cycles = start..start + (1 << self.shift);
            let part = cycles.min(self.cycles.end - from);
            (from, cycles) = (from + part, cycles - part);
            if cycles == 0 {
                return self.enter(code, part, count);
            }
            self.enter(code, part, 0);
        }
    }

    #[inline(always)]
    fn enter(&mut self, code: Code, cycles: u64, count: u64) {
        let [all_cycles, all_counts] = &mut self.sums[code.0 as usize % Pen::CODES];
        *all_cycles += cycles;
        *all_counts += count;
        self.used |= 1 << (code.0 as usize % Pen::CODES);
    }

    /// Makes entries of the sums.
    fn flush(&mut self) {
        while self.used != 0 {
            let code = self.used.trailing_zeros();
            self.used &= self.used - 1;
            let [cycles, count] = std::mem::take(&mut self.sums[code as usize]);
            if count > 0 || cycles > 0 {
                let key = Entry::key(self.cycles.start >> self.shift, self.station, Code(code as u8));
                self.entries.push(Entry { key, cycles, count });
            }
        }
    }

    /// Ends a piece: what was entered since the last one ended.
    pub fn end_piece(&mut self) -> Range<u32> {
        self.flush();
        let piece = self.piece as u32..self.entries.len() as u32;
        self.piece = self.entries.len();
        piece
    }
}
