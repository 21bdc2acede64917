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
    /// The last of the cells that have an op that the array's last cell cannot have, and the line.
    writes_x: Option<(usize, usize)>,
    reads_z: Option<(usize, usize)>,
}

impl Survey {
    pub(super) fn take(&mut self, line: &Line<'_>) -> Result<(), InputError> {
        let job = line.job()?;
        match line.actor()? {
            Actor::Host => self.take_host(job, line),
            Actor::Cell(index) => self.take_cell(index, line),
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

    fn take_cell(&mut self, index: usize, line: &Line<'_>) -> Result<(), InputError> {
        self.cells = self.cells.max(index + 1);
        line.ops().try_for_each(|op| {
            let (kind, _) = op?;
            let here = |asked: OpKind| (kind == asked).then_some((index, line.number));
            self.writes_x = self.writes_x.max(here(OpKind::WriteX));
            self.reads_z = self.reads_z.max(here(OpKind::ReadZ));
            // Which cell is the last, only the whole trace tells.
            OpBatch::check_op(kind, index, false).map_err(|error| line.error(line.words[1], error.to_string()))
        })
    }

    /// What only the whole trace shows.
    pub(super) fn check(&self, path: &Path) -> Result<(), InputError> {
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
        Ok(())
    }
}
