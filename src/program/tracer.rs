//! What the cells do for a ray: hits and ops, without a clock.
//!
//! `RayInGroup` has the six steps that a group of cells takes for a ray, in the order and with the numbers of docs/machine.md.
//! The paper's P1, P2 and P3 (§4.2, figure 5) are `walk`, `slabs_test` and `intersection_test` in the third of them.

mod counts;
mod visit;

use std::ops::ControlFlow;

use bitvec::vec::BitVec;
use glam::DVec3;

pub use counts::{Counts, Spared};
pub use visit::{GroupVisit, Said, Test, Visit, VoxelVisit};

use crate::geometry::partition::Weight;
use crate::geometry::{Hit, Ray, RaySlabs};
use crate::isa::Fault;
use crate::quantities::Cycles;
use crate::seam::{Costs, OpBatch, OpKind, OpStream, Unit};

use super::cells::ProgramTracer;
use super::layout::{Group, Surfaces};
use super::messages::{CANDIDATE_WORDS, HIT_WORDS, Messaging};
use super::stop_words::Stopping;
use super::work::{GRID_START, GRID_VOXEL, INTERSECTION_POLYGON, INTERSECTION_START, SLABS_POLYGON, SLABS_START};
use super::workload::{Shares, Workload};

/// Where a sample of rays made cells work, and for how many cycles.
#[derive(Debug)]
pub(super) struct WorkSample {
    /// For each stage, where the cells that it is of worked how long.
    pub stages: Vec<Vec<Weight>>,
    /// For each group and each of its stages, all that the cell worked.
    pub groups: Vec<Vec<f64>>,
}

impl WorkSample {
    /// No ray yet, for so many groups of so many cells.
    pub fn new(groups: usize, stages: usize) -> WorkSample {
        WorkSample { stages: vec![Vec::new(); stages], groups: vec![vec![0.0; stages]; groups] }
    }

    /// Takes what the cells of a group have done, there or nowhere.
    fn take(&mut self, cells: &mut [OpStream], group: usize, at: Option<DVec3>, costs: &Costs) {
        for (stage, ops) in cells.iter_mut().enumerate() {
            let amount = cycles(ops, costs).0 as f64;
            ops.clear();
            self.groups[group][stage] += amount;
            self.stages[stage].extend(at.map(|at| Weight { at, amount }));
        }
    }
}

/// Traces rays through a workload. Each thread has its own.
#[derive(Debug)]
pub struct Tracer<'a> {
    workload: &'a Workload,
    mailbox: Mailbox,
    /// The cells at work, if they run programs.
    programs: Option<ProgramTracer<'a>>,
    /// What has been counted so far.
    pub counts: Counts,
    /// The first fault of a cell's program; rays that a fault ends hit nothing.
    pub fault: Option<Fault>,
}

/// The polygons that a ray has already been tested against.
#[derive(Debug, Default)]
struct Mailbox {
    seen: BitVec,
    marked: Vec<u32>,
}

impl<'a> Tracer<'a> {
    /// A tracer that has counted nothing yet.
    pub fn new(workload: &'a Workload) -> Tracer<'a> {
        let mailbox = Mailbox::of(workload);
        let programs = workload.programs.as_ref().map(|cells| ProgramTracer::new(cells, workload.polygons().len()));
        Tracer { workload, mailbox, programs, counts: Counts::default(), fault: None }
    }

    /// What the rays are traced through.
    pub fn workload(&self) -> &'a Workload {
        self.workload
    }

    /// Instructions that cells with programs have executed.
    pub fn executed(&self) -> u64 {
        self.programs.as_ref().map_or(0, ProgramTracer::executed)
    }

