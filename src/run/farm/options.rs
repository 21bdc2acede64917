//! What can be asked of a farm.

use std::path::PathBuf;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::InputError;
use crate::machine::CapitanOptions;
use crate::parameters::{ParameterInfo, parameters};
use crate::program::farm::{HandOut, ItemKind, SceneBy};
use crate::run::options::choice;
use crate::run::{LightOptions, SceneOptions, ShapeOptions};

parameters! {
    /// A farm, and how it shares its work.
    pub struct FarmOptions under "Farm" {
        /// Workers, or from how many to how many, as in 1..8 [default: as many as there are processors for].
        tasks: TaskRange, "N|A..B", Whole, "workers";
        /// What the master hands out: runs of pixels with the same part of the scene, lines, pixels or tiles
        /// [default: segments].
        items: ItemKind, "WHAT", Text, "work items";
        /// Side of a tile, in pixels [default: 8].
        #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u32).range(1..)))]
        tile: u32, "N", Whole, "side of a tile (pixels)";
        /// How work items come to the workers: to the one that asks, or dealt beforehand [default: request].
        hand_out: HandOut, "HOW", Text, "handing out";
        /// How the scene comes to the tasks: a copy for each, or one broadcast [default: copies].
        scene_by: SceneBy, "HOW", Text, "the scene comes by";
        /// Number of rectangles of the made-up scene [default: 16].
        rectangles: u32, "N", Whole, "rectangles of the made-up scene";
        /// What the made-up scene depends on [default: 57].
        seed: u64, "N", Whole, "seed of the made-up scene";
        /// Voxels of the grid for each polygon [default: 50].
        grid_coefficient: f64, "N", Number, "grid coefficient (voxels a polygon)";
        /// A machine file of your own; the flags below change it further [default: CAPITAN].
        #[cfg_attr(feature = "cli", arg(help_heading = "Machine"))]
        machine: PathBuf, "FILE", File, "machine";
    }
}

choice!(ItemKind: "segments" is Segments, "lines" is Lines, "pixels" is Pixels, "tiles" is Tiles);
choice!(HandOut: "request" is Request, "dealt" is Dealt);
choice!(SceneBy: "copies" is Copies, "broadcast" is Broadcast);

/// Numbers of workers, from one to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TaskRange {
    /// The fewest.
    pub first: usize,
    /// The most.
    pub last: usize,
}

impl FromStr for TaskRange {
    type Err = &'static str;

    /// `8`, or `1..8`.
    fn from_str(text: &str) -> Result<TaskRange, &'static str> {
        let (first, last) = text.split_once("..").unwrap_or((text, text));
        let count =
            |text: &str| text.parse::<usize>().map_err(|_| "expected a number of workers, or a range as in 1..8");
        let range = TaskRange { first: count(first)?, last: count(last)? };
        match range {
            TaskRange { first: 0, .. } => Err("there must be at least 1 worker"),
            TaskRange { first, last } if first > last => Err("the range has no number in it"),
            _ => Ok(range),
        }
    }
}

/// All that can be asked of a farm, each by a name. What is left out is as the machine file has it, or by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FarmRunOptions {
    /// The scene.
    pub scene: SceneOptions,
    /// How large it is.
    pub shape: ShapeOptions,
    /// The light in a scene of polygons.
    pub light: LightOptions,
    /// The farm.
    pub farm: FarmOptions,
    /// Changes to the machine.
    pub machine: CapitanOptions,
}

impl FarmRunOptions {
    /// All parameters, in the order of tables.
    pub fn parameters() -> impl Iterator<Item = &'static ParameterInfo> {
        let groups = [
            SceneOptions::PARAMETERS,
            ShapeOptions::PARAMETERS,
            LightOptions::PARAMETERS,
            FarmOptions::PARAMETERS,
            CapitanOptions::PARAMETERS,
        ];
        groups.into_iter().flatten()
    }

    /// Gives a parameter the value that a text stands for.
    ///
    /// Fails if there is no such parameter, or if the text is no such value.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), InputError> {
        let known = self.scene.set(name, text)?
            || self.shape.set(name, text)?
            || self.light.set(name, text)?
            || self.farm.set(name, text)?
            || self.machine.set(name, text)?;
        if known { Ok(()) } else { Err(InputError::new(format!("a farm has no parameter '{name}'"))) }
    }

    /// Takes back the parameters that are not to be kept.
    pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        self.scene.retain(&keep);
        self.shape.retain(&keep);
        self.light.retain(&keep);
        self.farm.retain(&keep);
        self.machine.retain(&keep);
    }

    /// Whether a parameter was given.
    pub fn has(&self, name: &str) -> bool {
        self.scene.has(name)
            || self.shape.has(name)
            || self.light.has(name)
            || self.farm.has(name)
            || self.machine.has(name)
    }
}
