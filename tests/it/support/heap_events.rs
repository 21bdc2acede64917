//! A second scheduler, for comparison: all that is to happen lies in one heap, by time, then by task. It knows acts as the engine does and shares
//! nothing else with it.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use pcs_sim::machine::events::{Act, Delivery, Message, Turn};
use pcs_sim::machine::{Cycles, Ipsc2};
use pcs_sim::measure::StateId;

use super::cube_wires::Wires;

#[derive(Clone, Copy)]
enum Doing<M> {
    Something,
    Sending(Message<M>),
    Waiting(StateId),
    Sleeping(StateId),
    Nothing,
}

struct Task<M> {
    doing: Doing<M>,
    /// Since when; and which of its entries in the heap counts.
    since: u64,
    entry: u64,
    /// By arrival, sender, and number.
    mail: BTreeMap<(u64, usize, u64), M>,
    spent: BTreeMap<u8, u64>,
}

/// What came out: the end, and for each task the cycles in each state in which it was.
pub struct Ended {
    pub cycles: u64,
    pub spent: Vec<BTreeMap<u8, u64>>,
    pub links: Vec<[u64; 4]>,
}

/// All tasks, of which one acts.
pub struct Heap<'a, M> {
    all: Vec<Task<M>>,
    /// When each task goes on, and the number of that entry.
    heap: BinaryHeap<Reverse<(u64, usize, u64)>>,
    wires: Wires<'a>,
    nodes: usize,
    sending: StateId,
    /// Messages sent.
    number: u64,
    now: u64,
    task: usize,
    taken: Option<M>,
    is_over: bool,
}

impl<'a, M: Copy> Heap<'a, M> {
    fn new(machine: &'a Ipsc2, tasks: usize, sending: StateId) -> Heap<'a, M> {
        let new =
            || Task { doing: Doing::Something, since: 0, entry: 0, mail: BTreeMap::new(), spent: BTreeMap::new() };
        Heap {
            all: (0..tasks).map(|_| new()).collect(),
            heap: (0..tasks).map(|task| Reverse((0, task, 0))).collect(),
            wires: Wires::new(machine),
            nodes: machine.nodes,
            sending,
            number: 0,
            now: 0,
            task: 0,
            taken: None,
            is_over: false,
        }
    }

    fn on(&self, task: usize) -> usize {
        if task > self.nodes { task - self.nodes - 1 } else { task }
    }

    fn spend(&mut self, spells: &[(StateId, Cycles)], doing: Doing<M>) {
        let task = &mut self.all[self.task];
        for (state, cycles) in spells {
            *task.spent.entry(state.0).or_default() += cycles.0;
        }
        let sum: u64 = spells.iter().map(|spell| spell.1.0).sum();
        if sum > 0 {
            task.doing = doing;
            self.heap.push(Reverse((self.now + sum, self.task, task.entry)));
            self.is_over = true;
        }
    }

    fn send(&mut self, message: Message<M>) {
        let Delivery::Post(to) = message.delivery else { panic!("nodes post") };
        let at = self.wires.carry(self.on(self.task), self.on(to), message.bytes, self.now);
        self.number += 1;
        let receiver = &mut self.all[to];
        receiver.mail.insert((at, self.task, self.number), message.content);
        if let Doing::Waiting(_) = receiver.doing {
            receiver.entry += 1;
            let first = *receiver.mail.first_key_value().unwrap().0;
            self.heap.push(Reverse((first.0.max(self.now), to, receiver.entry)));
        }
    }

    fn receive(&mut self, state: StateId) {
        let (now, task) = (self.now, &mut self.all[self.task]);
        let waited = if let Doing::Waiting(_) = task.doing { now - task.since } else { 0 };
        *task.spent.entry(state.0).or_default() += waited;
        task.since = now;
        match task.mail.first_key_value().map(|(key, _)| *key) {
            Some(key) if key.0 <= now => {
                self.taken = task.mail.remove(&key);
                task.doing = Doing::Something;
            }
            first => {
                task.doing = Doing::Waiting(state);
                self.heap.extend(first.map(|key| Reverse((key.0, self.task, task.entry))));
                self.is_over = true;
            }
        }
    }

    fn wake(&mut self, other: usize) {
        let task = &mut self.all[other];
        if let Doing::Sleeping(state) | Doing::Waiting(state) = task.doing {
            *task.spent.entry(state.0).or_default() += self.now - task.since;
            task.doing = Doing::Something;
            task.entry += 1;
            self.heap.push(Reverse((self.now, other, task.entry)));
        }
    }
}

impl<M: Copy> Turn<M> for Heap<'_, M> {
    fn act(&mut self, act: Act<M>) -> bool {
        match act {
            Act::Spend(state, cycles) | Act::Work(state, cycles, _) => {
                self.spend(&[(state, cycles)], Doing::Something);
            }
            Act::SpendEach(spells) | Act::Job(_, spells) => self.spend(&spells, Doing::Something),
            Act::Send(message) if message.time.0 > 0 => {
                self.spend(&[(self.sending, message.time)], Doing::Sending(message));
            }
            Act::Send(message) => self.send(message),
            Act::Receive(_, state) => self.receive(state),
            Act::Sleep(state) => {
                let task = &mut self.all[self.task];
                (task.doing, task.since, self.is_over) = (Doing::Sleeping(state), self.now, true);
            }
            Act::Wake(other) => self.wake(other),
            Act::Begin(_) | Act::Done => {}
            Act::End => (self.all[self.task].doing, self.is_over) = (Doing::Nothing, true),
        }
        !self.is_over
    }

