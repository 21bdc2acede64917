//! What can be typed.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use pcs_sim::geometry::Partition;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::machine::{Cycles, RateCounts};
use pcs_sim::seam::activity_trace::Form;

use super::cell_args::{AsmArgs, CalibrateArgs, DisasmArgs, Figure7Args, StepArgs};

/// Simulates ray tracing on a linear array of PCS processors (INRIA RR-0992, 1989), exact to the cycle.
///
/// Without a command it traces a scene: `pcs-sim --mode broadcast --cells 8 --scene reference`.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub run: RunArgs,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Makes a whole image: the host shades the hits and sends shadow, reflected and refracted rays.
    Image(Box<ImageArgs>),
    /// Times a recorded activity trace again, under any machine, without its scene.
    Replay(Box<ReplayArgs>),
    /// Runs every combination of parameters that a file lists, and writes one table.
    Sweep(SweepArgs),
    /// Predicts a run by the paper's cost model, and tells how far off the prediction is.
    Model(Box<ModelArgs>),
    /// Draws one column of a table over another.
    Plot(PlotArgs),
    /// Tells in what two statistics files differ, and by how much.
    Compare(CompareArgs),
    /// Measures Figure 7's six numbers on both kinds of cell, and holds them against the paper.
    Figure7(Figure7Args),
    /// Fits what instructions cost to Figure 7, and writes a machine file.
    Calibrate(CalibrateArgs),
    /// Assembles a cell's program to an object file, and lists it with its cycles.
    Asm(AsmArgs),
    /// Turns an object file back into source text.
    Disasm(DisasmArgs),
    /// Runs a cell's program step by step, on words of your own.
    Step(StepArgs),
    /// Lists the built-in scenes.
    Scenes,
}

#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub program: ProgramArgs,
    #[command(flatten)]
    pub cells: CellArgs,
    #[command(flatten)]
    pub scene: SceneArgs,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub results: ResultArgs,
    #[command(flatten)]
    pub views: ViewArgs,
    /// Write a picture of the primary rays' hits as PNG.
    #[arg(long, value_name = "FILE", help_heading = "Results", conflicts_with = "rays")]
    pub image: Option<PathBuf>,
    #[command(flatten)]
    pub tracing: TracingArgs,
}

/// `pcs-sim image`.
#[derive(Debug, Args)]
pub struct ImageArgs {
    /// A built-in scene (`pcs-sim scenes` lists them) or a file: .ron, .obj, .ply, .nff.
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Where the image goes: .png, or .pfm for linear light in all its bits.
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    pub output: PathBuf,
    #[command(flatten)]
    pub shape: ShapeArgs,
    #[command(flatten)]
    pub light: LightArgs,
    #[command(flatten)]
    pub host: HostArgs,
    #[command(flatten)]
    pub program: ProgramArgs,
    #[command(flatten)]
    pub cells: CellArgs,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub results: ResultArgs,
    #[command(flatten)]
    pub tracing: TracingArgs,
    #[command(flatten)]
    pub views: ViewArgs,
}

/// What goes with rays that are traced, whether they are primary ones alone or a whole image's.
#[derive(Clone, Debug, Args)]
pub struct TracingArgs {
    /// Write the hits as CSV, in the order in which the host sends the rays: ray, t, polygon, alpha, beta.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub hits: Option<PathBuf>,
    /// Write what the host and every cell did for every ray, for `pcs-sim replay`.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub ops: Option<PathBuf>,
    /// What that file counts work in: units, which any machine prices, or the cycles of this one (priced).
    #[arg(long, value_name = "FORM", value_enum, default_value_t = OpsForm::Units, help_heading = "Results", requires = "ops")]
    pub ops_form: OpsForm,
    /// Threads to use [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// What an activity trace counts work in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OpsForm {
    /// Units of work.
    Units,
    /// Cycles.
    Priced,
}

