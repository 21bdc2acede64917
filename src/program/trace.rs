//! What the cells do for a ray: hits and ops, without a clock.

use std::ops::ControlFlow;

use bitvec::vec::BitVec;

use crate::geometry::partition::Weight;
use crate::geometry::{Hit, Ray, RaySlabs};
use crate::isa::Fault;
use crate::machine::{Cycles, OpBatch, OpKind, OpStream, Times, Work};

use super::cells::ProgramTracer;
use super::stop_words::Stopping;
use super::workload::{Group, Workload};

/// Words of a RAY message: id, origin, direction, t_max.
pub(super) const RAY_WORDS: u64 = 8;
/// Words of a CANDIDATE message, and of the END that follows the last.
const CANDIDATE_WORDS: u64 = 1;
/// Words of a HIT message: ray id, polygon, t, alpha, beta.
const HIT_WORDS: u64 = 5;

/// How often the kernels did their work, over all cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Voxels walked through.
    pub voxels: u64,
    /// Polygons tested against slabs.
    pub slab_tests: u64,
    /// Polygons tested for intersection.
    pub intersection_tests: u64,
    /// Rays that hit a polygon.
    pub hits: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.voxels += other.voxels;
        self.slab_tests += other.slab_tests;
        self.intersection_tests += other.intersection_tests;
        self.hits += other.hits;
    }
}

/// Where a sample of rays made one cell work, and for how many cycles.
#[derive(Debug, Default)]
pub(super) struct WorkSample {
    pub weights: Vec<Weight>,
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
        let polygons = if workload.mailbox { workload.polygons.len() } else { 0 };
        let mailbox = Mailbox { seen: BitVec::repeat(false, polygons), marked: Vec::new() };
        let programs = workload.programs.as_ref().map(|cells| ProgramTracer::new(cells, workload.polygons.len()));
        Tracer { workload, mailbox, programs, counts: Counts::default(), fault: None }
    }

    /// Instructions that cells with programs have executed.
    pub fn executed(&self) -> u64 {
        self.programs.as_ref().map_or(0, ProgramTracer::executed)
    }

    /// Traces ray number `id` of `count` rays that the host sends without waiting for hits: adds a line to the host's and
    /// to every cell's ops, and returns the first hit.
    pub fn trace(&mut self, id: u32, count: usize, ray: &Ray, batch: &mut OpBatch) -> Hit {
        send_ray(&mut batch.host, id, self.workload.times.host.ray);
        let ahead = self.workload.forward_ahead as u64;
        let known_before = if id == 0 { 0 } else { id as u64 + ahead };
        let passed_on = (id as u64 + 1 + ahead).min(count as u64).saturating_sub(known_before);
        self.visit(id, passed_on, ray, &mut batch.cells)
    }

    /// The same without the host's line, for who decides himself when the ray is sent. No ray is passed on ahead.
    pub fn trace_cells(&mut self, id: u32, ray: &Ray, cells: &mut [OpStream]) -> Hit {
        self.visit(id, 1, ray, cells)
    }

    /// Each cell reads and passes on so many rays (programs just the one), then works on this one.
    fn visit(&mut self, id: u32, passed_on: u64, ray: &Ray, cells: &mut [OpStream]) -> Hit {
        let hit = match &mut self.programs {
            Some(programs) => programs.trace(id, ray, cells, &mut self.counts).unwrap_or_else(|fault| {
                self.fault.get_or_insert(fault);
                Hit::MISS
            }),
            None => self.visit_groups(passed_on, ray, cells),
        };
        cells.iter_mut().for_each(|cell| cell.end_line(id));
        self.counts.hits += hit.is_hit() as u64;
        hit
    }

    /// The same where the cells take Figure 7's times.
    fn visit_groups(&mut self, passed_on: u64, ray: &Ray, cells: &mut [OpStream]) -> Hit {
        let mut nearest = Hit::MISS;
        let mut ray_slabs = None;
        let stages = self.workload.stages.count();
        for (index, (group, cells)) in self.workload.groups.iter().zip(cells.chunks_mut(stages)).enumerate() {
            let mut visit = GroupVisit {
                workload: self.workload,
                ray,
                cells,
                ray_slabs,
                entered: Entered::default(),
                stopping: Stopping::default(),
                hit: Hit::MISS,
            };
            visit.start(passed_on);
            if self.workload.stop_words.is_some() {
                visit.walk_told(group, &mut self.mailbox, &mut self.counts);
            } else {
                visit.walk(group, &mut self.mailbox, &mut self.counts);
            }
            visit.finish(index > 0);
            ray_slabs = visit.ray_slabs;
            nearest = nearest.nearer(visit.hit);
            self.mailbox.clear();
        }
        nearest
    }

    /// Traces a ray through a workload of one cell and notes its work, voxel by voxel.
    pub(super) fn sample(&mut self, ray: &Ray, sample: &mut WorkSample) {
        let workload = self.workload;
        let mut cells = [OpStream::default()];
        let Some(group) = workload.groups.first() else { return };
        let mut visit = GroupVisit {
            workload,
            ray,
            cells: &mut cells,
            ray_slabs: None,
            entered: Entered::default(),
            stopping: Stopping::default(),
            hit: Hit::MISS,
        };
        let mut t_enter = 0.0;
        group.grid.walk(ray, workload.polygons.beyond_margin(ray.origin), |voxel| {
            for &polygon in voxel.polygons {
                visit.candidate(polygon, &mut self.counts);
            }
            let work: u64 = visit.cells[0].ops().iter().map(|op| op.count() as u64).sum();
            visit.cells[0].clear();
            let at = group.grid.voxel_center(ray.at((t_enter + voxel.t_exit) / 2.0));
            sample.weights.push(Weight { at, amount: (work + workload.times.grid.each.0) as f64 });
            t_enter = voxel.t_exit;
            visit.done_in(voxel.t_exit)
        });
    }
}

