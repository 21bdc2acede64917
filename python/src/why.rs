//! Why a run took as long as it did.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Mutex;

use pcs_sim::error::InputError;
use pcs_sim::measure::{Actor, At, Clock, CriticalPath, Doing, Observed, What, When};
use pcs_sim::quantities::Cycles;
use pcs_sim::report::{account, moment, why as report};
use pcs_sim::run::{Replay, RunSpec, Setup, Watching, moot};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt};

use crate::calls::crew;
use crate::doing::{time, trace};
use crate::made::{Made, has_none};
use crate::request::{Of, Request};
use crate::run::Run;
use crate::table::{Table, number, text, truth, whole};
use crate::trouble::{Trouble, wrong};
use crate::work::work;

/// Why a run took as long as it did: its critical path, or what happened in one moment of it.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct Why {
    run: Py<Run>,
    by_cell: bool,
    /// Whose moment it is, if it is one.
    actor: Option<Actor>,
    text: String,
}

/// Finds out why a run, or a recorded trace, took as long as it did.
///
/// Takes the parameters of `run`; or `ops`, a recorded trace to be timed again, and those of the machine. `by_cell` tells the
/// times of each cell by themselves. With `cell` (a number, or "host") it is about one moment, and who then waits for whom: `at` a
/// cycle or a time as "12.3ms", or in the middle of the longest wait of the cell while it is at a `ray`.
#[pyfunction]
#[pyo3(signature = (scene=None, *, ops=None, config=None, by_cell=false, cell=None, at=None, ray=None, enough=false, threads=None, progress=None, **parameters))]
// A keyword each.
#[expect(clippy::too_many_arguments)]
pub fn why(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    ops: Option<PathBuf>,
    config: Option<&Bound<'_, PyAny>>,
    by_cell: bool,
    cell: Option<&Bound<'_, PyAny>>,
    at: Option<&Bound<'_, PyAny>>,
    ray: Option<u32>,
    enough: bool,
    threads: Option<i64>,
    progress: Option<bool>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Why> {
    let raise = |error: InputError| Trouble::from(error).raise(py);
    let actor = cell.map(|cell| said::<Actor>(py, "cell", cell)).transpose()?;
    let moment = match (actor, at, ray) {
        (None, None, None) => None,
        (Some(actor), Some(at), None) if !by_cell && !enough => Some((actor, Moment::At(said(py, "at", at)?))),
        (Some(Actor::Station(cell)), None, Some(ray)) if !by_cell && !enough => {
            Some((Actor::Station(cell), Moment::Ray(When::Job { station: cell, job: ray })))
        }
        _ => {
            let error = InputError::new("a moment is said by cell and either at or ray, and by nothing else");
            return Err(raise(
                error.help("the times of all cells tells by_cell; a ray is looked for in a cell, not in the host"),
            ));
        }
    };
    let crew = crew(py, threads, progress)?;
    let watching = |clock: Clock| Watching {
        path: true,
        enough,
        moment: moment.as_ref().map(|(_, moment)| moment.when(clock)),
        ..Watching::default()
    };
    let given = [("scene", scene.is_some()), ("config", config.is_some()), ("threads", threads.is_some())];
    if let Some((name, _)) = given.iter().find(|(_, given)| *given && ops.is_some()) {
        let error = InputError::new(format!("{name} {}", moot::WITHOUT_SCENE));
        return Err(raise(error.help("leave out one of the two")));
    }
    let request = Request::new(py, Of::Rays, scene, config, parameters)?;
    let made = work(py, crew, "rays", |task| match ops {
        Some(ops) => {
            moot::check_why(&request.options)?;
            moot::check_replay(&request.options)?;
            let machine = request.base.map(|base| base.machine);
            let mut replay = Replay::new(Some(&ops), &request.options, None, machine)?;
            let clock = replay.machine.spec.clock();
            let (stats, losses, observed) = time(&mut replay, &watching(clock), task)?;
            Ok(Made::Replay { replay: Mutex::new(replay), stats, losses, observed: Box::new(observed) })
        }
        None => {
            let cancel = &task.workers.cancel;
            let (run, mut layers) = request.planned(RunSpec::of_rays, moot::check_run, cancel)?;
            let setup = Setup::new(run, &mut layers, cancel)?;
            let (outcome, losses, _) = trace(&setup, &watching(setup.machine.spec.clock()), None, task)?;
            Ok(Made::Rays { setup, outcome: Box::new(outcome), losses })
        }
    })?;
    let (head, stats, clock) = (made.head()?, made.measured()?, made.clock());
    let observed = made.observed().ok_or_else(|| has_none("a farm", "critical path"))?;
    let text = match &moment {
        Some((actor, _)) => account::moment_text(&head, stats, (observed, clock), *actor).map_err(raise)?,
        None => account::why_text(&head, stats, observed, by_cell),
    };
    Ok(Why { run: Py::new(py, Run::new(made, crew))?, by_cell, actor: moment.map(|(actor, _)| actor), text })
}

/// Which moment.
enum Moment {
    At(At),
    Ray(When),
}

impl Moment {
    fn when(&self, clock: Clock) -> When {
        match *self {
            Moment::At(at) => When::Cycle(at.cycle(clock)),
            Moment::Ray(when) => when,
        }
    }
}

/// A value that the command takes as text, or a number of it.
fn said<T: FromStr<Err = String>>(py: Python<'_>, name: &str, value: &Bound<'_, PyAny>) -> PyResult<T> {
    let text = if value.is_instance_of::<PyInt>() { value.str()?.extract() } else { value.extract::<String>() };
    let text = text.unwrap_or_else(|_| value.to_string());
    text.parse().map_err(|error| wrong(py, format!("invalid value '{text}' for {name}: {error}")))
}

impl Why {
    fn observed(&self) -> PyResult<&Observed> {
        self.run.get().made().observed().ok_or_else(|| has_none("this run", "critical path"))
    }

    fn path(&self) -> PyResult<&CriticalPath> {
        self.observed()?.path.as_ref().ok_or_else(|| has_none("this run", "critical path"))
    }
}

#[pymethods]
impl Why {
    /// The run: its statistics, plots and page have the critical path, too.
    #[getter]
    fn run(&self, py: Python<'_>) -> Py<Run> {
        self.run.clone_ref(py)
    }

    /// The length of the run and of the path, in cycles.
    #[getter]
    fn cycles(&self) -> PyResult<u64> {
        Ok(self.path()?.cycles.0)
    }

    /// What the path is made of, for the most part.
    #[getter]
    fn sentence(&self) -> PyResult<String> {
        Ok(report::sentence(self.path()?))
    }

    /// The machine's times on the path, the longest first: the `time`, the cell that it is `at` (with `by_cell`), `count` (how
    /// often it lies there, so by how many cycles the run gets shorter if it does by one), `each` in cycles, `cycles` of
    /// all, and whether it `varies` from machine to machine.
    #[getter]
    fn times(&self) -> PyResult<Table> {
        let times = report::times(self.path()?, self.by_cell);
        let all = || times.iter();
        Table::new(vec![
            text("time", all().map(|time| time.name.clone())),
            text("at", all().map(|time| time.at.map(|at| at.to_string()).unwrap_or_default())),
            whole("count", all().map(|time| time.count)),
            whole("each", all().map(|time| time.each.0)),
            whole("cycles", all().map(|time| time.cycles.0)),
            truth("varies", all().map(|time| time.varies).collect()),
        ])
    }

    /// The parts of the path by place and cause: who it is `at`, the `cause`, the `fifo` if it is about one, `count`, `cycles`,
    /// and the `share` of the run. The cycles sum to the run.
    #[getter]
    fn parts(&self) -> PyResult<Table> {
        let path = self.path()?;
        let parts = path.parts();
        let all = || parts.iter();
        let share = |cycles: Cycles| if path.cycles.0 == 0 { 0.0 } else { cycles.0 as f64 / path.cycles.0 as f64 };
        Table::new(vec![
            text("at", all().map(|part| part.at.to_string())),
            text("cause", all().map(|part| report::name(path, part.cause))),
            text("fifo", all().map(|part| report::fifo_of(path, part.cause).unwrap_or_default().to_owned())),
            whole("count", all().map(|part| part.count)),
            whole("cycles", all().map(|part| part.cycles.0)),
            number("share", all().map(|part| Some(share(part.cycles)))),
        ])
    }

    /// Who waits for whom in the moment that was asked for, from the one that was named down to one that does not wait: a dict
    /// each, of the `actor`, what it does (`works`, `moves`, `waits`, `done`), the `fifo` that it waits at, the `ray`, `since` which cycle and
    /// `until` before which, and all of it as `text`. None if no moment was asked for.
    #[getter]
    fn waits<'py>(&self, py: Python<'py>) -> PyResult<Option<Vec<Bound<'py, PyDict>>>> {
        let Some(actor) = self.actor else { return Ok(None) };
        let (path, observed) = (self.path()?, self.observed()?);
        let Some(snapshot) = &observed.snapshot else { return Ok(None) };
        let links = moment::links(path, snapshot, actor);
        links
            .into_iter()
            .map(|(actor, doing)| link(py, path, (actor, doing), snapshot.at))
            .collect::<PyResult<_>>()
            .map(Some)
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!("<pcs_sim.Why: {}>", self.sentence()?))
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        py.import("pcs_sim._helpers")?.getattr("html_text")?.call1((&self.text,))?.extract()
    }
}

fn link<'py>(
    py: Python<'py>,
    path: &CriticalPath,
    (actor, doing): (Actor, Doing),
    at: Cycles,
) -> PyResult<Bound<'py, PyDict>> {
    let (does, fifo) = match doing.what {
        What::Works { .. } => ("works", None),
        What::Moves { .. } => ("moves", None),
        What::WaitsForWord { fifo, .. } => ("waits", fifo),
        What::WaitsForSlot { fifo } | What::WaitsForWire { fifo } => ("waits", Some(fifo)),
        What::WaitsForAnswer { .. } => ("waits", None),
        What::Done => ("done", None),
    };
    let told = PyDict::new(py);
    told.set_item("actor", actor.to_string())?;
    told.set_item("does", does)?;
    told.set_item("fifo", fifo.map(|fifo| path.topology.fifos[fifo].name.clone()))?;
    told.set_item("ray", doing.job)?;
    told.set_item("since", doing.since.0)?;
    told.set_item("until", doing.until.0)?;
    told.set_item("text", moment::line(path, actor, &doing, at))?;
    Ok(told)
}
