//! What can be typed for runs, images, replays, sweeps, models, plots and comparisons, and what several commands have.

use std::ops::Range;
use std::path::PathBuf;

use clap::parser::ValueSource;
use clap::{ArgMatches, Args, ValueEnum};
use pcs_sim::host::color_table::Palette;
use pcs_sim::machine::{Cycles, MachineOptions};
use pcs_sim::report::plot::Format;
use pcs_sim::run::{
    CellsOptions, HostOptions, LightOptions, MachineFileOptions, ProgramOptions, RayOptions, RecordingMemory,
    RunOptions, SceneOptions, SendingOptions, ShapeOptions,
};
use pcs_sim::seam::activity_trace::Form;

use super::engine_args::{EngineArgs, ShardsCommand};
use super::graphs::GraphArgs;

/// The heading of flags that are about no part of a run: that of `--help`.
pub const GENERAL: Option<&str> = None;

pub const VIEWS: &str = "Views of the run over time";

/// What can be asked of a run of primary rays.
#[derive(Clone, Debug, Args)]
pub struct Asked {
    #[command(flatten)]
    pub program: ProgramOptions,
    #[command(flatten)]
    pub cells: CellsOptions,
    #[command(flatten)]
    pub scene: SceneOptions,
    #[command(flatten)]
    pub shape: ShapeOptions,
    #[command(flatten)]
    pub rays: RayOptions,
    #[command(flatten)]
    pub sending: SendingOptions,
    #[command(flatten)]
    pub machine_file: MachineFileOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
}

impl Asked {
    /// What of it was typed.
    pub fn options(&self, typed: &Typed) -> RunOptions {
        let mut options = RunOptions {
            scene: self.scene.clone(),
            shape: self.shape.clone(),
            rays: self.rays.clone(),
            sending: self.sending.clone(),
            program: self.program.clone(),
            cells: self.cells.clone(),
            machine_file: self.machine_file.clone(),
            machine: self.machine.clone(),
            ..RunOptions::default()
        };
        options.retain(|name| typed.has(name));
        options
    }
}

#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    pub asked: Asked,
    /// Repeat the run that a file describes: statistics, or their configuration. Flags beside it change that.
    #[arg(long, value_name = "FILE", help_heading = GENERAL)]
    pub config: Option<PathBuf>,
    #[command(flatten)]
    pub results: ResultArgs,
    #[command(flatten)]
    pub views: ViewArgs,
    /// Write a picture of the primary rays' hits as PNG.
    #[arg(long, value_name = "FILE", help_heading = "Results", conflicts_with = "rays")]
    pub image: Option<PathBuf>,
    #[command(flatten)]
    pub tracing: TracingArgs,
    #[command(flatten)]
    pub graph: GraphArgs,
}

impl ImageArgs {
    /// What is asked of the image.
    pub fn options(&self, typed: &Typed) -> RunOptions {
        let mut options = RunOptions {
            scene: SceneOptions { scene: self.scene.clone() },
            shape: self.shape.clone(),
            sending: self.sending.clone(),
            program: self.program.clone(),
            cells: self.cells.clone(),
            machine_file: self.machine_file.clone(),
            machine: self.machine.clone(),
            light: self.light.clone(),
            host: self.host.clone(),
            ..RunOptions::default()
        };
        options.retain(|name| typed.has(name));
        options
    }
}

impl ModelArgs {
    /// What is asked of the run that is predicted.
    pub fn options(&self, typed: &Typed) -> RunOptions {
        let mut options = RunOptions {
            scene: SceneOptions { scene: self.scene.clone() },
            shape: self.shape.clone(),
            rays: self.rays.clone(),
            sending: self.sending.clone(),
            program: self.program.clone(),
            machine_file: self.machine_file.clone(),
            machine: self.machine.clone(),
            ..RunOptions::default()
        };
        options.retain(|name| typed.has(name));
        options
    }
}

