//! §4.2: when messages pass along a row of cells, and so how long a run takes.
//!
//! Each cell does its steps one after the other: it works, then takes a message or sends one. A message begins to move when
//!
//! - its cell has done the step before,
//! - what it takes has been sent,
//! - where it sends, what was sent a FIFO's depth earlier has been taken:
//!
//! ```text
//! first(step) = max( last(step before) + work,  sent(first word),  taken(first word - depth) )
//! last(step)  = max( first(step) + words - 1,   sent(last word),   taken(last word - depth)  )
//! ```
//!
//! For cells that all do a ray's whole work W(r, k), begin it with the ray's message and end it with the hit's, that is the heaviest
//! path through the table W that may step to the next ray, to the right neighbour, and to the left one at the price of as many rays as
//! the FIFO between them holds: last-passage percolation. Rays of neighbouring pixels put their weight in the same columns, which such
//! paths collect.
//!
//! It is a bound from below, of which only what holds up the words inside a message is missing.

use std::collections::VecDeque;

use crate::seam::{Channel, Costs, OpBatch, OpKind, OpStream};

/// What the FIFOs and links of a row let pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Fifos {
    /// Words that the FIFOs on X, Y and Z hold, of the link into each cell from left to right.
    pub words: Vec<[u64; 3]>,
    /// Cycles from the sending of a word to its first taking.
    pub latency: u64,
    /// Cycles from one word to the next.
    pub cycles_per_word: u64,
    /// Whether X and Y share that rate.
    pub shared: bool,
}

impl Fifos {
    /// The same with so many words of each on X and on Y.
    pub fn with(&self, x: u64, y: u64) -> Fifos {
        Fifos { words: self.words.iter().map(|words| [x, y, words[2]]).collect(), ..*self }
    }
}

/// What a cell does in one go: it works, and then moves a message.
#[derive(Clone, Copy, Debug, Default)]
struct Step {
    work: u64,
    takes: Option<Channel>,
    sends: Option<Channel>,
    words: u32,
}

/// What the host, or a cell, does for each ray.
#[derive(Clone, Debug, Default)]
struct Steps {
    steps: Vec<Step>,
    /// Where those for each ray end.
    ends: Vec<usize>,
}

impl Steps {
    /// Adds lines of a stream. The last cell passes no rays on.
    fn take(&mut self, stream: &OpStream, costs: &Costs, is_last: bool) {
        for (_, ops) in stream.lines() {
            let mut step = Step::default();
            for op in ops {
                let kind = op.kind();
                if let Some(unit) = op.unit() {
                    step.work += costs.of(unit).0 * u64::from(op.count());
                } else if kind != OpKind::Await {
                    let sends = kind.writes().filter(|&channel| !(is_last && channel == Channel::X));
                    self.steps.push(Step { takes: kind.reads(), sends, words: op.count(), ..step });
                    step = Step::default();
                }
            }
            if step.work > 0 {
                self.steps.push(step);
            }
            self.ends.push(self.steps.len());
        }
    }

    fn of_ray(&self, ray: usize) -> &[Step] {
        let from = ray.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.steps[from..self.ends[ray]]
    }

    /// The most words that it moves for any ray.
    fn most_words(&self) -> u64 {
        let words = |ray| self.of_ray(ray).iter().map(|step| u64::from(step.words)).sum();
        (0..self.ends.len()).map(words).max().unwrap_or(0)
    }

    /// What it has to do for a ray: its work, and moving words, of which those that it sends are so far apart.
    fn work(&self, ray: usize, cycles_per_word: u64) -> u64 {
        let gap = |step: &Step| if step.sends.is_some() { cycles_per_word } else { 1 };
        let moves = |step: &Step| if step.words > 0 { 1 + u64::from(step.words - 1) * gap(step) } else { 0 };
        self.of_ray(ray).iter().map(|step| step.work + moves(step)).sum()
    }

    /// The words that it sends on a channel for a ray.
    fn sent(&self, ray: usize, channel: Channel) -> u64 {
        let sends = |step: &&Step| step.sends == Some(channel);
        self.of_ray(ray).iter().filter(sends).map(|step| u64::from(step.words)).sum()
    }
}

/// What the host and each cell of a row do for some rays.
#[derive(Clone, Debug)]
pub struct Passage {
    /// The host, then the cells from left to right.
    actors: Vec<Steps>,
}

impl Passage {
    /// Of no ray yet, in a row of so many cells.
    pub fn new(cells: usize) -> Passage {
        Passage { actors: vec![Steps::default(); cells + 1] }
    }

    /// Adds the next rays: what is done for them, by what it costs.
    pub fn take(&mut self, batch: &OpBatch, costs: &Costs) {
        let (streams, last) = (std::iter::once(&batch.host).chain(&batch.cells), batch.cells.len());
        let actors = self.actors.iter_mut().zip(streams).enumerate();
        actors.for_each(|(place, (actor, stream))| actor.take(stream, costs, place == last));
    }

