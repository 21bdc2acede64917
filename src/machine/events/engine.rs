//! Tasks, and what they do to each other.

use std::fmt;
use std::ops::Range;

use super::agenda::{Agenda, NEVER};
use super::causes::Causes;
use super::lanes::Lanes;
use super::mailbox::{Mail, Mailbox, Sender};
use super::network::Network;
use crate::measure::{Measured, MessageSpan, Observed, PathUnit, SoFar, StateId, Topology};
use crate::quantities::Cycles;
use crate::seam::Unit;

/// What a task does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act<M> {
    /// Spends some cycles in a state.
    Spend(StateId, Cycles),
    /// The same, and says on what.
    Work(StateId, Cycles, Work),
    /// Spends some cycles in one state, then in the next.
    SpendEach([(StateId, Cycles); MOST_SPELLS]),
    /// Sends a message.
    Send(Message<M>),
    /// Takes a message; until there is one, it is in that state.
    Receive(Sender, StateId),
    /// Is in a state until another task wakes it.
    Sleep(StateId),
    /// Wakes another task, if that sleeps or waits for a message: it then goes on without one.
    Wake(usize),
    /// Does the job with that number, in one state after the other.
    Job(u32, [(StateId, Cycles); MOST_SPELLS]),
    /// Begins the job with that number.
    Begin(u32),
    /// Has done the job that it began last.
    Done,
    /// Does nothing any more.
    End,
}

/// The turn of a task, which does one thing after the other as long as that takes no time.
pub trait Turn<M> {
    /// Does something. False if that takes time: then its turn is over.
    fn act(&mut self, act: Act<M>) -> bool;

    /// The message that it has waited for, if it has just taken one.
    fn taken(&mut self) -> Option<M>;

    /// Takes the first message that has arrived, if there is one, and tells it.
    fn poll<T>(&mut self, tell: impl FnOnce(&M) -> T) -> Option<T>;
}

/// States that a task can spend its time in, one after the other.
pub const MOST_SPELLS: usize = 5;

/// What time is spent on, where [causes](Events::explained) are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// One unit of work.
    Unit(Unit),
    /// A piece of work, by its number, which consists of several units.
    Piece(u32),
}

/// By what names causes are told.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The units of work, and what each takes.
    pub units: Vec<PathUnit>,
    /// What a message takes as long as it has a bus or its links, and as long as it is on its way without.
    pub carrying: [Unit; 2],
    /// What each piece of work consists of: how many of each of the first units.
    pub pieces: Vec<[u32; PIECE_UNITS]>,
}

/// As many units a piece of work can consist of.
pub const PIECE_UNITS: usize = 8;

/// A message that a task sends: first the task itself is at work on it, then a bus carries it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<M> {
    /// Whom it is for, and what its sender does when it is ready to go.
    pub delivery: Delivery,
    /// What the sender itself spends on it.
    pub time: Cycles,
    /// How long it is.
    pub bytes: u64,
    /// What is in it.
    pub content: M,
}

/// Whom a message is for, and what its sender does when it is ready to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// It is for that task, and the sender goes on.
    Post(usize),
    /// It is for that task. The sender sends until it has arrived, and is then in that state until the task takes it: a
    /// rendezvous.
    Hold(usize, StateId),
    /// It is for all other tasks, and the sender goes on.
    Broadcast,
}

/// What a task is at.
#[derive(Clone, Copy, Debug)]
enum Phase<M> {
    /// Something that ends by itself.
    Busy,
    /// A job, which is done when it ends.
    Works,
    /// A message, until it is ready to go.
    Sends(Message<M>),
    /// A message that is on its way until a time, then a state until the receiver takes it.
    Holds { to: usize, arrives: u64, state: StateId },
    /// Waiting for a message.
    Waits { from: Sender, state: StateId },
    /// Waiting to be woken.
    Sleeps(StateId),
    /// Nothing any more.
    Ended,
}

/// The unit of work that a task spends on a message, by what is in it.
type WorkOf<M> = fn(&M) -> Option<Unit>;

/// Tasks at work.
#[derive(Debug)]
pub struct Events<M> {
    phases: Vec<Phase<M>>,
    mailboxes: Vec<Mailbox<M>>,
    agenda: Agenda,
    network: Network,
    lanes: Lanes,
    /// What follows from what, if that is asked for.
    causes: Option<(Causes, WorkOf<M>)>,
    /// The state of a task that is at work on a message, or whose message is on its way and held.
    sending: StateId,
    /// What is in the message that the task which acts has just taken.
    taken: Option<M>,
    now: u64,
}

