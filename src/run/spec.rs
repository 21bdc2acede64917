//! What a run is: all that its results depend on, with every default filled in.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::options::{CellsRun, MachineFileOptions, Mode, On, RunOptions, Switch};
use crate::error::{InputError, Place};
use crate::geometry::{Edges, Ray};
use crate::host::camera::{self, ImageSize};
use crate::host::order::{Order, Sequence};
use crate::host::policy::{HostRules, Policy};
use crate::host::ray_file;
use crate::host::rules::Rules;
use crate::host::sampling::{AdaptiveBy, Criterion, Sampling};
use crate::host::screen::ScreenRectangles;
use crate::host::shading::Limits;
use crate::input::STREAM;
use crate::input::fields::{self, is_default};
use crate::isa::Processor;
use crate::machine::{Machine, MachineFile};
use crate::program::cells::{Annex, CellOptions};
use crate::program::{ArrayProgram, Masks};
use crate::scene::{ReadOptions, Scene, builtin};

/// A run, described: enough to repeat it to the bit.
///
/// It is the `configuration` of a run's statistics; fields that it does not know are refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSpec {
    /// The simulator's version that wrote it.
    pub version: String,
    /// A built-in scene or a file.
    pub scene: String,
    /// Size factor of a built-in scene; `None` for its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_factor: Option<u32>,
    /// Slices of spheres and cones; `None` for the scene's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<u32>,
    /// Size of the image, if the rays are a camera's.
    #[serde(default = "standard_size")]
    pub size: ImageSize,
    /// The file of the rays, if they are not a camera's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rays: Option<PathBuf>,
    /// In which order the host sends the rays, or begins the pixels.
    #[serde(default, skip_serializing_if = "is_default")]
    pub order: Order,
    /// Of what there are rectangles, outside which the host sends no rays from the eye.
    #[serde(default, skip_serializing_if = "is_default")]
    pub screen_rectangles: ScreenRectangles,
    /// How a whole image is made; `None` for a run of primary rays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<ImageSpec>,
    /// The array program, as its file would have it.
    pub program: ArrayProgram,
    /// How the intersection tells the inside of a polygon.
    #[serde(default, skip_serializing_if = "is_default")]
    pub edges: Edges,
    /// What the cells run.
    pub cells_run: CellsRun,
    /// The programs of cells that run any: a folder, or `standard`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell_programs: Option<PathBuf>,
    /// The most cycles that a program may compute for one ray, if cells run any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instruction_limit: Option<u64>,
    /// Where the cells' programs do as the annex does, and the standard ones otherwise.
    #[serde(default, skip_serializing_if = "is_default")]
    pub annex: Annex,
    /// The machine, as its file would have it.
    pub machine: MachineFile,
}

/// A replay, described: enough to repeat it to the cycle.
///
/// It is the `configuration` of a replay's statistics; fields that it does not know are refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReplaySpec {
    /// The simulator's version that wrote it.
    pub version: String,
    /// The activity trace.
    pub ops: PathBuf,
    /// What the trace's units of work cost, in cycles; none, if it counts in cycles.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub unit_cycles: BTreeMap<String, u64>,
    /// The machine, as its file would have it. Its times of kernels count only through `unit_cycles`.
    pub machine: MachineFile,
}

impl ReplaySpec {
    /// Reads a description: a replay's configuration, or the statistics that have it.
    pub fn read(path: &Path) -> Result<ReplaySpec, InputError> {
        read_configuration::<ReplaySpec>(path, REPLAY)?.checked()
    }

    /// The same from JSON that is at hand.
    pub fn from_json(value: serde_json::Value) -> Result<ReplaySpec, InputError> {
        configuration::<ReplaySpec>(value, REPLAY)?.checked()
    }

    fn checked(self) -> Result<ReplaySpec, InputError> {
        self.machine.build()?;
        Ok(self)
    }
}

