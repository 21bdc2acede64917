//! The judge: the machine ticked cycle by cycle, written as plainly as the machine's description and sharing no code
//! with the simulator's timing half but the types of its input and output.

use std::collections::{BTreeMap, VecDeque};

use pcs_sim::machine::line::{IDLE, MOVING, blocked, waiting, working};
use pcs_sim::machine::{Cycles, MachineSpec, RateCounts, Words};
use pcs_sim::measure::{self, FifoStats, LinkStats, Measured, StateId, StateTimes};
use pcs_sim::seam::{Channel, Costs, Op, OpBatch, OpKind};

/// What the judge counts.
#[derive(Debug, Default, PartialEq)]
pub struct Ticked {
    pub cycles: Cycles,
    pub jobs: u64,
    pub stations: Vec<StateTimes>,
    /// Each FIFO's name, how many words it holds, and its figures.
    pub fifos: Vec<(String, Words, FifoStats)>,
    pub links: Vec<LinkStats>,
}

impl From<&Measured> for Ticked {
    fn from(run: &Measured) -> Ticked {
        let infos = run.topology.fifos.iter().map(|info| (info.name.clone(), info.capacity));
        Ticked {
            cycles: run.cycles,
            jobs: run.jobs,
            stations: run.stations.clone(),
            fifos: infos.zip(&run.fifos).map(|((name, capacity), fifo)| (name, capacity.unwrap(), *fifo)).collect(),
            links: run.links.clone(),
        }
    }
}

/// What happened in every single cycle.
#[derive(Default)]
pub struct History {
    /// For each cell, its state in each cycle.
    pub states: Vec<Vec<StateId>>,
    /// For each cell, in each cycle the number of the op that it was at; that behind the last when it had done all.
    pub at: Vec<Vec<usize>>,
    /// The same for the host.
    pub host_at: Vec<usize>,
    /// For each FIFO, in the order of the statistics, its occupancy at the end of each cycle.
    pub occupancies: Vec<Vec<u64>>,
    /// For each link and channel (0, 1, 2 for X, Y, Z), the cycles in which words were written and in which they were read.
    pub words: BTreeMap<(usize, usize), [Vec<u64>; 2]>,
    /// The cycles in which the host wrote the words of X.
    pub sent: Vec<u64>,
    /// The cycles in which the host read the last words of messages.
    pub returned: Vec<u64>,
}

/// A FIFO as a queue of write cycles, observed at the end of every cycle.
struct Queue {
    name: String,
    capacity: u64,
    written_in: VecDeque<u64>,
    at_start: usize,
    words: u64,
    max: u64,
    word_cycles: u128,
    full: u64,
    empty: u64,
}

struct Actor {
    ops: Vec<Op>,
    at: usize,
    done_of_op: u64,
    times: StateTimes,
}

pub struct Ticking<'a> {
    spec: &'a MachineSpec,
    costs: &'a Costs,
    host: Actor,
    cells: Vec<Actor>,
    x: Vec<Queue>,
    /// y[i] is read by cell i + 1, the last one by the host.
    y: Vec<Queue>,
    /// z[i] is written by cell i + 1 and read by cell i.
    z: Vec<Queue>,
    /// Per link (0 is the host's) and channel, the first cycle in which the wire is free.
    wire_free: Vec<[u64; 3]>,
    /// Per link, for how many cycles the wire of X and that of Y, which may be one, carried a word.
    wire_busy: Vec<[u64; 2]>,
    returned_words: u64,
    returned: Vec<u64>,
    now: u64,
    history: History,
}

/// Ticks the ops to the end. `None` if they never end.
pub fn run(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch]) -> Option<Ticked> {
    Some(run_recorded(spec, costs, batches)?.0)
}

/// The same, and what happened in every cycle.
pub fn run_recorded(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch]) -> Option<(Ticked, History)> {
    Ticking::new(spec, costs, batches).run(batches)
}

