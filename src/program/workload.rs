//! A scene laid out for an array program: what each group of cells has of it.

use crate::error::InputError;
use crate::geometry::{Grid, Polygons, Slabs, slabs};
use crate::machine::Words;

use super::array_program::{Kernel, Stages};
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
}

impl CellMemory {
    /// All of it.
    pub fn total(&self) -> Words {
        self.grid + self.slabs + self.polygons
    }
}

impl Workload {
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
        CellMemory {
            grid: words(Kernel::Grid, group.grid.memory_words()),
            slabs: words(Kernel::Slabs, slabs::WORDS * group.members.len() as u64),
            polygons: words(Kernel::Intersection, self.polygons.memory_words(&group.members)),
        }
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
            "the scene does not fit: cell {cell} needs {} (grid {}, slabs {}, planes and vertices {}) and has {memory}",
            need.total(),
            need.grid.0,
            need.slabs.0,
            need.polygons.0,
        );
        Err(InputError::new(message).help("use more cells, a smaller grid coefficient, or more memory_words"))
    }
}
