//! One moment of a run in words: what somebody does then, and whom it waits for.

use super::summary::{WIDTH, grouped, plural, time, wrapped};
use super::why::label;
use crate::measure::{
    Actor, Clock, CriticalPath, Doing, FifoInfo, Snapshot, StateKind, StationMoment, Topology, WaitAt, Waiting, What,
};
use crate::quantities::Cycles;

/// What somebody does in the cycle of a snapshot, and, a line each, who waits for whom, down to one that does not wait.
pub fn text(path: &CriticalPath, snapshot: &Snapshot, from: Actor, clock: Clock) -> String {
    let mut lines = vec![format!("cycle {} ({}):", grouped(snapshot.at.0), time(clock.seconds(snapshot.at)))];
    let links = links(path, snapshot, from).into_iter();
    lines.extend(links.map(|(actor, doing)| line(path, actor, &doing, snapshot.at)));
    // What a sentence goes on with stands in, as each line is about another of them.
    let lines = lines.iter().map(|line| wrapped(line, WIDTH - 2).replace('\n', "\n  "));
    lines.map(|line| line + "\n").collect()
}

/// What somebody does in the cycle of a snapshot, then what the one does that it waits for, and so on, down to one that does not wait.
pub fn links(path: &CriticalPath, snapshot: &Snapshot, from: Actor) -> Vec<(Actor, Doing)> {
    let mut links: Vec<(Actor, Doing)> = Vec::new();
    let mut next = Some(from);
    // In a run that ends nobody waits for itself; whatever it is, it is told once.
    while let Some(actor) = next.filter(|actor| links.iter().all(|link| link.0 != *actor)) {
        let Some(doing) = snapshot.of(actor) else { break };
        links.push((actor, *doing));
        next = waits_for(path, doing, snapshot.at);
    }
    links
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
pub fn line(path: &CriticalPath, actor: Actor, doing: &Doing, at: Cycles) -> String {
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
        What::WaitsForWord { fifo: Some(place), written } if at < written => waits_for_word(fifo(place)),
        What::WaitsForWord { fifo: Some(place), written } => {
            let fifo = fifo(place);
            format!("waits for a word that {} wrote to {} in cycle {}", fifo.from, fifo.name, grouped(written.0))
        }
        What::WaitsForSlot { fifo: place } => waits_for_room(fifo(place)),
        What::WaitsForWire { fifo: place } => waits_for_wire(fifo(place)),
        What::WaitsForAnswer { message, .. } => format!("waits for hit number {message}"),
        What::Done => return format!("{actor} has done all that it had to"),
    };
    if matches!(doing.what, What::Moves { .. }) {
        return format!("{actor} {what}{}", for_job(doing.job));
    }
    format!("{actor} {what}{}{}", from_until(doing.since, doing.until), for_job(doing.job))
}

/// Links of a chain that are told of a recording, as most of a long one is told at its other waits.
pub(super) const MOST_LINKS: usize = 8;

/// Who waits for whom in a recording, a line each: those next to the one that is asked for, and the one at the end.
pub fn chain(topology: &Topology, chain: &[Waiting]) -> Vec<String> {
    let told = if chain.len() > MOST_LINKS { MOST_LINKS - 1 } else { chain.len() };
    let mut lines: Vec<String> = chain[..told].iter().map(|waiting| recorded_line(topology, waiting)).collect();
    if let Some(last) = chain[told..].last() {
        lines.push(format!("... {}", recorded_line(topology, last)));
    }
    lines
}

/// One sentence on somebody in a recording.
fn recorded_line(topology: &Topology, waiting: &Waiting) -> String {
    let Waiting { actor, moment: StationMoment { stretch, job }, wait } = waiting;
    let state = topology.states.get(stretch.state);
    let what = match *wait {
        Some(WaitAt::Empty(fifo)) => waits_for_word(&topology.fifos[fifo]),
        Some(WaitAt::OnItsWay(fifo)) => {
            let fifo = &topology.fifos[fifo];
            format!("waits for a word that {} wrote to {}", fifo.from, fifo.name)
        }
        Some(WaitAt::Full(fifo)) => waits_for_room(&topology.fifos[fifo]),
        Some(WaitAt::Wire(fifo)) => waits_for_wire(&topology.fifos[fifo]),
        None => match state.map(|state| (state.kind, state.name.as_str())) {
            Some((StateKind::Works, name)) => format!("works ({name})"),
            Some((StateKind::Moves, _)) => "moves words".to_owned(),
            _ => return format!("{actor} has done all that it had to"),
        },
    };
    format!("{actor} {what}{}{}", from_until(stretch.from, stretch.until), for_job(job.map(|span| span.job)))
}

fn waits_for_word(fifo: &FifoInfo) -> String {
    let words = fifo.capacity.unwrap_or_default().0;
    format!("waits for {}: {} is empty (0 of {})", fifo.from, fifo.name, plural(words, "word"))
}

fn waits_for_room(fifo: &FifoInfo) -> String {
    let words = fifo.capacity.unwrap_or_default().0;
    format!("waits for {}: {} is full ({} of {})", fifo.to, fifo.name, grouped(words), plural(words, "word"))
}

fn waits_for_wire(fifo: &FifoInfo) -> String {
    format!("waits for the wire to {}, which carries the word before", fifo.name)
}

fn from_until(since: Cycles, until: Cycles) -> String {
    format!(", from cycle {} to before cycle {}", grouped(since.0), grouped(until.0))
}

fn for_job(job: Option<u32>) -> String {
    job.map(|job| format!(", ray {}", grouped(job.into()))).unwrap_or_default()
}
