//! How much memory recordings may take.

use std::fmt;
use std::str::FromStr;

/// The memory that there is for a recording that points of a sweep share, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RecordingMemory(pub u64);

/// The units in which it is told and asked for.
const UNITS: [(&str, u64); 3] = [("GB", 1_000_000_000), ("MB", 1_000_000), ("kB", 1000)];

impl RecordingMemory {
    /// As much as it takes.
    pub const UNBOUNDED: RecordingMemory = RecordingMemory(u64::MAX);

    /// Where the machine does not tell what it has.
    const UNKNOWN: u64 = 1 << 30;

    /// Half of what is free now, for a process that works with so many threads of all that the machine could run: others may
    /// do as it does on the rest.
    pub fn fitting(threads: usize) -> RecordingMemory {
        let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get()).max(threads) as u64;
        let shared = free_bytes().unwrap_or(RecordingMemory::UNKNOWN) / 2;
        RecordingMemory(shared / cores * threads as u64)
    }
}

/// What is free on Linux: of the machine, and of what a control group leaves to this process.
fn free_bytes() -> Option<u64> {
    let meminfo = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let free: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some((free * 1024).min(group_bytes().unwrap_or(u64::MAX)))
}

/// What the control group of this process leaves to it, if it has a limit.
fn group_bytes() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let group = groups.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let number = |file: &str| -> Option<u64> {
        std::fs::read_to_string(format!("/sys/fs/cgroup/{group}/{file}")).ok()?.trim().parse().ok()
    };
    Some(number("memory.max")?.saturating_sub(number("memory.current")?))
}

impl FromStr for RecordingMemory {
    type Err = String;

    /// `512MB`, `1.5 GB`.
    fn from_str(text: &str) -> Result<RecordingMemory, String> {
        let expected = || "expected a number of bytes with its unit, such as 500MB or 8GB".to_owned();
        let (number, bytes) =
            UNITS.iter().find_map(|(unit, bytes)| Some((text.strip_suffix(unit)?, *bytes))).ok_or_else(expected)?;
        let number: f64 = number.trim().parse().map_err(|_| expected())?;
        let bytes = number * bytes as f64;
        if (0.0..1e18).contains(&bytes) { Ok(RecordingMemory(bytes as u64)) } else { Err(expected()) }
    }
}

impl fmt::Display for RecordingMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (unit, bytes) = UNITS.into_iter().find(|(_, bytes)| self.0 >= *bytes).unwrap_or(UNITS[2]);
        let number = (self.0 as f64 / bytes as f64 * 10.0).round() / 10.0;
        write!(f, "{number} {unit}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_read_as_it_is_written() {
        for (text, bytes) in [("8GB", 8_000_000_000), ("1.5 MB", 1_500_000), ("0kB", 0), ("0.25 kB", 250)] {
            assert_eq!(text.parse(), Ok(RecordingMemory(bytes)));
        }
        for text in ["8 GB", "1.5 MB", "500 kB", "0 kB"] {
            assert_eq!(text.parse::<RecordingMemory>().map(|memory| memory.to_string()), Ok(text.to_owned()));
        }
        for wrong in ["", "8", "GB", "-1GB", "nanGB", "infGB", "1e30GB", "8gb", "8 TB"] {
            assert!(wrong.parse::<RecordingMemory>().unwrap_err().contains("500MB"), "{wrong}");
        }
    }

    #[test]
    fn more_threads_may_take_more() {
        let [one, all] = [1, 64].map(RecordingMemory::fitting);
        assert!(RecordingMemory(0) < one && one < all, "{one} {all}");
    }
}
