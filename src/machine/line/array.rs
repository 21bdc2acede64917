//! The linear array: a host, cells in a row, a link into each cell and one back to the host.

use std::collections::VecDeque;
use std::num::NonZeroU64;
use std::ops::Range;
use std::sync::Arc;

use super::causes::{Causes, Past, Stand};
use super::cell::Cell;
use super::cursor::{Halt, Side};
use super::departures::Departures;
use super::fifo::Fifo;
use super::link::{Link, around, ends};
use super::observers::Observers;
use super::prices::Prices;
use super::probe::Probe;
use super::recorder::Recorder;
use super::states::{blocked, states, waiting};
use super::stuck::{self, Stuck};
use super::unlimited::Coming;
use crate::machine::{FifoName, MachineSpec};
use crate::measure::{
    Actor, FifoInfo, FifoStats, LinkStats, Measured, Names, Observed, Shape, SoFar, StateTimes, Topology, When,
};
use crate::quantities::{Cycles, Words};
use crate::seam::{BatchError, Channel, Costs, Op, OpBatch, Vocabulary};

/// An array at work: takes ops batch by batch and works out when they happen.
///
/// ```
/// use std::sync::Arc;
///
/// use pcs_sim::machine::{Array, Cycles, MachineSpec};
/// use pcs_sim::seam::{Costs, OpBatch, OpKind, Unit, Vocabulary};
///
/// // A program with one unit of work, which takes 200 cycles, and answers of 5 words.
/// let vocabulary = Vocabulary::of_cycles(&[('t', "think")], 5);
/// let costs = Costs::new(Arc::new(vocabulary), |_| Cycles(200));
///
/// // One cell, one job: read 8 words, do 3 units of work, write 5 words.
/// let mut batch = OpBatch::new(1);
/// batch.host.push(OpKind::WriteX, 8);
/// batch.host.end_line(0);
/// batch.cells[0].push(OpKind::PassX, 8);
/// batch.cells[0].push(OpKind::Work(Unit(0)), 3);
/// batch.cells[0].push(OpKind::WriteY, 5);
/// batch.cells[0].end_line(0);
///
/// let mut array = Array::new(&MachineSpec::default(), &costs, 1);
/// array.feed(batch)?;
/// array.run()?;
/// // The host writes in cycles 0 to 7, the cell reads in 1 to 8, works in 9 to 608, writes in 609 to 613,
/// // and the host reads the last word in cycle 614.
/// assert_eq!(array.finish()?.cycles, Cycles(615));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Array {
    /// `links[i]` leads into cell i, and on Z out of it to the left; the last one leads back to the host, on Y only.
    pub(super) links: Vec<Link>,
    pub(super) host: CellAt,
    pub(super) cells: Vec<CellAt>,
    /// Shared with whoever feeds the same to other arrays.
    batches: VecDeque<Arc<OpBatch>>,
    /// How many batches have been dropped from the front of `batches`.
    dropped: usize,
    spent: Vec<OpBatch>,
    vocabulary: Arc<Vocabulary>,
    prices: Prices,
    /// Whether the host, each cell, and the host as a reader may go on.
    stirred: Box<[bool]>,
    jobs: u64,
    /// When the host read the last word of each returned message.
    returned: Vec<u64>,
    limit: u64,
    /// See what happens when, if asked to. Boxed, as most arrays have none.
    observers: Option<Box<Observers>>,
    /// What its FIFOs must have room for, if they have no limit.
    pub(super) coming: Option<Coming>,
    /// The same ops without such a limit, if it is asked for.
    unlimited: Option<Box<Array>>,
}

/// A cell and its place in the batches.
#[derive(Debug)]
pub(super) struct CellAt {
    pub(super) cell: Cell,
    /// The number of the batch that it is in, counted from the start of the run.
    batch: usize,
    halt: Halt,
    /// The neighbour that it waits for.
    awaits: Option<Side>,
}

/// Why an array has no statistics to give.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unfinished {
    /// The ops can never be done.
    #[error(transparent)]
    Stuck(#[from] Stuck),
    /// Some cell, or the host, works on or moves words after the host has read its last word. The statistics end with that
    /// word, of which `cycles` is the next cycle: time the same ops again in an array made by [`Array::until`].
    #[error("some cell works on after the host has read its last word in cycle {0}")]
    Outlived(Cycles),
}

