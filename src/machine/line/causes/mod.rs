//! Finds why a run took as long as it did: the chain of causes that ends with its last word.
//!
//! Between two waits a cell goes on by itself, and a wait is over because of one thing: a word came, a place in a FIFO or
//! a wire got free. So the way back from a word is a cell's ops up to its last wait, then those of the one that it waited
//! for, and so on; and all that has to be remembered are the ops and the ends of the waits.
//!
//! Which of all ways the run will end with is known only at its end, but it is one that goes on from where a cell stands or
//! from a word or a place that somebody may still wait for. Whenever the ops have come to a certain number, the ways back
//! from all of these are followed to where they come together, and added up in between: that is all that is
//! kept ([`chains`](crate::machine::chains)), and the ops are dropped. So the memory is bounded whatever the length of the run.

mod code;
mod moment;
mod waits;
mod way;
mod window;

use std::sync::Arc;

use super::cell::Cell;
use super::hold::Held;
use super::watcher::Watcher;
use crate::machine::chains::{Chains, Code, Entry};
use crate::machine::timeline::bins_for;
use crate::measure::{Actor, Cause, CriticalPath, PathPart, Snapshot, StateId, StateTimes, Topology, When};
use crate::quantities::Cycles;
use crate::seam::{Channel, OpBatch, Vocabulary};
use moment::Look;
use waits::Waits;
use way::Way;
use window::{NOW, Point};

pub(super) use window::Past;

/// What a stream counts for that has no ops.
const STREAM_OPS: usize = 16;

/// Ops that are held at the least for each point that something may follow from, as each of these is looked at in every
/// reckoning.
const OPS_PER_POINT: usize = 64;

/// Follows the causes of what all stations do: of the host, and of the cells.
#[derive(Debug)]
pub(super) struct Causes {
    stations: Vec<Station>,
    chains: Chains,
    /// Ops since the last reckoning.
    ops: usize,
    most_ops: usize,
    /// Points of earlier times that something may yet follow from, with their nodes, in order.
    live: Vec<(Point, u32)>,
    /// What is looked for in one cycle, if that is asked for.
    look: Option<Look>,
}

/// What is remembered of a station since the last reckoning.
#[derive(Debug, Default)]
struct Station {
    /// Where it stood then.
    start: Stand,
    waits: Vec<Waits>,
    /// The wait in which the end of the run finds it, if it comes to it.
    cut: Option<Waits>,
}

/// Where a station stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Stand {
    /// Its batch, counted from the start of the run, and its op in that.
    pub batch: usize,
    pub op: usize,
    /// What of the op is left to do; 0 if it has not begun.
    pub left: u64,
    pub clock: u64,
}

/// Remembers the waits of one station in a batch.
#[derive(Debug)]
pub(super) struct Remembered<'a> {
    station: &'a mut Station,
    batch: usize,
}

impl Watcher for &mut Remembered<'_> {
    #[inline(always)]
    fn spent(&mut self, _: StateId, _: u64, _: u64, _: &StateTimes) {}

    #[inline(always)]
    fn held(&mut self, held: Held) {
        if held.is_cut {
            self.station.cut = Some(Waits::new(self.batch, held));
        } else if !self.station.waits.last_mut().is_some_and(|row| row.extend(self.batch, &held)) {
            self.station.waits.push(Waits::new(self.batch, held));
        }
    }
}

impl Stand {
    pub fn of(batch: usize, cell: &Cell) -> Stand {
        Stand { batch, op: cell.now.done, left: cell.now.left, clock: cell.now.clock }
    }
}

impl Causes {
    /// Follows an array of `cells` cells, and holds about `most_ops` ops at a time.
    pub fn new(cells: usize, most_ops: usize) -> Causes {
        Causes {
            stations: (0..=cells).map(|_| Station::default()).collect(),
            chains: Chains::new(bins_for(cells) as u64),
            ops: 0,
            most_ops,
            live: (0..=cells).map(|station| ((station, NOW), 0)).collect(),
            look: None,
        }
    }

    /// Looks for what everybody does in one cycle.
    pub fn look(&mut self, when: When) {
        self.look = Some(Look::new(self.stations.len(), when));
    }

