//! A whole image: trees of rays on all threads, ahead of the host and the array in a closed loop.

use std::ops::{Range, RangeInclusive};

use glam::{DVec3, Vec3};

use super::ahead;
use super::closed_loop::ClosedLoop;
use super::shown::Look;
use super::timed::UNLIMITED;
use super::trace::BATCH_LINES;
use super::trees::{ByKind, Grower, KindCounts, TreeBatch};
use super::{RunError, Watching, Workers};
use crate::error::InputError;
use crate::geometry::Hit;
use crate::host::camera::{ImageSize, View};
use crate::host::order::Order;
use crate::host::policy::HostRules;
use crate::host::rules::Rules;
use crate::host::sampling::{Pass, Sampling, Shown};
use crate::host::screen::Screen;
use crate::host::shading::{Limits, Shader};
use crate::machine::{Array, Cycles, MachineSpec, Observed, Unfinished};
use crate::measure::Measured;
use crate::program::{Counts, Tracer, Workload};
use crate::scene::{Mesh, Object, Scene};
use crate::seam::OpBatch;

/// About the rays of a tree, to make batches of a good size.
const RAYS_PER_TREE: usize = 8;

/// Trees of a batch: as many rays, about, as a batch of primary rays has.
const TREES_PER_BATCH: RangeInclusive<usize> = 4..=128;

/// What is to be seen, and how well.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// The scene, whose mesh is the workload's.
    pub scene: &'a Scene,
    /// The scene laid out for the array.
    pub workload: &'a Workload,
    /// Size of the image.
    pub size: ImageSize,
    /// Rays from the eye.
    pub sampling: Sampling,
    /// Where the trees of rays end.
    pub limits: Limits,
    /// The pixels that can show anything, if the host knows: through the others it sends no rays.
    pub screen: Option<&'a Screen>,
    /// What spares tests and rays.
    pub rules: Rules,
}

/// What an observer sees of a run under way.
#[derive(Debug)]
pub enum Seen<'a> {
    /// More samples are known: so many of so many (more may be added to these by adaptive sampling).
    Samples {
        /// How many are known by now.
        done: usize,
        /// How many are to be known.
        of: usize,
        /// The array as it is by now, if there is one.
        array: Option<&'a Array>,
    },
    /// The trees of some samples were traced, whose pixels these are. The host sends their rays later.
    Grown(&'a TreeBatch, &'a [usize]),
    /// The host sends a ray: its ops, the hit that it will find, and its number among all rays that were grown. Not without timing.
    Sent(&'a OpBatch, &'a Hit, u32),
}

/// An image and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// Pixels of linear light, line by line from the top left. They do not depend on threads, timing, array or host.
    pub pixels: Vec<Vec3>,
    /// How often the kernels did their work.
    pub counts: Counts,
    /// What the rays of each kind came to.
    pub kinds: ByKind<KindCounts>,
    /// How many samples were taken: for those that can hit nothing no ray was sent, where the host knows.
    pub samples: u64,
    /// The pixels that adaptive sampling gave more samples, by their numbers, in rising order.
    pub refined: Vec<u32>,
    /// The machine's part, if it was asked for.
    pub timing: Option<Timing>,
}

/// What the machine did.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// Where every cycle and word went.
    pub stats: Measured,
    /// The latencies of the rays of each kind.
    pub latencies: ByKind<KindLatencies>,
    /// What the array's observers saw.
    pub observed: Observed,
}

/// Latencies in rising order: each from the cycle in which the host writes a ray's first word to that in which it reads
/// the last word of the ray's hit, both counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KindLatencies(Vec<u64>);

impl KindLatencies {
    fn new(mut latencies: Vec<u64>) -> KindLatencies {
        latencies.sort_unstable();
        KindLatencies(latencies)
    }

    /// The latency that `percent` % of the rays do not exceed: 0 gives the shortest, 100 the longest. 0 without rays.
    pub fn percentile(&self, percent: u32) -> Cycles {
        let rank = (self.0.len() * percent as usize).div_ceil(100).max(1);
        Cycles(self.0.get(rank - 1).copied().unwrap_or(0))
    }

    /// The mean, in cycles; 0 without rays.
    pub fn mean(&self) -> f64 {
        if self.0.is_empty() { 0.0 } else { self.0.iter().sum::<u64>() as f64 / self.0.len() as f64 }
    }
}

/// What times an image.
#[derive(Clone, Debug)]
pub struct Timed<'a> {
    /// The machine.
    pub spec: &'a MachineSpec,
    /// What its host may do.
    pub rules: HostRules,
    /// What is watched of it over time.
    pub watching: Watching,
}