impl Array {
    /// An array of `cells` cells with empty FIFOs, in cycle 0, in which units of work take what `costs` say.
    ///
    /// A machine file is checked, a [`MachineSpec`] made by hand is not: depths, a latency or a rate that no file may have are
    /// taken for the nearest that it may, and 0 cells for 1.
    pub fn new(spec: &MachineSpec, costs: &Costs, cells: usize) -> Array {
        Array::until(spec, costs, cells, Cycles(u64::MAX))
    }

    /// An array that ends with the cycle before `limit`: nothing happens in that cycle or later, and ops that are not done by
    /// then are no fault. It is how statistics end with the host's last read where a cell works on after it; see
    /// [`Unfinished::Outlived`].
    pub fn until(spec: &MachineSpec, costs: &Costs, cells: usize, limit: Cycles) -> Array {
        let cells = cells.max(1);
        let station = || CellAt { cell: Cell::new(limit.0), batch: 0, halt: Halt::OutOfOps, awaits: None };
        Array {
            links: (0..=cells).map(|link| Link::new(spec, link, cells)).collect(),
            host: station(),
            cells: (0..cells).map(|_| station()).collect(),
            batches: VecDeque::new(),
            dropped: 0,
            spent: Vec::new(),
            vocabulary: Arc::clone(costs.vocabulary()),
            prices: Prices::new(costs),
            stirred: vec![true; cells + 2].into(),
            jobs: 0,
            returned: Vec::new(),
            limit: limit.0,
            observers: None,
            coming: None,
            unlimited: None,
        }
    }

    /// The same with a probe, so that [`Array::finish_observed`] gives a profile. To be asked for before any ops are fed.
    pub fn probed(mut self) -> Array {
        let probe = Probe::new(&self.links);
        self.observers.get_or_insert_default().probe = Some(probe);
        self
    }

    /// The same with a recorder, so that [`Array::finish_observed`] gives a recording of the cycles in `window`, or of
    /// the first of them if more than `most_events` events happen in it. To be asked for before any ops are fed.
    pub fn recorded(mut self, window: Range<Cycles>, most_events: usize) -> Array {
        let recorder = Recorder::new(self.cells.len(), self.vocabulary.answer_words, window, most_events);
        self.observers.get_or_insert_default().recorder = Some(recorder);
        self
    }

    /// The same, following the causes of all that happens, so that [`Array::finish_observed`] gives the critical path. About
    /// `most_ops` ops are held at a time. To be asked for before any ops are fed.
    pub fn explained(mut self, most_ops: usize) -> Array {
        let causes = Causes::new(self.cells.len(), most_ops);
        self.observers.get_or_insert_default().causes = Some(causes);
        self
    }

    /// The same, noting when jobs leave, so that [`Array::next_latency`] can tell how long each took. To be asked for before any ops
    /// are fed.
    pub fn noting_departures(mut self) -> Array {
        self.observers.get_or_insert_default().departures = Some(Departures::default());
        self
    }

    /// The same, noting when each job leaves and is answered, so that [`Array::finish_observed`] gives their spans. To be asked for before
    /// any ops are fed.
    pub fn noting_spans(mut self) -> Array {
        self.observers.get_or_insert_default().spans = Some(Departures::default());
        self
    }

    /// The same for an array that is [explained](Array::explained): it also looks for what everybody does in one cycle. Of a
    /// job, [`Array::finish_observed`] tells the cycle; only one that is known before can be looked at.
    pub fn looking_at(mut self, when: When) -> Array {
        let causes = self.observers.as_mut().and_then(|observers| observers.causes.as_mut());
        causes.into_iter().for_each(|causes| causes.look(when));
        self
    }

    /// The same, beside one that is [unlimited](Array::unlimited) and does the same ops, so that the statistics tell of each FIFO
    /// the depth from which nothing changes any more. To be asked for before any ops are fed.
    pub fn beside_unlimited(mut self, spec: &MachineSpec, costs: &Costs) -> Array {
        self.unlimited = Some(Box::new(Array::unlimited(spec, costs, self.cells.len())));
        self
    }

