//! The linear array: a host, cells in a row, a link into each cell and one back to the host.

use std::collections::VecDeque;
use std::ops::Range;

use super::Channel;
use super::cell::{Cell, Halt, Link};
use super::fifo::Fifo;
use super::observers::{Observed, Observers};
use super::op::OpBatch;
use super::probe::Probe;
use super::recorder::Recorder;
use super::so_far::SoFar;
use super::spec::MachineSpec;
use super::stats::{RunStats, fifo_name};
use super::stuck::{self, Party, Stuck};
use super::units::Cycles;

/// Words of the message that comes back to the host for each line of its ops (a HIT).
pub(super) const RETURN_WORDS: u64 = 5;

/// An array at work: takes ops batch by batch and works out when they happen.
///
/// ```
/// use pcs_sim::machine::{Array, Cycles, MachineSpec, OpBatch, OpKind, Work};
///
/// // One cell, one ray: read 8 words, compute 600 cycles, write 5 words.
/// let mut batch = OpBatch::new(1);
/// batch.host.push(OpKind::WriteX, 8);
/// batch.host.end_line(0);
/// batch.cells[0].push(OpKind::PassX, 8);
/// batch.cells[0].push(OpKind::Compute(Work::Grid), 600);
/// batch.cells[0].push(OpKind::WriteY, 5);
/// batch.cells[0].end_line(0);
///
/// let mut array = Array::new(&MachineSpec::default(), 1);
/// array.feed(batch);
/// array.run()?;
/// // The host writes in cycles 0 to 7, the cell reads in 1 to 8, computes in 9 to 608, writes in 609 to 613,
/// // and the host reads the last word in cycle 614.
/// assert_eq!(array.finish()?.cycles, Cycles(615));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Array {
    /// `links[i]` leads into cell i, and on Z out of it to the left; the last one leads back to the host, on Y only.
    links: Vec<Link>,
    host: Station,
    cells: Vec<Station>,
    batches: VecDeque<OpBatch>,
    /// How many batches have been dropped from the front of `batches`.
    dropped: usize,
    spent: Vec<OpBatch>,
    rays: u64,
    /// When the host read the last word of each returned message.
    returned: Vec<u64>,
    limit: u64,
    /// See what happens when, if asked to. Boxed, as most arrays have none.
    observers: Option<Box<Observers>>,
}

/// A cell and its place in the batches.
#[derive(Debug)]
struct Station {
    cell: Cell,
    /// The number of the batch that it is in, counted from the start of the run.
    batch: usize,
    /// How many of that batch's ops it has done.
    done: usize,
    halt: Halt,
}

/// Why an array has no statistics to give.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unfinished {
    /// The ops can never be done.
    #[error(transparent)]
    Stuck(#[from] Stuck),
    /// Some cell works on after the host has read its last word. The statistics end with that word: time the same ops
    /// again in an array made by [`Array::until`].
    #[error("some cell works on after the host has read its last word in cycle {0}")]
    Outlived(Cycles),
}

impl Array {
    /// An array of `cells` cells, at least 1, with empty FIFOs, in cycle 0.
    pub fn new(spec: &MachineSpec, cells: usize) -> Array {
        Array::until(spec, cells, Cycles(u64::MAX))
    }

    /// The same, but nothing happens in cycle `limit` or later.
    pub fn until(spec: &MachineSpec, cells: usize, limit: Cycles) -> Array {
        let words = [Channel::X, Channel::Y, Channel::Z].map(|channel| spec.fifo_words_of(channel).0);
        let link = || Link::new(words, spec.latency.0, spec.link_rate());
        let station = || Station { cell: Cell::new(limit.0), batch: 0, done: 0, halt: Halt::OutOfOps };
        Array {
            links: (0..=cells).map(|_| link()).collect(),
            host: station(),
            cells: (0..cells).map(|_| station()).collect(),
            batches: VecDeque::new(),
            dropped: 0,
            spent: Vec::new(),
            rays: 0,
            returned: Vec::new(),
            limit: limit.0,
            observers: None,
        }
    }

    /// The same with a probe, so that [`Array::finish_observed`] gives a profile. To be asked for before any ops are fed.
    pub fn probed(mut self) -> Array {
        let probe = Probe::new(self.cells.len(), &self.links[0]);
        self.observers.get_or_insert_default().probe = Some(probe);
        self
    }

    /// The same with a recorder, so that [`Array::finish_observed`] gives a recording of the cycles in `window`, or of
    /// the first of them if more than `most_events` events happen in it. To be asked for before any ops are fed.
    pub fn recorded(mut self, window: Range<Cycles>, most_events: usize) -> Array {
        let recorder = Recorder::new(self.cells.len(), window, most_events);
        self.observers.get_or_insert_default().recorder = Some(recorder);
        self
    }

