//! A run in layers, each made of the one before: the scene, what is prepared of it, what is laid out, the ops, and the times.
//!
//! Each has a [`Key`] of exactly what it reads. Whoever changes one thing redoes the first layer that reads it and those
//! behind it, and nothing else: a change of Figure 7's times, of the clock, the links or the FIFOs is a replay.

use std::collections::HashMap;
use std::convert::Infallible;
use std::fmt::Debug;
use std::sync::Arc;

use super::options::{CellsRun, Switch};
use super::recording_memory::RecordingMemory;
use super::timed::{Outcome, RunError, TakeBatch, Watching, replay_watched, run_watched};
use super::trace::{TracedBatch, trace};
use super::{RunSpec, Workers, trees};
use crate::cancel::{Cancel, Cancelled};
use crate::error::InputError;
use crate::geometry::{Hit, Partition, Ray};
use crate::host::order::Sequence;
use crate::host::screen::{self, Screen, ScreenRectangles};
use crate::host::shading::Shader;
use crate::input::reading;
use crate::isa::InstructionCycles;
use crate::machine::{Machine, MachineSpec, Observed};
use crate::measure::Measured;
use crate::program::{ArrayProgram, Counts, Layout, NotLaidOut, Sample, Surfaces, Workload, sub_sample, work};
use crate::scene::Scene;
use crate::seam::{Costs, OpBatch};

/// How many rays of all kinds a cut looks at, at the most: it looks at them again and again.
const MOST_SAMPLED: usize = 4096;

/// What a layer of a run depends on. Two layers with the same key are the same, as long as the files that they read are.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Key(String);

impl Key {
    pub(super) fn of(what: impl Debug) -> Key {
        Key(format!("{what:?}"))
    }
}

/// The keys of a run's layers. Each holds those before it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Keys {
    /// The scene, read or generated.
    pub scene: Key,
    /// Its rays, and its polygons in 32 bits.
    pub prepared: Key,
    /// The sub-volumes and their grids.
    pub laid_out: Key,
    /// Hits, counts and the cells' ops.
    pub traced: Key,
    /// The times.
    pub timed: Key,
}

impl Keys {
    fn new(spec: &RunSpec, machine: &Machine) -> Keys {
        // All fields by name, so that a new one cannot be forgotten here.
        let RunSpec { version: _, scene, size_factor, resolution, size, rays, order, image, program, .. } = spec;
        let RunSpec {
            edges, cells_run, cell_programs, instruction_limit, annex, screen_rectangles, machine: _, ..
        } = spec;
        let ArrayProgram { name: _, stages, groups, partition, numbering, grid_coefficient, .. } = program;
        let ArrayProgram { mailbox, stop_words, forward_ahead, rays_per_message, bounded_walk, masks, .. } = program;
        let Machine { spec: array, times, instructions, notes: _ } = machine;

        let scene = Key::of((scene, size_factor, resolution));
        let prepared = Key::of((&scene, rays.as_ref().ok_or(size), order, edges, screen_rectangles));
        let sample =
            || (times.grid.each, times.slabs, times.intersection, times.message, program.placement().slabs.is_some());
        let in_groups = || (times.grid.start, stages, mailbox, stop_words.is_some(), bounded_walk);
        let light = image.as_ref().filter(|_| program.cut_by_all_rays()).map(|image| image.limits());
        let cut = || match partition {
            Partition::Regular | Partition::Polygons => (partition, None, None),
            Partition::Work => (partition, Some(sample()), None),
            Partition::Measured => (partition, Some(sample()), Some(in_groups())),
        };
        let cut = (*groups > 1).then(|| (cut(), numbering, light));
        let laid_out = Key::of((&prepared, groups, cut, grid_coefficient));
        // A machine that does not say what instructions cost runs no programs, whatever others would make of their ops. Whether
        // waits are counted is up to it, too.
        let programs = (*cells_run == CellsRun::Programs).then_some((
            cell_programs,
            instruction_limit,
            annex,
            instructions.as_ref().map(InstructionCycles::counts_waits),
        ));
        // Times are in cycles: of the clock and of rates they know what these make in cycles.
        let MachineSpec { clock_ns: _, word_bytes: _, link_mb_s: _, rate_counts: _, fifo_words, .. } = array;
        let MachineSpec { latency, memory_words, channel_words, own_words, .. } = array;
        let array = (fifo_words, channel_words, own_words, memory_words, array.link_rate(), latency);
        // The host of an image sends what it sends next by what it has read until then.
        let clock = |timing| (timing == Switch::On).then_some((array, times, instructions));
        let image = image.as_ref().map(|image| (image, clock(image.timing)));
        let messages = (rays_per_message, times.message.is_some());
        let cells = (stages, mailbox, stop_words, forward_ahead, messages, bounded_walk, masks);
        let traced = Key::of((&laid_out, cells, programs, image));
        let kernels = (times.grid, times.slabs, times.intersection);
        let costs = match cells_run {
            CellsRun::Timings => (times.host, Some((kernels, times.message)), None),
            CellsRun::Programs => (times.host, None, instructions.as_ref()),
        };
        let timed = Key::of((&traced, array, costs));
        Keys { scene, prepared, laid_out, traced, timed }
    }
}

