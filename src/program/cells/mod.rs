//! Cells that run programs: which program each cell runs, and the memory that the host's loader lays out for it.
//!
//! The programs are those of `pcs-programs/cells`, one for each set of kernels that a cell can have. They find hits by the
//! same 32-bit operations in the same order as [`crate::geometry`], so they find the same bits.

mod loader;
mod standard;
mod tracer;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::InputError;
use crate::isa::{Executable, InstructionCycles, Program, Register, assemble};
use crate::quantities::Words;

use super::array_program::{ArrayProgram, Kernel};
use super::layout::Layout;

pub use standard::STANDARD;
pub(super) use tracer::ProgramTracer;

/// How the cells of an array run programs.
#[derive(Clone, Debug, PartialEq)]
pub struct CellOptions {
    /// What instructions cost.
    pub cycles: InstructionCycles,
    /// The folder of the programs; `None` for the standard ones.
    pub folder: Option<PathBuf>,
    /// The most instructions that a cell may execute for one ray.
    pub instruction_limit: u64,
    /// Where their programs do as the annex does, and the standard ones otherwise.
    pub annex: Annex,
}

/// Two steps of annex A that the standard programs do otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Annex {
    /// A.2: the slabs' test ends at the first slab behind which no part of the ray is left, and does not work out the others.
    pub early_slabs: bool,
    /// A.1: the walk finds where the next plane of an axis is crossed by adding δt, which adds up rounding.
    pub stepped_walk: bool,
}

/// An instruction that a cell has executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstructionStep {
    /// Where it stands.
    pub address: u32,
    /// The register that holds something else since, and what; none if all hold what they did.
    pub changed: Option<(Register, u32)>,
}

/// The programs of all cells, loaded.
#[derive(Clone, Debug)]
pub(super) struct CellPrograms {
    executables: Vec<Executable>,
    cells: Vec<LoadedCell>,
    pub options: CellOptions,
}

/// A cell's program and memory.
#[derive(Clone, Debug)]
struct LoadedCell {
    /// Which of the executables.
    executable: usize,
    /// The data memory: the program's own data, filled in, and room that the loader adds.
    data: Vec<u32>,
    /// The memory behind it: the cell's part of the scene.
    scene: Vec<u32>,
}

/// The file of the program for a cell that runs some kernels.
pub fn program_name(kernels: &[Kernel]) -> &'static str {
    match kernels {
        [Kernel::Grid] => "grid.pcs",
        [Kernel::Slabs] => "slabs.pcs",
        [Kernel::Intersection] => "intersection.pcs",
        [Kernel::Grid, Kernel::Slabs] => "grid-slabs.pcs",
        [Kernel::Slabs, Kernel::Intersection] => "slabs-intersection.pcs",
        [Kernel::Grid, Kernel::Intersection] => "grid-intersection.pcs",
        _ => "broadcast.pcs",
    }
}

impl CellPrograms {
    /// Assembles the programs that the stages need and loads every cell's memory.
    pub fn new(layout: &Layout, array: &ArrayProgram, options: &CellOptions) -> Result<CellPrograms, InputError> {
        let (stages, groups) = (array.stages.len(), layout.groups.len());
        // The first group's cells have no earlier group's hit to read.
        let variants = groups.min(2);
        let mut executables = Vec::new();
        for earlier in 0..variants {
            for kernels in &array.stages {
                let program = open(kernels, earlier, array, options)?;
                executables.push(Executable::new(program, &options.cycles));
            }
        }
        let load = |cell: usize| {
            let executable = (cell / stages).min(variants - 1) * stages + cell % stages;
            let place = loader::Place {
                surfaces: &layout.surfaces,
                group: &layout.groups[cell / stages],
                kernels: &array.stages[cell % stages],
                mailbox: array.mailbox,
            };
            let (data, scene) = loader::load(&place, executables[executable].program())?;
            Ok(LoadedCell { executable, data, scene })
        };
        let cells = (0..groups * stages).map(load).collect::<Result<_, InputError>>()?;
        Ok(CellPrograms { executables, cells, options: options.clone() })
    }

    /// What a cell runs.
    pub fn executable(&self, cell: usize) -> &Executable {
        &self.executables[self.cells[cell].executable]
    }

    /// Words that a cell's program, data and part of the scene take.
    pub fn words(&self, cell: usize) -> Words {
        let cell = &self.cells[cell];
        let code = self.executables[cell.executable].program().code.len();
        Words((code + cell.data.len() + cell.scene.len()) as u64)
    }
}

fn open(
    kernels: &[Kernel],
    earlier: usize,
    array: &ArrayProgram,
    options: &CellOptions,
) -> Result<Program, InputError> {
    let name = program_name(kernels);
    let bounded = if array.bounded_walk { earlier } else { 0 };
    let set = [
        ("EARLIER", earlier as i64),
        ("BOUNDED", bounded as i64),
        ("MAILBOX", array.mailbox.into()),
        ("EARLY", options.annex.early_slabs.into()),
        ("STEPPED", options.annex.stepped_walk.into()),
    ];
    match &options.folder {
        Some(folder) => assemble(&folder.join(name), crate::isa::Sources::Files, &set),
        None => assemble(Path::new(name), STANDARD, &set),
    }
}