    /// Adds the next ops. A batch needs no whole rays: each stream simply goes on where the one before it ended.
    pub fn feed(&mut self, batch: OpBatch) {
        debug_assert_eq!(batch.cells.len(), self.cells.len());
        self.rays += batch.host.lines().len() as u64;
        if let Some(observers) = &mut self.observers {
            observers.fed(&batch.host);
        }
        self.batches.push_back(batch);
    }

    /// A batch that has been done, emptied, for its memory to be used again.
    pub fn take_spent(&mut self) -> Option<OpBatch> {
        self.spent.pop()
    }

    /// Works out all times that the ops fed so far determine. Fails as soon as no further ops could help.
    pub fn run(&mut self) -> Result<(), Stuck> {
        while self.sweep() {}
        let stations = || std::iter::once(&self.host).chain(&self.cells);
        let helpless = stations().all(|s| !matches!(s.halt, Halt::OutOfOps | Halt::Limit));
        if helpless { Err(self.stuck()) } else { Ok(()) }
    }

    /// The first cycle that the host has not spent on the ops fed so far, as far as they have been done.
    pub fn host_clock(&self) -> Cycles {
        Cycles(self.host.cell.now.clock)
    }

    /// The cycle in which the host reads the last word of the n-th message (from 0), if it is known.
    pub fn returned_in(&self, message: u64) -> Option<Cycles> {
        self.returned.get(message as usize).copied().map(Cycles)
    }

    /// What has been worked out by now. Takes no longer than a few reads for each cell.
    pub fn so_far(&self) -> SoFar {
        let fifo = |fifo: &Fifo, name: String| {
            let until = fifo.known_until();
            (fifo.stats(name, until), Cycles(until))
        };
        SoFar {
            cycles: Cycles(self.links[self.cells.len()].y.known_until()),
            returned: self.returned.len() as u64,
            cells: self.cells.iter().map(|station| station.cell.stats(station.cell.now.clock)).collect(),
            fifos: self.each_fifo(fifo),
        }
    }

    /// Ends the run: no more ops will come.
    pub fn finish(self) -> Result<RunStats, Unfinished> {
        self.finish_observed().map(|(stats, _)| stats)
    }

    /// Ends the run, and tells what its observers saw.
    pub fn finish_observed(mut self) -> Result<(RunStats, Observed), Unfinished> {
        self.run()?;
        let limited = self.limit != u64::MAX;
        if limited {
            self.stall_to_limit();
        } else if std::iter::once(&self.host).chain(&self.cells).any(|s| s.halt != Halt::OutOfOps) {
            return Err(self.stuck().into());
        }
        let cycles = self.cycles();
        if !limited && self.cells.iter().any(|s| s.cell.now.clock > cycles) {
            return Err(Unfinished::Outlived(Cycles(cycles)));
        }
        let stats = self.stats(cycles);
        let clocks = std::iter::once(&self.host).chain(&self.cells).map(|station| station.cell.now.clock);
        let observed = self.observers.map(|observers| observers.finish(&self.links, clocks, cycles));
        Ok((stats, observed.unwrap_or_default()))
    }

    /// Lets each cell, from left to right, go on as far as it can. Returns whether anything moved.
    fn sweep(&mut self) -> bool {
        let mut moved = self.run_host();
        for index in 0..self.cells.len() {
            moved |= self.run_cell(index);
        }
        self.collect_returns();
        self.drop_spent();
        moved
    }

    fn run_host(&mut self) -> bool {
        let Array { host, links, batches, dropped, returned, observers, .. } = self;
        let output = &mut links[0];
        let before = host.place();
        while let Some(batch) = batches.get(host.batch - *dropped) {
            let Station { cell, done, .. } = host;
            let seen = observers.as_mut().and_then(|all| all.run_host(cell, &batch.host, done, output, returned));
            host.halt = seen.unwrap_or_else(|| cell.run_host(batch.host.ops(), done, output, returned, ()));
            if !host.next_batch() {
                break;
            }
        }
        let moved = host.place() != before;
        self.follow_link(0);
        moved
    }

    fn run_cell(&mut self, index: usize) -> bool {
        let is_last = index + 1 == self.cells.len();
        let (left, right) = self.links.split_at_mut(index + 1);
        let (input, output) = (&mut left[index], &mut right[0]);
        let station = &mut self.cells[index];
        let before = station.place();
        while let Some(batch) = self.batches.get(station.batch - self.dropped) {
            let stream = &batch.cells[index];
            let Station { cell, done, .. } = station;
            let observers = self.observers.as_mut();
            let seen = observers.and_then(|all| all.run_cell(index, cell, stream, done, (input, output), is_last));
            station.halt = seen.unwrap_or_else(|| cell.run(stream.ops(), done, input, output, is_last, ()));
            if !station.next_batch() {
                break;
            }
        }
        if station.place() == before {
            return false;
        }
        self.follow_link(index);
        self.follow_link(index + 1);
        true
    }

    /// Brings what is known of a link's FIFOs up to date, after a stretch of reads or of writes.
    fn follow_link(&mut self, index: usize) {
        let link = &mut self.links[index];
        link.track_max();
        if let Some(observers) = &mut self.observers {
            observers.follow(index, link);
        }
    }

