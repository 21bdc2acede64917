//! The host and the array in a closed loop: a ray is sent only after the hit that asks for it has come back.
//!
//! The host does one thing after the other, on a clock of its own. Over and over, it
//!
//! 1. takes the hits that have come back by now, in order, and spends its time on each one that is shaded; then the rays
//!    that the hit asks for may be sent;
//! 2. sends one ray that may be sent, chosen by its [`Policy`], after spending its time on it; or waits for the next
//!    hit, if there is no such ray or the limit on rays in flight is reached. Where it tells by rectangles which samples can hit
//!    anything, it spends its time on each before it begins it, and passes over those that cannot, one at a time.
//!
//! A sample that adaptive sampling adds may be begun once the hits that asked for it have come back, as early as that:
//! while the last rays of the first pass are still under way. Samples are begun in order, and hits come back in the order
//! of their rays, so that one number says which samples' first hits are known: all before the first one whose is still under way.
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
use crate::program::Workload;
use crate::program::work::{HOST_FILTER, HOST_HIT};
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
    /// How many rays the batches before it have.
    before: u32,
}

/// What the host does next.
enum Next {
    /// It sends a ray, with a hit that it had to wait for, if it had to.
    Send(RayPlace, Option<u64>),
    /// It passes over a sample that can hit nothing.
    PassOver,
}

/// The host at work.
pub(super) struct ClosedLoop<'a> {
    array: Array,
    workload: &'a Workload,
    /// Whether it tests samples before it begins them.
    tests_samples: bool,
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
    /// How many rays all batches so far have.
    grown: u32,
    spare: Vec<TreeBatch>,
    /// The next sample to begin: its batch, and its number in it.
    next: (usize, usize),
    open: usize,
    /// How many samples it has begun, those among them that it has passed over.
    begun: usize,
    /// The numbers of the samples whose primary rays are under way.
    awaited: VecDeque<usize>,
    /// The number of the last hit of a primary ray that has come back.
    last_known: Option<u64>,
    /// For each kind, every ray's latency in cycles.
    pub latencies: ByKind<Vec<u64>>,
}

impl<'a> ClosedLoop<'a> {
    /// The host of an array for a workload, which may test samples before it begins them.
    pub fn new(array: Array, workload: &'a Workload, rules: HostRules, tests_samples: bool) -> ClosedLoop<'a> {
        let cells = workload.cells();
        ClosedLoop {
            array: array.noting_departures(),
            workload,
            tests_samples,
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
            grown: 0,
            spare: Vec::new(),
            next: (0, 0),
            open: 0,
            begun: 0,
            awaited: VecDeque::new(),
            last_known: None,
            latencies: Default::default(),
        }
    }

    /// Gives the host the next samples, and lets it work as long as it need not know those after them. `observe` sees
    /// each ray that is sent: the ops, the hit that it will find, and its number among all rays. Returns a batch that has been done, for its memory.
    pub fn add<E: From<Stuck> + From<BatchError>>(
        &mut self,
        trees: TreeBatch,
        observe: &mut impl FnMut(&OpBatch, &Hit, u32) -> Result<(), E>,
    ) -> Result<TreeBatch, E> {
        let left: Vec<u32> = (0..trees.ends.len()).map(|tree| trees.tree(tree).len() as u32).collect();
        let before = self.grown;
        self.grown += trees.rays.len() as u32;
        self.batches.push_back(Begun { trees_left: left.len(), left, trees, before });
        while self.open >= self.rules.open_samples || self.next_sample().is_some() {
            self.step(observe)?;
        }
        self.drop_done();
        Ok(self.spare.pop().unwrap_or_default())
    }

    /// Sends all rays that are left and waits for the last hit.
    pub fn drain<E: From<Stuck> + From<BatchError>>(
        &mut self,
        observe: &mut impl FnMut(&OpBatch, &Hit, u32) -> Result<(), E>,
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
        observe: &mut impl FnMut(&OpBatch, &Hit, u32) -> Result<(), E>,
    ) -> Result<(), E> {
        self.take_returned();
        let may_send = self.rules.in_flight.is_none_or(|most| (self.in_flight.len() as u64) < most);
        match may_send.then(|| self.choose()).flatten() {
            Some(Next::Send(place, parent)) => self.send(place, parent, observe),
            Some(Next::PassOver) => Ok(()),
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
                self.awaited.pop_front();
                self.last_known = Some(message);
            }
            let (first, count) = ray.children;
            let (sent, spared): (Vec<u32>, Vec<u32>) =
                (first..first + count).partition(|&child| begun.trees.rays[child as usize].is_sent);
            begun.left[ray.tree as usize] -= 1 + spared.len() as u32;
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
            self.ready[queue].extend(sent.into_iter().map(|ray| (RayPlace { ray, ..place }, message)));
        }
    }

    /// How many samples from the first one on have primary rays that have come back, or none.
    fn known(&self) -> usize {
        self.awaited.front().copied().unwrap_or(self.begun)
    }

    fn choose(&mut self) -> Option<Next> {
        match self.rules.policy {
            Policy::SecondariesFirst => self.next_ready().or_else(|| self.begin_sample()),
            Policy::PrimariesFirst | Policy::ByGeneration => self.begin_sample().or_else(|| self.next_ready()),
        }
    }

    fn next_ready(&mut self) -> Option<Next> {
        let (place, parent) = self.ready.iter_mut().find_map(VecDeque::pop_front)?;
        Some(Next::Send(place, Some(parent)))
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

    fn begin_sample(&mut self) -> Option<Next> {
        let (batch, tree) = self.next_sample().filter(|_| self.open < self.rules.open_samples)?;
        let trees = &self.batches[batch - self.dropped].trees;
        let decided_by = trees.decided_by[tree];
        if self.known() < decided_by {
            return None;
        }
        let rays = trees.tree(tree);
        self.next = (batch, tree + 1);
        if self.tests_samples {
            self.ops.push(OpKind::Work(HOST_FILTER), 1);
            self.clock += self.times.filter.0;
        }
        self.begun += 1;
        if rays.is_empty() {
            self.batches[batch - self.dropped].trees_left -= 1;
            return Some(Next::PassOver);
        }
        self.awaited.push_back(self.begun - 1);
        self.open += 1;
        let parent = self.last_known.filter(|_| decided_by > 0);
        Some(Next::Send(RayPlace { batch, ray: rays.start }, parent))
    }

    fn send<E: From<Stuck> + From<BatchError>>(
        &mut self,
        place: RayPlace,
        parent: Option<u64>,
        observe: &mut impl FnMut(&OpBatch, &Hit, u32) -> Result<(), E>,
    ) -> Result<(), E> {
        let spare = self.opening.take().or_else(|| self.array.take_spent());
        let mut batch = spare.unwrap_or_else(|| OpBatch::new(self.cells));
        let Begun { trees, before, .. } = &self.batches[place.batch - self.dropped];
        // What cannot be waited for any more costs nothing; it ties the ray to its parent under other machines too.
        parent.into_iter().for_each(|message| self.ops.push(OpKind::Await, message));
        let (id, mask_tests) = (self.sent as u32, trees.rays[place.ray as usize].mask_tests);
        self.workload.send_ray(&mut self.ops, id, mask_tests.into(), 1);
        batch.host.push_line(id, self.ops.line(0));
        self.ops.clear();
        for (cell, traced) in batch.cells.iter_mut().zip(&trees.traced.ops.cells) {
            cell.push_line(id, traced.line(place.ray as usize));
        }
        observe(&batch, &trees.traced.hits[place.ray as usize], before + place.ray)?;
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
