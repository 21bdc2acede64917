//! What nodes do that have a region each and send rays to each other (RR-0992, §4.1).
//!
//! A node does one thing after the other. When it is free, it takes the first that there is: a result that has come; what was put aside
//! and can go on; a ray, its own children first, the last made before the others, then those that have come, in the order in which
//! they did; a new pixel. Working on a ray is one leg: its way through the region. Then what follows from it is placed, one after the
//! other, here or on other nodes; a ray that has ended makes a result for the node that its pixel belongs to, which adds results up and
//! sends pixels that are done to the host.

use std::collections::VecDeque;

use super::graph::TaskGraph;
use super::mapping::gray_order;
use super::messages::{
    MessageKind, Messages, PACKET_PIXELS, RAY_BYTES, RESULT_BYTES, TOKEN_BYTES, WORD_BYTES, packet_bytes,
};
use super::pool::{Flow, Placing, Slots};
use super::states::{BLOCKED, GRID, IDLE, INTERSECTION, PIXELS, RECEIVING, SENDING, SHADING, SLABS, WAITING, topology};
use super::stuck::{Stuck, Waiting};
use super::token::{Account, Token};
use crate::host::shading::RayKind;
use crate::machine::events::{Act, Cube, Delivery, Message, Sender};
use crate::machine::{Cycles, Ipsc2};
use crate::measure::{StateId, Topology};

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
    /// Whether a node begins all its pixels before it works on rays of others.
    pub pixels_first: bool,
}

/// A ray in a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    /// The ray.
    pub ray: u32,
    /// Its leg, among all.
    pub leg: u32,
}

/// What is in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// A ray.
    Ray(Visit),
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
    /// Each region's node.
    node_of: Vec<u16>,
    /// Each tree's node.
    owners: &'a [u16],
    nodes: Vec<Node>,
    /// For each tree, how many results are still to come.
    left: Vec<u32>,
    /// Trees whose results have not all come.
    trees_left: usize,
    /// Pixels that the host has not got, and nodes that have not stopped, where they are told to.
    host_waits: usize,
    /// The host takes a packet with so many of them.
    host_takes: u32,
    /// The most regions of a line, and R, the highest rank.
    ranks: (u32, u32),
    /// The order of nodes in which the token goes round.
    ring: Vec<u16>,
    ages: u64,
    /// Nodes that have nothing else to do than to wait for a slot somewhere, a bit each.
    blocked: u128,
    over: bool,
    /// What is counted.
    pub seen: Seen,
}

/// What is counted beside the nodes' time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// Messages by kind.
    pub messages: Messages,
    /// When the last result was taken.
    pub true_end: Cycles,
    /// When that was known.
    pub told_at: Cycles,
    /// Rounds of the token that were begun.
    pub probes: u64,
    /// For each node, what it came to.
    pub nodes: Vec<NodeSeen>,
    /// Rays that were sent on or away, from each node to each, row by row.
    pub sent: Vec<u64>,
}

/// What a node came to beside its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeSeen {
    /// Pixels that belong to it.
    pub pixels: usize,
    /// Legs that it has worked on.
    pub legs: u64,
    /// The most rays that waited there.
    pub longest_queue: usize,
    /// The most slots that were taken at once, if there are slots.
    pub most_slots: u32,
    /// Pages that it has fetched, if it fetches any.
    pub pages: u64,
}

#[derive(Clone, Debug)]
struct Node {
    next: Next,
    /// What it does before it goes on.
    script: VecDeque<Act<Note>>,
    own: Vec<Visit>,
    received: VecDeque<Visit>,
    results: VecDeque<u32>,
    /// Its pixels, as trees, in the order in which they are begun; so many have been, and so many are done.
    pixels: Vec<u32>,
    begun: usize,
    done: usize,
    /// Pixels that are done and not sent to the host.
    packet: u32,
    slots: Slots,
    account: Account,
    has_stopped: bool,
    /// Since when it has nothing to do.
    rests: Option<Cycles>,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    /// Looks at what has come.
    Looks,
    /// Has seen all that has come, and chooses.
    Chooses,
    /// Has worked on a ray.
    Worked(Visit),
    /// Places what follows from a ray.
    Places(Placing),
    /// The same, and has been given the slot that it waited for.
    PlacesGranted(Placing),
    /// Has begun a pixel.
    Began(u32),
    /// Has taken a result.
    Counts(u32),
    /// Has taken the token.
    Passes,
    /// Has been told that all is done.
    Stops,
}

