//! Nodes with a shared memory that tick every cycle, for comparison. It shares no code with the engine and the nodes; caches are lists in
//! the order in which pages were read.

use std::collections::VecDeque;

use pcs_sim::machine::Ipsc2;
use pcs_sim::program::cube::{Dealt, TaskGraph};

use super::cube_wires::{Ticked, Wires};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Text {
    Wants(usize),
    Page,
    Pixels(u32),
    Asks(usize),
    Tile(Option<usize>),
}

#[derive(Clone, Copy, Debug)]
enum Todo {
    Be(&'static str, u64),
    Send(usize, Text),
    /// Makes good what it has served, before it begins the ray.
    Ray(u32),
    /// Reads the ray's pages from the n-th on.
    Read(u32, usize),
    /// From here on it waits, and serves for nothing.
    ServesForNothing,
    Work(u32),
    DoneWithTree,
    Takes(Text),
    Serves(usize),
    Await,
    End,
}

#[derive(Clone, Default)]
struct Task {
    todo: VecDeque<Todo>,
    busy: u64,
    state: &'static str,
    times: Vec<(String, u64)>,
    waits: bool,
    has_ended: bool,
    letters: Vec<(u64, usize, u64, Text)>,
    pixels: VecDeque<u32>,
    packet: u32,
    /// Its cache, what was read longest ago first.
    cache: Vec<u32>,
    owes: u64,
    serves_for_nothing: bool,
    fetched: u64,
}

struct Memory<'a> {
    machine: &'a Ipsc2,
    graph: &'a TaskGraph,
    wires: Wires<'a>,
    tasks: Vec<Task>,
    tiles: Option<Vec<Vec<u32>>>,
    given: usize,
    room: usize,
    trees: usize,
    untold: usize,
    number: u64,
    now: u64,
    out: Ticked,
}

/// Lets them tick until the host has all pixels and all nodes know. Also tells how many pages each node has fetched.
pub fn tick(machine: &Ipsc2, graph: &TaskGraph, dealt: Dealt) -> (Ticked, Vec<u64>) {
    let count = machine.nodes;
    let uses = graph.pages.as_ref().unwrap();
    let home = (uses.pages as u64).div_ceil(count as u64) * uses.page_bytes as u64;
    let room = machine.memory_bytes.saturating_sub(home) / uses.page_bytes as u64;
    let mut tasks = vec![Task::default(); 2 * count + 1];
    let tiles = match dealt {
        Dealt::Before(own) => {
            own.into_iter().zip(&mut tasks).for_each(|(pixels, task)| task.pixels = pixels.into());
            None
        }
        Dealt::AsAsked(tiles) => Some(tiles),
    };
    let untold = if tiles.is_some() { count } else { 0 };
    let out = Ticked { longest_queues: vec![0; count], queues: vec![(0, 0); count], ..Ticked::default() };
    let (wires, trees) = (Wires::new(machine), graph.trees.len());
    let room = (room as usize).clamp(1, uses.pages as usize);
    let mut memory =
        Memory { machine, graph, wires, tasks, tiles, given: 0, room, trees, untold, number: 0, now: 0, out };
    memory.run()
}

