//! What each task spends its time on.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::recorder::Recorder;
use crate::machine::timeline::{Count, Timeline, bins_for};
use crate::measure::{
    JobSpan, Latency, LinkStats, Measured, MessageSpan, Observed, Profile, SoFar, StateId, StateTimes, Topology,
};
use crate::quantities::Cycles;

/// The time of all tasks, and what watches it.
#[derive(Debug)]
pub struct Lanes {
    topology: Arc<Topology>,
    idle: StateId,
    lanes: Vec<Lane>,
    jobs: u64,
    /// Whether there is a probe or a recorder, or the jobs are noted.
    is_watched: bool,
    probe: Option<Probe>,
    recorder: Option<Recorder>,
    /// The jobs done so far, by their numbers, if that is asked for.
    spans: Option<BTreeMap<u32, JobSpan>>,
}

/// The time of one task.
#[derive(Clone, Debug, Default)]
struct Lane {
    times: StateTimes,
    /// Up to which time it has been told.
    now: u64,
    /// The job under way, and since when.
    job: Option<(u32, u64)>,
}

/// The run over time.
#[derive(Debug)]
struct Probe {
    tasks: Vec<Timeline<StateTimes>>,
    done: Timeline<Count>,
    latency: Latency,
}

impl Lanes {
    pub fn new(topology: Topology, idle: StateId) -> Lanes {
        let lanes = vec![Lane::default(); topology.stations];
        Lanes {
            topology: Arc::new(topology),
            idle,
            lanes,
            jobs: 0,
            is_watched: false,
            probe: None,
            recorder: None,
            spans: None,
        }
    }

    /// Sees the run over time.
    pub fn probe(&mut self) {
        let bins = bins_for(self.lanes.len());
        let tasks = self.lanes.iter().map(|_| Timeline::new(bins)).collect();
        self.is_watched = true;
        self.probe = Some(Probe { tasks, done: Timeline::new(bins), latency: Latency::default() });
    }

    /// Records a window of it.
    pub fn record(&mut self, window: Range<Cycles>, most_events: usize) {
        self.is_watched = true;
        self.recorder = Some(Recorder::new(self.lanes.len(), window.start.0..window.end.0, most_events));
    }

    /// Notes when each job is begun first, and done last.
    pub fn note_spans(&mut self) {
        self.is_watched = true;
        self.spans = Some(BTreeMap::new());
    }

    /// A task has been in a state up to a time, since what was told last.
    #[inline]
    pub fn spend(&mut self, task: usize, state: StateId, until: u64) {
        let Some(lane) = self.lanes.get_mut(task) else { return };
        if until <= lane.now {
            return;
        }
        let from = std::mem::replace(&mut lane.now, until);
        *lane.times.of_mut(state) += Cycles(until - from);
        if self.is_watched {
            self.watch(task, state, from..until);
        }
    }

    /// A task spends some time from `now` on, in one state after the other. Returns until when.
    #[inline(always)]
    pub fn spend_each(&mut self, task: usize, spells: &[(StateId, Cycles)], now: u64) -> u64 {
        let mut until = now;
        if self.is_watched {
            for &(state, cycles) in spells {
                until += cycles.0;
                self.spend(task, state, until);
            }
            return until;
        }
        let Some(lane) = self.lanes.get_mut(task) else {
            return until + spells.iter().map(|&(_, cycles)| cycles).sum::<Cycles>().0;
        };
        debug_assert_eq!(lane.now, now);
        for &(state, cycles) in spells {
            until += cycles.0;
            *lane.times.of_mut(state) += cycles;
        }
        lane.now = until;
        until
    }

    /// Tells those who watch what a task has spent. Kept apart from the tasks that nobody watches.
    #[inline(never)]
    fn watch(&mut self, task: usize, state: StateId, time: Range<u64>) {
        if let Some(probe) = &mut self.probe {
            probe.spend(task, state, time.clone());
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.spend(task, state, time);
        }
    }

    /// A task begins a job.
    #[inline]
    pub fn begin(&mut self, task: usize, job: u32, now: u64) {
        let Some(lane) = self.lanes.get_mut(task) else { return };
        lane.job = Some((job, now));
        if let Some(recorder) = &mut self.recorder {
            recorder.border(task);
        }
    }

    /// A task has done the job that it began last, if it is at any.
    #[inline]
    pub fn done(&mut self, task: usize, now: u64) {
        let Some((job, since)) = self.lanes.get_mut(task).and_then(|lane| lane.job.take()) else { return };
        self.jobs += 1;
        if self.is_watched {
            self.watch_done(task, job, since..now);
        }
    }

    /// Tells those who watch what job a task has done.
    #[inline(never)]
    fn watch_done(&mut self, task: usize, job: u32, time: Range<u64>) {
        if let Some(probe) = &mut self.probe {
            probe.done.at(time.end.saturating_sub(1)).0 += 1;
            probe.latency.add(time.end - time.start);
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.done(task, job, time.clone());
        }
        if let Some(spans) = &mut self.spans {
            let new = JobSpan { job, from: Cycles(time.start), until: Cycles(time.end) };
            let span = spans.entry(job).or_insert(new);
            (span.from, span.until) = (span.from.min(new.from), span.until.max(new.until));
        }
    }

    /// A message sets out.
    #[inline]
    pub fn message(&mut self, message: impl FnOnce() -> MessageSpan) {
        if let Some(recorder) = &mut self.recorder {
            recorder.message(message());
        }
    }

    /// What is known when it is `now`.
    pub fn so_far(&self, now: u64) -> SoFar {
        SoFar {
            topology: Arc::clone(&self.topology),
            cycles: Cycles(now),
            returned: self.jobs,
            stations: self.lanes.iter().map(|lane| lane.times).collect(),
            fifos: Vec::new(),
        }
    }

    /// All that was seen of a run of so many cycles.
    pub fn finish(mut self, cycles: u64, buses: Vec<LinkStats>) -> (Measured, Observed) {
        for task in 0..self.lanes.len() {
            self.spend(task, self.idle, cycles);
        }
        let (topology, cycles) = (self.topology, Cycles(cycles));
        let observed = Observed {
            profile: self.probe.map(|probe| probe.finish(&topology, cycles)),
            recording: self.recorder.map(|recorder| recorder.finish(&topology, cycles)),
            spans: self.spans.map(|spans| spans.into_values().collect()).unwrap_or_default(),
            ..Observed::default()
        };
        let measured = Measured {
            topology,
            cycles,
            jobs: self.jobs,
            stations: self.lanes.into_iter().map(|lane| lane.times).collect(),
            fifos: Vec::new(),
            links: buses,
        };
        (measured, observed)
    }
}

impl Probe {
    fn spend(&mut self, task: usize, state: StateId, time: Range<u64>) {
        let timeline = &mut self.tasks[task];
        match timeline.within(time.end) {
            Some(bin) => *bin.of_mut(state) += Cycles(time.end - time.start),
            None => timeline.cut(time.start, time.end, |bin, from, to| *bin.of_mut(state) += Cycles(to - from)),
        }
    }

    fn finish(self, topology: &Arc<Topology>, cycles: Cycles) -> Profile {
        let (done, bin) = self.done.finish(cycles.0);
        Profile {
            topology: Arc::clone(topology),
            bin: Cycles(bin),
            cycles,
            stations: self.tasks.into_iter().map(|task| task.finish(cycles.0).0).collect(),
            fifos: Vec::new(),
            jobs: done.into_iter().map(|count| count.0).collect(),
            latency: self.latency,
        }
    }
}
