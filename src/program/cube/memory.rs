//! What nodes do that have the scene together, in a shared memory that is only read (Ray Tracing News 3(1)).
//!
//! Page p is at home on node p mod N. A node has pixels of its own, or asks the host for a tile of them whenever it has none left, and
//! traces their trees, ray by ray; no ray is sent. Before a ray it reads the ray's pages: one at home for nothing, one of another node in
//! its cache for a look-up each time, else it asks the home for it and waits. The home is interrupted: a helper of it serves the page, and
//! what that took the node makes good before its next ray, unless it was waiting itself.

use super::causes::{self, LOOK_UP, PIXEL, SERVE, takes};
use super::graph::{PageUses, TaskGraph};
use super::lru::Lru;
use super::messages::{MessageKind, PACKET_PIXELS, PAGE_HEAD_BYTES, TOKEN_BYTES, WORD_BYTES, packet_bytes};
use super::seen::{NodeSeen, Seen};
use super::states::{
    GRID, IDLE, INTERSECTION, LOOKUP, PIXELS, RECEIVING, SENDING, SERVING, SHADING, SLABS, WAITING, WAITING_PAGE,
    topology,
};
use crate::machine::events::{Act, Cube, Delivery, Explanation, Message, Sender, Work};
use crate::machine::{Cycles, Ipsc2};
use crate::measure::{Actor, CriticalPath, StateId, Topology};
use crate::seam::Unit;

/// What is in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PageNote {
    /// That node wants a page.
    Wants(u16),
    /// A page.
    Page,
    /// So many pixels that are done.
    Pixels(u32),
    /// That node has no pixels left.
    Asks(u16),
    /// It may have that tile, if there is one left.
    Tile(Option<u32>),
}

/// Who traces which pixels.
#[derive(Clone, Debug)]
pub enum Dealt {
    /// Each node has trees of its own, in its order.
    Before(Vec<Vec<u32>>),
    /// The host has tiles of trees, which it gives to whoever asks.
    AsAsked(Vec<Vec<u32>>),
}

/// Nodes at work.
#[derive(Clone, Debug)]
pub struct MemoryNodes<'a> {
    machine: &'a Ipsc2,
    graph: &'a TaskGraph,
    uses: &'a PageUses,
    cube: Cube,
    nodes: Vec<Node>,
    host: Host,
    /// Nodes that have not ended.
    at_work: usize,
    /// Whether it is told what rays consist of.
    explains: bool,
    /// What is counted.
    pub seen: Seen,
}

#[derive(Clone, Debug)]
struct Host {
    /// Trees that it has not got, and the nodes that it has not told that there is nothing left to do.
    waits: usize,
    untold: usize,
    /// The tiles that it gives away; so many it has given.
    tiles: Vec<Vec<u32>>,
    given: usize,
    /// What it has taken.
    takes: Option<PageNote>,
    has_ended: bool,
}

#[derive(Clone, Debug)]
struct Node {
    next: Next,
    /// Its pixels, as trees; so many have been begun.
    pixels: Vec<u32>,
    begun: usize,
    /// Pixels that are done and not sent to the host.
    packet: u32,
    cache: Lru,
    /// The rays of the pixel under way that are still to come.
    rays: std::ops::Range<u32>,
    /// Whether it has told what its ray consists of, where that is told.
    has_told: bool,
    /// How many of its ray's pages it has read.
    read: usize,
    /// What it has served while it worked, and not made good.
    owes: Cycles,
    /// Whether it waits, and serves for nothing.
    waits: bool,
    rests: Option<Cycles>,
    /// Whom its helper serves.
    serves: Option<u16>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    /// Begins a pixel.
    Begins,
    /// Has asked the host for pixels, and waits for them.
    AwaitsTile,
    /// Has been given a tile, or told that there is none left.
    GetsTile(Option<u32>),
    /// Goes on to the next ray.
    Ray,
    /// Begins the ray itself.
    Starts,
    /// Reads the ray's pages.
    Reads,
    /// Asks for a page of that node.
    Asks(u16),
    /// Waits for it.
    Awaits,
    /// Has got it.
    Gets,
    /// Works on the ray.
    Works,
    /// Has worked on it.
    Worked,
    /// Has no more pixels.
    Ends,
}