/// A run that is possible: its description, its machine in cycles, and what its layers depend on.
#[derive(Clone, Debug)]
pub struct PlannedRun {
    /// What is run.
    pub spec: RunSpec,
    /// On what.
    pub machine: Machine,
    /// What each layer depends on.
    pub keys: Keys,
}

impl PlannedRun {
    /// The run that is described. Fails if its machine is impossible.
    pub fn new(spec: RunSpec) -> Result<PlannedRun, InputError> {
        let machine = spec.machine.build()?;
        let keys = Keys::new(&spec, &machine);
        Ok(PlannedRun { spec, machine, keys })
    }
}

/// The second layer: a scene's rays, and its polygons as the array has them.
#[derive(Debug)]
pub struct Prepared {
    /// The rays of the run that are sent, in the order in which they are; of an image, its primary rays.
    pub rays: Vec<Ray>,
    /// The polygons.
    pub surfaces: Arc<Surfaces>,
    /// The pixels that can show anything, if the host tells by rectangles.
    pub screen: Option<Screen>,
    /// For each of the rays, how many samples the host has tested since it sent the one before.
    tested: Arc<Vec<u32>>,
    /// The numbers of the rays.
    numbers: Sequence,
    /// How many rays there are, with those that are not sent.
    count: usize,
}

impl Prepared {
    fn new(spec: &RunSpec, scene: &Scene, by_number: Vec<Ray>) -> Prepared {
        let surfaces = Arc::new(Surfaces::with_edges(&scene.mesh, &by_number, spec.edges));
        let (count, all) = (by_number.len(), spec.sequence(by_number.len()));
        let screen = (spec.screen_rectangles != ScreenRectangles::Off).then(|| {
            let rectangles = screen::rectangles(scene, surfaces.polygons(), spec.size, spec.screen_rectangles);
            Screen::new(spec.size, &rectangles)
        });
        let Some(screen) = screen else {
            let (rays, tested) = (all.arrange(by_number), Arc::default());
            return Prepared { rays, surfaces, screen: None, tested, numbers: all, count };
        };
        let (mut rays, mut numbers, mut tested, mut since) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for number in all.numbers() {
            since += 1;
            if screen.shows(number) {
                rays.push(by_number[number]);
                numbers.push(number as u32);
                tested.push(std::mem::take(&mut since));
            }
        }
        let (tested, numbers) = (Arc::new(tested), Sequence::of_numbers(numbers));
        Prepared { rays, surfaces, screen: Some(screen), tested, numbers, count }
    }

    fn load(spec: &RunSpec, scene: &Scene) -> Result<Arc<Prepared>, InputError> {
        spec.load_rays(scene).map(|rays| Arc::new(Prepared::new(spec, scene, rays)))
    }

    /// How many samples the host has tested for a ray that it sent, on average.
    pub(super) fn samples_per_ray(&self) -> f64 {
        self.tested.iter().map(|&samples| f64::from(samples)).sum::<f64>() / self.tested.len().max(1) as f64
    }