impl ReplayArgs {
    /// What is asked of the machine.
    pub fn options(&self) -> RunOptions {
        let (machine_file, machine) = (self.machine_file.clone(), self.machine.clone());
        RunOptions { machine_file, machine, ..RunOptions::default() }
    }
}

/// Which of the arguments were typed; the others have their default.
pub struct Typed<'a>(pub &'a ArgMatches);

impl Typed<'_> {
    /// Whether an argument was.
    pub fn has(&self, name: &str) -> bool {
        let known = self.0.try_contains_id(name).is_ok();
        known && self.0.value_source(name) == Some(ValueSource::CommandLine)
    }
}

/// `pcs-sim image`.
#[derive(Debug, Args)]
pub struct ImageArgs {
    /// A built-in scene (`pcs-sim scenes` lists them) or a file: .ron, .obj, .ply, .nff, .cas.
    #[arg(value_name = "SCENE", required_unless_present = "config")]
    pub scene: Option<String>,
    /// Repeat the image that a file describes: statistics, or their configuration. Flags beside it change that.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Where the image goes: .png, or .pfm for linear light in all its bits.
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    pub output: PathBuf,
    /// Write a PNG of at most so many colours, with a table of them if they are no more than 256, and tell how far they are off.
    #[arg(long, value_name = "N", help_heading = "Results", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub colors: Option<u32>,
    /// How these colours are chosen.
    #[arg(long, value_enum, default_value_t = Palette::Peano, help_heading = "Results", requires = "colors")]
    pub palette: Palette,
    /// Tell how far the image is off from another one, such as one of many samples.
    #[arg(long, value_name = "FILE.pfm", help_heading = "Results")]
    pub against: Option<PathBuf>,
    /// Write which pixels adaptive sampling gave more samples, as a PNG in black and white.
    #[arg(long, value_name = "FILE.png", help_heading = "Results")]
    pub refined: Option<PathBuf>,
    /// Draw the rectangles of --screen-rectangles on the image.
    #[arg(long, help_heading = "Results")]
    pub show_rectangles: bool,
    /// First trace all rays with and without --rules, and make no image if a bit of any hit differs.
    #[arg(long, help_heading = "Results")]
    pub check_rules: bool,
    #[command(flatten)]
    pub shape: ShapeOptions,
    #[command(flatten)]
    pub sending: SendingOptions,
    #[command(flatten)]
    pub light: LightOptions,
    #[command(flatten)]
    pub host: HostOptions,
    #[command(flatten)]
    pub program: ProgramOptions,
    #[command(flatten)]
    pub cells: CellsOptions,
    #[command(flatten)]
    pub machine_file: MachineFileOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    #[command(flatten)]
    pub results: ResultArgs,
    #[command(flatten)]
    pub tracing: TracingArgs,
    #[command(flatten)]
    pub graph: GraphArgs,
    #[command(flatten)]
    pub views: ViewArgs,
    #[command(flatten)]
    pub engine: EngineArgs,
}

