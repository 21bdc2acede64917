//! Flags that a command would take and not look at: whoever types one expects it to matter, and is told that it does not.
//!
//! A sweep is no such typing: a parameter that runs through its values may well be without effect at some points.

use std::path::Path;

use pcs_sim::error::InputError;
use pcs_sim::program::ArrayProgram;
use pcs_sim::scene::builtin;

use super::args::{CellArgs, CellsRun, ImageArgs, MachineArgs, ModelArgs, ProgramArgs, ReplayArgs, RunArgs, Switch};
use super::run::is_builtin;

/// A flag, and whether it was typed.
type Flag = (&'static str, bool);

/// Refuses the flags that a run of primary rays would not look at.
pub fn check_run(args: &RunArgs, program: &ArrayProgram) -> Result<(), InputError> {
    let shading = [("--host-hit-us", args.machine.host_hit_us.is_some())];
    refuse(&shading, "is about shading hits, which only a whole image does", "`pcs-sim image` makes whole images")?;
    check_resolution(&args.scene.scene, args.scene.shape.resolution)?;
    check_cells(&args.cells, &args.machine)?;
    check_program(&args.program, &args.machine, program)
}

/// Refuses the flags that an image would not look at.
pub fn check_image(args: &ImageArgs, program: &ArrayProgram) -> Result<(), InputError> {
    if args.light.adaptive && args.light.samples == 1 {
        let error = InputError::new("--adaptive has nothing to refine a pixel with: it has one sample in any case");
        return Err(error.help("say with --samples how many samples along a side a refined pixel has"));
    }
    if args.host.timing == Switch::Off {
        let files = [
            ("--stats", args.results.stats.is_some()),
            ("--hits", args.tracing.hits.is_some()),
            ("--ops", args.tracing.ops.is_some()),
            ("--plot", args.views.plot.is_some()),
            ("--page", args.views.page.is_some()),
            ("--trace", args.views.trace.is_some()),
            ("--policy", args.host.policy.is_some()),
            ("--in-flight", args.host.in_flight.is_some()),
            ("--open-samples", args.host.open_samples.is_some()),
            ("--forward-ahead", args.program.forward_ahead.is_some()),
        ];
        let flags = [&files[..], &links(&args.machine), &host(&args.machine)].concat();
        refuse(&flags, "is about the machine at work, which --timing off leaves out", "leave out one of the two")?;
    }
    check_resolution(&args.scene, args.shape.resolution)?;
    check_cells(&args.cells, &args.machine)?;
    check_program(&args.program, &args.machine, program)
}

/// Refuses what the cost model would not look at.
pub fn check_model(args: &ModelArgs, program: &ArrayProgram) -> Result<(), InputError> {
    if program.mailbox {
        let error = InputError::new("the cost model knows no mailbox: it is the paper's, which has none");
        return Err(error.help("leave --mailbox out, or take a program with mailbox: false"));
    }
    if program.stop_words.is_some() || program.forward_ahead > 0 {
        let error =
            InputError::new("the cost model knows neither stop words nor rays forwarded ahead, as the paper does not");
        return Err(error.help("take a program without them, or run this one to see what it does"));
    }
    if args.predict_only {
        let flags = [
            ("--fifo-words", args.machine.fifo_words.is_some()),
            ("--latency-cycles", args.machine.latency_cycles.is_some()),
            ("--memory-words", args.machine.memory_words.is_some()),
            ("--threads", args.threads.is_some()),
        ];
        refuse(&flags, "is about the simulation, which --predict-only leaves out", "leave out one of the two")?;
    }
    let shading = [("--host-hit-us", args.machine.host_hit_us.is_some())];
    refuse(&shading, "is about shading hits, which only a whole image does", "`pcs-sim image` makes whole images")?;
    check_resolution(&args.scene, args.shape.resolution)?;
    check_program(&args.program, &args.machine, program)
}

/// Refuses the flags that a replay would not look at.
pub fn check_replay(args: &ReplayArgs) -> Result<(), InputError> {
    let memory = [("--memory-words", args.machine.memory_words.is_some())];
    refuse(&memory, "is held against a scene, which a trace has not", "leave it out")
}

/// Refuses the flags that a replay of a trace in cycles would not look at.
pub fn check_replay_of_cycles(args: &ReplayArgs) -> Result<(), InputError> {
    let recorded = [&kernels(&args.machine)[..], &host(&args.machine)].concat();
    refuse(&recorded, "is a time that the trace has recorded", "record a trace in units of work to see what it does")
}

/// Whether a flag gives the price of a unit of work.
pub fn prices(args: &MachineArgs, unit: &str) -> bool {
    let flag = |(flag, typed): &Flag| *typed && flag[2..].trim_end_matches("-us").replace('-', "_") == unit;
    kernels(args).iter().chain(&host(args)).any(flag)
}

fn check_cells(typed: &CellArgs, machine: &MachineArgs) -> Result<(), InputError> {
    if typed.cells_run == Some(CellsRun::Programs) {
        let why = "is a time of Figure 7, which cells that run programs do not take";
        return refuse(&kernels(machine), why, "leave it out, or let the cells run timings");
    }
    let flags = [
        ("--cell-programs", typed.cell_programs.is_some()),
        ("--instruction-limit", typed.instruction_limit.is_some()),
    ];
    refuse(&flags, "is about programs of the cells, which run none", "ask for --cells-run programs")
}

fn check_program(typed: &ProgramArgs, machine: &MachineArgs, program: &ArrayProgram) -> Result<(), InputError> {
    if program.groups == 1 {
        let flag = [("--partition", typed.partition.is_some())];
        refuse(&flag, "cuts the scene into sub-volumes, and one group has them all", "ask for several --groups")?;
    }
    if program.placement().slabs.is_none() {
        let slabs = kernels(machine).into_iter().filter(|(name, _)| name.starts_with("--slabs")).collect::<Vec<_>>();
        let why = format!("is about slabs, which the program '{}' goes without", program.name);
        refuse(&slabs, &why, "leave it out, or take a program with slabs")?;
    }
    Ok(())
}

/// Slices matter to spheres and cones, so not to every scene.
fn check_resolution(scene: &str, resolution: Option<u32>) -> Result<(), InputError> {
    let of_polygons = if is_builtin(scene) {
        builtin::all().iter().any(|known| known.name == scene && known.default_resolution.is_none())
    } else {
        let extension = Path::new(scene).extension().map(|extension| extension.to_string_lossy().to_lowercase());
        matches!(extension.as_deref(), Some("obj" | "ply"))
    };
    let flag = [("--resolution", of_polygons && resolution.is_some())];
    refuse(&flag, "slices spheres and cones, and this scene is of polygons only", "leave it out")
}

fn refuse(flags: &[Flag], why: &str, help: &str) -> Result<(), InputError> {
    match flags.iter().find(|(_, typed)| *typed) {
        Some((flag, _)) => Err(InputError::new(format!("{flag} {why}")).help(help)),
        None => Ok(()),
    }
}

/// The flags of what joins the cells: all that computing does not depend on.
fn links(args: &MachineArgs) -> [Flag; 5] {
    [
        ("--word-bytes", args.word_bytes.is_some()),
        ("--fifo-words", args.fifo_words.is_some()),
        ("--link-mb-s", args.link_mb_s.is_some()),
        ("--rate-counts", args.rate_counts.is_some()),
        ("--latency-cycles", args.latency_cycles.is_some()),
    ]
}

/// The flags of the host's times.
fn host(args: &MachineArgs) -> [Flag; 2] {
    [("--host-ray-us", args.host_ray_us.is_some()), ("--host-hit-us", args.host_hit_us.is_some())]
}

/// The flags of the kernels' times.
fn kernels(args: &MachineArgs) -> [Flag; 6] {
    [
        ("--grid-start", args.grid_start.is_some()),
        ("--grid-voxel", args.grid_voxel.is_some()),
        ("--slabs-start", args.slabs_start.is_some()),
        ("--slabs-polygon", args.slabs_polygon.is_some()),
        ("--intersection-start", args.intersection_start.is_some()),
        ("--intersection-polygon", args.intersection_polygon.is_some()),
    ]
}
