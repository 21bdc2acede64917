//! The judge of critical paths: from the last word back to cycle 0, unit by unit and word by word, through the complete list
//! of what the ticking model did. It knows nothing of waits: each thing begins when the last of what it needs is there.

use std::collections::BTreeMap;

use super::ticking::{self, History};
use pcs_sim::machine::{MachineSpec, RateCounts};
use pcs_sim::measure::{Actor, Cause, CriticalPath};
use pcs_sim::seam::{Channel, Costs, Op, OpBatch, OpKind, Unit};

/// A path in words: who or what FIFO's reader, why, how long, how often.
pub type Parts = BTreeMap<(String, String), (u64, u64)>;

/// What the judge finds.
#[derive(Debug, PartialEq)]
pub struct LookedBack {
    pub parts: Parts,
    /// For each cycle of the run, who and why.
    pub cycles: Vec<(String, String)>,
}

/// One unit of work, one word moved, or one wait for an answer.
struct Action {
    kind: OpKind,
    start: u64,
    end: u64,
    /// The numbers of the word that it reads and of the one that it writes.
    reads: Option<(Link, usize)>,
    writes: Option<(Link, usize)>,
    /// The last action that used the same wire.
    wire_after: Option<usize>,
    answer: u32,
}

/// A link and a channel.
type Link = (usize, usize);

struct Judge<'a> {
    spec: &'a MachineSpec,
    costs: &'a Costs,
    history: &'a History,
    /// The host's actions, and those of each cell.
    actors: Vec<Vec<Action>>,
    writer: BTreeMap<(Link, usize), (usize, usize)>,
    reader: BTreeMap<(Link, usize), (usize, usize)>,
    found: LookedBack,
}

/// The critical path by the rule of docs/machine.md. `None` if the ops never end.
pub fn look_back(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch]) -> Option<LookedBack> {
    let (ticked, history) = ticking::run_recorded(spec, costs, batches)?;
    let cells = batches[0].cells.len();
    let join = |stream: &dyn Fn(&OpBatch) -> Vec<Op>| batches.iter().flat_map(stream).collect::<Vec<Op>>();
    let mut judge = Judge {
        spec,
        costs,
        history: &history,
        actors: Vec::new(),
        writer: BTreeMap::new(),
        reader: BTreeMap::new(),
        found: LookedBack {
            parts: Parts::new(),
            cycles: vec![(String::new(), String::new()); ticked.cycles.0 as usize],
        },
    };
    judge.act(0, cells, &join(&|batch| batch.host.ops().to_vec()));
    for cell in 0..cells {
        judge.act(cell + 1, cells, &join(&|batch| batch.cells[cell].ops().to_vec()));
    }
    judge.look_back(cells, ticked.cycles.0);
    Some(judge.found)
}

fn name(actor: usize) -> String {
    if actor == 0 { "the host".to_owned() } else { format!("cell {}", actor - 1) }
}

/// The name of a FIFO, by its link and channel.
fn fifo(cells: usize, (link, channel): Link) -> String {
    match (channel, link == cells) {
        (2, _) => format!("Z{}", link - 1),
        (_, true) => "Yhost".to_owned(),
        (_, false) => format!("{}{link}", ["X", "Y"][channel]),
    }
}

