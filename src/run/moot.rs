//! Parameters that a run would take and not look at: whoever gives one expects it to matter, and is told that it does not,
//! by the name of its flag.
//!
//! A sweep is no such typing: a parameter that runs through its values may well be without effect at some points.

use std::path::Path;

use super::cube::{CubeRunOptions, CubeSpec, FlowKind};
use super::farm::{FarmRunOptions, FarmSpec};
use super::options::{CellsRun, MachineFileOptions, RunOptions, Switch};
use super::spec::{RunSpec, is_builtin};
use crate::error::InputError;
use crate::host::sampling::AdaptiveBy;
use crate::host::screen::ScreenRectangles;
use crate::input::name_inside;
use crate::machine::MachineOptions;
use crate::program::farm::ItemKind;
use crate::program::{ArrayProgram, Masks};
use crate::scene::builtin;

/// What commands share with others and refuse in any case, so that no help tells of it. (`run` is the command without a name.)
pub const ALWAYS_REFUSED: [(&str, &[&str]); 8] = [
    ("run", &["host_hit_us"]),
    ("replay", &["memory_words"]),
    (
        "model",
        &["host_hit_us", "mailbox", "stop_words", "forward_ahead", "rays_per_message", "message_us", "bounded_walk"],
    ),
    ("size-fifos", &DEPTHS),
    ("farm", &["adaptive", "adaptive_by", "threshold", "enough"]),
    ("ipsc2", &["adaptive", "adaptive_by", "threshold", "enough"]),
    ("calibrate-ipsc2", &ADAPTIVE),
    ("model-ipsc2", &ADAPTIVE),
];

/// Refuses the flags that a run of primary rays would not look at.
pub fn check_run(typed: &RunOptions, spec: &RunSpec) -> Result<(), InputError> {
    check_rays(typed)?;
    check_shading(typed)?;
    check_resolution(&spec.scene, spec.resolution)?;
    check_cells(typed, spec)?;
    check_host(typed, spec)?;
    check_program(typed, &spec.program)
}

/// Why an image that is not timed looks at no results of the machine.
pub const WITHOUT_TIMING: &str = "is about the machine at work, which --timing off leaves out";

/// Why a prediction alone does not look at what is about the run.
pub const WITHOUT_RUN: &str = "is about the simulation, which --predict-only leaves out";

/// Refuses the flags that an image would not look at.
pub fn check_image(typed: &RunOptions, spec: &RunSpec) -> Result<(), InputError> {
    let image = spec.image.clone().unwrap_or_default();
    if image.adaptive && image.samples == 1 {
        let flag = if typed.has("adaptive_by") { "--adaptive-by" } else { "--adaptive" };
        let error =
            InputError::new(format!("{flag} has nothing to refine a pixel with: it has one sample in any case"));
        return Err(error.help("say with --samples how many samples along a side a refined pixel has"));
    }
    if image.adaptive_by != AdaptiveBy::Whitted {
        let why = "is about colours, which are not what asks for samples here";
        refuse(typed, &["threshold"], why, "leave it out, or ask for --adaptive-by whitted")?;
    }
    if image.timing == Switch::Off {
        let (why, help) = (WITHOUT_TIMING, "leave out one of the two");
        let names = [
            &["order", "policy", "in_flight", "open_samples", "rules", "forward_ahead", "rays_per_message", "masks"],
            &LINKS[..],
            &DEPTHS,
            &HOST,
        ];
        refuse(typed, &names.concat(), why, help)?;
    }
    check_resolution(&spec.scene, spec.resolution)?;
    check_cells(typed, spec)?;
    check_host(typed, spec)?;
    check_program(typed, &spec.program)
}

/// Refuses what the cost model would not look at.
pub fn check_model(typed: &RunOptions, spec: &RunSpec, predict_only: bool) -> Result<(), InputError> {
    let program = &spec.program;
    if program.mailbox {
        let error = InputError::new("the cost model knows no mailbox: it is the paper's, which has none");
        return Err(error.help("leave --mailbox out, or take a program with mailbox: false"));
    }
    if program.stop_words.is_some() || program.forward_ahead > 0 {
        let error =
            InputError::new("the cost model knows neither stop words nor rays forwarded ahead, as the paper does not");
        return Err(error.help("take a program without them, or run this one to see what it does"));
    }
    if program.rays_per_message > 1 || spec.machine.message_us.is_some_and(|us| us > 0.0) {
        let error =
            InputError::new("the cost model knows no messages of several rays, and none that take the cells time");
        return Err(error.help("take a program of one ray a message and a machine without message_us, or run this one"));
    }
    if program.bounded_walk {
        let error = InputError::new("the cost model knows no walk that is bounded by the hit from the left");
        return Err(error.help("leave --bounded-walk out, or take a program with bounded_walk: false"));
    }
    if predict_only {
        let (why, help) = (WITHOUT_RUN, "leave out one of the two");
        refuse(typed, &["memory_words"], why, help)?;
    }
    check_rays(typed)?;
    check_shading(typed)?;
    check_resolution(&spec.scene, spec.resolution)?;
    check_host(typed, spec)?;
    check_program(typed, program)
}

