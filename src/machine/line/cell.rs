//! One cell: a sequencer with a clock of its own that does its ops one after the other.

use super::fifo::Fifo;
use super::link::Link;
use super::prices::Prices;
use super::states::{IDLE, MOVING, blocked, waiting};
use super::watcher::Watcher;
use crate::measure::{StateId, StateTimes};
use crate::quantities::Cycles;
use crate::seam::{Channel, Op, OpKind, Unit};

/// Why a cell has stopped. Its op tells the channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Halt {
    /// It has done all the ops that it has been given.
    OutOfOps,
    /// It reads, and it is not known when there will be a word.
    NoWord,
    /// It writes, and it is not known when there will be room.
    NoRoom,
    /// The host waits for a message whose last word is not known to have come back.
    NotReturned,
    /// Its clock has reached the last cycle that is to be simulated.
    Limit,
}

/// A cell, or the host as a writer: where it stands, and where its cycles went.
#[derive(Debug)]
pub(super) struct Cell {
    pub now: Cursor,
    pub times: StateTimes,
}

/// Where a cell stands. It is copied out of the cell while the cell runs, to stay in registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cursor {
    /// The first cycle that has not been spent yet.
    pub clock: u64,
    /// Units or words that are left of the op under way; 0 if none is.
    pub left: u64,
    /// Cycles from this one on are not simulated.
    limit: u64,
}

/// Where a cell's cycles are entered.
struct Ledger<'a, W> {
    prices: &'a Prices,
    times: &'a mut StateTimes,
    watcher: W,
}

impl<W: Watcher> Ledger<'_, W> {
    #[inline(always)]
    fn spend(&mut self, state: StateId, from: u64, cycles: u64) {
        *self.times.of_mut(state) += Cycles(cycles);
        self.watcher.spent(state, from, cycles);
    }
}

/// What an op ends with, or the part of it that could be done.
type Done = Result<(), Halt>;

impl Cell {
    pub fn new(limit: u64) -> Cell {
        Cell { now: Cursor { clock: 0, left: 0, limit }, times: StateTimes::default() }
    }

    /// Does a cell's ops, counting the finished ones up in `done`, until it can go no further. The last cell has no right
    /// neighbour to pass rays on to (`is_last`).
    pub fn run(
        &mut self,
        ops: &[Op],
        done: &mut usize,
        (input, output): (&mut Link, &mut Link),
        is_last: bool,
        (prices, watcher): (&Prices, impl Watcher),
    ) -> Halt {
        let ledger = &mut Ledger { times: &mut self.times, prices, watcher };
        self.now.run(ops, done, |now, op, left| {
            // Asked first, and not in the match: two of three ops compute, and a branch is cheaper than a jump table.
            if let Some(unit) = op.unit() {
                return now.work(unit, left, ledger);
            }
            match op.kind() {
                OpKind::Work(unit) => now.work(unit, left, ledger),
                OpKind::PassX if !is_last => now.pass_on(left, &mut input.x, output, ledger),
                OpKind::PassX | OpKind::ReadX => now.read(left, Channel::X, &mut input.x, ledger),
                OpKind::ReadY => now.read(left, Channel::Y, &mut input.y, ledger),
                OpKind::WriteX => now.write(left, Channel::X, output, ledger),
                OpKind::WriteY => now.write(left, Channel::Y, output, ledger),
                OpKind::ReadZ | OpKind::WriteZ => now.move_back(op, left, input, output, ledger),
                OpKind::Await => Err(Halt::NotReturned),
            }
        })
    }

