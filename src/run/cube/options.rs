//! What can be asked of an image on a hypercube.

use std::path::PathBuf;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::InputError;
use crate::host::rules::Rules;
use crate::machine::Ipsc2Options;
use crate::parameters::{ParameterInfo, parameters};
use crate::run::options::choice;
use crate::run::{LightOptions, SceneOptions, ShapeOptions};

parameters! {
    /// An image on a hypercube, and how its work is shared.
    pub struct CubeOptions under "Hypercube" {
        /// How the nodes share the scene: each has a region and rays are sent (regions), or all have it together and trace whole
        /// pixels (shared-memory) [default: regions].
        mode: CubeMode, "MODE", Text, "mode";
        /// Voxels of the grid for each polygon [default: 10].
        grid_coefficient: f64, "N", Number, "grid coefficient (voxels a polygon)";
        /// Share of the pixels on which the regions' work is measured before the run, in percent [default: 1.5].
        sub_sample: Percent, "PERCENT", Number, "pixels of the sub-sample (%)";
        /// Cells along each side of the plane from which regions are made [default: 64].
        #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u32).range(1..=128)))]
        cell_grid: u32, "N", Whole, "cells along a side";
        /// How cells are cut: of equal width (equal), so that each row and column has an equal part of the work (quantiles), or as
        /// pyramids from the eye, in which its rays stay (pyramids) [default: equal].
        cell_cuts: CellCuts, "HOW", Text, "cuts of the cells";
        /// Whose grid a node walks through: the part of the scene's one grid that is in its region, or one of its own that fits its
        /// polygons [default: one].
        grids: Grids, "WHOSE", Text, "grids";
        /// Which region is on which node: in Gray's order, or with pairs swapped while rays pass fewer links [default: swapped].
        mapping: Mapping, "HOW", Text, "mapping";
        /// How rays find room in queues: unlimited, block (the sender waits), window (few pixels under way) or classes (slots by
        /// rank, which never gets stuck) [default: classes].
        flow: FlowKind, "HOW", Text, "flow control";
        /// Rays for which a node has slots, where these are limited, or `memory`: as many as the fullest node has memory for
        /// [default: 4096].
        queue_rays: QueueRays, "N|memory", WholeOrWord, "slots of a node (rays)";
        /// How a node knows that another has a slot for a ray: for nothing (known), or by asking it and being answered before each ray
        /// (handshake) [default: known].
        grant: Grant, "HOW", Text, "granting of slots";
        /// Pixels that a node has under way at the most, with --flow window [default: 64].
        #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u32).range(1..=1 << 30)))]
        window: u32, "N", Whole, "pixels under way on a node";
        /// How it is found out that all is done: by credit, or by a token that goes round [default: credit].
        termination: Termination, "HOW", Text, "termination";
        /// In which order a node begins its pixels: line by line, or spread over the image [default: scan].
        pixel_order: PixelOrder, "ORDER", Text, "order of the pixels";
        /// What a node does first: work on rays, or begin its pixels [default: rays].
        first: First, "WHAT", Text, "what is done first";
        /// Who begins a pixel: the node whose region its ray enters first (owner), or pixel p node p mod N (shared)
        /// [default: owner].
        pixels: PixelsOf, "HOW", Text, "who begins a pixel";
        /// How nodes with a shared memory share the pixels: line y is node y mod N's, or each asks the host for tiles of 8 x 8
        /// [default: lines].
        distribution: Distribution, "HOW", Text, "distribution of the pixels";
        /// Bytes of a page of the shared memory [default: 1024].
        #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u32).range(64..=1 << 20)))]
        page_bytes: u32, "N", Whole, "page of the shared memory (bytes)";
        /// What spares tests and rays without changing a bit of any hit: rays name the polygon that they start on, which is not tested
        /// (own); shadow rays are not sent that start outside the cones of shadow of all objects (a4b), or inside that of a large
        /// polygon (a4c); several as in own+a4b; none [default: none].
        rules: Rules, "RULES", Text, "rules that spare tests and rays";
        /// A machine file of your own; the flags below change it further [default: iPSC/2].
        #[cfg_attr(feature = "cli", arg(help_heading = "Machine"))]
        machine: PathBuf, "FILE", File, "machine";
    }
}