impl<'a> RegionNodes<'a> {
    /// Nodes at the start: each region of a graph on the node that `node_of` tells, each tree begun by the node in `owners`, which has
    /// them in the order in which `order` lists them.
    pub fn new(
        machine: &'a Ipsc2,
        graph: &'a TaskGraph,
        node_of: &[u16],
        (owners, order): (&'a [u16], &[u32]),
        rules: Rules,
    ) -> RegionNodes<'a> {
        let count = machine.nodes;
        let most_regions = graph.most_regions_of_a_line();
        let ranks = (most_regions, highest_rank(graph));
        let free = match rules.flow {
            Flow::Block(slots) | Flow::Classes(slots) => slots,
            Flow::Unlimited | Flow::Window(_) => u32::MAX,
        };
        let mut nodes: Vec<Node> = (0..count).map(|_| Node::new(Slots::new(count, free))).collect();
        order.iter().for_each(|&tree| nodes[usize::from(owners[tree as usize])].pixels.push(tree));
        if rules.ends == Ends::Token {
            nodes[0].account.is_black = true;
            nodes[0].account.token = Some(Token::default());
        }
        let pixels = |node: &Node| NodeSeen { pixels: node.pixels.len(), ..NodeSeen::default() };
        let seen = Seen { nodes: nodes.iter().map(pixels).collect(), sent: vec![0; count * count], ..Seen::default() };
        RegionNodes {
            machine,
            graph,
            cube: machine.cube(),
            rules,
            node_of: node_of.to_vec(),
            owners,
            nodes,
            left: (0..graph.trees.len()).map(|tree| graph.tree(tree).len() as u32).collect(),
            trees_left: graph.trees.len(),
            host_waits: graph.trees.len() + if rules.ends == Ends::Token { count } else { 0 },
            host_takes: 0,
            ranks,
            ring: gray_order(count),
            ages: 0,
            blocked: 0,
            over: graph.trees.is_empty(),
            seen,
        }
    }

    /// The nodes, the host and their states.
    pub fn topology(&self) -> Topology {
        topology(self.nodes.len(), "leg")
    }

    /// The states of a node that sends, and of one that has nothing left to do.
    pub const SENDING_AND_IDLE: (StateId, StateId) = (SENDING, IDLE);

    /// Whether the host has all pixels.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// Since when a task has had nothing to do.
    pub fn rests(&self, task: usize) -> Option<Cycles> {
        self.nodes.get(task).and_then(|node| node.rests)
    }

    /// What a task does next, given the time and the message that it has just taken, if it did.
    pub fn next(&mut self, task: usize, now: Cycles, taken: Option<Note>) -> Act<Note> {
        if task == self.nodes.len() {
            return self.host(now, taken);
        }
        if let Some(note) = taken {
            self.take(task, note);
            self.nodes[task].next = Next::Chooses;
            return Act::Poll;
        }
        if let Some(act) = self.nodes[task].script.pop_front() {
            return act;
        }
        match self.nodes[task].next {
            Next::Chooses => self.choose(task, now),
            Next::Looks => self.look(task),
            Next::Worked(visit) => {
                self.nodes[task].next = Next::Places(Placing { visit, is_new: false, placed: 0 });
                Act::Done
            }
            Next::Places(placing) => self.place(task, placing, false, now),
            Next::PlacesGranted(placing) => self.place(task, placing, true, now),
            Next::Began(tree) => {
                let ray = self.graph.trees[tree as usize];
                let visit = Visit { ray, leg: self.graph.rays[ray as usize].first_leg };
                self.place(task, Placing { visit, is_new: true, placed: 0 }, false, now)
            }
            Next::Counts(tree) => {
                self.count(task, tree, now);
                self.look(task)
            }
            Next::Passes => self.pass(task, now),
            Next::Stops => self.stop(task),
        }
    }

