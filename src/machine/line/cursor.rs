//! Where a cell stands in its ops and in time, and how it does one op: this is where cycles pass.

use super::fifo::Fifo;
use super::hold::{Held, Hold};
use super::link::Link;
use super::prices::Prices;
use super::watcher::Watcher;
use crate::measure::{StateId, StateTimes};
use crate::quantities::Cycles;
use crate::seam::{Channel, Op, OpKind};

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

/// Where what a cell waits for comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

impl Halt {
    /// The neighbour who can let a cell go on that has halted in an op. Words come from the left and room from the right; on Z it
    /// is the other way round.
    #[inline]
    pub fn awaits(self, op: Op) -> Option<Side> {
        match self {
            Halt::NoWord => Some(if op.kind() == OpKind::ReadZ { Side::Right } else { Side::Left }),
            Halt::NoRoom => Some(if op.kind() == OpKind::WriteZ { Side::Left } else { Side::Right }),
            Halt::OutOfOps | Halt::NotReturned | Halt::Limit => None,
        }
    }
}

/// Where a cell stands. It is copied out of the cell while the cell runs, to stay in registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cursor {
    /// The first cycle that has not been spent yet.
    pub clock: u64,
    /// How many ops of its batch have been done: the place of the one under way.
    pub done: usize,
    /// Units or words that are left of the op under way; 0 if none is.
    pub left: u64,
    /// Cycles from this one on are not simulated.
    pub limit: u64,
}

/// How much was left of the op when the cell halted in the middle of it; 0 if it did not.
#[derive(Clone, Copy)]
pub(super) struct Resume(u64);

impl Resume {
    /// How much of an op that moves words or waits is left to do.
    #[inline(always)]
    pub fn left_of(self, op: Op) -> u64 {
        if self.0 > 0 { self.0 } else { op.words() }
    }
}

/// Where a cell's cycles are entered.
pub(super) struct Ledger<'a, W> {
    pub prices: &'a Prices,
    pub times: &'a mut StateTimes,
    pub watcher: W,
}

impl<W: Watcher> Ledger<'_, W> {
    #[inline(always)]
    fn spend(&mut self, state: StateId, from: u64, cycles: u64) {
        self.watcher.spent(state, from, cycles, self.times);
        *self.times.of_mut(state) += Cycles(cycles);
    }
}

/// What an op ends with, or the part of it that could be done.
pub(super) type Done = Result<(), Halt>;

impl Cursor {
    /// At the start of a run of which the cycles from `limit` on are not simulated.
    pub fn new(limit: u64) -> Cursor {
        Cursor { clock: 0, done: 0, left: 0, limit }
    }

    /// Does one op after the other until one halts. `step` does one that moves words or waits, or what is left of it.
    #[inline(always)]
    pub fn run<W: Watcher>(
        &mut self,
        ops: &[Op],
        ledger: &mut Ledger<'_, W>,
        mut step: impl FnMut(&mut Cursor, Op, Resume, &mut Ledger<'_, W>) -> Done,
    ) -> Halt {
        let mut now = *self;
        let mut resume = Resume(std::mem::take(&mut now.left));
        let halt = loop {
            if let Err(why) = now.work(ops, ledger) {
                break why;
            }
            let Some(&op) = ops.get(now.done) else { break Halt::OutOfOps };
            ledger.watcher.began(now.done, now.clock);
            if let Err(why) = step(&mut now, op, resume, ledger) {
                break why;
            }
            resume = Resume(0);
            now.done += 1;
        };
        *self = now;
        if halt == Halt::Limit {
            ops.get(self.done).into_iter().for_each(|op| self.work_to_limit(*op, ledger));
        }
        halt
    }

    /// Works, as long as one op after the other is work: that is often, and in a loop of its own the clock stays in a register.
    #[inline(always)]
    fn work(&mut self, ops: &[Op], ledger: &mut Ledger<'_, impl Watcher>) -> Done {
        let (mut clock, mut done) = (self.clock, self.done);
        while let Some((unit, count)) = ops.get(done).and_then(|op| Some((op.unit()?, op.count()))) {
            let (cost, state) = ledger.prices.of(unit);
            ledger.watcher.began(done, clock);
            let cycles = count as u64 * cost;
            if cycles > self.limit - clock {
                (self.clock, self.done) = (clock, done);
                return Err(Halt::Limit);
            }
            ledger.spend(state, clock, cycles);
            clock += cycles;
            done += 1;
        }
        (self.clock, self.done) = (clock, done);
        Ok(())
    }

    /// Works up to the limit, which is at the latest where cycles no longer fit into 64 bits: time itself has an end, too. What it cuts
    /// off is never gone on with, so it need not be told how far it came.
    #[cold]
    fn work_to_limit(&mut self, op: Op, ledger: &mut Ledger<'_, impl Watcher>) {
        let Some(unit) = op.unit() else { return };
        ledger.spend(ledger.prices.of(unit).1, self.clock, self.limit - self.clock);
        (self.clock, self.left) = (self.limit, op.count() as u64);
    }

    #[inline(always)]
    pub fn read(
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
            self.read_word(left, channel, input, ledger)?;
            left -= 1;
        }
        Ok(())
    }

