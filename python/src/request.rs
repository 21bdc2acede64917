//! What is asked of a run, from Python's keywords.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pcs_sim::cancel::Cancel;
use pcs_sim::error;
use pcs_sim::geometry::Ray;
use pcs_sim::machine::MachineOptions;
use pcs_sim::parameters::{Kind, ParameterInfo, named};
use pcs_sim::run::{
    CellsOptions, CubeRunOptions, CubeSpec, FarmRunOptions, FarmSpec, Layers, MachineFileOptions, PlannedRun,
    RayOptions, ReplaySpec, RunOptions, RunSpec, moot,
};
use pcs_sim::scene::{Scene as SceneData, builtin};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PySequence, PyString};

use crate::arrays::{self, Scene};
use crate::machine::{Machine, Program};
use crate::run::Run;
use crate::table::{Table, text, truth, whole};
use crate::trouble::{Trouble, wrong};

/// What the parameters are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// A run of primary rays.
    Rays,
    /// A whole image.
    Image,
    /// A prediction.
    Model,
    /// A replay.
    Replay,
    /// A farm.
    Farm,
    /// An image on a hypercube.
    Cube,
}

impl Of {
    /// What the call is named, and the command.
    fn name(self) -> &'static str {
        match self {
            Of::Rays => "run",
            Of::Image => "image",
            Of::Model => "model",
            Of::Replay => "replay",
            Of::Farm => "farm",
            Of::Cube => "ipsc2",
        }
    }

    /// The parameters that are known, those among them that the call always refuses: it then says why.
    fn parameters(self) -> Vec<&'static ParameterInfo> {
        let without = |group: &'static [ParameterInfo]| {
            RunOptions::parameters().filter(move |known| group.iter().all(|other| other.name != known.name))
        };
        match self {
            Of::Rays => RunOptions::parameters().collect(),
            Of::Image => without(RayOptions::PARAMETERS).chain(RunOptions::image_parameters()).collect(),
            Of::Model => without(CellsOptions::PARAMETERS).collect(),
            Of::Farm => FarmRunOptions::parameters().collect(),
            Of::Cube => CubeRunOptions::parameters().collect(),
            Of::Replay => MachineFileOptions::PARAMETERS.iter().chain(MachineOptions::PARAMETERS).collect(),
        }
    }
}

/// What is asked of a run.
#[derive(Debug, Default)]
pub struct Request {
    /// By name.
    pub options: RunOptions,
    /// What they are laid over.
    pub base: Option<RunSpec>,
    scene: Option<Arc<SceneData>>,
    rays: Option<Vec<Ray>>,
    has_program: bool,
}

