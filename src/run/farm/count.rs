//! What the pixels of a scene of polygons take: traced on all threads, counted, not timed.

use super::{FarmRays, FarmScene, FarmSpec};
use crate::host::camera::View;
use crate::host::order::Order;
use crate::host::rules::Rules;
use crate::host::sampling::{Pass, Sampling};
use crate::host::shading::{Limits, Shader};
use crate::program::farm::{Counts, PixelWork, Pixels};
use crate::program::{Tracer, work};
use crate::run::ahead;
use crate::run::one_cell::Whole;
use crate::run::render::{Picture, object};
use crate::run::trees::{Grower, TreeBatch};
use crate::run::{RunError, Workers};
use crate::scene::Object;

/// Trees of a batch, about.
const TREES: usize = 64;

/// What a pixel takes, and what it shows.
type Pixel = (Counts, Option<Object>);

impl FarmSpec {
    /// A scene of polygons, whose pixels are traced as one cell does that has all of it.
    pub(super) fn trace<E>(
        &self,
        rays: &FarmRays,
        workers: &Workers,
        observe: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<FarmScene, RunError<E>> {
        let machine = self.machine.build()?;
        let (size_factor, resolution, grid_coefficient) = (self.size_factor, self.resolution, rays.grid_coefficient);
        let whole = Whole { scene: &self.scene, size_factor, resolution, size: self.size, grid_coefficient };
        let (scene, workload) = &whole.lay_out(machine.times, &workers.cancel)?;
        let bytes = WORD_BYTES * workload.memory_of(0).total().0;
        self.check_memory(bytes)?;
        let sampling = Sampling { side: rays.samples, adaptive: None };
        let limits = Limits { depth: rays.depth, contribution: rays.min_contribution };
        let picture =
            Picture { scene, workload, size: self.size, sampling, limits, screen: None, rules: Rules::default() };
        let pixels = pixels(&picture, workers, observe)?;
        let (name, notes) = (scene.name.clone(), scene.notes.clone());
        Ok(FarmScene { name, polygons: Some(workload.polygons().len()), bytes, pixels, notes })
    }
}

/// Bytes of a word, in which a cell's memory is counted.
const WORD_BYTES: u64 = 4;

/// Counts what each pixel takes. A segment ends where another object is seen.
fn pixels<E>(
    picture: &Picture<'_>,
    workers: &Workers,
    mut observe: impl FnMut(usize) -> Result<(), E>,
) -> Result<Pixels, RunError<E>> {
    let pass = Pass::first(picture.size, picture.sampling, Order::Raster);
    let shader = Shader::new(picture.scene, picture.workload.polygons(), picture.limits);
    let view = View::new(&picture.scene.camera, picture.size);
    let worker = || {
        let tracer = Tracer::new(picture.workload);
        let costs = picture.workload.costs();
        (Grower { tracer, costs, shader: &shader, view, screen: None, look: None }, TreeBatch::default())
    };
    // Whole pixels.
    let per_batch = pass.per_pixel() * (TREES / pass.per_pixel()).max(1);
    let make = |(grower, trees): &mut (Grower<'_>, TreeBatch), index: usize, mut batch: Vec<Pixel>| {
        let samples = index * per_batch..pass.len().min((index + 1) * per_batch);
        *trees = grower.grow(&pass, samples, 1, std::mem::take(trees));
        batch.clear();
        batch.extend((0..trees.ends.len()).step_by(pass.per_pixel()).map(|first| {
            let shown = object(&picture.scene.mesh, trees.root_hit(first));
            (counts(trees, first..first + pass.per_pixel()), shown)
        }));
        batch
    };
    let (mut work, mut starts) = (Vec::with_capacity(pass.len()), Vec::with_capacity(pass.len()));
    let (mut left, width) = (None, picture.size.width as usize);
    ahead::in_order(pass.len().div_ceil(per_batch), workers.threads, worker, make, |batch: Vec<Pixel>| {
        workers.cancel.check()?;
        for &(counts, shown) in &batch {
            starts.push(work.len() % width == 0 || left != shown);
            work.push(counts);
            left = shown;
        }
        observe(work.len() * pass.per_pixel()).map_err(RunError::Observer)?;
        Ok::<_, RunError<E>>(batch)
    })?;
    Ok(Pixels { size: picture.size, work: PixelWork::Counts(work), starts })
}

/// The units of work of some trees. Shading a hit is one, too.
fn counts(batch: &TreeBatch, trees: std::ops::Range<usize>) -> Counts {
    let mut counts = Counts::default();
    for ray in trees.flat_map(|tree| batch.tree(tree)) {
        let ops = batch.traced.ops.cells[0].line(ray as usize).iter();
        for (unit, count) in ops.filter_map(|op| Some((op.unit()?, op.count()))) {
            counts[unit.0 as usize] += count;
        }
        counts[work::HOST_HIT.0 as usize] += u32::from(batch.rays[ray as usize].shaded);
    }
    counts
}