/// Refuses the flags that a replay would not look at.
pub fn check_replay(typed: &RunOptions) -> Result<(), InputError> {
    refuse(typed, &["memory_words"], "is held against a scene, which a trace has not", "leave it out")
}

/// Refuses what sizing the FIFOs finds out.
pub fn check_size_fifos(typed: &RunOptions) -> Result<(), InputError> {
    refuse(typed, &DEPTHS, "is what is sought here", "leave it out")
}

/// Refuses what a trace has recorded already.
pub fn check_size_fifos_of_trace(typed: &RunOptions) -> Result<(), InputError> {
    let of_machine = |name: &str| MachineOptions::PARAMETERS.iter().any(|known| known.name == name);
    let others =
        RunOptions::parameters().map(|known| known.name).filter(|name| *name != "machine" && !of_machine(name));
    let others: Vec<&str> = others.chain(["memory_words"]).collect();
    refuse(typed, &others, "is about what the trace has recorded", "leave it out, or --ops")
}

/// Why a trace that is timed again looks at nothing that is about a run.
pub const WITHOUT_SCENE: &str = "is about tracing a scene, and a recorded trace goes without";

/// Refuses the flags that only a run has, beside a trace that is timed again.
pub fn check_why(typed: &RunOptions) -> Result<(), InputError> {
    let of_machine = MachineFileOptions::PARAMETERS.iter().chain(MachineOptions::PARAMETERS);
    let of_machine: Vec<&str> = of_machine.map(|parameter| parameter.name).collect();
    let names: Vec<&str> = RunOptions::parameters().map(|parameter| parameter.name).collect();
    let names: Vec<&str> = names.into_iter().filter(|name| !of_machine.contains(name)).collect();
    refuse(typed, &names, WITHOUT_SCENE, "leave out one of the two")
}

/// Refuses the flags that a replay of a trace in cycles would not look at.
pub(super) fn check_replay_of_cycles(typed: &RunOptions) -> Result<(), InputError> {
    let recorded = [&KERNELS[..], &HOST].concat();
    let help = "record a trace in units of work to see what it does";
    refuse(typed, &recorded, "is a time that the trace has recorded", help)
}

/// Whether a flag gives the price of a unit of work.
pub(super) fn prices(typed: &RunOptions, unit: &str) -> bool {
    KERNELS.iter().chain(&HOST).any(|name| name.trim_end_matches("_us") == unit && typed.has(name))
}

fn check_rays(typed: &RunOptions) -> Result<(), InputError> {
    match typed.has("rays") && typed.has("size") {
        true => Err(InputError::new("rays and size cannot both be given").help("the size is that of a camera's image")),
        false => Ok(()),
    }
}

/// Refuses the flags that a farm would not look at.
pub fn check_farm(typed: &FarmRunOptions, spec: &FarmSpec) -> Result<(), InputError> {
    let refuse = |names: &[&str], why: &str, help: &str| match names.iter().find(|name| typed.has(name)) {
        Some(name) => Err(InputError::new(format!("--{} {why}", name.replace('_', "-"))).help(help)),
        None => Ok(()),
    };
    let adaptive = "asks what the neighbours of a pixel show, which other workers know";
    refuse(&ADAPTIVE, adaptive, "ask for more --samples in all pixels, as workers can take these by themselves")?;
    if spec.items != ItemKind::Tiles {
        refuse(&["tile"], "is about tiles, which the master does not hand out", "ask for --items tiles")?;
    }
    if spec.rectangles.is_none() {
        let why = "is about the made-up scene, and this one has polygons";
        refuse(&["rectangles", "seed", "pixel_ms"], why, "leave it out, or take the scene `rectangles`")?;
        return check_resolution(&spec.scene, spec.resolution);
    }
    let shape = ["size_factor", "resolution", "samples", "depth", "min_contribution", "grid_coefficient"];
    let why = "is about scenes of polygons, and this one is made up of rectangles";
    let help = "leave it out, or take another scene";
    refuse(&[&shape[..], &KERNELS, &["shade_hit"]].concat(), why, help)
}

/// Refuses the flags that an image on a hypercube would not look at.
pub fn check_cube(typed: &CubeRunOptions, spec: &CubeSpec) -> Result<(), InputError> {
    let refuse = |names: &[&str], why: &str, help: &str| match names.iter().find(|name| typed.has(name)) {
        Some(name) => Err(InputError::new(format!("--{} {why}", name.replace('_', "-"))).help(help)),
        None => Ok(()),
    };
    let adaptive = "asks what the neighbours of a pixel show, which other nodes know";
    refuse(&ADAPTIVE, adaptive, "ask for more --samples in all pixels")?;
    check_resolution(&spec.scene, spec.resolution)?;
    let Some(regions) = &spec.regions else {
        let why = "is about regions and the rays between them, and these nodes share a memory";
        return refuse(&OF_REGIONS, why, "leave it out, or ask for --mode regions");
    };
    let why = "is about pages of a shared memory, and these nodes have a region each";
    refuse(
        &["page_bytes", "distribution", "lookup_us", "serve_us"],
        why,
        "leave it out, or ask for --mode shared-memory",
    )?;
    if regions.flow != FlowKind::Window {
        refuse(&["window"], "is about pixels under way, which are not limited", "ask for --flow window")?;
    }
    if matches!(regions.flow, FlowKind::Unlimited | FlowKind::Window) {
        let why = "is about slots of queues, which are not limited";
        refuse(&["queue_rays"], why, "ask for --flow classes or block")?;
    }
    if regions.flow != FlowKind::Classes {
        let why = "is about slots by rank, of which other nodes must know whether they are free";
        refuse(&["grant"], why, "ask for --flow classes")?;
    }
    Ok(())
}

