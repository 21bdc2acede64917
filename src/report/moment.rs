//! One moment of a run in words: what somebody does then, and whom it waits for.

use super::summary::{grouped, prose, time};
use super::why::label;
use crate::measure::{Actor, Clock, CriticalPath, Doing, Snapshot, What};
use crate::quantities::Cycles;

/// What somebody does in the cycle of a snapshot, and, a line each, who waits for whom, down to one that does not wait.
pub fn text(path: &CriticalPath, snapshot: &Snapshot, from: Actor, clock: Clock) -> String {
    let mut lines = vec![format!("cycle {} ({}):", grouped(snapshot.at.0), time(clock.seconds(snapshot.at)))];
    let mut next = Some(from);
    // In a run that ends nobody waits for itself; whatever it is, it is told once.
    let mut told = Vec::new();
    while let Some(actor) = next.filter(|actor| !told.contains(actor)) {
        told.push(actor);
        let Some(doing) = snapshot.of(actor) else { break };
        lines.push(line(path, actor, doing, snapshot.at));
        next = waits_for(path, doing, snapshot.at);
    }
    prose(&(lines.join("\n") + "\n"))
}

/// Whom it waits for, if that one has still to do something for it.
fn waits_for(path: &CriticalPath, doing: &Doing, at: Cycles) -> Option<Actor> {
    let fifos = &path.topology.fifos;
    match doing.what {
        What::WaitsForWord { fifo, written } => fifo.filter(|_| at < written).map(|fifo| fifos[fifo].from),
        What::WaitsForSlot { fifo } => Some(fifos[fifo].to).filter(|&reader| reader != Actor::Host),
        What::WaitsForAnswer { written, .. } => {
            (at < written).then(|| Actor::Station(path.topology.stations.saturating_sub(1)))
        }
        What::Works { .. } | What::Moves { .. } | What::WaitsForWire { .. } | What::Done => None,
    }
}

/// One sentence on one of them.
fn line(path: &CriticalPath, actor: Actor, doing: &Doing, at: Cycles) -> String {
    let fifo = |fifo: usize| &path.topology.fifos[fifo];
    let what = match doing.what {
        What::Works { unit, count } => {
            let work = path.units.get(unit).map_or(String::new(), |unit| label(&unit.name));
            format!("works ({work}, {})", if count == 1 { "once".to_owned() } else { format!("{count} times") })
        }
        What::Moves { reads, writes } => {
            let reads = reads.map(|place| format!("reads {}", fifo(place).name));
            let writes = writes.map(|place| format!("writes {}", fifo(place).name));
            format!("moves a word ({})", reads.into_iter().chain(writes).collect::<Vec<_>>().join(", "))
        }
        What::WaitsForWord { fifo: None, .. } => "waits for a word that does not come in this run".to_owned(),
        What::WaitsForWord { fifo: Some(place), written } if at < written => {
            let fifo = fifo(place);
            format!("waits for {}: {} is empty (0 of {} words)", fifo.from, fifo.name, fifo.capacity.0)
        }
        What::WaitsForWord { fifo: Some(place), written } => {
            let fifo = fifo(place);
            format!("waits for a word that {} wrote to {} in cycle {}", fifo.from, fifo.name, grouped(written.0))
        }
        What::WaitsForSlot { fifo: place } => {
            let fifo = fifo(place);
            let words = fifo.capacity.0;
            format!("waits for {}: {} is full ({words} of {words} words)", fifo.to, fifo.name)
        }
        What::WaitsForWire { fifo: place } => {
            format!("waits for the wire to {}, which carries the word before", fifo(place).name)
        }
        What::WaitsForAnswer { message, .. } => format!("waits for hit number {message}"),
        What::Done => return format!("{actor} has done all that it had to"),
    };
    let job = doing.job.map(|job| format!(", ray {}", grouped(job.into()))).unwrap_or_default();
    if matches!(doing.what, What::Moves { .. }) {
        return format!("{actor} {what}{job}");
    }
    let [since, until] = [doing.since, doing.until].map(|cycle| grouped(cycle.0));
    format!("{actor} {what}, from cycle {since} to before cycle {until}{job}")
}