    /// Traces ray number `id` of `count` rays that the host sends without waiting for hits: adds a line to the host's and
    /// to every cell's ops, and returns the first hit.
    pub fn trace(&mut self, id: u32, count: usize, ray: &Ray, batch: &mut OpBatch) -> Hit {
        let shares = self.workload.shares(id, count);
        // The host forwards none ahead: it sends messages as they are answered.
        self.workload.send_ray(&mut batch.host, id, self.workload.mask_tests(ray), shares.answered);
        self.trace_line(id, shares, (ray, None), &mut batch.cells)
    }

    /// The same without the host's line, for who decides himself when the ray is sent, by itself.
    pub fn trace_cells(&mut self, id: u32, ray: &Ray, cells: &mut [OpStream]) -> Hit {
        self.trace_line(id, Shares::OWN, (ray, None), cells)
    }

    /// The same of a ray that says which polygon it starts on and does not hit, if it says so.
    pub fn trace_leaving(&mut self, id: u32, ray: &Ray, own: Option<u32>, cells: &mut [OpStream]) -> Hit {
        self.trace_line(id, Shares::OWN, (ray, own), cells)
    }

    /// Each cell reads and passes on some rays (programs just the one), works on this one, and answers some.
    fn trace_line(&mut self, id: u32, shares: Shares, (ray, own): (&Ray, Option<u32>), cells: &mut [OpStream]) -> Hit {
        let hit = match &mut self.programs {
            Some(programs) => programs.trace(id, ray, cells, &mut self.counts).unwrap_or_else(|fault| {
                self.fault.get_or_insert(fault);
                Hit::MISS
            }),
            None => self.trace_groups(shares, (ray, own), cells),
        };
        cells.iter_mut().for_each(|cell| cell.end_line(id));
        self.counts.hits += hit.is_hit() as u64;
        hit
    }

    /// The same where the cells take Figure 7's times.
    fn trace_groups(&mut self, shares: Shares, (ray, own): (&Ray, Option<u32>), cells: &mut [OpStream]) -> Hit {
        let bounded = self.workload.program.bounded_walk;
        let mut nearest = Hit::MISS;
        let mut ray_slabs = None;
        let stages = self.workload.stages.count();
        for (index, (group, cells)) in self.workload.layout.groups.iter().zip(cells.chunks_mut(stages)).enumerate() {
            let known = if bounded { nearest } else { Hit::MISS };
            let mut in_group = RayInGroup { own, ..RayInGroup::new(self.workload, ray, known, cells, ray_slabs) };
            in_group.read_ray(shares.read, index + 1 == self.workload.groups());
            if bounded && index > 0 {
                in_group.read_earlier_hits(shares.answered);
            }
            if self.workload.admits(ray, index) {
                in_group.start_kernels();
                in_group.take_candidates(group, &mut self.mailbox, &mut self.counts);
                in_group.end_candidates();
            }
            if !bounded && index > 0 {
                in_group.read_earlier_hits(shares.answered);
            }
            in_group.write_hits(shares.answered);
            ray_slabs = in_group.ray_slabs;
            nearest = nearest.nearer(in_group.hit);
            self.mailbox.clear();
        }
        nearest
    }