impl From<OpsForm> for Form {
    fn from(form: OpsForm) -> Form {
        match form {
            OpsForm::Units => Form::Units,
            OpsForm::Priced => Form::Cycles,
        }
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Light")]
pub struct LightArgs {
    /// Samples along each side of a pixel: N x N primary rays.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub samples: u32,
    /// One sample a pixel, and N x N only where a neighbour shows another object.
    #[arg(long)]
    pub adaptive: bool,
    /// How often light may be reflected or refracted on its way to the eye.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub depth: u8,
    /// Follow no reflected or refracted ray that adds less than this share to its pixel.
    #[arg(long, value_name = "SHARE", default_value_t = 1.0 / 256.0)]
    pub min_contribution: f64,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Host")]
pub struct HostArgs {
    /// Whether to time the array; without, there is just the image.
    #[arg(long, value_enum, default_value_t = Switch::On)]
    pub timing: Switch,
    /// What the host sends next when it can choose [default: secondaries].
    #[arg(long, value_enum)]
    pub policy: Option<PolicyName>,
    /// How many rays may be in the array at once [default: as many as it takes].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub in_flight: Option<u64>,
    /// How many samples the host may have begun and not done [default: 1024].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub open_samples: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    On,
    Off,
}

/// What the host sends next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PolicyName {
    /// Rays that a hit asked for before primary ones.
    Secondaries,
    /// Primary rays before all others.
    Primaries,
    /// The ray with the fewest rays between it and the eye.
    Generation,
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Array program")]
pub struct ProgramArgs {
    /// How the array works [default: pipeline].
    #[arg(long, value_enum)]
    pub mode: Option<Mode>,
    /// An array program of your own, or the name of a standard one (pipeline, broadcast, hybrid, hybrid-3).
    #[arg(long, value_name = "FILE", conflicts_with = "mode")]
    pub program: Option<PathBuf>,
    /// Number of cells: a multiple of the program's cells a group.
    #[arg(long, value_name = "N", conflicts_with = "groups")]
    pub cells: Option<usize>,
    /// Number of sub-volumes, each with a group of cells.
    #[arg(long, value_name = "G")]
    pub groups: Option<usize>,
    /// How the scene is cut into sub-volumes: regular, polygons (equally many each) or work (equal work each).
    #[arg(long, value_name = "HOW")]
    pub partition: Option<Partition>,
    /// Voxels of the grid for each polygon.
    #[arg(long, value_name = "N")]
    pub grid_coefficient: Option<f64>,
    /// Let the grid send no polygon twice for the same ray.
    #[arg(long)]
    pub mailbox: bool,
    /// Let the intersection's cell tell the grid's to stop, which walks up to W voxels ahead of its words.
    #[arg(long, value_name = "W")]
    pub stop_words: Option<u32>,
    /// Let each cell read and pass on K rays ahead of the one that it begins.
    #[arg(long, value_name = "K")]
    pub forward_ahead: Option<u32>,
}

/// How the cells work.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Cells")]
pub struct CellArgs {
    /// What a cell runs: timings, which are Figure 7's, or programs of instructions, which find the hits themselves
    /// [default: timings].
    #[arg(long, value_enum, value_name = "WHAT")]
    pub cells_run: Option<CellsRun>,
    /// A folder of programs for the cells (grid.pcs, broadcast.pcs, ...) in place of the standard ones.
    #[arg(long, value_name = "DIR")]
    pub cell_programs: Option<PathBuf>,
    /// The most instructions that a program may execute for one ray [default: 200000000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub instruction_limit: Option<u64>,
}

/// What a cell runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CellsRun {
    /// The times of the machine file.
    Timings,
    /// Programs of instructions.
    Programs,
}

/// The paper's two organisations of the array, and both together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// Macro-pipeline: grid, slabs and intersection, a cell each (§4.2).
    Pipeline,
    /// Parallel broadcast: every cell does all of the work on its part of the scene (§4.2).
    Broadcast,
    /// Broadcast to groups of two cells: filters, intersection (§5).
    Hybrid,
}

impl Mode {
    /// The name of the standard program.
    pub fn program(self) -> &'static str {
        match self {
            Mode::Pipeline => "pipeline",
            Mode::Broadcast => "broadcast",
            Mode::Hybrid => "hybrid",
        }
    }
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Scene and rays")]
pub struct SceneArgs {
    /// A built-in scene (`pcs-sim scenes` lists them) or a file: .ron, .obj, .ply, .nff.
    #[arg(long, value_name = "NAME|FILE", default_value = "teapot")]
    pub scene: String,
    #[command(flatten)]
    pub shape: ShapeArgs,
    /// Take the rays from a CSV file (ox,oy,oz,dx,dy,dz and optionally tmax) instead of the camera.
    #[arg(long, value_name = "FILE", conflicts_with = "size")]
    pub rays: Option<PathBuf>,
}

/// How large scene and image are.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Scene and rays")]
pub struct ShapeArgs {
    /// Size factor of a built-in scene.
    #[arg(long, value_name = "N")]
    pub size_factor: Option<u32>,
    /// Slices that spheres and cones are cut into.
    #[arg(long, value_name = "N")]
    pub resolution: Option<u32>,
    /// Size of the image, in pixels.
    #[arg(long, value_name = "WxH", default_value = "256x256", value_parser = image_size)]
    pub size: ImageSize,
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Machine")]
pub struct MachineArgs {
    /// A machine file of your own; the flags below change it further [default: PCS].
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// Length of a cycle, in ns.
    #[arg(long, value_name = "NS")]
    pub clock_ns: Option<f64>,
    /// Size of a word, in bytes.
    #[arg(long, value_name = "N")]
    pub word_bytes: Option<u32>,
    /// Words that each of a cell's two input FIFOs holds.
    #[arg(long, value_name = "N")]
    pub fifo_words: Option<u64>,
    /// Rate of a link, in 10^6 bytes a second.
    #[arg(long, value_name = "RATE")]
    pub link_mb_s: Option<f64>,
    /// Whether the rate counts both channels of a link together or each by itself: link or channel.
    #[arg(long, value_name = "WHAT", value_parser = rate_counts)]
    pub rate_counts: Option<RateCounts>,
    /// Cycles from the write of a word until it can be read.
    #[arg(long, value_name = "N")]
    pub latency_cycles: Option<u64>,
    /// Words of memory of a cell.
    #[arg(long, value_name = "N")]
    pub memory_words: Option<u64>,
    /// What the host spends on each ray before it sends it, in µs.
    #[arg(long, value_name = "US")]
    pub host_ray_us: Option<f64>,
    /// What the host spends on shading a hit, in µs.
    #[arg(long, value_name = "US")]
    pub host_hit_us: Option<f64>,
    /// Figure 7: the grid's start, in µs a ray.
    #[arg(long, value_name = "US")]
    pub grid_start: Option<f64>,
    /// Figure 7: the grid's work, in µs a voxel.
    #[arg(long, value_name = "US")]
    pub grid_voxel: Option<f64>,
    /// Figure 7: the slabs' start, in µs a ray.
    #[arg(long, value_name = "US")]
    pub slabs_start: Option<f64>,
    /// Figure 7: the slabs' work, in µs a polygon.
    #[arg(long, value_name = "US")]
    pub slabs_polygon: Option<f64>,
    /// Figure 7: the intersection's start, in µs a ray.
    #[arg(long, value_name = "US")]
    pub intersection_start: Option<f64>,
    /// Figure 7: the intersection's work, in µs a polygon.
    #[arg(long, value_name = "US")]
    pub intersection_polygon: Option<f64>,
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Results")]
pub struct ResultArgs {
    /// Write all statistics as JSON.
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
    /// Replace result files that exist.
    #[arg(long)]
    pub force: bool,
    /// Watch the cells and the FIFOs at work, on a terminal.
    #[arg(long, help_heading = "Options")]
    pub watch: bool,
}

#[derive(Debug, Args)]
pub struct ReplayArgs {
    /// The trace, as --ops wrote it.
    #[arg(value_name = "OPS")]
    pub ops: PathBuf,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub results: ResultArgs,
    #[command(flatten)]
    pub views: ViewArgs,
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Views of the run over time")]
pub struct ViewArgs {
    /// Draw the run as SVG and PNG: FIFO levels and histograms, cell states, rays done, latencies.
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
    /// Write a page (HTML) to look at the run in a browser: the array, and charts to zoom into.
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// Write the run cycle by cycle for a viewer: .pftrace for Perfetto, .vcd or .fst for GTKWave and Surfer.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// The cycles to trace, from A to before B; either may be left out [default: from 0 on, as many as viewers open with
    /// ease].
    #[arg(long, value_name = "A..B", requires = "trace", value_parser = window)]
    pub trace_window: Option<Range<Cycles>>,
}

#[derive(Debug, Args)]
pub struct SweepArgs {
    /// The sweep: a value, a list or a range for any of a run's parameters.
    #[arg(value_name = "SWEEP.ron")]
    pub sweep: PathBuf,
    /// The table: FILE.csv, and the same as FILE.parquet. It grows as points finish. A sweep that was stopped goes on
    /// where FILE.journal says; one that is done is not run again.
    #[arg(short = 'o', long, value_name = "FILE")]
    pub table: PathBuf,
    /// Draw one column over another, with a line for each value of a third: x=cells y=rays_per_second by=mode.
    ///
    /// The plot lies beside the table, as SVG and PNG. May be given several times, x= first.
    #[arg(long, num_args = 2..=3, value_names = ["x=COLUMN", "y=COLUMN", "by=COLUMN"])]
    pub plot: Vec<String>,
    /// Replace plots that exist, and the table and journal of another sweep.
    #[arg(long)]
    pub force: bool,
    /// Watch the points come in, on a terminal.
    #[arg(long)]
    pub watch: bool,
}

/// `pcs-sim model`.
#[derive(Debug, Args)]
pub struct ModelArgs {
    /// A built-in scene (`pcs-sim scenes` lists them) or a file: .ron, .obj, .ply, .nff.
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Predict and simulate nothing: seconds where the simulation may take minutes.
    #[arg(long)]
    pub predict_only: bool,
    #[command(flatten)]
    pub program: ProgramArgs,
    #[command(flatten)]
    pub shape: ShapeArgs,
    /// Take the rays from a CSV file (ox,oy,oz,dx,dy,dz and optionally tmax) instead of the camera.
    #[arg(long, value_name = "FILE", help_heading = "Scene and rays")]
    pub rays: Option<PathBuf>,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub results: ResultArgs,
    /// Threads to use [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct PlotArgs {
    /// A table: CSV with a heading, such as a sweep's.
    #[arg(value_name = "TABLE.csv")]
    pub table: PathBuf,
    /// The columns to draw, with a line for each value of the third. COLUMN=VALUE takes just the rows with that value.
    #[arg(required = true, value_names = ["x=COLUMN", "y=COLUMN", "by=COLUMN", "COLUMN=VALUE"], num_args = 2..)]
    pub columns: Vec<String>,
    /// The picture's name: NAME.svg and NAME.png.
    #[arg(short, long, value_name = "NAME")]
    pub output: PathBuf,
    /// What the picture shows, in a line above it.
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub title: String,
    /// Replace pictures that exist.
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The statistics of one run.
    #[arg(value_name = "A.json")]
    pub a: PathBuf,
    /// The statistics of another.
    #[arg(value_name = "B.json")]
    pub b: PathBuf,
}

/// The largest number of pixels: rays are numbered in 32 bits, and kept in memory.
const MOST_PIXELS: u64 = 1 << 26;

fn image_size(text: &str) -> Result<ImageSize, String> {
    let (width, height) = text.split_once(['x', 'X']).ok_or("expected a width and a height, as in 640x480")?;
    let side = |side: &str| side.parse::<u32>().ok().filter(|&n| n > 0).ok_or("width and height must be 1 or more");
    let size = ImageSize { width: side(width)?, height: side(height)? };
    if size.width as u64 * size.height as u64 > MOST_PIXELS {
        return Err(format!("an image can have at most {MOST_PIXELS} pixels"));
    }
    Ok(size)
}

fn window(text: &str) -> Result<Range<Cycles>, String> {
    let (from, until) = text.split_once("..").ok_or("expected two cycles, as in 2000..3000")?;
    let cycle = |cycle: &str, default: u64| match cycle {
        "" => Ok(Cycles(default)),
        _ => cycle.parse().map(Cycles).map_err(|_| format!("'{cycle}' is no number of a cycle")),
    };
    let window = cycle(from, 0)?..cycle(until, u64::MAX)?;
    if window.is_empty() { Err("it has no cycle: B must be larger than A".to_owned()) } else { Ok(window) }
}

fn rate_counts(text: &str) -> Result<RateCounts, String> {
    match text.to_ascii_lowercase().as_str() {
        "link" => Ok(RateCounts::Link),
        "channel" => Ok(RateCounts::Channel),
        _ => Err("expected link or channel".to_owned()),
    }
}
