//! Records what tasks do cycle by cycle, in a window of time and in bounded memory.
//!
//! A task's state is told when it ends, so not in the order of time. Where a recording is cut must not depend on that: as in a
//! line, it ends before the earliest cycle up to which there would be too many events.

use std::ops::Range;
use std::sync::Arc;

use crate::measure::{JobSpan, MessageSpan, Recording, StateId, StationRecord, Stretch, Topology};
use crate::quantities::Cycles;

/// Records all tasks.
#[derive(Debug)]
pub struct Recorder {
    window: Range<u64>,
    /// Whether the window has been made shorter.
    cut: bool,
    tracks: Vec<Track>,
    messages: Vec<MessageSpan>,
    /// How many events are held.
    events: usize,
    most_events: usize,
}

/// What one task did.
#[derive(Clone, Debug, Default)]
struct Track {
    record: StationRecord,
    /// A job has begun or ended since the last state: they do not run into each other.
    at_border: bool,
}

impl Recorder {
    pub fn new(tasks: usize, window: Range<u64>, most_events: usize) -> Recorder {
        let tracks = vec![Track::default(); tasks];
        Recorder { window, cut: false, tracks, messages: Vec::new(), events: 0, most_events }
    }

    /// The part of some time that lies in the window.
    fn clip(&self, time: Range<u64>) -> Option<Range<u64>> {
        let inside = time.start.max(self.window.start)..time.end.min(self.window.end);
        (!inside.is_empty()).then_some(inside)
    }

    /// A task was in a state.
    pub fn spend(&mut self, task: usize, state: StateId, time: Range<u64>) {
        let Some(inside) = self.clip(time) else { return };
        let track = &mut self.tracks[task];
        let is_same = !std::mem::take(&mut track.at_border);
        match track.record.states.last_mut() {
            Some(last) if is_same && last.state == state && last.until.0 == inside.start => {
                last.until = Cycles(inside.end);
            }
            _ => {
                let stretch = Stretch { state, from: Cycles(inside.start), until: Cycles(inside.end) };
                track.record.states.push(stretch);
                self.count();
            }
        }
    }

    /// A task begins a job.
    pub fn border(&mut self, task: usize) {
        self.tracks[task].at_border = true;
    }

    /// A task has done a job.
    pub fn done(&mut self, task: usize, job: u32, time: Range<u64>) {
        self.border(task);
        if let Some(inside) = self.clip(time) {
            let span = JobSpan { job, from: Cycles(inside.start), until: Cycles(inside.end) };
            self.tracks[task].record.jobs.push(span);
            self.count();
        }
    }

    /// A message sets out.
    pub fn message(&mut self, message: MessageSpan) {
        if self.window.contains(&message.sent.0) {
            self.messages.push(message);
            self.count();
        }
    }

    fn count(&mut self) {
        self.events += 1;
        if self.events >= 2 * self.most_events {
            self.shorten();
        }
    }

    /// Drops the latest events, so that there are no more than may be held.
    fn shorten(&mut self) {
        let starts = |record: &StationRecord| {
            let states = record.states.iter().map(|stretch| stretch.from.0);
            states.chain(record.jobs.iter().map(|span| span.from.0)).collect::<Vec<_>>()
        };
        let sent = self.messages.iter().map(|message| message.sent.0);
        let mut starts: Vec<u64> = self.tracks.iter().flat_map(|track| starts(&track.record)).chain(sent).collect();
        if starts.len() <= self.most_events {
            return;
        }
        let (_, &mut end, _) = starts.select_nth_unstable(self.most_events);
        self.end_at(end);
        self.events = starts.iter().filter(|&&start| start < end).count();
    }

    /// Drops all that lies at a time or later.
    fn end_at(&mut self, end: u64) {
        self.window.end = end;
        self.cut = true;
        self.tracks.iter_mut().for_each(|track| track.record.end_at(Cycles(end)));
        self.messages.truncate(self.messages.partition_point(|message| message.sent.0 < end));
    }

    /// All that was recorded of a run.
    pub fn finish(mut self, topology: &Arc<Topology>, cycles: Cycles) -> Recording {
        self.shorten();
        let from = self.window.start.min(cycles.0);
        Recording {
            topology: Arc::clone(topology),
            window: Cycles(from)..Cycles(self.window.end.clamp(from, cycles.0)),
            cycles,
            cut: self.cut,
            units: Vec::new(),
            ops_until: Cycles(from),
            host: None,
            answers: Vec::new(),
            stations: self.tracks.into_iter().map(|track| track.record).collect(),
            fifos: Vec::new(),
            messages: self.messages,
        }
    }
}
