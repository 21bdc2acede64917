//! Programs of cells: assembled, and run on words without an array.

use std::io::Write;
use std::path::PathBuf;

use numpy::PyArray1;
use pcs_sim::cancel::Cancel;
use pcs_sim::isa::{Executable, Processor, Queue, Queues, Register, Stepper, Stop, listing, object, words};
use pcs_sim::machine::Machine as MachineInCycles;
use pcs_sim::run::machine_file;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat};

use crate::outputs;
use crate::request::{Of, Request, is_path};
use crate::stepping::Stepping;
use crate::trouble::{Trouble, wrong};
use crate::work::briefly;

/// A cell's program, assembled.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct CellProgram {
    /// It, ready to run.
    pub executable: Executable,
}

/// Assembles a cell's program: source text, or an object file. `machine` says what instructions cost.
#[pyfunction]
#[pyo3(signature = (file, *, machine=None))]
pub fn assemble(py: Python<'_>, file: PathBuf, machine: Option<&Bound<'_, PyAny>>) -> PyResult<CellProgram> {
    let given = PyDict::new(py);
    given.set_item("machine", machine)?;
    let Request { options, base, .. } = Request::new(py, Of::Replay, None, None, Some(&given))?;
    briefly(py, |_| {
        let machine: MachineInCycles = machine_file(&options, base.as_ref().map(|base| &base.machine))?.build()?;
        Ok(CellProgram { executable: Executable::new(object::load(&file)?, &machine.instruction_cycles()?) })
    })
}

#[pymethods]
impl CellProgram {
    /// The object file's text.
    #[getter]
    fn object(&self) -> String {
        object::write(self.executable.program())
    }

    /// Addresses, words, source lines, and cycles of instructions and loops.
    #[getter]
    fn listing(&self) -> String {
        listing::listing(&self.executable)
    }

    /// Source text that assembles to the same words.
    #[getter]
    fn disassembly(&self) -> String {
        listing::disassembly(self.executable.program())
    }

    /// Writes the object file, the listing.
    #[pyo3(signature = (*, object=None, listing=None, force=false))]
    fn save(
        &self,
        py: Python<'_>,
        object: Option<PathBuf>,
        listing: Option<PathBuf>,
        force: bool,
    ) -> PyResult<Vec<PathBuf>> {
        let files = [object.map(|path| (path, self.object())), listing.map(|path| (path, self.listing()))];
        briefly(py, |_| {
            let files = files.iter().flatten();
            files.map(|(path, text)| outputs::write(path, force, |file| file.write_all(text.as_bytes()))).collect()
        })
    }

    /// Runs the program on words that come on X and Y: integers, floating-point numbers, or a file as `pcs-sim step` takes it.
    ///
    /// It goes on from message to message until it halts (`stopped` is "halted"), wants a word where no more come ("x",
    /// "y"), or has executed so many `instructions` (None). Gives a dict of that, of what it wrote (`x_out`, `y_out`), how
    /// much it read (`x_read`, `y_read`), `messages` that are done, `executed` instructions, the `cycles` of the last
    /// message, the next `address`, `registers` that are not 0, and its data memory (`data`).
    #[pyo3(signature = (x=None, y=None, *, instructions=None, instruction_limit=None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        x: Option<&Bound<'py, PyAny>>,
        y: Option<&Bound<'py, PyAny>>,
        instructions: Option<u64>,
        instruction_limit: Option<u64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let words = Words { x: words_of(py, "x", x)?, y: words_of(py, "y", y)? };
        let limit = instruction_limit.unwrap_or(Processor::INSTRUCTION_LIMIT);
        let most = instructions.unwrap_or(u64::MAX);
        let (cell, stopped) = briefly(py, |cancel| {
            let mut cell = words.cell(&self.executable, limit);
            let stopped = advance(&mut cell, cancel, |cell, stop| {
                stop.is_some_and(|stop| stop != Stop::Done) || cell.processor().executed() >= most
            })?;
            Ok((cell, stopped))
        })?;
        state(py, &self.executable, &cell, stopped)
    }

    /// Begins to run the program on words, an instruction at a time.
    #[pyo3(signature = (x=None, y=None, *, instruction_limit=None))]
    fn start(
        slf: &Bound<'_, Self>,
        x: Option<&Bound<'_, PyAny>>,
        y: Option<&Bound<'_, PyAny>>,
        instruction_limit: Option<u64>,
    ) -> PyResult<Stepping> {
        let py = slf.py();
        let words = Words { x: words_of(py, "x", x)?, y: words_of(py, "y", y)? };
        Ok(Stepping::new(slf.clone().unbind(), words, instruction_limit.unwrap_or(Processor::INSTRUCTION_LIMIT)))
    }

    fn __repr__(&self) -> String {
        let program = self.executable.program();
        format!("<pcs_sim.CellProgram: {} instructions, {} words of data>", program.code.len(), program.data.len())
    }
}

