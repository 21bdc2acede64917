//! One cell: a sequencer with a clock of its own that does its ops one after the other.

use super::fifo::Fifo;
use super::op::{Op, OpKind};
use super::spec::{LinkRate, RateCounts};
use super::stats::{CellState, CellStats};
use super::units::Cycles;
use super::{Channel, Work};

/// The FIFOs at both ends of a link, and the wires that lead to them.
#[derive(Debug)]
pub(super) struct Link {
    pub x: Fifo,
    pub y: Fifo,
    /// At the left end: the right cell writes to it, on a wire of its own.
    pub z: Fifo,
    rate: LinkRate,
    /// For X and Y, the first cycle in which the wire takes its next word.
    wire_free: [u64; 2],
    /// The same for the wire that leads to the left.
    wire_back_free: u64,
}

impl Link {
    /// `capacities` are those of X, Y and Z, in words.
    pub fn new(capacities: [u64; 3], latency: u64, rate: LinkRate) -> Link {
        let [x, y, z] = capacities.map(|capacity| Fifo::new(capacity, latency));
        Link { x, y, z, rate, wire_free: [0; 2], wire_back_free: 0 }
    }

    #[inline(always)]
    pub fn fifo(&self, channel: Channel) -> &Fifo {
        match channel {
            Channel::X => &self.x,
            Channel::Y => &self.y,
            Channel::Z => &self.z,
        }
    }

    #[inline(always)]
    pub fn fifo_mut(&mut self, channel: Channel) -> &mut Fifo {
        match channel {
            Channel::X => &mut self.x,
            Channel::Y => &mut self.y,
            Channel::Z => &mut self.z,
        }
    }

    /// The first cycle in which the wire takes the next word of `channel`.
    #[inline(always)]
    fn wire_free(&self, channel: Channel) -> u64 {
        if channel == Channel::Z { self.wire_back_free } else { self.wire_free[channel as usize] }
    }

    /// Whether `count` words can be written in as many cycles from `at` on.
    #[inline(always)]
    fn can_write(&self, channel: Channel, at: u64, count: u64) -> bool {
        self.rate.cycles_per_word == 1 && self.fifo(channel).can_write(at, count)
    }

    /// Writes a word in cycle `at`, which found room in the FIFO from cycle `room` on.
    #[inline(always)]
    fn write_one(&mut self, channel: Channel, at: u64, room: u64) {
        self.fifo_mut(channel).write_one(at, room);
        // The writer's own clock keeps words one cycle apart.
        if self.rate.cycles_per_word > 1 {
            self.occupy_wire(channel, at);
        }
    }

    fn occupy_wire(&mut self, channel: Channel, at: u64) {
        let free = at + self.rate.cycles_per_word;
        match self.rate.counts {
            _ if channel == Channel::Z => self.wire_back_free = free,
            RateCounts::Link => self.wire_free = [free; 2],
            RateCounts::Channel => self.wire_free[channel as usize] = free,
        }
    }

    /// Brings the FIFOs' maxima up to date; see [`Fifo::track_max`].
    pub fn track_max(&mut self) {
        self.x.track_max();
        self.y.track_max();
        if self.z.words_written() > 0 {
            self.z.track_max();
        }
    }
}

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
    pub now: Now,
    pub stats: CellStats,
}

/// Where a cell stands. It is copied out of the cell while the cell runs, to stay in registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Now {
    /// The first cycle that has not been spent yet.
    pub clock: u64,
    /// Cycles or words that are left of the op under way; 0 if none is.
    pub left: u64,
    /// Cycles from this one on are not simulated.
    limit: u64,
}

/// Sees where a cell's cycles go, all but those in which it moves a word or has nothing left to do. `()` sees nothing and
/// costs nothing.
pub(super) trait Watcher {
    /// The cell spent `cycles` cycles, from cycle `from` on, in one state.
    fn spent(&mut self, state: CellState, from: u64, cycles: u64);
}

impl Watcher for () {
    #[inline(always)]
    fn spent(&mut self, _: CellState, _: u64, _: u64) {}
}

impl<W: Watcher> Watcher for Option<W> {
    #[inline(always)]
    fn spent(&mut self, state: CellState, from: u64, cycles: u64) {
        if let Some(watcher) = self {
            watcher.spent(state, from, cycles);
        }
    }
}

/// Both see all.
impl<A: Watcher, B: Watcher> Watcher for (A, B) {
    #[inline(always)]
    fn spent(&mut self, state: CellState, from: u64, cycles: u64) {
        self.0.spent(state, from, cycles);
        self.1.spent(state, from, cycles);
    }
}

/// Where a cell's cycles are entered.
struct Ledger<'a, W> {
    stats: &'a mut CellStats,
    watcher: W,
}

