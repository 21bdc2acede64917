//! The host and the array in a closed loop: a ray is sent only after the hit that asks for it has come back.
//!
//! The host does one thing after the other, on a clock of its own. Over and over, it
//!
//! 1. takes the hits that have come back by now, in order, and spends its time on each one that is shaded; then the rays
//!    that the hit asks for may be sent;
//! 2. sends one ray that may be sent, chosen by its [`Policy`], after spending its time on it; or waits for the next
//!    hit, if there is no such ray or the limit on rays in flight is reached.
//!
//! A sample that adaptive sampling adds may be begun once the hits that asked for it have come back, as early as that:
//! while the last rays of the first pass are still under way. Samples are begun in order, and hits come back in the order
//! of their rays, so that one number says which samples' first hits are known.
//!
//! Each ray is handed to the array by itself and its return worked out before the next choice, so that the host knows of
//! just those hits that have come back on its clock. Its choices are written as ops (`a`, `c`, `w`): the trace that they
//! make replays to the same times.

use std::collections::VecDeque;

use super::trees::{ByKind, TreeBatch};
use crate::geometry::Hit;
use crate::host::policy::{HostRules, Policy};
use crate::host::shading::RayKind;
use crate::machine::{Array, Cycles, HostTimes, Stuck};
use crate::program::work::HOST_HIT;
use crate::program::{Workload, send_ray};
use crate::seam::{BatchError, OpBatch, OpKind, OpStream};

/// A ray: its batch, counted from the start of the run, and its number in it.
#[derive(Clone, Copy, Debug)]
struct RayPlace {
    batch: usize,
    ray: u32,
}

/// A batch of trees under way.
#[derive(Debug)]
struct Begun {
    trees: TreeBatch,
    /// How many rays of each tree have not come back.
    left: Vec<u32>,
    trees_left: usize,
}

/// The host at work.
pub(super) struct ClosedLoop {
    array: Array,
    cells: usize,
    /// What the cells do before the first ray, until it is sent.
    opening: Option<OpBatch>,
    rules: HostRules,
    times: HostTimes,
    clock: u64,
    /// What it has done since the last ray that it sent.
    ops: OpStream,
    sent: u64,
    /// The number of the next hit to be taken.
    taken: u64,
    in_flight: VecDeque<RayPlace>,
    /// Rays that may be sent; by generation if the policy asks for it, else all in the first.
    ready: Vec<VecDeque<(RayPlace, u64)>>,
    batches: VecDeque<Begun>,
    dropped: usize,
    spare: Vec<TreeBatch>,
    /// The next sample to begin: its batch, and its number in it.
    next: (usize, usize),
    open: usize,
    /// How many samples' primary rays have come back, and the number of the last one's hit.
    known: usize,
    last_known: u64,
    /// For each kind, every ray's latency in cycles.
    pub latencies: ByKind<Vec<u64>>,
}

impl ClosedLoop {
    /// The host of an array for a workload.
    pub fn new(array: Array, workload: &Workload, rules: HostRules) -> ClosedLoop {
        let cells = workload.cells();
        ClosedLoop {
            array: array.noting_departures(),
            cells,
            opening: Some(workload.opening()),
            rules,
            times: workload.host_times(),
            clock: 0,
            ops: OpStream::default(),
            sent: 0,
            taken: 0,
            in_flight: VecDeque::new(),
            ready: Vec::new(),
            batches: VecDeque::new(),
            dropped: 0,
            spare: Vec::new(),
            next: (0, 0),
            open: 0,
            known: 0,
            last_known: 0,
            latencies: Default::default(),
        }
    }

    /// Gives the host the next samples, and lets it work as long as it need not know those after them. `observe` sees
    /// each ray that is sent: the ops, and the hit that it will find. Returns a batch that has been done, for its memory.
    pub fn add<E: From<Stuck> + From<BatchError>>(
        &mut self,
        trees: TreeBatch,
        observe: &mut impl FnMut(&OpBatch, &Hit) -> Result<(), E>,
    ) -> Result<TreeBatch, E> {
        let left: Vec<u32> = (0..trees.ends.len()).map(|tree| trees.tree(tree).len() as u32).collect();
        self.batches.push_back(Begun { trees_left: left.len(), left, trees });
        while self.open >= self.rules.open_samples || self.next_sample().is_some() {
            self.step(observe)?;
        }
        self.drop_done();
        Ok(self.spare.pop().unwrap_or_default())
    }

    /// Sends all rays that are left and waits for the last hit.
    pub fn drain<E: From<Stuck> + From<BatchError>>(
        &mut self,
        observe: &mut impl FnMut(&OpBatch, &Hit) -> Result<(), E>,
    ) -> Result<(), E> {
        while self.open > 0 {
            self.step(observe)?;
        }
        Ok(())
    }

    /// The array at work.
    pub fn array(&self) -> &Array {
        &self.array
    }

    /// The array, when all is done.
    pub fn into_array(self) -> Array {
        self.array
    }