/// Instructions between two looks at whether the work is to be stopped.
const STEPS: u64 = 1 << 16;

/// The words that come to a cell.
#[derive(Clone, Debug, Default)]
pub struct Words {
    /// On X.
    pub x: Vec<u32>,
    /// On Y.
    pub y: Vec<u32>,
}

impl Words {
    /// A cell to which they come, before its first instruction.
    pub fn cell<'a>(&self, executable: &'a Executable, instruction_limit: u64) -> Stepper<'a> {
        let queues = Queues { x: self.x.clone(), y: self.y.clone(), ..Queues::default() };
        Stepper::new(executable, queues, instruction_limit)
    }
}

/// Executes one instruction after the other until `ends` says so, which is asked after each, and tells why the cell then stands
/// still, if it does.
pub fn advance(
    cell: &mut Stepper<'_>,
    cancel: &Cancel,
    mut ends: impl FnMut(&Stepper<'_>, Option<Stop>) -> bool,
) -> Result<Option<Stop>, Trouble> {
    for step in 0u64.. {
        if step.is_multiple_of(STEPS) {
            cancel.check()?;
        }
        let stop = cell.step().map_err(|fault| Trouble::Fault(Box::new(fault)))?;
        if ends(cell, stop) {
            return Ok(stop);
        }
    }
    Ok(None)
}

/// What can be seen of a cell that stands still for some reason.
pub fn state<'py>(
    py: Python<'py>,
    executable: &Executable,
    cell: &Stepper<'_>,
    stopped: Option<Stop>,
) -> PyResult<Bound<'py, PyDict>> {
    let (processor, queues) = (cell.processor(), &cell.queues);
    let registers = PyDict::new(py);
    for register in Register::all().filter(|register| register.queue().is_none()) {
        let word = processor.register(register);
        if word != 0 {
            registers.set_item(register.to_string(), word)?;
        }
    }
    let data = (0..executable.program().data.len() as u32).filter_map(|address| processor.memory(address));
    let state = PyDict::new(py);
    let stopped = stopped.map(|stop| match stop {
        Stop::Done => "done",
        Stop::Halted => "halted",
        Stop::Waiting(Queue::X | Queue::PassX) => "x",
        Stop::Waiting(Queue::Y) => "y",
    });
    state.set_item("stopped", stopped)?;
    state.set_item("messages", cell.messages())?;
    state.set_item("executed", processor.executed())?;
    state.set_item("cycles", cell.cycles())?;
    state.set_item("address", cell.address())?;
    state.set_item("x_read", queues.x_read)?;
    state.set_item("y_read", queues.y_read)?;
    state.set_item("x_out", PyArray1::from_slice(py, &queues.x_out))?;
    state.set_item("y_out", PyArray1::from_slice(py, &queues.y_out))?;
    state.set_item("registers", registers)?;
    state.set_item("data", PyArray1::from_iter(py, data))?;
    Ok(state)
}

/// Words: those of a file, or integers and floating-point numbers in 32 bits.
pub fn words_of(py: Python<'_>, name: &str, given: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<u32>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    if is_path(given) {
        let path: PathBuf = given.extract()?;
        let read = words::read(&path).map_err(|error| Trouble::from(error).raise(py))?;
        return Ok(read.words);
    }
    let given = if given.hasattr("tolist")? { given.call_method0("tolist")? } else { given.clone() };
    let misfit = |value: &Bound<'_, PyAny>| wrong(py, format!("{name}: expected words of 32 bits, not {value}"));
    let word = |value: Bound<'_, PyAny>| {
        if value.is_instance_of::<PyFloat>() {
            return Ok((value.extract::<f64>()? as f32).to_bits());
        }
        let whole: i64 = value.extract().map_err(|_| misfit(&value))?;
        let fits = (i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(&whole);
        if fits { Ok(whole as u32) } else { Err(misfit(&value)) }
    };
    given.try_iter().map_err(|_| misfit(&given))?.map(|value| word(value?)).collect()
}
