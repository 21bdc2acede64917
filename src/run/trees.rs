//! The functional half of an image: trees of rays, traced and shaded without a clock.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::TracedBatch;
use super::shown::Look;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Hit, Ray};
use crate::host::camera::View;
use crate::host::sampling::Pass;
use crate::host::screen::Screen;
use crate::host::shading::{Branch, RayKind, Shader};
use crate::program::{Tracer, Workload, work};
use crate::seam::{Costs, OpStream};

/// What was counted on the rays of each kind, in the order of [`RayKind::ALL`].
pub type ByKind<T> = [T; RayKind::ALL.len()];

/// What the rays of one kind came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KindCounts {
    /// How many there were.
    pub rays: u64,
    /// How many hit a polygon.
    pub hits: u64,
    /// Cycles that the cells computed on them.
    pub busy: u64,
}

impl std::ops::AddAssign for KindCounts {
    fn add_assign(&mut self, other: KindCounts) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.busy += other.busy;
    }
}

/// The trees of some consecutive samples. A ray's number in the batch is that of its line in the cells' ops.
#[derive(Debug, Default)]
pub struct TreeBatch {
    /// All rays, tree by tree; in a tree, generation by generation, so that each one's children stand together.
    pub rays: Vec<TreeRay>,
    /// Where the trees end among the rays. One of a sample that can hit nothing has none.
    pub ends: Vec<u32>,
    /// For each tree, how many samples from the first one on the host must know before it may begin this one.
    pub decided_by: Vec<usize>,
    /// Each tree's light.
    pub colors: Vec<DVec3>,
    /// What each tree shows, if that is asked for.
    pub shown: Vec<u64>,
    /// What the cells do for the rays; the host's ops are not known before the rays are sent.
    pub traced: TracedBatch,
    /// What was counted on the rays.
    pub kinds: ByKind<KindCounts>,
    branches: Vec<Branch>,
}

/// A ray's place in its tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeRay {
    /// What it is for.
    pub kind: RayKind,
    /// Its distance from the root.
    pub generation: u8,
    /// Whether the host shades its hit: shadow rays and rays that hit nothing take no time.
    pub shaded: bool,
    /// The rays that its hit asks for: the first one's number in the batch, and how many.
    pub children: (u32, u32),
    /// The number of its tree in the batch.
    pub tree: u32,
    /// Against how many sub-volumes the host tests it before it sends it.
    pub mask_tests: u32,
    /// The ray itself.
    pub ray: Ray,
    /// Cycles that the cells compute on it.
    pub busy: u64,
    /// Whether the host sends it: not if a rule says what it hits. Cells then do nothing for it.
    pub is_sent: bool,
}

/// Traces the trees of samples. Each thread has its own.
pub(super) struct Grower<'a> {
    pub tracer: Tracer<'a>,
    /// What the cells' work costs.
    pub costs: &'a Costs,
    pub shader: &'a Shader<'a>,
    pub view: View,
    /// The pixels that can show anything, if that is known.
    pub screen: Option<&'a Screen>,
    /// What is told of the samples beside their light.
    pub look: Option<&'a Look>,
}

impl Grower<'_> {
    /// Traces the trees of some samples of a pass into an old batch.
    pub fn grow(&mut self, pass: &Pass, samples: std::ops::Range<usize>, cells: usize, batch: TreeBatch) -> TreeBatch {
        let mut batch = batch;
        batch.reset(cells);
        for sample in samples {
            let (x, y) = pass.position(sample);
            batch.decided_by.push(pass.decided_by(sample));
            let first = batch.rays.len();
            match self.screen.is_none_or(|screen| screen.shows(pass.pixel(sample))) {
                true => self.tree(Branch::primary(self.view.ray(x, y)), &mut batch),
                false => batch.add_empty_tree(self.shader.background()),
            }
            if let Some(look) = self.look {
                let (rays, hits) = (&batch.rays[first..], &batch.traced.hits[first..]);
                let color = batch.colors.last().copied().unwrap_or_default();
                batch.shown.push(look.key((rays, hits, &batch.branches, first), color));
            }
        }
        batch.traced.counts = std::mem::take(&mut self.tracer.counts);
        batch.traced.fault = self.tracer.fault.take();
        batch
    }

    fn tree(&mut self, root: Branch, batch: &mut TreeBatch) {
        let TreeBatch { rays, ends, colors, traced, kinds, branches, .. } = batch;
        let (tree, first) = (ends.len() as u32, rays.len());
        let workload = self.tracer.workload();
        let color = grow(
            self.shader,
            root,
            branches,
            |branch| {
                let number = traced.hits.len();
                let spared = &mut self.tracer.counts.spared;
                let [objects, polygons] = branch.rule_tests;
                spared.object_tests += u64::from(objects);
                spared.polygon_tests += u64::from(polygons);
                if let Some(hit) = branch.foretold {
                    let rays = if hit.is_hit() { &mut spared.shaded_rays } else { &mut spared.lit_rays };
                    *rays += 1;
                    traced.ops.cells.iter_mut().for_each(|cell| cell.end_line(number as u32));
                    traced.hits.push(hit);
                    return (hit, 0);
                }
                let cells = &mut traced.ops.cells;
                let hit = self.tracer.trace_leaving(number as u32, &branch.ray, branch.own, cells);
                let busy = computing(&traced.ops.cells, number, self.costs);
                kinds[branch.kind as usize] += KindCounts { rays: 1, hits: hit.is_hit() as u64, busy };
                traced.hits.push(hit);
                (hit, busy)
            },
            |branch, (hit, busy), (next, children)| {
                rays.push(TreeRay {
                    kind: branch.kind,
                    generation: branch.generation,
                    shaded: hit.is_hit() && branch.kind != RayKind::Shadow,
                    children: ((first + next) as u32, children.len() as u32),
                    tree,
                    mask_tests: workload.mask_tests(&branch.ray) as u32,
                    ray: branch.ray,
                    busy,
                    is_sent: branch.foretold.is_none(),
                });
            },
        );
        colors.push(color);
        ends.push(rays.len() as u32);
    }
}

