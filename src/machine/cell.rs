//! One cell: a sequencer with a clock of its own that does its ops one after the other.

use super::fifo::Fifo;
use super::op::{Op, OpKind};
use super::spec::{LinkRate, RateCounts};
use super::stats::CellStats;
use super::units::Cycles;
use super::{Channel, Work};

/// The two FIFOs at the end of a link, and the wire that leads to them.
#[derive(Debug)]
pub(super) struct Link {
    pub x: Fifo,
    pub y: Fifo,
    rate: LinkRate,
    /// For each channel, the first cycle in which the wire takes its next word.
    wire_free: [u64; 2],
}

impl Link {
    pub fn new(capacity: u64, latency: u64, rate: LinkRate) -> Link {
        Link { x: Fifo::new(capacity, latency), y: Fifo::new(capacity, latency), rate, wire_free: [0; 2] }
    }

    pub fn fifo(&self, channel: Channel) -> &Fifo {
        match channel {
            Channel::X => &self.x,
            Channel::Y => &self.y,
        }
    }

    #[inline]
    pub fn fifo_mut(&mut self, channel: Channel) -> &mut Fifo {
        match channel {
            Channel::X => &mut self.x,
            Channel::Y => &mut self.y,
        }
    }

    /// The first cycle in which the next word of `channel` can be written, if it is known.
    #[inline]
    fn room(&self, channel: Channel) -> Option<u64> {
        self.fifo(channel).room().map(|room| room.max(self.wire_free[channel as usize]))
    }

    /// Whether `count` words can be written in as many cycles from `at` on.
    #[inline]
    fn can_write(&self, channel: Channel, at: u64, count: u64) -> bool {
        self.rate.cycles_per_word == 1 && self.fifo(channel).can_write(at, count)
    }

    /// Writes `count` words in as many cycles from `at` on.
    #[inline]
    fn write(&mut self, channel: Channel, at: u64, count: u64) {
        self.fifo_mut(channel).write(at, count);
        // The writer's own clock keeps words one cycle apart.
        if self.rate.cycles_per_word > 1 {
            let free = at + self.rate.cycles_per_word;
            match self.rate.counts {
                RateCounts::Link => self.wire_free = [free; 2],
                RateCounts::Channel => self.wire_free[channel as usize] = free,
            }
        }
    }

    /// Brings both FIFOs' maxima up to date; see [`Fifo::track_max`].
    pub fn track_max(&mut self) {
        self.x.track_max();
        self.y.track_max();
    }
}

/// Why a cell has stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Halt {
    /// It has done all the ops that it has been given.
    OutOfOps,
    /// It reads, and it is not known when there will be a word.
    NoWord(Channel),
    /// It writes, and it is not known when there will be room.
    NoRoom(Channel),
    /// The host waits for a message whose last word is not known to have come back.
    NotReturned(u64),
    /// Its clock has reached the last cycle that is to be simulated.
    Limit,
}

/// A cell (or the host, as a writer): its clock, its place in its ops, and where its cycles went.
#[derive(Debug)]
pub(super) struct Cell {
    /// The first cycle that it has not spent yet.
    pub clock: u64,
    /// Cycles from this one on are not simulated.
    limit: u64,
    /// Words of the op under way that have been moved.
    pub moved: u64,
    pub stats: CellStats,
}

impl Cell {
    pub fn new(limit: u64) -> Cell {
        Cell { clock: 0, limit, moved: 0, stats: CellStats::default() }
    }

    /// Does a cell's ops, counting the finished ones up in `done`, until it can go no further. The last cell has no right
    /// neighbour to pass rays on to (`is_last`).
    pub fn run(&mut self, ops: &[Op], done: &mut usize, input: &mut Link, output: &mut Link, is_last: bool) -> Halt {
        while let Some(op) = ops.get(*done) {
            let count = op.count() as u64;
            let result = match op.kind() {
                OpKind::Compute(work) => self.compute(work, count),
                OpKind::PassX if !is_last => self.pass_on(count, &mut input.x, output),
                OpKind::PassX | OpKind::ReadX => self.read(count, Channel::X, input),
                OpKind::ReadY => self.read(count, Channel::Y, input),
                OpKind::WriteX => self.write(count, Channel::X, output),
                OpKind::WriteY => self.write(count, Channel::Y, output),
                OpKind::Await => Err(Halt::NotReturned(count)),
            };
            if let Err(halt) = result {
                return halt;
            }
            self.moved = 0;
            *done += 1;
        }
        Halt::OutOfOps
    }

    /// Does the host's ops likewise. It only writes, computes and waits for messages, of which `returned` tells when the
    /// last word of each was read.
    pub fn run_host(&mut self, ops: &[Op], done: &mut usize, output: &mut Link, returned: &[u64]) -> Halt {
        while let Some(op) = ops.get(*done) {
            let count = op.count() as u64;
            let result = match op.kind() {
                OpKind::Compute(work) => self.compute(work, count),
                OpKind::WriteX => self.write(count, Channel::X, output),
                OpKind::WriteY => self.write(count, Channel::Y, output),
                OpKind::Await => self.wait_for_return(count, returned),
                OpKind::PassX | OpKind::ReadX => Err(Halt::NoWord(Channel::X)),
                OpKind::ReadY => Err(Halt::NoWord(Channel::Y)),
            };
            if let Err(halt) = result {
                return halt;
            }
            self.moved = 0;
            *done += 1;
        }
        Halt::OutOfOps
    }