    /// The host takes pixels until it has all.
    fn host(&mut self, now: Cycles, taken: Option<Note>) -> Act<Note> {
        if let Some(Note::Pixels(count, is_last)) = taken {
            let time = self.took(MessageKind::Calculation, packet_bytes(count));
            self.host_takes = count + u32::from(is_last);
            return Act::Spend(RECEIVING, time);
        }
        self.host_waits -= std::mem::take(&mut self.host_takes) as usize;
        if self.host_waits > 0 {
            return Act::Receive(Sender::Anyone, WAITING);
        }
        self.over = true;
        if self.rules.ends == Ends::Credit {
            self.seen.told_at = now;
        }
        Act::End
    }

    /// What has come is put where it belongs.
    fn take(&mut self, task: usize, note: Note) {
        let node = &mut self.nodes[task];
        match note {
            Note::Ray(visit) => {
                node.account.taken();
                node.received.push_back(visit);
                self.note_queue(task);
            }
            Note::Result(tree) => {
                node.account.taken();
                node.results.push_back(tree);
            }
            Note::Token(token) => node.account.token = Some(token),
            Note::Stop => node.has_stopped = true,
            Note::Pixels(..) => {}
        }
    }

    fn note_queue(&mut self, task: usize) {
        let node = &self.nodes[task];
        let waiting = node.own.len() + node.received.len();
        let seen = &mut self.seen.nodes[task];
        seen.longest_queue = seen.longest_queue.max(waiting);
    }

    /// Looks at what has come, then chooses.
    fn look(&mut self, task: usize) -> Act<Note> {
        let node = &mut self.nodes[task];
        if let Some(act) = node.script.pop_front() {
            node.next = Next::Looks;
            return act;
        }
        node.next = Next::Chooses;
        Act::Poll
    }

    /// Takes the first that there is to do.
    fn choose(&mut self, task: usize, now: Cycles) -> Act<Note> {
        let was_resting = self.nodes[task].rests.take();
        self.blocked &= !(1 << task);
        if let Some(tree) = self.nodes[task].results.pop_front() {
            let time = self.took(MessageKind::Calculation, RESULT_BYTES) + self.machine.costs.result;
            self.nodes[task].next = Next::Counts(tree);
            return Act::Spend(RECEIVING, time);
        }
        if let Some(placing) = self.movable(task) {
            return self.place(task, placing, false, now);
        }
        let chosen = match self.rules.pixels_first {
            false => self.work(task).or_else(|| self.pixel(task)),
            true => self.pixel(task).or_else(|| self.work(task)),
        };
        if let Some(act) = chosen {
            return act;
        }
        if self.nodes[task].has_stopped {
            self.nodes[task].has_stopped = false;
            self.nodes[task].next = Next::Stops;
            return Act::Spend(RECEIVING, self.took(MessageKind::Information, WORD_BYTES));
        }
        if let Some(act) = self.token(task) {
            return act;
        }
        let node = &mut self.nodes[task];
        node.rests = was_resting.or(Some(now));
        node.next = Next::Looks;
        let is_blocked = node.slots.wants_any();
        self.blocked |= u128::from(is_blocked) << task;
        Act::Receive(Sender::Anyone, if is_blocked { BLOCKED } else { WAITING })
    }

    /// What was put aside and can go on.
    fn movable(&mut self, task: usize) -> Option<Placing> {
        if !self.nodes[task].slots.wants_any() {
            return None;
        }
        let mut slots = std::mem::take(&mut self.nodes[task].slots);
        let (own, highest) = (slots.free, self.ranks.1);
        let free = |node: usize| if node == task { own } else { self.nodes[node].slots.free };
        let movable = slots.take_movable(|node, rank| free(node) > highest - rank);
        self.nodes[task].slots = slots;
        movable
    }

    /// Works on a ray, if there is one.
    fn work(&mut self, task: usize) -> Option<Act<Note>> {
        let node = &mut self.nodes[task];
        let own = node.own.pop();
        let is_own = own.is_some();
        let visit = own.or_else(|| node.received.pop_front())?;
        let mut receiving = Cycles(0);
        if !is_own {
            receiving = self.took(MessageKind::VirtualObject, RAY_BYTES);
            if let Flow::Block(_) = self.rules.flow {
                self.grant(task);
            }
        }
        let time = self.graph.time(visit.ray, visit.leg, &self.machine.times);
        self.seen.nodes[task].legs += 1;
        let node = &mut self.nodes[task];
        node.next = Next::Worked(visit);
        node.script.push_back(Act::SpendEach([
            (RECEIVING, receiving),
            (GRID, time.grid),
            (SLABS, time.slabs),
            (INTERSECTION, time.intersection),
            (SHADING, time.shading),
        ]));
        Some(Act::Begin(visit.ray))
    }

