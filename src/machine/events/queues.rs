//! The queues of tasks: how much waits in each, as the tasks tell that have them.

use std::ops::Range;

use crate::machine::timeline::{Timeline, bins_for, histogram};
use crate::measure::{FifoBin, FifoLevels, FifoProfile, FifoStats, Measured, Observed};
use crate::quantities::{Cycles, Words};

/// A queue for each of some tasks, which tell in the order of time what is in it.
#[derive(Clone, Debug)]
pub struct Queues {
    queues: Vec<Queue>,
    /// The same over time, if that is seen.
    probe: Vec<Lane>,
    recorder: Option<Recorder>,
}

/// A queue, which has been told of up to a time.
#[derive(Clone, Copy, Debug, Default)]
struct Queue {
    holds: u64,
    is_full: bool,
    since: u64,
    /// The most that it has held at that time.
    peak: u64,
    stats: FifoStats,
}

/// A queue over time.
#[derive(Clone, Debug)]
struct Lane {
    timeline: Timeline<FifoBin>,
    /// For each level the cycles for which it was held, up to the highest.
    held: Vec<u64>,
}

/// A window of all queues, cycle by cycle.
#[derive(Clone, Debug)]
struct Recorder {
    window: Range<u64>,
    /// For each queue the first cycle of the window, and each one in which the level changes, with the level at its end.
    levels: Vec<Vec<(Cycles, Words)>>,
    /// How many more of them may be held.
    room: usize,
}

impl Queues {
    /// So many queues, all empty.
    pub fn new(count: usize) -> Queues {
        Queues { queues: vec![Queue::default(); count], probe: Vec::new(), recorder: None }
    }

    /// The same with a probe, which sees them over time: in bins like those of a machine with so many stations.
    pub fn probed(mut self, stations: usize) -> Queues {
        let lane = Lane { timeline: Timeline::new(bins_for(stations)), held: Vec::new() };
        self.probe = vec![lane; self.queues.len()];
        self
    }

    /// The same with a recorder of a window of time, which holds so many changes at the most.
    pub fn recorded(mut self, window: Range<Cycles>, most_changes: usize) -> Queues {
        let levels = vec![vec![(window.start, Words(0))]; self.queues.len()];
        self.recorder = Some(Recorder { window: window.start.0..window.end.0, levels, room: most_changes });
        self
    }

    /// From now on so much waits in a queue.
    #[inline(always)]
    pub fn hold(&mut self, queue: usize, holds: u64, now: Cycles) {
        let at = &mut self.queues[queue];
        at.go_on(now.0, self.probe.get_mut(queue));
        at.stats.words += Words(holds.saturating_sub(at.holds));
        at.stats.max = at.stats.max.max(Words(holds));
        (at.holds, at.peak) = (holds, at.peak.max(holds));
        if let Some(recorder) = &mut self.recorder {
            recorder.hold(queue, holds, now);
        }
    }

    /// From now on a queue has no room for what comes, or has again.
    #[inline(always)]
    pub fn fill(&mut self, queue: usize, is_full: bool, now: Cycles) {
        let at = &mut self.queues[queue];
        if at.is_full != is_full {
            at.go_on(now.0, self.probe.get_mut(queue));
            at.is_full = is_full;
        }
    }

    /// What each has held so far, and up to which cycle that goes.
    pub fn so_far(&self) -> Vec<(FifoStats, Cycles)> {
        self.queues.iter().map(|queue| (queue.stats, Cycles(queue.since))).collect()
    }

    /// Adds what was seen of the queues to what was seen of their tasks.
    pub fn tell(mut self, measured: &mut Measured, observed: &mut Observed) {
        let cycles = measured.cycles;
        for (queue, at) in self.queues.iter_mut().enumerate() {
            at.go_on(cycles.0, self.probe.get_mut(queue));
        }
        measured.fifos = self.queues.iter().map(|queue| queue.stats).collect();
        if let Some(profile) = &mut observed.profile {
            profile.fifos = self.probe.into_iter().map(|lane| lane.finish(cycles.0)).collect();
        }
        if let (Some(recording), Some(recorder)) = (&mut observed.recording, self.recorder) {
            recording.end_at(Cycles(recorder.window.end));
            recording.fifos = recorder.finish(recording.window.end);
        }
    }
}

impl Queue {
    /// All stays as it is up to a time. `lane` is the queue over time, if that is seen.
    #[inline]
    fn go_on(&mut self, now: u64, lane: Option<&mut Lane>) {
        let cycles = now - self.since;
        if cycles == 0 {
            return;
        }
        self.stats.word_cycles += u128::from(self.holds) * u128::from(cycles);
        self.stats.full += Cycles(if self.is_full { cycles } else { 0 });
        self.stats.empty += Cycles(if self.holds == 0 { cycles } else { 0 });
        if let Some(lane) = lane {
            lane.go_on(self, now);
        }
        (self.since, self.peak) = (now, self.holds);
    }
}

impl Lane {
    #[inline(never)]
    fn go_on(&mut self, queue: &Queue, now: u64) {
        let (holds, since) = (queue.holds, queue.since);
        if self.held.len() <= holds as usize {
            self.held.resize(holds as usize + 1, 0);
        }
        self.held[holds as usize] += now - since;
        let first = self.timeline.at(since);
        first.max = first.max.max(Words(queue.peak));
        match self.timeline.within(now) {
            Some(bin) => bin.hold(holds, now - since, queue.is_full),
            None => self.timeline.cut(since, now, |bin, from, to| bin.hold(holds, to - from, queue.is_full)),
        }
    }

    fn finish(self, cycles: u64) -> FifoProfile {
        let (histogram, step) = histogram(&self.held);
        FifoProfile { bins: self.timeline.finish(cycles).0, histogram, step }
    }
}

impl Recorder {
    #[inline(never)]
    fn hold(&mut self, queue: usize, holds: u64, now: Cycles) {
        if now.0 >= self.window.end {
            return;
        }
        let at = now.max(Cycles(self.window.start));
        let levels = &mut self.levels[queue];
        match levels.last_mut() {
            Some(last) if last.0 == at => last.1 = Words(holds),
            _ if self.room == 0 => self.window.end = now.0,
            _ => {
                levels.push((at, Words(holds)));
                self.room -= 1;
            }
        }
    }

    fn finish(self, end: Cycles) -> Vec<FifoLevels> {
        let levels = |mut levels: Vec<(Cycles, Words)>| {
            levels.truncate(levels.partition_point(|(at, _)| *at < end));
            FifoLevels { levels, ..FifoLevels::default() }
        };
        self.levels.into_iter().map(levels).collect()
    }
}