    /// The waits of the host in a batch.
    pub fn host(&mut self, batch: usize) -> Remembered<'_> {
        Remembered { station: &mut self.stations[0], batch }
    }

    /// The waits of a cell in a batch.
    pub fn cell(&mut self, index: usize, batch: usize) -> Remembered<'_> {
        Remembered { station: &mut self.stations[index + 1], batch }
    }

    /// The next ops are known.
    pub fn fed(&mut self, batch: &OpBatch) {
        let streams = std::iter::once(&batch.host).chain(&batch.cells);
        self.ops += streams.map(|stream| stream.ops().len() + STREAM_OPS).sum::<usize>();
    }

    /// Whether it is time to reckon. No batch may be dropped in between.
    pub fn is_full(&self) -> bool {
        self.ops > self.most_ops.max(OPS_PER_POINT * self.live.len())
    }

    /// Keeps of all that happened what may still matter.
    pub fn reckon(&mut self, past: &Past<'_>) {
        self.keep(past, past.live());
        self.ops = 0;
    }

    /// Keeps the chains that end in some points.
    fn keep(&mut self, past: &Past<'_>, mut live: Vec<Point>) {
        let Causes { stations, chains, live: before, look, .. } = self;
        look.iter_mut().for_each(|look| look.look(past, stations));
        chains.reach(past.stands.iter().map(|stand| stand.clock).max().unwrap_or_default());
        live.sort_unstable();
        live.dedup();
        let way = Way::new(past, stations, (before, chains.len()), &live);
        way.enter(&live, chains);
        let nodes: Vec<u32> = live.iter().map(|&point| way.node_of(point)).collect();
        let nodes = chains.keep(&nodes);
        self.live = live.into_iter().zip(nodes).collect();
        for (station, &stand) in self.stations.iter_mut().zip(&past.stands) {
            station.waits.clear();
            station.start = stand;
        }
    }

    /// The path of a run of `cycles` cycles, which is over, and what was seen in the cycle that was looked for.
    pub fn finish(
        mut self,
        past: &Past<'_>,
        (topology, vocabulary): (&Arc<Topology>, &Vocabulary),
        cycles: u64,
    ) -> (CriticalPath, Option<Cycles>, Option<Snapshot>) {
        let longest = |station: &usize| (past.stands[*station].clock, std::cmp::Reverse(*station));
        let last_op = (0..past.stands.len()).max_by_key(longest).map(|station| (station, NOW));
        let end = past.end();
        self.keep(past, end.as_ref().map(|end| end.from).or(last_op).into_iter().collect());
        self.chains.reach(cycles);
        if let (Some(end), Some(&(_, node))) = (end, self.live.first()) {
            end.enter(&mut self.chains);
            self.chains.push(node, false);
            self.chains.keep(&[self.chains.len() - 1]);
        }
        let (entries, bin) = self.chains.into_settled();
        let mut bins = vec![Vec::new(); cycles.div_ceil(bin) as usize];
        let names = Names::new(topology);
        for entry in entries {
            if let Some(bin) = bins.get_mut(entry.bin()) {
                bin.push(names.part(&entry));
            }
        }
        let path = CriticalPath {
            topology: Arc::clone(topology),
            cycles: Cycles(cycles),
            units: past.prices.units(vocabulary),
            bin: Cycles(bin),
            bins,
        };
        let at = self.look.as_ref().and_then(Look::cycle);
        (path, at, self.look.and_then(|look| look.finish(past, topology)))
    }
}

/// How entries are called outside: FIFOs have places in the topology.
struct Names {
    /// For each station, the FIFOs of X, Y and Z that it reads.
    fifos: Vec<[usize; 3]>,
}

impl Names {
    fn new(topology: &Topology) -> Names {
        let place = |actor, channel: Channel| topology.fifo_of(&channel.to_string(), actor).unwrap_or_default();
        let of = |station| Channel::ALL.map(|channel| place(actor(station), channel));
        Names { fifos: (0..=topology.stations).map(of).collect() }
    }

    fn part(&self, entry: &Entry) -> PathPart {
        let fifos = &self.fifos[entry.station()];
        let cause = match entry.code() {
            Code(unit) if unit < Code::MOVE.0 => Cause::Work(unit as usize),
            Code::MOVE => Cause::Move,
            Code(other) => {
                let (kind, channel) = ((other - Code::MOVE.0 - 1) / 3, (other - Code::MOVE.0 - 1) % 3);
                [Cause::Latency, Cause::Wire, Cause::Slot][kind as usize](fifos[channel as usize])
            }
        };
        PathPart { at: actor(entry.station()), cause, cycles: Cycles(entry.cycles), count: entry.count }
    }
}

/// Who a station is.
fn actor(station: usize) -> Actor {
    station.checked_sub(1).map_or(Actor::Host, Actor::Station)
}