    /// Begins a pixel, if there is one and it may.
    fn pixel(&mut self, task: usize) -> Option<Act<Note>> {
        let node = &self.nodes[task];
        let may = match self.rules.flow {
            Flow::Unlimited | Flow::Block(_) => true,
            Flow::Window(window) => node.begun - node.done < window as usize,
            Flow::Classes(_) => node.slots.free > self.ranks.1,
        };
        let tree = *node.pixels.get(node.begun).filter(|_| may)?;
        let node = &mut self.nodes[task];
        node.begun += 1;
        node.next = Next::Began(tree);
        Some(Act::Spend(PIXELS, self.machine.costs.pixel))
    }

    /// A ray has a slot here, and waits for its turn.
    fn keep(&mut self, task: usize, visit: Visit) {
        if let Flow::Classes(_) = self.rules.flow {
            self.take_slot(task);
        }
        self.nodes[task].own.push(visit);
        self.note_queue(task);
    }

    fn take_slot(&mut self, node: usize) {
        let slots = &mut self.nodes[node].slots;
        slots.free = slots.free.saturating_sub(1);
        if let Flow::Block(all) | Flow::Classes(all) = self.rules.flow {
            let seen = &mut self.seen.nodes[node];
            seen.most_slots = seen.most_slots.max(all - slots.free);
        }
    }

    /// A ray leaves the queue, and the node that has waited longest may send.
    fn grant(&mut self, task: usize) {
        let node = &mut self.nodes[task];
        match node.slots.waiting.pop_front() {
            Some(other) => {
                node.script.push_back(Act::Wake(other.into()));
                let other = &mut self.nodes[usize::from(other)];
                if let Next::Places(placing) = other.next {
                    other.next = Next::PlacesGranted(placing);
                }
            }
            None => node.slots.free += 1,
        }
    }

    /// A ray has placed all that follows from it.
    fn leave(&mut self, task: usize) {
        if let Flow::Classes(_) = self.rules.flow {
            self.nodes[task].slots.free += 1;
            let mut blocked = self.blocked;
            while blocked != 0 {
                let other = blocked.trailing_zeros() as usize;
                blocked &= blocked - 1;
                if self.nodes[other].slots.wants(task) {
                    self.nodes[task].script.push_back(Act::Wake(other));
                }
            }
        }
    }

    /// The rank of a ray in a region.
    fn rank(&self, visit: Visit) -> u32 {
        let ray = &self.graph.rays[visit.ray as usize];
        u32::from(ray.turns) * self.ranks.0 + u32::from(ray.hop) + visit.leg - ray.first_leg
    }

    fn node(&self, region: u16) -> usize {
        self.node_of[usize::from(region)].into()
    }

    /// What of a placing comes next: the ray in its next region, or a ray that its hit asks for.
    fn follows(&self, placing: Placing) -> Option<Visit> {
        let Visit { ray, leg } = placing.visit;
        if placing.is_new {
            return (placing.placed == 0).then_some(placing.visit);
        }
        if leg + 1 < self.graph.legs_end(ray) {
            return (placing.placed == 0).then_some(Visit { ray, leg: leg + 1 });
        }
        let (first, count) = self.graph.rays[ray as usize].children;
        (placing.placed < count).then(|| {
            let ray = first + placing.placed;
            Visit { ray, leg: self.graph.rays[ray as usize].first_leg }
        })
    }

    /// Places what follows from a ray, until that takes time.
    fn place(&mut self, task: usize, mut placing: Placing, is_granted: bool, now: Cycles) -> Act<Note> {
        while let Some(visit) = self.follows(placing) {
            let to = self.node(self.graph.legs[visit.leg as usize].region);
            if to == task && self.is_the_rest(placing, visit) {
                // It has its line and its slot in common with the ray that met a blocker.
                self.nodes[task].own.push(visit);
                self.note_queue(task);
                return self.end(task, placing, now);
            }
            if let Some(act) = self.wait_for_slot(task, (to, visit), placing, is_granted) {
                return act;
            }
            placing.placed += 1;
            if to == task {
                self.keep(task, visit);
                continue;
            }
            if !is_granted && self.nodes[to].slots.free != u32::MAX {
                self.take_slot(to);
            }
            self.nodes[task].next = Next::Places(placing);
            return self.send_ray(task, to, visit);
        }
        if !placing.is_new {
            self.leave(task);
        }
        self.end(task, placing, now)
    }

