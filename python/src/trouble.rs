//! What can go wrong, as exceptions.

use std::fmt::{Display, Write};

use pcs_sim::cancel::Cancelled;
use pcs_sim::error::{self, Spot};
use pcs_sim::isa::Fault;
use pcs_sim::machine::{Stuck, StuckKind, Wait, WaitFor};
use pcs_sim::program::NotLaidOut;
use pcs_sim::run::RunError;
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

create_exception!(
    pcs_sim,
    InputError,
    PyValueError,
    "A mistake in an input: what is wrong, where, and what to do about it.\n\n\
     Its text is the command's. `message`, `help`, `file`, `line` and `column` are its parts, None where there is none."
);
create_exception!(
    pcs_sim,
    Deadlock,
    PyRuntimeError,
    "The array can go no further.\n\n\
     `kind` is \"deadlock\" if the waits form a loop, or \"starved\" if the last one waits for what is never done.\n\
     `waits` are the waits, a dict each, every one for the `actor` of the next."
);
create_exception!(
    pcs_sim,
    CellFault,
    PyRuntimeError,
    "A cell's program cannot go on. `cell`, `ray` and `address` say where."
);

/// Why something failed.
#[derive(Debug)]
pub enum Trouble {
    /// A mistake in an input.
    Input(Box<error::InputError>),
    /// The array can go no further.
    Stuck(Stuck),
    /// A cell's program cannot go on.
    Fault(Box<Fault>),
    /// A result could not be made or written.
    Output(String),
    /// It was told to stop.
    Cancelled,
}

/// A result could not be made or written.
pub fn output(error: impl Display) -> Trouble {
    Trouble::Output(error.to_string())
}

impl From<error::InputError> for Trouble {
    fn from(error: error::InputError) -> Trouble {
        Trouble::Input(Box::new(error))
    }
}

impl From<Cancelled> for Trouble {
    fn from(_: Cancelled) -> Trouble {
        Trouble::Cancelled
    }
}

impl From<NotLaidOut> for Trouble {
    fn from(not: NotLaidOut) -> Trouble {
        match not {
            NotLaidOut::Unfit(error) => error.into(),
            NotLaidOut::Cancelled(cancelled) => cancelled.into(),
        }
    }
}

impl<E: Display> From<RunError<E>> for Trouble {
    fn from(error: RunError<E>) -> Trouble {
        match error {
            RunError::Stuck(stuck) => Trouble::Stuck(stuck),
            RunError::Fault(fault) => Trouble::Fault(Box::new(fault)),
            RunError::Unfit(error) => error.into(),
            RunError::Batch(error) => error::InputError::new(error.to_string()).into(),
            RunError::Cancelled(cancelled) => cancelled.into(),
            RunError::Standstill(_) | RunError::Nodes(_) | RunError::Outlived(_) | RunError::Observer(_) => {
                output(error)
            }
        }
    }
}

impl Trouble {
    /// The exception that it is.
    pub fn raise(self, py: Python<'_>) -> PyErr {
        let raised = match self {
            Trouble::Input(error) => input_error(py, &error),
            Trouble::Stuck(stuck) => deadlock(py, &stuck),
            Trouble::Fault(fault) => cell_fault(py, &fault),
            Trouble::Output(message) => Ok(PyOSError::new_err(message)),
            Trouble::Cancelled => Ok(PyRuntimeError::new_err(Cancelled.to_string())),
        };
        raised.unwrap_or_else(|failed| failed)
    }
}

/// The exception of a mistake in what was passed.
pub fn wrong(py: Python<'_>, message: impl Into<String>) -> PyErr {
    Trouble::from(error::InputError::new(message)).raise(py)
}

fn input_error(py: Python<'_>, error: &error::InputError) -> PyResult<PyErr> {
    let raised = InputError::new_err(error.to_string());
    let value = raised.value(py);
    let (line, column) = match error.place.as_ref().and_then(|place| place.spot.as_ref()) {
        Some(Spot::Text { line, column, .. }) => (Some(*line), Some(*column)),
        _ => (None, None),
    };
    value.setattr("message", &error.message)?;
    value.setattr("help", &error.help)?;
    value.setattr("file", error.place.as_ref().map(|place| place.file.display().to_string()))?;
    value.setattr("line", line)?;
    value.setattr("column", column)?;
    Ok(raised)
}

fn deadlock(py: Python<'_>, stuck: &Stuck) -> PyResult<PyErr> {
    let mut text = stuck.kind.to_string();
    for wait in &stuck.waits {
        let _ = write!(text, "\n  {wait}");
    }
    let _ = write!(text, "\n  {}", stuck.help());
    let raised = Deadlock::new_err(text);
    let value = raised.value(py);
    let kind = if stuck.kind == StuckKind::Deadlock { "deadlock" } else { "starved" };
    let waits: Vec<_> = stuck.waits.iter().map(|wait| wait_of(py, wait)).collect::<PyResult<_>>()?;
    value.setattr("kind", kind)?;
    value.setattr("waits", PyList::new(py, waits)?)?;
    value.setattr("help", stuck.help())?;
    Ok(raised)
}

fn wait_of<'py>(py: Python<'py>, wait: &Wait) -> PyResult<Bound<'py, PyDict>> {
    let (what, channel, capacity) = match wait.for_what {
        WaitFor::Word { channel, capacity } => ("word", Some(channel.to_string()), Some(capacity.0)),
        WaitFor::Room { channel, capacity } => ("room", Some(channel.to_string()), Some(capacity.0)),
        WaitFor::Return { .. } => ("return", None, None),
        WaitFor::Nothing => ("nothing", None, None),
    };
    let told = PyDict::new(py);
    told.set_item("actor", wait.actor.to_string())?;
    told.set_item("on", wait.on.to_string())?;
    told.set_item("for", what)?;
    told.set_item("channel", channel)?;
    told.set_item("capacity", capacity)?;
    told.set_item("since", wait.since.0)?;
    told.set_item("op", format!("{:?}", wait.op))?;
    told.set_item("moved", wait.moved.0)?;
    told.set_item("ray", wait.job)?;
    told.set_item("position", wait.position)?;
    told.set_item("text", wait.to_string())?;
    Ok(told)
}

fn cell_fault(py: Python<'_>, fault: &Fault) -> PyResult<PyErr> {
    let raised = CellFault::new_err(fault.to_string());
    let value = raised.value(py);
    value.setattr("cell", fault.cell)?;
    value.setattr("ray", fault.message)?;
    value.setattr("address", fault.address)?;
    Ok(raised)
}