impl Request {
    /// Takes the keywords of a call. Those that are None are not given.
    pub fn new(
        py: Python<'_>,
        of: Of,
        scene: Option<&Bound<'_, PyAny>>,
        config: Option<&Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Request> {
        let base = config.map(|config| configuration(py, config)).transpose()?;
        let mut request = Request { base, ..Request::default() };
        if let Some(scene) = scene {
            request.take(py, of, "scene", scene)?;
        }
        for (name, value) in parameters.into_iter().flatten() {
            request.take(py, of, &name.extract::<String>()?, &value)?;
        }
        Ok(request)
    }

    fn take(&mut self, py: Python<'_>, of: Of, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let known = named(of.parameters(), name).map_err(|error| Trouble::from(error).raise(py))?;
        if value.is_none() || self.take_object(py, name, value)? {
            return Ok(());
        }
        let text = text_of(py, known, value)?;
        self.options.set(name, &text).map_err(|error| Trouble::from(error).raise(py))
    }

    /// Takes what is no text: a scene or rays at hand, a machine or a program. False if it is none of these.
    fn take_object(&mut self, py: Python<'_>, name: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
        match name {
            "scene" => {
                let Ok(scene) = value.cast::<Scene>() else { return Ok(false) };
                let data = scene.get().data.clone();
                self.options.scene.scene = Some(format!("{} (arrays)", data.name));
                self.scene = Some(data);
            }
            "rays" if !is_path(value) => {
                let rays = arrays::rays(py, value)?;
                self.options.rays.rays = Some(PathBuf::from(format!("(array of {} rays)", rays.len())));
                self.rays = Some(rays);
            }
            "machine" if !is_path(value) => self.base_mut(py)?.machine = Machine::of(py, value)?,
            "program" if !is_path(value) => {
                self.base_mut(py)?.program = Program::of(py, value)?;
                self.has_program = true;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn base_mut(&mut self, py: Python<'_>) -> PyResult<&mut RunSpec> {
        let standard = || RunSpec::new(&RunOptions::default(), None).map_err(|error| Trouble::from(error).raise(py));
        let base = self.base.take().map_or_else(standard, Ok)?;
        Ok(self.base.insert(base))
    }

    /// The run that is asked for, and the layers of it that are at hand.
    pub fn planned(
        self,
        spec: impl FnOnce(&RunOptions, Option<RunSpec>) -> Result<RunSpec, error::InputError>,
        check: impl FnOnce(&RunOptions, &RunSpec) -> Result<(), error::InputError>,
        cancel: &Cancel,
    ) -> Result<(PlannedRun, Layers), Trouble> {
        let Request { options, base, scene, rays, has_program } = self;
        if has_program && options.has("mode") {
            return Err(error::InputError::new("mode and program cannot both be given").into());
        }
        let run = PlannedRun::new(spec(&options, base)?)?;
        check(&options, &run.spec)?;
        let mut layers = Layers::default();
        if let Some(scene) = scene {
            if let Some(name) = ["size_factor", "resolution"].into_iter().find(|name| options.has(name)) {
                let message = format!("{name} is for scenes that are named, not for one of arrays");
                return Err(error::InputError::new(message).help("leave it out").into());
            }
            layers.give_scene(&run, scene);
        }
        if let Some(rays) = rays {
            layers.load_scene(&run, cancel)?;
            layers.give_rays(&run, rays)?;
        }
        Ok((run, layers))
    }
}

/// What a configuration describes: a file, a dict as `Run.stats` or its `configuration`, or a run itself.
fn configuration(py: Python<'_>, config: &Bound<'_, PyAny>) -> PyResult<RunSpec> {
    let read = match config.cast::<Run>() {
        Ok(run) => RunSpec::from_json(run.get().configuration(py)?),
        Err(_) if is_path(config) => RunSpec::read(&config.extract::<PathBuf>()?),
        Err(_) => RunSpec::from_json(json(py, config)?),
    };
    read.map_err(|error| Trouble::from(error).raise(py))
}

/// The same of a replay.
pub fn replay_configuration(py: Python<'_>, config: &Bound<'_, PyAny>) -> PyResult<ReplaySpec> {
    let read = match config.cast::<Run>() {
        Ok(run) => ReplaySpec::from_json(run.get().configuration(py)?),
        Err(_) if is_path(config) => ReplaySpec::read(&config.extract::<PathBuf>()?),
        Err(_) => ReplaySpec::from_json(json(py, config)?),
    };
    read.map_err(|error| Trouble::from(error).raise(py))
}

/// What is asked of a farm, and what that is laid over.
pub fn farm_request(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, PyAny>>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<(FarmRunOptions, Option<FarmSpec>)> {
    let base = config.map(|config| described(py, config, FarmSpec::read, FarmSpec::from_json)).transpose()?;
    let mut options = FarmRunOptions::default();
    ask(py, Of::Farm, scene, parameters, |name, text| options.set(name, text))?;
    Ok((options, base))
}

/// The same of an image on a hypercube.
pub fn cube_request(
    py: Python<'_>,
    scene: Option<&Bound<'_, PyAny>>,
    config: Option<&Bound<'_, PyAny>>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<(CubeRunOptions, Option<CubeSpec>)> {
    let base = config.map(|config| described(py, config, CubeSpec::read, CubeSpec::from_json)).transpose()?;
    let mut options = CubeRunOptions::default();
    ask(py, Of::Cube, scene, parameters, |name, text| options.set(name, text))?;
    Ok((options, base))
}

/// The description in a file, of another run, or in a value as JSON has it.
fn described<T>(
    py: Python<'_>,
    config: &Bound<'_, PyAny>,
    read: fn(&Path) -> Result<T, error::InputError>,
    from_json: fn(serde_json::Value) -> Result<T, error::InputError>,
) -> PyResult<T> {
    let described = match config.cast::<Run>() {
        Ok(run) => from_json(run.get().configuration(py)?),
        Err(_) if is_path(config) => read(&config.extract::<PathBuf>()?),
        Err(_) => from_json(json(py, config)?),
    };
    described.map_err(|error| Trouble::from(error).raise(py))
}

/// Hands each parameter that is given, by its name, and the text that stands for its value to `set`.
fn ask(
    py: Python<'_>,
    of: Of,
    scene: Option<&Bound<'_, PyAny>>,
    parameters: Option<&Bound<'_, PyDict>>,
    mut set: impl FnMut(&str, &str) -> Result<(), error::InputError>,
) -> PyResult<()> {
    let raise = |error: error::InputError| Trouble::from(error).raise(py);
    let given = PyDict::new(py);
    given.set_item("scene", scene)?;
    if let Some(parameters) = parameters {
        given.update(parameters.as_mapping())?;
    }
    for (name, value) in given {
        let known = named(of.parameters(), &name.extract::<String>()?).map_err(raise)?;
        if !value.is_none() {
            set(known.name, &text_of(py, known, &value)?).map_err(raise)?;
        }
    }
    Ok(())
}

/// Whether a value names a file: a text, or a path.
pub fn is_path(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyString>() || value.hasattr("__fspath__").unwrap_or(false)
}

/// A value as JSON: dicts, lists, numbers, texts, and what NumPy makes of them.
pub fn json(py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<serde_json::Value> {
    let text = py.import("pcs_sim._helpers")?.getattr("to_json")?.call1((value,));
    let text: String = text.map_err(|error| wrong(py, error.value(py).to_string()))?.extract()?;
    serde_json::from_str(&text).map_err(|error| wrong(py, error.to_string()))
}

/// The text that stands for a parameter's value, as it would be typed.
fn text_of(py: Python<'_>, known: &ParameterInfo, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let pair = |value: &Bound<'_, PyAny>| value.extract::<(u64, u64)>();
    if value.is_instance_of::<PyString>() {
        return value.extract();
    }
    // NumPy's, too.
    if let Ok(truth) = value.extract::<bool>() {
        return Ok(truth.to_string());
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(value.extract::<f64>()?.to_string());
    }
    if value.is_instance_of::<PyInt>() || value.hasattr("__index__")? {
        let number = value.call_method0("__index__").and_then(|number| number.str()?.extract::<String>());
        // An array has the method, but is no number.
        if let Ok(number) = number {
            return Ok(if known.kind == Kind::Size { format!("{number}x{number}") } else { number });
        }
    } else if value.hasattr("__fspath__")? {
        let path: PathBuf = value.extract()?;
        return path
            .into_os_string()
            .into_string()
            .map_err(|_| wrong(py, format!("{}: the path is not UTF-8", known.name)));
    } else if known.kind == Kind::Size && value.cast::<PySequence>().is_ok() && pair(value).is_ok() {
        let (width, height) = pair(value)?;
        return Ok(format!("{width}x{height}"));
    } else if let Ok(number) = value.extract::<f64>() {
        return Ok(number.to_string());
    }
    let expected = match known.kind {
        Kind::Text | Kind::File => "a text",
        Kind::Size => "a size: \"640x480\", (640, 480), or a number for both sides",
        Kind::Truth => "True or False",
        Kind::Whole => "a whole number",
        Kind::WholeOrWord => "a whole number or a word",
        Kind::Number => "a number",
    };
    Err(wrong(py, format!("invalid value {} for {}: expected {expected}", value.repr()?, known.name)))
}

/// The parameters: `name`, `kind` (text, size, truth, whole, whole or word, number), what it is (`label`, with its unit), for each call
/// whether it takes it (`run`, `image`, `replay`, `model`, `farm`, `ipsc2`), and whether it is one of a `machine`.
#[pyfunction]
pub fn parameters() -> PyResult<Table> {
    let mut all: Vec<&ParameterInfo> = Vec::new();
    for known in [Of::Rays, Of::Image, Of::Farm, Of::Cube].into_iter().flat_map(Of::parameters) {
        if all.iter().all(|other| other.name != known.name) {
            all.push(known);
        }
    }
    let kind = |kind: Kind| match kind {
        Kind::Text | Kind::File => "text",
        Kind::Size => "size",
        Kind::Truth => "truth",
        Kind::Whole => "whole",
        Kind::WholeOrWord => "whole or word",
        Kind::Number => "number",
    };
    let has = |of: Of, name: &str| of.parameters().iter().any(|known| known.name == name);
    let refused = |of: Of, name: &str| {
        moot::ALWAYS_REFUSED.iter().any(|(command, refused)| *command == of.name() && refused.contains(&name))
    };
    let takes = |of: Of| {
        let takes = all.iter().map(|known| has(of, known.name) && !refused(of, known.name));
        truth(of.name(), takes.collect::<Vec<_>>())
    };
    let mut columns = vec![
        text("name", all.iter().map(|known| known.name.to_owned())),
        text("kind", all.iter().map(|known| kind(known.kind).to_owned())),
        text("label", all.iter().map(|known| known.label.to_owned())),
    ];
    columns.extend([Of::Rays, Of::Image, Of::Replay, Of::Model, Of::Farm, Of::Cube].map(takes));
    columns.push(truth("machine", all.iter().map(|known| has(Of::Replay, known.name)).collect::<Vec<_>>()));
    Table::new(columns)
}

/// The built-in scenes: `name`, the default `size_factor`, how many `polygons` they then have, and what they show (`about`).
#[pyfunction]
pub fn scenes() -> PyResult<Table> {
    let all = builtin::all();
    Table::new(vec![
        text("name", all.iter().map(|scene| scene.name.to_owned())),
        whole("size_factor", all.iter().map(|scene| scene.default_size.into())),
        whole("polygons", all.iter().map(|scene| scene.faces(scene.default_size, None))),
        text("about", all.iter().map(|scene| scene.about.to_owned())),
    ])
}