    /// Whether a ray is the rest of a shadow ray behind what it has hit.
    fn is_the_rest(&self, placing: Placing, visit: Visit) -> bool {
        let kind = |ray: u32| self.graph.rays[ray as usize].kind;
        kind(visit.ray) == RayKind::Shadow
            && kind(placing.visit.ray) == RayKind::Shadow
            && visit.ray != placing.visit.ray
    }

    /// All that follows from a ray is placed: if it has ended, it makes a result.
    fn end(&mut self, task: usize, placing: Placing, now: Cycles) -> Act<Note> {
        let Visit { ray, leg } = placing.visit;
        if !placing.is_new && leg + 1 == self.graph.legs_end(ray) {
            let tree = self.graph.rays[ray as usize].tree;
            let owner = usize::from(self.owners[tree as usize]);
            if owner != task {
                self.nodes[task].account.sent();
                let result = self.send(task, owner, (MessageKind::Calculation, RESULT_BYTES), Note::Result(tree));
                // Who waits for the slot that is free now goes first.
                self.nodes[task].script.push_back(result);
                return self.look(task);
            }
            self.count(task, tree, now);
        }
        self.look(task)
    }

    /// What a node does that has to wait for a slot, if it has to.
    fn wait_for_slot(
        &mut self,
        task: usize,
        (to, visit): (usize, Visit),
        placing: Placing,
        is_granted: bool,
    ) -> Option<Act<Note>> {
        match self.rules.flow {
            Flow::Block(_) if to != task && !is_granted && self.nodes[to].slots.free == 0 => {
                self.nodes[to].slots.waiting.push_back(task as u16);
                self.nodes[task].next = Next::Places(placing);
                Some(Act::Sleep(BLOCKED))
            }
            Flow::Classes(_) if !self.has_room(to, self.rank(visit)) => {
                self.ages += 1;
                let (rank, age) = (self.rank(visit), self.ages);
                self.nodes[task].slots.put_aside(to, rank, age, placing);
                Some(self.look(task))
            }
            _ => None,
        }
    }

    /// Whether a node has a slot for such a rank.
    fn has_room(&self, node: usize, rank: u32) -> bool {
        self.nodes[node].slots.free > self.ranks.1 - rank
    }

    fn send_ray(&mut self, task: usize, to: usize, visit: Visit) -> Act<Note> {
        self.nodes[task].account.sent();
        self.seen.sent[task * self.nodes.len() + to] += 1;
        self.send(task, to, (MessageKind::VirtualObject, RAY_BYTES), Note::Ray(visit))
    }

    fn send(&mut self, task: usize, to: usize, (kind, bytes): (MessageKind, u64), content: Note) -> Act<Note> {
        let time = self.machine.messages.of(bytes);
        let counts = &mut self.seen.messages[kind as usize];
        counts.sent += 1;
        counts.bytes += bytes;
        counts.hops += self.cube.hops(task, to);
        counts.processor += time;
        Act::Send(Message { delivery: Delivery::Post(to), time, bytes, content })
    }

    /// What it takes to take a message.
    fn took(&mut self, kind: MessageKind, bytes: u64) -> Cycles {
        let time = self.machine.messages.of(bytes);
        let counts = &mut self.seen.messages[kind as usize];
        counts.taken += 1;
        counts.processor += time;
        time
    }

    /// A result of a tree has come to its node.
    fn count(&mut self, task: usize, tree: u32, now: Cycles) {
        let left = &mut self.left[tree as usize];
        *left -= 1;
        if *left > 0 {
            return;
        }
        self.trees_left -= 1;
        if self.trees_left == 0 {
            self.seen.true_end = now;
        }
        let node = &mut self.nodes[task];
        node.done += 1;
        node.packet += 1;
        if self.rules.ends == Ends::Credit && (node.packet == PACKET_PIXELS || node.done == node.pixels.len()) {
            self.send_packet(task, false);
        }
    }