/// What only nodes look at that have regions.
const OF_REGIONS: [&str; 15] = [
    "sub_sample",
    "cell_grid",
    "cell_cuts",
    "grids",
    "mapping",
    "flow",
    "queue_rays",
    "grant",
    "window",
    "termination",
    "pixel_order",
    "first",
    "pixels",
    "result_us",
    "fill_us",
];

fn check_shading(typed: &RunOptions) -> Result<(), InputError> {
    let why = "is about shading hits, which only a whole image does";
    refuse(typed, &["host_hit_us"], why, "`pcs-sim image` makes whole images")
}

fn check_cells(typed: &RunOptions, spec: &RunSpec) -> Result<(), InputError> {
    if spec.cells_run == CellsRun::Programs {
        let why = "is a time of Figure 7, which cells that run programs do not take";
        return refuse(typed, &KERNELS, why, "leave it out, or let the cells run timings");
    }
    let names = ["cell_programs", "instruction_limit", "early_slabs", "stepped_walk"];
    refuse(typed, &names, "is about programs of the cells, which run none", "ask for --cells-run programs")
}

/// Refuses the times of what the host does not do.
fn check_host(typed: &RunOptions, spec: &RunSpec) -> Result<(), InputError> {
    if spec.screen_rectangles == ScreenRectangles::Off {
        let why = "is about testing samples against rectangles, of which there are none";
        refuse(typed, &["host_filter_us"], why, "leave it out, or ask for --screen-rectangles")?;
    }
    if spec.program.masks == Masks::Off {
        let why = "is about masks, which rays have none of";
        refuse(typed, &["host_mask_us"], why, "leave it out, or ask for --masks")?;
    }
    Ok(())
}

fn check_program(typed: &RunOptions, program: &ArrayProgram) -> Result<(), InputError> {
    if program.groups == 1 {
        let why = "cuts the scene into sub-volumes, and one group has them all";
        refuse(typed, &["partition", "numbering"], why, "ask for several --groups")?;
        let why = "is about the hit of the groups to the left, and one group has none";
        refuse(typed, &["bounded_walk"], why, "ask for several --groups")?;
    }
    if program.placement().slabs.is_none() {
        let why = format!("is about slabs, which the program '{}' goes without", program.name);
        refuse(typed, &["slabs_start", "slabs_polygon"], &why, "leave it out, or take a program with slabs")?;
    }
    Ok(())
}

/// Slices matter to spheres and cones, so not to every scene.
fn check_resolution(scene: &str, resolution: Option<u32>) -> Result<(), InputError> {
    let of_polygons = if is_builtin(scene) {
        builtin::all().iter().any(|known| known.name == scene && known.default_resolution.is_none())
    } else {
        let inside = name_inside(Path::new(scene));
        let extension = inside.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        matches!(extension.as_deref(), Some("obj" | "ply"))
    };
    if of_polygons && resolution.is_some() {
        let error = InputError::new("--resolution slices spheres and cones, and this scene is of polygons only");
        return Err(error.help("leave it out"));
    }
    Ok(())
}

/// Fails if one of the parameters was typed.
fn refuse(typed: &RunOptions, names: &[&str], why: &str, help: &str) -> Result<(), InputError> {
    match names.iter().find(|name| typed.has(name)) {
        Some(name) => Err(InputError::new(format!("--{} {why}", name.replace('_', "-"))).help(help)),
        None => Ok(()),
    }
}

/// The depths of the FIFOs.
const DEPTHS: [&str; 4] = ["fifo_words", "x_fifo_words", "y_fifo_words", "z_fifo_words"];

/// What joins the cells beside: all that computing does not depend on.
const LINKS: [&str; 4] = ["word_bytes", "link_mb_s", "rate_counts", "latency_cycles"];

/// What only adaptive sampling looks at.
const ADAPTIVE: [&str; 3] = ["adaptive", "adaptive_by", "threshold"];

/// The host's times, and what messages take.
const HOST: [&str; 5] = ["host_ray_us", "host_hit_us", "host_filter_us", "host_mask_us", "message_us"];

/// The kernels' times.
const KERNELS: [&str; 6] =
    ["grid_start", "grid_voxel", "slabs_start", "slabs_polygon", "intersection_start", "intersection_polygon"];
