//! A run as the cost model sees it.

use super::layers::{Layers, PlannedRun};
use crate::cancel::Cancel;
use crate::error::InputError;
use crate::machine::{Machine, RateCounts};
use crate::measure::{Actor, Measured, StateKind, StateTimes};
use crate::model::cost::KernelTime;
use crate::model::{ArrayModel, Bound, CellLoad, LinkLoad, Links, Prediction, Stage, Survey, Times};
use crate::program::{ArrayProgram, Kernel, Masks, NotLaidOut, sub_sample};

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
        let sub_volumes = surfaces.sub_volumes(program, run.machine.times, &sub_sample(rays), cancel)?;
        let survey = Survey::new(surfaces.polygons(), &sub_volumes, rays).masked(program.masks, &scene.camera);
        let too_large = |error| InputError::new(format!("{error}"));
        let predicted = survey.predict(&array, program.grid_coefficient).map_err(too_large)?;
        let best = survey.best_coefficient(&array).map_err(too_large)?;
        let (polygons, rays) = (surfaces.polygons().len(), rays.len());
        Ok(Forecast { array, predicted, best, polygons, rays })
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