    /// Traces a ray through all groups and notes the work of their cells, voxel by voxel. Where stop words are sent, the cells are
    /// taken to stop at once.
    pub(super) fn sample(&mut self, ray: &Ray, sample: &mut WorkSample) {
        let (workload, program) = (self.workload, &self.workload.program);
        let stops = workload.stages.intersection == 0 || workload.stop_words.is_some();
        let mut cells: Vec<OpStream> = (0..workload.stages.count()).map(|_| OpStream::default()).collect();
        let mut nearest = Hit::MISS;
        for (index, group) in workload.layout.groups.iter().enumerate() {
            let known = if program.bounded_walk { nearest } else { Hit::MISS };
            let mut in_group = RayInGroup::new(workload, ray, known, &mut cells, None);
            in_group.start_kernels();
            sample.take(in_group.cells, index, None, workload.costs());
            let (ray, mut t_enter) = (in_group.ray, 0.0);
            group.grid.walk(&ray, workload.polygons().beyond_margin(ray.origin), |voxel| {
                in_group.work(0, GRID_VOXEL, 1);
                for &polygon in voxel.polygons {
                    if !program.mailbox || self.mailbox.mark(polygon) {
                        in_group.candidate(polygon, &mut self.counts);
                    }
                }
                let at = group.grid.voxel_center(ray.at((t_enter + voxel.t_exit) / 2.0));
                sample.take(in_group.cells, index, Some(at), workload.costs());
                t_enter = voxel.t_exit;
                if stops && in_group.hit.t <= voxel.t_exit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            nearest = nearest.nearer(in_group.hit);
            self.mailbox.clear();
        }
    }
}

/// The cycles of all work of a stream.
fn cycles(ops: &OpStream, costs: &Costs) -> Cycles {
    let work = ops.ops().iter().filter_map(|op| Some(Cycles(costs.of(op.unit()?).0 * op.count() as u64)));
    work.sum()
}

/// Which kernels have been entered, and their start paid, for a ray.
#[derive(Clone, Copy, Debug, Default)]
struct Entered {
    slabs: bool,
    intersection: bool,
}

/// One ray in one group of cells.
struct RayInGroup<'a> {
    workload: &'a Workload,
    surfaces: &'a Surfaces,
    /// The ray, which ends at the hit that is known when the group begins.
    ray: Ray,
    /// The polygon that it starts on and does not hit, if it says so.
    own: Option<u32>,
    cells: &'a mut [OpStream],
    ray_slabs: Option<RaySlabs>,
    entered: Entered,
    stopping: Stopping,
    hit: Hit,
}

impl<'a> RayInGroup<'a> {
    /// A group that begins with a ray, and knows a hit of it already or none. What slabs need of the ray may be known from the
    /// groups before.
    ///
    /// The ray then ends there, as far as the group is concerned. What it hits nearer, or at the same t on a polygon with a lower
    /// number, takes the known hit's place: that is how the hits of all groups are merged, whichever comes first.
    fn new(
        workload: &'a Workload,
        ray: &Ray,
        known: Hit,
        cells: &'a mut [OpStream],
        ray_slabs: Option<RaySlabs>,
    ) -> RayInGroup<'a> {
        let ray = ray.until(known.t);
        RayInGroup {
            workload,
            surfaces: &workload.layout.surfaces,
            ray,
            own: None,
            cells,
            ray_slabs: ray_slabs.map(|slabs| slabs.ending_at(ray.t_max)),
            entered: Entered::default(),
            stopping: Stopping::default(),
            hit: known,
        }
    }

    /// Step 1, the ray: every cell reads it and passes it on, but for the last of the last group. Where rays are passed on ahead, these
    /// are `rays` up to one further on: several at first, none at the end. Where several are in a message, the first has them all.
    fn read_ray(&mut self, rays: u64, is_last: bool) {
        if rays == 0 {
            return;
        }
        let (words, messaging) = (rays * self.workload.ray_words(), self.messaging());
        let last = self.workload.stages.intersection;
        for (stage, cell) in self.cells.iter_mut().enumerate() {
            messaging.pass(cell, words, !is_last || stage < last);
        }
    }

    #[inline(always)]
    fn messaging(&self) -> Messaging {
        self.workload.messaging()
    }

    /// Step 2, the starts: each cell's first kernel starts. The others do at the first candidate that reaches them.
    fn start_kernels(&mut self) {
        self.work(0, GRID_START, 1);
        let stages = self.workload.stages;
        if let Some(slabs) = stages.slabs.filter(|&slabs| slabs > 0) {
            self.enter_slabs(slabs);
        }
        // The intersection is its cell's first kernel if neither the grid nor the slabs run there.
        if stages.intersection > 0 && stages.slabs != Some(stages.intersection) {
            self.enter_intersection();
        }
    }

