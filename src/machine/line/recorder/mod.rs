//! Records what an array does cycle by cycle, in a window of time and in bounded memory.
//!
//! Cells run ahead of each other, so events come cell by cell and out of order. Where a recording is cut must not depend
//! on that: it ends before the earliest cycle up to which there would be too many events. Whenever there are twice as
//! many as it may hold, the latest are dropped, and the window ends where they began; nothing after that is recorded.

mod answers;
mod owners;
mod passages;
mod track;
mod words;

use std::ops::Range;

use std::sync::Arc;

use super::link::Link;
use crate::measure::{FifoLevels, PathUnit, Recording, Topology};
use crate::quantities::Cycles;
use crate::seam::{Channel, Op, OpBatch, OpKind, OpStream};
use answers::Answers;
use track::Track;
use words::WordTimes;

pub(super) use track::Recorded;

/// Records all cells and FIFOs of an array, and its host.
#[derive(Debug)]
pub(super) struct Recorder {
    window: Window,
    /// Whether the window has been made shorter.
    cut: bool,
    host: Track,
    cells: Vec<Track>,
    /// X, Y and Z of each link, where there is such a FIFO.
    links: Vec<[Option<WordTimes>; 3]>,
    answers: Answers,
    /// About how many events are held: all but those of the last stretches.
    events: usize,
    /// About how many ops are held.
    ops: usize,
    most_events: usize,
}

/// The cycles that are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    from: u64,
    until: u64,
    /// Of these, the ops of the cycles before this one: there may be any number of ops in a stretch.
    ops_until: u64,
}

impl Window {
    /// The part of `from..until` that lies inside; `None` if none does.
    #[inline]
    fn clip(self, from: u64, until: u64) -> Option<(u64, u64)> {
        let (from, until) = (from.max(self.from), until.min(self.until));
        (from < until).then_some((from, until))
    }
}

impl Recorder {
    /// A recorder for an array of `cells` cells.
    pub fn new(cells: usize, answer_words: u64, window: Range<Cycles>, most_events: usize) -> Recorder {
        let words = |exists: bool| exists.then(WordTimes::default);
        Recorder {
            window: Window { from: window.start.0, until: window.end.0, ops_until: window.end.0 },
            cut: false,
            host: Track::default(),
            cells: vec![Track::default(); cells],
            links: (0..=cells)
                .map(|link| [words(link < cells), words(link > 0), words(link > 0 && link < cells)])
                .collect(),
            answers: Answers::new(answer_words),
            events: 0,
            ops: 0,
            most_events,
        }
    }

    /// Whether anything from cycle `clock` on may be recorded.
    pub fn is_open_at(&self, clock: u64) -> bool {
        clock < self.window.until
    }