    fn send_packet(&mut self, task: usize, is_last: bool) {
        let count = std::mem::take(&mut self.nodes[task].packet);
        let host = self.nodes.len();
        let act = self.send(task, host, (MessageKind::Calculation, packet_bytes(count)), Note::Pixels(count, is_last));
        self.nodes[task].script.push_back(act);
    }

    /// A node that has the token and nothing else to do.
    fn token(&mut self, task: usize) -> Option<Act<Note>> {
        let node = &self.nodes[task];
        let is_passive = node.begun == node.pixels.len() && !node.slots.wants_any();
        node.account.token.filter(|_| is_passive)?;
        self.nodes[task].next = Next::Passes;
        // Node 0 has the first token without having been sent it. A token that took no time would go round for ever while a ray is
        // under way.
        let was_sent = task > 0 || self.seen.probes > 0;
        let time = if was_sent { self.took(MessageKind::Information, TOKEN_BYTES).max(Cycles(1)) } else { Cycles(0) };
        Some(Act::Spend(RECEIVING, time))
    }

    /// Passes the token on, or knows that all is over.
    fn pass(&mut self, task: usize, now: Cycles) -> Act<Note> {
        let account = &mut self.nodes[task].account;
        let is_alone = self.ring.len() == 1;
        if task == 0 && (account.is_over() || is_alone) {
            account.token = None;
            self.seen.told_at = now;
            let others = 1..self.nodes.len();
            for other in others {
                let act = self.send(0, other, (MessageKind::Information, WORD_BYTES), Note::Stop);
                self.nodes[0].script.push_back(act);
            }
            return self.stop(0);
        }
        let token = if task == 0 { Some(account.begin()) } else { account.pass() };
        self.seen.probes += u64::from(task == 0);
        let Some(token) = token else { return self.look(task) };
        self.nodes[task].next = Next::Looks;
        let place = self.ring.iter().position(|&node| usize::from(node) == task).unwrap_or(0);
        let to = usize::from(self.ring[(place + 1) % self.ring.len()]);
        self.send(task, to, (MessageKind::Information, TOKEN_BYTES), Note::Token(token))
    }

    /// Sends the host all its pixels, if only to say that there are none.
    fn stop(&mut self, task: usize) -> Act<Note> {
        let mut left = std::mem::take(&mut self.nodes[task].packet);
        loop {
            let count = left.min(PACKET_PIXELS);
            left -= count;
            self.nodes[task].packet = count;
            self.send_packet(task, left == 0);
            if left == 0 {
                return self.look(task);
            }
        }
    }

    /// Who waits for whom, when no node can go on.
    pub fn stuck(&self) -> Stuck {
        let waits = |(node, state): (usize, &Node)| {
            let (to, placing) = match (self.rules.flow, state.next) {
                (Flow::Block(_), Next::Places(placing)) => {
                    let visit = self.follows(placing)?;
                    (self.node(self.graph.legs[visit.leg as usize].region), placing)
                }
                _ => state.slots.first_aside()?,
            };
            let visit = self.follows(placing)?;
            let ray = &self.graph.rays[visit.ray as usize];
            Some(Waiting { node, ray: visit.ray, kind: ray.kind, tree: ray.tree, to })
        };
        let slots = match self.rules.flow {
            Flow::Block(slots) | Flow::Classes(slots) => slots,
            Flow::Unlimited | Flow::Window(_) => 0,
        };
        let waiting: Vec<Waiting> = self.nodes.iter().enumerate().filter_map(waits).collect();
        Stuck::new(&waiting, slots, self.ranks.1 + 1)
    }

    /// What kind a ray is of.
    pub fn kind(&self, ray: u32) -> RayKind {
        self.graph.rays[ray as usize].kind
    }
}

/// R, the highest rank of any ray of a graph: nodes need one slot more, for none to stick.
pub fn highest_rank(graph: &TaskGraph) -> u32 {
    (graph.most_turns() + 1).saturating_mul(graph.most_regions_of_a_line()) - 1
}

impl Node {
    fn new(slots: Slots) -> Node {
        Node {
            next: Next::Looks,
            script: VecDeque::new(),
            own: Vec::new(),
            received: VecDeque::new(),
            results: VecDeque::new(),
            pixels: Vec::new(),
            begun: 0,
            done: 0,
            packet: 0,
            slots,
            account: Account::default(),
            has_stopped: false,
            rests: None,
        }
    }
}