/// Ends the host's line with the ray: the host's time on it, then its words.
pub fn send_ray(host: &mut OpStream, id: u32, time: Cycles) {
    if time.0 > 0 {
        host.push(OpKind::Compute(Work::Other), time.0);
    }
    host.push(OpKind::WriteX, RAY_WORDS);
    host.end_line(id);
}

/// Which kernels have been entered, and their start paid, for a ray.
#[derive(Clone, Copy, Debug, Default)]
struct Entered {
    slabs: bool,
    intersection: bool,
}

/// One ray in one group of cells.
struct GroupVisit<'a> {
    workload: &'a Workload,
    ray: &'a Ray,
    cells: &'a mut [OpStream],
    ray_slabs: Option<RaySlabs>,
    entered: Entered,
    stopping: Stopping,
    hit: Hit,
}

impl GroupVisit<'_> {
    /// Every cell reads so many rays, this one among them if it does not know it yet; its first kernel starts on it.
    fn start(&mut self, passed_on: u64) {
        if passed_on > 0 {
            self.cells.iter_mut().for_each(|cell| cell.push(OpKind::PassX, passed_on * RAY_WORDS));
        }
        self.cells[0].push(OpKind::Compute(Work::Grid), self.workload.times.grid.start.0);
        let stages = self.workload.stages;
        if let Some(slabs) = stages.slabs.filter(|&slabs| slabs > 0) {
            self.enter_slabs(slabs);
        }
        // The intersection is its cell's first kernel if neither the grid nor the slabs run there.
        if stages.intersection > 0 && stages.slabs != Some(stages.intersection) {
            self.enter_intersection();
        }
    }

    /// The grid's walk, and what becomes of each candidate.
    fn walk(&mut self, group: &Group, mailbox: &mut Mailbox, counts: &mut Counts) {
        let workload = self.workload;
        let each = workload.times.grid.each.0;
        let mut voxels = 0;
        group.grid.walk(self.ray, workload.polygons.beyond_margin(self.ray.origin), |voxel| {
            voxels += 1;
            if voxel.polygons.is_empty() {
                return self.done_in(voxel.t_exit);
            }
            self.cells[0].push(OpKind::Compute(Work::Grid), voxels * each);
            counts.voxels += voxels;
            voxels = 0;
            for &polygon in voxel.polygons {
                if !workload.mailbox || mailbox.mark(polygon) {
                    self.candidate(polygon, counts);
                }
            }
            self.done_in(voxel.t_exit)
        });
        if voxels > 0 {
            self.cells[0].push(OpKind::Compute(Work::Grid), voxels * each);
            counts.voxels += voxels;
        }
    }

    /// The same where the cells tell each other of every voxel: the grid's cell walks until it has read the stop.
    fn walk_told(&mut self, group: &Group, mailbox: &mut Mailbox, counts: &mut Counts) {
        let workload = self.workload;
        let Some(words) = workload.stop_words else { return };
        group.grid.walk(self.ray, workload.polygons.beyond_margin(self.ray.origin), |voxel| {
            self.cells[0].push(OpKind::Compute(Work::Grid), workload.times.grid.each.0);
            counts.voxels += 1;
            for &polygon in voxel.polygons {
                if !workload.mailbox || mailbox.mark(polygon) {
                    self.candidate(polygon, counts);
                }
            }
            words.end_voxel(self.cells);
            self.stopping.end_voxel(self.hit.t <= voxel.t_exit);
            let stop = self.stopping.seen_by(0, workload.stop_words);
            if stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
    }

    /// A cell that has both grid and intersection stops when its nearest hit lies inside the voxel just done.
    #[inline]
    fn done_in(&self, t_exit: f32) -> ControlFlow<()> {
        if self.workload.stages.intersection == 0 && self.hit.t <= t_exit {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// A polygon from the grid goes through the slabs, if there are any, to the intersection.
    #[inline]
    fn candidate(&mut self, polygon: u32, counts: &mut Counts) {
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

    /// Sends one word on Y, if the kernels do not run in the same cell.
    #[inline]
    fn send(&mut self, from: usize, to: usize) {
        if from != to {
            self.cells[from].push(OpKind::WriteY, CANDIDATE_WORDS);
            self.cells[to].push(OpKind::ReadY, CANDIDATE_WORDS);
        }
    }

    #[inline]
    fn slabs_test(&mut self, cell: usize, polygon: u32) -> bool {
        if !self.entered.slabs {
            self.enter_slabs(cell);
        }
        self.cells[cell].push(OpKind::Compute(Work::Slabs), self.workload.times.slabs.each.0);
        let polygons = &self.workload.polygons;
        let new = || RaySlabs::new(self.ray, polygons.largest_coordinate());
        self.workload.slabs.meets(self.ray_slabs.get_or_insert_with(new), polygon)
    }

    #[inline]
    fn intersection_test(&mut self, polygon: u32) {
        if !self.entered.intersection {
            self.enter_intersection();
        }
        let cell = self.workload.stages.intersection;
        self.cells[cell].push(OpKind::Compute(Work::Intersection), self.workload.times.intersection.each.0);
        self.hit = self.workload.polygons.nearer(self.ray, polygon, self.hit);
    }

    fn enter_slabs(&mut self, cell: usize) {
        self.entered.slabs = true;
        self.pay(cell, Work::Slabs, self.workload.times.slabs);
    }

    fn enter_intersection(&mut self) {
        self.entered.intersection = true;
        self.pay(self.workload.stages.intersection, Work::Intersection, self.workload.times.intersection);
    }

    fn pay(&mut self, cell: usize, work: Work, times: Times) {
        let Times { start: Cycles(cycles), .. } = times;
        if cycles > 0 {
            self.cells[cell].push(OpKind::Compute(work), cycles);
        }
    }

    /// END goes down the stages; then the earlier group's hit, to be merged where the intersection is.
    fn finish(&mut self, has_earlier_group: bool) {
        let last = self.workload.stages.intersection;
        for stage in 0..=last {
            let cell = &mut self.cells[stage];
            if stage > 0 {
                cell.push(OpKind::ReadY, CANDIDATE_WORDS);
            }
            if stage < last {
                cell.push(OpKind::WriteY, CANDIDATE_WORDS);
            }
            if has_earlier_group {
                cell.push(OpKind::ReadY, HIT_WORDS);
            }
            if stage == last || has_earlier_group {
                cell.push(OpKind::WriteY, HIT_WORDS);
            }
        }
    }
}

impl Mailbox {
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
