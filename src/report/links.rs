//! What the links of a hypercube carried.

use serde::Serialize;

use super::summary::{Rows, grouped, percent, time};
use crate::measure::{Actor, Clock, LinkStats, Measured};
use crate::quantities::Cycles;

/// A link as statistics tell it.
#[derive(Debug, Serialize)]
pub struct LinkJson {
    from: String,
    to: String,
    busy: u64,
    messages: u64,
    bytes: u64,
    waited: u64,
}

/// All links, each with its ends; times are in cycles.
pub fn to_json(run: &Measured) -> Vec<LinkJson> {
    let link = |link: &LinkStats| {
        let messages = link.messages.unwrap_or_default();
        LinkJson {
            from: end(run, link.from),
            to: end(run, link.into),
            busy: link.busy.0,
            messages: messages.sent,
            bytes: messages.bytes,
            waited: messages.waited.0,
        }
    };
    run.links.iter().map(link).collect()
}

/// A row for the links of each direction, and one for the host's, with the busiest of them.
pub fn rows(run: &Measured, clock: Clock) -> Rows {
    let row = |(name, links): (String, Vec<&LinkStats>)| {
        let messages = || links.iter().filter_map(|link| link.messages);
        let busiest = links.iter().rev().max_by_key(|link| link.busy).filter(|link| link.busy > Cycles(0));
        let ends = |link: &&&LinkStats| format!("{} to {}", end(run, link.from), end(run, link.into));
        vec![
            name,
            grouped(messages().map(|link| link.sent).sum()),
            grouped(messages().map(|link| link.bytes).sum()),
            time(clock.seconds(messages().map(|link| link.waited).sum())),
            busiest.as_ref().map_or(String::new(), ends),
            percent(busiest.map_or(Cycles(0), |link| link.busy), run.cycles),
        ]
    };
    let header = ["links", "messages", "bytes", "waited for", "busiest", "busy"];
    Rows { header: header.map(str::to_owned).to_vec(), rows: directions(run).into_iter().map(row).collect() }
}

/// The links by what they lead along: a bit of the nodes' numbers, or to and from the host.
fn directions(run: &Measured) -> Vec<(String, Vec<&LinkStats>)> {
    let mut directions: Vec<(String, Vec<&LinkStats>)> = Vec::new();
    for link in &run.links {
        let name = match (link.from, link.into) {
            (Some(Actor::Station(from)), Some(Actor::Station(to))) => format!("bit {}", (from ^ to).trailing_zeros()),
            _ => "host".to_owned(),
        };
        match directions.iter_mut().find(|(known, _)| *known == name) {
            Some((_, links)) => links.push(link),
            None => directions.push((name, vec![link])),
        }
    }
    directions
}

/// The end of a link: a node's number, or that of a place without a node, which only passes messages on.
fn end(run: &Measured, actor: Option<Actor>) -> String {
    // The last station is the host.
    let nodes = run.stations.len().saturating_sub(1);
    match actor {
        Some(Actor::Station(place)) if place < nodes => place.to_string(),
        Some(Actor::Station(place)) => format!("router {place}"),
        Some(Actor::Host) | None => "host".to_owned(),
    }
}
