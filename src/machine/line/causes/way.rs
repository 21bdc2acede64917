//! The way back from some points, through the ops since the last reckoning.

use super::waits::{Wait, Waits, last_before};
use super::window::{NOW, Past, Point};
use super::{Stand, Station};
use crate::machine::chains::{Chains, Code};
use crate::seam::{Op, OpKind};

/// All points since the last reckoning that some points lead back to.
pub(super) struct Way<'a> {
    past: &'a Past<'a>,
    stations: &'a [Station],
    /// The points of earlier times, with their nodes.
    before: &'a [(Point, u32)],
    reached: Vec<Reached<'a>>,
    /// For each station, the node of its first point.
    first: Vec<u32>,
}

impl<'a> Way<'a> {
    /// The way back from `live` points. The nodes of the points on it are numbered from `next` on.
    pub fn new(
        past: &'a Past<'a>,
        stations: &'a [Station],
        (before, mut next): (&'a [(Point, u32)], u32),
        live: &[Point],
    ) -> Way<'a> {
        let mut reached: Vec<Reached<'_>> = stations.iter().map(|station| Reached::new(&station.waits)).collect();
        let mut todo = live.to_vec();
        while let Some((station, cycle)) = todo.pop() {
            if cycle < stations[station].start.clock {
                continue;
            }
            if let Some(wait) = reached[station].come_to(cycle) {
                todo.push(past.crossing(station, &stations[station].waits[wait.row], wait.number).from);
            }
        }
        let mut first = Vec::with_capacity(reached.len());
        for station in &mut reached {
            // They mostly came one before the other, which this sort makes use of.
            station.cycles.sort();
            station.cycles.dedup();
            first.push(next);
            next += station.cycles.len() as u32;
        }
        Way { past, stations, before, reached, first }
    }

    /// The node of a point.
    pub fn node_of(&self, (station, cycle): Point) -> u32 {
        if cycle < self.stations[station].start.clock {
            return self.node_before((station, cycle));
        }
        let place = self.reached[station].cycles.partition_point(|&other| other < cycle);
        self.first[station] + place as u32
    }

    /// The node of a point of an earlier time.
    fn node_before(&self, point: Point) -> u32 {
        let found = self.before.binary_search_by_key(&point, |entry| entry.0);
        debug_assert!(found.is_ok(), "nothing can follow from {point:?}");
        found.map_or(0, |place| self.before[place].1)
    }

    /// Adds the points to the chains, each with what lies between it and the one that it follows from. What leads to a point
    /// that only the next one of its station follows from is left to that.
    pub fn enter(&self, live: &[Point], chains: &mut Chains) {
        let (first, parents) = (chains.len(), self.parents());
        let mut followers = vec![0u32; parents.len()];
        let of_new = |node: u32| node.checked_sub(first).map(|place| place as usize);
        parents.iter().filter_map(|&parent| of_new(parent)).for_each(|place| followers[place] += 1);
        live.iter().filter_map(|&point| of_new(self.node_of(point))).for_each(|place| followers[place] += 2);
        for (station, reached) in self.reached.iter().enumerate() {
            let mut walk = Walk { past: self.past, station, at: self.stations[station].start };
            let mut behind = None;
            for (place, (&cycle, last)) in reached.points().enumerate() {
                let node = self.first[station] + place as u32;
                if let Some(Wait { row, number }) = last.filter(|_| behind != Some(last)) {
                    self.past.crossing(station, &reached.waits[row], number).enter(chains);
                    walk.at = reached.waits[row].stand(number);
                }
                behind = Some(last);
                walk.go(cycle, chains);
                let here = (node - first) as usize;
                let goes_on = place + 1 < reached.cycles.len() && followers[here] == 1 && parents[here + 1] == node;
                chains.push(parents[here], goes_on);
            }
        }
    }

    /// The points that those follow from, as nodes.
    fn parents(&self) -> Vec<u32> {
        let mut parents = Vec::with_capacity(self.reached.iter().map(|reached| reached.cycles.len()).sum());
        for (station, reached) in self.reached.iter().enumerate() {
            let mut behind = None;
            for (place, (_, last)) in reached.points().enumerate() {
                parents.push(match last {
                    _ if behind == Some(last) => self.first[station] + place as u32 - 1,
                    None => self.node_before((station, NOW)),
                    Some(Wait { row, number }) => {
                        self.node_of(self.past.crossing(station, &reached.waits[row], number).from)
                    }
                });
                behind = Some(last);
            }
        }
        parents
    }
}

/// The waits of one station in the window, and its points that chains lead through.
struct Reached<'a> {
    waits: &'a [Waits],
    /// Whether the way that begins behind a row of waits has been come to; the first begins with the window.
    seen: Vec<bool>,
    cycles: Vec<u64>,
    /// Behind the row that was found last.
    near: usize,
}

