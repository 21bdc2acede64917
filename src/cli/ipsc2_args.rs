//! What can be typed for an image on the iPSC/2.

use std::path::PathBuf;

use clap::Args;
use pcs_sim::machine::Ipsc2Options;
use pcs_sim::run::{
    CubeMode, CubeOptions, CubeRunOptions, KnownTime, LightOptions, RunSpec, SceneOptions, ShapeOptions,
};

use super::args::{Typed, VIEWS, ViewArgs};
use super::graphs::GraphArgs;

/// `pcs-sim ipsc2`.
#[derive(Debug, Args)]
pub struct Ipsc2Args {
    /// A built-in scene (`pcs-sim scenes` lists them) or a file: .ron, .obj, .ply, .nff. Or tasks that --tasks wrote, to be timed again
    /// without their scene: .tasks [default: teapot].
    #[arg(value_name = "SCENE")]
    pub scene: Option<String>,
    /// Repeat the image that a file describes: statistics, or their configuration. Flags beside it change that.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Where the image goes: .png, or .pfm for linear light in all its bits.
    #[arg(short, long, value_name = "FILE", help_heading = "Results")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub cube: CubeOptions,
    #[command(flatten)]
    pub shape: ShapeOptions,
    #[command(flatten)]
    pub light: LightOptions,
    #[command(flatten)]
    pub machine: Ipsc2Options,
    /// Write all statistics as JSON; - is standard output, which then has nothing else.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub stats: Option<PathBuf>,
    /// Print all statistics as JSON, and nothing else: short for --stats -.
    #[arg(long, help_heading = "Results", conflicts_with = "stats")]
    pub json: bool,
    /// Write the hits as CSV: ray, t, polygon, alpha, beta. Rays are numbered pixel by pixel, each one's tree by generations.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub hits: Option<PathBuf>,
    /// Write what the rays make the nodes do, to be timed again under another machine: .tasks.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub tasks: Option<PathBuf>,
    /// Replace result files that exist.
    #[arg(long, help_heading = "Results")]
    pub force: bool,
    /// Watch the nodes and their queues at work, on a terminal.
    #[arg(long, help_heading = VIEWS)]
    pub watch: bool,
    #[command(flatten)]
    pub graph: GraphArgs,
    #[command(flatten)]
    pub views: ViewArgs,
    /// Threads to use [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

impl Ipsc2Args {
    /// The scene, as a run without a command takes it if none is named.
    fn scene(&self) -> Option<String> {
        let standard = || self.config.is_none().then(|| RunSpec::STANDARD_SCENE.to_owned());
        self.scene.clone().or_else(standard)
    }

    /// What is asked of the image.
    pub fn options(&self, typed: &Typed) -> CubeRunOptions {
        let mut options = CubeRunOptions {
            scene: SceneOptions { scene: self.scene() },
            shape: self.shape.clone(),
            light: self.light.clone(),
            cube: self.cube.clone(),
            machine: self.machine.clone(),
        };
        options.retain(|name| name == "scene" || typed.has(name));
        options
    }
}

/// `pcs-sim model-ipsc2`.
#[derive(Debug, Args)]
pub struct ModelIpsc2Args {
    /// A built-in scene (`pcs-sim scenes` lists them) or a file: .ron, .obj, .ply, .nff, .cas.
    #[arg(value_name = "SCENE", required_unless_present = "config")]
    pub scene: Option<String>,
    /// Predict the image that a file describes: statistics, or their configuration. Flags beside it change that.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Predict and simulate nothing.
    #[arg(long)]
    pub predict_only: bool,
    #[command(flatten)]
    pub cube: CubeOptions,
    #[command(flatten)]
    pub shape: ShapeOptions,
    #[command(flatten)]
    pub light: LightOptions,
    #[command(flatten)]
    pub machine: Ipsc2Options,
    /// Write all quantities as JSON; - is standard output, which then has nothing else.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub stats: Option<PathBuf>,
    /// Print all quantities as JSON, and nothing else: short for --stats -.
    #[arg(long, help_heading = "Results", conflicts_with = "stats")]
    pub json: bool,
    /// Replace result files that exist.
    #[arg(long, help_heading = "Results")]
    pub force: bool,
    /// Threads to use [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

impl ModelIpsc2Args {
    /// What is asked of the image that is predicted.
    pub fn options(&self, typed: &Typed) -> CubeRunOptions {
        let mut options = CubeRunOptions {
            scene: SceneOptions { scene: self.scene.clone() },
            shape: self.shape.clone(),
            light: self.light.clone(),
            cube: self.cube.clone(),
            machine: self.machine.clone(),
        };
        options.retain(|name| typed.has(name));
        options
    }
}

/// `pcs-sim calibrate-ipsc2`.
#[derive(Debug, Args)]
pub struct CalibrateIpsc2Args {
    /// The scene whose times are known: a built-in one, or a file.
    #[arg(value_name = "SCENE")]
    pub scene: String,
    #[command(flatten)]
    pub shape: ShapeOptions,
    #[command(flatten)]
    pub light: LightOptions,
    /// Voxels of the grid for each polygon [default: 10].
    #[arg(long, value_name = "N")]
    pub grid_coefficient: Option<f64>,
    /// What it takes on one node, in seconds.
    #[arg(long, value_name = "SECONDS")]
    pub seconds: f64,
    /// How much of that is geometry, in percent.
    #[arg(long, value_name = "PERCENT", default_value_t = 80.0)]
    pub geometry: f64,
    /// What it takes on several nodes that share a memory: 2:3332,4:1700,...
    #[arg(long, value_name = "NODES:SECONDS", value_delimiter = ',')]
    pub times: Vec<KnownTime>,
    /// The machine file whose times are fitted [default: iPSC/2].
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// Where the new machine file goes [default: stdout].
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Replace a file that exists.
    #[arg(long)]
    pub force: bool,
    /// Threads to use [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

impl CalibrateIpsc2Args {
    /// The image that is fitted to.
    pub fn options(&self, typed: &Typed) -> CubeRunOptions {
        let mut options =
            CubeRunOptions { shape: self.shape.clone(), light: self.light.clone(), ..CubeRunOptions::default() };
        options.retain(|name| typed.has(name));
        options.scene.scene = Some(self.scene.clone());
        options.cube = CubeOptions {
            mode: Some(CubeMode::SharedMemory),
            grid_coefficient: self.grid_coefficient,
            machine: self.machine.clone(),
            ..CubeOptions::default()
        };
        options
    }
}
