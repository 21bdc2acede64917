//! A scene laid out for an array program: what each group of cells has of it.

use crate::error::InputError;
use crate::geometry::{Grid, Polygons, Slabs, slabs};
use crate::machine::Words;

use super::array_program::{Kernel, Stages};
use super::cells::{CellOptions, CellPrograms};
use super::kernel::{HostTimes, KernelTimes};

/// A scene's polygons with the grids and slabs that an array program gives its cells.
#[derive(Clone, Debug)]
pub struct Workload {
    pub(super) polygons: Polygons,
    pub(super) slabs: Slabs,
    pub(super) groups: Vec<Group>,
    pub(super) stages: Stages,
    pub(super) times: KernelTimes,
    pub(super) mailbox: bool,
    pub(super) kernels: Vec<Vec<Kernel>>,
    /// The cells' programs, if they run any instead of Figure 7's times.
    pub(super) programs: Option<CellPrograms>,
}

/// A group's part of the scene.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub members: Vec<u32>,
    pub grid: Grid,
}

/// What a cell's memory holds, in words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellMemory {
    /// Voxel table and index lists (equation 4).
    pub grid: Words,
    /// Slabs (equation 6).
    pub slabs: Words,
    /// Planes and vertices.
    pub polygons: Words,
    /// What a cell that runs a program needs beside: the program, its own data, planes between voxels, addresses of records.
    pub program: Words,
}

impl CellMemory {
    /// All of it.
    pub fn total(&self) -> Words {
        self.grid + self.slabs + self.polygons + self.program
    }
}

impl Workload {
    /// Lets the cells run programs instead of taking Figure 7's times: assembles them and loads every cell's memory.
    ///
    /// Fails if a program has a mistake, or wants something of the loader that it does not have.
    pub fn with_programs(self, options: &CellOptions) -> Result<Workload, InputError> {
        let programs = CellPrograms::new(&self, options)?;
        Ok(Workload { programs: Some(programs), ..self })
    }

    /// Whether the cells run programs.
    pub fn runs_programs(&self) -> bool {
        self.programs.is_some()
    }

    /// What the host spends.
    pub fn host_times(&self) -> HostTimes {
        self.times.host
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.groups.len() * self.stages.count()
    }

    /// Number of groups.
    pub fn groups(&self) -> usize {
        self.groups.len()
    }

    /// The polygons.
    pub fn polygons(&self) -> &Polygons {
        &self.polygons
    }

    /// Each group's grid.
    pub fn grids(&self) -> impl ExactSizeIterator<Item = &Grid> {
        self.groups.iter().map(|group| &group.grid)
    }

    /// The kernels that a cell runs.
    pub fn kernels_of(&self, cell: usize) -> &[Kernel] {
        &self.kernels[cell % self.kernels.len()]
    }

    /// What a cell's memory must hold.
    pub fn memory_of(&self, cell: usize) -> CellMemory {
        let group = &self.groups[cell / self.kernels.len()];
        let words = |kernel, words: u64| Words(if self.kernels_of(cell).contains(&kernel) { words } else { 0 });
        let mut memory = CellMemory {
            grid: words(Kernel::Grid, group.grid.memory_words()),
            slabs: words(Kernel::Slabs, slabs::WORDS * group.members.len() as u64),
            polygons: words(Kernel::Intersection, self.polygons.memory_words(&group.members)),
            program: Words(0),
        };
        if let Some(programs) = &self.programs {
            memory.program = Words(programs.words(cell).0 - memory.total().0);
        }
        memory
    }

    /// Fails if some cell needs more memory than it has.
    pub fn check_memory(&self, memory: Option<Words>) -> Result<(), InputError> {
        let Some(memory) = memory else { return Ok(()) };
        let largest = (0..self.cells()).max_by_key(|&cell| (self.memory_of(cell).total(), std::cmp::Reverse(cell)));
        let Some((cell, need)) = largest.map(|cell| (cell, self.memory_of(cell))).filter(|l| l.1.total() > memory)
        else {
            return Ok(());
        };
        let message = format!(
            "the scene does not fit: cell {cell} needs {} (grid {}, slabs {}, planes and vertices {}, program {}) and has {memory}",
            need.total(),
            need.grid.0,
            need.slabs.0,
            need.polygons.0,
            need.program.0,
        );
        Err(InputError::new(message).help("use more cells, a smaller grid coefficient, or more memory_words"))
    }
}
