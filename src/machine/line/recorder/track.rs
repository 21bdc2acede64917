//! What the host or one cell did.

use super::Window;
use crate::machine::line::cursor::{Cursor, Halt};
use crate::machine::line::states::{IDLE, MOVING, is_waiting};
use crate::machine::line::watcher::Watcher;
use crate::measure::{JobSpan, OpSpan, StateId, StateTimes, StationRecord, Stretch};
use crate::quantities::Cycles;
use crate::seam::{Op, OpStream};

/// The end of an op of which it is not known.
const UNDER_WAY: Cycles = Cycles(u64::MAX);

/// The states, the jobs and the ops of the host or of one cell.
#[derive(Clone, Debug, Default)]
pub struct Track {
    states: Vec<Stretch>,
    jobs: Vec<JobSpan>,
    /// The ops, the last of which is under way.
    ops: Vec<OpSpan>,
    /// How many ops of the batch have been begun.
    begun: usize,
    /// The first cycle that has not been entered yet.
    now: u64,
    /// The line of ops that is under way.
    line: Option<Line>,
    /// Where the last job began or ended: states are cut there.
    border: u64,
}

#[derive(Clone, Copy, Debug)]
struct Line {
    /// Whose it is; ops behind the last line are nobody's.
    job: Option<u32>,
    /// The first cycle in which it did not wait.
    entered: Option<u64>,
}

/// A track under way, as a watcher of its cell.
#[derive(Debug)]
pub struct Recorded<'a> {
    track: &'a mut Track,
    window: Window,
    /// Those of the batch under way.
    ops: &'a [Op],
}

impl Watcher for &mut Recorded<'_> {
    #[inline]
    fn spent(&mut self, state: StateId, from: u64, cycles: u64, _: &StateTimes) {
        if cycles == 0 {
            return;
        }
        let Recorded { track, window, .. } = self;
        track.moved_until(from, *window);
        if !is_waiting(state) {
            track.enter(from);
        }
        track.push(state, from, from + cycles, *window);
        track.now = from + cycles;
    }

    #[inline]
    fn began(&mut self, op: usize, cycle: u64) {
        let Recorded { track, window, ops } = self;
        if op >= track.begun {
            track.begun = op + 1;
            track.moved_until(cycle, *window);
            track.begin(ops[op], cycle, *window);
        }
    }
}