    /// Reads the next word of an op of which so many are left.
    #[inline(always)]
    pub fn read_word(
        &mut self,
        left: u64,
        channel: Channel,
        input: &mut Fifo,
        ledger: &mut Ledger<'_, impl Watcher>,
    ) -> Done {
        let Some(ready) = input.ready() else { return self.halt(Halt::NoWord, left) };
        self.stall(ready, (Hold::Word(channel), left), ledger)?;
        input.read_one(self.clock, ready);
        self.clock += 1;
        Ok(())
    }

    #[inline(always)]
    pub fn write(
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
            self.write_word(left, channel, output, ledger)?;
            left -= 1;
        }
        Ok(())
    }

    /// Writes the next word of an op of which so many are left.
    #[inline(always)]
    pub fn write_word(
        &mut self,
        left: u64,
        channel: Channel,
        output: &mut Link,
        ledger: &mut Ledger<'_, impl Watcher>,
    ) -> Done {
        let Some(room) = output.fifo(channel).room() else { return self.halt(Halt::NoRoom, left) };
        if output.takes_a_word_a_cycle() {
            self.stall(room, (Hold::Slot(channel), left), ledger)?;
            output.fifo_mut(channel).write_one(self.clock);
        } else {
            self.stall_for_room(channel, room, output, left, ledger)?;
            output.write_one(channel, self.clock);
        }
        self.clock += 1;
        Ok(())
    }

    /// Reads words from X and writes each to the right neighbour's X in the cycle in which it is read.
    #[inline(always)]
    pub fn pass_on(
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
            self.stall(ready, (Hold::Word(Channel::X), left), ledger)?;
            self.stall_for_room(Channel::X, room, output, left, ledger)?;
            input.read_one(self.clock, ready);
            output.write_one(Channel::X, self.clock);
            self.clock += 1;
            left -= 1;
        }
        Ok(())
    }

    /// The wait ends in the cycle in which the message's last word is read; the next op starts in the cycle after it.
    pub fn wait_for_return(&mut self, message: u64, returned: &[u64], ledger: &mut Ledger<'_, impl Watcher>) -> Done {
        let Some(read_at) = returned.get(message as usize) else { return Err(Halt::NotReturned) };
        self.stall_until(read_at + 1, (Hold::Answer, message), ledger);
        Ok(())
    }

    /// Waits until a FIFO has room, which it has from cycle `room` on, and the wire to it is free. Of two that come at once
    /// it is the room that it waits for.
    #[inline(always)]
    fn stall_for_room(
        &mut self,
        channel: Channel,
        room: u64,
        output: &Link,
        left: u64,
        ledger: &mut Ledger<'_, impl Watcher>,
    ) -> Done {
        let wire_free = output.wire_free(channel);
        let hold = if wire_free > room { Hold::Wire(channel) } else { Hold::Slot(channel) };
        self.stall(room.max(wire_free), (hold, left), ledger)
    }

    /// Waits until cycle `cycle` for what holds it up, with so much `left` of the op, or halts at the limit.
    #[inline(always)]
    fn stall(&mut self, cycle: u64, held: (Hold, u64), ledger: &mut Ledger<'_, impl Watcher>) -> Done {
        if cycle.max(self.clock) >= self.limit {
            self.stall_until(cycle, held, ledger);
            return self.halt(Halt::Limit, held.1);
        }
        self.spend_until(cycle.max(self.clock), held, false, ledger);
        Ok(())
    }

    /// Waits likewise, at the longest up to the limit.
    pub fn stall_until(&mut self, cycle: u64, held: (Hold, u64), ledger: &mut Ledger<'_, impl Watcher>) {
        self.spend_until(cycle.min(self.limit).max(self.clock), held, cycle >= self.limit, ledger);
    }

    #[inline(always)]
    fn spend_until(
        &mut self,
        until: u64,
        (by, left): (Hold, u64),
        is_cut: bool,
        ledger: &mut Ledger<'_, impl Watcher>,
    ) {
        ledger.spend(by.state(), self.clock, until - self.clock);
        if until > self.clock {
            ledger.watcher.held(Held { until, op: self.done, left, by, is_cut });
        }
        self.clock = until;
    }

    /// Stops in the middle of an op.
    #[inline(always)]
    fn halt(&mut self, why: Halt, left: u64) -> Done {
        self.left = left;
        Err(why)
    }
}