/// Makes an image; with a machine, it also times it.
///
/// `observe` sees it grow: for progress, or to keep the ops.
///
/// # Errors
///
/// If the machine cannot run the workload ([`Workload::check`]), or not for such a host
/// ([`Workload::check_closed_loop`]); if the array or a cell's program cannot go on; if `observe` fails; and if it is told
/// to stop.
pub fn render<E>(
    picture: &Picture,
    timed: Option<Timed<'_>>,
    workers: &Workers,
    mut observe: impl FnMut(Seen<'_>) -> Result<(), E>,
) -> Result<Rendered, RunError<E>> {
    let order = timed.as_ref().map_or(Order::Raster, |timed| timed.rules.order);
    let mut host = timed.map(|timed| timed.host(picture)).transpose()?;
    let look = &Look::new(picture);
    let mut canvas = Canvas::new(picture, look);
    let mut seen = |seen: Seen<'_>| {
        workers.cancel.check()?;
        observe(seen).map_err(RunError::Observer)
    };
    let first = Pass::first(picture.size, picture.sampling, order);
    canvas.take_pass(&first, workers.threads, &mut host, &mut seen)?;
    if let Some(second) = canvas.second_pass(&first) {
        canvas.refined = second.pixel_numbers();
        canvas.take_pass(&second, workers.threads, &mut host, &mut seen)?;
    }
    if let Some(host) = &mut host {
        host.drain(&mut |ops, hit, ray| seen(Seen::Sent(ops, hit, ray)))?;
    }
    let timing = host.map(finish).transpose()?;
    Ok(canvas.rendered(timing))
}

/// Makes some lines of an image, untimed. The pixels of all others are black.
///
/// Lines that are made apart are those of the whole image, to the bit, and what is counted on them adds up to what is
/// counted on that.
///
/// # Errors
///
/// If a cell's program cannot go on; if `observe` fails; and if it is told to stop.
pub fn render_lines<E>(
    picture: &Picture,
    lines: Range<u32>,
    workers: &Workers,
    mut observe: impl FnMut(Seen<'_>) -> Result<(), E>,
) -> Result<Rendered, RunError<E>> {
    let (width, count) = (picture.size.width as usize, picture.size.pixels());
    let own = lines.start as usize * width..(lines.end as usize * width).min(count);
    let look = &Look::new(picture);
    let mut canvas = Canvas::new(picture, look);
    let mut seen = |seen: Seen<'_>| {
        workers.cancel.check()?;
        observe(seen).map_err(RunError::Observer)
    };
    let all = Pass::first(picture.size, picture.sampling, Order::Raster);
    let first = all.clone().within(own.clone());
    canvas.take_pass(&first, workers.threads, &mut None, &mut seen)?;
    if look.is_some() {
        // What the lines above and below show decides on these; it is counted where they are made.
        let mut beside = Canvas::new(picture, look);
        for line in [own.start.saturating_sub(width)..own.start, own.end..(own.end + width).min(count)] {
            let pass = all.clone().within(line.clone());
            beside.take_pass(&pass, workers.threads, &mut None, &mut |_| {
                workers.cancel.check().map_err(RunError::from)
            })?;
            canvas.shown.keys[line.clone()].copy_from_slice(&beside.shown.keys[line]);
        }
    }
    if let Some(second) = canvas.second_pass(&all) {
        let second = second.within(own);
        canvas.refined = second.pixel_numbers();
        canvas.take_pass(&second, workers.threads, &mut None, &mut seen)?;
    }
    Ok(canvas.rendered(None))
}

impl Timed<'_> {
    fn host<'a>(self, picture: &Picture<'a>) -> Result<ClosedLoop<'a>, InputError> {
        let workload = picture.workload;
        workload.check(self.spec)?;
        workload.check_closed_loop()?;
        let array = self.watching.array(self.spec, workload.costs(), workload.cells(), UNLIMITED);
        Ok(ClosedLoop::new(array, workload, self.rules, picture.screen.is_some()))
    }
}

fn finish(mut host: ClosedLoop<'_>) -> Result<Timing, Unfinished> {
    let latencies = std::mem::take(&mut host.latencies).map(KindLatencies::new);
    let (stats, observed) = host.into_array().finish_observed()?;
    Ok(Timing { stats, latencies, observed })
}