impl<W: Watcher> Ledger<'_, W> {
    #[inline(always)]
    fn spend(&mut self, state: CellState, from: u64, cycles: u64) {
        *self.stats.of_mut(state) += Cycles(cycles);
        self.watcher.spent(state, from, cycles);
    }
}

/// What an op ends with, or the part of it that could be done.
type Done = Result<(), Halt>;

impl Cell {
    pub fn new(limit: u64) -> Cell {
        Cell { now: Now { clock: 0, left: 0, limit }, stats: CellStats::default() }
    }

    /// Does a cell's ops, counting the finished ones up in `done`, until it can go no further. The last cell has no right
    /// neighbour to pass rays on to (`is_last`).
    pub fn run(
        &mut self,
        ops: &[Op],
        done: &mut usize,
        input: &mut Link,
        output: &mut Link,
        is_last: bool,
        watcher: impl Watcher,
    ) -> Halt {
        let ledger = &mut Ledger { stats: &mut self.stats, watcher };
        self.now.run(ops, done, |now, op, left| {
            // Asked first, and not in the match: two of three ops compute, and a branch is cheaper than a jump table.
            if let Some(work) = op.work() {
                return now.compute(work, left, ledger);
            }
            match op.kind() {
                OpKind::Compute(work) => now.compute(work, left, ledger),
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
        watcher: impl Watcher,
    ) -> Halt {
        let ledger = &mut Ledger { stats: &mut self.stats, watcher };
        self.now.run(ops, done, |now, op, left| match op.kind() {
            OpKind::Compute(work) => now.compute(work, left, ledger),
            OpKind::WriteX => now.write(left, Channel::X, output, ledger),
            OpKind::WriteY => now.write(left, Channel::Y, output, ledger),
            OpKind::Await => now.wait_for_return(left, returned, ledger),
            OpKind::PassX | OpKind::ReadX | OpKind::ReadY | OpKind::ReadZ | OpKind::WriteZ => Err(Halt::NoWord),
        })
    }

    /// Spends the cycles up to the limit on what the cell stood at, op `op`, when its neighbour reached the limit.
    pub fn stall_to_limit(&mut self, halt: Halt, op: Op, input: &Link, watcher: impl Watcher) {
        let now = &mut self.now;
        let ledger = &mut Ledger { stats: &mut self.stats, watcher };
        let (reads, writes) = (op.kind().reads(), op.kind().writes());
        // A word that is passed on and waits for room still has to come in first.
        if let (Some(channel), Halt::NoWord | Halt::NoRoom) = (reads, halt) {
            let ready = if halt == Halt::NoWord { None } else { input.fifo(channel).ready() };
            now.stall_until(ready.unwrap_or(now.limit), CellState::Waiting(channel), ledger);
        }
        if let (Some(channel), Halt::NoRoom) = (writes, halt) {
            now.stall_until(now.limit, CellState::Blocked(channel), ledger);
        }
        if halt == Halt::NotReturned {
            now.stall_until(now.limit, CellState::Waiting(Channel::Y), ledger);
        }
    }

    /// The statistics of a run of `cycles` cycles.
    pub fn stats(&self, cycles: u64) -> CellStats {
        // Every cycle up to the clock was spent in some way; those not counted elsewhere moved a word.
        let moving = Cycles(self.now.clock) - self.stats.active();
        CellStats { moving, idle: Cycles(cycles - self.now.clock), ..self.stats }
    }
}

impl Now {
    /// Does one op after the other until one halts. `step` does one, of which so much is left to do.
    #[inline(always)]
    fn run(&mut self, ops: &[Op], done: &mut usize, mut step: impl FnMut(&mut Now, Op, u64) -> Done) -> Halt {
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

    #[inline(always)]
    fn compute(&mut self, work: Work, count: u64, ledger: &mut Ledger<'_, impl Watcher>) -> Done {
        let cycles = count.min(self.limit - self.clock);
        ledger.spend(CellState::Busy(work), self.clock, cycles);
        self.clock += cycles;
        if cycles < count { self.halt(Halt::Limit, count - cycles) } else { Ok(()) }
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
            self.stall_until(ready, CellState::Waiting(channel), ledger);
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
            self.stall_until(room.max(output.wire_free(channel)), CellState::Blocked(channel), ledger);
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
            self.stall_until(ready, CellState::Waiting(Channel::X), ledger);
            self.stall_until(room.max(output.wire_free(Channel::X)), CellState::Blocked(Channel::X), ledger);
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
        self.stall_until(read_at + 1, CellState::Waiting(Channel::Y), ledger);
        Ok(())
    }

    #[inline(always)]
    fn stall_until(&mut self, cycle: u64, state: CellState, ledger: &mut Ledger<'_, impl Watcher>) {
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