    /// The host reads each word in the first cycle in which it can be read.
    fn collect_returns(&mut self) {
        let inbox = &mut self.links[self.cells.len()].y;
        while let Some(ready) = inbox.ready().filter(|ready| *ready < self.limit) {
            inbox.read_one(ready, ready);
            if inbox.words_read().is_multiple_of(RETURN_WORDS) {
                self.returned.push(ready);
                if let Some(observers) = &mut self.observers {
                    observers.returned(ready);
                }
            }
        }
        self.follow_link(self.cells.len());
    }

    fn drop_spent(&mut self) {
        let stations = std::iter::once(&self.host).chain(&self.cells);
        let oldest = stations.map(|s| s.batch).min().unwrap_or(0);
        while self.dropped < oldest {
            let Some(mut batch) = self.batches.pop_front() else { break };
            batch.clear();
            self.spent.push(batch);
            self.dropped += 1;
        }
    }

    fn cycles(&self) -> u64 {
        let inbox = &self.links[self.cells.len()].y;
        if inbox.words_read() > 0 {
            inbox.last_read() + 1
        } else {
            std::iter::once(&self.host).chain(&self.cells).map(|s| s.cell.now.clock).max().unwrap_or(0)
        }
    }

    fn stall_to_limit(&mut self) {
        let Array { host, links, batches, dropped, observers, .. } = self;
        let observers = &mut **observers.get_or_insert_default();
        let batch = |station: &Station| batches.get(station.batch - *dropped);
        if let Some(&op) = batch(host).and_then(|batch| batch.host.ops().get(host.done)) {
            observers.stall_host_to_limit(&mut host.cell, host.halt, op, &links[0]);
        }
        for (index, station) in self.cells.iter_mut().enumerate() {
            if let Some(&op) = batch(station).and_then(|batch| batch.cells[index].ops().get(station.done)) {
                observers.stall_cell_to_limit(index, &mut station.cell, station.halt, op, &links[index]);
            }
        }
    }

    fn stats(&self, cycles: u64) -> RunStats {
        RunStats {
            cycles: Cycles(cycles),
            rays: self.rays,
            cells: self.cells.iter().map(|station| station.cell.stats(cycles)).collect(),
            fifos: self.each_fifo(|fifo, name| fifo.stats(name, cycles)),
        }
    }

    /// Asks each FIFO, in the order of [`RunStats::fifos`]. Those of Z are there once they have carried a word.
    fn each_fifo<T>(&self, ask: impl Fn(&Fifo, String) -> T) -> Vec<T> {
        let count = self.cells.len();
        let xs = (0..count).map(|link| (link, Channel::X));
        let ys = (1..=count).map(|link| (link, Channel::Y));
        let zs = (1..count).filter(|&link| self.links[link].z.words_written() > 0).map(|link| (link, Channel::Z));
        let all = xs.chain(ys).chain(zs);
        all.map(|(link, channel)| ask(self.links[link].fifo(channel), fifo_name(channel, link, count))).collect()
    }

    /// Who waits for whom, in an array that does not go on.
    pub fn stuck(&self) -> Stuck {
        let parties = (0..self.cells.len()).map(Party::Cell);
        stuck::diagnose(std::iter::once(Party::Host).chain(parties).filter_map(|party| self.standing(party)))
    }

    /// Where a party that is not done stands; `None` if it has done all its ops.
    fn standing(&self, party: Party) -> Option<stuck::Standing> {
        let station = self.station(party);
        let batch = self.batches.get(station.batch - self.dropped)?;
        let stream = match party {
            Party::Host => &batch.host,
            Party::Cell(index) => &batch.cells[index],
        };
        let op = *stream.ops().get(station.done)?;
        let (ray, position) = stream.locate(station.done).unwrap_or((u32::MAX, station.done));
        let left = if station.cell.now.left > 0 { station.cell.now.left } else { op.count() as u64 };
        let mut standing = stuck::Standing {
            party,
            halt: station.halt,
            cycle: station.cell.now.clock,
            op,
            moved: op.count() as u64 - left,
            ray,
            position,
            cells: self.cells.len(),
            capacity: None,
        };
        standing.capacity = standing.fifo().map(|(link, channel)| self.links[link].fifo(channel).capacity());
        Some(standing)
    }

    fn station(&self, party: Party) -> &Station {
        match party {
            Party::Host => &self.host,
            Party::Cell(index) => &self.cells[index],
        }
    }
}

impl Station {
    /// Goes to the start of the next batch, if it has done all of this one.
    fn next_batch(&mut self) -> bool {
        let done = self.halt == Halt::OutOfOps;
        if done {
            self.batch += 1;
            self.done = 0;
        }
        done
    }

    fn place(&self) -> (usize, usize, u64) {
        (self.batch, self.done, self.cell.now.left)
    }
}
