//! The cost model.

use std::convert::Infallible;
use std::path::PathBuf;

use pcs_sim::report::prediction::{self, Row};
use pcs_sim::report::summary::prose;
use pcs_sim::report::{account, bottleneck};
use pcs_sim::run::{self, Layers, PlannedRun, RunSpec, Shuffled, moot};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::calls::crew;
use crate::outputs;
use crate::request::{Of, Request};
use crate::table::{Table, number, text};
use crate::trouble::{Trouble, output, wrong};
use crate::work::{Task, briefly, work};

/// What the cost model says of a run, and whether it is right.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct Model {
    rows: Vec<Row>,
    text: String,
    json: String,
    notes: Vec<String>,
}

/// Predicts a run by the paper's cost model, and holds the prediction against the run.
///
/// Takes the parameters of `run`, but for those of cells that run programs. With `predict_only` nothing is simulated:
/// seconds where the simulation may take minutes.
#[pyfunction]
#[pyo3(signature = (scene=None, *, config=None, predict_only=false, threads=None, progress=None, **parameters))]
pub fn model(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, PyAny>>,
    predict_only: bool,
    threads: Option<i64>,
    progress: Option<bool>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Model> {
    if predict_only && threads.is_some() {
        return Err(wrong(py, format!("--threads {}", moot::WITHOUT_RUN)));
    }
    let request = Request::new(py, Of::Model, scene, config, parameters)?;
    work(py, crew(py, threads, progress)?, "rays", |task| {
        let check = |options: &_, spec: &_| moot::check_model(options, spec, predict_only);
        let (run, layers) = request.planned(RunSpec::of_model, check, &task.workers.cancel)?;
        predict(&run, layers, predict_only, task)
    })
}

fn predict(run: &PlannedRun, mut layers: Layers, predict_only: bool, task: &Task) -> Result<Model, Trouble> {
    let workers = &task.workers;
    layers.load(run, &workers.cancel)?;
    let forecast = layers.forecast(run, &workers.cancel)?;
    let scene = layers.scene(run)?;
    let outcome = match predict_only {
        true => None,
        false => {
            let (workload, prepared) = (layers.workload(run, &workers.cancel)?, layers.prepared(run)?);
            task.set(0, prepared.rays.len() as u64);
            let mut shuffled = Shuffled::new(workload.cells());
            let outcome = run::run(&workload, &run.machine.spec, &prepared.rays, workers, |batch| {
                task.add(batch.hits.len() as u64);
                shuffled.take(&batch.ops);
                Ok::<_, Infallible>(())
            })?;
            let spec = &run.machine.spec;
            let timed = || shuffled.time(spec, workload.costs(), &workers.cancel);
            let losses = bottleneck::losses(&outcome.stats, timed);
            Some((workload, outcome, losses))
        }
    };
    let measured = outcome.as_ref().map(|(workload, outcome, _)| prediction::Run {
        workload,
        counts: &outcome.counts,
        stats: &outcome.stats,
    });
    let rows = prediction::rows(&forecast, measured);
    let mut text = account::model_text((&scene, &run.spec, &run.machine), &forecast, &rows);
    if let Some((_, outcome, losses)) = &outcome {
        let verdict = account::verdict(&outcome.stats, losses.as_ref(), run.machine.spec.clock());
        text.push_str(&prose(&format!("Measured: {verdict}\n")));
    }
    let json = prediction::to_json((&scene.name, &run.spec), &rows, &forecast).map_err(output)?;
    let notes = run.machine.notes.iter().chain(&scene.notes).cloned().collect();
    Ok(Model { rows, text, json, notes })
}

#[pymethods]
impl Model {
    /// The quantities, a row each: by the `paper`'s formulas, by the `model`, as `counted` and as `measured`.
    #[getter]
    fn quantities(&self) -> PyResult<Table> {
        let rows = || self.rows.iter();
        Table::new(vec![
            text("quantity", rows().map(|row| row.quantity.clone())),
            number("paper", rows().map(|row| row.paper)),
            number("model", rows().map(|row| Some(row.model))),
            number("counted", rows().map(|row| row.counted)),
            number("measured", rows().map(|row| row.measured)),
            number("error", rows().map(Row::error)),
        ])
    }

    /// What `pcs-sim model --stats` writes.
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.getattr("loads")?.call1((&self.json,))
    }

    /// What the user should know: what had to be rounded, cut or assumed.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Writes the statistics.
    #[pyo3(signature = (stats, *, force=false))]
    fn save(&self, py: Python<'_>, stats: PathBuf, force: bool) -> PyResult<()> {
        let bytes = self.json.as_bytes();
        briefly(py, |_| outputs::write(&stats, force, |file| std::io::Write::write_all(file, bytes)).map(drop))
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        let title = self.text.lines().next().unwrap_or_default();
        format!("<pcs_sim.Model: {title}>")
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        py.import("pcs_sim._helpers")?.getattr("html_text")?.call1((&self.text,))?.extract()
    }
}