/// Reads a configuration, or the one in statistics.
pub(super) fn read_configuration<T: DeserializeOwned>(path: &Path, what: &str) -> Result<T, InputError> {
    let text = fields::read_text(path)?;
    let value = serde_json::from_str(&text)
        .map_err(|error| InputError::in_file(path, format!("describes no {what}: {error}")))?;
    let place = Some(Place { file: path.to_owned(), spot: None });
    configuration(value, what).map_err(|error| InputError { place, ..error })
}

/// What a configuration describes, or the one in statistics.
pub(super) fn configuration<T: DeserializeOwned>(mut value: serde_json::Value, what: &str) -> Result<T, InputError> {
    let configuration = match value.get_mut("configuration") {
        Some(configuration) => configuration,
        None => &mut value,
    };
    let kind = KINDS.iter().find(|(field, ..)| configuration.pointer(field).is_some());
    if let Some((.., told, command)) = kind.filter(|(_, kind, ..)| *kind != what) {
        let error = InputError::new(format!("describes no {what}, but {told}"));
        return Err(error.help(format!("`pcs-sim {command}` repeats it")));
    }
    // It tells more than what was asked for: what the scene came to, which is worked out again.
    if let Some(fields) = configuration.as_object_mut() {
        FACTS.iter().for_each(|fact| drop(fields.remove(*fact)));
    }
    serde_json::from_value(configuration.take())
        .map_err(|error| InputError::new(format!("describes no {what}: {error}")))
}

/// What configurations describe: a field by which to know it, what it is and is called, and the command that repeats it.
const KINDS: [(&str, &str, &str, &str); 5] = [
    ("/ops", REPLAY, "a replay", "replay --config FILE"),
    ("/tasks", FARM, "a farm", "farm --config FILE"),
    ("/machine/nodes", CUBE, "an image on a hypercube", "ipsc2 --config FILE"),
    ("/image", RUN, "a whole image", "image --config FILE -o IMAGE"),
    ("/program", RUN, "a run", "--config FILE"),
];

const REPLAY: &str = "replay";
const RUN: &str = "run";
pub(super) const FARM: &str = "farm";
pub(super) const CUBE: &str = "image on a hypercube";

/// What a configuration says of its scene beside the run's description.
const FACTS: [&str; 3] = ["polygons", "memory", "solids"];

/// How an image is made of its scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageSpec {
    /// Samples along each side of a pixel.
    pub samples: u32,
    /// Whether a pixel has them only where something asks for them.
    pub adaptive: bool,
    /// What asks for them then.
    #[serde(default, skip_serializing_if = "is_default")]
    pub adaptive_by: AdaptiveBy,
    /// How far colours may differ where these ask, in steps of 255; `None` for [`Criterion::THRESHOLD`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub threshold: Option<u8>,
    /// How often light may be reflected or refracted.
    pub depth: u8,
    /// The least share of a pixel for which a ray is followed.
    pub min_contribution: f64,
    /// Whether the array is timed.
    pub timing: Switch,
    /// What the host sends next.
    pub policy: Policy,
    /// How many rays may be in the array at once; `None` for as many as it takes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub in_flight: Option<u64>,
    /// How many samples the host may have begun and not done.
    pub open_samples: u32,
    /// What spares tests and rays without changing a hit.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rules: Rules,
}

/// What stands for the standard programs of the cells.
const STANDARD_PROGRAMS: &str = "standard";

pub(super) fn standard_size() -> ImageSize {
    ImageSize { width: 256, height: 256 }
}

impl Default for ImageSpec {
    fn default() -> Self {
        let (limits, rules) = (Limits { depth: 5, contribution: 1.0 / 256.0 }, HostRules::default());
        ImageSpec {
            samples: 1,
            adaptive: false,
            adaptive_by: AdaptiveBy::default(),
            threshold: None,
            depth: limits.depth,
            min_contribution: limits.contribution,
            timing: Switch::On,
            policy: rules.policy,
            in_flight: rules.in_flight,
            open_samples: rules.open_samples as u32,
            rules: Rules::default(),
        }
    }
}

impl RunSpec {
    /// The scene where none is named.
    pub const STANDARD_SCENE: &str = "teapot";