    /// The track of the host.
    pub fn host(&mut self) -> Recorded<'_> {
        Recorded::new(&mut self.host, self.window)
    }

    /// The track of a cell.
    pub fn cell(&mut self, index: usize) -> Recorded<'_> {
        Recorded::new(&mut self.cells[index], self.window)
    }

    /// The next ops are known.
    pub fn fed(&mut self, batch: &OpBatch) {
        self.answers.fed(&batch.host);
        self.fed_words(None, &batch.host);
        for (cell, stream) in batch.cells.iter().enumerate() {
            self.fed_words(Some(cell), stream);
        }
    }

    /// The next ops of a cell, or of the host, are known: which words they write, and for which jobs.
    fn fed_words(&mut self, cell: Option<usize>, stream: &OpStream) {
        let is_last = cell.is_some_and(|cell| cell + 1 == self.cells.len());
        let link = |channel: Channel| match channel {
            Channel::Z => cell.unwrap_or_default(),
            Channel::X | Channel::Y => cell.map_or(0, |cell| cell + 1),
        };
        let is_over = |channel: Channel| {
            self.links[link(channel)][channel as usize].as_ref().is_none_or(|words| words.passages.is_over())
        };
        if Channel::ALL.into_iter().all(is_over) {
            return;
        }
        let lines = stream.lines().map(|(job, ops)| (Some(job), ops));
        let of_jobs: usize = stream.lines().map(|(_, ops)| ops.len()).sum();
        for (job, ops) in lines.chain([(None, &stream.ops()[of_jobs..])]) {
            let mut words = [0; 3];
            // Nobody takes the words that the last cell passes on.
            let writes = |op: &&Op| !(is_last && op.kind() == OpKind::PassX);
            for op in ops.iter().filter(writes) {
                op.kind().writes().into_iter().for_each(|channel| words[channel as usize] += op.count() as u64);
            }
            for channel in Channel::ALL {
                let fifo = self.links[link(channel)][channel as usize].as_mut();
                fifo.into_iter().for_each(|fifo| fifo.fed(job, words[channel as usize]));
            }
        }
    }

    /// Follows the FIFOs of a link, after each stretch of reads or writes.
    pub fn follow(&mut self, index: usize, link: &Link) {
        for (words, fifo) in self.links[index].iter_mut().zip([&link.x, &link.y, &link.z]) {
            if let Some(words) = words {
                self.events += words.follow(fifo, self.window);
            }
        }
        if index == self.cells.len() {
            self.events += self.answers.follow(&link.y, self.window);
        }
        if self.events >= 2 * self.most_events {
            self.shorten();
        }
    }

    /// A stretch of a cell or of the host has added so many events, and so many ops.
    pub fn count(&mut self, [events, ops]: [usize; 2]) {
        self.events += events;
        self.ops += ops;
        if self.ops >= 2 * self.most_events {
            self.shorten_ops();
        }
    }

    /// Drops the latest ops, so that there are no more than may be held.
    fn shorten_ops(&mut self) {
        let mut starts: Vec<u64> = self.tracks().flat_map(Track::op_starts).collect();
        if starts.len() <= self.most_events {
            return;
        }
        let (_, &mut end, _) = starts.select_nth_unstable(self.most_events);
        self.window.ops_until = end;
        std::iter::once(&mut self.host).chain(&mut self.cells).for_each(|track| track.forget_ops_from(end));
        self.ops = starts.iter().filter(|&&start| start < end).count();
    }

    /// The host's track, and the cells'.
    fn tracks(&self) -> impl Iterator<Item = &Track> {
        std::iter::once(&self.host).chain(&self.cells)
    }

    /// Drops the latest events, so that there are no more than may be held.
    fn shorten(&mut self) {
        let words = || self.links.iter().flatten().flatten();
        let starts = self.tracks().flat_map(Track::starts).chain(words().flat_map(WordTimes::times));
        let mut starts: Vec<u64> = starts.chain(self.answers.starts()).collect();
        if starts.len() <= self.most_events {
            return;
        }
        let (_, &mut end, _) = starts.select_nth_unstable(self.most_events);
        (self.window.until, self.window.ops_until) = (end, self.window.ops_until.min(end));
        self.cut = true;
        for track in std::iter::once(&mut self.host).chain(&mut self.cells) {
            track.forget_from(end);
            track.forget_ops_from(end);
        }
        self.links.iter_mut().flatten().flatten().for_each(|words| words.forget_from(end));
        self.answers.forget_from(end);
        self.events = starts.iter().filter(|&&start| start < end).count();
    }

    /// All that was recorded of a run of `cycles` cycles. `clocks` are those of the host and of the cells at its end.
    pub fn finish(
        mut self,
        (topology, units): (&Arc<Topology>, Vec<PathUnit>),
        links: &[Link],
        clocks: impl Iterator<Item = u64>,
        cycles: u64,
    ) -> Recording {
        for (track, clock) in std::iter::once(&mut self.host).chain(&mut self.cells).zip(clocks) {
            track.finish(self.window, clock, cycles);
        }
        self.shorten();
        self.shorten_ops();
        let from = self.window.from.min(cycles);
        let until = self.window.until.clamp(from, cycles.max(from));
        let window = Window { from, until, ops_until: self.window.ops_until.clamp(from, until) };
        let mut fifos: [Vec<FifoLevels>; 3] = Default::default();
        for (words, link) in self.links.into_iter().zip(links) {
            for (words, channel) in words.into_iter().zip(Channel::ALL) {
                let fifo = link.fifo(channel);
                let words = words.filter(|_| channel != Channel::Z || fifo.words_written() > 0);
                let levels = |words: WordTimes| words.finish(window);
                fifos[channel as usize].extend(words.map(levels));
            }
        }
        Recording {
            topology: Arc::clone(topology),
            window: Cycles(window.from)..Cycles(window.until),
            cycles: Cycles(cycles),
            cut: self.cut,
            units,
            ops_until: Cycles(window.ops_until),
            host: Some(self.host.into_record(window)),
            answers: self.answers.into_spans(window),
            stations: self.cells.into_iter().map(|track| track.into_record(window)).collect(),
            fifos: fifos.into_iter().flatten().collect(),
            messages: Vec::new(),
        }
    }
}
