//! What the cells do for one ray, test by test: for who looks at a single ray, where a run only counts.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::{Counts, Mailbox, RayInGroup, Tracer};
use crate::geometry::{Hit, Ray};
use crate::program::Workload;
use crate::seam::OpStream;

/// A ray's way through the sub-volumes of all groups.
#[derive(Clone, Debug, PartialEq)]
pub struct Visit {
    /// What happens to it in each group, from left to right.
    pub groups: Vec<GroupVisit>,
    /// Its first hit.
    pub hit: Hit,
}

/// A ray in one group.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupVisit {
    /// The voxels that are walked through, in their order. None if the ray misses the volume.
    pub voxels: Vec<VoxelVisit>,
    /// The nearest hit on the group's polygons.
    pub hit: Hit,
}

/// A voxel on a ray's way.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelVisit {
    /// Its number in the group's grid; x runs fastest.
    pub voxel: usize,
    /// The polygons in it, and what became of each.
    pub tests: Vec<Test>,
}

/// A candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// The polygon's index.
    pub polygon: u32,
    /// What became of it.
    pub said: Said,
}

/// What becomes of a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Said {
    /// The mailbox has had it before.
    Known,
    /// The ray was stopped before it came to all of its cells.
    Stopped,
    /// The ray misses its slabs.
    Dropped,
    /// The ray misses it.
    Missed,
    /// The ray hits it, at that t, and something nearer.
    Behind(f32),
    /// The ray hits it, at that t: the nearest by then.
    Nearest(f32),
}

impl Workload {
    /// The first hits of rays that no run sends. All cores take part.
    pub fn look(&self, rays: &[Ray]) -> Vec<Hit> {
        let tracer = || (Tracer { programs: None, ..Tracer::new(self) }, vec![OpStream::default(); self.cells()]);
        let look = |(tracer, cells): &mut (Tracer<'_>, Vec<OpStream>), ray: &Ray| {
            cells.iter_mut().for_each(OpStream::clear);
            tracer.trace_cells(0, ray, cells)
        };
        rays.par_iter().with_min_len(1024).map_init(tracer, look).collect()
    }

    /// What the group's cells do for a ray, test by test. Cells that run programs do the same.
    pub fn visit(&self, ray: &Ray) -> Visit {
        let mut mailbox = Mailbox::of(self);
        let mut cells = vec![OpStream::default(); self.stages.count()];
        let (mut ray_slabs, mut nearest) = (None, Hit::MISS);
        let groups = self.layout.groups.iter().enumerate().map(|(index, group)| {
            if !self.admits(ray, index) {
                return GroupVisit { voxels: Vec::new(), hit: Hit::MISS };
            }
            let known = if self.program.bounded_walk { nearest } else { Hit::MISS };
            let mut in_group = RayInGroup::new(self, ray, known, &mut cells, ray_slabs);
            let ray = in_group.ray;
            let mut voxels = Vec::new();
            group.grid.walk(&ray, self.polygons().beyond_margin(ray.origin), |voxel| {
                let told = |&polygon: &u32| Test { polygon, said: in_group.told(polygon, &mut mailbox) };
                voxels.push(VoxelVisit { voxel: voxel.voxel, tests: voxel.polygons.iter().map(told).collect() });
                let is_done = match self.stop_words {
                    Some(_) => {
                        in_group.stopping.end_voxel(in_group.hit.t <= voxel.t_exit);
                        in_group.stopping.seen_by(0, self.stop_words)
                    }
                    None => in_group.t_done() <= voxel.t_exit,
                };
                if is_done { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            let hit = in_group.hit;
            ray_slabs = in_group.ray_slabs;
            nearest = nearest.nearer(hit);
            mailbox.clear();
            cells.iter_mut().for_each(OpStream::clear);
            GroupVisit { voxels, hit }
        });
        Visit { groups: groups.collect(), hit: nearest }
    }
}

impl RayInGroup<'_> {
    /// Takes a polygon as the walk does, and tells what became of it.
    fn told(&mut self, polygon: u32, mailbox: &mut Mailbox) -> Said {
        if self.workload.program.mailbox && !mailbox.mark(polygon) {
            return Said::Known;
        }
        let (stages, stop_words) = (self.workload.stages, self.workload.stop_words);
        let (mut counts, before) = (Counts::default(), self.hit);
        self.candidate(polygon, &mut counts);
        match counts {
            Counts { intersection_tests: 1, .. } if self.hit != before => Said::Nearest(self.hit.t),
            Counts { intersection_tests: 1, .. } => {
                let hit = self.surfaces.polygons.intersect(&self.ray, polygon, f32::INFINITY);
                hit.map_or(Said::Missed, |hit| Said::Behind(hit.t))
            }
            Counts { slab_tests: 1, .. } if !self.stopping.seen_by(stages.intersection, stop_words) => Said::Dropped,
            _ => Said::Stopped,
        }
    }
}