    /// Spends the cycles up to the limit on what the cell stood at, op `op`, when its neighbour reached the limit.
    pub fn stall_to_limit(&mut self, halt: Halt, op: Op, input: &Link) {
        match halt {
            Halt::NoWord(channel) => {
                let _ = self.wait_until(self.limit, channel);
            }
            Halt::NoRoom(channel) => {
                // A ray word that waits for room still has to come in first.
                if op.kind() == OpKind::PassX {
                    let _ = self.wait_until(input.x.ready().unwrap_or(self.limit), Channel::X);
                }
                let _ = self.block_until(self.limit, channel);
            }
            Halt::OutOfOps | Halt::NotReturned(_) | Halt::Limit => {}
        }
    }

    fn compute(&mut self, work: Work, count: u64) -> Result<(), Halt> {
        let cycles = count.min(self.limit - self.clock);
        self.stats.busy.0[work as usize] += Cycles(cycles);
        self.clock += cycles;
        if cycles < count { Err(Halt::Limit) } else { Ok(()) }
    }

    fn read(&mut self, count: u64, channel: Channel, input: &mut Link) -> Result<(), Halt> {
        let fifo = input.fifo_mut(channel);
        while self.moved < count {
            let left = count - self.moved;
            if self.clock + left <= self.limit && fifo.can_read(self.clock, left) {
                fifo.read(self.clock, left);
                self.advance(left);
            } else {
                self.wait_until(fifo.ready().ok_or(Halt::NoWord(channel))?, channel)?;
                fifo.read(self.clock, 1);
                self.advance(1);
            }
        }
        Ok(())
    }

    fn write(&mut self, count: u64, channel: Channel, output: &mut Link) -> Result<(), Halt> {
        while self.moved < count {
            let left = count - self.moved;
            if self.clock + left <= self.limit && output.can_write(channel, self.clock, left) {
                output.write(channel, self.clock, left);
                self.advance(left);
            } else {
                self.block_until(output.room(channel).ok_or(Halt::NoRoom(channel))?, channel)?;
                output.write(channel, self.clock, 1);
                self.advance(1);
            }
        }
        Ok(())
    }

    /// Reads words from X and writes each to the right neighbour's X in the cycle in which it is read.
    fn pass_on(&mut self, count: u64, input: &mut Fifo, output: &mut Link) -> Result<(), Halt> {
        while self.moved < count {
            let left = count - self.moved;
            let mut burst = 1;
            if self.clock + left <= self.limit
                && input.can_read(self.clock, left)
                && output.can_write(Channel::X, self.clock, left)
            {
                burst = left;
            } else {
                // Both times must be known before a cycle is spent, as the cell may have to come back to this word.
                let ready = input.ready().ok_or(Halt::NoWord(Channel::X))?;
                let room = output.room(Channel::X).ok_or(Halt::NoRoom(Channel::X))?;
                self.wait_until(ready, Channel::X)?;
                self.block_until(room, Channel::X)?;
            }
            input.read(self.clock, burst);
            output.write(Channel::X, self.clock, burst);
            self.advance(burst);
        }
        Ok(())
    }

    /// The wait ends in the cycle in which the message's last word is read; the next op starts in the cycle after it.
    fn wait_for_return(&mut self, message: u64, returned: &[u64]) -> Result<(), Halt> {
        let read_at = *returned.get(message as usize).ok_or(Halt::NotReturned(message))?;
        self.clock = self.clock.max(read_at + 1).min(self.limit);
        Ok(())
    }

    #[inline]
    fn advance(&mut self, words: u64) {
        self.moved += words;
        self.clock += words;
        self.stats.moving += Cycles(words);
    }

    #[inline]
    fn wait_until(&mut self, cycle: u64, channel: Channel) -> Result<(), Halt> {
        let stall = self.stall_until(cycle);
        *self.stats.waiting(channel) += stall;
        self.within_limit()
    }

    #[inline]
    fn block_until(&mut self, cycle: u64, channel: Channel) -> Result<(), Halt> {
        let stall = self.stall_until(cycle);
        *self.stats.blocked(channel) += stall;
        self.within_limit()
    }

    #[inline]
    fn stall_until(&mut self, cycle: u64) -> Cycles {
        let until = cycle.min(self.limit).max(self.clock);
        let stall = until - self.clock;
        self.clock = until;
        Cycles(stall)
    }

    #[inline]
    fn within_limit(&self) -> Result<(), Halt> {
        if self.clock < self.limit { Ok(()) } else { Err(Halt::Limit) }
    }
}
