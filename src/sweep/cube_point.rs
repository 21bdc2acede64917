//! One point of a sweep of images on a hypercube.

use std::convert::Infallible;

use super::effective::{Effective, OF_CUBES};
use super::laid_out::LaidOut;
use super::parameters::ON;
use super::point::reason;
use crate::cancel::Cancel;
use crate::machine::{Cycles, Ipsc2};
use crate::measure::StateTimes;
use crate::program::cube::MessageKind;
use crate::report::cube::{Losses, efficiency, speed_up};
use crate::report::table::{Column, Kind};
use crate::run::{CubeOutcome, CubeRunOptions, CubeScene, CubeSpec, Key, RunError, Watching, Workers};

/// What the table tells of a point, behind its parameters. `one_node` to `tail` are what the time of all nodes goes to, as shares; they add
/// up to 1. `computing` is the share that all their work takes. `at_least_seconds` is the highest of the three bounds behind it.
pub const COLUMNS: [Column<'static>; 30] = [
    Column::new("polygons", Kind::Whole, "polygons of the scene"),
    Column::new("ray_count", Kind::Whole, "rays"),
    Column::new("cycles", Kind::Whole, "simulated time (cycles)"),
    Column::new("seconds", Kind::Number, "simulated time (s)"),
    Column::new("one_node_seconds", Kind::Number, "time of one node with all of the scene (s)"),
    Column::new("speed_up", Kind::Number, "times as fast as one node"),
    Column::new("efficiency", Kind::Number, "efficiency"),
    Column::new("load_seconds", Kind::Number, "loading the scene (s)"),
    Column::new("subdivide_seconds", Kind::Number, "making the voxels' lists (s)"),
    Column::new("computing", Kind::Number, "share of the time that nodes compute"),
    Column::new("one_node", Kind::Number, "share of the time: one node's work"),
    Column::new("regions", Kind::Number, "share of the time: entering regions"),
    Column::new("messages", Kind::Number, "share of the time: messages"),
    Column::new("paging", Kind::Number, "share of the time: pages"),
    Column::new("blocked", Kind::Number, "share of the time: no room in queues"),
    Column::new("waiting", Kind::Number, "share of the time: waiting for work"),
    Column::new("tail", Kind::Number, "share of the time: nothing left to do"),
    Column::new("ray_messages", Kind::Number, "ray messages a ray"),
    Column::new("longest_queue", Kind::Whole, "longest queue (rays)"),
    Column::new("real_objects", Kind::Whole, "messages with parts of the scene"),
    Column::new("virtual_objects", Kind::Whole, "messages with rays"),
    Column::new("calculations", Kind::Whole, "messages with results"),
    Column::new("informations", Kind::Whole, "messages that only say that something is so"),
    Column::new("busiest_link", Kind::Number, "share of the time that the busiest link is taken"),
    Column::new("needed_slots", Kind::Whole, "slots that classes need (rays)"),
    Column::new("at_least_seconds", Kind::Number, "time at the least (s)"),
    Column::new("busiest_node_seconds", Kind::Number, "work of the busiest node (s)"),
    Column::new("equal_part_seconds", Kind::Number, "an equal part of all work (s)"),
    Column::new("longest_chain_seconds", Kind::Number, "longest chain of a pixel (s)"),
    Column::new("error", Kind::Text, "why the point failed"),
];

/// All that a point is made of.
pub struct CubePoint {
    spec: CubeSpec,
    machine: Ipsc2,
}

impl LaidOut for CubePoint {
    type Scene = CubeScene;
    type Machine = Ipsc2;
    const EFFECTIVE: &'static [Effective<Ipsc2>] = &OF_CUBES;

