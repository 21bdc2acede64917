//! A run as the cost model sees it.

use super::layers::{Layers, PlannedRun};
use super::{Workers, trace};
use crate::cancel::{Cancel, Cancelled};
use crate::error::InputError;
use crate::geometry::partition::SubVolume;
use crate::geometry::{Bounds, Ray};
use crate::machine::{FifoName, Machine, MachineSpec, RateCounts};
use crate::measure::{Actor, Measured, StateKind, StateTimes};
use crate::model::cost::KernelTime;
use crate::model::passage::{Fifos, Passage};
use crate::model::{
    ArrayModel, Bound, CellLoad, Depth, Expectation, Few, LinkLoad, Links, Prediction, Stage, Stretches, Survey, Times,
};
use crate::program::{ArrayProgram, Kernel, Masks, NotLaidOut, Workload};
use crate::seam::Channel;

/// An array program on a machine, as the model sees it.
pub fn array_model(program: &ArrayProgram, machine: &Machine) -> ArrayModel {
    let stage = |kernels: &Vec<Kernel>| Stage {
        grid: kernels.contains(&Kernel::Grid),
        slabs: kernels.contains(&Kernel::Slabs),
        intersection: kernels.contains(&Kernel::Intersection),
    };
    let time = |times: crate::machine::Times| KernelTime { start: times.start.0 as f64, each: times.each.0 as f64 };
    let rate = machine.spec.link_rate();
    ArrayModel {
        stages: program.stages.iter().map(stage).collect(),
        times: Times {
            grid: time(machine.times.grid),
            slabs: time(machine.times.slabs),
            intersection: time(machine.times.intersection),
            host_ray: machine.times.host.ray.0 as f64,
        },
        mask_words: program.masks.words(program.groups) as f64,
        links: Links { cycles_per_word: rate.cycles_per_word as f64, shared: rate.counts == RateCounts::Link },
        cycles_per_second: 1e9 / machine.spec.clock_ns,
    }
}

/// What the cost model expects of a run.
#[derive(Clone, Debug)]
pub struct Forecast {
    /// The array as the model sees it.
    pub array: ArrayModel,
    /// What it will have to do, and how fast.
    pub predicted: Prediction,
    /// The grid coefficient that the model takes for the best, and what to expect of it.
    pub best: (f64, Prediction),
    /// How long it will take, by the passage of a few of its rays; `None` if they do not come to an end.
    pub expected: Option<Expectation>,
    /// How deep its FIFOs must be for less to be lost to waiting.
    pub depths: Vec<Depth>,
    /// How many rays were traced for that.
    pub traced: usize,
    /// Polygons of the scene.
    pub polygons: usize,
    /// Rays of the run.
    pub rays: usize,
}

impl Layers {
    /// Predicts a run of primary rays.
    ///
    /// # Errors
    ///
    /// If files cannot be read, if the program does not go with the scene, and if it is told to stop.
    pub fn forecast(&mut self, run: &PlannedRun, cancel: &Cancel) -> Result<Forecast, NotLaidOut> {
        let (scene, prepared, program) = (self.scene(run)?, self.prepared(run)?, &run.spec.program);
        let (surfaces, rays, host) = (&prepared.surfaces, &prepared.rays, run.machine.times.host);
        let mut array = array_model(program, &run.machine);
        if prepared.screen.is_some() {
            array.times.host_ray += host.filter.0 as f64 * prepared.samples_per_ray();
        }
        if program.masks != Masks::Off {
            array.times.host_ray += (host.mask.0 * program.groups as u64) as f64;
        }
        let workload = self.workload(run, cancel)?;
        let part = |(volume, members): (Bounds, &[u32])| SubVolume { volume, members: members.to_vec() };
        let sub_volumes: Vec<SubVolume> = workload.sub_volumes().map(part).collect();
        let survey = Survey::new(surfaces.polygons(), &sub_volumes, rays).masked(program.masks, &scene.camera);
        let too_large = |error| InputError::new(format!("{error}"));
        let predicted = survey.predict(&array, program.grid_coefficient).map_err(too_large)?;
        let best = survey.best_coefficient(&array).map_err(too_large)?;
        let (some, fifos) = (few(&workload, rays, cancel)?, fifos(&run.machine.spec, workload.cells()));
        let (expected, depths, traced) = (some.expect(&fifos), some.depths(&fifos), some.passage.rays());
        let (polygons, rays) = (surfaces.polygons().len(), rays.len());
        Ok(Forecast { array, predicted, best, expected, depths, traced, polygons, rays })
    }
}

