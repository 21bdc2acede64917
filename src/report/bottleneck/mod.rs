//! One sentence on what limits the machine.

mod cube;
pub(crate) mod farm;

use super::losses::{Losses, NOTABLE};
use super::summary::percent;
use crate::measure::{Actor, FifoInfo, Measured, Shape, State, StateKind, StateTimes, Toward};
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
    let why = blocked_most(run).unwrap_or_else(|| format!("and {}", rest(run, index)));
    match run.stations.len() {
        1 => format!("The only cell {told}, {why}."),
        _ => format!("No cell limits the array by itself: the busiest, cell {index}, {told}, {why}."),
    }
}

/// Who stands blocked longest, where that is worth a word, and what would let it go on. Links whose words nobody reads are left out.
fn blocked_most(run: &Measured) -> Option<String> {
    let blocks = run.topology.states.all().iter().filter(|state| state.kind == StateKind::Blocked);
    let is_read = |to: Actor| run.links.iter().any(|link| link.into == Some(to) && 2 * link.read.0 > link.busy.0);
    let stands = blocks.flat_map(|state| {
        let fifo = move |index| {
            let (group, toward) = state.stands_at.as_ref()?;
            let fifo = run.topology.fifo_from(group, Actor::Station(index))?;
            (*toward == Toward::Upstream || is_read(run.topology.fifos[fifo].to)).then_some(fifo)
        };
        let times = run.stations.iter().enumerate();
        times.filter_map(move |(index, times)| Some((times.of(state.id), index, fifo(index)?)))
    });
    // The first of several that stand as long.
    let (time, index, fifo) = stands.min_by_key(|&(time, ..)| std::cmp::Reverse(time))?;
    let (info, held) = (&run.topology.fifos[fifo], &run.fifos[fifo]);
    (run.share(time) > NOTABLE).then(|| {
        let stands = format!("but cell {index} stands blocked for {}", percent(time, run.cycles));
        if run.share(held.full) > NOTABLE {
            let FifoInfo { name, to, .. } = info;
            format!("{stands} as {name} is full, which {to} reads: deeper FIFOs, or work cut more evenly, would let it go on")
        } else {
            format!("{stands} as the wire into {} carries the word before: faster links would let it go on", info.name)
        }
    })
}

/// What the busiest cell does for most of the time in which it does not work.
fn rest(run: &Measured, busiest: usize) -> String {
    let states = &run.topology.states;
    let times = &run.stations[busiest];
    let idle = states.sum(times, |state| state.kind == StateKind::Idle);
    if idle > states.waits(times) {
        return format!("has nothing left to do for {}", percent(idle, run.cycles));
    }
    match run.stations.len() {
        1 => format!("waits for words for {}", percent(states.waits(times), run.cycles)),
        _ => "the cells take turns at being waited for, as the work of a ray is uneven over them".to_owned(),
    }
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

/// What the limiting cell does to its neighbours. Words come from the left and room from the right; on Z it is the other way round.
fn effect(run: &Measured, index: usize) -> String {
    let longest = |stations: &[StateTimes], side: Toward, kind: StateKind| {
        let stands =
            |state: &State| state.kind == kind && state.stands_at.as_ref().is_some_and(|(_, toward)| *toward == side);
        stations.iter().map(|times| run.topology.states.sum(times, stands)).max().unwrap_or_default()
    };
    let (left, right) = run.stations.split_at(index);
    let right = &right[1..];
    let held_up = [
        ("left", "stands blocked", longest(left, Toward::Downstream, StateKind::Blocked)),
        ("left", "waits for words on Z", longest(left, Toward::Downstream, StateKind::Waits)),
        ("right", "waits", longest(right, Toward::Upstream, StateKind::Waits)),
        (
            "right",
            "stands blocked on Z, which its left neighbour reads,",
            longest(right, Toward::Upstream, StateKind::Blocked),
        ),
    ];
    let notable = held_up.into_iter().filter(|(.., time)| run.share(*time) > NOTABLE);
    let told = notable.enumerate().map(|(number, (side, stands, time))| {
        let (set_off, who) = if number == 0 { (";", "a cell") } else { (",", "one") };
        format!("{set_off} to its {side} {who} {stands} for {}", percent(time, run.cycles))
    });
    told.collect()
}

/// A link that carries words for nearly all of the run. Those that nobody reads hold nobody up.
fn link_limits(run: &Measured) -> Option<String> {
    // The first of several that are as busy.
    let link = run.links.iter().rev().max_by_key(|link| link.read)?;
    let leads_to = match link.into {
        None | Some(Actor::Host) => "back to the host".to_owned(),
        Some(Actor::Station(cell)) => format!("into cell {cell}"),
    };
    (run.share(link.read) > SATURATED).then(|| {
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