    fn new(values: impl Iterator<Item = (&'static str, String)>) -> Result<CubePoint, String> {
        let mut options = CubeRunOptions::default();
        for (name, value) in values {
            match (name == ON.name, value.as_str()) {
                (true, "ipsc2") => {}
                (true, _) => {
                    return Err(format!("nodes with regions, or a shared memory, are on ipsc2, not on {value}"));
                }
                (false, _) => options.set(name, &value).map_err(reason)?,
            }
        }
        if options.light.adaptive.unwrap_or(options.light.adaptive_by.is_some()) {
            return Err("adaptive asks what the neighbours of a pixel show, which other nodes know".to_owned());
        }
        let spec = CubeSpec::new(&options, None).map_err(reason)?;
        let machine = spec.machine.build().map_err(reason)?;
        Ok(CubePoint { spec, machine })
    }

    fn work_key(&self) -> Key {
        self.spec.work_key()
    }

    fn machine(&self) -> &Ipsc2 {
        &self.machine
    }

    fn notes(&self) -> &[String] {
        &self.machine.notes
    }

    fn lay_out(&self, workers: &Workers) -> Result<CubeScene, String> {
        self.spec.lay_out(false, workers, |_| Ok::<_, Infallible>(())).map_err(reason)
    }

    fn told(scene: &CubeScene) -> (&str, &[String]) {
        (&scene.name, &scene.notes)
    }

    fn run(&self, scene: &CubeScene, cancel: &Cancel) -> Result<Vec<String>, String> {
        // A circle of nodes that wait has a line each.
        let in_a_line =
            |error: RunError<Infallible>| reason(error).lines().map(str::trim).collect::<Vec<_>>().join("; ");
        let outcome = self.spec.run(scene, &self.machine, &Watching::default(), cancel).map_err(in_a_line)?;
        Ok(self.results(scene, &outcome))
    }
}

impl CubePoint {
    /// A cell for each of [`COLUMNS`].
    fn results(&self, scene: &CubeScene, outcome: &CubeOutcome) -> Vec<String> {
        let seconds = |time: Cycles| self.machine.clock.seconds(time).to_string();
        let nodes = outcome.parts.len();
        let whole = (outcome.stats.cycles.0 as f64 * nodes as f64).max(1.0);
        let share = |time: Cycles| (time.0 as f64 / whole).to_string();
        let works = StateTimes::sum(&outcome.stats.stations[..nodes]);
        let computing = outcome.stats.topology.states.by_activity(&works).map(|(_, time)| time).sum();
        let sent = |kind: MessageKind| outcome.seen.messages[kind as usize].sent.to_string();
        let rays = scene.graph.rays.len();
        let ray_messages: u64 = outcome.seen.sent.iter().sum();
        let link = outcome.stats.links.iter().map(|link| link.busy).max().unwrap_or_default();
        let phases = outcome.phases;
        let bounds = self.spec.bounds(scene, &self.machine, &outcome.node_of);
        let results = [
            scene.polygons.to_string(),
            rays.to_string(),
            outcome.stats.cycles.0.to_string(),
            seconds(outcome.stats.cycles),
            seconds(outcome.one_node),
            speed_up(outcome).to_string(),
            efficiency(outcome).to_string(),
            seconds(phases.loaded),
            seconds(Cycles(phases.subdivided.0 - phases.loaded.0)),
            share(computing),
        ];
        let losses = Losses::new(outcome).named().map(|(_, time)| share(time));
        let rest = [
            (ray_messages as f64 / rays.max(1) as f64).to_string(),
            outcome.stats.fifos.iter().map(|queue| queue.max.0).max().unwrap_or(0).to_string(),
            sent(MessageKind::RealObject),
            sent(MessageKind::VirtualObject),
            sent(MessageKind::Calculation),
            sent(MessageKind::Information),
            outcome.stats.share(link).to_string(),
            (outcome.highest_rank + 1).to_string(),
            seconds(bounds.least()),
            bounds.busiest().map_or_else(String::new, |(_, work)| seconds(work)),
            seconds(bounds.equal),
            seconds(bounds.chain),
            String::new(),
        ];
        results.into_iter().chain(losses).chain(rest).collect()
    }
}