    fn step<E: From<Stuck> + From<BatchError>>(
        &mut self,
        observe: &mut impl FnMut(&OpBatch, &Hit) -> Result<(), E>,
    ) -> Result<(), E> {
        self.take_returned();
        let may_send = self.rules.in_flight.is_none_or(|most| (self.in_flight.len() as u64) < most);
        match may_send.then(|| self.choose()).flatten() {
            Some((place, parent)) => self.send(place, parent, observe),
            None if self.open == 0 || self.wait() => Ok(()),
            None => Err(self.array.stuck().into()),
        }
    }

    /// Takes the hits that have come back, with those that come back meanwhile.
    fn take_returned(&mut self) {
        while let Some(returned) = self.array.returned_in(self.taken).filter(|cycle| cycle.0 < self.clock) {
            let Some(place) = self.in_flight.pop_front() else { return };
            let message = self.taken;
            self.taken += 1;
            let begun = &mut self.batches[place.batch - self.dropped];
            let ray = begun.trees.rays[place.ray as usize];
            self.latencies[ray.kind as usize].extend(self.array.next_latency(returned).map(|latency| latency.0));
            if ray.kind == RayKind::Primary {
                self.known += 1;
                self.last_known = message;
            }
            begun.left[ray.tree as usize] -= 1;
            if begun.left[ray.tree as usize] == 0 {
                begun.trees_left -= 1;
                self.open -= 1;
            }
            if ray.shaded && self.times.hit.0 > 0 {
                self.ops.push(OpKind::Await, message);
                self.ops.push(OpKind::Work(HOST_HIT), 1);
                self.clock += self.times.hit.0;
            }
            let by_generation = self.rules.policy == Policy::ByGeneration;
            let queue = if by_generation { ray.generation as usize } else { 0 };
            if self.ready.len() <= queue {
                self.ready.resize_with(queue + 1, VecDeque::new);
            }
            let (first, count) = ray.children;
            let children = (first..first + count).map(|ray| (RayPlace { ray, ..place }, message));
            self.ready[queue].extend(children);
        }
    }

    /// The ray to send next, with a hit that it had to wait for, if it had to.
    fn choose(&mut self) -> Option<(RayPlace, Option<u64>)> {
        match self.rules.policy {
            Policy::SecondariesFirst => self.next_ready().or_else(|| self.begin_sample()),
            Policy::PrimariesFirst | Policy::ByGeneration => self.begin_sample().or_else(|| self.next_ready()),
        }
    }

    fn next_ready(&mut self) -> Option<(RayPlace, Option<u64>)> {
        let (place, parent) = self.ready.iter_mut().find_map(VecDeque::pop_front)?;
        Some((place, Some(parent)))
    }

    /// The next sample that is known: its batch, and its number in it.
    fn next_sample(&self) -> Option<(usize, usize)> {
        let (batch, tree) = self.next;
        let known = |batch: usize| self.batches.get(batch - self.dropped);
        match known(batch)?.left.len() {
            count if tree < count => Some((batch, tree)),
            _ => known(batch + 1).map(|_| (batch + 1, 0)),
        }
    }

    fn begin_sample(&mut self) -> Option<(RayPlace, Option<u64>)> {
        let (batch, tree) = self.next_sample().filter(|_| self.open < self.rules.open_samples)?;
        let trees = &self.batches[batch - self.dropped].trees;
        let decided_by = trees.decided_by[tree];
        if self.known < decided_by {
            return None;
        }
        let ray = trees.tree(tree).start;
        self.next = (batch, tree + 1);
        self.open += 1;
        Some((RayPlace { batch, ray }, (decided_by > 0).then_some(self.last_known)))
    }

    fn send<E: From<Stuck> + From<BatchError>>(
        &mut self,
        place: RayPlace,
        parent: Option<u64>,
        observe: &mut impl FnMut(&OpBatch, &Hit) -> Result<(), E>,
    ) -> Result<(), E> {
        let spare = self.opening.take().or_else(|| self.array.take_spent());
        let mut batch = spare.unwrap_or_else(|| OpBatch::new(self.cells));
        let trees = &self.batches[place.batch - self.dropped].trees;
        // What cannot be waited for any more costs nothing; it ties the ray to its parent under other machines too.
        parent.into_iter().for_each(|message| self.ops.push(OpKind::Await, message));
        let id = self.sent as u32;
        send_ray(&mut self.ops, id);
        batch.host.push_line(id, self.ops.line(0));
        self.ops.clear();
        for (cell, traced) in batch.cells.iter_mut().zip(&trees.traced.ops.cells) {
            cell.push_line(id, traced.line(place.ray as usize));
        }
        observe(&batch, &trees.traced.hits[place.ray as usize])?;
        self.array.feed(batch)?;
        self.array.run()?;
        self.clock = self.array.host_clock().0;
        self.in_flight.push_back(place);
        self.sent += 1;
        Ok(())
    }

    /// Waits until the next hit has come back; false if it never will.
    fn wait(&mut self) -> bool {
        let Some(Cycles(returned)) = self.array.returned_in(self.taken) else { return false };
        self.ops.push(OpKind::Await, self.taken);
        self.clock = self.clock.max(returned + 1);
        true
    }

    fn drop_done(&mut self) {
        while self.batches.front().is_some_and(|begun| begun.trees_left == 0) && self.next.0 > self.dropped {
            let Some(begun) = self.batches.pop_front() else { return };
            self.spare.push(begun.trees);
            self.dropped += 1;
        }
    }
}