/// What goes with rays that are traced, whether they are primary ones alone or a whole image's.
#[derive(Clone, Debug, Args)]
pub struct TracingArgs {
    /// Write the hits as CSV: ray, t, polygon, alpha, beta. Primary rays are numbered as their pixels are, a whole image's as the
    /// host sends them.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub hits: Option<PathBuf>,
    /// Write what the host and every cell did for every ray, for `pcs-sim replay`.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub ops: Option<PathBuf>,
    /// What that file counts work in: units, which any machine prices, or the cycles of this one (priced).
    #[arg(long, value_name = "FORM", value_enum, default_value_t = OpsForm::Units, help_heading = "Results", requires = "ops")]
    pub ops_form: OpsForm,
    /// Threads to use [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", help_heading = GENERAL, value_parser = clap::value_parser!(u16).range(1..))]
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

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Results")]
pub struct ResultArgs {
    /// Write all statistics as JSON; - is standard output, which then has nothing else.
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
    /// Print all statistics as JSON, and nothing else: short for --stats -.
    #[arg(long, conflicts_with = "stats")]
    pub json: bool,
    /// Replace result files that exist.
    #[arg(long)]
    pub force: bool,
    /// Watch the cells and the FIFOs at work, on a terminal.
    #[arg(long, help_heading = VIEWS)]
    pub watch: bool,
}

#[derive(Debug, Args)]
pub struct ReplayArgs {
    /// The trace, as --ops wrote it; - is standard input.
    #[arg(value_name = "OPS", required_unless_present = "config")]
    pub ops: Option<PathBuf>,
    /// Repeat the replay that a file describes: statistics, or their configuration. Flags beside it change that.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    #[command(flatten)]
    pub machine_file: MachineFileOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    #[command(flatten)]
    pub results: ResultArgs,
    #[command(flatten)]
    pub views: ViewArgs,
}

/// What pictures are written as.
#[derive(Clone, Debug, Args)]
pub struct PlotFormats {
    /// What the pictures are written as.
    #[arg(long, value_name = "FORMAT,...", value_enum, value_delimiter = ',', default_values_t = [Format::Svg, Format::Png])]
    pub plot_format: Vec<Format>,
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = VIEWS)]
pub struct ViewArgs {
    #[command(flatten)]
    pub formats: PlotFormats,
    /// Draw the run as SVG and PNG: FIFO levels and histograms, cell states, rays on their way and done, latencies.
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
    /// Write a page (HTML) to look at the run in a browser: the array, and charts to zoom into.
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// Write the run cycle by cycle for a viewer: .pftrace for Perfetto, .vcd or .fst for GTKWave and Surfer, with a save file for
    /// GTKWave beside it (.gtkw).
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// The cycles to trace, and those that a page and plots show one by one, from A to before B; either may be left out
    /// [default: from 0 on, as many as viewers open with ease].
    #[arg(long, value_name = "A..B", value_parser = window)]
    pub trace_window: Option<Range<Cycles>>,
    /// Tell why the run took as long: its critical path, and what faster parts would save. In --stats, --plot and --page too.
    #[arg(long)]
    pub why: bool,
    /// Tell of each FIFO the depth from which nothing changes any more, beside what it holds. In --stats and --page too.
    #[arg(long)]
    pub enough: bool,
}

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct SweepArgs {
    #[command(subcommand)]
    pub shards: Option<ShardsCommand>,
    /// The sweep: a value, a list or a range for any of a run's parameters.
    #[arg(value_name = "SWEEP.ron", required = true)]
    pub sweep: Option<PathBuf>,
    /// The table: FILE.csv, and the same as FILE.parquet. It grows as points finish. A sweep that was stopped goes on
    /// where FILE.journal says; one that is done is not run again.
    #[arg(short = 'o', long, value_name = "FILE", required_unless_present = "count")]
    pub table: Option<PathBuf>,
    /// Tell how many points the sweep has, and run none.
    #[arg(long, conflicts_with_all = ["table", "plot", "force", "watch", "accept_failures", "threads", "recording_memory"])]
    pub count: bool,
    /// Draw one column over another, with a line for each value of a third: x=cells y=rays_per_second by=mode, and all else that
    /// `pcs-sim plot` takes.
    ///
    /// The plot lies beside the table. May be given several times, x= first.
    #[arg(long, num_args = 2.., value_name = "WORD=VALUE")]
    pub plot: Vec<String>,
    #[command(flatten)]
    pub formats: PlotFormats,
    /// Replace plots that exist, and the table and journal of another sweep.
    #[arg(long)]
    pub force: bool,
    /// Take a table in which points failed for a success: exit status 0.
    #[arg(long)]
    pub accept_failures: bool,
    /// Watch the points come in, on a terminal.
    #[arg(long)]
    pub watch: bool,
    /// Threads to use [default: all cores; one a shard, past one machine]. The results do not depend on it.
    #[arg(long, value_name = "N", help_heading = GENERAL, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// The memory that a recording may take, which points share, such as 8GB [default: half of what is free, by the share of
    /// the cores that are used]. Points of a larger one are timed while its rays are traced. The results do not depend on it.
    #[arg(long, value_name = "SIZE")]
    pub recording_memory: Option<RecordingMemory>,
    #[command(flatten)]
    pub engine: EngineArgs,
}

