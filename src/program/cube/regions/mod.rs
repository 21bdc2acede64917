//! What nodes do that have a region each and send rays to each other (RR-0992, §4.1).
//!
//! A node does one thing after the other. When it is free, it takes the first that there is: a result that has come; what others ask or
//! answer about slots; what was put aside and can go on; a ray, its own children first, the last made before the others, then those that
//! have come, in the order in which they did; a new pixel. Working on a ray is one leg: its way through the region. Then what follows from
//! it is placed, one after the other, here or on other nodes; a ray that has ended makes a result for the node that its pixel belongs to,
//! which adds results up and sends pixels that are done to the host.

mod ending;
mod itinerary;
mod node;
mod placing;

use itinerary::Itinerary;
pub use itinerary::Visit;
use node::{Next, Node};

use super::causes::{self, PIXEL, takes};
use super::graph::TaskGraph;
use super::mapping::gray_order;
use super::messages::{MessageKind, RESULT_BYTES, WORD_BYTES, packet_bytes};
use super::pool::{Aside, Flow, Placing, Slots};
use super::seen::{NodeSeen, Seen};
use super::states::{BLOCKED, GRID, IDLE, INTERSECTION, PIXELS, RECEIVING, SENDING, SHADING, SLABS, WAITING, topology};
use super::token::Token;
use crate::machine::events::{Act, Cube, Delivery, Explanation, MOST_SPELLS, Message, Queues, Sender, Turn, Work};
use crate::machine::{Cycles, Ipsc2};
use crate::measure::{Actor, FifoInfo, StateId, Topology};
use crate::seam::Unit;

/// How it is found out that all is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Each ray has a share of its pixel's credit, which its result brings back (Mattern 1987).
    Credit,
    /// A token goes round.
    Token,
}

/// What nodes go by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rules {
    /// How rays find room in queues.
    pub flow: Flow,
    /// How it is found out that all is done.
    pub ends: Ends,
    /// Whether a node asks another for a slot by rank before each ray, and waits until that answers. Else it knows what is free.
    pub asks_for_slots: bool,
    /// Whether a node begins all its pixels before it works on rays of others.
    pub pixels_first: bool,
}

/// What is in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// A ray.
    Ray(Visit),
    /// A node asks for a slot for what follows next from a ray.
    Asks(Placing),
    /// It has one.
    Gives(Placing),
    /// A result for that tree's pixel.
    Result(u32),
    /// So many pixels that are done, and whether they are the last of a node that has been told to stop.
    Pixels(u32, bool),
    /// The token.
    Token(Token),
    /// All is done.
    Stop,
}

/// Nodes at work.
#[derive(Clone, Debug)]
pub struct RegionNodes<'a> {
    machine: &'a Ipsc2,
    graph: &'a TaskGraph,
    cube: Cube,
    rules: Rules,
    itinerary: Itinerary,
    ray_bytes: u64,
    nodes: Vec<Node>,
    /// For each node, how many of its slots are free.
    free: Vec<u32>,
    /// For each tree, how many results are still to come.
    left: Vec<u32>,
    /// Trees whose results have not all come.
    trees_left: usize,
    /// Pixels that the host has not got, and nodes that have not stopped, where they are told to.
    host_waits: usize,
    /// The host takes a packet with so many of them.
    host_takes: u32,
    /// R, the highest rank of any ray.
    highest_rank: u32,
    /// The order of nodes in which the token goes round.
    ring: Vec<u16>,
    ages: u64,
    /// What time it is.
    now: u64,
    /// Nodes that have nothing else to do than to wait for a slot somewhere, a bit each.
    blocked: u128,
    over: bool,
    /// Whether it is told what legs consist of.
    explains: bool,
    /// What is counted.
    pub seen: Seen,
    /// The rays that wait on each node, its own children too; full is one without a slot for a new ray: of a pixel by rank, of another
    /// node under blocking.
    pub queues: Queues,
}

