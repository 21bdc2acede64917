//! What can be typed for a farm.

use std::path::PathBuf;

use clap::Args;
use pcs_sim::machine::CapitanOptions;
use pcs_sim::run::{FarmOptions, FarmRunOptions, LightOptions, SceneOptions, ShapeOptions};

use super::args::{GENERAL, Typed, ViewArgs};

/// `pcs-sim farm`.
#[derive(Debug, Args)]
pub struct FarmArgs {
    /// A built-in scene (`pcs-sim scenes` lists them), a file (.ron, .obj, .ply, .nff), or rectangles: a made-up scene.
    #[arg(value_name = "SCENE", required_unless_present = "config")]
    pub scene: Option<String>,
    /// Repeat the farm that a file describes: statistics, or their configuration. Flags beside it change that.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    #[command(flatten)]
    pub farm: FarmOptions,
    #[command(flatten)]
    pub shape: ShapeOptions,
    #[command(flatten)]
    pub light: LightOptions,
    #[command(flatten)]
    pub machine: CapitanOptions,
    /// Write all statistics as JSON; - is standard output, which then has nothing else.
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    pub stats: Option<PathBuf>,
    /// Print all statistics as JSON, and nothing else: short for --stats -.
    #[arg(long, help_heading = "Results", conflicts_with = "stats")]
    pub json: bool,
    /// Replace result files that exist.
    #[arg(long, help_heading = "Results")]
    pub force: bool,
    #[command(flatten)]
    pub views: ViewArgs,
    /// Threads to use [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", help_heading = GENERAL, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

impl FarmArgs {
    /// What is asked of the farm.
    pub fn options(&self, typed: &Typed) -> FarmRunOptions {
        let mut options = FarmRunOptions {
            scene: SceneOptions { scene: self.scene.clone() },
            shape: self.shape.clone(),
            light: self.light.clone(),
            farm: self.farm.clone(),
            machine: self.machine.clone(),
        };
        options.retain(|name| typed.has(name));
        options
    }
}
