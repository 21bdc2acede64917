//! Nodes with a region each that tick every cycle, for comparison. It shares no code with the engine and the nodes: links are times, queues are
//! lists, and whoever can do something in a cycle does it, the lowest number first.

use std::collections::VecDeque;

use pcs_sim::host::shading::RayKind;
use pcs_sim::machine::Ipsc2;
use pcs_sim::program::cube::{Ends, Flow, Leg, Rules, TaskGraph};

use super::cube_wires::{Ticked, Wires};

/// Why nothing came out.
#[derive(Debug, PartialEq)]
pub enum Stopped {
    /// All wait for each other.
    Stuck,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Text {
    Ray(u32, u32),
    Asks(Place),
    Gives(Place),
    Result(u32),
    Pixels(u32, bool),
    Token(i64, bool),
    Stop,
}

impl Text {
    fn kind(self) -> usize {
        match self {
            Text::Ray(..) => 1,
            Text::Result(_) | Text::Pixels(..) => 2,
            Text::Asks(_) | Text::Gives(_) | Text::Token(..) | Text::Stop => 3,
        }
    }

    fn bytes(self) -> u64 {
        match self {
            Text::Ray(..) => 52,
            Text::Result(_) => 20,
            Text::Pixels(pixels, _) => 8 + 16 * u64::from(pixels),
            Text::Token(..) | Text::Asks(_) => 16,
            Text::Stop | Text::Gives(_) => 4,
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Todo {
    Be(&'static str, u64),
    Send(usize, Text),
    Place(Place),
    /// Looks whether it has a slot for what another node asks for.
    Answer(Place),
    Count(u32),
    PassToken,
    Packets,
    HostCounts(u32),
}

/// A ray whose followers are placed: so many are. A new one is its own first follower.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    ray: u32,
    leg: u32,
    is_new: bool,
    placed: u32,
}

#[derive(Clone, Copy, Debug)]
struct Letter {
    arrives: u64,
    from: usize,
    number: u64,
    text: Text,
}

#[derive(Clone, Default)]
struct Node {
    todo: VecDeque<Todo>,
    busy: u64,
    state: &'static str,
    /// Its states, and until when.
    times: Vec<(String, u64)>,
    /// It waits, since when, and whether it has been so with nothing between.
    waits: bool,
    since: Option<u64>,
    /// It stands before a full queue with that.
    stands: Option<(usize, Place)>,
    granted: bool,
    letters: Vec<Letter>,
    own: Vec<(u32, u32)>,
    received: VecDeque<(u32, u32)>,
    results: VecDeque<u32>,
    pixels: VecDeque<u32>,
    under_way: u32,
    undone: usize,
    packet: u32,
    free: i64,
    in_line: VecDeque<usize>,
    aside: Vec<(u32, u64, usize, Place)>,
    /// What others ask it for, what waits here for a slot, what it was given, and how many it waits for.
    questions: VecDeque<Place>,
    waiting: Vec<(u32, u64, Place)>,
    answers: VecDeque<Place>,
    asked: u32,
    sent: i64,
    black: bool,
    token: Option<(i64, bool)>,
    stop: bool,
    woken: bool,
    longest: usize,
    queued: u64,
    full: u64,
}

struct Cube<'a> {
    machine: &'a Ipsc2,
    graph: &'a TaskGraph,
    rules: Rules,
    node_of: &'a [u16],
    owners: &'a [u16],
    now: u64,
    nodes: Vec<Node>,
    wires: Wires<'a>,
    left: Vec<u32>,
    undone: usize,
    host_left: usize,
    over: bool,
    number: u64,
    age: u64,
    h: u32,
    r: i64,
    out: Ticked,
}

/// Lets them tick until the host has all pixels.
pub fn tick(
    machine: &Ipsc2,
    graph: &TaskGraph,
    node_of: &[u16],
    (owners, order): (&[u16], &[u32]),
    rules: Rules,
) -> Result<Ticked, Stopped> {
    let count = machine.nodes;
    let chain = |ray: usize| u32::from(graph.rays[ray].hop) + legs(graph, ray as u32).len() as u32;
    let h = (0..graph.rays.len()).map(chain).max().unwrap_or(1);
    let turns = graph.rays.iter().map(|ray| u32::from(ray.turns)).max().unwrap_or(0);
    let slots = match rules.flow {
        Flow::Block(slots) | Flow::Classes(slots) => i64::from(slots),
        _ => i64::MAX / 2,
    };
    let mut nodes = vec![Node { free: slots, ..Node::default() }; count + 1];
    for &tree in order {
        let node = &mut nodes[owners[tree as usize] as usize];
        node.pixels.push_back(tree);
        node.undone += 1;
    }
    if rules.ends == Ends::Token {
        nodes[0].token = Some((0, false));
        nodes[0].black = true;
    }
    let mut cube = Cube {
        machine,
        graph,
        rules,
        node_of,
        owners,
        now: 0,
        nodes,
        wires: Wires::new(machine),
        left: (0..graph.trees.len())
            .map(|tree| graph.rays.iter().filter(|ray| ray.tree == tree as u32).count() as u32)
            .collect(),
        undone: graph.trees.len(),
        host_left: graph.trees.len() + if rules.ends == Ends::Token { count } else { 0 },
        over: false,
        number: 0,
        age: 0,
        h,
        r: i64::from((turns + 1) * h) - 1,
        out: Ticked::default(),
    };
    cube.run()
}

fn legs(graph: &TaskGraph, ray: u32) -> Vec<Leg> {
    let first = graph.rays[ray as usize].first_leg as usize;
    let end = graph.rays.get(ray as usize + 1).map_or(graph.legs.len(), |next| next.first_leg as usize);
    graph.legs[first..end].to_vec()
}

impl Cube<'_> {
    fn run(&mut self) -> Result<Ticked, Stopped> {
        loop {
            while let Some(task) = (0..self.nodes.len()).find(|&task| self.can_act(task)) {
                self.act(task);
                if self.over {
                    return Ok(self.ended());
                }
            }
            let is_busy = self
                .nodes
                .iter()
                .any(|node| node.busy > 0 || node.letters.iter().any(|letter| letter.arrives > self.now));
            if !is_busy {
                return Err(Stopped::Stuck);
            }
            for node in &mut self.nodes {
                node.queued += (node.own.len() + node.received.len()) as u64;
                node.full += u64::from(match self.rules.flow {
                    Flow::Block(_) => node.free == 0,
                    Flow::Classes(_) => node.free <= self.r,
                    Flow::Unlimited | Flow::Window(_) => false,
                });
                match node.times.last_mut() {
                    Some((state, until)) if state == node.state => *until += 1,
                    _ => node.times.push((node.state.to_owned(), self.now + 1)),
                }
                node.busy = node.busy.saturating_sub(1);
            }
            self.now += 1;
        }
    }

    fn can_act(&self, task: usize) -> bool {
        let node = &self.nodes[task];
        if node.busy > 0 {
            return false;
        }
        if node.stands.is_some() {
            return node.granted;
        }
        !node.waits || node.woken || node.letters.iter().any(|letter| letter.arrives <= self.now)
    }

    /// A task does what it can until that takes time.
    fn act(&mut self, task: usize) {
        let node = &mut self.nodes[task];
        node.waits = false;
        node.woken = false;
        if let Some((_, place)) = node.stands.take() {
            node.todo.push_front(Todo::Place(place));
        }
        loop {
            if self.nodes[task].busy > 0 || self.nodes[task].waits || self.nodes[task].stands.is_some() || self.over {
                return;
            }
            match self.nodes[task].todo.pop_front() {
                Some(todo) => self.do_it(task, todo),
                None if task == self.machine.nodes => self.host(),
                None => self.choose(task),
            }
        }
    }

    fn be(&mut self, task: usize, state: &'static str, cycles: u64) {
        if cycles > 0 {
            self.nodes[task].busy = cycles;
            self.nodes[task].state = state;
        }
    }

    fn do_it(&mut self, task: usize, todo: Todo) {
        match todo {
            Todo::Be(state, cycles) => self.be(task, state, cycles),
            Todo::Send(to, text) => self.carry(task, to, text),
            Todo::Place(place) => self.place(task, place),
            Todo::Answer(place) => {
                let (ray, leg) = self.follower(place).unwrap();
                self.age += 1;
                let rank = self.rank(ray, leg);
                self.nodes[task].waiting.push((rank, self.age, place));
                self.answer(task);
            }
            Todo::Count(tree) => self.count(task, tree),
            Todo::PassToken => self.pass(task),
            Todo::Packets => {
                let mut pixels = std::mem::take(&mut self.nodes[task].packet);
                loop {
                    let some = pixels.min(64);
                    pixels -= some;
                    self.send(task, self.machine.nodes, Text::Pixels(some, pixels == 0));
                    if pixels == 0 {
                        break;
                    }
                }
            }
            Todo::HostCounts(pixels) => {
                self.host_left -= pixels as usize;
                if self.host_left == 0 {
                    self.over = true;
                    if self.rules.ends == Ends::Credit {
                        self.out.told_at = self.now;
                    }
                }
            }
        }
    }

    /// Puts the work on a message, and its way, on the list.
    fn send(&mut self, task: usize, to: usize, text: Text) {
        let time = self.wires.processor(text.bytes());
        let hops = self.wires.way(task, to).len() as u64;
        let counts = &mut self.out.messages[text.kind()];
        counts[0] += 1;
        counts[2] += text.bytes();
        counts[3] += hops;
        counts[4] += time;
        if matches!(text, Text::Ray(..) | Text::Result(_)) {
            self.nodes[task].sent += 1;
        }
        let at = self.nodes[task]
            .todo
            .iter()
            .take_while(|todo| matches!(todo, Todo::Be("sending", _) | Todo::Send(..)))
            .count();
        self.nodes[task].todo.insert(at, Todo::Be("sending", time));
        self.nodes[task].todo.insert(at + 1, Todo::Send(to, text));
    }

    fn took(&mut self, text: Text) -> u64 {
        let time = self.wires.processor(text.bytes());
        let counts = &mut self.out.messages[text.kind()];
        counts[1] += 1;
        counts[4] += time;
        time
    }

    fn carry(&mut self, from: usize, to: usize, text: Text) {
        let arrives = self.wires.carry(from, to, text.bytes(), self.now);
        self.number += 1;
        let letter = Letter { arrives, from, number: self.number, text };
        self.nodes[to].letters.push(letter);
        self.nodes[to].letters.sort_by_key(|letter| (letter.arrives, letter.from, letter.number));
    }

    fn host(&mut self) {
        let host = self.machine.nodes;
        let now = self.now;
        if self.nodes[host].letters.first().is_some_and(|letter| letter.arrives <= now) {
            let letter = self.nodes[host].letters.remove(0);
            let Text::Pixels(pixels, last) = letter.text else { panic!("the host takes pixels") };
            let time = self.took(letter.text);
            self.nodes[host].todo.push_back(Todo::Be("receiving", time));
            self.nodes[host].todo.push_back(Todo::HostCounts(pixels + u32::from(last)));
        } else {
            self.nodes[host].waits = true;
            self.nodes[host].state = "waiting";
        }
    }

    fn read_letters(&mut self, task: usize) {
        let now = self.now;
        let node = &mut self.nodes[task];
        while node.letters.first().is_some_and(|letter| letter.arrives <= now) {
            let letter = node.letters.remove(0);
            if matches!(letter.text, Text::Ray(..) | Text::Result(_)) {
                node.sent -= 1;
                node.black = true;
            }
            match letter.text {
                Text::Ray(ray, leg) => node.received.push_back((ray, leg)),
                Text::Result(tree) => node.results.push_back(tree),
                Text::Asks(place) => node.questions.push_back(place),
                Text::Gives(place) => node.answers.push_back(place),
                Text::Token(count, black) => node.token = Some((count, black)),
                Text::Stop => node.stop = true,
                Text::Pixels(..) => panic!("a node takes no pixels"),
            }
            node.longest = node.longest.max(node.own.len() + node.received.len());
        }
    }

    fn choose(&mut self, task: usize) {
        self.read_letters(task);
        let since = self.nodes[task].since.take();
        if let Some(tree) = self.nodes[task].results.pop_front() {
            let time = self.took(Text::Result(tree)) + self.machine.costs.result.0;
            return self.nodes[task].todo.extend([Todo::Be("receiving", time), Todo::Count(tree)]);
        }
        if let Some(place) = self.nodes[task].questions.pop_front() {
            let time = self.took(Text::Asks(place));
            return self.nodes[task].todo.extend([Todo::Be("receiving", time), Todo::Answer(place)]);
        }
        if let Some(place) = self.nodes[task].answers.pop_front() {
            let time = self.took(Text::Gives(place));
            let node = &mut self.nodes[task];
            node.asked -= 1;
            node.granted = true;
            return node.todo.extend([Todo::Be("receiving", time), Todo::Place(place)]);
        }
        let can = |(rank, _, to, _): &&(u32, u64, usize, Place)| self.nodes[*to].free > self.r - i64::from(*rank);
        let best = self.nodes[task]
            .aside
            .iter()
            .filter(can)
            .max_by_key(|(rank, age, ..)| (*rank, std::cmp::Reverse(*age)))
            .map(|aside| aside.1);
        if let Some(age) = best {
            let at = self.nodes[task].aside.iter().position(|aside| aside.1 == age).unwrap();
            let (.., place) = self.nodes[task].aside.remove(at);
            return self.place(task, place);
        }
        let mut ways: [fn(&mut Self, usize) -> bool; 2] = [Self::work, Self::begin];
        if self.rules.pixels_first {
            ways.reverse();
        }
        if ways.iter().any(|way| way(self, task)) {
            return;
        }
        if std::mem::take(&mut self.nodes[task].stop) {
            let time = self.took(Text::Stop);
            return self.nodes[task].todo.extend([Todo::Be("receiving", time), Todo::Packets]);
        }
        let node = &self.nodes[task];
        if let Some((count, black)) = node.token
            && node.pixels.is_empty()
            && node.aside.is_empty()
            && node.asked == 0
        {
            let is_first = task == 0 && self.out.probes == 0;
            let time = if is_first { 0 } else { self.took(Text::Token(count, black)).max(1) };
            return self.nodes[task].todo.extend([Todo::Be("receiving", time), Todo::PassToken]);
        }
        let now = self.now;
        let node = &mut self.nodes[task];
        node.since = since.or(Some(now));
        node.waits = true;
        node.state = if node.aside.is_empty() && node.asked == 0 { "waiting" } else { "blocked" };
    }

    fn work(&mut self, task: usize) -> bool {
        let mut receiving = 0;
        let (ray, leg) = match self.nodes[task].own.pop() {
            Some(own) => own,
            None => {
                let Some(ray) = self.nodes[task].received.pop_front() else { return false };
                receiving = self.took(Text::Ray(ray.0, ray.1));
                if let Flow::Block(_) = self.rules.flow {
                    match self.nodes[task].in_line.pop_front() {
                        Some(first) => self.nodes[first].granted = true,
                        None => self.nodes[task].free += 1,
                    }
                }
                ray
            }
        };
        let times = &self.machine.times;
        let counts = self.graph.legs[leg as usize];
        let task_of = &self.graph.rays[ray as usize];
        let is_last = leg + 1 == task_of.first_leg + legs(self.graph, ray).len() as u32;
        let started = |count: u32, start: u64, each: u64| if count > 0 { start + u64::from(count) * each } else { 0 };
        let grid = times.grid.start.0 + u64::from(counts.voxels) * times.grid.each.0;
        let slabs = started(counts.slab_tests, times.slabs.start.0, times.slabs.each.0);
        let tests = started(counts.intersection_tests, times.intersection.start.0, times.intersection.each.0);
        let shading = if is_last && task_of.shaded { times.host.hit.0 } else { 0 };
        self.nodes[task].todo.extend([
            Todo::Be("receiving", receiving),
            Todo::Be("grid", grid),
            Todo::Be("slabs", slabs),
            Todo::Be("intersection", tests),
            Todo::Be("shading", shading),
            Todo::Place(Place { ray, leg, is_new: false, placed: 0 }),
        ]);
        true
    }

    fn begin(&mut self, task: usize) -> bool {
        let node = &mut self.nodes[task];
        let may = match self.rules.flow {
            Flow::Window(window) => node.under_way < window,
            Flow::Classes(_) => node.free > self.r,
            _ => true,
        };
        if !may || node.pixels.is_empty() {
            return false;
        }
        let tree = node.pixels.pop_front().unwrap();
        node.under_way += 1;
        let ray = self.graph.trees[tree as usize];
        let leg = self.graph.rays[ray as usize].first_leg;
        let place = Place { ray, leg, is_new: true, placed: 0 };
        node.todo.extend([Todo::Be("pixels", self.machine.costs.pixel.0), Todo::Place(place)]);
        true
    }

    fn follower(&self, place: Place) -> Option<(u32, u32)> {
        let ray = &self.graph.rays[place.ray as usize];
        let last = ray.first_leg + legs(self.graph, place.ray).len() as u32 - 1;
        if place.is_new {
            return (place.placed == 0).then_some((place.ray, place.leg));
        }
        if place.leg < last {
            return (place.placed == 0).then_some((place.ray, place.leg + 1));
        }
        (place.placed < ray.children.1).then(|| {
            let child = ray.children.0 + place.placed;
            (child, self.graph.rays[child as usize].first_leg)
        })
    }

    fn place(&mut self, task: usize, mut place: Place) {
        while let Some((ray, leg)) = self.follower(place) {
            let to = self.node_of[self.graph.legs[leg as usize].region as usize] as usize;
            let kind = |ray: u32| self.graph.rays[ray as usize].kind;
            if to == task && ray != place.ray && kind(ray) == RayKind::Shadow && kind(place.ray) == RayKind::Shadow {
                let node = &mut self.nodes[task];
                node.own.push((ray, leg));
                node.longest = node.longest.max(node.own.len() + node.received.len());
                return self.end(task, place);
            }
            let rank = self.rank(ray, leg);
            let granted = std::mem::take(&mut self.nodes[task].granted);
            match self.rules.flow {
                Flow::Block(_) if to != task && !granted && self.nodes[to].free == 0 => {
                    self.nodes[to].in_line.push_back(task);
                    self.nodes[task].stands = Some((to, place));
                    self.nodes[task].state = "blocked";
                    return;
                }
                Flow::Classes(_) if to != task && self.rules.asks_for_slots && !granted => {
                    self.nodes[task].asked += 1;
                    return self.send(task, to, Text::Asks(place));
                }
                Flow::Classes(_) if !granted && self.nodes[to].free <= self.r - i64::from(rank) => {
                    self.age += 1;
                    self.nodes[task].aside.push((rank, self.age, to, place));
                    return;
                }
                _ => {}
            }
            place.placed += 1;
            let takes_slot = match self.rules.flow {
                Flow::Block(_) => to != task && !granted,
                Flow::Classes(_) => !granted,
                _ => false,
            };
            self.nodes[to].free -= i64::from(takes_slot);
            if to == task {
                self.nodes[task].own.push((ray, leg));
                let node = &mut self.nodes[task];
                node.longest = node.longest.max(node.own.len() + node.received.len());
                continue;
            }
            self.nodes[task].todo.push_front(Todo::Place(place));
            return self.send(task, to, Text::Ray(ray, leg));
        }
        if !place.is_new && matches!(self.rules.flow, Flow::Classes(_)) {
            self.nodes[task].free += 1;
            self.answer(task);
            for node in &mut self.nodes {
                node.woken |= node.waits && node.aside.iter().any(|aside| aside.2 == task);
            }
        }
        self.end(task, place);
    }

    fn rank(&self, ray: u32, leg: u32) -> u32 {
        let task = &self.graph.rays[ray as usize];
        u32::from(task.turns) * self.h + u32::from(task.hop) + leg - task.first_leg
    }

    /// Gives slots to those that wait, the highest rank first, while there are any for it.
    fn answer(&mut self, task: usize) {
        loop {
            let best = self.nodes[task].waiting.iter().max_by_key(|(rank, age, _)| (*rank, std::cmp::Reverse(*age)));
            let Some(&(rank, age, place)) = best else { return };
            if self.nodes[task].free <= self.r - i64::from(rank) {
                return;
            }
            self.nodes[task].waiting.retain(|waiting| waiting.1 != age);
            self.nodes[task].free -= 1;
            let region = self.graph.legs[place.leg as usize].region;
            let tree = self.graph.rays[place.ray as usize].tree;
            let to = if place.is_new { self.owners[tree as usize] } else { self.node_of[region as usize] };
            self.send(task, to as usize, Text::Gives(place));
        }
    }

    fn end(&mut self, task: usize, place: Place) {
        let ray = &self.graph.rays[place.ray as usize];
        let last = ray.first_leg + legs(self.graph, place.ray).len() as u32 - 1;
        if place.is_new || place.leg < last {
            return;
        }
        let owner = self.owners[ray.tree as usize] as usize;
        if owner == task { self.count(task, ray.tree) } else { self.send(task, owner, Text::Result(ray.tree)) }
    }

    fn count(&mut self, task: usize, tree: u32) {
        self.left[tree as usize] -= 1;
        if self.left[tree as usize] > 0 {
            return;
        }
        self.undone -= 1;
        if self.undone == 0 {
            self.out.true_end = self.now;
        }
        let node = &mut self.nodes[task];
        node.under_way -= 1;
        node.undone -= 1;
        node.packet += 1;
        if self.rules.ends == Ends::Credit && (node.packet == 64 || node.undone == 0) {
            let pixels = std::mem::take(&mut node.packet);
            self.send(task, self.machine.nodes, Text::Pixels(pixels, false));
        }
    }

    fn pass(&mut self, task: usize) {
        let (count, black) = self.nodes[task].token.take().unwrap();
        let nodes = self.machine.nodes;
        let ring: Vec<usize> = (0..nodes.next_power_of_two()).map(|n| n ^ (n >> 1)).filter(|&n| n < nodes).collect();
        let next = ring[(ring.iter().position(|&node| node == task).unwrap() + 1) % nodes];
        let node = &mut self.nodes[task];
        if task > 0 {
            let text = Text::Token(count + node.sent, black || node.black);
            node.black = false;
            return self.send(task, next, text);
        }
        if nodes == 1 || (!black && !node.black && count + node.sent == 0) {
            self.out.told_at = self.now;
            for other in 1..nodes {
                self.send(0, other, Text::Stop);
            }
            self.nodes[0].todo.push_back(Todo::Packets);
            return;
        }
        node.black = false;
        self.out.probes += 1;
        self.send(0, next, Text::Token(0, false));
    }

    fn ended(&mut self) -> Ticked {
        let host = self.machine.nodes;
        let mut out = std::mem::take(&mut self.out);
        out.cycles = self.now;
        for node in &mut self.nodes[..host] {
            // What it waited for last did not come any more.
            if let Some(since) = node.since.filter(|since| *since < self.now) {
                node.times.retain(|(_, until)| *until <= since);
                let until = node.times.last().map_or(0, |last| last.1);
                node.times.extend((until < since).then(|| ("waiting".to_owned(), since)));
                node.times.push(("idle".to_owned(), self.now));
            }
        }
        out.longest_queues = self.nodes[..host].iter().map(|node| node.longest).collect();
        out.queues = self.nodes[..host].iter().map(|node| (node.queued, node.full)).collect();
        out.tasks = self.nodes.iter().map(|node| node.times.clone()).collect();
        out.links = self.wires.taken();
        out
    }
}
