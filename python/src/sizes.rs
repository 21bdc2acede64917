//! The fewest words that FIFOs need.

use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::report::sizing::{self, SizesTable};
use pcs_sim::report::{account, table};
use pcs_sim::run::{self, Front, KeptOps, Point, Replay, RunSpec, Searching, moot};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::machine::Machine;
use crate::outputs;
use crate::request::{Of, Request};
use crate::table::Table;
use crate::trouble::{Trouble, output, wrong};
use crate::view::Picture;
use crate::work::{Crew, Task, briefly, work};

/// The fewest words that the FIFOs of a run need for each speed.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct Sizes {
    title: String,
    front: Front,
    machine: pcs_sim::machine::Machine,
    file: pcs_sim::machine::MachineFile,
}

/// Finds the fewest words that the FIFOs of a run, or of a recorded trace, need for some speeds.
///
/// Takes the parameters of `run`, but for the FIFOs' depths; or `ops`, a recorded trace, and parameters of the machine. `speed` is a
/// percentage of the speed with unlimited FIFOs, or several (100, 99.9, 99, 95 and 90).
#[pyfunction]
#[pyo3(signature = (scene=None, *, ops=None, config=None, speed=None, progress=None, **parameters))]
pub fn size_fifos(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    ops: Option<PathBuf>,
    config: Option<&Bound<'_, PyAny>>,
    speed: Option<&Bound<'_, PyAny>>,
    progress: Option<bool>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Sizes> {
    let speed: Vec<f64> = match speed {
        None => Vec::new(),
        Some(one) => one
            .extract()
            .map(|one| vec![one])
            .or_else(|_| one.extract())
            .map_err(|_| wrong(py, "speed: expected a number, or a list of them"))?,
    };
    let speeds = run::slower(&speed).map_err(|error| Trouble::from(error).raise(py))?;
    if ops.is_some() && config.is_some() {
        return Err(wrong(py, "ops and config cannot both be given"));
    }
    let request = Request::new(py, Of::Rays, scene, config, parameters)?;
    work(py, Crew { threads: None, progress }, "machines", |task| {
        moot::check_size_fifos(&request.options)?;
        let (title, kept) = match ops {
            Some(ops) => of_trace(&ops, request, task)?,
            None => of_run(request, task)?,
        };
        let note = |searching: Searching| task.set(searching.points as u64, speeds.len() as u64);
        let front = run::size_fifos(kept.recorded(), &speeds, &task.workers.cancel, note)?;
        Ok(Sizes { title, front, machine: kept.machine, file: kept.file })
    })
}

/// The ops of a run, and what it is called.
fn of_run(request: Request, task: &Task) -> Result<(String, KeptOps), Trouble> {
    let cancel = &task.workers.cancel;
    let (run, mut layers) = request.planned(RunSpec::of_sizing, moot::check_run, cancel)?;
    let traced = layers.traced(&run, &task.workers)?;
    let (scene, prepared) = (layers.scene(&run)?, layers.prepared(&run)?);
    let title = account::run_title(&run.spec, &scene, traced.workload(), prepared.rays.len());
    Ok((title, KeptOps::of_run(run, traced)))
}

/// The same of a recorded trace.
fn of_trace(ops: &Path, request: Request, task: &Task) -> Result<(String, KeptOps), Trouble> {
    moot::check_size_fifos_of_trace(&request.options)?;
    let replay = Replay::new(Some(ops), &request.options, None, request.base.map(|base| base.machine))?;
    Ok((account::sized_trace_title(&replay), KeptOps::of_trace(replay, &task.workers.cancel)?))
}

impl Sizes {
    fn with_table<T>(&self, use_it: impl FnOnce(&SizesTable, &table::Table<'_>) -> T) -> T {
        let sizes = SizesTable::new(&self.front, self.machine.spec.clock());
        let (columns, rows) = (sizes.columns(), sizes.rows());
        use_it(&sizes, &table::Table { columns: &columns, rows })
    }

    fn pictures(&self) -> Result<Vec<pcs_sim::report::plot::Picture>, Trouble> {
        let heading = sizing::heading(&self.title);
        self.with_table(|sizes, _| sizes.pictures(&heading)).map(Vec::from).map_err(output)
    }

    fn point(&self, py: Python<'_>, speed: f64) -> PyResult<&Point> {
        let of = |slower: &[u64]| self.front.points.iter().find(|point| slower.contains(&point.slower));
        let slower = run::slower(&[speed]).map_err(|error| Trouble::from(error).raise(py))?;
        of(&slower).ok_or_else(|| {
            let found: Vec<String> = self.front.points.iter().map(|point| sizing::name(point.slower)).collect();
            wrong(py, format!("no machine was sought for {speed} % of the speed, but for {}", found.join(", ")))
        })
    }
}

#[pymethods]
impl Sizes {
    /// What was found, as the command writes it: a row for the unlimited depths, for each speed, for each of its FIFOs with a word
    /// fewer, and for the least machine.
    #[getter]
    fn table(&self) -> PyResult<Table> {
        self.with_table(|_, table| Table::of_cells(table))
    }

    /// How often the recording was timed.
    #[getter]
    fn replays(&self) -> u64 {
        self.front.replays
    }

    /// The depths of the FIFOs for a speed, by their names.
    fn words<'py>(&self, py: Python<'py>, speed: f64) -> PyResult<Bound<'py, PyDict>> {
        let words = PyDict::new(py);
        for (fifo, depth) in self.front.fifos.iter().zip(&self.point(py, speed)?.depths.words) {
            words.set_item(fifo.to_string(), depth.0)?;
        }
        Ok(words)
    }

    /// The machine for a speed.
    fn machine(&self, py: Python<'_>, speed: f64) -> PyResult<Machine> {
        Ok(Machine::from(self.front.machine(&self.point(py, speed)?.depths.words, &self.file)))
    }

    /// Pictures: `front`, the speed over the words of all FIFOs, and `depths`, that of each FIFO for each speed.
    fn plots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let pictures = PyDict::new(py);
        for picture in briefly(py, |_| self.pictures())? {
            let name = picture.name.clone();
            pictures.set_item(name, Py::new(py, Picture { picture })?)?;
        }
        Ok(pictures)
    }

    /// Writes the table, as CSV and as Parquet, and beside it the pictures and the machine of each speed, as the command does.
    /// Gives the files that it wrote.
    #[pyo3(signature = (table, *, plot=false, machines=false, force=false))]
    fn save(&self, py: Python<'_>, table: PathBuf, plot: bool, machines: bool, force: bool) -> PyResult<Vec<PathBuf>> {
        let stem = table.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let beside = |ending: String| table.with_file_name(format!("{stem}-{ending}"));
        if !table.extension().is_some_and(|ending| ending == "csv" || ending == "parquet") {
            let error = InputError::in_file(&table, "a table's name must end in .csv or .parquet");
            return Err(Trouble::from(error.help("it is written as both, side by side")).raise(py));
        }
        briefly(py, |_| {
            let mut written = self.with_table(|_, all| {
                let csv = outputs::write(&table.with_extension("csv"), force, |file| table::write_csv(file, all))?;
                let parquet = outputs::write(&table.with_extension("parquet"), force, |file| {
                    table::write_parquet(file, all, &[])
                })?;
                Ok::<_, Trouble>(vec![csv, parquet])
            })?;
            for picture in if plot { self.pictures()? } else { Vec::new() } {
                for (ending, bytes) in [("svg", picture.rendered.svg.as_bytes()), ("png", &picture.rendered.png)] {
                    let path = beside(format!("{}.{ending}", picture.name));
                    written.push(outputs::write(&path, force, |file| file.write_all(bytes))?);
                }
            }
            for point in self.front.points.iter().filter(|_| machines) {
                let text = sizing::machine_text(&self.front, point, &self.title, &self.file).map_err(output)?;
                let path = beside(format!("{}.ron", sizing::name(point.slower)));
                written.push(outputs::write(&path, force, |file| file.write_all(text.as_bytes()))?);
            }
            Ok(written)
        })
    }

    fn __str__(&self) -> String {
        sizing::text(&self.front, &self.title, &self.machine)
    }

    fn __repr__(&self) -> String {
        format!("<pcs_sim.Sizes: FIFOs of {}>", self.title)
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let pictures = briefly(py, |_| self.pictures())?;
        let front = pictures.into_iter().next().map(|picture| picture.rendered.svg);
        py.import("pcs_sim._helpers")?.getattr("html_text")?.call1((self.__str__(), front))?.extract()
    }
}