impl<'a> RegionNodes<'a> {
    /// Nodes at the start: each region of a graph on the node that `node_of` tells, each tree begun by the node in `owners`, which has
    /// them in the order in which `order` lists them. None if there are more rays and legs than can be counted.
    pub fn new(
        machine: &'a Ipsc2,
        graph: &'a TaskGraph,
        node_of: &[u16],
        (owners, order): (&[u16], &[u32]),
        rules: Rules,
    ) -> Option<RegionNodes<'a>> {
        let count = machine.nodes;
        let (most_regions, highest_rank) = ranks(graph);
        let free = match rules.flow {
            Flow::Block(slots) | Flow::Classes(slots) => slots,
            Flow::Unlimited | Flow::Window(_) => u32::MAX,
        };
        let mut nodes: Vec<Node> = (0..count).map(|_| Node::new(Slots::new(count))).collect();
        let order = by_owner(order, owners, &mut nodes);
        if rules.ends == Ends::Token {
            nodes[0].account.is_black = true;
            nodes[0].account.token = Some(Token::default());
        }
        let pixels = |node: &Node| NodeSeen { pixels: node.pixels.len(), ..NodeSeen::default() };
        let seen = Seen {
            nodes: nodes.iter().map(pixels).collect(),
            sent: vec![0; count * count],
            pairs: vec![Default::default(); (count + 1) * (count + 1)],
            ..Seen::default()
        };
        Some(RegionNodes {
            machine,
            graph,
            cube: machine.cube(),
            rules,
            itinerary: Itinerary::new(graph, (&order, owners), node_of, most_regions)?,
            ray_bytes: graph.ray_bytes(),
            nodes,
            free: vec![free; count],
            left: order.iter().map(|&tree| graph.tree(tree as usize).len() as u32).collect(),
            trees_left: graph.trees.len(),
            host_waits: graph.trees.len() + if rules.ends == Ends::Token { count } else { 0 },
            host_takes: 0,
            highest_rank,
            ring: gray_order(count),
            ages: 0,
            now: 0,
            blocked: 0,
            over: graph.trees.is_empty(),
            explains: false,
            seen,
            queues: Queues::new(count),
        })
    }

    /// The nodes, the host, their states and their queues.
    pub fn topology(&self) -> Topology {
        let queue = |node: usize| FifoInfo {
            name: format!("queue {node}"),
            group: "queue".to_owned(),
            from: Actor::Station(node),
            to: Actor::Station(node),
            // Where there are slots, rays have them that do not wait, too.
            capacity: None,
        };
        Topology { fifos: (0..self.nodes.len()).map(queue).collect(), ..topology(self.nodes.len(), "leg") }
    }

    /// The states of a node that sends, and of one that has nothing left to do.
    pub const SENDING_AND_IDLE: (StateId, StateId) = (SENDING, IDLE);

    /// Lets the nodes tell what they spend their time on, and by what names.
    pub fn explain(&mut self) -> Explanation {
        self.explains = true;
        causes::explanation(self.machine, (0, self.ray_bytes), causes::of_legs(self.graph))
    }

    /// What a node spends on sending a message, by what is in it.
    pub fn sending(note: &Note) -> Option<Unit> {
        Some(causes::sends(match note {
            Note::Ray(_) => MessageKind::VirtualObject,
            Note::Result(_) | Note::Pixels(..) => MessageKind::Calculation,
            Note::Asks(_) | Note::Gives(_) | Note::Token(_) | Note::Stop => MessageKind::Information,
        }))
    }

    /// Whether the host has all pixels.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// Since when a task has had nothing to do.
    pub fn rests(&self, task: usize) -> Option<Cycles> {
        self.nodes.get(task).and_then(|node| node.rests)
    }

    /// Lets a task act.
    pub fn next(&mut self, task: usize, now: Cycles, turn: &mut impl Turn<Note>) {
        self.now = now.0;
        if task == self.nodes.len() {
            return self.host(now, turn);
        }
        if let Some(note) = turn.taken() {
            self.take(task, &note);
        }
        while match self.nodes[task].script.pop_front() {
            Some(act) => turn.act(act),
            None => self.go_on(task, now, turn),
        } {}
    }

    /// Lets a node act that has nothing else to do before. False if its turn is over.
    #[inline(always)]
    fn go_on(&mut self, task: usize, now: Cycles, turn: &mut impl Turn<Note>) -> bool {
        match std::mem::replace(&mut self.nodes[task].next, Next::Looks) {
            Next::Looks => {
                while turn.poll(|note| self.take(task, note)).is_some() {}
                self.choose(task, now, turn)
            }
            Next::Answers(placing) => self.answer(task, placing),
            Next::Places { placing, is_granted } => self.place(task, placing, is_granted, turn),
            Next::Counts(tree) => {
                self.count(task, tree);
                true
            }
            Next::Passes => self.pass(task, now, turn),
            Next::Stops => self.stop(task),
        }
    }

    /// The host takes pixels until it has all.
    fn host(&mut self, now: Cycles, turn: &mut impl Turn<Note>) {
        if let Some(Note::Pixels(count, is_last)) = turn.taken() {
            let time = self.took(MessageKind::Calculation, packet_bytes(count));
            self.host_takes = count + u32::from(is_last);
            turn.act(Act::Work(RECEIVING, time, takes(MessageKind::Calculation)));
            return;
        }
        self.host_waits -= std::mem::take(&mut self.host_takes) as usize;
        if self.host_waits > 0 {
            turn.act(Act::Receive(Sender::Anyone, WAITING));
            return;
        }
        self.over = true;
        if self.rules.ends == Ends::Credit {
            self.seen.told_at = now;
        }
        turn.act(Act::End);
    }

    /// What has come is put where it belongs.
    #[inline]
    fn take(&mut self, task: usize, note: &Note) {
        let node = &mut self.nodes[task];
        match *note {
            Note::Ray(visit) => {
                node.account.taken();
                node.received.push_back(visit);
                self.note_queue(task);
            }
            Note::Result(tree) => {
                node.account.taken();
                node.results.push_back(tree);
            }
            Note::Asks(placing) => node.requests.push_back(placing),
            Note::Gives(placing) => node.given.push_back(placing),
            Note::Token(token) => node.account.token = Some(token),
            Note::Stop => node.has_stopped = true,
            Note::Pixels(..) => {}
        }
    }

    #[inline(always)]
    fn note_queue(&mut self, task: usize) {
        let node = &self.nodes[task];
        let waiting = node.own.len() + node.received.len();
        self.queues.hold(task, waiting as u64, Cycles(self.now));
    }

    /// Some slots of a node are taken or free.
    #[inline(always)]
    fn note_slots(&mut self, task: usize) {
        let is_full = match self.rules.flow {
            Flow::Block(_) => self.free[task] == 0,
            Flow::Classes(_) => self.free[task] <= self.highest_rank,
            Flow::Unlimited | Flow::Window(_) => return,
        };
        self.queues.fill(task, is_full, Cycles(self.now));
    }

    /// Does the first that there is to do. False if its turn is over.
    #[inline]
    fn choose(&mut self, task: usize, now: Cycles, turn: &mut impl Turn<Note>) -> bool {
        let was_resting = self.nodes[task].rests.take();
        if was_resting.is_some() {
            self.set_blocked(task, false);
        }
        if let Some(tree) = self.nodes[task].results.pop_front() {
            let time = self.took(MessageKind::Calculation, RESULT_BYTES) + self.machine.costs.result;
            self.nodes[task].next = Next::Counts(tree);
            return turn.act(Act::Work(RECEIVING, time, takes(MessageKind::Calculation)));
        }
        if self.rules.asks_for_slots
            && let Some(goes_on) = self.about_slots(task, turn)
        {
            return goes_on;
        }
        if let Some(Aside { placing, .. }) = self.movable(task) {
            self.nodes[task].next = Next::Places { placing, is_granted: false };
            return true;
        }
        let pixel = if self.rules.pixels_first { self.pixel(task, turn) } else { None };
        // Who has found no pixel finds none behind its rays either.
        let chosen = pixel.or_else(|| self.work(task, turn)).or_else(|| self.pixel(task, turn));
        if let Some(goes_on) = chosen {
            return goes_on;
        }
        if self.nodes[task].has_stopped {
            self.nodes[task].has_stopped = false;
            self.nodes[task].next = Next::Stops;
            let time = self.took(MessageKind::Information, WORD_BYTES);
            return turn.act(Act::Work(RECEIVING, time, takes(MessageKind::Information)));
        }
        if let Some(goes_on) = self.token(task, turn) {
            return goes_on;
        }
        let node = &mut self.nodes[task];
        node.rests = was_resting.or(Some(now));
        let is_blocked = node.slots.wants_any() || node.asked > 0;
        if is_blocked {
            self.set_blocked(task, true);
        }
        turn.act(Act::Receive(Sender::Anyone, if is_blocked { BLOCKED } else { WAITING }));
        false
    }

    /// A node has nothing else to do than to wait for a slot somewhere, or has again.
    #[inline(never)]
    fn set_blocked(&mut self, task: usize, is_blocked: bool) {
        self.blocked = self.blocked & !(1 << task) | u128::from(is_blocked) << task;
    }

    /// What was put aside and can go on.
    fn movable(&mut self, task: usize) -> Option<Aside> {
        if !self.nodes[task].slots.wants_any() {
            return None;
        }
        let (free, highest) = (&self.free, self.highest_rank);
        let slots = &mut self.nodes[task].slots;
        let (node, aside) = slots.take_movable(|node, rank| free[node] > highest - rank)?;
        if !slots.wants(node) {
            self.nodes[node].slots.wanted_by &= !(1 << task);
        }
        Some(aside)
    }

    /// Works on a ray, if there is one. False if its turn is over.
    #[inline(always)]
    fn work(&mut self, task: usize, turn: &mut impl Turn<Note>) -> Option<bool> {
        let node = &mut self.nodes[task];
        let own = node.own.pop();
        let is_own = own.is_some();
        let visit = match own {
            Some(visit) => visit,
            None => node.first_received(&self.itinerary)?,
        };
        let (ray, leg) = (self.itinerary.ray(visit), self.itinerary.leg(visit));
        self.note_queue(task);
        let mut receiving = Cycles(0);
        if !is_own {
            receiving = self.took(MessageKind::VirtualObject, self.ray_bytes);
            if let Flow::Block(_) = self.rules.flow {
                self.grant(task, turn);
            }
        }
        let time = self.itinerary.time(leg, &self.machine.times);
        self.seen.nodes[task].legs += 1;
        self.nodes[task].next = Next::Places { placing: self.itinerary.placing(visit, leg), is_granted: false };
        let spells = [
            (RECEIVING, receiving),
            (GRID, time.grid),
            (SLABS, time.slabs),
            (INTERSECTION, time.intersection),
            (SHADING, time.shading),
        ];
        if self.explains {
            self.explain_work(task, (ray, self.itinerary.legs_before(visit)), is_own, spells);
            return Some(true);
        }
        Some(turn.act(Act::Job(ray, spells)))
    }

    /// Tells what the work on a ray consists of, as it does it.
    fn explain_work(
        &mut self,
        task: usize,
        (ray, legs_before): (u32, u32),
        is_own: bool,
        mut spells: [(StateId, Cycles); MOST_SPELLS],
    ) {
        let receiving = std::mem::take(&mut spells[0].1);
        let taken = Act::Work(RECEIVING, receiving, takes(MessageKind::VirtualObject));
        let leg = self.graph.rays[ray as usize].first_leg + legs_before;
        let work = Act::Work(GRID, Cycles(0), Work::Piece(leg));
        let script = &mut self.nodes[task].script;
        script.push_back(Act::Begin(ray));
        script.extend((!is_own).then_some(taken));
        script.extend([work, Act::SpendEach(spells), Act::Done]);
    }

    /// Begins a pixel, if there is one and it may. False if its turn is over.
    #[inline]
    fn pixel(&mut self, task: usize, turn: &mut impl Turn<Note>) -> Option<bool> {
        let node = &self.nodes[task];
        let may = match self.rules.flow {
            Flow::Unlimited | Flow::Block(_) => true,
            Flow::Window(window) => node.begun - node.done < window as usize,
            Flow::Classes(_) => self.free[task] > self.highest_rank,
        };
        if !may {
            return None;
        }
        let node = &mut self.nodes[task];
        let tree = node.next_pixel(&self.itinerary)?;
        node.next = Next::Places { placing: self.itinerary.begin(tree), is_granted: false };
        Some(turn.act(Act::Work(PIXELS, self.machine.costs.pixel, PIXEL)))
    }

    #[inline(always)]
    fn send(&mut self, task: usize, to: usize, (kind, bytes): (MessageKind, u64), content: Note) -> Act<Note> {
        let time = self.machine.messages.of(bytes);
        self.seen.send(&self.cube, (task, to), (kind, bytes), time);
        Act::Send(Message { delivery: Delivery::Post(to), time, bytes, content })
    }

    /// What it takes to take a message.
    #[inline]
    fn took(&mut self, kind: MessageKind, bytes: u64) -> Cycles {
        let time = self.machine.messages.of(bytes);
        self.seen.messages[kind as usize].take(time);
        time
    }
}

/// The trees of an order, those that belong to the first node before those of the second and so on. Each node is told its own.
fn by_owner(order: &[u32], owners: &[u16], nodes: &mut [Node]) -> Vec<u32> {
    owners.iter().for_each(|&owner| nodes[usize::from(owner)].pixels.end += 1);
    let mut end = 0;
    for Node { pixels, .. } in nodes.iter_mut() {
        (pixels.start, end) = (end, end + pixels.end);
        pixels.end = pixels.start;
    }
    let mut sorted = vec![0; order.len()];
    for &tree in order {
        let pixels = &mut nodes[usize::from(owners[tree as usize])].pixels;
        sorted[pixels.end as usize] = tree;
        pixels.end += 1;
    }
    sorted
}

/// R, the highest rank of any ray of a graph: nodes need one slot more, for none to stick.
pub fn highest_rank(graph: &TaskGraph) -> u32 {
    ranks(graph).1
}

/// The most regions of a line, and R.
fn ranks(graph: &TaskGraph) -> (u32, u32) {
    let (regions, turns) = graph.most_regions_and_turns();
    (regions, (turns + 1).saturating_mul(regions) - 1)
}
