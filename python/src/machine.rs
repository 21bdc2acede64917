//! Machines and array programs as values.

use std::path::PathBuf;

use pcs_sim::error;
use pcs_sim::machine::MachineFile;
use pcs_sim::program::ArrayProgram;
use pcs_sim::run::{RunOptions, array_program, machine_file};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::request::{Of, Request, is_path, json};
use crate::trouble::{Trouble, wrong};

/// A machine: PCS, that of a file or of a dict, with changes.
///
/// The changes are the machine's parameters, by the names of the command's flags. `to_dict()` is what a machine file has.
#[pyclass(frozen, eq, module = "pcs_sim")]
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    file: MachineFile,
}

/// An array program: a standard one by name, that of a file or of a dict.
#[pyclass(frozen, eq, module = "pcs_sim")]
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    program: ArrayProgram,
}

impl From<MachineFile> for Machine {
    fn from(file: MachineFile) -> Machine {
        Machine { file }
    }
}

impl Machine {
    /// The machine that a value is: one of these, or a dict.
    pub fn of(py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<MachineFile> {
        if let Ok(machine) = value.cast::<Machine>() {
            return Ok(machine.get().file.clone());
        }
        let file: MachineFile = described(py, json(py, value)?, "machine")?;
        file.build().map_err(|error| Trouble::from(error).raise(py))?;
        Ok(file)
    }
}

impl Program {
    /// The program that a value is: one of these, or a dict.
    pub fn of(py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<ArrayProgram> {
        if let Ok(program) = value.cast::<Program>() {
            return Ok(program.get().program.clone());
        }
        let program: ArrayProgram = described(py, json(py, value)?, "array program")?;
        program.check().map_err(|error| Trouble::from(error).raise(py))?;
        Ok(program)
    }
}

fn described<T: serde::de::DeserializeOwned>(py: Python<'_>, value: Value, what: &str) -> PyResult<T> {
    serde_json::from_value(value).map_err(|error| wrong(py, format!("describes no {what}: {error}")))
}

/// What a value has in a file, as a dict.
fn to_dict<'py>(py: Python<'py>, value: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| wrong(py, error.to_string()))?;
    py.import("json")?.getattr("loads")?.call1((text,))
}

#[pymethods]
impl Machine {
    #[new]
    #[pyo3(signature = (machine=None, **changes))]
    fn new(
        py: Python<'_>,
        machine: Option<&Bound<'_, PyAny>>,
        changes: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Machine> {
        let given = PyDict::new(py);
        given.set_item("machine", machine)?;
        if let Some(changes) = changes {
            given.update(changes.as_mapping())?;
        }
        let Request { options, base, .. } = Request::new(py, Of::Replay, None, None, Some(&given))?;
        let file = machine_file(&options, base.as_ref().map(|base| &base.machine));
        let built = file.and_then(|file: MachineFile| file.build().map(|_| Machine { file }));
        built.map_err(|error| Trouble::from(error).raise(py))
    }

    /// What the machine's file has.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_dict(py, &self.file)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("pcs_sim.Machine({})", self.to_dict(py)?.repr()?))
    }
}

#[pymethods]
impl Program {
    #[new]
    fn new(py: Python<'_>, program: &Bound<'_, PyAny>) -> PyResult<Program> {
        if !is_path(program) {
            return Ok(Program { program: Program::of(py, program)? });
        }
        let mut options = RunOptions::default();
        options.program.program = Some(program.extract::<PathBuf>()?);
        let read: Result<ArrayProgram, error::InputError> = array_program(&options, None);
        Ok(Program { program: read.map_err(|error| Trouble::from(error).raise(py))? })
    }

    /// What the program's file has.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_dict(py, &self.program)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("pcs_sim.Program({})", self.to_dict(py)?.repr()?))
    }
}
