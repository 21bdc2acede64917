//! A run that can go no further: who waits for whom.

use std::fmt;

use super::cursor::Halt;
use crate::measure::Actor;
use crate::quantities::{Cycles, Words};
use crate::seam::{Channel, Op, OpKind};

/// A run that can never end, and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{kind}, {} still waiting", if waits.len() == 1 { "one".to_owned() } else { waits.len().to_string() })]
pub struct Stuck {
    /// What sort of standstill it is.
    pub kind: StuckKind,
    /// The chain of waits, each for the next one's actor; in a deadlock the last one waits for the first.
    pub waits: Vec<Wait>,
}

impl Stuck {
    /// What the user can make of it.
    pub fn help(&self) -> &'static str {
        let full = self.waits.iter().any(|wait| matches!(wait.for_what, WaitFor::Room { .. }));
        match self.kind {
            StuckKind::Deadlock if full => {
                "each waits for the next, the last for the first; deeper FIFOs may break the loop"
            }
            StuckKind::Deadlock => "each waits for the next, the last for the first; the ops do not match",
            StuckKind::Starved { .. } => "what the last of them waits for is never done: the ops do not match",
        }
    }
}

/// The sorts of standstill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StuckKind {
    /// The waits form a loop.
    Deadlock,
    /// The chain ends with an actor that has done all its ops, so that what the one before it waits for never comes.
    Starved {
        /// The one that has done all its ops.
        by: Actor,
    },
}

/// One wait.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wait {
    /// Who waits.
    pub actor: Actor,
    /// For whom.
    pub on: Actor,
    /// For what.
    pub for_what: WaitFor,
    /// Since which cycle.
    pub since: Cycles,
    /// The op that waits.
    pub op: Op,
    /// How many of the op's words have been moved.
    pub moved: Words,
    /// The job whose op it is.
    pub job: u32,
    /// The op's place in what the actor does for that job, from 0.
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

/// What an actor stands at that is not done.
pub(super) struct Blocked {
    pub actor: Actor,
    pub halt: Halt,
    pub cycle: u64,
    pub op: Op,
    pub moved: u64,
    pub job: u32,
    pub position: usize,
    /// The number of cells of the array.
    pub cells: usize,
    /// Words that the FIFO can hold at which it stands, if it stands at one.
    pub capacity: Option<u64>,
}

impl Blocked {
    /// The FIFO that it stands at, as the number of the link that leads there and the channel.
    pub fn fifo(&self) -> Option<(usize, Channel)> {
        match (self.actor, self.halt) {
            (Actor::Station(index), Halt::NoWord) => match self.op.kind().reads()? {
                Channel::Z => Some((index + 1, Channel::Z)),
                channel => Some((index, channel)),
            },
            (Actor::Station(index), Halt::NoRoom) => match self.op.kind().writes()? {
                Channel::Z => Some((index, Channel::Z)),
                channel => Some((index + 1, channel)),
            },
            (Actor::Host, Halt::NoRoom) => Some((0, self.op.kind().writes()?)),
            _ => None,
        }
    }

    fn waits_on(&self) -> Actor {
        let index = match (self.actor, self.halt) {
            (Actor::Host, Halt::NoRoom) => return Actor::Station(0),
            (Actor::Host, _) => return Actor::Station(self.cells - 1),
            (Actor::Station(index), _) => index,
        };
        // Words come from the left and room from the right; on Z it is the other way round.
        let on_z = matches!(self.fifo(), Some((_, Channel::Z)));
        let neighbour = if (self.halt == Halt::NoWord) == on_z { Some(index + 1) } else { index.checked_sub(1) };
        neighbour.filter(|&neighbour| neighbour < self.cells).map_or(Actor::Host, Actor::Station)
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
            actor: self.actor,
            on: self.waits_on(),
            for_what: self.for_what(),
            since: Cycles(self.cycle),
            op: self.op,
            moved: Words(self.moved),
            job: self.job,
            position: self.position,
        }
    }
}

/// Follows the waits from the leftmost one that is not done until they come back on themselves or end.
pub(super) fn diagnose(blocked: impl Iterator<Item = Blocked>) -> Stuck {
    let waits: Vec<Wait> = blocked.map(|at| at.wait()).collect();
    let mut chain: Vec<Wait> = Vec::new();
    let mut next = waits.first();
    while let Some(wait) = next {
        if let Some(start) = chain.iter().position(|seen| seen.actor == wait.actor) {
            return Stuck { kind: StuckKind::Deadlock, waits: chain.split_off(start) };
        }
        chain.push(wait.clone());
        next = waits.iter().find(|other| other.actor == wait.on);
    }
    let by = chain.last().map_or(Actor::Host, |wait| wait.on);
    Stuck { kind: StuckKind::Starved { by }, waits: chain }
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
        write!(f, "{} waits for {}: ", self.actor, self.on)?;
        let reader = |actor: Actor| match actor {
            Actor::Host => "host".to_owned(),
            Actor::Station(index) => index.to_string(),
        };
        match self.for_what {
            WaitFor::Word { channel, capacity } => {
                write!(f, "{channel}{} is empty (0 of {capacity})", reader(self.actor))?
            }
            WaitFor::Room { channel, capacity } => {
                write!(f, "{channel}{} is full ({} of {capacity})", reader(self.on), capacity.0)?
            }
            WaitFor::Return { message } => write!(f, "hit number {message} has not come back")?,
            WaitFor::Nothing => write!(f, "nothing can come there")?,
        }
        write!(f, ", since cycle {}, in {:?}", self.since.0, self.op)?;
        if self.moved.0 > 0 && !matches!(self.op.kind(), OpKind::Work(_)) {
            write!(f, " ({} of it moved)", self.moved)?;
        }
        write!(f, ", op {} of ray {}", self.position, self.job)
    }
}