impl Memory<'_> {
    fn host(&self) -> usize {
        self.machine.nodes
    }

    fn run(&mut self) -> (Ticked, Vec<u64>) {
        loop {
            while let Some(task) = (0..self.tasks.len()).find(|&task| self.can_act(task)) {
                self.act(task);
                if self.tasks[..=self.host()].iter().all(|task| task.has_ended) {
                    return self.ended();
                }
            }
            for task in &mut self.tasks {
                let state = if task.has_ended { "idle" } else { task.state };
                match task.times.last_mut() {
                    Some((known, until)) if known == state => *until += 1,
                    _ => task.times.push((state.to_owned(), self.now + 1)),
                }
                task.busy = task.busy.saturating_sub(1);
            }
            self.now += 1;
            assert!(self.now < 10_000_000, "it does not end");
        }
    }

    fn can_act(&self, task: usize) -> bool {
        let task = &self.tasks[task];
        let has_mail = task.letters.first().is_some_and(|letter| letter.0 <= self.now);
        !task.has_ended && task.busy == 0 && (!task.waits || has_mail)
    }

    fn act(&mut self, task: usize) {
        self.tasks[task].waits = false;
        while self.tasks[task].busy == 0 && !self.tasks[task].waits && !self.tasks[task].has_ended {
            match self.tasks[task].todo.pop_front() {
                Some(todo) => self.do_it(task, todo),
                None if task < self.host() => self.begin(task),
                None => self.stand_by(task),
            }
        }
    }

    /// The host and the helpers take what comes; the host until it has all pixels and has told all who ask.
    fn stand_by(&mut self, task: usize) {
        if task == self.host() && self.trees == 0 && self.untold == 0 {
            self.tasks[task].has_ended = true;
            return;
        }
        self.tasks[task].todo.push_back(Todo::Await);
    }

    /// A node goes to its next pixel, if it has one or gets one.
    fn begin(&mut self, task: usize) {
        let host = self.host();
        let node = &mut self.tasks[task];
        if let Some(tree) = node.pixels.pop_front() {
            node.todo.push_back(Todo::Be("pixels", self.machine.costs.pixel.0));
            node.todo.extend(self.graph.tree(tree as usize).map(Todo::Ray));
            node.todo.push_back(Todo::DoneWithTree);
        } else if self.tiles.is_some() {
            node.serves_for_nothing = true;
            self.send(task, host, Text::Asks(task));
            self.tasks[task].todo.push_back(Todo::Await);
        } else {
            node.todo.push_back(Todo::End);
        }
    }

    fn do_it(&mut self, task: usize, todo: Todo) {
        let now = self.now;
        let (machine, graph) = (self.machine, self.graph);
        match todo {
            Todo::Be(state, cycles) => {
                let task = &mut self.tasks[task];
                (task.busy, task.state) = (cycles, if cycles > 0 { state } else { task.state });
            }
            Todo::Send(to, text) => {
                let on = |task: usize| if task > machine.nodes { task - machine.nodes - 1 } else { task };
                let arrives = self.wires.carry(on(task), on(to), self.bytes(text), now);
                self.number += 1;
                self.tasks[to].letters.push((arrives, task, self.number, text));
                self.tasks[to].letters.sort_by_key(|letter| (letter.0, letter.1, letter.2));
            }
            Todo::Await => {
                if self.tasks[task].letters.first().is_some_and(|letter| letter.0 <= now) {
                    let text = self.tasks[task].letters.remove(0).3;
                    self.receive(task, text);
                } else {
                    let is_page = matches!(self.tasks[task].todo.front(), Some(Todo::Read(..)));
                    let node = &mut self.tasks[task];
                    node.waits = true;
                    node.state = if is_page { "waiting page" } else { "waiting" };
                    node.todo.push_front(Todo::Await);
                }
            }
            Todo::Ray(ray) => {
                let node = &mut self.tasks[task];
                let owes = std::mem::take(&mut node.owes);
                node.todo.push_front(Todo::Read(ray, 0));
                node.todo.push_front(Todo::Be("serving", owes));
            }
            Todo::Read(ray, first) => self.read(task, ray, first),
            Todo::Work(ray) => {
                let legs = graph.legs_of(ray);
                let sum = |count: fn(&pcs_sim::program::cube::Leg) -> u32| {
                    legs.iter().map(|leg| u64::from(count(leg))).sum::<u64>()
                };
                let (voxels, slabs, tests) =
                    (sum(|leg| leg.voxels), sum(|leg| leg.slab_tests), sum(|leg| leg.intersection_tests));
                let times = &machine.times;
                let started = |count: u64, start: u64, each: u64| if count > 0 { start + count * each } else { 0 };
                let shading = if graph.rays[ray as usize].shaded { times.host.hit.0 } else { 0 };
                let all = [
                    Todo::Be("grid", times.grid.start.0 + voxels * times.grid.each.0),
                    Todo::Be("slabs", started(slabs, times.slabs.start.0, times.slabs.each.0)),
                    Todo::Be("intersection", started(tests, times.intersection.start.0, times.intersection.each.0)),
                    Todo::Be("shading", shading),
                ];
                all.into_iter().rev().for_each(|todo| self.tasks[task].todo.push_front(todo));
            }
            Todo::DoneWithTree => {
                self.out.true_end = now;
                let node = &mut self.tasks[task];
                node.packet += 1;
                if node.packet == 64 || node.pixels.is_empty() {
                    let count = std::mem::take(&mut node.packet);
                    self.send(task, self.host(), Text::Pixels(count));
                }
            }
            Todo::ServesForNothing => self.tasks[task].serves_for_nothing = true,
            Todo::Takes(text) => self.has_taken(task, text),
            Todo::Serves(asker) => {
                let node = task - self.host() - 1;
                if !self.tasks[node].serves_for_nothing {
                    self.tasks[node].owes += machine.costs.serve.0;
                }
                self.out.messages[3][1] += 1;
                let hops = self.wires.way(node, asker).len() as u64;
                let bytes = self.bytes(Text::Page);
                let counts = &mut self.out.messages[0];
                (counts[0], counts[2], counts[3]) = (counts[0] + 1, counts[2] + bytes, counts[3] + hops);
                self.tasks[task].todo.push_front(Todo::Send(asker, Text::Page));
            }
            Todo::End => {
                let node = &mut self.tasks[task];
                (node.has_ended, node.serves_for_nothing) = (true, true);
            }
        }
    }

    /// Looks a ray's pages up, until one is missing: that is asked for.
    fn read(&mut self, task: usize, ray: u32, first: usize) {
        let count = self.host();
        let pages = self.graph.pages.as_ref().unwrap().of_ray(ray);
        let mut lookups = 0;
        for (at, &(page, reads)) in pages.iter().enumerate().skip(first) {
            let home = page as usize % count;
            if home == task {
                continue;
            }
            lookups += u64::from(reads) * self.machine.costs.lookup.0;
            let node = &mut self.tasks[task];
            let known = node.cache.iter().position(|&known| known == page);
            if let Some(place) = known {
                node.cache.remove(place);
            }
            node.cache.push(page);
            if node.cache.len() > self.room {
                node.cache.remove(0);
            }
            if known.is_none() {
                node.fetched += 1;
                let helper = count + 1 + home;
                let time = self.wires.processor(self.bytes(Text::Wants(task)));
                self.counted(task, helper, Text::Wants(task), time);
                let all = [
                    Todo::Be("lookup", lookups),
                    Todo::ServesForNothing,
                    Todo::Be("sending", time),
                    Todo::Send(helper, Text::Wants(task)),
                    Todo::Await,
                    Todo::Read(ray, at + 1),
                ];
                all.into_iter().rev().for_each(|todo| self.tasks[task].todo.push_front(todo));
                return;
            }
        }
        self.tasks[task].todo.push_front(Todo::Work(ray));
        self.tasks[task].todo.push_front(Todo::Be("lookup", lookups));
    }

    fn receive(&mut self, task: usize, text: Text) {
        let host = self.host();
        if task > host {
            let Text::Wants(asker) = text else { panic!("a helper is asked for pages") };
            self.tasks[task].todo.push_back(Todo::Be("serving", self.machine.costs.serve.0));
            self.tasks[task].todo.push_back(Todo::Serves(asker));
            return;
        }
        if text == Text::Page {
            self.tasks[task].serves_for_nothing = false;
        }
        let time = self.wires.processor(self.bytes(text));
        let counts = &mut self.out.messages[kind(text)];
        (counts[1], counts[4]) = (counts[1] + 1, counts[4] + time);
        self.tasks[task].todo.push_front(Todo::Takes(text));
        self.tasks[task].todo.push_front(Todo::Be("receiving", time));
    }

    fn has_taken(&mut self, task: usize, text: Text) {
        match text {
            Text::Pixels(count) => {
                self.trees -= count as usize;
                if self.trees == 0 {
                    self.out.told_at = self.now;
                }
            }
            Text::Asks(node) => {
                let is_left = self.given < self.tiles.as_ref().unwrap().len();
                let tile = is_left.then_some(self.given);
                self.given += usize::from(is_left);
                self.untold -= usize::from(!is_left);
                self.send(task, node, Text::Tile(tile));
            }
            Text::Tile(None) => self.tasks[task].todo.push_back(Todo::End),
            Text::Tile(Some(tile)) => {
                let node = &mut self.tasks[task];
                node.pixels = self.tiles.as_ref().unwrap()[tile].clone().into();
                node.serves_for_nothing = false;
            }
            Text::Page | Text::Wants(_) => {}
        }
    }

    fn bytes(&self, text: Text) -> u64 {
        match text {
            Text::Wants(_) | Text::Asks(_) => 16,
            Text::Page => 8 + u64::from(self.graph.pages.as_ref().unwrap().page_bytes),
            Text::Pixels(count) => 8 + 16 * u64::from(count),
            Text::Tile(_) => 4,
        }
    }

    fn counted(&mut self, task: usize, to: usize, text: Text, time: u64) {
        let host = self.host();
        let on = |task: usize| if task > host { task - host - 1 } else { task };
        let (hops, bytes) = (self.wires.way(on(task), on(to)).len() as u64, self.bytes(text));
        let counts = &mut self.out.messages[kind(text)];
        for (count, more) in [(0, 1), (2, bytes), (3, hops), (4, time)] {
            counts[count] += more;
        }
    }

    fn send(&mut self, task: usize, to: usize, text: Text) {
        let time = self.wires.processor(self.bytes(text));
        self.counted(task, to, text, time);
        self.tasks[task].todo.push_front(Todo::Send(to, text));
        self.tasks[task].todo.push_front(Todo::Be("sending", time));
    }

    fn ended(&mut self) -> (Ticked, Vec<u64>) {
        let host = self.host();
        let mut out = std::mem::take(&mut self.out);
        out.cycles = self.now;
        out.tasks = self.tasks[..=host].iter().map(|task| task.times.clone()).collect();
        out.links = self.wires.taken();
        (out, self.tasks[..host].iter().map(|task| task.fetched).collect())
    }
}

fn kind(text: Text) -> usize {
    match text {
        Text::Page => 0,
        Text::Pixels(_) => 2,
        Text::Wants(_) | Text::Asks(_) | Text::Tile(_) => 3,
    }
}