    /// The memory that it takes, in bytes.
    fn bytes(&self) -> u64 {
        let Prepared { rays, surfaces, screen, tested, numbers, count } = self;
        let of_screen = if screen.is_some() { count / 8 } else { 0 };
        surfaces.bytes() + numbers.bytes() + (size_of_val(&rays[..]) + size_of_val(&tested[..]) + of_screen) as u64
    }

    /// The number of the ray that is sent in a place, from 0: of a camera's its pixel's, line by line.
    pub fn number(&self, place: usize) -> usize {
        self.numbers.number(place)
    }

    /// How many rays there are, with those that are not sent.
    pub fn count(&self) -> usize {
        self.count
    }

    /// What there is of each ray that is sent, in the order in which they are, in the order of all rays' numbers: of pixels line by
    /// line. Those that are not sent have `unsent`.
    pub fn by_number<T: Copy>(&self, items: &[T], unsent: T) -> Vec<T> {
        let mut found = vec![unsent; self.count];
        self.numbers.numbers().zip(items).for_each(|(number, &item)| found[number] = item);
        found
    }
}

/// The fourth layer: all that the cells do for the rays, without times.
#[derive(Debug)]
pub struct Traced {
    workload: Workload,
    batches: Vec<Arc<OpBatch>>,
    counts: Counts,
    hits: Vec<Hit>,
    bytes: u64,
}

/// The layers of the run that was made last, for the next one to take what it can of them.
///
/// A file that changes between two runs is not read again. A clone shares what there is.
#[derive(Clone, Debug, Default)]
pub struct Layers {
    scene: Kept<Scene>,
    prepared: Kept<Prepared>,
    laid_out: Kept<Layout>,
    traced: Option<(Key, Arc<Traced>)>,
}

/// A layer with its key, or why it cannot be made.
type Kept<T> = Option<(Key, Result<Arc<T>, InputError>)>;

fn find<T>(kept: &Kept<T>, key: &Key) -> Option<Result<Arc<T>, InputError>> {
    kept.as_ref().filter(|kept| kept.0 == *key).map(|kept| kept.1.clone())
}

/// A layer, if it could be made.
fn made<T>(kept: &Kept<T>) -> Option<&Arc<T>> {
    kept.as_ref()?.1.as_ref().ok()
}

impl Layers {
    /// Takes a scene that is at hand for the one that a run names.
    pub fn give_scene(&mut self, run: &PlannedRun, scene: Arc<Scene>) {
        *self = Layers { scene: Some((run.keys.scene.clone(), Ok(scene))), ..Layers::default() };
    }

    /// Takes rays that are at hand for those that a run names. Fails if its scene cannot be read.
    pub fn give_rays(&mut self, run: &PlannedRun, rays: Vec<Ray>) -> Result<(), InputError> {
        let scene = self.scene(run)?;
        (self.laid_out, self.traced) = (None, None);
        self.prepared = Some((run.keys.prepared.clone(), Ok(Arc::new(Prepared::new(&run.spec, &scene, rays)))));
        Ok(())
    }

    /// A run's scene.
    pub fn scene(&mut self, run: &PlannedRun) -> Result<Arc<Scene>, InputError> {
        if let Some(scene) = find(&self.scene, &run.keys.scene) {
            return scene;
        }
        // What was made of the last scene makes room first.
        *self = Layers::default();
        let scene = run.spec.load_scene().map(Arc::new);
        self.scene = Some((run.keys.scene.clone(), scene.clone()));
        scene
    }

    /// Its rays and polygons.
    pub fn prepared(&mut self, run: &PlannedRun) -> Result<Arc<Prepared>, InputError> {
        if let Some(prepared) = find(&self.prepared, &run.keys.prepared) {
            return prepared;
        }
        let scene = self.scene(run)?;
        (self.prepared, self.laid_out, self.traced) = (None, None, None);
        let prepared = Prepared::load(&run.spec, &scene);
        self.prepared = Some((run.keys.prepared.clone(), prepared.clone()));
        prepared
    }