    fn taken(&mut self) -> Option<M> {
        self.taken.take()
    }

    fn poll<T>(&mut self, tell: impl FnOnce(&M) -> T) -> Option<T> {
        let mail = &mut self.all[self.task].mail;
        let first = *mail.first_key_value().filter(|(key, _)| key.0 <= self.now)?.0;
        mail.remove(&first).as_ref().map(tell)
    }
}

/// Lets tasks act until `is_over`, or nothing is left to happen. `tasks` are the nodes, the host, and helpers; `rests` tells since when one has
/// nothing left to do.
pub fn run<P, M: Copy>(
    (machine, tasks): (&Ipsc2, usize),
    program: &mut P,
    next: impl Fn(&mut P, usize, Cycles, &mut Heap<'_, M>),
    is_over: impl Fn(&P) -> bool,
    rests: impl Fn(&P, usize) -> Option<Cycles>,
    (sending, idle): (StateId, StateId),
) -> Ended {
    let mut heap = Heap::new(machine, tasks, sending);
    while !is_over(program) {
        let Some(Reverse((now, task, entry))) = heap.heap.pop() else { break };
        if heap.all[task].entry != entry {
            continue;
        }
        (heap.now, heap.task, heap.is_over) = (now, task, false);
        heap.all[task].entry += 1;
        match heap.all[task].doing {
            Doing::Sending(message) => heap.send(message),
            Doing::Waiting(state) => heap.receive(state),
            _ => {}
        }
        while !heap.is_over {
            next(program, task, Cycles(now), &mut heap);
        }
    }
    let now = heap.now;
    for (number, task) in heap.all.iter_mut().enumerate() {
        if let Doing::Waiting(state) | Doing::Sleeping(state) = task.doing {
            let until = rests(program, number).map_or(now, |since| since.0);
            *task.spent.entry(state.0).or_default() += until - task.since.min(until);
        }
        let sum: u64 = task.spent.values().sum();
        *task.spent.entry(idle.0).or_default() += now - sum;
        task.spent.retain(|_, cycles| *cycles > 0);
    }
    Ended { cycles: now, spent: heap.all.into_iter().map(|task| task.spent).collect(), links: heap.wires.taken() }
}
