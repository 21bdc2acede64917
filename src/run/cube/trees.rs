//! The functional half: the trees of an image's samples as a task graph, on all threads, without a clock.

use glam::{DVec3, Vec3};

use crate::error::InputError;
use crate::geometry::Hit;
use crate::host::camera::View;
use crate::host::sampling::Pass;
use crate::host::shading::{Branch, RayKind, Shader};
use crate::program::Spared;
use crate::program::cube::{Leg, PageMap, PageUses, RayTask, Space, TaskGraph, Walker};
use crate::run::render::Picture;
use crate::run::trees::{ByKind, grow};
use crate::run::{RunError, Workers, ahead};

/// Trees of a batch.
const TREES: usize = 64;

/// What is to be traced, and how it is told apart.
#[derive(Clone, Copy, Debug)]
pub struct Tracing<'a> {
    /// What is to be seen.
    pub picture: Picture<'a>,
    /// The regions.
    pub space: Space<'a>,
    /// Where the scene is in a shared memory, if it is noted what rays read there.
    pub pages: Option<(PageMap, u32)>,
    /// Whether the hits are kept.
    pub hits: bool,
}

/// What was traced.
#[derive(Clone, Debug, Default)]
pub struct Traced {
    /// What it makes the nodes do.
    pub graph: TaskGraph,
    /// The light of each sample.
    pub colors: Vec<DVec3>,
    /// The hits of all rays, if they are kept.
    pub hits: Vec<Hit>,
    /// How many rays there are of each kind, and how many hit.
    pub kinds: ByKind<(u64, u64)>,
    /// What rules spared.
    pub spared: Spared,
}

/// What a ray has from the one whose hit asked for it.
#[derive(Clone, Copy, Debug, Default)]
struct Parent {
    turns: u8,
    /// How many regions the line has met, up to the one in which the parent ended.
    hop: u16,
    /// That region; `None` for a line of its own.
    region: Option<u16>,
}

/// A ray's legs: where they begin among all, how many there are, and the regions of the first and the last.
#[derive(Clone, Copy, Debug)]
struct Way {
    first: u32,
    count: u16,
    ends: (u16, u16),
}

/// Traces trees. Each thread has its own.
struct Grower<'a> {
    walker: Walker<'a>,
    shader: &'a Shader<'a>,
    view: View,
    regions: u16,
    has_own_grids: bool,
    keeps_hits: bool,
    branches: Vec<Branch>,
    parents: Vec<Parent>,
}

impl Tracing<'_> {
    /// Traces the trees of all samples of a pass. `observe` sees how many are done.
    ///
    /// Fails if there are more rays than can be numbered, if `observe` fails, and if it is told to stop.
    pub fn pass<E>(
        &self,
        pass: &Pass,
        workers: &Workers,
        observe: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<Traced, RunError<E>> {
        self.trace((pass.len(), |sample| pass.position(sample)), workers, observe)
    }

    /// The same of so many samples, which lie where `position` tells.
    pub fn trace<E>(
        &self,
        (count, position): (usize, impl Fn(usize) -> (f64, f64) + Sync),
        workers: &Workers,
        mut observe: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<Traced, RunError<E>> {
        let Picture { scene, workload, size, limits, rules, .. } = self.picture;
        let shader = Shader::new(scene, workload.polygons(), limits).with_rules(rules);
        let worker = || Grower {
            walker: Walker::new(workload, self.space, self.pages.map(|(map, _)| map)),
            has_own_grids: !self.space.own.is_empty(),
            shader: &shader,
            view: View::new(&scene.camera, size),
            regions: self.space.regions.count() as u16,
            keeps_hits: self.hits,
            branches: Vec::new(),
            parents: Vec::new(),
        };
        let make = |grower: &mut Grower<'_>, index: usize, mut batch: Traced| {
            batch.clear(self.pages.is_some());
            for sample in index * TREES..count.min((index + 1) * TREES) {
                let (x, y) = position(sample);
                grower.tree(sample, Branch::primary(grower.view.ray(x, y)), &mut batch);
            }
            batch.spared += std::mem::take(&mut grower.walker.spared);
            batch
        };
        let mut all = Traced::default();
        all.clear(self.pages.is_some());
        ahead::in_order(count.div_ceil(TREES), workers.threads, worker, make, |batch: Traced| {
            workers.cancel.check()?;
            all.add(&batch).map_err(RunError::Unfit)?;
            observe(all.graph.trees.len()).map_err(RunError::Observer)?;
            Ok::<_, RunError<E>>(batch)
        })?;
        (all.graph.regions, all.graph.names_own) = (self.space.regions.count(), rules.own);
        if let (Some(uses), Some((map, page_bytes))) = (&mut all.graph.pages, self.pages) {
            (uses.pages, uses.page_bytes) = (map.pages(), page_bytes);
        }
        Ok(all)
    }
}