    /// Makes a run's scene, rays and polygons, so that they are at hand. Once it is told to stop it waits for them no longer.
    ///
    /// # Errors
    ///
    /// If it is told to stop. What is wrong with the scene is told where it is asked for.
    pub fn load(&mut self, run: &PlannedRun, cancel: &Cancel) -> Result<(), Cancelled> {
        self.load_scene(run, cancel)?;
        if find(&self.prepared, &run.keys.prepared).is_none()
            && let Some(Ok(scene)) = find(&self.scene, &run.keys.scene)
        {
            (self.prepared, self.laid_out, self.traced) = (None, None, None);
            let spec = run.spec.clone();
            let prepared = reading::wait_for(cancel, move || Prepared::load(&spec, &scene))?;
            self.prepared = Some((run.keys.prepared.clone(), prepared));
        }
        Ok(())
    }

    /// The same of the scene alone.
    pub fn load_scene(&mut self, run: &PlannedRun, cancel: &Cancel) -> Result<(), Cancelled> {
        if find(&self.scene, &run.keys.scene).is_some() {
            return Ok(());
        }
        *self = Layers::default();
        let spec = run.spec.clone();
        let scene = reading::wait_for(cancel, move || spec.load_scene().map(Arc::new))?;
        self.scene = Some((run.keys.scene.clone(), scene));
        Ok(())
    }

    fn laid_out(&mut self, run: &PlannedRun, cancel: &Cancel) -> Result<Arc<Layout>, NotLaidOut> {
        if let Some(layout) = find(&self.laid_out, &run.keys.laid_out) {
            return Ok(layout?);
        }
        self.load(run, cancel)?;
        let prepared = self.prepared(run)?;
        (self.laid_out, self.traced) = (None, None);
        let (surfaces, times) = (prepared.surfaces.clone(), run.machine.times);
        let sample = self.sample(run, cancel)?;
        let layout = match Layout::new(surfaces, &run.spec.program, times, sample, cancel) {
            Ok(layout) => Ok(Arc::new(layout)),
            Err(NotLaidOut::Unfit(error)) => Err(error),
            Err(NotLaidOut::Cancelled(cancelled)) => return Err(cancelled.into()),
        };
        self.laid_out = Some((run.keys.laid_out.clone(), layout.clone()));
        Ok(layout?)
    }

    /// What the cut looks at: a few rays of the run. Of an image they are its primary rays, or, for cuts that look at all kinds of rays,
    /// all rays of these samples.
    fn sample(&mut self, run: &PlannedRun, cancel: &Cancel) -> Result<Sample, NotLaidOut> {
        let (prepared, program, times) = (self.prepared(run)?, &run.spec.program, run.machine.times);
        let primary = sub_sample(&prepared.rays);
        let Some(image) = run.spec.image.as_ref().filter(|_| program.cut_by_all_rays()) else {
            return Ok(Sample { rays: primary, in_one_cell: None });
        };
        let one_cell = ArrayProgram::one_cell(program.grid_coefficient);
        let layout = Arc::new(Layout::new(prepared.surfaces.clone(), &one_cell, times, Sample::default(), cancel)?);
        let workload = Workload::of(layout.clone(), &one_cell, times);
        let scene = self.scene(run)?;
        let shader = Shader::new(&scene, workload.polygons(), image.limits());
        let all = trees::rays(&shader, &workload, primary, cancel)?;
        let rays = all.iter().step_by(all.len().div_ceil(MOST_SAMPLED).max(1)).copied().collect();
        Ok(Sample { rays, in_one_cell: Some(layout) })
    }

    /// What the array has to do: the scene laid out for its program, with the cells' programs if they run any.
    ///
    /// # Errors
    ///
    /// If files cannot be read, if the program does not go with the scene, and if it is told to stop.
    pub fn workload(&mut self, run: &PlannedRun, cancel: &Cancel) -> Result<Workload, NotLaidOut> {
        let workload = Workload::of(self.laid_out(run, cancel)?, &run.spec.program, run.machine.times);
        let (scene, prepared) = (self.scene(run)?, self.prepared(run)?);
        let workload = workload.seen_by(&scene.camera);
        let names_own = run.spec.image.as_ref().is_some_and(|image| image.rules.own);
        let workload = if names_own { workload.naming_own() } else { workload };
        let workload = match prepared.screen {
            // The host of an image finds out as it goes what it tests.
            Some(_) if run.spec.image.is_some() => workload.with_samples_tested(Arc::default()),
            Some(_) => workload.with_samples_tested(prepared.tested.clone()),
            None => workload,
        };
        match run.spec.cells_run {
            CellsRun::Programs => Ok(workload.with_programs(&run.spec.cell_options(&run.machine)?)?),
            CellsRun::Timings => Ok(workload),
        }
    }

