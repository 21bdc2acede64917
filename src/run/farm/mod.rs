//! A farm of workers, described as a value ([`FarmSpec`]), laid out, and run.

mod count;
mod options;
mod spec;

use std::convert::Infallible;

use super::{RunError, Watching, Workers};
use crate::cancel::Cancel;
use crate::error::InputError;
use crate::machine::events::{Events, Turn};
use crate::machine::{Capitan, Cycles};
use crate::measure::{Measured, Observed, Recording};
use crate::program::farm::{Farm, Items, PixelWork, Pixels, UNITS};

pub use options::{FarmOptions, FarmRunOptions, TaskRange};
pub use spec::{FarmRays, FarmSpec};

/// A farm's scene, and what its pixels take.
#[derive(Clone, Debug)]
pub struct FarmScene {
    /// Its name.
    pub name: String,
    /// How many polygons it has; `None` for rectangles.
    pub polygons: Option<usize>,
    /// What a processor holds of it, in bytes.
    pub bytes: u64,
    /// The pixels.
    pub pixels: Pixels,
    /// What reading it changed.
    pub notes: Vec<String>,
}

/// A farm that is laid out, whatever the number of its workers.
#[derive(Debug)]
pub struct FarmSetup {
    /// What is run.
    pub spec: FarmSpec,
    /// On what.
    pub machine: Capitan,
    /// What is to be computed.
    pub scene: FarmScene,
    /// How it is cut.
    pub items: Items,
}

impl FarmSetup {
    /// Lays a farm out. `observe` sees how many of the image's samples are traced.
    ///
    /// # Errors
    ///
    /// As [`FarmSpec::lay_out`] and [`FarmSpec::cut`], and if the machine is impossible.
    pub fn new<E>(
        spec: FarmSpec,
        workers: &Workers,
        observe: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<FarmSetup, RunError<E>> {
        let machine = spec.machine.build()?;
        let scene = spec.lay_out(workers, observe)?;
        let items = spec.cut(&scene, &machine)?;
        Ok(FarmSetup { spec, machine, scene, items })
    }

    /// What the user should know before the figures: what had to be rounded, cut or assumed.
    pub fn notes(&self) -> impl Iterator<Item = &str> {
        self.machine.notes.iter().chain(&self.scene.notes).map(String::as_str)
    }

    /// Lets so many workers run. Fails if it is told to stop.
    pub fn run(&self, tasks: usize, watching: &Watching, cancel: &Cancel) -> Result<FarmOutcome, RunError<Infallible>> {
        let spec = FarmSpec { tasks, ..self.spec.clone() };
        spec.run((&self.scene, &self.machine, &self.items), watching, cancel)
    }
}

/// What a farm came to.
#[derive(Clone, Debug, PartialEq)]
pub struct FarmOutcome {
    /// How many workers there were.
    pub workers: usize,
    /// How many items they had.
    pub items: usize,
    /// Where all time went.
    pub stats: Measured,
    /// What was seen of it over time.
    pub observed: Observed,
    /// What a single worker would have taken.
    pub one_worker: Cycles,
    /// What one program on one such processor would have taken, without messages.
    pub one_program: Cycles,
}

/// Steps of the tasks between two looks at whether they are to be stopped.
const STEPS: usize = 1 << 16;

impl FarmScene {
    /// What was counted on all pixels; `None` for rectangles, on which nothing is counted.
    pub fn counts(&self) -> Option<[u64; UNITS]> {
        let PixelWork::Counts(counts) = &self.pixels.work else { return None };
        let mut sums = [0; UNITS];
        counts.iter().for_each(|pixel| sums.iter_mut().zip(pixel).for_each(|(sum, &count)| *sum += u64::from(count)));
        Some(sums)
    }
}

impl FarmSpec {
    /// The scene with what its pixels take. `observe` sees how many of the image's samples are traced.
    ///
    /// Fails if the scene cannot be read, or is larger than a processor's memory; if `observe` fails; and if it is told to stop.
    pub fn lay_out<E>(
        &self,
        workers: &Workers,
        observe: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<FarmScene, RunError<E>> {
        match (self.rectangles, &self.rays) {
            (Some(rectangles), _) => {
                self.check_memory(rectangles.bytes())?;
                Ok(FarmScene {
                    name: format!("{} rectangles of seed {}", rectangles.count, rectangles.seed),
                    polygons: None,
                    bytes: rectangles.bytes(),
                    pixels: rectangles.pixels(self.size),
                    notes: Vec::new(),
                })
            }
            (None, rays) => self.trace(&rays.clone().unwrap_or_default(), workers, observe),
        }
    }

    /// How many samples the image has.
    pub fn samples(&self) -> usize {
        self.size.pixels() * self.rays.as_ref().map_or(1, |rays| rays.samples as usize).pow(2)
    }

    /// Fails if a scene of so many bytes is larger than a processor's memory.
    fn check_memory(&self, needed: u64) -> Result<(), InputError> {
        let has = self.machine.build()?.memory_bytes;
        if needed <= has {
            return Ok(());
        }
        let message = format!("the scene does not fit: each processor needs {needed} bytes for it and has {has}");
        let help = "take a smaller scene, a smaller --grid-coefficient, or more --memory-kbyte";
        Err(InputError::new(message).help(help))
    }

    /// The work items for a machine.
    ///
    /// Fails if the run would take longer than can be counted.
    pub fn cut(&self, scene: &FarmScene, machine: &Capitan) -> Result<Items, InputError> {
        Items::cut(&scene.pixels, self.items, self.tile.unwrap_or(1), machine)
    }

    /// Lets the tasks run.
    ///
    /// Fails if it is told to stop.
    pub fn run(
        &self,
        (scene, machine, items): (&FarmScene, &Capitan, &Items),
        watching: &Watching,
        cancel: &Cancel,
    ) -> Result<FarmOutcome, RunError<Infallible>> {
        let farm = |workers| Farm::new(machine, items, (scene.bytes, self.scene_by), (workers, self.hand_out));
        let (stats, observed) = run(machine, farm(self.tasks), watching, cancel)?;
        let one_worker = match self.tasks {
            1 => stats.cycles,
            _ => run(machine, farm(1), &Watching::default(), cancel)?.0.cycles,
        };
        let set_ups = Cycles(machine.costs.segment.0 * items.len() as u64);
        let one_program = machine.costs.fixed + set_ups + items.pixels().iter().copied().sum();
        Ok(FarmOutcome { workers: self.tasks, items: items.len(), stats, observed, one_worker, one_program })
    }
}

/// Lets the tasks of a farm run.
fn run(
    machine: &Capitan,
    mut farm: Farm<'_>,
    watching: &Watching,
    cancel: &Cancel,
) -> Result<(Measured, Observed), RunError<Infallible>> {
    let mut events = Events::new(farm.topology(), machine.buses.clone(), Farm::SENDING_AND_IDLE);
    if watching.profile {
        events = events.probed();
    }
    if watching.path {
        events = events.explained(farm.explanation(), Farm::sending);
    }
    if let Some(window) = &watching.recording {
        events = events.recorded(window.clone(), Recording::MOST_EVENTS);
    }
    let mut step = || {
        events.step(&mut |task, _, turn| {
            let taken = turn.taken();
            turn.act(farm.next(task, taken.as_ref()));
        })
    };
    while (0..STEPS).all(|_| step()) {
        cancel.check()?;
    }
    Ok(events.finish()?)
}