impl Grower<'_> {
    fn tree(&mut self, sample: usize, root: Branch, batch: &mut Traced) {
        let Grower { walker, shader, branches, parents, regions, has_own_grids, keeps_hits, .. } = self;
        let Traced { graph, colors, hits, kinds, spared } = batch;
        let TaskGraph { rays, legs, trees, in_one, pages, .. } = graph;
        let (tree, first) = (trees.len() as u32, rays.len());
        trees.push(first as u32);
        parents.clear();
        parents.push(Parent::default());
        let mut unread = Vec::new();
        // A ray that meets no voxel is where the one before it was.
        let mut nearest = (sample % usize::from(*regions)) as u16;
        // Rays of the tree so far that are traced, done or to be done.
        let mut known = 1;
        let color = grow(
            shader,
            root,
            branches,
            |branch| {
                let [objects, polygons] = branch.rule_tests;
                spared.object_tests += u64::from(objects);
                spared.polygon_tests += u64::from(polygons);
                if let Some(hit) = branch.foretold {
                    let rays = if hit.is_hit() { &mut spared.shaded_rays } else { &mut spared.lit_rays };
                    *rays += 1;
                    return (hit, None);
                }
                let (first, leaving, dropped) = (legs.len(), (&branch.ray, branch.own), walker.spared);
                let uses = pages.as_mut().map_or(&mut unread, |pages| &mut pages.uses);
                let mut hit = walker.trace(leaving, legs, uses);
                if *has_own_grids {
                    in_one.push(Leg::sum(&legs[first..]));
                    legs.truncate(first);
                    walker.spared = dropped;
                    hit = walker.trace_own(leaving, legs);
                }
                pages.iter_mut().for_each(|pages| pages.ends.push(pages.uses.len() as u32));
                if legs.len() == first {
                    legs.push(Leg { region: nearest, ..Leg::default() });
                }
                nearest = legs[legs.len() - 1].region;
                hits.extend(keeps_hits.then_some(hit));
                kinds[branch.kind as usize].0 += 1;
                kinds[branch.kind as usize].1 += u64::from(hit.is_hit());
                let count = (legs.len() - first) as u16;
                (hit, Some(Way { first: first as u32, count, ends: (legs[first].region, nearest) }))
            },
            |branch, (hit, way), (_, children)| {
                let Some(way) = way else { return };
                let children = children.iter().filter(|child| child.foretold.is_none()).count();
                let Parent { turns, hop, region } = parents[rays.len() - first];
                let hop = hop + u16::from(region.is_some_and(|region| region != way.ends.0));
                let is_shadow = branch.kind == RayKind::Shadow;
                let rest = Parent { turns, hop: hop + way.count - 1, region: Some(way.ends.1) };
                let turned = Parent { turns: turns.saturating_add(1), ..Parent::default() };
                parents.extend(std::iter::repeat_n(if is_shadow { rest } else { turned }, children));
                rays.push(RayTask {
                    first_leg: way.first,
                    children: ((first + known) as u32, children as u32),
                    tree,
                    hop,
                    turns,
                    kind: branch.kind,
                    shaded: hit.is_hit() && !is_shadow,
                });
                known += children;
            },
        );
        colors.push(color);
    }
}

impl Traced {
    fn clear(&mut self, has_pages: bool) {
        let TaskGraph { rays, legs, trees, in_one, pages, .. } = &mut self.graph;
        in_one.clear();
        rays.clear();
        legs.clear();
        trees.clear();
        match pages {
            Some(pages) => {
                pages.uses.clear();
                pages.ends.clear();
            }
            None => *pages = has_pages.then(PageUses::default),
        }
        self.colors.clear();
        self.hits.clear();
        self.kinds = ByKind::default();
        self.spared = Spared::default();
    }

    /// Adds a batch behind what is there. Fails if there are more rays, or parts of them, than can be numbered.
    fn add(&mut self, batch: &Traced) -> Result<(), InputError> {
        let graph = &mut self.graph;
        let tree = graph.trees.len() as u32;
        let uses = |graph: &TaskGraph| graph.pages.as_ref().map_or(0, |pages| pages.uses.len());
        let sizes = |graph: &TaskGraph| [graph.rays.len(), graph.legs.len(), uses(graph)];
        let [ray, leg, page] = sizes(graph);
        if sizes(graph).iter().zip(sizes(&batch.graph)).any(|(all, more)| all + more >= u32::MAX as usize) {
            let error = InputError::new("the image has more rays than can be numbered");
            return Err(error.help("take a smaller image, or fewer samples"));
        }
        let (ray, leg) = (ray as u32, leg as u32);
        graph.trees.extend(batch.graph.trees.iter().map(|first| first + ray));
        graph.rays.extend(batch.graph.rays.iter().map(|task| RayTask {
            first_leg: task.first_leg + leg,
            children: (task.children.0 + ray, task.children.1),
            tree: task.tree + tree,
            ..*task
        }));
        graph.legs.extend_from_slice(&batch.graph.legs);
        graph.in_one.extend_from_slice(&batch.graph.in_one);
        if let (Some(all), Some(more)) = (&mut graph.pages, &batch.graph.pages) {
            all.uses.extend_from_slice(&more.uses);
            all.ends.extend(more.ends.iter().map(|end| end + page as u32));
        }
        self.colors.extend_from_slice(&batch.colors);
        self.hits.extend_from_slice(&batch.hits);
        self.spared += batch.spared;
        for (all, more) in self.kinds.iter_mut().zip(batch.kinds) {
            all.0 += more.0;
            all.1 += more.1;
        }
        Ok(())
    }

    /// The pixels' light, of so many samples each.
    pub fn pixels(&self, per_pixel: usize) -> Vec<Vec3> {
        let light = |samples: &[DVec3]| (samples.iter().sum::<DVec3>() / per_pixel as f64).as_vec3();
        self.colors.chunks(per_pixel.max(1)).map(light).collect()
    }
}
