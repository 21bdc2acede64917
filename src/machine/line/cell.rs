//! One cell: a sequencer with a clock of its own that does its ops one after the other.

use super::cursor::{Cursor, Halt, Ledger};
use super::hold::Hold;
use super::link::Link;
use super::prices::Prices;
use super::states::{IDLE, MOVING};
use super::watcher::Watcher;
use crate::measure::StateTimes;
use crate::quantities::Cycles;
use crate::seam::{Channel, Op, OpKind};

/// A cell, or the host as a writer: where it stands, and where its cycles went.
#[derive(Debug)]
pub(super) struct Cell {
    pub now: Cursor,
    pub times: StateTimes,
}

impl Cell {
    pub fn new(limit: u64) -> Cell {
        Cell { now: Cursor::new(limit), times: StateTimes::default() }
    }

    /// Does a cell's ops until it can go no further. The last cell has no right neighbour to pass rays on to (`is_last`).
    /// Inlined: the links then lie where the array has them, and the clock in a register.
    #[inline(always)]
    pub fn run(
        &mut self,
        ops: &[Op],
        (input, output): (&mut Link, &mut Link),
        is_last: bool,
        (prices, watcher): (&Prices, impl Watcher),
    ) -> Halt {
        let ledger = &mut Ledger { times: &mut self.times, prices, watcher };
        self.now.run(ops, ledger, |now, op, resume, ledger| {
            // Most ops of a pipeline: nothing can be left of them but the whole.
            if op == Op::ONE_FROM_Y {
                return now.read_word(1, Channel::Y, &mut input.y, ledger);
            }
            if op == Op::ONE_TO_Y {
                return now.write_word(1, Channel::Y, output, ledger);
            }
            let (channel, input) = match op.kind() {
                OpKind::PassX if !is_last => return now.pass_on(resume.left_of(op), &mut input.x, output, ledger),
                OpKind::PassX | OpKind::ReadX => (Channel::X, &mut input.x),
                OpKind::ReadY => (Channel::Y, &mut input.y),
                OpKind::ReadZ if op.words() == 1 => return now.read_word(1, Channel::Z, &mut output.z, ledger),
                OpKind::ReadZ => (Channel::Z, &mut output.z),
                OpKind::WriteX => return now.write(resume.left_of(op), Channel::X, output, ledger),
                OpKind::WriteY => return now.write(resume.left_of(op), Channel::Y, output, ledger),
                OpKind::WriteZ if op.words() == 1 => return now.write_word(1, Channel::Z, input, ledger),
                OpKind::WriteZ => return now.write(resume.left_of(op), Channel::Z, input, ledger),
                OpKind::Await | OpKind::Work(_) => return Err(Halt::NotReturned),
            };
            now.read(resume.left_of(op), channel, input, ledger)
        })
    }

    /// Does the host's ops likewise. It only writes, computes and waits for messages, of which `returned` tells when the
    /// last word of each was read.
    pub fn run_host(
        &mut self,
        ops: &[Op],
        output: &mut Link,
        returned: &[u64],
        (prices, watcher): (&Prices, impl Watcher),
    ) -> Halt {
        let ledger = &mut Ledger { times: &mut self.times, prices, watcher };
        self.now.run(ops, ledger, |now, op, resume, ledger| match op.kind() {
            OpKind::WriteX => now.write(resume.left_of(op), Channel::X, output, ledger),
            OpKind::WriteY => now.write(resume.left_of(op), Channel::Y, output, ledger),
            OpKind::Await => now.wait_for_return(resume.left_of(op), returned, ledger),
            OpKind::PassX | OpKind::ReadX | OpKind::ReadY | OpKind::ReadZ | OpKind::WriteZ | OpKind::Work(_) => {
                Err(Halt::NoWord)
            }
        })
    }

    /// Spends the cycles up to the limit on what the cell stood at, op `op`, when its neighbour reached the limit.
    pub fn stall_to_limit(&mut self, halt: Halt, op: Op, input: &Link, (prices, watcher): (&Prices, impl Watcher)) {
        let now = &mut self.now;
        let ledger = &mut Ledger { times: &mut self.times, prices, watcher };
        let (reads, writes) = (op.kind().reads(), op.kind().writes());
        // A word that is passed on and waits for room still has to come in first.
        if let (Some(channel), Halt::NoWord | Halt::NoRoom) = (reads, halt) {
            let ready = if halt == Halt::NoWord { None } else { input.fifo(channel).ready() };
            now.stall_until(ready.unwrap_or(now.limit), (Hold::Word(channel), now.left), ledger);
        }
        if let (Some(channel), Halt::NoRoom) = (writes, halt) {
            now.stall_until(now.limit, (Hold::Slot(channel), now.left), ledger);
        }
        if halt == Halt::NotReturned {
            now.stall_until(now.limit, (Hold::Answer, now.left), ledger);
        }
    }

    /// The times of a run of `cycles` cycles.
    pub fn times(&self, cycles: u64) -> StateTimes {
        // Every cycle up to the clock was spent in some way; those not counted elsewhere moved a word.
        let mut times = self.times;
        *times.of_mut(MOVING) = Cycles(self.now.clock) - times.total();
        *times.of_mut(IDLE) = Cycles(cycles - self.now.clock);
        times
    }
}