impl<'a> Reached<'a> {
    fn new(waits: &'a [Waits]) -> Reached<'a> {
        Reached { waits, seen: vec![false; waits.len() + 1], cycles: Vec::new(), near: waits.len() }
    }

    /// The points in order, each with the wait before it.
    fn points(&self) -> impl Iterator<Item = (&u64, Option<Wait>)> {
        let mut rows = 0;
        self.cycles.iter().map(move |cycle| {
            while self.waits.get(rows).is_some_and(|row| row.first() <= *cycle) {
                rows += 1;
            }
            let number = |row: usize| self.waits[row].last_before(*cycle);
            (cycle, rows.checked_sub(1).map(|row| Wait { row, number: number(row) }))
        })
    }

    /// Comes to a point. Returns the wait before it, if no point behind that has been come to (inside a row it may have been).
    fn come_to(&mut self, cycle: u64) -> Option<Wait> {
        self.cycles.push(cycle);
        let last = last_before(self.waits, cycle, self.near);
        self.near = last.map_or(0, |wait| wait.row + 1);
        let Some(wait) = last else {
            self.seen[0] = true;
            return None;
        };
        let is_last = wait.number + 1 == self.waits[wait.row].count();
        let is_new = !is_last || !std::mem::replace(&mut self.seen[wait.row + 1], true);
        is_new.then_some(wait)
    }
}

/// Goes through the ops of one station from a wait to the next, between which no cycle is lost.
pub(super) struct Walk<'a> {
    pub past: &'a Past<'a>,
    pub station: usize,
    pub at: Stand,
}

impl Walk<'_> {
    /// The op that it is at, and how many cycles each of its units or words takes. It comes to the next batch if there is none
    /// left in this one; `None` behind the last that is known.
    pub fn op(&mut self) -> Option<(Op, u64)> {
        loop {
            if let Some(&op) = self.past.ops(self.station, self.at.batch).get(self.at.op) {
                let each = match op.kind() {
                    OpKind::Work(unit) => self.past.prices.of(unit).0,
                    OpKind::Await => 0,
                    _ => 1,
                };
                return Some((op, each));
            }
            if self.at.batch >= self.past.stands[self.station].batch {
                return None;
            }
            self.at = Stand { batch: self.at.batch + 1, op: 0, ..self.at };
        }
    }

    /// What is left of the op that it is at.
    pub fn left(&self, op: Op) -> u64 {
        if self.at.left > 0 { self.at.left } else { op.count() as u64 }
    }

    /// Goes on to the next op, so many cycles later.
    pub fn skip(&mut self, cycles: u64) {
        self.at = Stand { op: self.at.op + 1, left: 0, clock: self.at.clock + cycles, ..self.at };
    }

    /// Goes on to the beginning of cycle `until`, in which the station moves a word, or to where it stands now.
    fn go(&mut self, until: u64, chains: &mut Chains) {
        let end = self.past.stands[self.station];
        chains.pen.turn_to(self.station);
        loop {
            self.work(end, chains);
            let Some((op, each)) = self.op() else { return };
            let is_last = (self.at.batch, self.at.op) == (end.batch, end.op);
            if is_last && end.left == 0 {
                return;
            }
            let left = self.left(op);
            let known = if is_last { left.saturating_sub(end.left) } else { left };
            let (code, done) = match op.kind() {
                OpKind::Work(unit) => (Some(Code::work(unit)), known),
                OpKind::Await => (None, known),
                _ => (Some(Code::MOVE), known.min(until.saturating_sub(self.at.clock))),
            };
            if let Some(code) = code {
                chains.pen.add(code, self.at.clock, done * each, done);
            }
            if is_last || done < known {
                self.at = Stand { left: left - done, clock: self.at.clock + done * each, ..self.at };
                return;
            }
            self.skip(done * each);
        }
    }

    /// Goes through ops of one batch that are work, as long as one follows the other: most are.
    fn work(&mut self, end: Stand, chains: &mut Chains) {
        let ops = self.past.ops(self.station, self.at.batch);
        let last = if self.at.batch == end.batch { end.op.min(ops.len()) } else { ops.len() };
        let Stand { mut op, mut clock, .. } = self.at;
        while op < last
            && let Some(unit) = ops[op].unit()
        {
            let count = ops[op].count() as u64;
            let cycles = count * self.past.prices.of(unit).0;
            chains.pen.add(Code::work(unit), clock, cycles, count);
            clock += cycles;
            op += 1;
        }
        if op > self.at.op {
            self.at = Stand { op, clock, left: 0, ..self.at };
        }
    }
}
