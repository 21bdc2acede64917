//! The description of an array program: groups of stages (§4.2, §5).

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::InputError;
use crate::geometry::{Numbering, Partition};
use crate::input::fields::{self, Fault, is_default};

/// A step of the geometric computation (§3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kernel {
    /// Filter 1: the walk through the grid.
    Grid,
    /// Filter 2: the slabs test.
    Slabs,
    /// The intersection test.
    Intersection,
}

/// An array program, as a file describes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArrayProgram {
    /// Its name, for reports.
    pub name: String,
    /// How many sub-volumes the scene is cut into, each served by a group of neighbouring cells.
    pub groups: usize,
    /// The kernels of each of a group's cells, from left to right.
    pub stages: Vec<Vec<Kernel>>,
    /// How the scene is cut.
    #[serde(default)]
    pub partition: Partition,
    /// Which sub-volume is which group's.
    #[serde(default, skip_serializing_if = "is_default")]
    pub numbering: Numbering,
    /// coeff_grid: voxels a polygon (annex A.1; 50 is UgRay's rule).
    #[serde(default = "ugray_coefficient")]
    pub grid_coefficient: f64,
    /// Whether the grid drops polygons that it has already sent on for the same ray.
    #[serde(default)]
    pub mailbox: bool,
    /// How many voxels the grid's cell may be ahead of what the intersection's cell has told it, by stop words, at least 1.
    /// `None` for the paper's way: the grid's cell walks to the end of the volume. Beyond the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop_words: Option<u32>,
    /// How many rays a cell reads and passes on ahead of the one that it begins. Beyond the paper, where it is 0.
    #[serde(default, skip_serializing_if = "is_default")]
    pub forward_ahead: u32,
    /// How many rays, and hits, are in a message: the host bundles rays, and a cell works on a bundle before it answers. Beyond the
    /// paper, where it is 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub rays_per_message: u32,
    /// How the host tells which sub-volumes a ray can meet, which it then says in RAY; cells of the others pass it on, and do no
    /// more. Beyond the paper, in which all cells start on all rays.
    #[serde(default, skip_serializing_if = "is_default")]
    pub masks: Masks,
    /// Whether a cell reads the hit of the groups before its own before it begins, and looks for nothing behind that. Beyond the
    /// paper, whose cells read it when they have done their own work.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bounded_walk: bool,
}

/// How the host tells which sub-volumes a ray can meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Masks {
    /// It does not: all cells start on all rays, as in the paper.
    #[default]
    Off,
    /// By the sub-volumes' rectangles on the screen: of rays from the eye; any other may meet them all.
    Rectangles,
    /// By the sub-volumes' boxes.
    Boxes,
}

fn one() -> u32 {
    1
}

fn is_one(rays: &u32) -> bool {
    *rays == 1
}

fn ugray_coefficient() -> f64 {
    50.0
}

/// In which of a group's cells each kernel runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stages {
    /// The slabs' cell; the grid's is always the first. `None` if the program goes without slabs.
    pub slabs: Option<usize>,
    /// The intersection's cell, which is always the last.
    pub intersection: usize,
}

impl Stages {
    /// Cells of a group.
    pub fn count(&self) -> usize {
        self.intersection + 1
    }
}

const STANDARD: [(&str, &str); 4] = [
    ("pipeline", include_str!("../../pcs-programs/pipeline.ron")),
    ("broadcast", include_str!("../../pcs-programs/broadcast.ron")),
    ("hybrid", include_str!("../../pcs-programs/hybrid.ron")),
    ("hybrid-3", include_str!("../../pcs-programs/hybrid-3.ron")),
];

impl ArrayProgram {
    /// The largest number of cells of an array.
    pub const MOST_CELLS: usize = 4096;

    /// The most rays of a message.
    pub const MOST_RAYS_PER_MESSAGE: u32 = 65536;

    /// A standard program by name: `pipeline`, `broadcast`, `hybrid` or `hybrid-3`.
    pub fn standard(name: &str) -> Option<Result<ArrayProgram, InputError>> {
        let (name, text) = STANDARD.iter().find(|(standard, _)| *standard == name)?;
        Some(ArrayProgram::parse(Path::new(&format!("{name}.ron")), text))
    }

