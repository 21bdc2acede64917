//! What limits a farm.

use super::SATURATED;
use crate::measure::{Measured, State, StateKind, StateTimes};
use crate::quantities::Cycles;
use crate::report::losses::NOTABLE;

/// Workers that compute more of the time are what limits their farm.
const WORKERS_LIMIT: f64 = 2.0 / 3.0;

/// Where a farm's time goes: shares of the workers' time, which add up to 1, then those of others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shares {
    /// They compute.
    pub computing: f64,
    /// They send to the master, or wait for an item that is on its way.
    pub messages: f64,
    /// They wait for the scene.
    pub scene: f64,
    /// They wait until the master takes their message.
    pub master: f64,
    /// They have nothing left to do.
    pub idle: f64,
    /// The master sends to one worker, or waits for just that one.
    pub held: f64,
    /// The station takes and files colours.
    pub files: f64,
    /// The busiest bus carries messages.
    pub bus: f64,
}

/// Names what limits a farm, and why.
pub fn sentence(run: &Measured) -> String {
    if run.stations.len() < 3 {
        return "There are no workers.".to_owned();
    }
    Shares::new(run).sentence()
}

impl Shares {
    /// Where the time of a run went: its first task gives out the scene, its second one hands out work, the others do it.
    pub fn new(run: &Measured) -> Shares {
        let [station, master, workers @ ..] = run.stations.as_slice() else { return Shares::default() };
        let all = StateTimes::sum(workers);
        let of_workers = |time: Cycles| run.share(time) / workers.len().max(1) as f64;
        let kind = |times, kind| run.topology.states.sum(times, |state: &State| state.kind == kind);
        let named = |times, name| run.topology.states.sum(times, |state: &State| state.name == name);
        let scene = named(&all, "waiting scene");
        Shares {
            computing: of_workers(kind(&all, StateKind::Works)),
            messages: of_workers(kind(&all, StateKind::Moves) + kind(&all, StateKind::Waits) - scene),
            scene: of_workers(scene),
            master: of_workers(kind(&all, StateKind::Blocked)),
            idle: of_workers(kind(&all, StateKind::Idle)),
            held: run.share(kind(master, StateKind::Moves) + named(master, "waiting answer")),
            files: run.share(named(station, "receiving")),
            bus: run.share(run.links.iter().map(|bus| bus.busy).max().unwrap_or_default()),
        }
    }

    /// What the workers lose time to, the most first: its share, its name, and what they are at.
    fn losses(&self) -> [(f64, &'static str, &'static str); 4] {
        let mut losses = [
            (self.scene, "start-up", "waiting for the scene"),
            (self.master, "the master", "waiting for the master"),
            (self.messages, "messages", "on messages with the master"),
            (self.idle, "uneven work", "idle at the end"),
        ];
        losses.sort_by(|a, b| b.0.total_cmp(&a.0));
        losses
    }

    /// What limits the farm, in a word or two.
    pub fn limits(&self) -> &'static str {
        let [(_, most, _), ..] = self.losses();
        match self {
            Shares { bus, .. } if *bus > SATURATED => "the buses",
            Shares { files, .. } if *files > SATURATED => "the station",
            Shares { computing, .. } if *computing > WORKERS_LIMIT => "the workers",
            _ => most,
        }
    }

    fn sentence(&self) -> String {
        let limits = self.limits();
        let computing = format!("the workers compute {} of the time", percent(self.computing));
        let [(first, _, told), (second, _, next), ..] = self.losses();
        let next = if second > NOTABLE { format!(", {} {next}", percent(second)) } else { String::new() };
        let losses = format!("and spend {} {told}{next}", percent(first));
        match limits {
            "the buses" => {
                format!(
                    "The buses limit the farm: the busiest carries messages for {}; {computing}.",
                    percent(self.bus)
                )
            }
            "the station" => {
                format!("The station limits the farm: it files colours for {}; {computing}.", percent(self.files))
            }
            "the workers" => {
                format!("The workers limit the farm: they compute {} of the time {losses}.", percent(self.computing))
            }
            _ => {
                let verb = if limits == "messages" { "limit" } else { "limits" };
                let (letter, rest) = limits.split_at(1);
                let (limits, held) = (letter.to_uppercase() + rest, percent(self.held));
                format!(
                    "{limits} {verb} the farm: {computing} {losses}. The master is held by one at a time for {held}."
                )
            }
        }
    }
}

/// In percent with one decimal.
fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
