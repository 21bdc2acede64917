//! A machine at one cycle, as a recording has it.

use super::recording::{FifoLevels, JobSpan, OpSpan, Recording, StationRecord, Stretch};
use super::state::StateKind;
use super::topology::Actor;
use crate::quantities::{Cycles, Words};
use crate::seam::OpKind;

/// What the whole machine was at in one cycle. Stations and FIFOs stand in the order of the recording's topology.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moment {
    /// The cycle.
    pub at: Cycles,
    /// The host as it sends jobs, if there is one.
    pub host: Option<StationMoment>,
    /// The answer that the host is reading: from its first word to its last.
    pub answer: Option<JobSpan>,
    /// The stations.
    pub stations: Vec<StationMoment>,
    /// What each FIFO held at the end of the cycle.
    pub levels: Vec<Words>,
}

/// What a station, or the host, was at in one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StationMoment {
    /// Its state, since when and until when, as far as the window goes. It is cut where a job starts or ends.
    pub stretch: Stretch,
    /// The job that it worked on, if any, from its start to its end, as far as the window goes.
    pub job: Option<JobSpan>,
}

/// The op that a station, or the host, was at in one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpMoment {
    /// The op, from its start to its end.
    pub span: OpSpan,
    /// What of it was done at the end of the cycle: cycles of work, or words moved.
    pub done: u64,
    /// How much there is to do; 0 of a wait for an answer.
    pub of: u64,
}

impl Recording {
    /// The op that somebody was at in cycle `at`; `None` outside the cycles of which ops are recorded, and behind the last.
    pub fn op(&self, actor: Actor, at: Cycles) -> Option<OpMoment> {
        let record = match actor {
            Actor::Host => self.host.as_ref()?,
            Actor::Station(station) => self.stations.get(station)?,
        };
        let known = self.window.start <= at && at < self.ops_until;
        let span = last_until(&record.ops, at, |op| op.from).copied().filter(|op| known && at < op.until)?;
        let count = u64::from(span.op.count());
        if let Some(unit) = span.op.unit() {
            let each = self.units.get(usize::from(unit.0)).map_or(Cycles(0), |unit| unit.cycles);
            return Some(OpMoment { span, done: at.0 + 1 - span.from.0, of: count * each.0 });
        }
        if span.op.kind() == OpKind::Await {
            return Some(OpMoment { span, done: 0, of: 0 });
        }
        let (from, until) = (span.from.max(self.window.start), at + Cycles(1));
        let states = &record.states[record.states.partition_point(|stretch| stretch.until <= from)..];
        let moved = states
            .iter()
            .take_while(|stretch| stretch.from < until)
            .filter(|stretch| self.topology.states.is(stretch.state, StateKind::Moves));
        let moved = moved.map(|stretch| stretch.until.min(until).0 - stretch.from.max(from).0).sum::<u64>();
        Some(OpMoment { span, done: u64::from(span.before) + moved, of: count })
    }

    /// Whose words a FIFO held at the end of cycle `at`, the oldest first; `None` outside the window. The FIFO is told by its
    /// place in the topology.
    pub fn words(&self, fifo: usize, at: Cycles) -> Option<Vec<Option<u32>>> {
        let held = self.fifos.get(fifo).filter(|_| self.window.contains(&at))?;
        let inside_at_first = held.words.iter().map(|words| words.count).sum::<u64>() - held.writes.len() as u64;
        let until = |times: &[Cycles]| times.partition_point(|&time| time <= at) as u64;
        let (first, last) = (until(&held.reads), inside_at_first + until(&held.writes));
        let all = held.words.iter().flat_map(|words| std::iter::repeat_n(words.job, words.count as usize));
        Some(all.skip(first as usize).take((last - first) as usize).collect())
    }

    /// The machine in cycle `at`; `None` outside the window.
    pub fn moment(&self, at: Cycles) -> Option<Moment> {
        if !self.window.contains(&at) {
            return None;
        }
        Some(Moment {
            at,
            host: self.host.as_ref().and_then(|host| host.moment(at)),
            answer: job_at(&self.answers, at),
            stations: self.stations.iter().map(|station| station.moment(at)).collect::<Option<_>>()?,
            levels: self.fifos.iter().map(|fifo| fifo.level(at)).collect::<Option<_>>()?,
        })
    }

    /// The first cycle after `after` in which anything is different from the cycle before it: a state, a job, an answer or
    /// a level. `None` if the window ends first.
    pub fn next_change(&self, after: Cycles) -> Option<Cycles> {
        let next = self.changes(Seek::After(after.max(self.window.start))).min();
        next.filter(|&change| change < self.window.end)
    }

    /// The last cycle before `before` in which anything is different from the cycle before it. `None` if the window starts
    /// first.
    pub fn previous_change(&self, before: Cycles) -> Option<Cycles> {
        let previous = self.changes(Seek::Before(before.min(self.window.end))).max();
        previous.filter(|&change| change > self.window.start)
    }

    /// The nearest change of each station, of the answers and of each FIFO. A job starts and ends with a stretch.
    fn changes(&self, seek: Seek) -> impl Iterator<Item = Cycles> + '_ {
        let stations = self.host.iter().chain(&self.stations);
        let states = stations.map(move |station| seek.among(&station.states, |stretch| stretch.from));
        let answers = [|answer: &JobSpan| answer.from, |answer: &JobSpan| answer.until];
        let answers = answers.into_iter().map(move |end| seek.among(&self.answers, end));
        let levels = self.fifos.iter().map(move |fifo| seek.among(&fifo.levels, |level| level.0));
        states.chain(answers).chain(levels).flatten()
    }
}

impl StationRecord {
    /// What it was at in cycle `at`; `None` outside the window.
    pub(super) fn moment(&self, at: Cycles) -> Option<StationMoment> {
        let stretch = last_until(&self.states, at, |stretch| stretch.from)?;
        (at < stretch.until).then(|| StationMoment { stretch: *stretch, job: job_at(&self.jobs, at) })
    }
}

impl FifoLevels {
    /// The level at the end of cycle `at`; `None` before the window.
    pub(super) fn level(&self, at: Cycles) -> Option<Words> {
        last_until(&self.levels, at, |level| level.0).map(|level| level.1)
    }
}

/// The job whose time a cycle lies in.
fn job_at(jobs: &[JobSpan], at: Cycles) -> Option<JobSpan> {
    last_until(jobs, at, |job| job.from).filter(|job| at < job.until).copied()
}

/// The last of some items, in the order of their times, whose time is `at` or earlier.
fn last_until<T>(items: &[T], at: Cycles, time: impl Fn(&T) -> Cycles) -> Option<&T> {
    items[..items.partition_point(|item| time(item) <= at)].last()
}

/// Which of some times is looked for.
#[derive(Clone, Copy)]
enum Seek {
    /// The first one after a cycle.
    After(Cycles),
    /// The last one before a cycle.
    Before(Cycles),
}

impl Seek {
    /// Looks among items in the order of their times.
    fn among<T>(self, items: &[T], time: impl Fn(&T) -> Cycles) -> Option<Cycles> {
        let found = match self {
            Seek::After(cycle) => items.get(items.partition_point(|item| time(item) <= cycle)),
            Seek::Before(cycle) => items[..items.partition_point(|item| time(item) < cycle)].last(),
        };
        found.map(time)
    }
}