impl<'a> MemoryNodes<'a> {
    /// Nodes at the start, with their pixels. `None` if it was not recorded what the rays read.
    pub fn new(machine: &'a Ipsc2, graph: &'a TaskGraph, dealt: Dealt) -> Option<MemoryNodes<'a>> {
        let uses = graph.pages.as_ref()?;
        let count = machine.nodes;
        let at_home = u64::from(uses.pages).div_ceil(count as u64) * u64::from(uses.page_bytes);
        let room = machine.memory_bytes.saturating_sub(at_home) / u64::from(uses.page_bytes.max(1));
        let cache = Lru::new(uses.pages, room.min(u64::from(uses.pages)) as usize);
        let (own, tiles, untold) = match dealt {
            Dealt::Before(own) => (own, Vec::new(), 0),
            Dealt::AsAsked(tiles) => (vec![Vec::new(); count], tiles, count),
        };
        let pixels = |pixels: &Vec<u32>| NodeSeen { pixels: pixels.len(), ..NodeSeen::default() };
        let seen = Seen {
            nodes: own.iter().map(pixels).collect(),
            sent: vec![0; count * count],
            pairs: vec![Default::default(); (count + 1) * (count + 1)],
            ..Seen::default()
        };
        let waits = graph.trees.len();
        Some(MemoryNodes {
            machine,
            graph,
            uses,
            cube: machine.cube(),
            nodes: own.into_iter().map(|pixels| Node::new(pixels, cache.clone())).collect(),
            host: Host { waits, untold, tiles, given: 0, takes: None, has_ended: false },
            at_work: count,
            explains: false,
            seen,
        })
    }

    /// The nodes, the host and their states.
    pub fn topology(&self) -> Topology {
        topology(self.nodes.len(), "ray")
    }

    /// The states of a node that sends, and of one that has nothing left to do.
    pub const SENDING_AND_IDLE: (StateId, StateId) = (SENDING, IDLE);

    /// Tasks behind the host, which serve pages: one a node.
    pub fn helpers(&self) -> usize {
        self.nodes.len()
    }

    /// Lets the nodes tell what they spend their time on, and by what names.
    pub fn explain(&mut self) -> Explanation {
        self.explains = true;
        let bytes = (self.uses.page_bytes, self.graph.ray_bytes());
        causes::explanation(self.machine, bytes, causes::of_rays(self.graph))
    }

    /// What a node spends on sending a message, by what is in it; what it takes to send a page is part of serving.
    pub fn sending(note: &PageNote) -> Option<Unit> {
        match note {
            PageNote::Page => None,
            PageNote::Pixels(_) => Some(causes::sends(MessageKind::Calculation)),
            PageNote::Wants(_) | PageNote::Asks(_) | PageNote::Tile(_) => Some(causes::sends(MessageKind::Information)),
        }
    }

    /// What helpers do is told of their nodes.
    pub fn told_of_nodes(&self, path: &mut CriticalPath) {
        let host = self.nodes.len();
        for part in path.bins.iter_mut().flatten() {
            if let Actor::Station(task) = &mut part.at
                && *task > host
            {
                *task -= host + 1;
            }
        }
    }

    /// Whether the host has all pixels, and all nodes know.
    pub fn is_over(&self) -> bool {
        self.host.has_ended && self.at_work == 0
    }

    /// Since when a task has had nothing to do.
    pub fn rests(&self, task: usize) -> Option<Cycles> {
        self.nodes.get(task).and_then(|node| node.rests)
    }

    /// What a task does next, given the time and the message that it has just taken, if it did.
    pub fn next(&mut self, task: usize, now: Cycles, taken: Option<&PageNote>) -> Act<PageNote> {
        let host = self.nodes.len();
        match task {
            task if task < host => self.node(task, now, taken),
            task if task == host => self.host(now, taken),
            helper => self.serve(helper - host - 1, taken),
        }
    }

    /// The host takes pixels and gives tiles away until it has all and has told so whoever asks.
    fn host(&mut self, now: Cycles, taken: Option<&PageNote>) -> Act<PageNote> {
        if let Some(note) = taken {
            self.host.takes = Some(*note);
            let (kind, bytes) = match note {
                PageNote::Pixels(count) => (MessageKind::Calculation, packet_bytes(*count)),
                _ => (MessageKind::Information, TOKEN_BYTES),
            };
            return Act::Work(RECEIVING, self.took(kind, bytes), takes(kind));
        }
        match self.host.takes.take() {
            Some(PageNote::Asks(node)) => return self.give_tile(node),
            Some(PageNote::Pixels(count)) => {
                self.host.waits -= count as usize;
                if self.host.waits == 0 {
                    self.seen.told_at = now;
                }
            }
            _ => {}
        }
        if self.host.waits > 0 || self.host.untold > 0 {
            return Act::Receive(Sender::Anyone, WAITING);
        }
        self.host.has_ended = true;
        Act::End
    }

    fn give_tile(&mut self, node: u16) -> Act<PageNote> {
        let host = &mut self.host;
        let tile = (host.given < host.tiles.len()).then_some(host.given as u32);
        match tile {
            Some(_) => host.given += 1,
            None => host.untold -= 1,
        }
        let time = self.machine.messages.of(WORD_BYTES);
        let ends = (self.nodes.len(), node.into());
        self.send(ends, (MessageKind::Information, WORD_BYTES), time, PageNote::Tile(tile))
    }

    /// A node's helper serves who wants a page of it.
    fn serve(&mut self, node: usize, taken: Option<&PageNote>) -> Act<PageNote> {
        if let Some(&PageNote::Wants(asker)) = taken {
            self.nodes[node].serves = Some(asker);
            return Act::Work(SERVING, self.machine.costs.serve, SERVE);
        }
        let Some(asker) = self.nodes[node].serves.take() else { return Act::Receive(Sender::Anyone, IDLE) };
        if !self.nodes[node].waits {
            self.nodes[node].owes += self.machine.costs.serve;
        }
        self.seen.messages[MessageKind::Information as usize].taken += 1;
        let bytes = PAGE_HEAD_BYTES + u64::from(self.uses.page_bytes);
        // What it takes to send it is part of serving.
        self.send((node, asker.into()), (MessageKind::RealObject, bytes), Cycles(0), PageNote::Page)
    }

    fn node(&mut self, task: usize, now: Cycles, taken: Option<&PageNote>) -> Act<PageNote> {
        let machine = self.machine;
        if let Some(&PageNote::Tile(tile)) = taken {
            self.nodes[task].next = Next::GetsTile(tile);
            let time = self.took(MessageKind::Information, WORD_BYTES);
            return Act::Work(RECEIVING, time, takes(MessageKind::Information));
        }
        let node = &mut self.nodes[task];
        match node.next {
            Next::Begins => {
                let Some(&tree) = node.pixels.get(node.begun) else { return self.ask_or_end(task, now) };
                node.begun += 1;
                node.rays = self.graph.tree(tree as usize);
                node.next = Next::Ray;
                Act::Work(PIXELS, machine.costs.pixel, PIXEL)
            }
            Next::AwaitsTile => Act::Receive(Sender::Anyone, WAITING),
            Next::GetsTile(None) => self.end(task, now),
            Next::GetsTile(Some(tile)) => {
                node.pixels = std::mem::take(&mut self.host.tiles[tile as usize]);
                node.begun = 0;
                node.waits = false;
                node.next = Next::Begins;
                self.seen.nodes[task].pixels += node.pixels.len();
                self.node(task, now, None)
            }
            Next::Ray if node.rays.is_empty() => self.end_pixel(task, now),
            Next::Ray => {
                node.read = 0;
                node.next = Next::Starts;
                Act::Work(SERVING, std::mem::take(&mut node.owes), SERVE)
            }
            Next::Starts => {
                node.next = Next::Reads;
                Act::Begin(node.rays.start)
            }
            Next::Reads => self.read(task),
            Next::Asks(home) => {
                node.next = Next::Awaits;
                node.waits = true;
                self.seen.nodes[task].pages += 1;
                // The request goes to the home's helper.
                let to = self.nodes.len() + 1 + usize::from(home);
                let note = PageNote::Wants(task as u16);
                let time = machine.messages.of(TOKEN_BYTES);
                self.send((task, to), (MessageKind::Information, TOKEN_BYTES), time, note)
            }
            Next::Awaits => {
                node.next = Next::Gets;
                Act::Receive(Sender::Anyone, WAITING_PAGE)
            }
            Next::Gets => {
                node.waits = false;
                node.next = Next::Reads;
                let bytes = PAGE_HEAD_BYTES + u64::from(self.uses.page_bytes);
                Act::Work(RECEIVING, self.took(MessageKind::RealObject, bytes), takes(MessageKind::RealObject))
            }
            Next::Works if self.explains && !node.has_told => {
                node.has_told = true;
                Act::Work(GRID, Cycles(0), Work::Piece(node.rays.start))
            }
            Next::Works => {
                node.has_told = false;
                node.next = Next::Worked;
                let time = self.graph.time_in_one(node.rays.start, &machine.times);
                Act::SpendEach([
                    (GRID, time.grid),
                    (SLABS, time.slabs),
                    (INTERSECTION, time.intersection),
                    (SHADING, time.shading),
                    (SHADING, Cycles(0)),
                ])
            }
            Next::Worked => {
                node.rays.start += 1;
                node.next = Next::Ray;
                self.seen.nodes[task].legs += 1;
                Act::Done
            }
            Next::Ends => Act::End,
        }
    }

    /// Reads the pages of a ray, until one is missing or all are read.
    fn read(&mut self, task: usize) -> Act<PageNote> {
        let count = self.nodes.len() as u32;
        let node = &mut self.nodes[task];
        let pages = self.uses.of_ray(node.rays.start);
        let mut lookups = 0u64;
        node.next = Next::Works;
        while let Some(&(page, reads)) = pages.get(node.read) {
            node.read += 1;
            let home = page % count;
            if home as usize == task {
                continue;
            }
            lookups += u64::from(reads);
            if !node.cache.read(page) {
                node.next = Next::Asks(home as u16);
                break;
            }
        }
        Act::Work(LOOKUP, Cycles(lookups * self.machine.costs.lookup.0), LOOK_UP)
    }

    fn end_pixel(&mut self, task: usize, now: Cycles) -> Act<PageNote> {
        self.seen.true_end = now;
        let node = &mut self.nodes[task];
        node.next = Next::Begins;
        node.packet += 1;
        if node.packet < PACKET_PIXELS && node.begun < node.pixels.len() {
            return self.node(task, now, None);
        }
        let count = std::mem::take(&mut node.packet);
        let (host, bytes) = (self.nodes.len(), packet_bytes(count));
        let time = self.machine.messages.of(bytes);
        self.send((task, host), (MessageKind::Calculation, bytes), time, PageNote::Pixels(count))
    }

    /// A node that has no pixels left asks the host for more, if that has them all.
    fn ask_or_end(&mut self, task: usize, now: Cycles) -> Act<PageNote> {
        if self.host.untold == 0 {
            return self.end(task, now);
        }
        let node = &mut self.nodes[task];
        node.next = Next::AwaitsTile;
        node.waits = true;
        let (host, time) = (self.nodes.len(), self.machine.messages.of(TOKEN_BYTES));
        self.send((task, host), (MessageKind::Information, TOKEN_BYTES), time, PageNote::Asks(task as u16))
    }

    fn end(&mut self, task: usize, now: Cycles) -> Act<PageNote> {
        self.at_work -= 1;
        let node = &mut self.nodes[task];
        node.next = Next::Ends;
        node.waits = true;
        node.rests = Some(now);
        Act::End
    }

    fn send(
        &mut self,
        (from, to): (usize, usize),
        (kind, bytes): (MessageKind, u64),
        time: Cycles,
        content: PageNote,
    ) -> Act<PageNote> {
        self.seen.send(&self.cube, (from, to), (kind, bytes), time);
        Act::Send(Message { delivery: Delivery::Post(to), time, bytes, content })
    }

    fn took(&mut self, kind: MessageKind, bytes: u64) -> Cycles {
        let time = self.machine.messages.of(bytes);
        self.seen.messages[kind as usize].take(time);
        time
    }
}

impl Node {
    fn new(pixels: Vec<u32>, cache: Lru) -> Node {
        Node {
            next: Next::Begins,
            pixels,
            begun: 0,
            packet: 0,
            cache,
            rays: 0..0,
            has_told: false,
            read: 0,
            owes: Cycles(0),
            waits: false,
            rests: None,
            serves: None,
        }
    }
}
