//! What limits a farm.

use super::{NOTABLE, SATURATED, percent};
use crate::measure::{Measured, State, StateKind, StateTimes};
use crate::quantities::Cycles;

/// Workers that compute more of the time are what limits their farm.
const WORKERS_LIMIT: f64 = 2.0 / 3.0;

/// What the workers lose time to.
struct Loss {
    /// As the subject of a sentence, with its verb.
    limits: &'static str,
    /// As what it is that takes their time.
    told: &'static str,
    time: Cycles,
}

/// Names what limits a farm: its first task gives out the scene, its second one hands out work, the others do it.
pub fn sentence(run: &Measured) -> String {
    let [station, master, workers @ ..] = run.stations.as_slice() else { return "There are no workers.".to_owned() };
    let all = StateTimes::sum(workers);
    let of_workers = |time| percent(time, Cycles(run.cycles.0 * workers.len() as u64));
    let computing = kind(run, &all, StateKind::Works);
    let told = format!("the workers compute {} of the time", of_workers(computing));
    let busiest = run.links.iter().map(|bus| bus.busy).max().unwrap_or_default();
    if run.share(busiest) > SATURATED {
        let share = percent(busiest, run.cycles);
        return format!("The buses limit the farm: the busiest carries messages for {share} of the time; {told}.");
    }
    let filing = named(run, station, "receiving");
    if run.share(filing) > SATURATED {
        let share = percent(filing, run.cycles);
        return format!("The station limits the farm: it takes colours for {share} of the time; {told}.");
    }
    let mut losses = losses(run, &all);
    losses.sort_by_key(|loss| std::cmp::Reverse(loss.time));
    let [first, second, ..] = &losses;
    let held = held(run, master);
    if computing.0 as f64 > WORKERS_LIMIT * (run.cycles.0 * workers.len() as u64) as f64 {
        let most = of_workers(first.time);
        return format!("The workers limit the farm: they compute {} of the time. Most of what else they spend, {most}, is {}.", of_workers(computing), first.told);
    }
    let next = match second.time.0 as f64 > NOTABLE * (run.cycles.0 * workers.len() as u64) as f64 {
        true => format!(" and {} more {}", of_workers(second.time), second.told),
        false => String::new(),
    };
    format!(
        "{} the farm: {told}, and spend {} {}{next}. The master is held by one at a time for {}.",
        first.limits,
        of_workers(first.time),
        first.told,
        percent(held, run.cycles),
    )
}

fn losses(run: &Measured, all: &StateTimes) -> [Loss; 4] {
    let scene = named(run, all, SCENE);
    let items = kind(run, all, StateKind::Waits) - scene;
    [
        Loss { limits: "Start-up limits", told: "waiting for the scene", time: scene },
        Loss { limits: "The master limits", told: "waiting for the master", time: kind(run, all, StateKind::Blocked) },
        Loss { limits: "Messages limit", told: "on messages with the master", time: items + kind(run, all, StateKind::Moves) },
        Loss { limits: "Uneven work limits", told: "idle at the end", time: kind(run, all, StateKind::Idle) },
    ]
}

/// The state of a task that waits for the scene.
const SCENE: &str = "waiting scene";

/// How long the master sends to one worker, or waits for just that one.
fn held(run: &Measured, master: &StateTimes) -> Cycles {
    kind(run, master, StateKind::Moves) + named(run, master, "waiting answer")
}

fn kind(run: &Measured, times: &StateTimes, kind: StateKind) -> Cycles {
    run.topology.states.sum(times, |state: &State| state.kind == kind)
}

fn named(run: &Measured, times: &StateTimes, name: &str) -> Cycles {
    run.topology.states.sum(times, |state| state.name == name)
}
