//! Reading a trace: once through to check it, then in batches, any number of times.

use std::collections::HashMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::heading::{Halt, Heading};
use super::line::{Actor, Line, lines};
use super::survey::Survey;
use super::{Form, MAGIC};
use crate::error::InputError;
use crate::input::file;
use crate::quantities::Cycles;
use crate::seam::{Costs, OpBatch, Vocabulary};

/// Lines that a batch of a replay has at the most.
const BATCH_LINES: usize = 4096;

/// A trace file that has been read through once, and found well formed.
#[derive(Debug)]
pub struct ActivityTrace {
    path: PathBuf,
    file: File,
    form: Form,
    costs: Costs,
    cells: usize,
    jobs: u64,
    /// The place of each job among the host's lines.
    order: HashMap<u32, u64>,
}

impl ActivityTrace {
    /// Opens a trace and checks every line of it. `cycles` is the vocabulary of a trace that counts in cycles.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, or some line is none of a trace: with the line and the column.
    pub fn open(path: &Path, cycles: &Arc<Vocabulary>) -> Result<ActivityTrace, InputError> {
        let unreadable = |error: std::io::Error| InputError::unreadable(path, &error);
        let file = file::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Err(InputError::in_file(path, "cannot read the file: it is a directory"));
        }
        let costs = Costs::new(Arc::clone(cycles), |_| Cycles(1));
        let (form, order) = (Form::Cycles, HashMap::new());
        let mut trace = ActivityTrace { path: path.to_owned(), file, form, costs, cells: 0, jobs: 0, order };
        trace.survey()?;
        Ok(trace)
    }

    /// What it counts work in.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Its units, and what they cost when it was recorded.
    pub fn costs(&self) -> &Costs {
        &self.costs
    }

    /// Number of cells: one more than the highest that has a line.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Number of jobs: of the host's lines.
    pub fn jobs(&self) -> u64 {
        self.jobs
    }

    /// Reads the trace from its start and hands it on in batches.
    pub fn for_each_batch<E: From<InputError>>(
        &mut self,
        mut take: impl FnMut(OpBatch) -> Result<(), E>,
    ) -> Result<(), E> {
        let order = std::mem::take(&mut self.order);
        let mut batch = OpBatch::new(self.cells);
        let mut lines = 0;
        let result = self.for_each_line(|line| {
            let stream = match line.actor()? {
                Actor::Host => &mut batch.host,
                Actor::Cell(index) => &mut batch.cells[index],
            };
            line.push_to(stream, &order)?;
            lines += 1;
            if lines % BATCH_LINES == 0 {
                let cells = batch.cells.len();
                take(std::mem::replace(&mut batch, OpBatch::new(cells)))?;
            }
            Ok::<(), E>(())
        });
        self.order = order;
        result?;
        take(batch)
    }

    /// Counts cells and jobs, and checks every line.
    fn survey(&mut self) -> Result<(), InputError> {
        self.read_heading()?;
        let mut survey = Survey::default();
        self.for_each_line(|line| survey.take(&line))?;
        if self.form == Form::Units && survey.is_empty() {
            return Err(InputError::in_file(&self.path, "the trace sends no ray: there is nothing to time"));
        }
        survey.check(&self.path, self.costs.vocabulary().answer_words)?;
        (self.cells, self.jobs, self.order) = (survey.cells, survey.jobs, survey.order);
        Ok(())
    }

    /// Reads the heading of a trace in units, if it has one.
    fn read_heading(&mut self) -> Result<(), InputError> {
        let mut heading: Option<Heading> = None;
        let path = self.path.clone();
        let read = lines(&path, &self.file, |number, text| {
            let line = Line::of_heading(&path, number, text);
            match &mut heading {
                None if text.starts_with(MAGIC) => heading = Some(Heading::begin(&line)?),
                Some(heading) if text.starts_with("unit ") => heading.add(&line)?,
                _ => return Err(Halt::AtBody),
            }
            Ok(())
        });
        match read {
            Err(Halt::Input(error)) => return Err(error),
            Err(Halt::AtBody) | Ok(()) => {}
        }
        if let Some(heading) = heading {
            (self.form, self.costs) = (Form::Units, heading.into_costs());
        }
        Ok(())
    }

    /// Calls `visit` for every line of ops.
    fn for_each_line<E: From<InputError>>(
        &mut self,
        mut visit: impl FnMut(Line<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let vocabulary = Arc::clone(self.costs.vocabulary());
        let has_heading = self.form == Form::Units;
        lines(&self.path, &self.file, |number, text| {
            let is_heading = has_heading && (text.starts_with(MAGIC) || text.starts_with("unit "));
            if is_heading { Ok(()) } else { visit(Line::new(&self.path, number, text, &vocabulary)) }
        })
    }
}
