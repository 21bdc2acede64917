//! A cell's program under way, an instruction at a time.

use std::collections::BTreeSet;
use std::sync::Mutex;

use pcs_sim::cancel::Cancel;
use pcs_sim::isa::listing;
use pcs_sim::isa::{Executable, Stepper, Stop};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt};

use crate::cells::{CellProgram, Words, advance, state, words_of};
use crate::made::locked;
use crate::trouble::{Trouble, wrong};
use crate::work::briefly;

/// A cell's program under way, an instruction at a time, on words that may come later.
///
/// `CellProgram.start` makes it. What a cell does depends on its words alone, so all that is kept is how far it is: each call runs the
/// program from its start to there.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct Stepping {
    program: Py<CellProgram>,
    instruction_limit: u64,
    at: Mutex<Progress>,
}

/// How far it is.
#[derive(Clone, Debug, Default)]
struct Progress {
    words: Words,
    /// Steps in which something was done.
    steps: u64,
    breakpoints: BTreeSet<u32>,
}

impl Stepping {
    /// Before the first instruction.
    pub fn new(program: Py<CellProgram>, words: Words, instruction_limit: u64) -> Stepping {
        let at = Mutex::new(Progress { words, ..Progress::default() });
        Stepping { program, instruction_limit, at }
    }

    /// Goes on, for so many steps at the most, to where the cell stands still or to a breakpoint.
    fn advance<'py>(&self, py: Python<'py>, most: u64) -> PyResult<Bound<'py, PyDict>> {
        let executable = &self.program.get().executable;
        let mut now = locked(&self.at).clone();
        let (cell, stopped, at_breakpoint) = briefly(py, |cancel| {
            let mut cell = now.cell(executable, self.instruction_limit, cancel)?;
            let (mut done, mut stopped, mut at_breakpoint) = (0, None, false);
            if most > 0 {
                stopped = advance(&mut cell, cancel, |cell, stop| {
                    done += u64::from(!matches!(stop, Some(Stop::Waiting(_))));
                    at_breakpoint = stop.is_none() && now.breakpoints.contains(&cell.address());
                    stop.is_some() || at_breakpoint || done >= most
                })?;
            }
            now.steps += done;
            Ok((cell, stopped, at_breakpoint))
        })?;
        locked(&self.at).steps = now.steps;
        let told = state(py, executable, &cell, stopped)?;
        if at_breakpoint {
            told.set_item("stopped", "breakpoint")?;
        }
        Ok(told)
    }
}

impl Progress {
    /// The cell as it is now.
    fn cell<'a>(&self, executable: &'a Executable, limit: u64, cancel: &Cancel) -> Result<Stepper<'a>, Trouble> {
        let mut cell = self.words.cell(executable, limit);
        let mut left = self.steps;
        if left > 0 {
            advance(&mut cell, cancel, |_, _| {
                left -= 1;
                left == 0
            })?;
        }
        Ok(cell)
    }
}

#[pymethods]
impl Stepping {
    /// Executes so many instructions, or fewer if the cell then stands still or comes to a breakpoint. Gives what
    /// `CellProgram.step` does; `stopped` may also be "done" (with a message) and "breakpoint".
    #[pyo3(signature = (instructions=1))]
    fn step<'py>(&self, py: Python<'py>, instructions: u64) -> PyResult<Bound<'py, PyDict>> {
        self.advance(py, instructions)
    }

    /// Goes on to a breakpoint, or until the cell stands still: done with a message, halted, or without a word that it wants.
    fn run<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.advance(py, u64::MAX)
    }

    /// Lets more words come on X and Y.
    #[pyo3(signature = (x=None, y=None))]
    fn feed(&self, py: Python<'_>, x: Option<&Bound<'_, PyAny>>, y: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let (x, y) = (words_of(py, "x", x)?, words_of(py, "y", y)?);
        let words = &mut locked(&self.at).words;
        words.x.extend(x);
        words.y.extend(y);
        Ok(())
    }

    /// Sets breakpoints, in place of those that were set: addresses, labels, or lines of the program's own file as texts.
    #[pyo3(name = "break_at", signature = (*places))]
    fn break_at(&self, py: Python<'_>, places: Vec<Bound<'_, PyAny>>) -> PyResult<()> {
        let program = self.program.get().executable.program();
        let address = |place: &Bound<'_, PyAny>| {
            let text = if place.is_instance_of::<PyInt>() { format!("@{place}") } else { place.to_string() };
            program.address_of(&text).map_err(|error| wrong(py, error))
        };
        locked(&self.at).breakpoints = places.iter().map(address).collect::<PyResult<_>>()?;
        Ok(())
    }

    /// What the cell is at now, without executing anything.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.advance(py, 0)
    }

    /// The instruction that comes next: its address, words and line of source.
    fn __str__(&self, py: Python<'_>) -> PyResult<String> {
        let executable = &self.program.get().executable;
        let now = locked(&self.at).clone();
        briefly(py, |cancel| {
            let cell = now.cell(executable, self.instruction_limit, cancel)?;
            Ok(listing::row(executable, cell.address()))
        })
    }
}
