//! The micro-workloads behind Figure 7's six numbers.
//!
//! Each number is measured on a cell of the macro-pipeline, by the units of work that it does on a ray; the words that it moves
//! are not counted, as they are the links' affair and the machine has their cycles beside. What a kernel takes for each
//! voxel or polygon is what one more of them costs; its start is what is left of a ray without any.
//!
//! - The grid: a ray through empty voxels that crosses planes of all three axes equally often.
//! - The slabs: a ray that meets the slabs of all its candidates.
//! - The intersection: a ray through triangles, each of which lies behind the first one. On the built-in scenes most tests
//!   end so: without a new nearest hit. A new one takes a little longer.

pub mod calibrate;
mod calibrated_text;
pub mod fits;
pub mod two_constants;

use glam::Vec3;

use crate::error::InputError;
use crate::geometry::Ray;
use crate::isa::Fault;
use crate::machine::{KernelTimes, MachineSpec};
use crate::scene::Mesh;
use crate::seam::{Costs, OpStream, Unit, Vocabulary};

use super::cells::CellOptions;
use super::{ArrayProgram, Tracer, Workload, work};

pub use calibrated_text::machine_text;

/// One of Figure 7's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// What it tells.
    pub name: &'static str,
    /// What the paper says, in µs.
    pub paper_us: f64,
}

/// The six numbers, as Figure 7 has them: start and work of the grid, the slabs and the intersection.
pub const NUMBERS: [Number; 6] = [
    Number { name: "grid, start", paper_us: 30.0 },
    Number { name: "grid, a voxel", paper_us: 7.8 },
    Number { name: "slabs, start", paper_us: 9.0 },
    Number { name: "slabs, a polygon", paper_us: 13.0 },
    Number { name: "intersection, start", paper_us: 1.0 },
    Number { name: "intersection, a polygon", paper_us: 30.0 },
];

/// How many units of work are behind each of the six numbers, by the unit. They may be fractions, as means.
pub type Mix = [[f64; Vocabulary::MOST_UNITS]; NUMBERS.len()];

/// Why the six numbers cannot be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// A program has a mistake.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A program does what none may.
    #[error("Figure 7 cannot be measured: {0}")]
    Fault(Box<Fault>),
}

/// The units of work behind the six numbers: of cells that take Figure 7's times, or that run programs.
///
/// # Errors
///
/// If the programs have a mistake, or do what no program may.
pub fn mix(programs: Option<&CellOptions>) -> Result<Mix, MeasureError> {
    let cells = Cells { programs };
    let [grid_start, voxel] = cells.grid()?;
    let [slabs_start, slabs_polygon] = cells.candidates(1)?;
    let [intersection_start, intersection_polygon] = cells.candidates(2)?;
    Ok([grid_start, voxel, slabs_start, slabs_polygon, intersection_start, intersection_polygon])
}

/// The six numbers in cycles, on a machine where units cost so much.
pub fn measure(mix: &Mix, costs: &Costs) -> [f64; NUMBERS.len()] {
    let units = || (0..).map(Unit);
    mix.map(|row| row.iter().zip(units()).map(|(count, unit)| count * costs.of(unit).0 as f64).sum())
}

/// The six numbers in cycles, of cells that take a machine's times, or that run programs on it.
///
/// # Errors
///
/// If the programs have a mistake, or do what no program may.
pub fn numbers(times: &KernelTimes, programs: Option<&CellOptions>) -> Result<[f64; NUMBERS.len()], MeasureError> {
    let waits = programs.filter(|options| options.cycles.counts_waits()).map(|_| work::FLOAT_WAIT);
    let vocabulary = work::vocabulary_with(programs.is_some(), waits.as_slice());
    let costs = work::costs(&vocabulary, times, programs.map(|options| &options.cycles));
    Ok(measure(&mix(programs)?, &costs))
}

/// Cycles as µs on a machine.
pub fn us(cycles: f64, spec: &MachineSpec) -> f64 {
    cycles * spec.clock_ns / 1e3
}

/// The cells that are measured.
struct Cells<'a> {
    programs: Option<&'a CellOptions>,
}