    /// How many rays there are.
    pub fn rays(&self) -> usize {
        self.actors[0].ends.len()
    }

    /// What the busiest of the host, the cells and the links has to do for rays in such an order: no run of them is shorter.
    pub fn bound(&self, order: &[u32], fifos: &Fifos) -> u64 {
        let gap = fifos.cycles_per_word;
        let sum = |of: &dyn Fn(usize) -> u64| order.iter().map(|&ray| of(ray as usize)).sum::<u64>();
        let busy = |actor: &Steps| {
            let [x, y] = [Channel::X, Channel::Y].map(|channel| sum(&|ray| actor.sent(ray, channel)));
            let carried = if fifos.shared { x + y } else { x.max(y) };
            sum(&|ray| actor.work(ray, gap)).max(carried * gap)
        };
        self.actors.iter().map(busy).max().unwrap_or(0)
    }

    /// The cycles that the rays take in such an order, each by its number and as often as it stands there. `None` if they take more
    /// than `most`, or never come to an end.
    pub fn cycles(&self, order: &[u32], fifos: &Fifos, most: u64) -> Option<u64> {
        let mut row = Row::new(self, fifos, order.len());
        let mut from = 0;
        while from < order.len() {
            from = order.len().min(from + RAYS_AT_ONCE);
            while row.sweep(&order[..from]) {}
            if row.end() > most {
                return None;
            }
        }
        row.is_done(order.len()).then(|| row.end())
    }
}

/// Rays that are fed at once, so that not all that passes must be remembered.
const RAYS_AT_ONCE: usize = 256;

/// A row at work.
struct Row<'a> {
    fifos: &'a Fifos,
    actors: Vec<Actor<'a>>,
    links: Vec<[Fifo; 3]>,
    /// When the last word went back to the host.
    returned: Option<u64>,
    /// Words that move at once. With no more than half of what the FIFOs hold nobody waits for what waits for him.
    at_once: u64,
}

/// The host or a cell, and how far it is.
struct Actor<'a> {
    steps: &'a Steps,
    /// Its place in the order, and the step of that ray.
    at: usize,
    step: usize,
    /// Words that have moved of the step's message.
    moved: u64,
    /// The first cycle that it has not spent.
    clock: u64,
    /// The first cycle in which its links take another word of X, Y and Z.
    link_free: [u64; 3],
}

impl Actor<'_> {
    /// Its link takes no other word of a channel, or of X and Y, before a cycle.
    fn occupy(&mut self, channel: usize, until: u64, shared: bool) {
        self.link_free[channel] = until;
        if shared && channel != Channel::Z as usize {
            (self.link_free[Channel::X as usize], self.link_free[Channel::Y as usize]) = (until, until);
        }
    }
}

