//! What FIFOs are called.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::measure::Actor;
use crate::seam::Channel;

/// A FIFO of a row of cells, by its channel and the one that reads it: `X0`, `Y3`, `Yhost`, `Z1` in reports and in machine files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct FifoName {
    /// The channel.
    pub channel: Channel,
    /// Who reads it.
    pub reader: Actor,
}

impl FifoName {
    /// Whether a row of so many cells has such a FIFO.
    pub fn is_among(self, cells: usize) -> bool {
        match (self.channel, self.reader) {
            (Channel::X, Actor::Station(cell)) => cell < cells,
            (Channel::Y, Actor::Station(cell)) => (1..cells).contains(&cell),
            (Channel::Y, Actor::Host) => true,
            (Channel::Z, Actor::Station(cell)) => cell + 1 < cells,
            (Channel::X | Channel::Z, Actor::Host) => false,
        }
    }

    /// Its place in reports: by channel, then from left to right.
    fn place(self) -> (Channel, usize) {
        match self.reader {
            Actor::Station(cell) => (self.channel, cell),
            Actor::Host => (self.channel, usize::MAX),
        }
    }
}

impl Ord for FifoName {
    fn cmp(&self, other: &FifoName) -> Ordering {
        self.place().cmp(&other.place())
    }
}

impl PartialOrd for FifoName {
    fn partial_cmp(&self, other: &FifoName) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl FromStr for FifoName {
    type Err = String;

    fn from_str(text: &str) -> Result<FifoName, String> {
        let channel = Channel::ALL.into_iter().find(|channel| text.starts_with(&channel.to_string()));
        let name = channel.and_then(|channel| {
            let reader = match &text[1..] {
                "host" => Actor::Host,
                cell => Actor::Station(cell.parse().ok()?),
            };
            Some(FifoName { channel, reader })
        });
        let known = name.filter(|name| name.is_among(usize::MAX) && name.to_string() == text);
        known.ok_or_else(|| format!("'{text}' is no FIFO; they are named as in reports: X0, Y3, Yhost, Z1"))
    }
}

impl fmt::Display for FifoName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reader {
            Actor::Host => write!(f, "{}host", self.channel),
            Actor::Station(cell) => write!(f, "{}{cell}", self.channel),
        }
    }
}

impl TryFrom<String> for FifoName {
    type Error = String;

    fn try_from(text: String) -> Result<FifoName, String> {
        text.parse()
    }
}

impl From<FifoName> for String {
    fn from(name: FifoName) -> String {
        name.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written_and_sorted_as_in_reports() {
        let names = ["X0", "X2", "X10", "Y1", "Y11", "Yhost", "Z0", "Z7"];
        let mut read: Vec<FifoName> = names.iter().rev().map(|name| name.parse().unwrap()).collect();
        read.sort();
        assert_eq!(read.iter().map(FifoName::to_string).collect::<Vec<_>>(), names);
        for wrong in ["", "X", "x0", "X-1", "X01", "X 1", "Xhost", "Y0", "Zhost", "W1", "Yhosts", "é1"] {
            assert!(wrong.parse::<FifoName>().unwrap_err().contains("as in reports"), "{wrong}");
        }
    }

    #[test]
    fn a_row_has_a_fifo_into_each_cell_and_into_the_host() {
        let among = |name: &str, cells| name.parse::<FifoName>().unwrap().is_among(cells);
        assert!(among("X2", 3) && among("Y2", 3) && among("Yhost", 1) && among("Z1", 3));
        assert!(!among("X3", 3) && !among("Y3", 3) && !among("Z2", 3) && !among("Z0", 1));
    }
}
