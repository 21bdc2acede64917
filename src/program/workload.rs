//! A scene laid out for an array program: what each group of cells has of it.

use crate::error::InputError;
use crate::geometry::{Bounds, Grid, Partition, Polygons, Ray, Slabs, partition, slabs};
use crate::machine::Words;
use crate::scene::Mesh;

use super::array_program::{ArrayProgram, Kernel, Stages};
use super::kernel::{HostTimes, KernelTimes};
use super::trace::{Tracer, WorkSample};

/// One ray in so many is traced ahead to find where the work is (§4.1: 1.5 % of the pixels).
const SAMPLE_EVERY: usize = 67;

/// A scene's polygons with the grids and slabs that an array program gives its cells.
#[derive(Clone, Debug)]
pub struct Workload {
    pub(super) polygons: Polygons,
    pub(super) slabs: Slabs,
    pub(super) groups: Vec<Group>,
    pub(super) stages: Stages,
    pub(super) times: KernelTimes,
    pub(super) mailbox: bool,
    kernels: Vec<Vec<Kernel>>,
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
    /// Lays a scene out. `rays` are those of the run, of which the partition by work traces a few ahead.
    ///
    /// Fails if there are more groups than polygons, or if a grid would be too large.
    pub fn new(mesh: &Mesh, program: &ArrayProgram, times: KernelTimes, rays: &[Ray]) -> Result<Workload, InputError> {
        program.check()?;
        let polygons = Polygons::new(mesh);
        if program.groups > polygons.len() {
            let message = format!("{} groups are more than the scene's {} polygons", program.groups, polygons.len());
            return Err(InputError::new(message).help("use fewer cells or a larger scene"));
        }
        let mut workload = Workload {
            slabs: Slabs::new(&polygons),
            polygons,
            groups: Vec::new(),
            stages: program.placement(),
            times,
            mailbox: program.mailbox,
            kernels: program.stages.clone(),
        };
        let boxes = workload.cut(program, rays)?;
        workload.groups = workload.fill_groups(&boxes, program.grid_coefficient)?;
        Ok(workload)
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

    fn cut(&self, program: &ArrayProgram, rays: &[Ray]) -> Result<Vec<Bounds>, InputError> {
        let all: Vec<u32> = (0..self.polygons.len() as u32).collect();
        let volume = partition::reached(&self.polygons, &all);
        if volume.is_empty() || program.groups == 1 {
            return Ok(vec![volume; program.groups]);
        }
        Ok(match program.partition {
            Partition::Regular => partition::regular(volume, program.groups),
            Partition::Polygons => {
                partition::weighted(volume, &mut partition::polygon_weights(&self.polygons), program.groups)
            }
            Partition::Work => {
                let mut weights = self.sample_work(volume, program.grid_coefficient, rays)?;
                partition::weighted(volume, &mut weights, program.groups)
            }
        })
    }

    /// Traces a sub-sample of the rays through the whole scene in one cell and notes where it worked how long.
    fn sample_work(
        &self,
        volume: Bounds,
        coefficient: f64,
        rays: &[Ray],
    ) -> Result<Vec<partition::Weight>, InputError> {
        let whole = Workload {
            groups: self.fill_groups(&[volume], coefficient)?,
            stages: Stages { slabs: self.stages.slabs.map(|_| 0), intersection: 0 },
            ..self.clone()
        };
        let mut sample = WorkSample::default();
        let mut tracer = Tracer::new(&whole);
        for ray in rays.iter().step_by(SAMPLE_EVERY) {
            tracer.sample(ray, &mut sample);
        }
        Ok(sample.weights)
    }

    fn fill_groups(&self, boxes: &[Bounds], coefficient: f64) -> Result<Vec<Group>, InputError> {
        let too_large = |error: crate::geometry::grid::GridTooLarge| InputError::new(error.to_string());
        let fill = |sub_volume: partition::SubVolume| {
            let grid = Grid::new(&self.polygons, &sub_volume.members, sub_volume.volume, coefficient);
            Ok(Group { grid: grid.map_err(too_large)?, members: sub_volume.members })
        };
        partition::assign(&self.polygons, boxes).into_iter().map(fill).collect()
    }
}