/// `pcs-sim model`.
#[derive(Debug, Args)]
pub struct ModelArgs {
    /// A built-in scene (`pcs-sim scenes` lists them) or a file: .ron, .obj, .ply, .nff, .cas.
    #[arg(value_name = "SCENE", required_unless_present = "config")]
    pub scene: Option<String>,
    /// Predict the run that a file describes: statistics, or their configuration. Flags beside it change that.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Predict and simulate nothing: seconds where the simulation may take minutes.
    #[arg(long)]
    pub predict_only: bool,
    #[command(flatten)]
    pub program: ProgramOptions,
    #[command(flatten)]
    pub shape: ShapeOptions,
    #[command(flatten)]
    pub rays: RayOptions,
    #[command(flatten)]
    pub sending: SendingOptions,
    #[command(flatten)]
    pub machine_file: MachineFileOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
    #[command(flatten)]
    pub results: ResultArgs,
    /// Threads to use [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", help_heading = GENERAL, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct PlotArgs {
    /// A table: CSV with a heading, or Parquet, such as a sweep's.
    #[arg(value_name = "TABLE")]
    pub table: PathBuf,
    /// What to draw: x=COLUMN y=COLUMN, a line for each value of by=COLUMN, a panel for each of facet=COLUMN; COLUMN=VALUE takes
    /// just the rows with that value.
    ///
    /// log=y (x, xy, none) makes axes logarithmic or not; relative=first divides each line by its first point, relative=LINE all
    /// by that line; cm=16x10 is the size. No point is an average: where rows that differ come to the same place, one column
    /// that tells them apart gets lines of its own, or it is said what to choose.
    #[arg(required = true, value_name = "WORD=VALUE", num_args = 2..)]
    pub columns: Vec<String>,
    /// The picture's name, without the ending.
    #[arg(short, long, value_name = "NAME")]
    pub output: PathBuf,
    /// What the picture shows, in a line above it [default: the parameters in the table].
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    #[command(flatten)]
    pub formats: PlotFormats,
    /// Replace pictures that exist.
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct ScenesArgs {
    /// A built-in scene, or a file; without one, all built-in scenes are listed.
    #[arg(value_name = "SCENE")]
    pub scene: Option<String>,
    /// Write the scene's polygons, as the array gets them, as PLY.
    #[arg(long, value_name = "FILE.ply", requires = "scene")]
    pub export: Option<PathBuf>,
    /// Size factor of the scene.
    #[arg(long, value_name = "N", requires = "scene")]
    pub size_factor: Option<u32>,
    /// Slices of spheres and cones.
    #[arg(long, value_name = "N", requires = "scene")]
    pub resolution: Option<u32>,
    /// Replace a file that exists.
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct ManArgs {
    /// The folder that they are written to: pcs-sim.1, pcs-sim-image.1, ...
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Replace pages that exist.
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct CompareArgs {
    /// The statistics of one run; - is standard input.
    #[arg(value_name = "A.json")]
    pub a: PathBuf,
    /// The statistics of another.
    #[arg(value_name = "B.json")]
    pub b: PathBuf,
    /// Tell of every value that differs, below the ten lines that matter most.
    #[arg(long)]
    pub all: bool,
    /// Print the values that differ as CSV, and nothing else.
    #[arg(long, conflicts_with_all = ["all", "json"])]
    pub csv: bool,
    /// Print them as JSON, and nothing else.
    #[arg(long, conflicts_with = "all")]
    pub json: bool,
    /// Do both runs again, and write a page (HTML) on which they have one axis of time.
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// Replace a page that exists.
    #[arg(long, requires = "page")]
    pub force: bool,
    /// Threads to use for the page [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", requires = "page", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
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
