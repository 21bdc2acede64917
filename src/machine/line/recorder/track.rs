//! What the host or one cell did.

use super::Window;
use crate::machine::line::cursor::{Cursor, Halt};
use crate::machine::line::states::{IDLE, MOVING, is_waiting};
use crate::machine::line::watcher::Watcher;
use crate::measure::{JobSpan, StateId, StationRecord, Stretch};
use crate::quantities::Cycles;
use crate::seam::{Op, OpStream};

/// The states and the jobs of the host or of one cell.
#[derive(Clone, Debug, Default)]
pub struct Track {
    states: Vec<Stretch>,
    jobs: Vec<JobSpan>,
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
}

impl Watcher for &mut Recorded<'_> {
    #[inline]
    fn spent(&mut self, state: StateId, from: u64, cycles: u64) {
        if cycles == 0 {
            return;
        }
        let Recorded { track, window } = self;
        track.moved_until(from, *window);
        if !is_waiting(state) {
            track.enter(from);
        }
        track.push(state, from, from + cycles, *window);
        track.now = from + cycles;
    }
}

impl<'a> Recorded<'a> {
    pub(super) fn new(track: &'a mut Track, window: Window) -> Recorded<'a> {
        Recorded { track, window }
    }

    /// Does the ops of a stream from number `done` on line by line, so that it is known which job they are for. `run` does
    /// some ops as far as it can, and tells where it stands then. Returns also how many events were recorded.
    pub fn run(
        mut self,
        stream: &OpStream,
        mut done: usize,
        mut run: impl FnMut(&[Op], &mut Recorded<'_>) -> (Halt, Cursor),
    ) -> (Halt, usize) {
        let before = self.track.events();
        let ops = stream.ops();
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
                return (halt, self.track.events() - before);
            }
        }
    }
}

impl Track {
    /// How many events are held.
    fn events(&self) -> usize {
        self.states.len() + self.jobs.len()
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
        self.push(IDLE, clock, cycles, window);
    }

    /// The track in its final window.
    pub fn into_record(mut self, window: Window) -> StationRecord {
        let end = Cycles(window.until);
        self.forget_from(window.until);
        self.states.last_mut().into_iter().for_each(|last| last.until = last.until.min(end));
        self.jobs.last_mut().into_iter().for_each(|last| last.until = last.until.min(end));
        StationRecord { states: self.states, jobs: self.jobs }
    }
}
