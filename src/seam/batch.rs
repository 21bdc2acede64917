//! The ops of all stations for some jobs, and what must hold of them.

use super::{OpKind, OpStream, Unit};

/// The ops of the host and of every cell for some jobs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpBatch {
    /// What the host does: `w` to the first cell's X, `a`, `c`.
    pub host: OpStream,
    /// What each cell does, from left to right.
    pub cells: Vec<OpStream>,
}

impl OpBatch {
    /// An empty batch for an array of `cells` cells.
    pub fn new(cells: usize) -> OpBatch {
        OpBatch { host: OpStream::default(), cells: vec![OpStream::default(); cells] }
    }

    /// The memory that its ops take, in bytes.
    pub fn bytes(&self) -> u64 {
        self.host.bytes() + self.cells.iter().map(OpStream::bytes).sum::<u64>()
    }

    /// Forgets all ops but keeps the memory.
    pub fn clear(&mut self) {
        self.host.clear();
        self.cells.iter_mut().for_each(OpStream::clear);
    }
}

/// Ops that no array of so many cells could do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BatchError {
    /// The batch is for another number of cells.
    #[error("the batch has ops for {found} cells, and the array has {expected}")]
    Cells {
        /// Cells of the batch.
        found: usize,
        /// Cells of the array.
        expected: usize,
    },
    /// The host has an op that is none of a host's.
    #[error("the host can write to X, work and wait for answers, and do nothing else")]
    Host,
    /// A cell waits for an answer, which only the host can.
    #[error("cell {cell} waits for an answer, which only the host gets")]
    Await {
        /// The cell.
        cell: usize,
    },
    /// The last cell writes words to X.
    #[error("the last cell writes to X, which has nobody to read it")]
    LastWritesX,
    /// Cell 0 writes words to Z.
    #[error("cell 0 writes to Z, which has nobody to read it")]
    FirstWritesZ,
    /// The last cell reads words from Z.
    #[error("the last cell reads from Z, to which nobody writes")]
    LastReadsZ,
}

impl OpBatch {
    /// Whether an array of `cells` cells can do these ops: each of an actor that has it, each word with a reader and a
    /// writer. Whether they come to an end is for the timing half to find out.
    pub fn check(&self, cells: usize) -> Result<(), BatchError> {
        if self.cells.len() != cells {
            return Err(BatchError::Cells { found: self.cells.len(), expected: cells });
        }
        if !self.host.has_only(&[OpKind::Work(Unit(0)), OpKind::WriteX, OpKind::Await]) {
            return Err(BatchError::Host);
        }
        (0..cells).filter(|&cell| !self.cells[cell].has_only(&OpBatch::ANYWHERE)).try_for_each(|cell| {
            self.cells[cell].kinds().try_for_each(|kind| OpBatch::check_op(kind, cell, cell + 1 == cells))
        })
    }

    /// What every cell can have, so that it need not be checked one by one.
    const ANYWHERE: [OpKind; 5] = [OpKind::Work(Unit(0)), OpKind::PassX, OpKind::ReadX, OpKind::ReadY, OpKind::WriteY];

    /// Whether a cell can have an op.
    pub(super) fn check_op(kind: OpKind, cell: usize, is_last: bool) -> Result<(), BatchError> {
        match kind {
            OpKind::Await => Err(BatchError::Await { cell }),
            OpKind::WriteX if is_last => Err(BatchError::LastWritesX),
            OpKind::WriteZ if cell == 0 => Err(BatchError::FirstWritesZ),
            OpKind::ReadZ if is_last => Err(BatchError::LastReadsZ),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What an array of two cells says to ops of the host (`None`) or of a cell, each op of one word, unit or answer.
    fn checked(cell: Option<usize>, kind: OpKind) -> Result<(), BatchError> {
        let mut batch = OpBatch::new(2);
        let stream = match cell {
            None => &mut batch.host,
            Some(cell) => &mut batch.cells[cell],
        };
        stream.push(OpKind::Work(Unit(0)), 1);
        stream.push(kind, 1);
        stream.end_line(0);
        batch.check(2)
    }

    #[test]
    fn a_batch_is_for_one_number_of_cells() {
        for found in [0, 1, 3] {
            assert_eq!(OpBatch::new(found).check(2), Err(BatchError::Cells { found, expected: 2 }));
        }
        assert_eq!(OpBatch::new(2).check(2), Ok(()));
    }

    #[test]
    fn the_host_has_ops_of_its_own() {
        for kind in [OpKind::WriteX, OpKind::Await, OpKind::Work(Unit(3))] {
            assert_eq!(checked(None, kind), Ok(()), "{kind:?}");
        }
        for kind in [OpKind::PassX, OpKind::ReadX, OpKind::ReadY, OpKind::WriteY, OpKind::ReadZ, OpKind::WriteZ] {
            assert_eq!(checked(None, kind), Err(BatchError::Host), "{kind:?}");
        }
    }

    #[test]
    fn what_is_not_checked_is_allowed_everywhere() {
        for kind in OpBatch::ANYWHERE {
            for (cell, is_last) in [(0, true), (0, false), (1, true), (1, false)] {
                assert_eq!(OpBatch::check_op(kind, cell, is_last), Ok(()), "{kind:?}");
            }
        }
    }

    #[test]
    fn each_word_of_a_cell_has_somebody_at_its_other_end() {
        for cell in 0..2 {
            assert_eq!(checked(Some(cell), OpKind::Await), Err(BatchError::Await { cell }));
            for kind in [OpKind::PassX, OpKind::ReadX, OpKind::ReadY, OpKind::WriteY] {
                assert_eq!(checked(Some(cell), kind), Ok(()), "{kind:?}");
            }
        }
        assert_eq!(checked(Some(0), OpKind::WriteX), Ok(()));
        assert_eq!(checked(Some(1), OpKind::WriteX), Err(BatchError::LastWritesX));
        assert_eq!(checked(Some(1), OpKind::WriteZ), Ok(()));
        assert_eq!(checked(Some(0), OpKind::WriteZ), Err(BatchError::FirstWritesZ));
        assert_eq!(checked(Some(0), OpKind::ReadZ), Ok(()));
        assert_eq!(checked(Some(1), OpKind::ReadZ), Err(BatchError::LastReadsZ));
    }
}