    /// How many of them a run could take over, the scene alone being one.
    pub fn shared(&self, run: &PlannedRun) -> usize {
        let Keys { scene, prepared, laid_out, traced, timed: _ } = &run.keys;
        let shared = [
            find(&self.scene, scene).is_some(),
            find(&self.prepared, prepared).is_some(),
            find(&self.laid_out, laid_out).is_some(),
            self.traced.as_ref().is_some_and(|kept| kept.0 == *traced),
        ];
        shared.into_iter().filter(|shared| *shared).count()
    }

    /// What the cells do, if it is at hand for a run.
    pub fn kept(&self, run: &PlannedRun) -> Option<&Arc<Traced>> {
        self.traced.as_ref().filter(|kept| kept.0 == run.keys.traced).map(|kept| &kept.1)
    }

    /// Whether what the cells do is at hand for some run.
    pub fn has_recording(&self) -> bool {
        self.traced.is_some()
    }

    /// The memory that the layers of some runs take together, in bytes. What they share is counted once.
    pub fn bytes(all: &[Layers]) -> u64 {
        let parts: HashMap<*const (), u64> = all.iter().flat_map(Layers::parts).collect();
        parts.into_values().sum()
    }

    /// Where each layer is, with the memory that it takes.
    fn parts(&self) -> impl Iterator<Item = (*const (), u64)> {
        let Layers { scene, prepared, laid_out, traced } = self;
        let parts = [
            made(scene).map(|scene| (Arc::as_ptr(scene).cast(), scene.mesh.bytes())),
            made(prepared).map(|prepared| (Arc::as_ptr(prepared).cast(), prepared.bytes())),
            made(laid_out).map(|layout| (Arc::as_ptr(layout).cast(), layout.bytes())),
            traced.as_ref().map(|(_, traced)| (Arc::as_ptr(traced).cast(), traced.bytes)),
        ];
        parts.into_iter().flatten()
    }

    /// Runs primary rays. What the cells do is taken from the run before, if it was the same, and is kept for the next if it fits
    /// into the memory. `observe` sees each batch once, in order: its ops and, of rays that are traced now, its hits.
    ///
    /// # Errors
    ///
    /// As [`Layers::traced`] and [`run_watched`].
    pub fn run(
        &mut self,
        run: &PlannedRun,
        watching: &Watching,
        (workers, memory): (&Workers, RecordingMemory),
        mut observe: impl FnMut(&OpBatch, &[Hit]),
    ) -> Result<Outcome, RunError<Infallible>> {
        if let Some(traced) = self.kept(run).cloned() {
            let (stats, observed) = traced.time(&run.machine, watching, &workers.cancel)?;
            traced.batches.iter().for_each(|batch| observe(batch, &[]));
            return Ok(Outcome { stats, counts: traced.counts, hits: traced.hits.clone(), observed });
        }
        let workload = self.workload(run, &workers.cancel)?;
        let rays = &self.prepared(run)?;
        self.traced = None;
        let (mut batches, mut bytes) = (Some(Vec::new()), 0);
        let outcome = run_watched(&workload, (&run.machine.spec, watching), &rays.rays, workers, |batch, _| {
            observe(&batch.ops, &batch.hits);
            bytes += batch.ops.bytes() + (batch.hits.len() * size_of::<Hit>()) as u64;
            batches = batches.take().filter(|_| bytes <= memory.0);
            if let Some(batches) = &mut batches {
                batches.push(Arc::new(batch.ops.clone()));
            }
            Ok(())
        })?;
        let kept = |batches| Traced { workload, batches, counts: outcome.counts, hits: outcome.hits.clone(), bytes };
        self.traced = batches.map(|batches| (run.keys.traced.clone(), Arc::new(kept(batches))));
        Ok(outcome)
    }

