//! What can be asked of a run: what is typed after a command, a sweep's point, and whatever else describes one by names.

use std::path::PathBuf;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::InputError;
use crate::geometry::{Edges, Numbering, Partition};
use crate::host::camera::ImageSize;
use crate::host::order::Order;
use crate::host::policy::Policy;
use crate::host::rules::Rules;
use crate::host::sampling::AdaptiveBy;
use crate::host::screen::ScreenRectangles;
use crate::machine::MachineOptions;
use crate::parameters::{ParameterInfo, parameters};
use crate::program::Masks;

parameters! {
    /// The scene.
    pub struct SceneOptions under "Scene and rays" {
        /// A built-in scene (`pcs-sim scenes` lists them) or a file: .ron, .obj, .ply, .nff.
        #[cfg_attr(feature = "cli", arg(default_value = "teapot"))]
        scene: String, "NAME|FILE", Text, "scene";
    }
}

parameters! {
    /// How large scene and image are.
    pub struct ShapeOptions under "Scene and rays" {
        /// Size factor of a built-in scene [default: the scene's; `pcs-sim scenes` tells it].
        size_factor: u32, "N", Whole, "size factor of the scene";
        /// Slices that spheres and cones are cut into [default: the scene's; 16 in scene files].
        resolution: u32, "N", Whole, "slices of spheres and cones";
        /// Size of the image, in pixels.
        #[cfg_attr(feature = "cli", arg(default_value = "256x256"))]
        size: ImageSize, "WxH", Size, "size of the image (pixels)";
    }
}

parameters! {
    /// The rays, if they are not a camera's.
    pub struct RayOptions under "Scene and rays" {
        /// Take the rays from a CSV file (ox,oy,oz,dx,dy,dz and optionally tmax) instead of the camera.
        #[cfg_attr(feature = "cli", arg(conflicts_with = "size"))]
        rays: PathBuf, "FILE", File, "rays";
    }
}

parameters! {
    /// Which rays are sent, and in which order.
    pub struct SendingOptions under "Scene and rays" {
        /// Send no rays through pixels that can show nothing: those outside all rectangles, of the whole scene or of each object
        /// (off, scene, objects) [default: off].
        screen_rectangles: ScreenRectangles, "OF", Text, "screen rectangles";
        /// In which order the host sends the rays, or begins the pixels: raster, columns, tiles:N (squares of N x N pixels),
        /// hilbert, stride, shuffle:SEED [default: raster].
        order: Order, "ORDER", Text, "order of the rays";
    }
}

parameters! {
    /// The array program, and changes to it.
    pub struct ProgramOptions under "Array program" {
        /// How the array works [default: pipeline].
        mode: Mode, "MODE", Text, "mode";
        /// An array program of your own, or the name of a standard one (pipeline, broadcast, hybrid, hybrid-3).
        #[cfg_attr(feature = "cli", arg(conflicts_with = "mode"))]
        program: PathBuf, "FILE", File, "array program";
        /// Number of cells: a multiple of the program's cells a group [default: the program's; 3 in pipeline, 8 in the others].
        #[cfg_attr(feature = "cli", arg(conflicts_with = "groups"))]
        cells: usize, "N", Whole, "cells";
        /// Number of sub-volumes, each with a group of cells [default: the program's; 1 in pipeline, 8 in broadcast, 4 in hybrid].
        groups: usize, "G", Whole, "groups of cells";
        /// How the scene is cut into sub-volumes: regular, polygons (equally many each), work (equal work each) or measured (work,
        /// measured in the parts and cut again) [default: the program's; regular in the standard ones].
        partition: Partition, "HOW", Text, "partition of the scene";
        /// Which sub-volume is which group's [default: the program's; cut in the standard ones].
        numbering: Numbering, "HOW", Text, "numbering of the groups";
        /// Voxels of the grid for each polygon [default: the program's; 50 in the standard ones].
        grid_coefficient: f64, "N", Number, "grid coefficient (voxels a polygon)";
        /// Let the grid send no polygon twice for the same ray.
        #[cfg_attr(feature = "cli", arg(action = clap::ArgAction::SetTrue))]
        mailbox: bool, "", Truth, "mailbox in the grid";
        /// Let the intersection's cell tell the grid's to stop, which walks up to W voxels ahead of its words
        /// [default: the program's; none in the standard ones].
        stop_words: u32, "W", Whole, "voxels ahead of the stop words";
        /// Let each cell read and pass on K rays ahead of the one that it begins [default: the program's; 0 in the standard ones].
        forward_ahead: u32, "K", Whole, "rays passed on ahead";
        /// Put N rays, and N hits, in a message, which a cell works on before it answers [default: the program's; 1 in the standard ones].
        rays_per_message: u32, "N", Whole, "rays in a message";
        /// Let each cell read the hit of the groups to its left before it begins a ray, and look for nothing behind it.
        #[cfg_attr(feature = "cli", arg(action = clap::ArgAction::SetTrue))]
        bounded_walk: bool, "", Truth, "walk bounded by the hit from the left";
        /// Let the host tell each ray which sub-volumes it can meet, whose cells alone start on it (not for cells that run programs): by
        /// their rectangles on the screen, for rays from the eye, or by their boxes [default: the program's; none in the standard ones].
        masks: Masks, "BY", Text, "masks of the sub-volumes";
    }
}