    /// What a run of primary rays is that was asked for by `options`: they are laid over `base`, or over the defaults.
    ///
    /// Fails if a file cannot be read, or if the options make an impossible program or machine.
    pub fn new(options: &RunOptions, base: Option<RunSpec>) -> Result<RunSpec, InputError> {
        let base = base.as_ref();
        let machine = machine_file(options, base.map(|base| &base.machine))?;
        machine.build()?;
        let program = array_program(options, base.map(|base| &base.program))?;
        let (scene, shape, cells) = (&options.scene.scene, &options.shape, &options.cells);
        let of_same_scene = base.filter(|base| scene.as_ref().is_none_or(|scene| *scene == base.scene));
        let size = shape.size.or(base.map(|base| base.size)).unwrap_or_else(standard_size);
        let cells_run = cells.cells_run.or(base.map(|base| base.cells_run)).unwrap_or(CellsRun::Timings);
        let runs_programs = cells_run == CellsRun::Programs;
        // A folder that happens to have that name is still a folder.
        let folder = cells.cell_programs.as_ref().map(|folder| match folder == Path::new(STANDARD_PROGRAMS) {
            true => Path::new(".").join(folder),
            false => folder.clone(),
        });
        let cell_programs = folder.or_else(|| base?.cell_programs.clone()).unwrap_or_else(|| STANDARD_PROGRAMS.into());
        let instruction_limit = cells.instruction_limit.or(base.and_then(|base| base.instruction_limit));
        let instruction_limit = instruction_limit.unwrap_or(Processor::INSTRUCTION_LIMIT);
        let before = base.map(|base| base.annex).unwrap_or_default();
        let annex = Annex {
            early_slabs: cells.early_slabs.unwrap_or(before.early_slabs),
            stepped_walk: cells.stepped_walk.unwrap_or(before.stepped_walk),
        };
        let rays = options.rays.rays.clone().or_else(|| base?.rays.clone().filter(|_| shape.size.is_none()));
        let edges = cells.edges.or(base.map(|base| base.edges)).unwrap_or_default();
        check_edges(edges, cells_run)?;
        let sending = &options.sending;
        let order = sending.order.or(base.map(|base| base.order)).unwrap_or_default();
        check_order(order, rays.as_deref())?;
        let screen_rectangles =
            sending.screen_rectangles.or(base.map(|base| base.screen_rectangles)).unwrap_or_default();
        check_screen((screen_rectangles, program.masks), rays.as_deref())?;
        Ok(RunSpec {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene
                .clone()
                .or(base.map(|base| base.scene.clone()))
                .unwrap_or_else(|| RunSpec::STANDARD_SCENE.to_owned()),
            size_factor: shape.size_factor.or(of_same_scene.and_then(|base| base.size_factor)),
            resolution: shape.resolution.or(of_same_scene.and_then(|base| base.resolution)),
            size,
            rays,
            order,
            screen_rectangles,
            image: None,
            program,
            edges,
            cells_run,
            cell_programs: runs_programs.then_some(cell_programs),
            instruction_limit: runs_programs.then_some(instruction_limit),
            annex: if runs_programs { annex } else { Annex::default() },
            machine,
        })
    }

    /// The same, where `base` may be no whole image.
    pub fn of_rays(options: &RunOptions, base: Option<RunSpec>) -> Result<RunSpec, InputError> {
        let help = "`pcs-sim image --config FILE` makes it again";
        RunSpec::new(options, base.map(|base| base.without_image(help)).transpose()?)
    }

    /// What a run is whose FIFOs are sized: `base` may be no whole image.
    pub fn of_sizing(options: &RunOptions, base: Option<RunSpec>) -> Result<RunSpec, InputError> {
        let help = "record it by `pcs-sim image --config FILE --ops OPS`, and take the recording by --ops OPS";
        RunSpec::new(options, base.map(|base| base.without_image(help)).transpose()?)
    }

