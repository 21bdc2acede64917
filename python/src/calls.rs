//! The calls that make runs.

use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::Mutex;

use pcs_sim::error;
use pcs_sim::run::{CubeSetup, CubeSpec, FarmSetup, FarmSpec, Replay, RunSpec, Setup, Switch, Watching, moot};
use pcs_sim::seam::activity_trace::Form;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::doing::{Ops, render, time, trace};
use crate::made::Made;
use crate::outputs;
use crate::request::{Of, Request, cube_request, farm_request, replay_configuration};
use crate::run::Run;
use crate::trouble::wrong;
use crate::work::{Crew, Task, work};

/// Runs a scene's primary rays on the array.
///
/// Takes every parameter of the command, by the name of its flag with underscores (`pcs_sim.parameters()` lists them);
/// what is left out is as the command has it. `scene` is a built-in scene, a file or a `Scene`; `rays` a file or an array;
/// `machine` and `program` a file, a dict, or a `Machine` or `Program`. `config` is a run to be repeated, with changes:
/// a file of statistics, `Run.stats`, or a `Run`. `ops` names a file for what every cell did, for `replay`. `why` and `enough` add
/// to text, statistics, plots and page what the command's flags of these names do.
#[pyfunction]
#[pyo3(signature = (scene=None, *, config=None, ops=None, ops_form="units", why=false, enough=false, force=false, threads=None, progress=None, **parameters))]
// A keyword each.
#[expect(clippy::too_many_arguments)]
pub fn run(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, PyAny>>,
    ops: Option<PathBuf>,
    ops_form: &str,
    why: bool,
    enough: bool,
    force: bool,
    threads: Option<i64>,
    progress: Option<bool>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Run> {
    let (crew, ops) = (crew(py, threads, progress)?, self::ops(py, ops, ops_form, force)?);
    let request = Request::new(py, Of::Rays, scene, config, parameters)?;
    let made = work(py, crew, "rays", |task| {
        let (run, mut layers) = request.planned(RunSpec::of_rays, moot::check_run, &task.workers.cancel)?;
        let file = ops.as_ref().map(|ops| outputs::open(&ops.path, ops.force)).transpose()?;
        let setup = Setup::new(run, &mut layers, &task.workers.cancel)?;
        let (outcome, losses, file) = trace(&setup, &watching(why, enough), ops.as_ref().zip(file), task)?;
        file.map(outputs::finish).transpose()?;
        Ok(Made::Rays { setup, outcome: Box::new(outcome), losses })
    })?;
    Ok(Run::new(made, crew))
}

/// Makes a whole image: the host shades the hits and sends shadow, reflected and refracted rays.
///
/// Takes the parameters of `run`, but for `rays`, and those of light and host (`samples`, `depth`, `timing`, ...).
#[pyfunction]
#[pyo3(name = "image", signature = (scene=None, *, config=None, ops=None, ops_form="units", why=false, enough=false, force=false, threads=None, progress=None, **parameters))]
// A keyword each.
#[expect(clippy::too_many_arguments)]
pub fn image(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, PyAny>>,
    ops: Option<PathBuf>,
    ops_form: &str,
    why: bool,
    enough: bool,
    force: bool,
    threads: Option<i64>,
    progress: Option<bool>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Run> {
    let (crew, ops) = (crew(py, threads, progress)?, self::ops(py, ops, ops_form, force)?);
    let request = Request::new(py, Of::Image, scene, config, parameters)?;
    let made = work(py, crew, "samples", |task| {
        let (run, mut layers) = request.planned(RunSpec::of_image, moot::check_image, &task.workers.cancel)?;
        let untimed = run.spec.image.as_ref().is_some_and(|image| image.timing == Switch::Off);
        let asked = [("--ops", ops.is_some()), ("--why", why), ("--enough", enough)];
        if let Some((flag, _)) = asked.iter().find(|(_, asked)| *asked && untimed) {
            return Err(error::InputError::new(format!("{flag} {}", moot::WITHOUT_TIMING)).into());
        }
        let file = ops.as_ref().map(|ops| outputs::open(&ops.path, ops.force)).transpose()?;
        let setup = Setup::new(run, &mut layers, &task.workers.cancel)?;
        let (rendered, losses, hits, file) = render(&setup, &watching(why, enough), ops.as_ref().zip(file), task)?;
        file.map(outputs::finish).transpose()?;
        Ok(Made::Image { setup, rendered: Box::new(rendered), losses, hits })
    })?;
    Ok(Run::new(made, crew))
}

/// Times a recorded activity trace again, under any machine, without its scene.
///
/// `ops` is a file that `run(ops=...)` or the command's `--ops` wrote. Takes the parameters of the machine; `config` is a
/// replay to be repeated.
#[pyfunction]
#[pyo3(signature = (ops=None, *, config=None, why=false, enough=false, progress=None, **parameters))]
pub fn replay(
    py: Python<'_>,
    ops: Option<PathBuf>,
    config: Option<&Bound<'_, PyAny>>,
    why: bool,
    enough: bool,
    progress: Option<bool>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Run> {
    let crew = Crew { threads: None, progress };
    let base = config.map(|config| replay_configuration(py, config)).transpose()?;
    if ops.is_none() && base.is_none() {
        return Err(wrong(py, "a replay needs a trace: ops, or config"));
    }
    let Request { options, base: machine, .. } = Request::new(py, Of::Replay, None, None, parameters)?;
    let made = work(py, crew, "rays", |task| {
        moot::check_replay(&options)?;
        let machine = machine.map(|base| base.machine);
        let mut replay = Replay::new(ops.as_deref(), &options, base.as_ref(), machine)?;
        let (stats, losses, observed) = time(&mut replay, &watching(why, enough), task)?;
        Ok(Made::Replay { replay: Mutex::new(replay), stats, losses, observed: Box::new(observed) })
    })?;
    Ok(Run::new(made, crew))
}

/// Runs a farm: a master and workers that share an image, on CAPITAN.
///
/// Takes the parameters of farms, by the names of the flags of `pcs-sim farm`; `tasks` is a number of workers (`sweep` makes
/// tables of many). `config` is a farm to be repeated. `why` adds the critical path to what is seen and saved.
#[pyfunction]
#[pyo3(signature = (scene=None, *, config=None, why=false, threads=None, progress=None, **parameters))]
pub fn farm(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, PyAny>>,
    why: bool,
    threads: Option<i64>,
    progress: Option<bool>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Run> {
    let crew = crew(py, threads, progress)?;
    let (options, base) = farm_request(py, scene, config, parameters)?;
    let made = work(py, crew, "samples", |task| {
        let spec = FarmSpec::new(&options, base)?;
        moot::check_farm(&options, &spec)?;
        if options.farm.tasks.is_some_and(|range| range.first < range.last) {
            let error = error::InputError::new("statistics and views are of one number of workers, not of a range");
            return Err(error.help("ask for one number of tasks; a sweep makes tables of many").into());
        }
        let told = samples(task, spec.samples());
        let setup = FarmSetup::new(spec, &task.workers, told)?;
        let outcome = setup.run(setup.spec.tasks, &watching(why, false), &task.workers.cancel)?;
        Ok(Made::Farm { setup: Box::new(setup), outcome: Box::new(outcome) })
    })?;
    Ok(Run::new(made, crew))
}

/// Makes an image on the nodes of an iPSC/2, a hypercube.
///
/// Takes the parameters by the names of the flags of `pcs-sim ipsc2`. `config` is an image to be made again. `why` adds the critical
/// path to what is seen and saved.
#[pyfunction]
#[pyo3(signature = (scene=None, *, config=None, why=false, threads=None, progress=None, **parameters))]
pub fn ipsc2(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, PyAny>>,
    why: bool,
    threads: Option<i64>,
    progress: Option<bool>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Run> {
    let crew = crew(py, threads, progress)?;
    let (options, base) = cube_request(py, scene, config, parameters)?;
    let made = work(py, crew, "samples", |task| {
        let spec = CubeSpec::new(&options, base)?;
        moot::check_cube(&options, &spec)?;
        let told = samples(task, spec.samples());
        let setup = CubeSetup::new(spec, false, &task.workers, told)?;
        let outcome = setup.run(&watching(why, false), &task.workers.cancel)?;
        Ok(Made::Cube { setup: Box::new(setup), outcome: Box::new(outcome) })
    })?;
    Ok(Run::new(made, crew))
}

/// Tells the bar how many of an image's samples are traced.
pub fn samples(task: &Task, all: usize) -> impl FnMut(usize) -> Result<(), Infallible> {
    move |done| {
        task.set(done as u64, all as u64);
        Ok(())
    }
}

/// What is watched of a run as it is made.
pub fn watching(why: bool, enough: bool) -> Watching {
    Watching { path: why, enough, ..Watching::default() }
}

/// The threads and the bar that are asked for.
pub fn crew(py: Python<'_>, threads: Option<i64>, progress: Option<bool>) -> PyResult<Crew> {
    let fit = |threads: i64| {
        let message = format!("threads is {threads}, it must be from 1 to {}", u16::MAX);
        u16::try_from(threads).ok().filter(|&threads| threads > 0).ok_or_else(|| wrong(py, message))
    };
    Ok(Crew { threads: threads.map(fit).transpose()?, progress })
}

fn ops(py: Python<'_>, path: Option<PathBuf>, form: &str, force: bool) -> PyResult<Option<Ops>> {
    let form = match form {
        "units" => Form::Units,
        "priced" => Form::Cycles,
        _ => return Err(wrong(py, format!("invalid value '{form}' for ops_form: expected one of units, priced"))),
    };
    Ok(path.map(|path| Ops { path, form, force }))
}
