//! One point of a sweep of farms.

use std::convert::Infallible;

use super::effective::{Effective, OF_FARMS};
use super::laid_out::LaidOut;
use super::parameters::FARM;
use super::point::reason;
use crate::cancel::Cancel;
use crate::machine::{Capitan, Cycles};
use crate::report::bottleneck::farm::Shares;
use crate::report::farm::{efficiency, speed_up};
use crate::report::table::{Column, Kind};
use crate::run::{FarmOutcome, FarmRunOptions, FarmScene, FarmSpec, Key, Watching, Workers};

/// What the table tells of a point, behind its parameters. `computing` to `idle` are what all workers together spend in each
/// state, as shares of their time; they add up to 1.
pub const COLUMNS: [Column<'static>; 18] = [
    Column::new("workers", Kind::Whole, "workers"),
    Column::new("polygons", Kind::Whole, "polygons of the scene"),
    Column::new("scene_bytes", Kind::Whole, "scene in a processor's memory (bytes)"),
    Column::new("work_items", Kind::Whole, "work items"),
    Column::new("seconds", Kind::Number, "simulated time (s)"),
    Column::new("speed_up", Kind::Number, "times as fast as one worker"),
    Column::new("efficiency", Kind::Number, "efficiency"),
    Column::new("one_program_seconds", Kind::Number, "time of one program on one processor (s)"),
    Column::new("computing", Kind::Number, "share of the time that workers compute"),
    Column::new("messages", Kind::Number, "share of the time that workers send, or wait for an item on its way"),
    Column::new("waiting_scene", Kind::Number, "share of the time that workers wait for the scene"),
    Column::new("waiting_master", Kind::Number, "share of the time that workers wait for the master"),
    Column::new("idle", Kind::Number, "share of the time that workers have nothing left to do"),
    Column::new("master_held", Kind::Number, "share of the time that the master is held by one worker"),
    Column::new("station_files", Kind::Number, "share of the time that the station files colours"),
    Column::new("busiest_bus", Kind::Number, "share of the time that the busiest bus carries messages"),
    Column::new("limits", Kind::Text, "what limits the farm"),
    Column::new("error", Kind::Text, "why the point failed"),
];

/// All that a point is made of.
pub struct FarmPoint {
    spec: FarmSpec,
    machine: Capitan,
}

impl LaidOut for FarmPoint {
    type Scene = FarmScene;
    type Machine = Capitan;
    const EFFECTIVE: &'static [Effective<Capitan>] = &OF_FARMS;

    fn new(values: impl Iterator<Item = (&'static str, String)>) -> Result<FarmPoint, String> {
        let mut options = FarmRunOptions::default();
        for (name, value) in values.filter(|(name, _)| *name != FARM.name) {
            options.set(name, &value).map_err(reason)?;
        }
        if options.light.adaptive.unwrap_or(options.light.adaptive_by.is_some()) {
            return Err("adaptive asks what the neighbours of a pixel show, which other workers know".to_owned());
        }
        let spec = FarmSpec::new(&options, None).map_err(reason)?;
        let machine = spec.machine.build().map_err(reason)?;
        Ok(FarmPoint { spec, machine })
    }

    fn work_key(&self) -> Key {
        self.spec.work_key()
    }

    fn machine(&self) -> &Capitan {
        &self.machine
    }

    fn notes(&self) -> &[String] {
        &self.machine.notes
    }

    fn lay_out(&self, workers: &Workers) -> Result<FarmScene, String> {
        self.spec.lay_out(workers, |_| Ok::<_, Infallible>(())).map_err(reason)
    }

    fn told(scene: &FarmScene) -> (&str, &[String]) {
        (&scene.name, &scene.notes)
    }

    fn run(&self, scene: &FarmScene, cancel: &Cancel) -> Result<Vec<String>, String> {
        let items = self.spec.cut(scene, &self.machine).map_err(reason)?;
        let made = (scene, &self.machine, &items);
        let outcome = self.spec.run(made, &Watching::default(), cancel).map_err(reason)?;
        Ok(results(&outcome, scene))
    }
}

fn results(outcome: &FarmOutcome, scene: &FarmScene) -> Vec<String> {
    let stats = &outcome.stats;
    let shares = Shares::new(stats);
    let seconds = |time: Cycles| Capitan::CLOCK.seconds(time).to_string();
    vec![
        outcome.workers.to_string(),
        scene.polygons.map_or(String::new(), |polygons| polygons.to_string()),
        scene.bytes.to_string(),
        outcome.items.to_string(),
        seconds(stats.cycles),
        speed_up(outcome).to_string(),
        efficiency(outcome).to_string(),
        seconds(outcome.one_program),
        shares.computing.to_string(),
        shares.messages.to_string(),
        shares.scene.to_string(),
        shares.master.to_string(),
        shares.idle.to_string(),
        shares.held.to_string(),
        shares.files.to_string(),
        shares.bus.to_string(),
        shares.limits().to_owned(),
        String::new(),
    ]
}