    /// What a run is that the cost model predicts: `base` may be no whole image, and none whose cells run programs.
    pub fn of_model(options: &RunOptions, base: Option<RunSpec>) -> Result<RunSpec, InputError> {
        let help = "the model is about primary rays: take the configuration of a run";
        let base = base.map(|base| base.without_image(help)).transpose()?;
        if base.as_ref().is_some_and(|base| base.cells_run == CellsRun::Programs) {
            let error = InputError::new("the configuration is that of cells that run programs");
            return Err(error.help("the model is about Figure 7's times: take the configuration of a run with those"));
        }
        RunSpec::new(options, base)
    }

    fn without_image(self, help: &str) -> Result<RunSpec, InputError> {
        match self.image {
            Some(_) => Err(InputError::new("the configuration is that of a whole image").help(help)),
            None => Ok(self),
        }
    }

    /// The same of a whole image.
    pub fn of_image(options: &RunOptions, base: Option<RunSpec>) -> Result<RunSpec, InputError> {
        let below = base.as_ref().and_then(|base| base.image.clone()).unwrap_or_default();
        let (light, host) = (&options.light, &options.host);
        let image = ImageSpec {
            samples: light.samples.unwrap_or(below.samples),
            adaptive: light.adaptive.unwrap_or(below.adaptive || light.adaptive_by.is_some()),
            adaptive_by: light.adaptive_by.unwrap_or(below.adaptive_by),
            threshold: light.threshold.or(below.threshold),
            depth: light.depth.unwrap_or(below.depth),
            min_contribution: light.min_contribution.unwrap_or(below.min_contribution),
            timing: host.timing.unwrap_or(below.timing),
            policy: host.policy.unwrap_or(below.policy),
            in_flight: host.in_flight.or(below.in_flight),
            open_samples: host.open_samples.unwrap_or(below.open_samples),
            rules: host.rules.unwrap_or(below.rules),
        };
        image.check()?;
        Ok(RunSpec { image: Some(image), rays: None, ..RunSpec::new(options, base)? })
    }

    /// Reads a description: a run's configuration, or the statistics that have it.
    pub fn read(path: &Path) -> Result<RunSpec, InputError> {
        read_configuration::<RunSpec>(path, RUN)?.checked()
    }

    /// The same from JSON that is at hand.
    pub fn from_json(value: serde_json::Value) -> Result<RunSpec, InputError> {
        configuration::<RunSpec>(value, RUN)?.checked()
    }

    fn checked(self) -> Result<RunSpec, InputError> {
        self.machine.build()?;
        self.program.check()?;
        check_edges(self.edges, self.cells_run)?;
        check_order(self.order, self.rays.as_deref())?;
        check_screen((self.screen_rectangles, self.program.masks), self.rays.as_deref())?;
        self.image.as_ref().map_or(Ok(()), ImageSpec::check)?;
        Ok(self)
    }

    /// Reads or generates the scene.
    pub fn load_scene(&self) -> Result<Scene, InputError> {
        load_scene(&self.scene, self.size_factor, self.resolution)
    }

    /// The rays of its file or of the camera, by their numbers.
    pub(super) fn load_rays(&self, scene: &Scene) -> Result<Vec<Ray>, InputError> {
        match &self.rays {
            Some(path) => ray_file::read(path),
            None => Ok(camera::primary_rays(&scene.camera, self.size)),
        }
    }

    /// The numbers of that many rays, in the order in which the host sends them. The number of a camera's ray is its pixel's, line
    /// by line; that of a file's, its place there.
    pub fn sequence(&self, rays: usize) -> Sequence {
        match &self.rays {
            Some(_) => self.order.of_list(rays).unwrap_or_else(|| Sequence::in_order(rays)),
            None => self.order.of_pixels(self.size),
        }
    }

    /// How the cells run programs.
    pub(super) fn cell_options(&self, machine: &Machine) -> Result<CellOptions, InputError> {
        let instruction_limit = self.instruction_limit.unwrap_or(Processor::INSTRUCTION_LIMIT);
        let folder = self.cell_programs.clone().filter(|folder| folder != Path::new(STANDARD_PROGRAMS));
        Ok(CellOptions { cycles: machine.instruction_cycles()?, folder, instruction_limit, annex: self.annex })
    }
}