parameters! {
    /// How the cells work.
    pub struct CellsOptions under "Cells" {
        /// How the intersection tells the inside of a polygon: as the paper does (paper), or so that no ray passes between two
        /// polygons that share an edge (closed) [default: paper].
        edges: Edges, "HOW", Text, "edges of polygons";
        /// What a cell runs: timings, which are Figure 7's, or programs of instructions, which find the hits themselves
        /// [default: timings].
        cells_run: CellsRun, "WHAT", Text, "what the cells run";
        /// A folder of programs for the cells (grid.pcs, broadcast.pcs, ...) in place of the standard ones.
        cell_programs: PathBuf, "DIR", File, "programs of the cells";
        /// Let the slabs' program stop at the first slab that rules the ray out, as annex A.2 does, and not work out all seven.
        #[cfg_attr(feature = "cli", arg(action = clap::ArgAction::SetTrue))]
        early_slabs: bool, "", Truth, "slabs' test ends early";
        /// Let the grid's program add up where the ray crosses planes, as annex A.1 does: rounding adds up too, and hits may differ.
        #[cfg_attr(feature = "cli", arg(action = clap::ArgAction::SetTrue))]
        stepped_walk: bool, "", Truth, "walk adds up its steps";
        /// The most instructions that a program may execute for one ray [default: 200000000].
        #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u64).range(1..)))]
        instruction_limit: u64, "N", Whole, "most instructions for one ray";
    }
}

parameters! {
    /// The machine that changes are laid over.
    pub struct MachineFileOptions under "Machine" {
        /// On which machine: pcs, or the nodes of an iPSC/2 as a row of cells. (With --mode regions or shared-memory: see ipsc2.)
        /// [default: pcs]
        #[cfg_attr(feature = "cli", arg(conflicts_with = "machine"))]
        on: On, "MACHINE", Text, "machine";
        /// A machine file of your own; the flags below change it further [default: PCS].
        machine: PathBuf, "FILE", File, "machine";
    }
}

parameters! {
    /// How the host makes an image of the light.
    pub struct LightOptions under "Light" {
        /// Samples along each side of a pixel: N x N primary rays.
        #[cfg_attr(feature = "cli", arg(default_value = "1", value_parser = clap::value_parser!(u32).range(1..=64)))]
        samples: u32, "N", Whole, "samples along a side of a pixel";
        /// One sample a pixel, and N x N only where a neighbour shows another object.
        #[cfg_attr(feature = "cli", arg(action = clap::ArgAction::SetTrue))]
        adaptive: bool, "", Truth, "samples only where they tell";
        /// The same, and N x N where another object is shown (object), another smooth surface (surface), another surface, light or mirror
        /// image around it or something smaller than a pixel (lao), or where colours differ (whitted) [default: object].
        adaptive_by: AdaptiveBy, "WHAT", Text, "what asks for samples";
        /// How far colours may differ, of 255 steps, for --adaptive-by whitted [default: 16].
        #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u8)))]
        threshold: u8, "N", Whole, "colours may differ by (of 255)";
        /// How often light may be reflected or refracted on its way to the eye.
        #[cfg_attr(feature = "cli", arg(default_value = "5"))]
        depth: u8, "N", Whole, "reflections and refractions at the most";
        /// Follow no reflected or refracted ray that adds less than this share to its pixel.
        #[cfg_attr(feature = "cli", arg(default_value = "0.00390625"))]
        min_contribution: f64, "SHARE", Number, "least share of a pixel that is followed";
    }
}

parameters! {
    /// What the host of an image does.
    pub struct HostOptions under "Host" {
        /// Whether to time the array; without, there is just the image.
        #[cfg_attr(feature = "cli", arg(default_value = "on"))]
        timing: Switch, "TIMING", Text, "timing";
        /// What the host sends next when it can choose [default: secondaries].
        policy: Policy, "POLICY", Text, "what the host sends next";
        /// How many rays may be in the array at once [default: as many as it takes].
        #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u64).range(1..)))]
        in_flight: u64, "N", Whole, "rays in the array at the most";
        /// How many samples the host may have begun and not done [default: 1024].
        #[cfg_attr(feature = "cli", arg(value_parser = clap::value_parser!(u32).range(1..=1 << 20)))]
        open_samples: u32, "N", Whole, "samples under way at the most";
        /// What spares tests and rays without changing a bit of any hit: rays name the polygon that they start on, which is not tested
        /// (own); shadow rays are not sent that start outside the cones of shadow of all objects (a4b), or inside that of a large
        /// polygon (a4c); several as in own+a4b; none [default: none].
        rules: Rules, "RULES", Text, "rules that spare tests and rays";
    }
}

/// Reads the names of a choice.
macro_rules! choice {
    ($Choice:ident: $($name:literal is $value:ident),*) => {
        impl FromStr for $Choice {
            type Err = String;

            fn from_str(text: &str) -> Result<$Choice, String> {
                match text {
                    $($name => Ok($Choice::$value),)*
                    _ => Err(format!("expected one of {}", [$($name),*].join(", "))),
                }
            }
        }
    };
}

