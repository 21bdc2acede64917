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
    /// Be in a state for some time, on work of that name.
    Be(&'static str, u64, &'static str),
    /// Send to a task, and wait in a state until it has the message.
    Hand(usize, &'static str, Text),
    /// Send to some tasks, and go on.
    Post(usize, usize, Text),
    /// Wait in a state for a message of a task, or of anyone.
    Take(Option<usize>, &'static str),
}

struct Message {
    number: usize,
    /// The passage on a bus by which it came.
    passage: usize,
    arrives: u64,
    from: usize,
    to: usize,
    text: Text,
}

/// What a task has done.
#[derive(Clone, Copy, Debug)]
pub enum Deed {
    /// It worked.
    Worked(&'static str, u64),
    /// It took what came by a passage, having waited since some time.
    Took { passage: usize, since: u64 },
    /// A message of its own was taken, that came by a passage.
    WasTaken { passage: usize },
}

/// A passage on a bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    pub bus: usize,
    pub from: usize,
    /// When it was ready to go, set out and arrived.
    pub ready: u64,
    pub starts: u64,
    pub arrives: u64,
    /// How much its sender had done before.
    pub after: usize,
    /// Who took it, and as its how manieth deed; of a broadcast nobody asks.
    pub taken: Option<(usize, usize)>,
}

/// All that happened: what each task did, and until when; and all passages in the order in which they had a bus.
#[derive(Clone, Debug, Default)]
pub struct History {
    pub deeds: Vec<Vec<(Deed, u64)>>,
    pub passages: Vec<Passage>,
}

impl History {
    /// Who came before whom: all that may change when times do, beside the times themselves.
    pub fn order(&self) -> impl PartialEq + use<> {
        let taken = |deed: &(Deed, u64)| match deed.0 {
            Deed::Took { passage, .. } => Some(passage),
            _ => None,
        };
        let taken: Vec<Vec<_>> = self.deeds.iter().map(|deeds| deeds.iter().map(taken).collect()).collect();
        let passages: Vec<_> = self.passages.iter().map(|passage| (passage.bus, passage.from, passage.after)).collect();
        (taken, passages)
    }
}

#[derive(Default)]
struct Task {
    todo: VecDeque<Instruction>,
    /// Since when it waits for a message.
    since: Option<u64>,
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
    /// The passage of each message.
    passage_of: Vec<usize>,
    sent: usize,
    bus_free: Vec<u64>,
    history: History,
    now: u64,
    next_item: usize,
    asked: Vec<bool>,
    at_work: usize,
    filed: usize,
}

/// Ticks a farm to its end.
pub fn tick(plan: &Plan) -> Ticked {
    tick_recorded(plan).0
}

/// The same, with all that happened.
pub fn tick_recorded(plan: &Plan) -> (Ticked, History) {
    let tasks = plan.workers + 2;
    let mut farm = Farm {
        plan,
        tasks: (0..tasks).map(|_| Task::default()).collect(),
        under_way: Vec::new(),
        passage_of: Vec::new(),
        sent: 0,
        bus_free: vec![0; plan.buses],
        history: History { deeds: vec![Vec::new(); tasks], passages: Vec::new() },
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
            return (Ticked { time: farm.now, tasks: spent }, farm.history);
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
            let passage = self.passage_of[number];
            self.history.deeds[task].push((Deed::WasTaken { passage }, self.now));
            return true;
        }
        let Some(&instruction) = self.tasks[task].todo.front() else {
            self.tell(task);
            return true;
        };
        match instruction {
            Instruction::Be(state, time, work) => {
                self.history.deeds[task].push((Deed::Worked(work, time), self.now + time));
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
                let since = *self.tasks[task].since.get_or_insert(self.now);
                let is_for = |message: &&Message| {
                    message.to == task && message.arrives <= self.now && from.is_none_or(|from| from == message.from)
                };
                let first = self.under_way.iter().filter(is_for).min_by_key(|m| (m.arrives, m.from, m.number));
                let Some(number) = first.map(|message| message.number) else { return false };
                let place = self.under_way.iter().position(|message| message.number == number).unwrap();
                let message = self.under_way.remove(place);
                let passage = message.passage;
                self.history.passages[passage].taken = Some((task, self.history.deeds[task].len()));
                self.history.deeds[task].push((Deed::Took { passage, since }, self.now));
                self.tasks[task].told = Some(message.text);
                self.tasks[task].since = None;
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
        let starts = self.now.max(self.bus_free[bus]);
        let arrives = starts + time;
        self.bus_free[bus] = arrives;
        let (passage, after) = (self.history.passages.len(), self.history.deeds[from].len());
        self.history.passages.push(Passage { bus, from, ready: self.now, starts, arrives, after, taken: None });
        for to in to {
            self.passage_of.push(passage);
            self.under_way.push(Message { number: self.sent, passage, arrives, from, to, text });
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
            let mut todo = vec![Instruction::Be("computing", plan.fixed, "fixed_ms")];
            match plan.scene_by {
                SceneBy::Copies => (1..tasks).for_each(|task| {
                    todo.push(Instruction::Be("sending", plan.per_cap, "per_cap_ms"));
                    todo.push(Instruction::Hand(task, "waiting answer", Text::Scene));
                }),
                SceneBy::Broadcast => {
                    todo.push(Instruction::Be("sending", plan.per_cap, "per_cap_ms"));
                    todo.push(Instruction::Post(1, tasks, Text::Scene));
                }
            }
            return Some(todo);
        }
        if told == Some(Text::Color) {
            self.filed += 1;
            return Some(vec![Instruction::Be("receiving", plan.color, "color_ms")]);
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
            Instruction::Be("sending", self.plan.message, "message_ms"),
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
        let says = [
            Instruction::Be("sending", plan.message, "message_ms"),
            Instruction::Hand(1, "waiting master", Text::Ready(task)),
        ];
        let asks = [&says[..], &[Instruction::Take(Some(1), "waiting item")]].concat();
        if stage == 0 {
            return Some([&[Instruction::Take(Some(0), "waiting scene")], &asks[..]].concat());
        }
        let mut todo = says.to_vec();
        match told {
            Some(Text::Item(first)) => {
                let step = if plan.hand_out == HandOut::Dealt { plan.workers } else { plan.items.len() };
                for item in plan.items[first..].iter().step_by(step) {
                    todo.push(Instruction::Be("computing", plan.segment, "segment_ms"));
                    for &time in item {
                        todo.push(Instruction::Be("computing", time, "pixel_ms"));
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