impl ImageSpec {
    pub(super) fn check(&self) -> Result<(), InputError> {
        let within = |what: &str, value: u64, least: u64, most: u64| match (least..=most).contains(&value) {
            true => Ok(()),
            false => Err(InputError::new(format!("{what} are {value}, they must be from {least} to {most}"))),
        };
        let share = self.min_contribution;
        if !(0.0..=1.0).contains(&share) {
            return Err(InputError::new(format!("the least contribution is {share}, it must be from 0 to 1")));
        }
        within("the samples along a side of a pixel", self.samples as u64, 1, 64)?;
        within("the open samples", self.open_samples as u64, 1, 1 << 20)?;
        within("the rays in flight", self.in_flight.unwrap_or(1), 1, u64::MAX)
    }

    /// How many samples a pixel has.
    pub fn sampling(&self) -> Sampling {
        let criterion = match self.adaptive_by {
            AdaptiveBy::Object => Criterion::Object,
            AdaptiveBy::Surface => Criterion::Surface,
            AdaptiveBy::Lao => Criterion::Lao,
            AdaptiveBy::Whitted => Criterion::Whitted { threshold: self.threshold.unwrap_or(Criterion::THRESHOLD) },
        };
        Sampling { side: self.samples, adaptive: self.adaptive.then_some(criterion) }
    }

    /// How far light is followed.
    pub fn limits(&self) -> Limits {
        Limits { depth: self.depth, contribution: self.min_contribution }
    }

    /// What the host may do, which begins the pixels in that order.
    pub fn host_rules(&self, order: Order) -> HostRules {
        let open_samples = self.open_samples as usize;
        HostRules { order, policy: self.policy, in_flight: self.in_flight, open_samples }
    }
}

/// The cells' programs are annex A.3.
fn check_edges(edges: Edges, cells_run: CellsRun) -> Result<(), InputError> {
    if edges == Edges::Closed && cells_run == CellsRun::Programs {
        let error = InputError::new(
            "the cells' programs tell the inside of a polygon as the paper does: theirs has no closed edges",
        );
        return Err(error.help("leave --edges closed out, or let the cells run timings"));
    }
    Ok(())
}

/// Reads or generates a scene, with the size factor of a built-in one and the slices of spheres and cones if they are given.
///
/// # Errors
///
/// If there is no such scene, or its file is wrong.
pub fn load_scene(scene: &str, size_factor: Option<u32>, resolution: Option<u32>) -> Result<Scene, InputError> {
    if scene == STREAM {
        let error = InputError::new("standard input does not tell what kind of scene comes");
        return Err(error.help("name it with an ending: -.obj, -.ply, ..."));
    }
    if is_builtin(scene) {
        return builtin::generate(scene, size_factor, resolution);
    }
    if size_factor.is_some() {
        let error = InputError::new("a size factor is for built-in scenes, not for files");
        return Err(error.help("`pcs-sim scenes` lists the built-in scenes"));
    }
    let options = ReadOptions { resolution: resolution.unwrap_or(ReadOptions::default().resolution) };
    crate::scene::load(Path::new(scene), &options)
}

/// Fails if rays of a file are to be sent in an order of pixels.
fn check_order(order: Order, rays: Option<&Path>) -> Result<(), InputError> {
    if rays.is_none() || order.of_list(1).is_some() {
        return Ok(());
    }
    let error = InputError::new(format!("{order} is an order of pixels, and the rays are a file's"));
    Err(error.help("rays of a file can be sent as they stand there (raster), by stride and by shuffle:SEED"))
}

/// Fails if there is to be a screen of rays that have none.
fn check_screen((rectangles, masks): (ScreenRectangles, Masks), rays: Option<&Path>) -> Result<(), InputError> {
    if rays.is_none() {
        return Ok(());
    }
    let help = "leave them out, or let the rays be the camera's";
    if rectangles != ScreenRectangles::Off {
        let error = InputError::new("screen rectangles are seen from the camera's eye, and the rays are a file's");
        return Err(error.help(help));
    }
    match masks {
        Masks::Rectangles => {
            let error =
                InputError::new("masks by rectangles are for rays from the camera's eye, and these are a file's");
            Err(error.help("masks by boxes are for any rays"))
        }
        Masks::Off | Masks::Boxes => Ok(()),
    }
}