/// The task whose turn it is.
#[derive(Debug)]
pub struct Acting<'a, M> {
    events: &'a mut Events<M>,
    task: usize,
    /// When it goes on, if not at once.
    until: Option<u64>,
}

impl<M: Copy> Turn<M> for Acting<'_, M> {
    #[inline(always)]
    fn act(&mut self, act: Act<M>) -> bool {
        self.until = self.events.act(self.task, act);
        self.until.is_none()
    }

    #[inline(always)]
    fn taken(&mut self) -> Option<M> {
        if self.events.taken.is_some() { self.events.taken.take() } else { None }
    }

    #[inline(always)]
    fn poll<T>(&mut self, tell: impl FnOnce(&M) -> T) -> Option<T> {
        self.events.take(self.task, Sender::Anyone, tell)
    }
}

/// Tasks wait for each other, or for messages that nobody sends.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Standstill(pub Vec<(usize, Waits)>);

/// What a task waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Waits {
    /// A message.
    For(Sender),
    /// That a task takes its message.
    On(usize),
    /// That a task wakes it.
    ToBeWoken,
}

impl<M: Copy> Events<M> {
    /// The tasks of a machine at time 0. In `sending` they send, in `idle` they have nothing left to do.
    pub fn new(topology: Topology, network: impl Into<Network>, states: (StateId, StateId)) -> Events<M> {
        Events::with_helpers(topology, 0, network, states)
    }

    /// The same with so many more tasks, which help the others and whose time is not told.
    pub fn with_helpers(
        topology: Topology,
        helpers: usize,
        network: impl Into<Network>,
        (sending, idle): (StateId, StateId),
    ) -> Events<M> {
        let tasks = topology.stations + helpers;
        Events {
            phases: vec![Phase::Busy; tasks],
            mailboxes: (0..tasks).map(|_| Mailbox::new()).collect(),
            agenda: Agenda::new(tasks),
            network: network.into(),
            lanes: Lanes::new(topology, idle),
            causes: None,
            sending,
            taken: None,
            now: 0,
        }
    }

    /// The same with a probe, which sees what they do over time.
    pub fn probed(mut self) -> Events<M> {
        self.lanes.probe();
        self
    }

    /// The same with a recorder of a window of time, which holds so many events at the most.
    pub fn recorded(mut self, window: Range<Cycles>, most_events: usize) -> Events<M> {
        self.lanes.record(window, most_events);
        self
    }

    /// The same, noting when each job is begun first, and done last.
    pub fn noting_spans(mut self) -> Events<M> {
        self.lanes.note_spans();
        self
    }

    /// The same with its causes followed, of which all time is told as work: [`Act::Work`] says what.
    /// `sending` tells the unit of work that a task spends on a message, by what is in it.
    pub fn explained(mut self, explanation: Explanation, sending: WorkOf<M>) -> Events<M> {
        self.causes = Some((Causes::new(self.phases.len(), self.network.count(), explanation), sending));
        self
    }

