//! An image on a hypercube, described as a value ([`CubeSpec`]), laid out, and run.

mod bounds;
mod calibrate;
mod cut;
mod forecast;
mod options;
mod shares;
mod spec;
mod tasks_file;
mod trees;

use std::convert::Infallible;
use std::path::Path;

use glam::Vec3;

use super::{RunError, Watching, Workers};
use crate::cancel::{Cancel, Cancelled};
use crate::error::InputError;
use crate::geometry::{CellPlane, Eye, Hit, Pyramids, Regions};
use crate::host::order::Order;
use crate::host::sampling::Pass;
use crate::machine::events::{Acting, Events, Queues, Turn};
use crate::machine::{Cycles, Ipsc2, Ipsc2File};
use crate::measure::{Measured, Observed, Recording, SoFar, Topology};
use crate::program::cube::{
    MemoryNodes, PageMap, Part, Phases, Preparation, RegionNodes, Seen, Space, TaskGraph, highest_rank, topology,
};
use crate::program::{Spared, Workload};
use crate::run::one_cell::Whole;
use crate::run::render::Picture;
use crate::run::trees::ByKind;
use crate::scene::Scene;

pub use calibrate::{Calibrated, Known, KnownTime};
pub use cut::Cut;
pub use forecast::CubeForecast;
pub use options::{
    CellCuts, CubeMode, CubeOptions, CubeRunOptions, Distribution, First, FlowKind, Grant, Grids, Mapping, Percent,
    PixelOrder, PixelsOf, QueueRays, Termination,
};
use shares::order;
pub use spec::{CubeSpec, RegionSpec};
use trees::{Traced, Tracing};

/// The scene of an image, and what its rays make the nodes do.
#[derive(Clone, Debug)]
pub struct CubeScene {
    /// Its name.
    pub name: String,
    /// How many polygons it has.
    pub polygons: usize,
    /// What is to be done.
    pub graph: TaskGraph,
    /// How it is cut.
    pub cut: Cut,
    /// The image: its pixels' light, line by line. None of it was recorded with tasks.
    pub pixels: Vec<Vec3>,
    /// The hits of all rays, if they were asked for.
    pub found: Option<Found>,
    /// How many rays there are of each kind, and how many hit.
    pub kinds: ByKind<(u64, u64)>,
    /// What rules spared.
    pub spared: Spared,
    /// What reading it changed.
    pub notes: Vec<String>,
}

/// What the rays of an image have found, and where.
#[derive(Clone, Debug)]
pub struct Found {
    /// The hits of all rays, tree by tree.
    pub hits: Vec<Hit>,
    /// The scene.
    pub scene: Scene,
    /// The scene as one node would have it.
    pub workload: Workload,
}

/// An image that is laid out for its nodes.
#[derive(Debug)]
pub struct CubeSetup {
    /// What is run.
    pub spec: CubeSpec,
    /// On what.
    pub machine: Ipsc2,
    /// What is to be done.
    pub scene: CubeScene,
}

/// What an image on a hypercube came to.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeOutcome {
    /// Where all time went, from the first pixel on. The last station is the host.
    pub stats: Measured,
    /// What was seen of it over time.
    pub observed: Observed,
    /// What was counted beside.
    pub seen: Seen,
    /// What all pixels take on one node that has all of the scene.
    pub one_node: Cycles,
    /// What came before.
    pub phases: Phases,
    /// Each region's node.
    pub node_of: Vec<u16>,
    /// The node that each pixel belongs to, if nodes have regions.
    pub owners: Vec<u16>,
    /// Each node's part of the scene.
    pub parts: Vec<Part>,
    /// The slots of each node, if these are limited.
    pub slots: Option<u32>,
    /// The highest rank of any ray, if rays are sent.
    pub highest_rank: u32,
}

/// Steps of the nodes between two looks at whether they are to be stopped.
const STEPS: usize = 1 << 16;

/// All times of a run together stay below, so that no clock leaves 64 bits.
const LONGEST_RUN: u128 = 1 << 61;