impl<'a> Recorded<'a> {
    pub(super) fn new(track: &'a mut Track, window: Window) -> Recorded<'a> {
        Recorded { track, window, ops: &[] }
    }

    /// Does the ops of a stream from number `done` on line by line, so that it is known which job they are for. `run` does
    /// some ops as far as it can, and tells where it stands then. Returns also how many events were recorded, and how many
    /// ops.
    pub fn run(
        mut self,
        stream: &'a OpStream,
        mut done: usize,
        mut run: impl FnMut(&[Op], &mut Recorded<'_>) -> (Halt, Cursor),
    ) -> (Halt, [usize; 2]) {
        let before = self.track.held();
        let ops = stream.ops();
        self.ops = ops;
        loop {
            let line = stream.line_of(done);
            let end = line.map_or(ops.len(), |line| line.end as usize);
            self.track.line.get_or_insert(Line { job: line.map(|line| line.job), entered: None });
            let (halt, now) = run(&ops[..end], &mut self);
            done = now.done;
            if halt == Halt::OutOfOps {
                self.track.end_line(now.clock, self.window);
            }
            if halt != Halt::OutOfOps || end == ops.len() {
                if halt == Halt::OutOfOps {
                    self.track.begun = 0;
                }
                // An op that has taken no time is held no more.
                let held = self.track.held();
                return (halt, [0, 1].map(|of| held[of].saturating_sub(before[of])));
            }
        }
    }
}

impl Track {
    /// How many events are held, and how many ops.
    fn held(&self) -> [usize; 2] {
        [self.states.len() + self.jobs.len(), self.ops.len()]
    }

    /// The cycles in which the ops begin that are held for good: one that is under way may turn out to take no time.
    pub fn op_starts(&self) -> impl Iterator<Item = u64> {
        self.ops.iter().filter(|op| op.until < UNDER_WAY).map(|op| op.from.0)
    }

    /// Drops the ops that begin in cycle `end` or later.
    pub fn forget_ops_from(&mut self, end: u64) {
        self.ops.truncate(self.ops.partition_point(|op| op.from.0 < end));
    }

    /// The cycles in which the events that are held begin.
    pub fn starts(&self) -> impl Iterator<Item = u64> {
        let states = self.states.iter().map(|stretch| stretch.from.0);
        states.chain(self.jobs.iter().map(|span| span.from.0))
    }

    /// Drops all that begins in cycle `end` or later.
    pub fn forget_from(&mut self, end: u64) {
        self.states.truncate(self.states.partition_point(|stretch| stretch.from.0 < end));
        self.jobs.truncate(self.jobs.partition_point(|span| span.from.0 < end));
    }

    /// Every cycle is spent in some way; those that nobody entered moved a word.
    fn moved_until(&mut self, cycle: u64, window: Window) {
        if self.now < cycle {
            self.enter(self.now);
            if let Some(op) = self.ops.last_mut() {
                op.before += cycle.min(window.from).saturating_sub(self.now) as u32;
            }
            self.push(MOVING, self.now, cycle, window);
            self.now = cycle;
        }
    }

    /// The line under way does not wait in that cycle.
    fn enter(&mut self, cycle: u64) {
        if let Some(line) = &mut self.line
            && line.entered.is_none()
        {
            line.entered = Some(cycle);
            self.border = cycle;
        }
    }

    /// Comes to an op, with which the one before it is over.
    fn begin(&mut self, op: Op, cycle: u64, window: Window) {
        self.end_op(cycle, window);
        if cycle < window.ops_until {
            let job = self.line.and_then(|line| line.job);
            self.ops.push(OpSpan { op, job, from: Cycles(cycle), until: UNDER_WAY, before: 0 });
        }
    }

    /// The op under way is over. One that took no time, or that was over before the window, is forgotten.
    fn end_op(&mut self, cycle: u64, window: Window) {
        let Some(last) = self.ops.last_mut().filter(|last| last.until == UNDER_WAY) else { return };
        last.until = Cycles(cycle);
        if cycle <= window.from.max(last.from.0) {
            self.ops.pop();
        }
    }

    fn end_line(&mut self, clock: u64, window: Window) {
        self.moved_until(clock, window);
        if let Some(Line { job: Some(job), entered: Some(from) }) = self.line.take()
            && let Some((from, _)) = window.clip(from, self.now)
        {
            self.jobs.push(JobSpan { job, from: Cycles(from), until: Cycles(self.now) });
        }
        self.border = self.now;
    }

    fn push(&mut self, state: StateId, from: u64, until: u64, window: Window) {
        let Some((start, _)) = window.clip(from, until) else { return };
        match self.states.last_mut() {
            Some(last) if last.state == state && last.until.0 == from && from != self.border => {
                last.until = Cycles(until);
            }
            _ => self.states.push(Stretch { state, from: Cycles(start), until: Cycles(until) }),
        }
    }

    /// Ends the track of a run of `cycles` cycles, in which it had spent those before `clock`.
    pub fn finish(&mut self, window: Window, clock: u64, cycles: u64) {
        self.end_line(clock, window);
        self.end_op(clock, window);
        self.push(IDLE, clock, cycles, window);
    }

    /// The track in its final window.
    pub fn into_record(mut self, window: Window) -> StationRecord {
        let end = Cycles(window.until);
        self.forget_from(window.until);
        self.forget_ops_from(window.ops_until);
        self.ops.last_mut().into_iter().for_each(|last| last.until = last.until.min(Cycles(window.ops_until)));
        self.states.last_mut().into_iter().for_each(|last| last.until = last.until.min(end));
        self.jobs.last_mut().into_iter().for_each(|last| last.until = last.until.min(end));
        StationRecord { states: self.states, jobs: self.jobs, ops: self.ops }
    }
}