impl<'a> Row<'a> {
    fn new(passage: &'a Passage, fifos: &'a Fifos, rays: usize) -> Row<'a> {
        let actor = |steps: &'a Steps| Actor { steps, at: 0, step: 0, moved: 0, clock: 0, link_free: [0; 3] };
        let most_of_ray = passage.actors.iter().map(Steps::most_words).max().unwrap_or(0);
        let fifo = |&words: &u64| Fifo {
            depth: (words < most_of_ray.saturating_mul(rays as u64)).then_some(words),
            ..Fifo::default()
        };
        let links = fifos.words.iter().map(|words| words.each_ref().map(fifo)).chain([Default::default()]);
        let least = fifos.words.iter().flatten().copied().min().unwrap_or(1);
        Row {
            fifos,
            actors: passage.actors.iter().map(actor).collect(),
            links: links.collect(),
            returned: None,
            at_once: least.div_ceil(2).max(1),
        }
    }

    /// Lets each go on as far as it can, from left to right. Whether anything moved.
    fn sweep(&mut self, order: &[u32]) -> bool {
        (0..self.actors.len()).fold(false, |moved, actor| self.run(actor, order) | moved)
    }

    /// Lets an actor go on as far as it can.
    fn run(&mut self, actor: usize, order: &[u32]) -> bool {
        let mut moved = false;
        while let Some(&ray) = order.get(self.actors[actor].at) {
            let steps = self.actors[actor].steps.of_ray(ray as usize);
            while let Some(step) = steps.get(self.actors[actor].step) {
                if !self.step(actor, step) {
                    return moved;
                }
                moved = true;
            }
            let actor = &mut self.actors[actor];
            (actor.at, actor.step) = (actor.at + 1, 0);
        }
        moved
    }

    /// Does a step, or a part of its message, if it is known when.
    fn step(&mut self, actor: usize, step: &Step) -> bool {
        let now = &self.actors[actor];
        let words = (u64::from(step.words) - now.moved).min(self.at_once);
        let last_link = self.links.len() - 1;
        // What the actor numbered n, cell n - 1, has to its left is link n - 1.
        let place = |channel: Channel, goes_on: bool| {
            (actor - usize::from((channel == Channel::Z) == goes_on), channel as usize)
        };
        let takes = step.takes.map(|channel| place(channel, false));
        let sends = step.sends.map(|channel| place(channel, true));
        let is_known = takes.is_none_or(|(link, channel)| self.links[link][channel].can_take(words))
            && sends.is_none_or(|(link, channel)| self.links[link][channel].can_send(words));
        if !is_known {
            return false;
        }
        let work = if now.moved == 0 { step.work } else { 0 };
        let (mut first, mut last, mut gap) = (now.clock + work, 0, 1);
        if let Some((link, channel)) = takes {
            let sent = self.links[link][channel].next_sent(words);
            (first, last) = (first.max(sent.0 + self.fifos.latency), sent.1 + self.fifos.latency);
        }
        if let Some((link, channel)) = sends {
            let room = self.links[link][channel].next_room(words);
            (first, last) = (first.max(room.0).max(now.link_free[channel]), last.max(room.1));
            gap = self.fifos.cycles_per_word;
        }
        let last = last.max(first + words.saturating_sub(1) * gap);
        let span = Span { first, last, words };
        if let Some((link, channel)) = takes {
            self.links[link][channel].take(span);
        }
        if let Some((link, channel)) = sends {
            // What goes back to the host it takes at once.
            if link == last_link {
                self.returned = Some(last);
            } else {
                self.links[link][channel].send(span);
            }
            self.actors[actor].occupy(channel, last + gap, self.fifos.shared);
        }
        let now = &mut self.actors[actor];
        now.clock = if words > 0 { last + 1 } else { first };
        now.moved += words;
        if now.moved == u64::from(step.words) {
            (now.moved, now.step) = (0, now.step + 1);
        }
        true
    }

    /// The cycle after the one in which the host takes the last word so far.
    fn end(&self) -> u64 {
        self.returned.map_or(0, |sent| sent + self.fifos.latency + 1)
    }

    /// Whether all have done all.
    fn is_done(&self, rays: usize) -> bool {
        self.actors.iter().all(|actor| actor.at == rays)
    }
}

/// A FIFO, by the times at which words were sent to it and taken from it.
#[derive(Clone, Debug, Default)]
struct Fifo {
    /// `None` if it holds all there is.
    depth: Option<u64>,
    sent: Times,
    taken: Times,
}

impl Fifo {
    /// Whether it is known when the next words can be taken.
    fn can_take(&self, words: u64) -> bool {
        self.taken.words + words <= self.sent.words
    }

    /// Whether it is known when there is room for the next words.
    fn can_send(&self, words: u64) -> bool {
        self.depth.is_none_or(|depth| self.sent.words + words <= self.taken.words + depth)
    }

    /// When the next so many words were sent: the first and the last.
    fn next_sent(&mut self, words: u64) -> (u64, u64) {
        let next = self.taken.words;
        (self.sent.of(next), self.sent.of(next + words - 1))
    }

    /// When there is room for the next so many words: for the first and the last.
    fn next_room(&mut self, words: u64) -> (u64, u64) {
        let (Some(depth), next) = (self.depth, self.sent.words) else { return (0, 0) };
        let mut room = |word: u64| word.checked_sub(depth).map_or(0, |taken| self.taken.of(taken) + 1);
        (room(next), room(next + words - 1))
    }

    fn send(&mut self, span: Span) {
        self.sent.add(span);
    }

    fn take(&mut self, span: Span) {
        match self.depth {
            Some(_) => self.taken.add(span),
            None => self.taken.words += span.words,
        }
    }
}

/// Some words that moved one after the other: the cycles of the first and of the last.
#[derive(Clone, Copy, Debug)]
struct Span {
    first: u64,
    last: u64,
    words: u64,
}

/// When words moved, as far back as somebody may ask.
#[derive(Clone, Debug, Default)]
struct Times {
    /// Words that have moved.
    words: u64,
    /// The number of the first word of each span, and the span.
    spans: VecDeque<(u64, Span)>,
}

impl Times {
    fn add(&mut self, span: Span) {
        self.spans.push_back((self.words, span));
        self.words += span.words;
    }

    /// When a word moved, at the earliest: exactly, if it is the first or the last of its span. Those before it are forgotten.
    fn of(&mut self, word: u64) -> u64 {
        while let Some((start, span)) = self.spans.front() {
            match word - start {
                within if within + 1 < span.words => return span.first + within,
                within if within + 1 == span.words => return span.last,
                _ => self.spans.pop_front(),
            };
        }
        0
    }
}