    /// Adds the next ops. A batch needs no whole jobs: each stream simply goes on where the one before it ended. One that several
    /// arrays do can be shared.
    ///
    /// # Errors
    ///
    /// If no array of so many cells could do the ops.
    pub fn feed(&mut self, batch: impl Into<Arc<OpBatch>>) -> Result<(), BatchError> {
        let batch: Arc<OpBatch> = batch.into();
        batch.check(self.cells.len())?;
        self.jobs += batch.host.lines().len() as u64;
        self.make_room(&batch);
        if let Some(unlimited) = &mut self.unlimited {
            unlimited.feed(Arc::clone(&batch))?;
        }
        if let Some(observers) = &mut self.observers {
            observers.fed(&batch);
        }
        self.batches.push_back(batch);
        Ok(())
    }

    /// A batch that has been done, emptied, for its memory to be used again. One that somebody else still has is none of it. To be asked
    /// for as often as batches are fed, or they pile up.
    pub fn take_spent(&mut self) -> Option<OpBatch> {
        // The array beside it does the same batches, and is the last to have them.
        self.spent.pop().or_else(|| self.unlimited.as_mut()?.take_spent())
    }

    /// The memory that it takes, in bytes, but for what its observers keep.
    pub fn bytes(&self) -> u64 {
        let fifos: u64 = self.links.iter().map(Link::bytes).sum();
        let ops: u64 = self.batches.iter().map(|batch| &**batch).chain(&self.spent).map(OpBatch::bytes).sum();
        fifos + ops + (self.returned.capacity() * size_of::<u64>()) as u64
    }

    /// Works out all times that the ops fed so far determine. Fails as soon as no further ops could help.
    pub fn run(&mut self) -> Result<(), Stuck> {
        self.advance();
        if self.causes().is_some_and(Causes::is_full) {
            self.reckon();
        }
        let stations = || std::iter::once(&self.host).chain(&self.cells);
        let helpless = stations().all(|s| !matches!(s.halt, Halt::OutOfOps | Halt::Limit));
        if helpless {
            return Err(self.stuck());
        }
        self.unlimited.as_mut().map_or(Ok(()), |unlimited| unlimited.run())
    }

    /// The first cycle that the host has not spent on the ops fed so far, as far as they have been done.
    pub fn host_clock(&self) -> Cycles {
        Cycles(self.host.cell.now.clock)
    }

    /// The cycle in which the host reads the last word of the n-th message (from 0), if it is known.
    pub fn returned_in(&self, message: u64) -> Option<Cycles> {
        self.returned.get(message as usize).copied().map(Cycles)
    }

    /// How long the next job took whose answer came back in cycle `returned`, in an array that [notes](Array::noting_departures)
    /// when jobs leave: jobs are told in the order in which they were sent, each once.
    pub fn next_latency(&mut self, returned: Cycles) -> Option<Cycles> {
        let sent = self.observers.as_mut()?.departures.as_mut()?.next()?;
        Some(Departures::latency(sent, returned.0))
    }

    /// What has been worked out by now. Takes no longer than a few reads for each cell.
    pub fn so_far(&self) -> SoFar {
        let fifo = |fifo: &Fifo| {
            let until = fifo.known_until();
            (fifo.stats(until), Cycles(until))
        };
        let stations: Vec<StateTimes> = self.cells.iter().map(|at| at.cell.times(at.cell.now.clock)).collect();
        let topology = Arc::new(self.topology());
        SoFar {
            cycles: Cycles(self.links[self.cells.len()].y.known_until()),
            returned: self.returned.len() as u64,
            stations,
            fifos: self.fifos().map(|(link, channel)| fifo(self.links[link].fifo(channel))).collect(),
            topology,
        }
    }

    /// Ends the run: no more ops will come.
    pub fn finish(self) -> Result<Measured, Unfinished> {
        self.finish_observed().map(|(measured, _)| measured)
    }