impl Queue {
    /// It holds what the machine says for it by name, else for its channel, else for all.
    fn new(name: String, spec: &MachineSpec) -> Queue {
        let own = spec.own_words.iter().find(|(fifo, _)| fifo.to_string() == name).map(|(_, &words)| words);
        let of_channel = spec.channel_words["XYZ".find(&name[..1]).unwrap()];
        let capacity = own.or(of_channel).unwrap_or(spec.fifo_words).0;
        Queue {
            name,
            capacity,
            written_in: VecDeque::new(),
            at_start: 0,
            words: 0,
            max: 0,
            word_cycles: 0,
            full: 0,
            empty: 0,
        }
    }

    fn observe(&mut self) {
        let occupancy = self.written_in.len() as u64;
        self.max = self.max.max(occupancy);
        self.word_cycles += occupancy as u128;
        self.full += (occupancy == self.capacity) as u64;
        self.empty += (occupancy == 0) as u64;
    }

    fn stats(&self) -> (String, Words, FifoStats) {
        let stats = FifoStats {
            words: Words(self.words),
            max: Words(self.max),
            word_cycles: self.word_cycles,
            full: Cycles(self.full),
            empty: Cycles(self.empty),
            enough: None,
        };
        (self.name.clone(), Words(self.capacity), stats)
    }
}

impl Actor {
    fn new(ops: Vec<Op>) -> Actor {
        Actor { ops, at: 0, done_of_op: 0, times: StateTimes::default() }
    }

    /// One more cycle or word of the op under way.
    fn step(&mut self, costs: &Costs) {
        self.done_of_op += 1;
        if self.done_of_op == length(self.ops[self.at], costs) {
            self.at += 1;
            self.done_of_op = 0;
        }
    }
}

/// How many cycles, or words, an op is long.
fn length(op: Op, costs: &Costs) -> u64 {
    op.count() as u64 * op.unit().map_or(1, |unit| costs.of(unit).0)
}

