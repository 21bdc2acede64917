//! A farm that ticks every nanosecond, for comparison. It shares no code with the engine and the tasks: each task has a list of
//! instructions, and whenever it has done them it is told the next ones.

use std::collections::{BTreeMap, VecDeque};

use pcs_sim::program::farm::{HandOut, SceneBy};

/// A farm in plain numbers. Times are in ns.
#[derive(Clone, Debug)]
pub struct Plan {
    pub workers: usize,
    /// The times of the pixels of each item.
    pub items: Vec<Vec<u64>>,
    pub fixed: u64,
    pub per_cap: u64,
    pub message: u64,
    pub segment: u64,
    pub color: u64,
    pub buses: usize,
    /// ps that a byte has a bus.
    pub byte_ps: u64,
    pub header: u64,
    pub scene_bytes: u64,
    pub hand_out: HandOut,
    pub scene_by: SceneBy,
}

/// What is in a message.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Text {
    Scene,
    Ready(usize),
    Item(usize),
    NoMore,
    Color,
}

#[derive(Clone, Copy, Debug)]
enum Instruction {
    /// Be in a state for some time.
    Be(&'static str, u64),
    /// Send to a task, and wait in a state until it has the message.
    Hand(usize, &'static str, Text),
    /// Send to some tasks, and go on.
    Post(usize, usize, Text),
    /// Wait in a state for a message of a task, or of anyone.
    Take(Option<usize>, &'static str),
}

struct Message {
    number: usize,
    arrives: u64,
    from: usize,
    to: usize,
    text: Text,
}

#[derive(Default)]
struct Task {
    todo: VecDeque<Instruction>,
    /// How long it is still busy.
    busy: u64,
    /// The message that it waits to have taken.
    handed: Option<usize>,
    /// The state that it is in.
    state: &'static str,
    told: Option<Text>,
    ended: bool,
    stage: usize,
}

/// What came out: the time, and for each task the time in each state.
#[derive(Debug, PartialEq)]
pub struct Ticked {
    pub time: u64,
    pub tasks: Vec<BTreeMap<String, u64>>,
}

struct Farm<'a> {
    plan: &'a Plan,
    tasks: Vec<Task>,
    under_way: Vec<Message>,
    sent: usize,
    bus_free: Vec<u64>,
    now: u64,
    next_item: usize,
    asked: Vec<bool>,
    at_work: usize,
    filed: usize,
}

/// Ticks a farm to its end.
pub fn tick(plan: &Plan) -> Ticked {
    let tasks = plan.workers + 2;
    let mut farm = Farm {
        plan,
        tasks: (0..tasks).map(|_| Task::default()).collect(),
        under_way: Vec::new(),
        sent: 0,
        bus_free: vec![0; plan.buses],
        now: 0,
        next_item: 0,
        asked: vec![false; plan.workers],
        at_work: plan.workers,
        filed: 0,
    };
    let mut spent = vec![BTreeMap::new(); tasks];
    loop {
        while (0..tasks).any(|task| farm.goes_on(task)) {}
        if farm.tasks.iter().all(|task| task.ended) {
            return Ticked { time: farm.now, tasks: spent };
        }
        for (task, spent) in farm.tasks.iter_mut().zip(&mut spent) {
            let state = if task.ended { "idle" } else { task.state };
            *spent.entry(state.to_owned()).or_insert(0) += 1;
            task.busy = task.busy.saturating_sub(1);
        }
        farm.now += 1;
        assert!(farm.now < 1_000_000, "it does not end");
    }
}

impl Farm<'_> {
    /// Lets a task do all that it can at this time. False if that is nothing.
    fn goes_on(&mut self, task: usize) -> bool {
        let mut has_done = false;
        while self.does_one(task) {
            has_done = true;
        }
        has_done
    }

    fn does_one(&mut self, task: usize) -> bool {
        if self.tasks[task].ended || self.tasks[task].busy > 0 {
            return false;
        }
        if let Some(number) = self.tasks[task].handed {
            if let Some(message) = self.under_way.iter().find(|message| message.number == number) {
                if message.arrives <= self.now
                    && let Some(Instruction::Hand(_, state, _)) = self.tasks[task].todo.front()
                {
                    self.tasks[task].state = state;
                }
                return false;
            }
            self.tasks[task].handed = None;
            self.tasks[task].todo.pop_front();
            return true;
        }
        let Some(&instruction) = self.tasks[task].todo.front() else {
            self.tell(task);
            return true;
        };
        match instruction {
            Instruction::Be(state, time) => {
                self.tasks[task].state = state;
                self.tasks[task].busy = time;
                self.tasks[task].todo.pop_front();
                true
            }
            Instruction::Hand(to, _, text) => {
                self.tasks[task].state = "sending";
                self.tasks[task].handed = Some(self.sent);
                self.put_on_bus(task, to..to + 1, text);
                true
            }
            Instruction::Post(from, until, text) => {
                self.put_on_bus(task, from..until, text);
                self.tasks[task].todo.pop_front();
                true
            }
            Instruction::Take(from, state) => {
                self.tasks[task].state = state;
                let is_for = |message: &&Message| {
                    message.to == task && message.arrives <= self.now && from.is_none_or(|from| from == message.from)
                };
                let first = self.under_way.iter().filter(is_for).min_by_key(|m| (m.arrives, m.from, m.number));
                let Some(number) = first.map(|message| message.number) else { return false };
                let place = self.under_way.iter().position(|message| message.number == number).unwrap();
                self.tasks[task].told = Some(self.under_way.remove(place).text);
                self.tasks[task].todo.pop_front();
                true
            }
        }
    }

    fn put_on_bus(&mut self, from: usize, to: std::ops::Range<usize>, text: Text) {
        let inside = match text {
            Text::Scene => self.plan.scene_bytes,
            Text::Ready(_) => 0,
            Text::NoMore => 4,
            Text::Item(_) => 8,
            Text::Color => 20,
        };
        let time = ((self.plan.header + inside) * self.plan.byte_ps).div_ceil(1000);
        let bus = (0..self.bus_free.len()).min_by_key(|&bus| (self.bus_free[bus], bus)).unwrap();
        let arrives = self.now.max(self.bus_free[bus]) + time;
        self.bus_free[bus] = arrives;
        for to in to {
            self.under_way.push(Message { number: self.sent, arrives, from, to, text });
            self.sent += 1;
        }
    }

    /// Tells a task what to do next.
    fn tell(&mut self, task: usize) {
        let told = self.tasks[task].told.take();
        let stage = self.tasks[task].stage;
        self.tasks[task].stage += 1;
        let todo = match task {
            0 => self.station(stage, told),
            1 => self.master(stage, told),
            _ => self.worker(task, stage, told),
        };
        match todo {
            Some(todo) => self.tasks[task].todo.extend(todo),
            None => self.tasks[task].ended = true,
        }
    }

    fn station(&mut self, stage: usize, told: Option<Text>) -> Option<Vec<Instruction>> {
        let plan = self.plan;
        let tasks = plan.workers + 2;
        if stage == 0 {
            let mut todo = vec![Instruction::Be("computing", plan.fixed)];
            match plan.scene_by {
                SceneBy::Copies => (1..tasks).for_each(|task| {
                    todo.push(Instruction::Be("sending", plan.per_cap));
                    todo.push(Instruction::Hand(task, "waiting answer", Text::Scene));
                }),
                SceneBy::Broadcast => {
                    todo.push(Instruction::Be("sending", plan.per_cap));
                    todo.push(Instruction::Post(1, tasks, Text::Scene));
                }
            }
            return Some(todo);
        }
        if told == Some(Text::Color) {
            self.filed += 1;
            return Some(vec![Instruction::Be("receiving", plan.color)]);
        }
        let all: usize = plan.items.iter().map(Vec::len).sum();
        (self.filed < all).then(|| vec![Instruction::Take(None, "waiting mail")])
    }

    fn master(&mut self, stage: usize, told: Option<Text>) -> Option<Vec<Instruction>> {
        if stage == 0 {
            let take = Instruction::Take(None, "waiting mail");
            return Some(vec![Instruction::Take(Some(0), "waiting scene"), take]);
        }
        // All have been told that there are no more, and the last has answered.
        if self.at_work == 0 {
            return None;
        }
        let Some(Text::Ready(worker)) = told else { panic!("the master hears requests") };
        let text = match self.item_for(worker - 2) {
            Some(item) => Text::Item(item),
            None => {
                self.at_work -= 1;
                Text::NoMore
            }
        };
        let mut todo = vec![
            Instruction::Be("sending", self.plan.message),
            Instruction::Hand(worker, "waiting answer", text),
            Instruction::Take(Some(worker), "waiting answer"),
        ];
        if self.at_work > 0 {
            todo.push(Instruction::Take(None, "waiting mail"));
        }
        Some(todo)
    }

    fn item_for(&mut self, worker: usize) -> Option<usize> {
        let item = match self.plan.hand_out {
            HandOut::Request => self.next_item,
            HandOut::Dealt if self.asked[worker] => return None,
            HandOut::Dealt => worker,
        };
        self.asked[worker] = true;
        self.next_item += 1;
        (item < self.plan.items.len()).then_some(item)
    }

    fn worker(&mut self, task: usize, stage: usize, told: Option<Text>) -> Option<Vec<Instruction>> {
        let plan = self.plan;
        let says =
            [Instruction::Be("sending", plan.message), Instruction::Hand(1, "waiting master", Text::Ready(task))];
        let asks = [&says[..], &[Instruction::Take(Some(1), "waiting item")]].concat();
        if stage == 0 {
            return Some([&[Instruction::Take(Some(0), "waiting scene")], &asks[..]].concat());
        }
        let mut todo = says.to_vec();
        match told {
            Some(Text::Item(first)) => {
                let step = if plan.hand_out == HandOut::Dealt { plan.workers } else { plan.items.len() };
                for item in plan.items[first..].iter().step_by(step) {
                    todo.push(Instruction::Be("computing", plan.segment));
                    for &time in item {
                        todo.push(Instruction::Be("computing", time));
                        todo.push(Instruction::Post(0, 1, Text::Color));
                    }
                }
                todo.extend(asks);
                Some(todo)
            }
            Some(Text::NoMore) => Some(todo),
            _ => None,
        }
    }
}