    /// The names of the standard programs.
    pub fn standard_names() -> impl Iterator<Item = &'static str> {
        STANDARD.iter().map(|(name, _)| *name)
    }

    /// All of the work in one cell, with a grid of so many voxels a polygon.
    pub fn one_cell(grid_coefficient: f64) -> ArrayProgram {
        ArrayProgram {
            name: "one cell".to_owned(),
            groups: 1,
            stages: vec![vec![Kernel::Grid, Kernel::Slabs, Kernel::Intersection]],
            partition: Partition::default(),
            numbering: Numbering::default(),
            grid_coefficient,
            mailbox: false,
            stop_words: None,
            forward_ahead: 0,
            rays_per_message: 1,
            masks: Masks::Off,
            bounded_walk: false,
        }
    }

    /// Reads a program file.
    pub fn read(path: &Path) -> Result<ArrayProgram, InputError> {
        ArrayProgram::parse(path, &fields::read_text(path)?)
    }

    fn parse(path: &Path, text: &str) -> Result<ArrayProgram, InputError> {
        let program: ArrayProgram = fields::parse(path, text)?;
        program.find_fault().map_err(|fault| fault.in_text(path, text))?;
        Ok(program)
    }

    /// Whether the description can be built: kernels in order and each once, at least one group, a usable coefficient.
    pub fn check(&self) -> Result<(), InputError> {
        self.find_fault().map_err(Fault::in_flags)
    }

    fn find_fault(&self) -> Result<(), Fault> {
        let order: Vec<Kernel> = self.stages.iter().flatten().copied().collect();
        let allowed = [Kernel::Grid, Kernel::Slabs, Kernel::Intersection];
        if order != allowed && order != [Kernel::Grid, Kernel::Intersection] {
            let message = "the stages must run grid, slabs and intersection once each, in that order";
            let help = "split the three over the stages as you like; slabs may be left out";
            return Err(Fault::new("stages", message).help(help));
        }
        if self.stages.iter().any(Vec::is_empty) {
            return Err(Fault::new("stages", "a stage has no kernel").help("leave the empty stage out"));
        }
        if self.groups == 0 {
            return Err(Fault::new("groups", "an array of 0 cells cannot run: there must be at least 1 group"));
        }
        if self.cells() > Self::MOST_CELLS {
            let message =
                format!("{} cells are more than the {} that can be simulated", self.cells(), Self::MOST_CELLS);
            return Err(Fault::new("groups", message));
        }
        if self.stop_words == Some(0) {
            let message = "the grid's cell cannot walk at all if it may be 0 voxels ahead of the stop words";
            return Err(Fault::new("stop_words", message).help("give 1 or more, or leave the stop words out"));
        }
        if self.stop_words.is_some() && self.stages.len() == 1 {
            let message = "stop words go from the intersection's cell to the grid's, which here are the same";
            return Err(Fault::new("stop_words", message).help("it stops by itself: leave the stop words out"));
        }
        self.find_fault_of_messages()?;
        if !(self.grid_coefficient > 0.0 && self.grid_coefficient <= 1e6) {
            let message = format!("a grid coefficient of {} is not above 0 and at most 1000000", self.grid_coefficient);
            let help = "it is the number of voxels a polygon; UgRay's rule is 50";
            return Err(Fault::new("grid_coefficient", message).help(help));
        }
        Ok(())
    }

    fn find_fault_of_messages(&self) -> Result<(), Fault> {
        const NAME: &str = "rays_per_message";
        if !(1..=Self::MOST_RAYS_PER_MESSAGE).contains(&self.rays_per_message) {
            let most = Self::MOST_RAYS_PER_MESSAGE;
            let message = format!("a message of {} rays is none of 1 to {most}", self.rays_per_message);
            return Err(Fault::new(NAME, message));
        }
        let message = match (self.rays_per_message, self.forward_ahead, self.bounded_walk) {
            (1, ..) | (_, 0, false) => return Ok(()),
            (_, 0, true) => {
                "a walk bounded by the hit from the left waits for it, and rays in one message are answered together"
            }
            (..) => "a cell reads rays ahead one by one, or several in a message, and not both",
        };
        Err(Fault::new(NAME, message).help("leave out one of the two"))
    }

    /// Cells of the array.
    pub fn cells(&self) -> usize {
        self.groups.saturating_mul(self.stages.len())
    }

    /// Whether the cut looks at rays of all kinds, which an image has more of than those of its camera.
    pub fn cut_by_all_rays(&self) -> bool {
        self.groups > 1 && (self.partition == Partition::Measured || self.numbering == Numbering::Front)
    }

    /// Where each kernel runs.
    pub fn placement(&self) -> Stages {
        let stage_of = |kernel| self.stages.iter().position(|stage| stage.contains(&kernel));
        Stages { slabs: stage_of(Kernel::Slabs), intersection: self.stages.len() - 1 }
    }
}
