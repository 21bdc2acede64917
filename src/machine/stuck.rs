//! A run that can go no further: who waits for whom.

use std::fmt;

use super::Channel;
use super::cell::Halt;
use super::op::{Op, OpKind};
use super::units::{Cycles, Words};

/// The host or a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Party {
    /// The host, at both ends of the array.
    Host,
    /// A cell, counted from 0 on the left.
    Cell(usize),
}

/// A run that can never end, and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{kind}, {} of {} still waiting", waits.len(), if waits.len() == 1 { "party" } else { "parties" })]
pub struct Stuck {
    /// What sort of standstill it is.
    pub kind: StuckKind,
    /// The chain of waits, each for the next one's party; in a deadlock the last one waits for the first.
    pub waits: Vec<Wait>,
}

/// The sorts of standstill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StuckKind {
    /// The waits form a loop.
    Deadlock,
    /// The chain ends with a party that has done all its ops, so that what the one before it waits for never comes.
    Starved {
        /// The party that has done all its ops.
        by: Party,
    },
}

/// One wait.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wait {
    /// Who waits.
    pub party: Party,
    /// For whom.
    pub on: Party,
    /// For what.
    pub for_what: WaitFor,
    /// Since which cycle.
    pub since: Cycles,
    /// The op that waits.
    pub op: Op,
    /// How many of the op's words have been moved.
    pub moved: Words,
    /// The ray whose op it is.
    pub ray: u32,
    /// The op's place in what the party does for that ray, from 0.
    pub position: usize,
}

/// What a wait is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaitFor {
    /// A word in an empty FIFO.
    Word {
        /// The channel read.
        channel: Channel,
        /// How many words the FIFO could hold.
        capacity: Words,
    },
    /// Room in a full FIFO.
    Room {
        /// The channel written.
        channel: Channel,
        /// How many words the FIFO holds.
        capacity: Words,
    },
    /// A message that comes back to the host.
    Return {
        /// The message's number, from 0.
        message: u64,
    },
    /// Words from where none can come: the host has no FIFO to read rays from.
    Nothing,
}

/// Where a party stands that is not done.
pub(super) struct Standing {
    pub party: Party,
    pub halt: Halt,
    pub cycle: u64,
    pub op: Op,
    pub moved: u64,
    pub ray: u32,
    pub position: usize,
    /// The number of cells of the array.
    pub cells: usize,
    /// Words that the FIFO can hold at which it stands, if it stands at one.
    pub capacity: Option<u64>,
}

impl Standing {
    /// The FIFO that it stands at, as the number of the link that leads there and the channel.
    pub fn fifo(&self) -> Option<(usize, Channel)> {
        match (self.party, self.halt) {
            (Party::Cell(index), Halt::NoWord) => match self.op.kind().reads()? {
                Channel::Z => Some((index + 1, Channel::Z)),
                channel => Some((index, channel)),
            },
            (Party::Cell(index), Halt::NoRoom) => match self.op.kind().writes()? {
                Channel::Z => Some((index, Channel::Z)),
                channel => Some((index + 1, channel)),
            },
            (Party::Host, Halt::NoRoom) => Some((0, self.op.kind().writes()?)),
            _ => None,
        }
    }

    fn waits_on(&self) -> Party {
        let index = match (self.party, self.halt) {
            (Party::Host, Halt::NoRoom) => return Party::Cell(0),
            (Party::Host, _) => return Party::Cell(self.cells - 1),
            (Party::Cell(index), _) => index,
        };
        // Words come from the left and room from the right; on Z it is the other way round.
        let on_z = matches!(self.fifo(), Some((_, Channel::Z)));
        let neighbour = if (self.halt == Halt::NoWord) == on_z { Some(index + 1) } else { index.checked_sub(1) };
        neighbour.filter(|&neighbour| neighbour < self.cells).map_or(Party::Host, Party::Cell)
    }

    fn for_what(&self) -> WaitFor {
        match (self.halt, self.fifo(), self.capacity.map(Words)) {
            (Halt::NoWord, Some((_, channel)), Some(capacity)) => WaitFor::Word { channel, capacity },
            (Halt::NoRoom, Some((_, channel)), Some(capacity)) => WaitFor::Room { channel, capacity },
            (Halt::NotReturned, ..) => WaitFor::Return { message: self.op.count() as u64 },
            _ => WaitFor::Nothing,
        }
    }

    fn wait(&self) -> Wait {
        Wait {
            party: self.party,
            on: self.waits_on(),
            for_what: self.for_what(),
            since: Cycles(self.cycle),
            op: self.op,
            moved: Words(self.moved),
            ray: self.ray,
            position: self.position,
        }
    }
}

/// Follows the waits from the leftmost party that is not done until they come back on themselves or end.
pub(super) fn diagnose(standing: impl Iterator<Item = Standing>) -> Stuck {
    let waits: Vec<Wait> = standing.map(|s| s.wait()).collect();
    let mut chain: Vec<Wait> = Vec::new();
    let mut next = waits.first();
    while let Some(wait) = next {
        if let Some(start) = chain.iter().position(|seen| seen.party == wait.party) {
            return Stuck { kind: StuckKind::Deadlock, waits: chain.split_off(start) };
        }
        chain.push(wait.clone());
        next = waits.iter().find(|other| other.party == wait.on);
    }
    let by = chain.last().map_or(Party::Host, |wait| wait.on);
    Stuck { kind: StuckKind::Starved { by }, waits: chain }
}

impl fmt::Display for Party {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Party::Host => write!(f, "the host"),
            Party::Cell(index) => write!(f, "cell {index}"),
        }
    }
}

impl fmt::Display for StuckKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StuckKind::Deadlock => write!(f, "deadlock"),
            StuckKind::Starved { by } => write!(f, "starved: {by} has done all its ops"),
        }
    }
}

impl fmt::Display for Wait {
    /// One sentence: `cell 1 waits for cell 0: Y1 is empty (0 of 512 words), since cycle 615, in i1 (op 4 of ray 7)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} waits for {}: ", self.party, self.on)?;
        let reader = |party: Party| match party {
            Party::Host => "host".to_owned(),
            Party::Cell(index) => index.to_string(),
        };
        match self.for_what {
            WaitFor::Word { channel, capacity } => {
                write!(f, "{channel}{} is empty (0 of {capacity})", reader(self.party))?
            }
            WaitFor::Room { channel, capacity } => {
                write!(f, "{channel}{} is full ({} of {capacity})", reader(self.on), capacity.0)?
            }
            WaitFor::Return { message } => write!(f, "hit number {message} has not come back")?,
            WaitFor::Nothing => write!(f, "nothing can come there")?,
        }
        write!(f, ", since cycle {}, in {}", self.since.0, self.op)?;
        if self.moved.0 > 0 && !matches!(self.op.kind(), OpKind::Compute(_)) {
            write!(f, " ({} of it moved)", self.moved)?;
        }
        write!(f, ", op {} of ray {}", self.position, self.ray)
    }
}