impl CubeSetup {
    /// Lays an image out. `observe` sees how many of its samples are traced, of all.
    ///
    /// # Errors
    ///
    /// As [`CubeSpec::lay_out`], and if the machine is impossible or has no room.
    pub fn new<E>(
        spec: CubeSpec,
        keeps_hits: bool,
        workers: &Workers,
        observe: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<CubeSetup, RunError<E>> {
        let machine = spec.machine.build()?;
        let scene = spec.lay_out(keeps_hits, workers, observe)?;
        Ok(CubeSetup { spec, machine, scene })
    }

    /// An image whose tasks were recorded, with changes to all that they do not depend on.
    ///
    /// Fails if the file has no tasks, or if the options would change them or make an impossible machine.
    pub fn of_tasks(path: &Path, options: &CubeRunOptions) -> Result<CubeSetup, InputError> {
        let (recorded, scene) = CubeScene::read_tasks(path)?;
        let spec = CubeSpec::new(options, Some(recorded.clone()))?;
        let fits = |changed: &CubeSpec| {
            let work = |spec: &CubeSpec| {
                let times_us = recorded.machine.times_us;
                CubeSpec { machine: Ipsc2File { times_us, ..spec.machine.clone() }, ..spec.clone() }.work_key()
            };
            work(changed) == work(&recorded)
        };
        if !fits(&spec) {
            let error = InputError::in_file(path, "its tasks are of another scene, image or number of regions");
            return Err(error.help("leave out what changes them, or trace the scene again"));
        }
        let machine = spec.machine.build()?;
        Ok(CubeSetup { spec, machine, scene })
    }

    /// What the user should know before the figures: what had to be rounded, cut or assumed.
    pub fn notes(&self) -> impl Iterator<Item = &str> {
        self.machine.notes.iter().chain(&self.scene.notes).map(String::as_str)
    }

    /// Lets the nodes run.
    ///
    /// # Errors
    ///
    /// As [`CubeSpec::run`].
    pub fn run(&self, watching: &Watching, cancel: &Cancel) -> Result<CubeOutcome, RunError<Infallible>> {
        self.spec.run(&self.scene, &self.machine, watching, cancel)
    }

    /// The same. `show` is called now and then; it can ask what has been done so far.
    ///
    /// # Errors
    ///
    /// As [`CubeSpec::run`].
    pub fn run_shown(
        &self,
        watching: &Watching,
        cancel: &Cancel,
        show: impl FnMut(&dyn Fn() -> SoFar),
    ) -> Result<CubeOutcome, RunError<Infallible>> {
        self.spec.run_shown(&self.scene, &self.machine, watching, cancel, show)
    }
}

impl CubeSpec {
    /// How many samples the image has.
    pub fn samples(&self) -> usize {
        self.size.pixels() * (self.rays.samples as usize).pow(2)
    }

