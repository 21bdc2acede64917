//! Numbers in few letters.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::measure::JobSpan;
use crate::quantities::Cycles;

/// Whole numbers in as few bytes as they need, seven bits each, the lowest first; in base 64. Those that may be negative are
/// [folded].
#[derive(Serialize)]
pub struct Packed(String);

/// 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
pub fn folded(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}

impl Packed {
    pub fn new(numbers: impl IntoIterator<Item = u64>) -> Packed {
        let mut bytes = Vec::new();
        for mut number in numbers {
            while number > 0x7f {
                bytes.push(number as u8 | 0x80);
                number >>= 7;
            }
            bytes.push(number as u8);
        }
        Packed(STANDARD.encode(bytes))
    }

    /// For each job its number against the one before it, when it began after that had, and how long it took.
    pub fn jobs(jobs: &[JobSpan], (start, end): (Cycles, Cycles)) -> Packed {
        let (mut job, mut from) = (0, start);
        Packed::new(jobs.iter().filter(|span| span.from < end).flat_map(|span| {
            let numbers =
                [folded(i64::from(span.job) - job), span.from.0 - from.0, span.until.min(end).0 - span.from.0];
            (job, from) = (i64::from(span.job), span.from);
            numbers
        }))
    }

    /// For each row of times, one behind the other: the cycles since the end of the row before it, and how many they are.
    pub fn times(times: &[Cycles], (start, end): (Cycles, Cycles)) -> Packed {
        let times = &times[..times.partition_point(|&time| time < end)];
        let mut next = start;
        Packed::new(times.chunk_by(|a, b| a.0 + 1 == b.0).flat_map(|row| {
            let numbers = [row[0].0 - next.0, row.len() as u64];
            next = row[0] + Cycles(row.len() as u64);
            numbers
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_as_few_bytes_as_they_need() {
        let packed = Packed::new([0, 127, 128, 300]);
        assert_eq!(STANDARD.decode(packed.0).unwrap(), [0, 127, 0x80, 1, 0xac, 2]);
        assert_eq!([0, -1, 1, -2, i64::MAX].map(folded), [0, 1, 2, 3, u64::MAX - 1]);
    }

    #[test]
    fn times_are_told_row_by_row() {
        let times = [3, 4, 5, 9, 11, 12].map(Cycles);
        let packed = Packed::times(&times, (Cycles(1), Cycles(12)));
        assert_eq!(STANDARD.decode(packed.0).unwrap(), [2, 3, 3, 1, 1, 1]);
    }
}