impl<'a> Ticking<'a> {
    fn new(spec: &'a MachineSpec, costs: &'a Costs, batches: &[OpBatch]) -> Ticking<'a> {
        let cells = batches[0].cells.len();
        let join = |stream: &dyn Fn(&OpBatch) -> Vec<Op>| Actor::new(batches.iter().flat_map(stream).collect());
        Ticking {
            spec,
            costs,
            host: join(&|batch| batch.host.ops().to_vec()),
            cells: (0..cells).map(|index| join(&|batch| batch.cells[index].ops().to_vec())).collect(),
            x: (0..cells).map(|cell| Queue::new(format!("X{cell}"), spec)).collect(),
            y: (1..cells)
                .map(|cell| format!("Y{cell}"))
                .chain(["Yhost".to_owned()])
                .map(|name| Queue::new(name, spec))
                .collect(),
            z: (1..cells).map(|cell| Queue::new(format!("Z{}", cell - 1), spec)).collect(),
            wire_free: vec![[0; 3]; cells + 1],
            wire_busy: vec![[0; 2]; cells + 1],
            returned_words: 0,
            returned: Vec::new(),
            now: 0,
            history: History {
                states: vec![Vec::new(); cells],
                at: vec![Vec::new(); cells],
                occupancies: vec![Vec::new(); 3 * cells - 1],
                ..History::default()
            },
        }
    }

    fn run(mut self, batches: &[OpBatch]) -> Option<(Ticked, History)> {
        let last = self.cells.last().unwrap();
        let to_return: u64 = last.ops.iter().filter(|op| op.kind() == OpKind::WriteY).map(|op| op.count() as u64).sum();
        let rate = self.spec.link_rate();
        let patience = self.spec.latency.0 + rate.cycles_per_word + 2;
        let mut still = 0;
        while if to_return > 0 { self.returned_words < to_return } else { !self.all_done() } {
            still = if self.tick() { 0 } else { still + 1 };
            if still > patience {
                return None;
            }
        }
        // What can never end must not pass for ended because the host has all its words.
        let stats = self.stats(batches);
        let mut history = std::mem::take(&mut self.history);
        let always = self.x.len() + self.y.len();
        let mut exist = (0..).map(|fifo: usize| fifo.checked_sub(always).is_none_or(|z| self.z[z].words > 0));
        history.occupancies.retain(|_| exist.next().unwrap());
        history.returned = self.returned.clone();
        self.history.states = vec![Vec::new(); self.cells.len()];
        self.history.at = vec![Vec::new(); self.cells.len()];
        self.history.occupancies = vec![Vec::new(); 3 * self.cells.len() - 1];
        if to_return > 0 {
            let mut still = 0;
            while !self.all_done() {
                still = if self.tick() { 0 } else { still + 1 };
                if still > patience {
                    return None;
                }
            }
        }
        Some((stats, history))
    }

    fn all_done(&self) -> bool {
        std::iter::once(&self.host)
            .chain(&self.cells)
            .all(|a| a.ops[a.at..].iter().all(|op| length(*op, self.costs) == 0))
    }

    /// One cycle. Returns whether anything happened in it.
    fn tick(&mut self) -> bool {
        for queue in self.x.iter_mut().chain(&mut self.y).chain(&mut self.z) {
            queue.at_start = queue.written_in.len();
        }
        let mut active = self.tick_host();
        for index in 0..self.cells.len() {
            let before = self.cells[index].times;
            active |= self.tick_cell(index);
            let after = self.cells[index].times;
            let state = (0..=IDLE.0).map(StateId).find(|&state| after.of(state) > before.of(state));
            self.history.states[index].push(state.expect("every cycle is spent in some state"));
        }
        active |= self.host_reads();
        let queues = self.x.iter_mut().chain(&mut self.y).chain(&mut self.z);
        for (queue, occupancies) in queues.zip(&mut self.history.occupancies) {
            queue.observe();
            occupancies.push(queue.written_in.len() as u64);
        }
        for (busy, free) in self.wire_busy.iter_mut().zip(&self.wire_free) {
            busy.iter_mut().zip(free).for_each(|(busy, free)| *busy += (*free > self.now) as u64);
        }
        self.now += 1;
        active
    }

    fn tick_host(&mut self) -> bool {
        let returned = |message: u32| self.returned.get(message as usize).is_some_and(|&cycle| cycle < self.now);
        let takes_no_time = |op: &Op| match op.kind() {
            OpKind::Await => returned(op.count()),
            _ => length(*op, self.costs) == 0,
        };
        let skipped = self.host.ops[self.host.at..].iter().take_while(|op| takes_no_time(op)).count();
        self.host.at += skipped;
        self.history.host_at.push(self.host.at);
        let Some(op) = self.host.ops.get(self.host.at).copied() else { return false };
        match op.kind() {
            OpKind::Await => false,
            OpKind::Work(_) => {
                self.host.step(self.costs);
                true
            }
            OpKind::WriteX => {
                let room = self.room(0, 0);
                if room {
                    self.history.sent.push(self.now);
                    self.put(0, 0);
                    self.host.step(self.costs);
                }
                room
            }
            other => panic!("the host has no op {other:?}"),
        }
    }

    fn tick_cell(&mut self, index: usize) -> bool {
        while self.cells[index].ops.get(self.cells[index].at).is_some_and(|op| length(*op, self.costs) == 0) {
            self.cells[index].at += 1;
        }
        self.history.at[index].push(self.cells[index].at);
        let Some(op) = self.cells[index].ops.get(self.cells[index].at).copied() else {
            *self.cells[index].times.of_mut(IDLE) += Cycles(1);
            return false;
        };
        let last = index + 1 == self.cells.len();
        let (reads, writes) = match op.kind() {
            OpKind::Work(unit) => {
                *self.cells[index].times.of_mut(working(self.costs.activity(unit))) += Cycles(1);
                self.cells[index].step(self.costs);
                return true;
            }
            OpKind::PassX => (Some(0), (!last).then_some(0)),
            OpKind::ReadX => (Some(0), None),
            OpKind::ReadY => (Some(1), None),
            OpKind::WriteX => (None, Some(0)),
            OpKind::WriteY => (None, Some(1)),
            OpKind::ReadZ => (Some(2), None),
            OpKind::WriteZ => (None, Some(2)),
            OpKind::Await => panic!("cells await nothing"),
        };
        let mut state = MOVING;
        // X and Y come from the left and go to the right; Z comes from the right and goes to the left.
        let from = |channel| if channel == 2 { index + 1 } else { index };
        let to = |channel| if channel == 2 { index } else { index + 1 };
        let moved = if reads.is_some_and(|channel| !self.word(from(channel), channel)) {
            state = waiting(Channel::ALL[reads.unwrap()]);
            false
        } else if writes.is_some_and(|channel| !self.room(to(channel), channel)) {
            state = blocked(Channel::ALL[writes.unwrap()]);
            false
        } else {
            true
        };
        *self.cells[index].times.of_mut(state) += Cycles(1);
        if moved {
            if let Some(channel) = reads {
                self.take(from(channel), channel);
            }
            if let Some(channel) = writes {
                self.put(to(channel), channel);
            }
            self.cells[index].step(self.costs);
        }
        moved
    }

    /// The queue of a link: link i leads into cell i, the last one to the host.
    fn queue(&mut self, link: usize, channel: usize) -> Option<&mut Queue> {
        match channel {
            0 => self.x.get_mut(link),
            1 => self.y.get_mut(link.checked_sub(1)?),
            _ => self.z.get_mut(link.checked_sub(1)?),
        }
    }

    fn word(&mut self, link: usize, channel: usize) -> bool {
        let (latency, now) = (self.spec.latency.0, self.now);
        self.queue(link, channel).and_then(|q| q.written_in.front().copied()).is_some_and(|w| w + latency <= now)
    }

    fn room(&mut self, link: usize, channel: usize) -> bool {
        let wire_free = self.wire_free[link][channel] <= self.now;
        wire_free && self.queue(link, channel).is_some_and(|q| (q.at_start as u64) < q.capacity)
    }

    fn take(&mut self, link: usize, channel: usize) {
        self.queue(link, channel).unwrap().written_in.pop_front();
        self.history.words.entry((link, channel)).or_default()[1].push(self.now);
    }

    fn put(&mut self, link: usize, channel: usize) {
        let now = self.now;
        self.history.words.entry((link, channel)).or_default()[0].push(now);
        let queue = self.queue(link, channel).unwrap();
        queue.written_in.push_back(now);
        queue.words += 1;
        let rate = self.spec.link_rate();
        let free = now + rate.cycles_per_word;
        let shared = rate.counts == RateCounts::Link && channel < 2;
        for wire in if shared { 0..2 } else { channel..channel + 1 } {
            self.wire_free[link][wire] = free;
        }
    }

    fn host_reads(&mut self) -> bool {
        let link = self.cells.len();
        let read = self.word(link, 1);
        if read {
            self.take(link, 1);
            self.returned_words += 1;
            if self.returned_words.is_multiple_of(self.costs.vocabulary().answer_words) {
                self.returned.push(self.now);
            }
        }
        read
    }

    fn stats(&self, batches: &[OpBatch]) -> Ticked {
        let used = |queue: &&Queue| queue.words > 0;
        let fifos = self.x.iter().chain(&self.y).chain(self.z.iter().filter(used));
        let cells = || (0..self.cells.len()).map(measure::Actor::Station);
        let ends = [measure::Actor::Host].into_iter().chain(cells()).zip(cells().chain([measure::Actor::Host]));
        let read = |queue: Option<&Queue>| queue.map_or(0, |queue| queue.words - queue.written_in.len() as u64);
        let rate = self.spec.link_rate();
        let links = ends.zip(&self.wire_busy).enumerate().map(|(link, ((from, into), [x, y]))| {
            let [x_read, y_read] =
                [read(self.x.get(link)), read(link.checked_sub(1).and_then(|link| self.y.get(link)))];
            let words = if rate.counts == RateCounts::Link { x_read + y_read } else { x_read.max(y_read) };
            let busy = *x.max(y);
            let read = Cycles((words * rate.cycles_per_word).min(busy));
            LinkStats { from: Some(from), into: Some(into), busy: Cycles(busy), read, messages: None }
        });
        Ticked {
            cycles: Cycles(self.now),
            jobs: batches.iter().map(|batch| batch.host.lines().len() as u64).sum(),
            stations: self.cells.iter().map(|cell| cell.times).collect(),
            fifos: fifos.map(Queue::stats).collect(),
            links: links.collect(),
        }
    }
}