    /// The scene, cut for the nodes, with all that its rays make them do. `observe` sees how many of the samples are traced.
    ///
    /// # Errors
    ///
    /// If the scene cannot be read, or cannot be cut into so many regions; if `observe` fails; and if it is told to stop.
    pub fn lay_out<E>(
        &self,
        keeps_hits: bool,
        workers: &Workers,
        observe: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<CubeScene, RunError<E>> {
        let pass = Pass::first(self.size, self.sampling(), Order::Raster);
        self.lay_out_by(keeps_hits, workers, |tracing| tracing.pass(&pass, workers, observe))
    }

    /// The same of the samples that `trace` traces.
    fn lay_out_by<E>(
        &self,
        keeps_hits: bool,
        workers: &Workers,
        trace: impl FnOnce(&Tracing<'_>) -> Result<Traced, RunError<E>>,
    ) -> Result<CubeScene, RunError<E>> {
        let machine = self.machine.build()?;
        let CubeSpec { size_factor, resolution, size, .. } = *self;
        let whole =
            Whole { scene: &self.scene, size_factor, resolution, size, grid_coefficient: self.rays.grid_coefficient };
        let (scene, workload) = whole.lay_out(machine.times, &workers.cancel)?;
        let (sampling, limits) = (self.sampling(), self.limits());
        let picture =
            Picture { scene: &scene, workload: &workload, size, sampling, limits, screen: None, rules: self.rules };
        let pyramids = self.pyramids(&picture)?;
        let mut cut = self.cut(&picture, &machine, pyramids.as_ref(), workers)?;
        let own = match self.regions.map(|regions| regions.grids) {
            Some(Grids::Own) => cut.own_grids(&workload, self.rays.grid_coefficient, workers)?,
            _ => Vec::new(),
        };
        let pages = self.page_bytes.and_then(|bytes| {
            let grid = workload.grids().next()?;
            Some((PageMap::new(grid, workload.polygons(), bytes), bytes))
        });
        let space = Space { regions: &cut.regions, own: &own, pyramids: pyramids.as_ref() };
        let tracing = Tracing { picture, space, pages, hits: keeps_hits };
        let traced = trace(&tracing)?;
        let pixels = traced.pixels((self.rays.samples as usize).pow(2));
        let polygons = workload.polygons().len();
        let Traced { graph, hits, kinds, spared, .. } = traced;
        let (name, notes) = (scene.name.clone(), scene.notes.clone());
        let found = keeps_hits.then_some(Found { hits, scene, workload });
        Ok(CubeScene { name, polygons, graph, cut, pixels, found, kinds, spared, notes })
    }

    /// The regions of a scene, or all of it as one.
    fn cut<E>(
        &self,
        picture: &Picture<'_>,
        machine: &Ipsc2,
        pyramids: Option<&Pyramids>,
        workers: &Workers,
    ) -> Result<Cut, RunError<E>> {
        let Some(grid) = picture.workload.grids().next() else {
            return Err(InputError::new("the scene has no grid").into());
        };
        match &self.regions {
            None => Ok(Cut::none(Regions::whole(CellPlane::new(grid, 1)), picture.workload)),
            Some(spec) => Cut::by_sample(spec, picture, (grid, machine, pyramids), workers),
        }
    }

    /// The pyramids that are the regions' cells, if they are.
    ///
    /// Fails if the eye does not have all of the scene before it.
    fn pyramids(&self, picture: &Picture<'_>) -> Result<Option<Pyramids>, InputError> {
        let asked = self.regions.filter(|regions| regions.cell_cuts == CellCuts::Pyramids);
        let Some((regions, grid)) = asked.zip(picture.workload.grids().next()) else { return Ok(None) };
        let eye = Eye::of(&picture.scene.camera);
        let pyramids = Pyramids::new(eye, grid.volume(), regions.cell_grid);
        let around = || {
            InputError::new("pyramids start at the eye, which does not have all of the scene before it")
                .help("take other --cell-cuts, or another scene")
        };
        pyramids.map(Some).ok_or_else(around)
    }

    /// Lets the nodes run.
    ///
    /// # Errors
    ///
    /// If a node has no room for its part of the scene and its queue, or the run would take longer than can be counted; if the nodes
    /// are stuck; and if it is told to stop.
    pub fn run(
        &self,
        scene: &CubeScene,
        machine: &Ipsc2,
        watching: &Watching,
        cancel: &Cancel,
    ) -> Result<CubeOutcome, RunError<Infallible>> {
        self.run_shown(scene, machine, watching, cancel, |_| {})
    }

    fn run_shown(
        &self,
        scene: &CubeScene,
        machine: &Ipsc2,
        watching: &Watching,
        cancel: &Cancel,
        mut show: impl FnMut(&dyn Fn() -> SoFar),
    ) -> Result<CubeOutcome, RunError<Infallible>> {
        let one_node = one_node(&scene.graph, machine)?;
        let node_of = self.node_of(&scene.cut, machine);
        let parts = self.parts(scene, machine, &node_of);
        let slots = self.slots(&scene.graph, &parts, machine)?;
        let phases = prepare(machine, &parts);
        let highest_rank = highest_rank(&scene.graph);
        let owners = self.regions.map(|spec| self.owners(&spec, &scene.graph, &node_of)).unwrap_or_default();
        let (stats, observed, seen) = match &self.regions {
            Some(spec) => {
                self.check_slots(slots, highest_rank)?;
                let rules = spec.rules(slots.unwrap_or(0));
                let order = order(spec, scene.graph.trees.len());
                let nodes = RegionNodes::new(machine, &scene.graph, &node_of, (&owners, &order), rules);
                let Some(mut nodes) = nodes else {
                    return Err(InputError::new("there are more rays than can be counted")
                        .help("make the image smaller")
                        .into());
                };
                nodes.queues = watched_queues(nodes.queues, machine, watching);
                let mut events = watched(nodes.topology(), 0, machine, watching);
                if watching.path {
                    events = events.explained(nodes.explain(), RegionNodes::sending);
                }
                let mut show = |nodes: &RegionNodes<'_>, events: &Events<_>| {
                    cancel.check()?;
                    show(&|| SoFar { fifos: nodes.queues.so_far(), ..events.so_far() });
                    Ok(())
                };
                let next = |nodes: &mut RegionNodes<'_>, task, now, turn: &mut Acting<'_, _>| {
                    nodes.next(task, now, turn);
                };
                let events = drive(&mut nodes, events, (next, RegionNodes::is_over), &mut show)?;
                if !nodes.is_over() {
                    return Err(nodes.stuck().into());
                }
                let (mut stats, mut observed) = events.stop(|task| nodes.rests(task));
                nodes.queues.tell(&mut stats, &mut observed);
                (stats, observed, nodes.seen)
            }
            None => {
                let nodes = MemoryNodes::new(machine, &scene.graph, self.dealt(machine.nodes));
                let Some(mut nodes) = nodes else {
                    return Err(InputError::new("it was not recorded which pages the rays read").into());
                };
                let mut events = watched(nodes.topology(), nodes.helpers(), machine, watching);
                if watching.path {
                    events = events.explained(nodes.explain(), MemoryNodes::sending);
                }
                let mut show = |_: &MemoryNodes<'_>, events: &Events<_>| {
                    cancel.check()?;
                    show(&|| events.so_far());
                    Ok(())
                };
                let next = |nodes: &mut MemoryNodes<'_>, task, now, turn: &mut Acting<'_, _>| {
                    let taken = turn.taken();
                    turn.act(nodes.next(task, now, taken.as_ref()));
                };
                let events = drive(&mut nodes, events, (next, MemoryNodes::is_over), &mut show)?;
                let (stats, mut observed) = events.stop(|task| nodes.rests(task));
                observed.path.iter_mut().for_each(|path| nodes.told_of_nodes(path));
                (stats, observed, nodes.seen)
            }
        };
        Ok(CubeOutcome {
            stats,
            observed,
            seen,
            one_node,
            phases,
            node_of,
            owners: self.of_pixels(owners),
            parts,
            slots,
            highest_rank,
        })
    }
}

/// What all pixels take on one node that has all of the scene.
fn one_node(graph: &TaskGraph, machine: &Ipsc2) -> Result<Cycles, InputError> {
    let rays = (0..graph.rays.len() as u32).map(|ray| u128::from(graph.time_in_one(ray, &machine.times).all().0));
    let all = rays.sum::<u128>() + u128::from(machine.costs.pixel.0) * graph.trees.len() as u128;
    match all < LONGEST_RUN {
        true => Ok(Cycles(all as u64)),
        false => Err(InputError::new("the work of all pixels takes longer than can be counted")
            .help("make the image smaller, or the machine faster")),
    }
}

/// What comes before the first pixel.
fn prepare(machine: &Ipsc2, parts: &[Part]) -> Phases {
    let mut preparation = Preparation::new(machine, parts);
    let mut events = Events::new(topology(machine.nodes, "block"), machine.cube(), RegionNodes::SENDING_AND_IDLE);
    while events.step(&mut |task, now, turn| {
        turn.act(preparation.next(task, now));
    }) {}
    preparation.phases
}

fn watched<M: Copy>(topology: Topology, helpers: usize, machine: &Ipsc2, watching: &Watching) -> Events<M> {
    let events = Events::with_helpers(topology, helpers, machine.cube(), RegionNodes::SENDING_AND_IDLE);
    let events = if watching.profile { events.probed() } else { events };
    let events = if watching.spans { events.noting_spans() } else { events };
    match &watching.recording {
        Some(window) => events.recorded(window.clone(), Recording::MOST_EVENTS),
        None => events,
    }
}

fn watched_queues(queues: Queues, machine: &Ipsc2, watching: &Watching) -> Queues {
    // The host is a station, too.
    let queues = if watching.profile { queues.probed(machine.nodes + 1) } else { queues };
    match &watching.recording {
        Some(window) => queues.recorded(window.clone(), Recording::MOST_EVENTS),
        None => queues,
    }
}

/// Lets nodes run until all is over, or none can go on. Of them is known how a task acts, and whether all is over; `look` sees them now and
/// then.
fn drive<P, M: Copy>(
    nodes: &mut P,
    mut events: Events<M>,
    (next, is_over): (impl Fn(&mut P, usize, Cycles, &mut Acting<'_, M>), impl Fn(&P) -> bool),
    look: &mut impl FnMut(&P, &Events<M>) -> Result<(), Cancelled>,
) -> Result<Events<M>, RunError<Infallible>> {
    loop {
        for _ in 0..STEPS {
            if is_over(nodes) || !events.step(&mut |task, now, turn| next(nodes, task, now, turn)) {
                return Ok(events);
            }
        }
        look(nodes, &events)?;
    }
}