/// A few of the rays of a run, in the order in which they are sent, traced to stand for all.
///
/// # Errors
///
/// If it is told to stop.
pub fn few(workload: &Workload, rays: &[Ray], cancel: &Cancel) -> Result<Few, Cancelled> {
    let stretches = Stretches::of(rays, workload.cells());
    let some: Vec<Ray> = stretches.traced.iter().map(|&place| rays[place]).collect();
    let mut passage = Passage::new(workload.cells());
    let workers = Workers { cancel: cancel.clone(), ..Workers::on_all_cores() };
    trace(&workload.of_some(&stretches.traced), &some, &workers, |batch| {
        cancel.check()?;
        passage.take(&batch.ops, workload.costs());
        Ok::<_, Cancelled>(batch)
    })?;
    Ok(Few { passage, stretches })
}

/// The FIFOs and links of a row of so many cells, as the model sees them.
pub fn fifos(spec: &MachineSpec, cells: usize) -> Fifos {
    let words = |link: usize| {
        Channel::ALL.map(|channel| {
            // What goes to the left is taken by the cell before, which on the first link is none.
            let reader = if channel == Channel::Z { link.saturating_sub(1) } else { link };
            spec.fifo_words_of(FifoName { channel, reader: Actor::Station(reader) }).0
        })
    };
    let rate = spec.link_rate();
    Fifos {
        words: (0..cells).map(words).collect(),
        latency: spec.link_latency().0,
        cycles_per_word: rate.cycles_per_word,
        shared: rate.counts == RateCounts::Link,
    }
}

/// The loads of a run, as counted, and the bound that follows from them.
#[derive(Clone, Debug, PartialEq)]
pub struct CountedLoads {
    /// Each cell's, a ray.
    pub cells: Vec<CellLoad>,
    /// Each link's, a ray.
    pub links: Vec<LinkLoad>,
    /// What no run of these ops can pass.
    pub bound: Bound,
}

impl CountedLoads {
    /// Those of a run. `predicted` lends the waits between words, which follow from the messages' lengths alone.
    pub fn new(stats: &Measured, array: &ArrayModel, predicted: &[CellLoad]) -> CountedLoads {
        let rays = stats.jobs.max(1) as f64;
        let states = &stats.topology.states;
        let on = |cell: &StateTimes, activity: &str| states.sum(cell, |state| state.name == activity).0 as f64 / rays;
        let cell = |(cell, predicted): (&StateTimes, &CellLoad)| CellLoad {
            grid: on(cell, "grid"),
            slabs: on(cell, "slabs"),
            intersection: on(cell, "intersection"),
            moving: states.sum(cell, |state| state.kind == StateKind::Moves).0 as f64 / rays,
            link_wait: predicted.link_wait,
        };
        let count = stats.stations.len();
        let reader = |link: usize| if link == count { Actor::Host } else { Actor::Station(link) };
        let words = |channel: &str, link: usize| stats.words_into(channel, reader(link)).0 as f64 / rays;
        let cells: Vec<CellLoad> = stats.stations.iter().zip(predicted).map(cell).collect();
        let link = |link| LinkLoad { x: words("X", link), y: words("Y", link) };
        let links: Vec<LinkLoad> = (0..=count).map(link).collect();
        let bound = Bound::new(array.host_load(), &cells, &links, array.links);
        CountedLoads { cells, links, bound }
    }
}
