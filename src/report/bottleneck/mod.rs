//! One sentence on what limits the machine.

mod cube;
pub(crate) mod farm;

use super::losses::{Losses, NOTABLE};
use super::summary::percent;
use crate::measure::{Actor, Measured, Shape, StateKind, StateTimes, Toward};
use crate::quantities::Cycles;
use crate::run::Reordered;

/// What works for more than this share of the run is what the rest waits for.
const SATURATED: f64 = 0.85;

/// What a first cell waits for the host longer than limits the rest.
const STARVED: f64 = 0.5;

/// Names what limits a machine, and why.
pub fn sentence(run: &Measured) -> String {
    match run.topology.shape {
        Shape::Line => of_line(run),
        Shape::Farm => farm::sentence(run),
        Shape::Cube => cube::sentence(run),
    }
}

fn of_line(run: &Measured) -> String {
    let Some(index) = run.busiest() else { return "There are no cells.".to_owned() };
    if run.cycles == Cycles(0) {
        return "No ray is sent.".to_owned();
    }
    let states = &run.topology.states;
    let busiest = &run.stations[index];
    let works = states.works(busiest);
    let told = format!("works {} of the time, {}", percent(works, run.cycles), main_work(run, busiest));
    if run.share(works) > SATURATED {
        return format!("Cell {index} limits the array: it {told}{}.", effect(run, index));
    }
    if let Some(sentence) = link_limits(run).or_else(|| host_limits(run)) {
        return sentence;
    }
    let blocked = run.stations.iter().map(|station| states.blocked(station)).max().unwrap_or_default();
    let why = if run.share(blocked) > NOTABLE {
        let blocked = percent(blocked, run.cycles);
        format!("but full FIFOs block a cell for {blocked}: deeper ones, or work cut more evenly, would let it go on")
    } else {
        "and the cells take turns at being waited for, as the work of a ray is uneven over them".to_owned()
    };
    format!("No cell limits the array by itself: the busiest, cell {index}, {told}, {why}.")
}

/// What is lost against the busiest station's work, where that is worth a word: it is much, and neither a link nor the host is what
/// limits the machine. `shuffled` times the same rays in a random order.
pub fn losses(run: &Measured, shuffled: impl FnOnce() -> Option<Reordered>) -> Option<Losses> {
    let works = run.topology.states.works(&run.stations[run.busiest()?]);
    let told = run.share(works) >= 1.0 - NOTABLE || link_limits(run).or_else(|| host_limits(run)).is_some();
    if told { None } else { Losses::new(run, &shuffled()?) }
}

/// How a sentence tells what a cell works on.
fn doing(activity: &str) -> String {
    match activity {
        "grid" => "walking the grid".to_owned(),
        "slabs" => "on slabs tests".to_owned(),
        "intersection" => "on intersection tests".to_owned(),
        "other" => "on other work".to_owned(),
        another => format!("on {another}"),
    }
}

/// "96.2 % on the slabs test", or moving words, whichever takes most.
fn main_work(run: &Measured, times: &StateTimes) -> String {
    let states = &run.topology.states;
    let works = states.by_activity(times).map(|(name, cycles)| (cycles, doing(name)));
    let moving = states.sum(times, |state| state.kind == StateKind::Moves);
    let most = works.chain([(moving, "moving words".to_owned())]).max_by_key(|entry| entry.0);
    let (most, name) = most.unwrap_or_default();
    format!("{} of it {name}", percent(most, states.works(times)))
}

/// What the limiting cell does to its neighbours.
fn effect(run: &Measured, index: usize) -> String {
    let held_up = |stations: &[StateTimes], side: Toward| {
        let toward = |times| {
            run.topology.states.sum(times, |state| state.stands_at.as_ref().is_some_and(|(_, toward)| *toward == side))
        };
        stations.iter().map(toward).max().unwrap_or_default()
    };
    let blocked = held_up(&run.stations[..index], Toward::Downstream);
    let waiting = held_up(&run.stations[index + 1..], Toward::Upstream);
    let part = |cycles: Cycles| percent(cycles, run.cycles);
    let significant = |cycles: Cycles| run.share(cycles) > NOTABLE;
    match (significant(blocked), significant(waiting)) {
        (true, true) => format!(
            "; to its left a cell stands blocked for {}, to its right one waits for {}",
            part(blocked),
            part(waiting)
        ),
        (true, false) => format!("; to its left a cell stands blocked for {}", part(blocked)),
        (false, true) => format!("; to its right a cell waits for {}", part(waiting)),
        (false, false) => String::new(),
    }
}

/// A link that carries words for nearly all of the run.
fn link_limits(run: &Measured) -> Option<String> {
    // The first of several that are as busy.
    let link = run.links.iter().rev().max_by_key(|link| link.busy)?;
    let leads_to = match link.into {
        None | Some(Actor::Host) => "back to the host".to_owned(),
        Some(Actor::Station(cell)) => format!("into cell {cell}"),
    };
    (run.share(link.busy) > SATURATED).then(|| {
        format!(
            "The link {leads_to} limits the array: it carries words for {} of the time.",
            percent(link.busy, run.cycles)
        )
    })
}

/// The first cell waits for jobs: the host, or its link, is too slow.
fn host_limits(run: &Measured) -> Option<String> {
    let first = run.stations.first()?;
    let fed_by_host = |group: &str| {
        let fifo = run.topology.fifo_of(group, Actor::Station(0));
        fifo.is_some_and(|fifo| run.topology.fifos[fifo].from == Actor::Host)
    };
    let waiting = run.topology.states.sum(first, |state| {
        let at_host = state.stands_at.as_ref().is_some_and(|(group, _)| fed_by_host(group));
        state.kind == StateKind::Waits && at_host
    });
    (run.share(waiting) > STARVED).then(|| {
        format!("The host limits the array: cell 0 waits for rays {} of the time.", percent(waiting, run.cycles))
    })
}