    /// All that the cells do for the rays of a run of primary rays: kept in memory, to be timed any number of times.
    ///
    /// # Errors
    ///
    /// As [`Layers::workload`], and if a cell's program cannot go on.
    pub fn traced(&mut self, run: &PlannedRun, workers: &Workers) -> Result<Arc<Traced>, RunError<Infallible>> {
        let traced = self.traced_within(run, workers, RecordingMemory::UNBOUNDED)?;
        traced.ok_or_else(|| InputError::new("the recording is larger than any memory").into())
    }

    /// The same, if it fits into the memory that there is for recordings.
    ///
    /// # Errors
    ///
    /// As [`Layers::traced`].
    pub fn traced_within(
        &mut self,
        run: &PlannedRun,
        workers: &Workers,
        memory: RecordingMemory,
    ) -> Result<Option<Arc<Traced>>, RunError<Infallible>> {
        if let Some(traced) = self.kept(run) {
            return Ok(Some(traced.clone()));
        }
        let workload = self.workload(run, &workers.cancel)?;
        self.traced = None;
        let traced = Traced::new(workload, &self.prepared(run)?.rays, workers, memory)?.map(Arc::new);
        self.traced = traced.clone().map(|traced| (run.keys.traced.clone(), traced));
        Ok(traced)
    }
}

impl Traced {
    /// `None` if it does not fit into the memory.
    fn new(
        workload: Workload,
        rays: &[Ray],
        workers: &Workers,
        memory: RecordingMemory,
    ) -> Result<Option<Traced>, RunError<Infallible>> {
        let (mut batches, mut counts, mut hits) = (Vec::new(), Counts::default(), Vec::new());
        let mut bytes = 0;
        let traced = trace(&workload, rays, workers, |mut batch| {
            workers.cancel.check().map_err(|cancelled| Some(cancelled.into()))?;
            batch.fault.map_or(Ok(()), |fault| Err(Some(fault.into())))?;
            bytes += batch.ops.bytes() + (batch.hits.len() * size_of::<Hit>()) as u64;
            if bytes > memory.0 {
                return Err(None);
            }
            counts += batch.counts;
            hits.append(&mut batch.hits);
            batches.push(Arc::new(batch.ops));
            Ok::<_, Option<RunError<Infallible>>>(TracedBatch::default())
        });
        match traced {
            Ok(()) => Ok(Some(Traced { workload, batches, counts, hits, bytes })),
            Err(None) => Ok(None),
            Err(Some(error)) => Err(error),
        }
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// What the array had to do.
    pub fn workload(&self) -> &Workload {
        &self.workload
    }

    /// What host and cells do, batch by batch.
    pub fn batches(&self) -> &[Arc<OpBatch>] {
        &self.batches
    }

    /// What was counted.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Each ray's first hit, in the order of the rays.
    pub fn hits(&self) -> &[Hit] {
        &self.hits
    }

    /// Times the ops on the machine of a run with the same [`Keys::traced`].
    ///
    /// # Errors
    ///
    /// If the machine cannot run the workload, if the array can go no further, and if it is told to stop.
    pub fn time(
        &self,
        machine: &Machine,
        watching: &Watching,
        cancel: &Cancel,
    ) -> Result<(Measured, Observed), RunError<Infallible>> {
        self.workload.check(&machine.spec)?;
        let costs = costs_on(machine, &self.workload);
        let (watched, array) = ((&machine.spec, watching), (&costs, self.workload.cells()));
        let feed =
            |take: &mut TakeBatch<'_, Infallible>| self.batches.iter().try_for_each(|batch| take(Arc::clone(batch)));
        replay_watched(watched, array, cancel, feed, |_| ())
    }
}

/// What a workload's units of work cost on a machine.
pub(super) fn costs_on(machine: &Machine, workload: &Workload) -> Costs {
    work::costs(workload.costs().vocabulary(), &machine.times, machine.instructions.as_ref())
}
