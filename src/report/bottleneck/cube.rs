//! What limits a hypercube.

use crate::measure::{Measured, StateTimes};
use crate::quantities::Cycles;
use crate::report::summary::percent;

/// What nodes spend time on beside computing: the states, and what is told of them.
const LOSSES: [(&[&str], &str); 5] = [
    (&["sending", "receiving"], "send and take messages"),
    (&["lookup", "serving", "waiting page"], "look pages up, fetch and serve them"),
    (&["blocked"], "have rays for which queues have no room"),
    (&["waiting"], IDLING[0]),
    (&["idle"], IDLING[1]),
];

/// What nodes do while others have all to do.
const IDLING: [&str; 2] = ["wait for rays", "have nothing left to do while others still work"];

/// Names what limits a hypercube, and why.
pub fn sentence(run: &Measured) -> String {
    let [nodes @ .., _host] = run.stations.as_slice() else { return "There are no nodes.".to_owned() };
    let (all, states) = (StateTimes::sum(nodes), &run.topology.states);
    let whole = Cycles(run.cycles.0 * nodes.len() as u64);
    let of = |names: &[&str]| states.sum(&all, |state| names.contains(&state.name.as_str()));
    let losses = LOSSES.map(|(names, told)| (of(names), told));
    let lost: Cycles = losses.iter().map(|(time, _)| *time).sum();
    // The first of several that are as large.
    let Some((most, told)) = losses.into_iter().rev().max_by_key(|(time, _)| *time).filter(|(time, _)| time.0 > 0)
    else {
        return "The nodes compute all of the time.".to_owned();
    };
    let computing = percent(Cycles(whole.0 - lost.0), whole);
    let busiest = run.busiest().filter(|_| nodes.len() > 1 && IDLING.contains(&told));
    let who = busiest.map_or(String::new(), |node| {
        let works = percent(states.works(&run.stations[node]), run.cycles);
        format!("; {} computes most, for {works}", run.topology.station(node))
    });
    format!(
        "The nodes compute {computing} of the time; for most of the rest they {told} ({}){who}.",
        percent(most, whole)
    )
}
