//! What only a whole trace tells.

use std::collections::HashMap;
use std::path::Path;

use super::line::{Actor, Line};
use crate::error::InputError;
use crate::seam::{OpBatch, OpKind};

/// What is found out about a trace before it is timed.
#[derive(Default)]
pub(super) struct Survey {
    pub(super) cells: usize,
    pub(super) jobs: u64,
    pub(super) order: HashMap<u32, u64>,
    /// Jobs whose answers the host waits for, and the lines.
    awaited: Vec<(u64, usize)>,
    /// Words that the last cell so far writes to Y, and for which jobs, in order.
    answers: Vec<Answer>,
    /// The last of the cells that have an op that the array's last cell cannot have, and the line.
    writes_x: Option<(usize, usize)>,
    reads_z: Option<(usize, usize)>,
}

/// What the last cell writes to Y in one line.
struct Answer {
    job: u32,
    words: u64,
    line: usize,
}

impl Survey {
    pub(super) fn take(&mut self, line: &Line<'_>) -> Result<(), InputError> {
        let job = line.job()?;
        match line.actor()? {
            Actor::Host => self.take_host(job, line),
            Actor::Cell(index) => self.take_cell(job, index, line),
        }
    }

    fn take_host(&mut self, job: u32, line: &Line<'_>) -> Result<(), InputError> {
        if self.order.insert(job, self.jobs).is_some() {
            return Err(line.error(line.words[0], format!("the host has two lines for ray {job}")));
        }
        self.jobs += 1;
        line.ops().try_for_each(|op| {
            let (kind, count) = op?;
            self.awaited.extend((kind == OpKind::Await).then_some((count, line.number)));
            Ok(())
        })
    }

    fn take_cell(&mut self, job: u32, index: usize, line: &Line<'_>) -> Result<(), InputError> {
        if index >= self.cells {
            self.cells = index + 1;
            self.answers.clear();
        }
        let mut words = 0;
        line.ops().try_for_each(|op| {
            let (kind, count) = op?;
            words += if kind == OpKind::WriteY { count } else { 0 };
            let here = |asked: OpKind| (kind == asked).then_some((index, line.number));
            self.writes_x = self.writes_x.max(here(OpKind::WriteX));
            self.reads_z = self.reads_z.max(here(OpKind::ReadZ));
            // Which cell is the last, only the whole trace tells.
            OpBatch::check_op(kind, index, false).map_err(|error| line.error(line.words[1], error.to_string()))
        })?;
        if index + 1 == self.cells && words > 0 {
            self.answers.push(Answer { job, words, line: line.number });
        }
        Ok(())
    }

    /// Whether there was no line.
    pub(super) fn is_empty(&self) -> bool {
        self.cells == 0 && self.jobs == 0
    }

    /// What only the whole trace shows.
    pub(super) fn check(&self, path: &Path, answer_words: u64) -> Result<(), InputError> {
        let sent = |job: &u64| u32::try_from(*job).is_ok_and(|job| self.order.contains_key(&job));
        let fail = |message: String| Err(InputError::in_file(path, message));
        if let Some((job, line)) = self.awaited.iter().find(|(job, _)| !sent(job)) {
            return fail(format!("line {line}: the host waits for ray {job}, which it never sends"));
        }
        for (kind, last) in [(OpKind::WriteX, self.writes_x), (OpKind::ReadZ, self.reads_z)] {
            if let Some((cell, line)) = last.filter(|(cell, _)| cell + 1 == self.cells)
                && let Err(error) = OpBatch::check_op(kind, cell, true)
            {
                return fail(format!("line {line}: {error}"));
            }
        }
        if self.cells == 0 || self.jobs == 0 {
            let what = if self.jobs == 0 { "the host" } else { "a cell" };
            return fail(format!("the file is no activity trace: it has no line of {what}"));
        }
        self.check_answers(answer_words).or_else(fail)
    }

    /// Answers must come back in the order in which the host sends the jobs, and whole where it waits for one: the n-th answer
    /// is then the n-th job's own.
    fn check_answers(&self, answer_words: u64) -> Result<(), String> {
        let place = |answer: &Answer| self.order.get(&answer.job).copied();
        let sent = || self.answers.iter().filter_map(|answer| Some((answer, place(answer)?)));
        if let Some(((before, _), (after, _))) = sent().zip(sent().skip(1)).find(|((_, n), (_, next))| next < n) {
            return Err(format!(
                "line {}: cell {}, the last one, answers ray {} after ray {}, which the host sends later; answers must \
                 come back in the order in which the rays are sent",
                after.line,
                self.cells - 1,
                after.job,
                before.job
            ));
        }
        if self.awaited.is_empty() {
            return Ok(());
        }
        // Words up to and with the n-th job's answer.
        let mut written = 0u64;
        let mut until: HashMap<u64, u64> = HashMap::new();
        for answer in &self.answers {
            written += answer.words;
            until.extend(place(answer).map(|place| (place, written)));
        }
        let own = |place: u64| until.get(&place) == Some(&((place + 1) * answer_words));
        let first = |place: u64| place == 0 || own(place - 1);
        let waits = self.awaited.iter().filter_map(|&(job, line)| Some((job, line, u32::try_from(job).ok()?)));
        let waits = waits.filter_map(|(job, line, key)| Some((job, line, *self.order.get(&key)?)));
        match waits.into_iter().find(|&(_, _, place)| !(own(place) && first(place))) {
            None => Ok(()),
            Some((job, line, _)) => Err(format!(
                "line {line}: the host waits for the answer of ray {job}, which is not known: the last cell must write \
                 {answer_words} words to Y for it, and as many for each ray that is sent before it"
            )),
        }
    }
}