    /// Lets the next task do what it can: `next` is told the task and the time, and lets it act. False if no task has anything left to do.
    #[inline]
    pub fn step(&mut self, next: &mut impl FnMut(usize, Cycles, &mut Acting<'_, M>)) -> bool {
        let Some((now, task)) = self.agenda.next() else { return false };
        self.now = now;
        let mut pause = self.resume(task);
        let until = loop {
            if let Some(until) = pause {
                break until;
            }
            let mut turn = Acting { events: self, task, until: None };
            next(task, Cycles(now), &mut turn);
            pause = turn.until;
        };
        self.taken = None;
        self.agenda.settle(task, until);
        if let Some((causes, _)) = self.causes.as_mut().filter(|(causes, _)| causes.is_full()) {
            causes.reckon(self.mailboxes.iter_mut().flat_map(Mailbox::all).map(|mail| &mut mail.cause));
        }
        true
    }

    /// A task wakes up. Returns when it goes on, if not at once.
    #[inline]
    fn resume(&mut self, task: usize) -> Option<u64> {
        match self.phases[task] {
            Phase::Busy => None,
            Phase::Works => {
                self.lanes.done(task, self.now);
                None
            }
            Phase::Sends(_) => self.send(task),
            Phase::Holds { arrives, state, .. } => {
                self.lanes.spend(task, self.sending, arrives);
                self.lanes.spend(task, state, self.now);
                None
            }
            Phase::Waits { from, state } => {
                self.lanes.spend(task, state, self.now);
                self.receive(task, from, state)
            }
            Phase::Sleeps(_) | Phase::Ended => Some(NEVER),
        }
    }

    /// A task does something. Returns when it goes on, if not at once. Where it is known what it does, no more than that is left of this.
    #[inline(always)]
    fn act(&mut self, task: usize, act: Act<M>) -> Option<u64> {
        match act {
            Act::Spend(state, cycles) => self.spend(task, (state, cycles), Phase::Busy),
            Act::Work(state, cycles, work) => {
                if let Some((causes, _)) = &mut self.causes {
                    causes.work(task, cycles, work);
                }
                self.spend(task, (state, cycles), Phase::Busy)
            }
            Act::SpendEach(spells) => self.spend_each(task, &spells, Phase::Busy),
            Act::Job(job, spells) => {
                self.lanes.begin(task, job, self.now);
                let until = self.spend_each(task, &spells, Phase::Works);
                if until.is_none() {
                    self.lanes.done(task, self.now);
                }
                until
            }
            Act::Send(message) => self.begin_to_send(task, message),
            Act::Receive(from, state) => self.receive(task, from, state),
            Act::Sleep(state) => {
                self.phases[task] = Phase::Sleeps(state);
                Some(NEVER)
            }
            Act::Wake(other) => {
                self.wake(task, other);
                None
            }
            Act::Begin(job) => {
                self.lanes.begin(task, job, self.now);
                None
            }
            Act::Done => {
                self.lanes.done(task, self.now);
                None
            }
            Act::End => {
                self.phases[task] = Phase::Ended;
                Some(NEVER)
            }
        }
    }

    /// A task is at work on a message, which it then sends.
    #[inline(always)]
    fn begin_to_send(&mut self, task: usize, message: Message<M>) -> Option<u64> {
        self.phases[task] = Phase::Sends(message);
        if let Some((causes, sending)) = &mut self.causes
            && let Phase::Sends(message) = &self.phases[task]
            && let Some(unit) = sending(&message.content)
        {
            causes.work(task, message.time, Work::Unit(unit));
        }
        match message.time {
            Cycles(0) => self.send(task),
            time => Some(self.lanes.spend_each(task, &[(self.sending, time)], self.now)),
        }
    }

    /// A task spends some time in a state.
    #[inline(always)]
    fn spend(&mut self, task: usize, spell: (StateId, Cycles), phase: Phase<M>) -> Option<u64> {
        self.spend_each(task, &[spell], phase)
    }

    /// The same in several states, one after the other.
    #[inline(always)]
    fn spend_each(&mut self, task: usize, spells: &[(StateId, Cycles)], phase: Phase<M>) -> Option<u64> {
        let until = self.lanes.spend_each(task, spells, self.now);
        if until == self.now {
            return None;
        }
        self.phases[task] = phase;
        Some(until)
    }

    /// A task goes on that sleeps or waits for a message, as another wakes it.
    fn wake(&mut self, waker: usize, task: usize) {
        if let Phase::Sleeps(state) | Phase::Waits { state, .. } = self.phases[task] {
            self.lanes.spend(task, state, self.now);
            self.phases[task] = Phase::Busy;
            self.agenda.wake(task, self.now);
            if let Some((causes, _)) = &mut self.causes {
                causes.woken(task, waker);
            }
        }
    }

    /// The message that a task sends is ready to go. Returns when its sender goes on, if not at once.
    fn send(&mut self, task: usize) -> Option<u64> {
        let Phase::Sends(Message { delivery, bytes, .. }) = self.phases[task] else { return None };
        match delivery {
            Delivery::Post(to) => {
                self.carry(task, to, bytes, false);
                None
            }
            Delivery::Hold(to, state) => {
                let arrives = self.carry(task, to, bytes, true);
                self.phases[task] = Phase::Holds { to, arrives, state };
                Some(NEVER)
            }
            Delivery::Broadcast => {
                self.broadcast(task, bytes);
                None
            }
        }
    }

    /// Lets the network carry a task's message, and tells when it arrives.
    #[inline(always)]
    fn carry(&mut self, task: usize, to: usize, bytes: u64, is_held: bool) -> u64 {
        let passed = self.pass(task, to, bytes);
        self.deliver(task, to, passed, is_held);
        passed.0
    }

    /// A task's message goes to all others: at once if the network can, else to one after the other.
    #[inline(never)]
    fn broadcast(&mut self, task: usize, bytes: u64) {
        let others = (0..self.phases.len()).filter(|&other| other != task);
        if !self.network.broadcasts() {
            return others.for_each(|other| {
                self.carry(task, other, bytes, false);
            });
        }
        let passed = self.pass(task, task, bytes);
        others.for_each(|other| self.deliver(task, other, passed, false));
    }

    #[inline]
    fn set_out(&mut self, task: usize, to: usize, at: u64) {
        let Events { lanes, network, now, .. } = self;
        lanes.message(|| {
            let [from, to] = [task, to].map(|task| network.place(task));
            MessageSpan { from, to, sent: Cycles(*now), arrived: Cycles(at) }
        });
    }

    /// When a message that is ready to go arrives, and by what chain of causes.
    #[inline(always)]
    fn pass(&mut self, task: usize, to: usize, bytes: u64) -> (u64, u32) {
        let passage = self.network.carry((task, to), self.now, bytes);
        let cause = self
            .causes
            .as_mut()
            .map_or(0, |(causes, _)| causes.carry(task, &passage, &self.network.taken_by((task, to), &passage)));
        (passage.arrives, cause)
    }

    /// A task's message sets out, and arrives at that time by that chain of causes.
    #[inline(always)]
    fn deliver(&mut self, task: usize, to: usize, (at, cause): (u64, u32), is_held: bool) {
        self.set_out(task, to, at);
        if let Phase::Waits { from, .. } = self.phases[to]
            && from.is(task)
        {
            self.agenda.wake(to, at);
        }
        // It is copied from where it was written long ago: what was written just now in smaller pieces takes longer to read.
        let Phase::Sends(Message { ref content, .. }) = self.phases[task] else { return };
        self.mailboxes[to].add((at, task), || Mail { at, cause, from: task, is_held, content: *content });
    }

    /// Takes a message, if there is one; else waits for it. Returns when the task goes on, if not at once.
    fn receive(&mut self, task: usize, from: Sender, state: StateId) -> Option<u64> {
        self.taken = self.take(task, from, |content| *content);
        if self.taken.is_some() {
            return None;
        }
        self.phases[task] = Phase::Waits { from, state };
        Some(self.mailboxes[task].arrival(from).unwrap_or(NEVER))
    }

    /// Takes a message, if there is one, whose sender may wait for that, and tells it.
    #[inline(always)]
    fn take<T>(&mut self, task: usize, from: Sender, tell: impl FnOnce(&M) -> T) -> Option<T> {
        let mailbox = &mut self.mailboxes[task];
        let (place, mail) = mailbox.first(from, self.now)?;
        if let Some((causes, _)) = &mut self.causes {
            causes.taken(task, mail);
        }
        if mail.is_held {
            self.agenda.wake(mail.from, self.now);
        }
        let told = tell(&mail.content);
        mailbox.remove(place);
        Some(told)
    }

    /// What the tasks have done so far. Each has come to a cycle of its own.
    pub fn so_far(&self) -> SoFar {
        self.lanes.so_far(self.now)
    }

    /// What was measured and seen up to now. `rests` tells since when each task waits for what does not come any more: from then on it
    /// has nothing left to do.
    pub fn stop(mut self, rests: impl Fn(usize) -> Option<Cycles>) -> (Measured, Observed) {
        for task in 0..self.phases.len() {
            if let Phase::Sleeps(state) | Phase::Waits { state, .. } = self.phases[task] {
                self.lanes.spend(task, state, rests(task).map_or(self.now, |since| since.0));
            }
        }
        self.measured()
    }

    fn measured(self) -> (Measured, Observed) {
        let (measured, observed) = self.lanes.finish(self.now, self.network.stats());
        let path = self.causes.map(|(causes, _)| causes.finish(&measured.topology, self.now));
        (measured, Observed { path, ..observed })
    }

    /// What was measured and seen, when all tasks have ended.
    pub fn finish(self) -> Result<(Measured, Observed), Standstill> {
        let waits = |phase: &Phase<M>| match *phase {
            Phase::Waits { from, .. } => Some(Waits::For(from)),
            Phase::Holds { to, .. } => Some(Waits::On(to)),
            Phase::Sleeps(_) => Some(Waits::ToBeWoken),
            Phase::Busy | Phase::Works | Phase::Sends(_) | Phase::Ended => None,
        };
        let waiting: Vec<_> =
            self.phases.iter().enumerate().filter_map(|(task, phase)| Some((task, waits(phase)?))).collect();
        match waiting.is_empty() {
            true => Ok(self.measured()),
            false => Err(Standstill(waiting)),
        }
    }
}

impl fmt::Display for Standstill {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no task can go on")?;
        self.0.iter().try_for_each(|(task, waits)| match waits {
            Waits::For(Sender::Anyone) => write!(f, "; task {task} waits for a message"),
            Waits::For(Sender::Task(other)) => write!(f, "; task {task} waits for a message of task {other}"),
            Waits::ToBeWoken => write!(f, "; task {task} waits to be woken"),
            Waits::On(other) => write!(f, "; task {task} waits until task {other} takes its message"),
        })
    }
}
