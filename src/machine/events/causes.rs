//! Finds why the tasks took as long as they did: the chain of causes that ends with the last thing that was done.
//!
//! A task goes on at the latest of a few times: when it has done what it was at, when the message arrives that it waits for, when
//! its own message is taken, when another wakes it. A message sets out when it is ready and its bus is free. So each of these
//! follows from the one that was last, and of times that are equal from the task's own doing, or the message's own sender.
//! Whoever was waited for was at work itself or waited for another, so that each cycle of a chain is work, or a message on its way.

use std::sync::Arc;

use super::engine::{Explanation, Work};
use super::mailbox::Mail;
use super::network::Passage;
use crate::machine::chains::{Chains, Code, Entry};
use crate::machine::timeline::bins_for;
use crate::measure::{Actor, Cause, CriticalPath, PathPart, Topology};
use crate::quantities::Cycles;
use crate::seam::Unit;

/// Points that are added before those are forgotten that nothing can follow from any more, for each of those that are left at the
/// least.
const POINTS_PER_LIVE: u32 = 4;
/// And so many at the least.
const FEW_POINTS: u32 = 1 << 14;

/// Follows the causes of what all tasks do.
#[derive(Debug)]
pub(super) struct Causes {
    chains: Chains,
    /// Where each task stands: when it has done, or been given, what it goes on from.
    tasks: Vec<Point>,
    /// When each bus or link is free, and by what.
    links: Vec<Point>,
    explanation: Explanation,
    most_points: u32,
}

/// A time, and the chain that ends there, by the number of its last point.
#[derive(Clone, Copy, Debug, Default)]
struct Point {
    at: u64,
    chain: u32,
}

impl Point {
    /// The later of two, and of two at one time the first.
    fn or_later(self, other: Point) -> Point {
        if other.at > self.at { other } else { self }
    }
}

impl Causes {
    pub fn new(tasks: usize, links: usize, explanation: Explanation) -> Causes {
        Causes {
            chains: Chains::new(bins_for(tasks) as u64),
            tasks: vec![Point::default(); tasks],
            links: vec![Point::default(); links],
            explanation,
            most_points: FEW_POINTS,
        }
    }

    /// A point some cycles after another, which a task spent on so many units of something.
    fn add(&mut self, from: Point, task: usize, (unit, count): (Unit, u32), cycles: u64) -> Point {
        let at = from.at + cycles;
        self.chains.reach(at);
        self.chains.pen.turn_to(task);
        self.chains.pen.add(Code::work(unit), from.at, cycles, u64::from(count));
        let chain = self.chains.len();
        self.chains.push(from.chain, false);
        Point { at, chain }
    }

    /// A task works.
    pub fn work(&mut self, task: usize, cycles: Cycles, work: Work) {
        match work {
            Work::Unit(unit) => self.tasks[task] = self.add(self.tasks[task], task, (unit, 1), cycles.0),
            Work::Piece(piece) => {
                let Some(&counts) = self.explanation.pieces.get(piece as usize) else { return };
                for (unit, count) in counts.into_iter().enumerate().filter(|(_, count)| *count > 0) {
                    let cycles = u64::from(count) * self.explanation.units[unit].cycles.0;
                    self.tasks[task] = self.add(self.tasks[task], task, (Unit(unit as u8), count), cycles);
                }
            }
        }
    }

    /// A message that a task has made passes, by way of some links. Returns its chain.
    pub fn carry(&mut self, task: usize, passage: &Passage, links: &[usize]) -> u32 {
        let sets_out = links.iter().fold(self.tasks[task], |point, &link| point.or_later(self.links[link]));
        let [holds, on_its_way] = self.explanation.carrying;
        let free = self.add(sets_out, task, (holds, 1), passage.free - passage.starts);
        links.iter().for_each(|&link| self.links[link] = free);
        match passage.arrives - passage.free {
            0 => free.chain,
            rest => self.add(free, task, (on_its_way, 1), rest).chain,
        }
    }

    /// A task takes a message, whose sender may have waited for that.
    pub fn taken<M>(&mut self, task: usize, mail: &Mail<M>) {
        let arrival = Point { at: mail.at, chain: mail.cause };
        self.tasks[task] = self.tasks[task].or_later(arrival);
        if mail.is_held {
            self.tasks[mail.from] = arrival.or_later(self.tasks[task]);
        }
    }

    /// A task is woken by another.
    pub fn woken(&mut self, task: usize, waker: usize) {
        self.tasks[task] = self.tasks[task].or_later(self.tasks[waker]);
    }

    /// Whether it is time to reckon.
    pub fn is_full(&self) -> bool {
        self.chains.len() > self.most_points
    }

    /// Forgets what nothing can follow from any more. `mails` are the chains of all messages that nobody has taken yet.
    pub fn reckon<'a>(&'a mut self, mails: impl Iterator<Item = &'a mut u32>) {
        let own = self.tasks.iter_mut().chain(&mut self.links).map(|point| &mut point.chain);
        let live: Vec<&mut u32> = own.chain(mails).collect();
        let old: Vec<u32> = live.iter().map(|chain| **chain).collect();
        let new = self.chains.keep(&old);
        live.into_iter().zip(new).for_each(|(chain, new)| *chain = new);
        self.most_points = FEW_POINTS + POINTS_PER_LIVE * self.chains.len();
    }

    /// The path of a run of so many cycles, which is over: it ends with the task that did something last, and of several that with the
    /// lowest number.
    pub fn finish(mut self, topology: &Arc<Topology>, cycles: u64) -> CriticalPath {
        let last = self.tasks.iter().copied().reduce(Point::or_later).unwrap_or_default();
        self.chains.reach(cycles);
        self.chains.keep(&[last.chain]);
        let (entries, bin) = self.chains.into_settled();
        let mut bins = vec![Vec::new(); cycles.div_ceil(bin) as usize];
        let part = |entry: &Entry| PathPart {
            at: Actor::Station(entry.station()),
            cause: Cause::Work(entry.code().0.into()),
            cycles: Cycles(entry.cycles),
            count: entry.count,
        };
        for entry in &entries {
            // What takes no time at the end of the run is told in its last bin.
            let bin = entry.bin().min(bins.len().saturating_sub(1));
            bins.get_mut(bin).into_iter().for_each(|bin: &mut Vec<PathPart>| bin.push(part(entry)));
        }
        let topology = Arc::clone(topology);
        CriticalPath { topology, cycles: Cycles(cycles), units: self.explanation.units, bin: Cycles(bin), bins }
    }
}