impl Judge<'_> {
    /// Lists what an actor did, as far as the run goes.
    fn act(&mut self, actor: usize, cells: usize, ops: &[Op]) {
        let mut actions: Vec<Action> = Vec::new();
        let mut numbers: BTreeMap<(bool, Link), usize> = BTreeMap::new();
        let mut wires: BTreeMap<Link, usize> = BTreeMap::new();
        'ops: for op in ops {
            let count = if op.kind() == OpKind::Await { 1 } else { op.count() };
            for _ in 0..count {
                let own = actions.last().map_or(0, |last| last.end);
                let mut action = Action {
                    kind: op.kind(),
                    start: own,
                    end: own,
                    reads: None,
                    writes: None,
                    wire_after: None,
                    answer: op.count(),
                };
                match op.kind() {
                    OpKind::Work(unit) => action.end = own + self.costs.of(unit).0,
                    OpKind::Await => match self.history.returned.get(op.count() as usize) {
                        Some(returned) => {
                            action.start = own.max(returned + 1);
                            action.end = action.start;
                        }
                        None => break 'ops,
                    },
                    kind => {
                        // X and Y are read from the link to the left and written to that to the right; Z the other way.
                        let reads = kind.reads().map(|c| (if c == Channel::Z { actor } else { actor - 1 }, c as usize));
                        let writes = kind.writes().filter(|_| !(kind == OpKind::PassX && actor == cells));
                        let writes = writes.map(|c| (if c == Channel::Z { actor - 1 } else { actor }, c as usize));
                        let mut next = |is_write: bool, link: Link| {
                            let number = numbers.entry((is_write, link)).or_default();
                            *number += 1;
                            (link, *number - 1)
                        };
                        action.reads = reads.map(|link| next(false, link));
                        action.writes = writes.map(|link| next(true, link));
                        let happened = |is_write: bool, (link, word): (Link, usize)| {
                            self.history.words.get(&link)?[1 - is_write as usize].get(word).copied()
                        };
                        let at = match (action.reads, action.writes) {
                            (Some(read), _) => happened(false, read),
                            (_, Some(write)) => happened(true, write),
                            _ => unreachable!("it moves words"),
                        };
                        let Some(at) = at else { break 'ops };
                        (action.start, action.end) = (at, at + 1);
                        action.reads.into_iter().for_each(|read| {
                            self.reader.insert(read, (actor, actions.len()));
                        });
                        if let Some(write) = action.writes {
                            self.writer.insert(write, (actor, actions.len()));
                            let shared = self.spec.link_rate().counts == RateCounts::Link && write.0.1 < 2;
                            let wire = if shared { (write.0.0, 0) } else { write.0 };
                            action.wire_after = wires.insert(wire, actions.len());
                        }
                    }
                }
                actions.push(action);
            }
        }
        self.actors.push(actions);
    }

    /// Enters that something took the cycles before `until`.
    fn enter(&mut self, who: String, why: String, until: u64, cycles: u64) {
        for cycle in until - cycles..until {
            let entry = &mut self.found.cycles[cycle as usize];
            assert_eq!(entry.0, "", "cycle {cycle} has one cause");
            *entry = (who.clone(), why.clone());
        }
        let part = self.found.parts.entry((who, why)).or_default();
        part.0 += cycles;
        part.1 += 1;
    }

    /// The word that the host read in the cycle before `until` was written then.
    fn through_host(&mut self, cells: usize, why: &str, until: u64, word: usize) -> (usize, usize) {
        self.enter(name(0), why.to_owned(), until, 1);
        let latency = self.spec.latency.0;
        self.enter(name(0), "latency of Yhost".to_owned(), until - 1, latency);
        self.writer[&((cells, 1), word)]
    }

    fn look_back(&mut self, cells: usize, cycles: u64) {
        let inbox = self.history.words.get(&(cells, 1)).map_or(0, |words| words[1].len());
        // The action that is to begin next, going back.
        let mut next = if inbox > 0 {
            Some(self.through_host(cells, "move", cycles, inbox - 1))
        } else {
            let clock = |actor: usize| self.actors[actor].last().map_or(0, |last| last.end);
            let last = (0..=cells).find(|&actor| clock(actor) == cycles).expect("somebody did the last op");
            self.before(last, self.actors[last].len())
        };
        while let Some((actor, index)) = next {
            next = self.cause(cells, actor, index);
        }
    }

    /// The action before another of the same actor, which is entered.
    fn before(&mut self, actor: usize, index: usize) -> Option<(usize, usize)> {
        let before = index.checked_sub(1)?;
        let Action { kind, start, end, .. } = self.actors[actor][before];
        let why = match kind {
            OpKind::Work(Unit(unit)) => self.costs.vocabulary().units[unit as usize].name.clone(),
            OpKind::Await => return Some((actor, before)),
            _ => "move".to_owned(),
        };
        self.enter(name(actor), why, end, end - start);
        Some((actor, before))
    }

    /// What an action began after: its actor, its word, its slot or its wire, the first of those that were there last.
    fn cause(&mut self, cells: usize, actor: usize, index: usize) -> Option<(usize, usize)> {
        let action = &self.actors[actor][index];
        let (start, reads, writes, wire_after) = (action.start, action.reads, action.writes, action.wire_after);
        let own = index.checked_sub(1).map_or(0, |before| self.actors[actor][before].end);
        if own == start {
            return self.before(actor, index);
        }
        if action.kind == OpKind::Await {
            let word = (action.answer as usize + 1) * self.costs.vocabulary().answer_words as usize - 1;
            return Some(self.through_host(cells, "move", start, word));
        }
        let latency = self.spec.latency.0;
        if let Some((link, word)) = reads
            && self.history.words[&link][0][word] + latency == start
        {
            self.enter(name(actor), format!("latency of {}", fifo(cells, link)), start, latency);
            return Some(self.writer[&(link, word)]);
        }
        let (link, word) = writes.expect("what waits for nothing else writes");
        let name_of = fifo(cells, link);
        let freed = word.checked_sub(self.spec.fifo_words_of(name_of.parse().unwrap()).0 as usize);
        if let Some(freed) = freed
            && self.history.words[&link][1][freed] + 1 == start
        {
            if link == (cells, 1) {
                return Some(self.through_host(cells, "slot of Yhost", start, freed));
            }
            let (reader, index) = self.reader[&(link, freed)];
            self.enter(name(reader), format!("slot of {name_of}"), start, 1);
            return Some((reader, index));
        }
        let before = wire_after.expect("what waits for nothing else waits for its wire");
        let rate = self.spec.link_rate().cycles_per_word;
        assert_eq!(self.actors[actor][before].start + rate, start, "something is the last that it needs");
        let reader = match link {
            (link, 2) => link,
            (link, _) if link == cells => 0,
            (link, _) => link + 1,
        };
        self.enter(name(reader), format!("wire of {name_of}"), start, rate);
        Some((actor, before))
    }
}

/// What a path says in the judge's words.
pub fn in_words(path: &CriticalPath) -> Parts {
    let parts = path.parts().into_iter();
    parts.map(|part| ((actor(part.at), why(path, part.cause)), (part.cycles.0, part.count))).collect()
}

/// The cycles of a path in each of its bins, in the judge's words.
pub fn bins_in_words(path: &CriticalPath) -> Vec<BTreeMap<(String, String), u64>> {
    let bin = |parts: &Vec<pcs_sim::measure::PathPart>| {
        let timed = parts.iter().filter(|part| part.cycles.0 > 0);
        timed.map(|part| ((actor(part.at), why(path, part.cause)), part.cycles.0)).collect()
    };
    path.bins.iter().map(bin).collect()
}

fn actor(actor: Actor) -> String {
    actor.to_string()
}

fn why(path: &CriticalPath, cause: Cause) -> String {
    let fifo = |fifo: usize| &path.topology.fifos[fifo].name;
    match cause {
        Cause::Work(unit) => path.units[unit].name.clone(),
        Cause::Move => "move".to_owned(),
        Cause::Latency(place) => format!("latency of {}", fifo(place)),
        Cause::Wire(place) => format!("wire of {}", fifo(place)),
        Cause::Slot(place) => format!("slot of {}", fifo(place)),
    }
}