    /// Ends the run, and tells what its observers saw.
    pub fn finish_observed(mut self) -> Result<(Measured, Observed), Unfinished> {
        self.run()?;
        let limited = self.limit != u64::MAX;
        if limited {
            self.stall_to_limit();
        } else if std::iter::once(&self.host).chain(&self.cells).any(|s| s.halt != Halt::OutOfOps) {
            return Err(self.stuck().into());
        }
        let cycles = self.cycles();
        if !limited && std::iter::once(&self.host).chain(&self.cells).any(|s| s.cell.now.clock > cycles) {
            return Err(Unfinished::Outlived(Cycles(cycles)));
        }
        let measured = self.measured(cycles);
        let observers = self.observers.take();
        let seen = (&measured.topology, &*self.vocabulary);
        let times: Vec<StateTimes> = self.cells.iter().map(|at| at.cell.times).collect();
        let observed = observers.map(|observers| observers.finish((&self.past(), &times), seen, cycles));
        Ok((measured, observed.unwrap_or_default()))
    }

    fn causes(&self) -> Option<&Causes> {
        self.observers.as_ref()?.causes.as_ref()
    }

    /// What happened so far, for those who look back.
    fn past(&self) -> Past<'_> {
        Past {
            batches: &self.batches,
            first: self.dropped,
            links: &self.links,
            prices: &self.prices,
            returned: &self.returned,
            stands: std::iter::once(&self.host).chain(&self.cells).map(|at| Stand::of(at.batch, &at.cell)).collect(),
        }
    }

    /// Lets the causes be followed back, after which the ops are needed no more.
    fn reckon(&mut self) {
        let Some(mut observers) = self.observers.take() else { return };
        observers.causes.iter_mut().for_each(|causes| causes.reckon(&self.past()));
        self.observers = Some(observers);
        self.drop_spent();
    }

    /// Lets the host and each cell go on as far as they can, from left to right and again, as long as anything moves. In which order
    /// is all the same to the times.
    fn advance(&mut self) {
        // The host has place 0, cell i has i + 1, and the host as a reader is the last.
        let last = self.cells.len() + 1;
        self.stirred.fill(true);
        let mut again = true;
        while std::mem::take(&mut again) {
            for place in 0..=last {
                if std::mem::take(&mut self.stirred[place]) && self.go_on(place) {
                    // Its neighbours may have waited for that; and for an answer, the host.
                    if let Some(left) = place.checked_sub(1) {
                        again |= self.stir(left, Side::Right);
                    }
                    if place < last {
                        self.stir(place + 1, Side::Left);
                    } else {
                        self.stirred[0] = true;
                        again = true;
                    }
                }
            }
        }
        if self.causes().is_none() {
            self.drop_spent();
        }
    }

    /// Lets whoever has a place go on, if it waits for its neighbour on that side. Returns whether it does.
    fn stir(&mut self, place: usize, side: Side) -> bool {
        let awaits = match place.checked_sub(1) {
            None => self.host.awaits,
            Some(cell) => self.cells.get(cell).map_or(Some(Side::Left), |at| at.awaits),
        };
        let does = awaits == Some(side);
        self.stirred[place] |= does;
        does
    }

    /// Lets whoever has a place go on as far as it can. Returns whether it moved.
    fn go_on(&mut self, place: usize) -> bool {
        match place {
            0 => self.run_host(),
            _ if place > self.cells.len() => self.collect_returns(),
            _ => self.run_cell(place - 1),
        }
    }

    fn run_host(&mut self) -> bool {
        let Array { host, links, batches, dropped, returned, observers, prices, .. } = self;
        let output = &mut links[0];
        let before = host.progress();
        while let Some(batch) = batches.get(host.batch - *dropped) {
            let stream = (host.batch, &batch.host);
            let cell = &mut host.cell;
            let seen = observers.as_mut().and_then(|all| all.run_host(cell, stream, output, (prices, returned)));
            host.halt = seen.unwrap_or_else(|| cell.run_host(batch.host.ops(), output, returned, (prices, ())));
            if !host.next_batch(batch.host.ops()) {
                break;
            }
        }
        let moved = host.progress() != before;
        self.follow_link(0);
        moved
    }

    fn run_cell(&mut self, index: usize) -> bool {
        let is_last = index + 1 == self.cells.len();
        let (station, links, prices) = (&mut self.cells[index], &mut self.links, &self.prices);
        let before = station.progress();
        while let Some(batch) = self.batches.get(station.batch - self.dropped) {
            let stream = (station.batch, &batch.cells[index]);
            let cell = &mut station.cell;
            let observers = self.observers.as_mut();
            let seen = observers.and_then(|all| all.run_cell((index, cell), stream, links, (prices, is_last)));
            station.halt = seen.unwrap_or_else(|| run_unseen((index, cell), stream.1.ops(), links, (prices, is_last)));
            if !station.next_batch(stream.1.ops()) {
                break;
            }
        }
        if station.progress() == before {
            return false;
        }
        self.follow_link(index);
        self.follow_link(index + 1);
        true
    }

    /// Brings what is known of a link's FIFOs up to date, after a stretch of reads or of writes.
    #[inline]
    fn follow_link(&mut self, index: usize) {
        let link = &mut self.links[index];
        link.follow();
        if let Some(observers) = &mut self.observers {
            observers.follow(index, link);
        }
    }

    /// The host reads each word in the first cycle in which it can be read. Returns whether it did.
    fn collect_returns(&mut self) -> bool {
        let inbox = &mut self.links[self.cells.len()].y;
        let before = inbox.words_read();
        // Where nothing is an answer, words are read all the same.
        let answer_words = NonZeroU64::new(self.vocabulary.answer_words).map_or(u64::MAX, NonZeroU64::get);
        let mut left = answer_words - before % answer_words;
        while let Some(ready) = inbox.ready().filter(|ready| *ready < self.limit) {
            inbox.read_one(ready, ready);
            left -= 1;
            if left == 0 {
                left = answer_words;
                self.returned.push(ready);
                if let Some(observers) = &mut self.observers {
                    observers.returned(ready);
                }
            }
        }
        let moved = inbox.words_read() != before;
        self.follow_link(self.cells.len());
        moved
    }

    fn drop_spent(&mut self) {
        let stations = std::iter::once(&self.host).chain(&self.cells);
        let oldest = stations.map(|s| s.batch).min().unwrap_or(0);
        while self.dropped < oldest {
            let Some(batch) = self.batches.pop_front() else { break };
            if let Ok(mut batch) = Arc::try_unwrap(batch) {
                batch.clear();
                self.spent.push(batch);
            }
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
        let Array { host, links, batches, dropped, observers, prices, .. } = self;
        let observers = &mut **observers.get_or_insert_default();
        let batch = |station: &CellAt| batches.get(station.batch - *dropped);
        if let Some(&op) = batch(host).and_then(|batch| batch.host.ops().get(host.cell.now.done)) {
            observers.stall_host_to_limit(&mut host.cell, (host.batch, host.halt, op), &links[0], prices);
        }
        for (index, station) in self.cells.iter_mut().enumerate() {
            if let Some(&op) = batch(station).and_then(|batch| batch.cells[index].ops().get(station.cell.now.done)) {
                let halt = (station.batch, station.halt, op);
                observers.stall_cell_to_limit((index, &mut station.cell), halt, &links[index], prices);
            }
        }
    }

    fn measured(&self, cycles: u64) -> Measured {
        let enough = self.unlimited.as_ref().map(|unlimited| unlimited.enough());
        let fifo = |(index, (link, channel)): (usize, (usize, Channel))| FifoStats {
            enough: enough.as_ref().and_then(|enough| enough.get(index).copied()),
            ..self.links[link].fifo(channel).stats(cycles)
        };
        let cells = || (0..self.cells.len()).map(Actor::Station);
        let ends = [Actor::Host].into_iter().chain(cells()).zip(cells().chain([Actor::Host]));
        let carried = |(link, (from, into)): (&Link, (Actor, Actor))| LinkStats {
            from: Some(from),
            into: Some(into),
            busy: Cycles(link.busy(cycles)),
            read: Cycles(link.read(cycles)),
            messages: None,
        };
        Measured {
            topology: Arc::new(self.topology()),
            cycles: Cycles(cycles),
            jobs: self.jobs,
            stations: self.cells.iter().map(|at| at.cell.times(cycles)).collect(),
            fifos: self.fifos().enumerate().map(fifo).collect(),
            links: self.links.iter().zip(ends).map(carried).collect(),
        }
    }

    /// The FIFOs, by link and channel: `X0`, `X1`, ..., then `Y1`, `Y2`, ..., `Yhost`; then those of `Z0`, `Z1`, ... once
    /// they have carried a word.
    pub(super) fn fifos(&self) -> impl Iterator<Item = (usize, Channel)> + '_ {
        let count = self.cells.len();
        let xs = (0..count).map(|link| (link, Channel::X));
        let ys = (1..=count).map(|link| (link, Channel::Y));
        let zs = (1..count).filter(|&link| self.links[link].z.words_written() > 0).map(|link| (link, Channel::Z));
        xs.chain(ys).chain(zs)
    }

    /// What the array is made of, as far as it is in use.
    fn topology(&self) -> Topology {
        let fifos = self.fifos().map(|(link, channel)| {
            let (from, to) = ends(link, self.cells.len(), channel);
            let name = FifoName { channel, reader: to }.to_string();
            let capacity = Some(Words(self.links[link].fifo(channel).capacity()));
            FifoInfo { name, group: channel.to_string(), from, to, capacity }
        });
        let at_z = |times: &StateTimes| times.of(waiting(Channel::Z)) + times.of(blocked(Channel::Z)) > Cycles(0);
        let uses_z = self.fifos().any(|(_, channel)| channel == Channel::Z)
            || self.cells.iter().any(|station| at_z(&station.cell.times));
        Topology {
            shape: Shape::Line,
            stations: self.cells.len(),
            fifos: fifos.collect(),
            states: states(&self.vocabulary, uses_z),
            names: Names::default(),
        }
    }

    /// Who waits for whom, in an array that does not go on.
    pub fn stuck(&self) -> Stuck {
        let stations = (0..self.cells.len()).map(Actor::Station);
        stuck::diagnose(std::iter::once(Actor::Host).chain(stations).filter_map(|actor| self.blocked(actor)))
    }

    /// What an actor stands at that is not done; `None` if it has done all its ops.
    fn blocked(&self, actor: Actor) -> Option<stuck::Blocked> {
        let station = self.station(actor);
        let batch = self.batches.get(station.batch - self.dropped)?;
        let stream = match actor {
            Actor::Host => &batch.host,
            Actor::Station(index) => &batch.cells[index],
        };
        let op = *stream.ops().get(station.cell.now.done)?;
        let (job, position) = stream.locate(station.cell.now.done).unwrap_or((u32::MAX, station.cell.now.done));
        let left = if station.cell.now.left > 0 { station.cell.now.left } else { op.count() as u64 };
        let mut blocked = stuck::Blocked {
            actor,
            halt: station.halt,
            cycle: station.cell.now.clock,
            op,
            moved: op.count() as u64 - left,
            job,
            position,
            cells: self.cells.len(),
            capacity: None,
        };
        blocked.capacity = blocked.fifo().map(|(link, channel)| self.links[link].fifo(channel).capacity());
        Some(blocked)
    }

    fn station(&self, actor: Actor) -> &CellAt {
        match actor {
            Actor::Host => &self.host,
            Actor::Station(index) => &self.cells[index],
        }
    }
}

/// Does a cell's ops of a batch as [`Cell::run`], seen by nobody.
#[inline(never)]
#[expect(
    clippy::ptr_arg,
    reason = "of a slice, LLVM loads all that links hold before each op, as nothing else could change it"
)]
fn run_unseen(
    (index, cell): (usize, &mut Cell),
    ops: &[Op],
    links: &mut Vec<Link>,
    (prices, is_last): (&Prices, bool),
) -> Halt {
    cell.run(ops, around(links, index), is_last, (prices, ()))
}

impl CellAt {
    /// Notes for whom it waits, if it has halted in one of the ops of its batch; or goes to the start of the next batch, if it has done
    /// all of them. Returns whether it has.
    fn next_batch(&mut self, ops: &[Op]) -> bool {
        let halted_in = ops.get(self.cell.now.done);
        self.awaits = halted_in.and_then(|op| self.halt.awaits(*op));
        let done = self.halt == Halt::OutOfOps;
        if done {
            self.batch += 1;
            self.cell.now.done = 0;
        }
        done
    }

    fn progress(&self) -> (usize, usize, u64) {
        (self.batch, self.cell.now.done, self.cell.now.left)
    }
}