/// Units of work, by their number.
type Units = [f64; Vocabulary::MOST_UNITS];

/// What one cell did on one ray.
struct Work {
    units: Units,
    voxels: f64,
}

/// Calculates with each unit by itself.
fn each_unit(of: impl Fn(usize) -> f64) -> Units {
    std::array::from_fn(of)
}

impl Cells<'_> {
    /// The grid's start and work. The volume is spanned by two small triangles in opposite corners; the ray goes from a
    /// third corner to a fourth, and is ended earlier or later.
    fn grid(&self) -> Result<[Units; 2], MeasureError> {
        let mut mesh = Mesh::default();
        for (corner, size) in [(Vec3::ZERO, 0.1), (Vec3::splat(100.0), -0.1)] {
            let corners = [Vec3::ZERO, Vec3::new(size, 0.0, size), Vec3::new(0.0, size, size)];
            let points = corners.map(|point| mesh.add_point(corner + point));
            mesh.add_face(&points, 0);
        }
        let coefficient = 32.0f64.powi(3) / 2.0;
        let ray = |t_max: f32| Ray { t_max, ..Ray::new(Vec3::new(-1.0, 100.0, 0.5), Vec3::new(1.0, -0.993, 0.989)) };
        let short = self.work(&mesh, coefficient, ray(20.0), 0)?;
        let long = self.work(&mesh, coefficient, ray(90.0), 0)?;
        let each = each_unit(|unit| (long.units[unit] - short.units[unit]) / (long.voxels - short.voxels));
        Ok([each_unit(|unit| long.units[unit] - each[unit] * long.voxels), each])
    }

    /// The start and the work of a cell that reads candidates: triangles one behind the other, all in one voxel.
    fn candidates(&self, cell: usize) -> Result<[Units; 2], MeasureError> {
        let units = |count: u32| {
            let mut mesh = Mesh::default();
            for z in 0..count {
                let corners = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
                let points = corners.map(|[x, y]| mesh.add_point(Vec3::new(x, y, z as f32)));
                mesh.add_face(&points, 0);
            }
            let ray = Ray::new(Vec3::new(0.9, 1.1, -1.0), Vec3::new(0.01, 0.02, 1.0));
            Ok::<Units, MeasureError>(self.work(&mesh, 1.0 / count as f64, ray, cell)?.units)
        };
        let (few, many) = (2, 12);
        let (with_few, with_many) = (units(few)?, units(many)?);
        let each = each_unit(|unit| (with_many[unit] - with_few[unit]) / (many - few) as f64);
        let beside = Ray::new(Vec3::new(9.0, 9.0, -1.0), Vec3::Z);
        let mut mesh = Mesh::default();
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|point| mesh.add_point(point));
        mesh.add_face(&points, 0);
        Ok([self.work(&mesh, 1.0, beside, cell)?.units, each])
    }

    /// What a cell of the macro-pipeline does on a ray.
    fn work(&self, mesh: &Mesh, coefficient: f64, ray: Ray, cell: usize) -> Result<Work, MeasureError> {
        let pipeline = ArrayProgram::standard("pipeline").unwrap_or_else(|| Err(InputError::new("no pipeline")))?;
        let pipeline = ArrayProgram { grid_coefficient: coefficient, ..pipeline };
        let mut workload = Workload::new(mesh, &pipeline, KernelTimes::default(), &[ray])?;
        if let Some(options) = self.programs {
            workload = workload.with_programs(options)?;
        }
        let mut tracer = Tracer::new(&workload);
        let mut cells = vec![OpStream::default(); workload.cells()];
        tracer.trace_cells(0, &ray, &mut cells);
        if let Some(fault) = tracer.fault {
            return Err(MeasureError::Fault(Box::new(fault)));
        }
        let mut units = [0.0; Vocabulary::MOST_UNITS];
        let works = cells[cell].ops().iter().filter_map(|op| Some((op.unit()?, op.count())));
        works.for_each(|(Unit(unit), count)| units[unit as usize] += count as f64);
        Ok(Work { units, voxels: tracer.counts.voxels as f64 })
    }
}