    /// Part of step 2 for the slabs: their start.
    fn enter_slabs(&mut self, cell: usize) {
        self.entered.slabs = true;
        self.work(cell, SLABS_START, 1);
    }

    /// Part of step 2 for the intersection: its start.
    fn enter_intersection(&mut self) {
        self.entered.intersection = true;
        self.work(self.workload.stages.intersection, INTERSECTION_START, 1);
    }

    /// Step 3, the candidates: the grid's walk finds them, and each goes through the kernels that follow.
    fn take_candidates(&mut self, group: &Group, mailbox: &mut Mailbox, counts: &mut Counts) {
        if self.workload.stop_words.is_some() {
            self.walk_told(group, mailbox, counts);
        } else {
            self.walk(group, mailbox, counts);
        }
    }

    /// P1: the grid's walk, and what becomes of each candidate.
    fn walk(&mut self, group: &Group, mailbox: &mut Mailbox, counts: &mut Counts) {
        let workload = self.workload;
        let strayed = self.surfaces.polygons.beyond_margin(self.ray.origin);
        let ray = self.ray;
        let behind = group.grid.walk_occupied(&ray, strayed, |stretch| {
            self.work(0, GRID_VOXEL, stretch.voxels);
            counts.voxels += stretch.voxels;
            for &polygon in stretch.polygons {
                if !workload.program.mailbox || mailbox.mark(polygon) {
                    self.candidate(polygon, counts);
                }
            }
            self.t_done()
        });
        if behind > 0 {
            self.work(0, GRID_VOXEL, behind);
            counts.voxels += behind;
        }
    }