/// All rays of the trees that grow from some roots, tree by tree, traced through a workload of one cell.
///
/// # Errors
///
/// If it is told to stop.
pub(super) fn rays(
    shader: &Shader<'_>,
    workload: &Workload,
    roots: Vec<Ray>,
    cancel: &Cancel,
) -> Result<Vec<Ray>, Cancelled> {
    let (mut tracer, mut cells, mut branches) = (Tracer::new(workload), [OpStream::default()], Vec::new());
    let mut rays = Vec::new();
    for root in roots {
        cancel.check()?;
        let trace = |branch: &Branch| {
            cells[0].clear();
            rays.push(branch.ray);
            (tracer.trace_cells(0, &branch.ray, &mut cells), ())
        };
        grow(shader, Branch::primary(root), &mut branches, trace, |_, _, _| ());
    }
    Ok(rays)
}

/// Grows a tree of rays, generation by generation, and tells its light. `trace` finds each ray's first hit, and what else there is to
/// say of it; `note` is then told of both, and of the rays that the hit asks for: where in the tree they begin, and all of them.
pub(super) fn grow<R>(
    shader: &Shader<'_>,
    root: Branch,
    branches: &mut Vec<Branch>,
    mut trace: impl FnMut(&Branch) -> (Hit, R),
    mut note: impl FnMut(&Branch, (Hit, R), (usize, &[Branch])),
) -> DVec3 {
    let mut color = DVec3::ZERO;
    branches.clear();
    branches.push(root);
    let mut next = 0;
    while next < branches.len() {
        let branch = branches[next];
        let (hit, record) = trace(&branch);
        let children = branches.len();
        color += shader.shade(&branch, &hit, |child| branches.push(child));
        note(&branch, (hit, record), (children, &branches[children..]));
        next += 1;
    }
    color
}

/// The cycles that cells compute on a ray, in their kernels; `line` is its place in the batch.
pub fn computing(cells: &[OpStream], line: usize, costs: &Costs) -> u64 {
    let ops = cells.iter().flat_map(|cell| cell.line(line));
    let units = ops.filter_map(|op| Some((op.unit()?, op.count())));
    let of_kernels = units.filter(|(unit, _)| costs.activity(*unit) != work::OTHER);
    of_kernels.map(|(unit, count)| costs.of(unit).0 * count as u64).sum()
}

impl TreeBatch {
    fn reset(&mut self, cells: usize) {
        self.traced.reset(cells);
        self.rays.clear();
        self.ends.clear();
        self.decided_by.clear();
        self.colors.clear();
        self.shown.clear();
        self.kinds = Default::default();
    }

    /// The hit of a tree's root, of one that has rays.
    pub fn root_hit(&self, tree: usize) -> &Hit {
        &self.traced.hits[self.tree(tree).start as usize]
    }

    /// Adds a tree without rays, which has the background's light.
    fn add_empty_tree(&mut self, background: DVec3) {
        self.colors.push(background);
        self.ends.push(self.rays.len() as u32);
    }

    /// The rays of a tree, as numbers in the batch.
    pub fn tree(&self, tree: usize) -> std::ops::Range<u32> {
        let start = if tree == 0 { 0 } else { self.ends[tree - 1] };
        start..self.ends[tree]
    }
}