/// Whether a scene is the name of a built-in one, not that of a file.
pub fn is_builtin(scene: &str) -> bool {
    !scene.contains(['.', '/', '\\'])
}

/// The machine: that of a file, of `base` or PCS, with the changes that are asked for.
pub fn machine_file(options: &RunOptions, base: Option<&MachineFile>) -> Result<MachineFile, InputError> {
    let MachineFileOptions { on, machine } = &options.machine_file;
    let mut file = match (on, machine, base) {
        (Some(_), Some(_), _) => return Err(InputError::new("on and machine cannot both be given")),
        (Some(On::Pcs), None, _) | (None, None, None) => MachineFile::standard()?,
        (Some(On::Ipsc2), None, _) => MachineFile::ipsc2_line()?,
        (None, Some(path), _) => MachineFile::read(path)?,
        (None, None, Some(base)) => base.clone(),
    };
    options.machine.change(&mut file);
    Ok(file)
}

/// The array program: a standard one, a file's or `base`, with the changes that are asked for.
pub fn array_program(options: &RunOptions, base: Option<&ArrayProgram>) -> Result<ArrayProgram, InputError> {
    let options = &options.program;
    if let (Some(_), Some(_)) = (options.mode, &options.program) {
        return Err(InputError::new("mode and program cannot both be given"));
    }
    if let (Some(_), Some(_)) = (options.cells, options.groups) {
        return Err(InputError::new("cells and groups cannot both be given"));
    }
    let mut program = match (&options.program, options.mode, base) {
        (Some(path), _, _) => named_program(path)?,
        (None, None, Some(base)) => base.clone(),
        (None, mode, _) => standard_program(mode.unwrap_or(Mode::Pipeline))?,
    };
    let is_pipeline = program == standard_program(Mode::Pipeline)?;
    let stages = program.stages.len();
    if let Some(cells) = options.cells {
        if cells == 0 || !cells.is_multiple_of(stages) {
            let message = format!("{cells} cells are no whole number of groups of {stages}");
            let help = format!("program '{}' takes {stages}, {}, {}, ... cells", program.name, 2 * stages, 3 * stages);
            return Err(InputError::new(message).help(help));
        }
        program.groups = cells / stages;
    }
    program.groups = options.groups.unwrap_or(program.groups);
    if is_pipeline && program.groups != 1 {
        let message = format!("the macro-pipeline is one group of {stages} cells, not {} groups", program.groups);
        return Err(InputError::new(message).help("several macro-pipelines side by side are --program hybrid-3"));
    }
    program.partition = options.partition.unwrap_or(program.partition);
    program.numbering = options.numbering.unwrap_or(program.numbering);
    program.grid_coefficient = options.grid_coefficient.unwrap_or(program.grid_coefficient);
    program.mailbox = options.mailbox.unwrap_or(program.mailbox);
    program.stop_words = options.stop_words.or(program.stop_words);
    program.forward_ahead = options.forward_ahead.unwrap_or(program.forward_ahead);
    program.rays_per_message = options.rays_per_message.unwrap_or(program.rays_per_message);
    program.bounded_walk = options.bounded_walk.unwrap_or(program.bounded_walk);
    program.masks = options.masks.unwrap_or(program.masks);
    program.check()?;
    Ok(program)
}

fn standard_program(mode: Mode) -> Result<ArrayProgram, InputError> {
    let name = mode.program();
    ArrayProgram::standard(name).unwrap_or_else(|| Err(InputError::new(format!("there is no standard program {name}"))))
}

/// A standard program by its name, or a program file.
fn named_program(path: &Path) -> Result<ArrayProgram, InputError> {
    let standard = path.to_str().and_then(ArrayProgram::standard);
    standard.unwrap_or_else(|| ArrayProgram::read(path))
}