    /// The same where the cells tell each other of every voxel: the grid's cell walks until it has read the stop.
    fn walk_told(&mut self, group: &Group, mailbox: &mut Mailbox, counts: &mut Counts) {
        let workload = self.workload;
        let Some(words) = workload.stop_words else { return };
        let ray = self.ray;
        group.grid.walk(&ray, self.surfaces.polygons.beyond_margin(ray.origin), |voxel| {
            self.work(0, GRID_VOXEL, 1);
            counts.voxels += 1;
            for &polygon in voxel.polygons {
                if !workload.program.mailbox || mailbox.mark(polygon) {
                    self.candidate(polygon, counts);
                }
            }
            words.end_voxel(self.cells, workload.messaging());
            self.stopping.end_voxel(self.hit.t <= voxel.t_exit);
            let stop = self.stopping.seen_by(0, workload.stop_words);
            if stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
    }

    /// A cell that has both grid and intersection stops when its nearest hit lies inside the voxel just done: from where on the
    /// ray on it need not look.
    #[inline]
    fn t_done(&self) -> f32 {
        if self.workload.stages.intersection == 0 { self.hit.t } else { f32::INFINITY }
    }

    /// A polygon from the grid goes through the slabs, if there are any, to the intersection.
    #[inline]
    fn candidate(&mut self, polygon: u32, counts: &mut Counts) {
        if self.own == Some(polygon) {
            return self.spare(polygon, counts);
        }
        let stages = self.workload.stages;
        let mut cell = 0;
        if let Some(slabs) = stages.slabs {
            self.send(cell, slabs);
            if self.stopping.seen_by(slabs, self.workload.stop_words) {
                return;
            }
            cell = slabs;
            counts.slab_tests += 1;
            if !self.slabs_test(slabs, polygon) {
                return;
            }
        }
        self.send(cell, stages.intersection);
        if self.stopping.seen_by(stages.intersection, self.workload.stop_words) {
            return;
        }
        counts.intersection_tests += 1;
        self.intersection_test(polygon);
    }

    /// Drops the polygon that the ray starts on, and counts the tests that it would have had.
    fn spare(&mut self, polygon: u32, counts: &mut Counts) {
        let (stages, stop_words) = (self.workload.stages, self.workload.stop_words);
        if let Some(cell) = stages.slabs {
            if self.stopping.seen_by(cell, stop_words) {
                return;
            }
            counts.spared.slab_tests += 1;
            let Surfaces { polygons, slabs } = self.surfaces;
            let new = || RaySlabs::new(&self.ray, polygons.largest_coordinate());
            if !slabs.meets(self.ray_slabs.get_or_insert_with(new), polygon) {
                return;
            }
        }
        if !self.stopping.seen_by(stages.intersection, stop_words) {
            counts.spared.intersection_tests += 1;
        }
    }

    /// Sends one word on Y, if the kernels do not run in the same cell.
    #[inline(always)]
    fn send(&mut self, from: usize, to: usize) {
        if from != to {
            let messaging = self.messaging();
            messaging.send(&mut self.cells[from], OpKind::WriteY, CANDIDATE_WORDS);
            messaging.take(&mut self.cells[to], OpKind::ReadY, CANDIDATE_WORDS);
        }
    }

    /// P2: a candidate whose slabs the ray misses is dropped.
    #[inline(always)]
    fn slabs_test(&mut self, cell: usize, polygon: u32) -> bool {
        if !self.entered.slabs {
            self.enter_slabs(cell);
        }
        self.work(cell, SLABS_POLYGON, 1);
        let Surfaces { polygons, slabs } = self.surfaces;
        let new = || RaySlabs::new(&self.ray, polygons.largest_coordinate());
        slabs.meets(self.ray_slabs.get_or_insert_with(new), polygon)
    }

    /// P3: a candidate is intersected, and kept if it is the nearest so far.
    #[inline]
    fn intersection_test(&mut self, polygon: u32) {
        if !self.entered.intersection {
            self.enter_intersection();
        }
        self.work(self.workload.stages.intersection, INTERSECTION_POLYGON, 1);
        self.hit = self.surfaces.polygons.nearer(&self.ray, polygon, self.hit);
    }

    #[inline(always)]
    fn work(&mut self, cell: usize, unit: Unit, count: u64) {
        self.cells[cell].push(OpKind::Work(unit), count);
    }

    /// Step 4, the end: END goes down the stages.
    fn end_candidates(&mut self) {
        let last = self.workload.stages.intersection;
        for stage in 0..last {
            self.send(stage, stage + 1);
        }
    }

    /// Step 5, the earlier group's hit: every stage reads it, and all but the last pass it on. The last merges it with its
    /// own, which takes no time. Where it bounds the walk, that comes before step 2. Where several rays are in a message, all of their
    /// hits come behind the last one's work.
    fn read_earlier_hits(&mut self, hits: u64) {
        if hits == 0 {
            return;
        }
        let (last, messaging) = (self.workload.stages.intersection, self.messaging());
        for (stage, cell) in self.cells.iter_mut().enumerate() {
            messaging.take(cell, OpKind::ReadY, hits * HIT_WORDS);
            if stage < last {
                messaging.send(cell, OpKind::WriteY, hits * HIT_WORDS);
            }
        }
    }

    /// Step 6, the answer: the last stage writes the nearer hit of the message's rays.
    fn write_hits(&mut self, hits: u64) {
        if hits > 0 {
            let last = self.workload.stages.intersection;
            self.messaging().send(&mut self.cells[last], OpKind::WriteY, hits * HIT_WORDS);
        }
    }
}

impl Mailbox {
    /// An empty one, for the polygons of a workload that has mailboxes.
    fn of(workload: &Workload) -> Mailbox {
        let polygons = if workload.program.mailbox { workload.polygons().len() } else { 0 };
        Mailbox { seen: BitVec::repeat(false, polygons), marked: Vec::new() }
    }

    /// Marks a polygon; false if it was marked before.
    fn mark(&mut self, polygon: u32) -> bool {
        let new = !self.seen.replace(polygon as usize, true);
        if new {
            self.marked.push(polygon);
        }
        new
    }

    fn clear(&mut self) {
        for polygon in self.marked.drain(..) {
            self.seen.set(polygon as usize, false);
        }
    }
}