/// The paper's two organisations of the array, and both together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Mode {
    /// Macro-pipeline: grid, slabs and intersection, a cell each (§4.2).
    Pipeline,
    /// Parallel broadcast: every cell does all of the work on its part of the scene (§4.2).
    Broadcast,
    /// Broadcast to groups of two cells: filters, intersection (§5).
    Hybrid,
}

choice!(Mode: "pipeline" is Pipeline, "broadcast" is Broadcast, "hybrid" is Hybrid);

/// A machine whose file comes with the simulator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum On {
    /// PCS.
    #[default]
    Pcs,
    /// An iPSC/2, its nodes as a row of cells.
    Ipsc2,
}

choice!(On: "pcs" is Pcs, "ipsc2" is Ipsc2);

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

/// What a cell runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum CellsRun {
    /// The times of the machine file.
    Timings,
    /// Programs of instructions.
    Programs,
}

choice!(CellsRun: "timings" is Timings, "programs" is Programs);

/// Whether something is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Switch {
    /// It is.
    On,
    /// It is not.
    Off,
}

/// By hand, as the command's help has nothing to say about on and off.
#[cfg(feature = "cli")]
impl clap::ValueEnum for Switch {
    fn value_variants<'a>() -> &'a [Switch] {
        &[Switch::On, Switch::Off]
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(clap::builder::PossibleValue::new(if *self == Switch::On { "on" } else { "off" }))
    }
}

pub(super) use choice;

choice!(Switch: "on" is On, "off" is Off);
choice!(Numbering: "cut" is Cut, "front" is Front);
choice!(Masks: "off" is Off, "rectangles" is Rectangles, "boxes" is Boxes);
choice!(AdaptiveBy: "object" is Object, "surface" is Surface, "lao" is Lao, "whitted" is Whitted);
choice!(ScreenRectangles: "off" is Off, "scene" is Scene, "objects" is Objects);
choice!(Policy: "secondaries" is SecondariesFirst, "primaries" is PrimariesFirst, "generation" is ByGeneration);

/// All that can be asked of a run, each by a name. What is left out is as a machine or program file has it, or by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunOptions {
    /// The scene.
    pub scene: SceneOptions,
    /// How large it is.
    pub shape: ShapeOptions,
    /// The rays.
    pub rays: RayOptions,
    /// Which are sent, and their order.
    pub sending: SendingOptions,
    /// The array program.
    pub program: ProgramOptions,
    /// How the cells work.
    pub cells: CellsOptions,
    /// The machine.
    pub machine_file: MachineFileOptions,
    /// Changes to the machine.
    pub machine: MachineOptions,
    /// An image's light.
    pub light: LightOptions,
    /// An image's host.
    pub host: HostOptions,
}

impl RunOptions {
    /// All parameters of a run of primary rays, in the order of tables.
    pub fn parameters() -> impl Iterator<Item = &'static ParameterInfo> {
        let groups = [
            SceneOptions::PARAMETERS,
            ShapeOptions::PARAMETERS,
            RayOptions::PARAMETERS,
            SendingOptions::PARAMETERS,
            ProgramOptions::PARAMETERS,
            CellsOptions::PARAMETERS,
            MachineFileOptions::PARAMETERS,
            MachineOptions::PARAMETERS,
        ];
        groups.into_iter().flatten()
    }

    /// The parameters that only a whole image has.
    pub fn image_parameters() -> impl Iterator<Item = &'static ParameterInfo> {
        [LightOptions::PARAMETERS, HostOptions::PARAMETERS].into_iter().flatten()
    }

    /// Gives a parameter the value that a text stands for.
    ///
    /// Fails if there is no such parameter, or if the text is no such value.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), InputError> {
        let known = self.scene.set(name, text)?
            || self.shape.set(name, text)?
            || self.rays.set(name, text)?
            || self.sending.set(name, text)?
            || self.program.set(name, text)?
            || self.cells.set(name, text)?
            || self.machine_file.set(name, text)?
            || self.machine.set(name, text)?
            || self.light.set(name, text)?
            || self.host.set(name, text)?;
        if known { Ok(()) } else { Err(InputError::new(format!("a run has no parameter '{name}'"))) }
    }

    /// Takes back the parameters that are not to be kept.
    pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
        self.scene.retain(&keep);
        self.shape.retain(&keep);
        self.rays.retain(&keep);
        self.sending.retain(&keep);
        self.program.retain(&keep);
        self.cells.retain(&keep);
        self.machine_file.retain(&keep);
        self.machine.retain(&keep);
        self.light.retain(&keep);
        self.host.retain(&keep);
    }

    /// Whether a parameter was given.
    pub fn has(&self, name: &str) -> bool {
        self.scene.has(name)
            || self.shape.has(name)
            || self.rays.has(name)
            || self.sending.has(name)
            || self.program.has(name)
            || self.cells.has(name)
            || self.machine_file.has(name)
            || self.machine.has(name)
            || self.light.has(name)
            || self.host.has(name)
    }
}