/// Declares what can be chosen, by the names that are typed.
macro_rules! choices {
    ($($(#[$meta:meta])* $Type:ident { $($(#[$value_meta:meta])* $Value:ident = $name:literal),* $(,)? })*) => {$(
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        #[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
        pub enum $Type { $($(#[$value_meta])* $Value),* }

        choice!($Type: $($name is $Value),*);

        impl $Type {
            /// Its name.
            pub fn name(self) -> &'static str {
                match self { $($Type::$Value => $name),* }
            }
        }
    )*};
}

choices! {
    /// How nodes share a scene.
    CubeMode {
        /// Each has a region; rays are sent.
        #[default]
        Regions = "regions",
        /// All have it together, as the pages of a memory.
        SharedMemory = "shared-memory",
    }
    /// Which region is on which node.
    Mapping {
        /// In Gray's order.
        Gray = "gray",
        /// With pairs swapped from there on.
        #[default]
        Swapped = "swapped",
    }
    /// How cells are cut.
    CellCuts {
        /// All as wide.
        #[default]
        Equal = "equal",
        /// With an equal part of the work in each row and column.
        Quantiles = "quantiles",
        /// On the screen.
        Pyramids = "pyramids",
    }
    /// Whose grid a node walks through.
    Grids {
        /// Its part of the scene's.
        #[default]
        One = "one",
        /// Its own, which fits its polygons.
        Own = "own",
    }
    /// How a node knows that another has a slot.
    Grant {
        /// For nothing.
        #[default]
        Known = "known",
        /// By asking, and being answered.
        Handshake = "handshake",
    }
    /// How nodes with a shared memory share the pixels.
    Distribution {
        /// Line y is node y mod N's.
        #[default]
        Lines = "lines",
        /// Each asks the host for tiles.
        Tiles = "tiles",
    }
    /// How rays find room in queues.
    FlowKind {
        /// A queue takes all.
        Unlimited = "unlimited",
        /// The sender waits.
        Block = "block",
        /// Few pixels are under way.
        Window = "window",
        /// Slots are given by rank.
        #[default]
        Classes = "classes",
    }
    /// How it is found out that all is done.
    Termination {
        /// By credit.
        #[default]
        Credit = "credit",
        /// By a token.
        Token = "token",
    }
    /// In which order a node begins its pixels.
    PixelOrder {
        /// Line by line.
        #[default]
        Scan = "scan",
        /// Spread over the image: by their numbers with the bits from last to first.
        Strided = "strided",
    }
    /// What a node does first.
    First {
        /// Works on rays.
        #[default]
        Rays = "rays",
        /// Begins pixels.
        Pixels = "pixels",
    }
    /// Who begins a pixel.
    PixelsOf {
        /// The node whose region its ray enters first.
        #[default]
        Owner = "owner",
        /// Pixel p node p mod N.
        Shared = "shared",
    }
}

/// A share in percent: `1.5` or `1.5%`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Percent(pub f64);

impl FromStr for Percent {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Percent, &'static str> {
        let number = text.strip_suffix('%').unwrap_or(text).trim_end();
        let is_share = |value: &f64| *value > 0.0 && *value <= 100.0;
        number.parse().ok().filter(is_share).map(Percent).ok_or("expected a share of more than 0 and up to 100 percent")
    }
}

/// How many rays a node has slots for: `256`, or `memory`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum QueueRays {
    /// For as many as the fullest node has memory for.
    #[serde(rename = "memory")]
    Memory,
    /// For so many.
    #[serde(untagged)]
    Count(u32),
}

impl FromStr for QueueRays {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<QueueRays, &'static str> {
        match text {
            "memory" => Ok(QueueRays::Memory),
            _ => text.parse().map(QueueRays::Count).ok().filter(QueueRays::is_possible).ok_or(QueueRays::EXPECTED),
        }
    }
}

impl QueueRays {
    /// What it must be.
    pub const EXPECTED: &str = "expected a number of rays from 1 to 1073741824, or memory";

    /// Whether there can be such a queue.
    pub fn is_possible(&self) -> bool {
        !matches!(self, QueueRays::Count(count) if !(1..=1 << 30).contains(count))
    }
}

/// All that can be asked of an image on a hypercube, each by a name. What is left out is as the machine file has it, or by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CubeRunOptions {
    /// The scene.
    pub scene: SceneOptions,
    /// How large it is.
    pub shape: ShapeOptions,
    /// The light.
    pub light: LightOptions,
    /// How its work is shared.
    pub cube: CubeOptions,
    /// Changes to the machine.
    pub machine: Ipsc2Options,
}

impl CubeRunOptions {
    /// All parameters, in the order of tables.
    pub fn parameters() -> impl Iterator<Item = &'static ParameterInfo> {
        let groups = [
            SceneOptions::PARAMETERS,
            ShapeOptions::PARAMETERS,
            LightOptions::PARAMETERS,
            CubeOptions::PARAMETERS,
            Ipsc2Options::PARAMETERS,
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
            || self.cube.set(name, text)?
            || self.machine.set(name, text)?;
        if known { Ok(()) } else { Err(InputError::new(format!("an image on a hypercube has no parameter '{name}'"))) }
    }

    /// Takes back the parameters that are not to be kept.
    pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        self.scene.retain(&keep);
        self.shape.retain(&keep);
        self.light.retain(&keep);
        self.cube.retain(&keep);
        self.machine.retain(&keep);
    }

    /// Whether a parameter was given.
    pub fn has(&self, name: &str) -> bool {
        self.scene.has(name)
            || self.shape.has(name)
            || self.light.has(name)
            || self.cube.has(name)
            || self.machine.has(name)
    }
}