/// What is known of the image.
struct Canvas<'a> {
    picture: &'a Picture<'a>,
    look: Option<&'a Look>,
    pixels: Vec<Vec3>,
    /// What each pixel shows, if adaptive sampling asks for it.
    shown: Shown,
    refined: Vec<u32>,
    samples: u64,
    counts: Counts,
    kinds: ByKind<KindCounts>,
}

impl<'a> Canvas<'a> {
    fn new(picture: &'a Picture<'a>, look: &'a Option<Look>) -> Canvas<'a> {
        Canvas {
            picture,
            look: look.as_ref(),
            pixels: vec![Vec3::ZERO; picture.size.pixels()],
            shown: look.as_ref().map(|look| look.blank(picture)).unwrap_or_default(),
            refined: Vec::new(),
            samples: 0,
            counts: Counts::default(),
            kinds: Default::default(),
        }
    }

    /// The pass that adaptive sampling asks for behind the first one.
    fn second_pass(&self, first: &Pass) -> Option<Pass> {
        let Sampling { side, adaptive } = self.picture.sampling;
        self.look.and(adaptive).map(|criterion| Pass::second(first, (criterion, side), &self.shown))
    }

    fn rendered(self, timing: Option<Timing>) -> Rendered {
        let Canvas { pixels, counts, kinds, samples, refined, .. } = self;
        Rendered { pixels, counts, kinds, samples, refined, timing }
    }

    fn take_pass<E>(
        &mut self,
        pass: &Pass,
        threads: usize,
        host: &mut Option<ClosedLoop<'_>>,
        observe: &mut impl FnMut(Seen<'_>) -> Result<(), RunError<E>>,
    ) -> Result<(), RunError<E>> {
        let picture = self.picture;
        let cells = picture.workload.cells();
        let shader = Shader::new(picture.scene, picture.workload.polygons(), picture.limits);
        let shader = shader.with_rules(picture.rules);
        let view = View::new(&picture.scene.camera, picture.size);
        // What refined samples show, nobody asks for.
        let look = self.look.filter(|_| pass.per_pixel() == 1);
        let worker = || Grower {
            tracer: Tracer::new(picture.workload),
            costs: picture.workload.costs(),
            shader: &shader,
            view,
            screen: picture.screen,
            look,
        };
        let per_batch = (BATCH_LINES / cells / RAYS_PER_TREE).clamp(*TREES_PER_BATCH.start(), *TREES_PER_BATCH.end());
        let samples = |index: usize| index * per_batch..pass.len().min((index + 1) * per_batch);
        let make =
            |grower: &mut Grower<'_>, index: usize, batch: TreeBatch| grower.grow(pass, samples(index), cells, batch);
        let (mut index, mut sum) = (0, DVec3::ZERO);
        ahead::in_order(pass.len().div_ceil(per_batch), threads, worker, make, |mut batch| {
            batch.traced.fault.take().map_or(Ok(()), Err)?;
            let range = samples(index);
            self.counts += batch.traced.counts;
            self.kinds.iter_mut().zip(batch.kinds).for_each(|(all, new)| *all += new);
            self.samples += range.len() as u64;
            for (sample, &color) in range.clone().zip(&batch.colors) {
                self.take_sample(pass, sample, color, &mut sum);
            }
            range.clone().zip(&batch.shown).for_each(|(sample, &key)| self.shown.keys[pass.pixel(sample)] = key);
            index += 1;
            let pixels: Vec<usize> = range.clone().map(|sample| pass.pixel(sample)).collect();
            observe(Seen::Grown(&batch, &pixels))?;
            let array = host.as_ref().map(ClosedLoop::array);
            observe(Seen::Samples { done: range.end, of: pass.len(), array })?;
            match host {
                Some(host) => host.add(batch, &mut |ops, hit, ray| observe(Seen::Sent(ops, hit, ray))),
                None => Ok(batch),
            }
        })
    }

    /// Adds a sample; after a pixel's last one, `sum` is its light, and starts anew.
    fn take_sample(&mut self, pass: &Pass, sample: usize, color: DVec3, sum: &mut DVec3) {
        *sum += color;
        if (sample + 1).is_multiple_of(pass.per_pixel()) {
            let pixel = pass.pixel(sample);
            self.pixels[pixel] = (*sum / pass.per_pixel() as f64).as_vec3();
            *sum = DVec3::ZERO;
        }
    }
}

/// The object that a hit shows.
pub(super) fn object(mesh: &Mesh, hit: &Hit) -> Option<Object> {
    hit.is_hit().then(|| mesh.object(&mesh.faces()[hit.polygon as usize]))
}