    /// Does the host's ops likewise. It only writes, computes and waits for messages, of which `returned` tells when the
    /// last word of each was read.
    pub fn run_host(
        &mut self,
        ops: &[Op],
        done: &mut usize,
        output: &mut Link,
        returned: &[u64],
        (prices, watcher): (&Prices, impl Watcher),
    ) -> Halt {
        let ledger = &mut Ledger { times: &mut self.times, prices, watcher };
        self.now.run(ops, done, |now, op, left| match op.kind() {
            OpKind::Work(unit) => now.work(unit, left, ledger),
            OpKind::WriteX => now.write(left, Channel::X, output, ledger),
            OpKind::WriteY => now.write(left, Channel::Y, output, ledger),
            OpKind::Await => now.wait_for_return(left, returned, ledger),
            OpKind::PassX | OpKind::ReadX | OpKind::ReadY | OpKind::ReadZ | OpKind::WriteZ => Err(Halt::NoWord),
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
            now.stall_until(ready.unwrap_or(now.limit), waiting(channel), ledger);
        }
        if let (Some(channel), Halt::NoRoom) = (writes, halt) {
            now.stall_until(now.limit, blocked(channel), ledger);
        }
        if halt == Halt::NotReturned {
            now.stall_until(now.limit, waiting(Channel::Y), ledger);
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

impl Cursor {
    /// Does one op after the other until one halts. `step` does one, of which so much is left to do.
    #[inline(always)]
    fn run(&mut self, ops: &[Op], done: &mut usize, mut step: impl FnMut(&mut Cursor, Op, u64) -> Done) -> Halt {
        let mut now = *self;
        let mut halt = Halt::OutOfOps;
        let mut finished = *done;
        let mut resume = std::mem::take(&mut now.left);
        while let Some(&op) = ops.get(finished) {
            let left = if resume > 0 { resume } else { op.count() as u64 };
            if let Err(why) = step(&mut now, op, left) {
                halt = why;
                break;
            }
            resume = 0;
            finished += 1;
        }
        *done = finished;
        *self = now;
        halt
    }

    /// Works on so many units. What the limit cuts off is never gone on with, so it need not be told how far it came.
    #[inline(always)]
    fn work(&mut self, unit: Unit, count: u64, ledger: &mut Ledger<'_, impl Watcher>) -> Done {
        let (cost, state) = ledger.prices.of(unit);
        let wanted = count * cost;
        let cycles = wanted.min(self.limit - self.clock);
        ledger.spend(state, self.clock, cycles);
        self.clock += cycles;
        if cycles < wanted { self.halt(Halt::Limit, count) } else { Ok(()) }
    }

    #[inline(always)]
    fn read(
        &mut self,
        mut left: u64,
        channel: Channel,
        input: &mut Fifo,
        ledger: &mut Ledger<'_, impl Watcher>,
    ) -> Done {
        while left > 0 {
            if left > 1 && self.clock + left <= self.limit && input.can_read(self.clock, left) {
                input.read_burst(self.clock, left);
                self.clock += left;
                return Ok(());
            }
            let Some(ready) = input.ready() else { return self.halt(Halt::NoWord, left) };
            self.stall_until(ready, waiting(channel), ledger);
            if self.clock >= self.limit {
                return self.halt(Halt::Limit, left);
            }
            input.read_one(self.clock, ready);
            self.clock += 1;
            left -= 1;
        }
        Ok(())
    }

    #[inline(always)]
    fn write(
        &mut self,
        mut left: u64,
        channel: Channel,
        output: &mut Link,
        ledger: &mut Ledger<'_, impl Watcher>,
    ) -> Done {
        while left > 0 {
            if left > 1 && self.clock + left <= self.limit && output.can_write(channel, self.clock, left) {
                output.fifo_mut(channel).write_burst(self.clock, left);
                self.clock += left;
                return Ok(());
            }
            let Some(room) = output.fifo(channel).room() else { return self.halt(Halt::NoRoom, left) };
            self.stall_until(room.max(output.wire_free(channel)), blocked(channel), ledger);
            if self.clock >= self.limit {
                return self.halt(Halt::Limit, left);
            }
            output.write_one(channel, self.clock, room);
            self.clock += 1;
            left -= 1;
        }
        Ok(())
    }

    /// Reads from Z, which comes from the right, or writes to the left neighbour's. Kept out of the way of the programs that
    /// have no use for it.
    #[cold]
    #[inline(never)]
    fn move_back(
        &mut self,
        op: Op,
        left: u64,
        input: &mut Link,
        output: &mut Link,
        ledger: &mut Ledger<'_, impl Watcher>,
    ) -> Done {
        match op.kind() {
            OpKind::ReadZ => self.read(left, Channel::Z, &mut output.z, ledger),
            _ => self.write(left, Channel::Z, input, ledger),
        }
    }

    /// Reads words from X and writes each to the right neighbour's X in the cycle in which it is read.
    #[inline(always)]
    fn pass_on(
        &mut self,
        mut left: u64,
        input: &mut Fifo,
        output: &mut Link,
        ledger: &mut Ledger<'_, impl Watcher>,
    ) -> Done {
        while left > 0 {
            if self.clock + left <= self.limit
                && input.can_read(self.clock, left)
                && output.can_write(Channel::X, self.clock, left)
            {
                input.read_burst(self.clock, left);
                output.x.write_burst(self.clock, left);
                self.clock += left;
                return Ok(());
            }
            // Both times must be known before a cycle is spent, as the cell may have to come back to this word.
            let Some(ready) = input.ready() else { return self.halt(Halt::NoWord, left) };
            let Some(room) = output.x.room() else { return self.halt(Halt::NoRoom, left) };
            self.stall_until(ready, waiting(Channel::X), ledger);
            self.stall_until(room.max(output.wire_free(Channel::X)), blocked(Channel::X), ledger);
            if self.clock >= self.limit {
                return self.halt(Halt::Limit, left);
            }
            input.read_one(self.clock, ready);
            output.write_one(Channel::X, self.clock, room);
            self.clock += 1;
            left -= 1;
        }
        Ok(())
    }

    /// The wait ends in the cycle in which the message's last word is read; the next op starts in the cycle after it.
    fn wait_for_return(&mut self, message: u64, returned: &[u64], ledger: &mut Ledger<'_, impl Watcher>) -> Done {
        let Some(read_at) = returned.get(message as usize) else { return Err(Halt::NotReturned) };
        self.stall_until(read_at + 1, waiting(Channel::Y), ledger);
        Ok(())
    }

    #[inline(always)]
    fn stall_until(&mut self, cycle: u64, state: StateId, ledger: &mut Ledger<'_, impl Watcher>) {
        let until = cycle.min(self.limit).max(self.clock);
        ledger.spend(state, self.clock, until - self.clock);
        self.clock = until;
    }

    /// Stops in the middle of an op.
    #[inline(always)]
    fn halt(&mut self, why: Halt, left: u64) -> Done {
        self.left = left;
        Err(why)
    }
}
