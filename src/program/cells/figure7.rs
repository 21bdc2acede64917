//! The micro-workloads behind Figure 7's six numbers.
//!
//! Each number is measured on a cell of the macro-pipeline, by the cycles that it computes on a ray; the words that it moves
//! are not counted, as they are the links' affair and the machine has their cycles beside. What a kernel takes for each
//! voxel or polygon is what one more of them costs; its start is what is left of a ray without any.
//!
//! - The grid: a ray through empty voxels that crosses planes of all three axes equally often.
//! - The slabs: a ray that meets the slabs of all its candidates.
//! - The intersection: a ray through triangles, each of which lies behind the first one. On the built-in scenes most tests
//!   end so: without a new nearest hit. A new one takes a little longer.

use glam::Vec3;

use crate::error::InputError;
use crate::geometry::Ray;
use crate::machine::{KernelTimes, MachineSpec, OpKind, OpStream};
use crate::program::{ArrayProgram, Tracer, Workload};
use crate::scene::Mesh;

use super::CellOptions;

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

/// The six numbers of cells that take `times`, or that run programs, in cycles. They may be fractions, as means.
pub fn measure(times: KernelTimes, programs: Option<&CellOptions>) -> Result<[f64; 6], InputError> {
    let cells = Cells { times, programs };
    let [grid_start, voxel] = cells.grid()?;
    let [slabs_start, slabs_polygon] = cells.candidates(1)?;
    let [intersection_start, intersection_polygon] = cells.candidates(2)?;
    Ok([grid_start, voxel, slabs_start, slabs_polygon, intersection_start, intersection_polygon])
}

/// Cycles as µs on a machine.
pub fn us(cycles: f64, spec: &MachineSpec) -> f64 {
    cycles * spec.clock_ns / 1e3
}

/// The cells that are measured.
struct Cells<'a> {
    times: KernelTimes,
    programs: Option<&'a CellOptions>,
}

/// What one cell did on one ray.
struct Work {
    cycles: f64,
    voxels: f64,
}

impl Cells<'_> {
    /// The grid's start and work. The volume is spanned by two small triangles in opposite corners; the ray goes from a
    /// third corner to a fourth, and is ended earlier or later.
    fn grid(&self) -> Result<[f64; 2], InputError> {
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
        let each = (long.cycles - short.cycles) / (long.voxels - short.voxels);
        Ok([long.cycles - each * long.voxels, each])
    }

    /// The start and the work of a cell that reads candidates: triangles one behind the other, all in one voxel.
    fn candidates(&self, cell: usize) -> Result<[f64; 2], InputError> {
        let cycles = |count: u32| {
            let mut mesh = Mesh::default();
            for z in 0..count {
                let corners = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
                let points = corners.map(|[x, y]| mesh.add_point(Vec3::new(x, y, z as f32)));
                mesh.add_face(&points, 0);
            }
            let ray = Ray::new(Vec3::new(0.9, 1.1, -1.0), Vec3::new(0.01, 0.02, 1.0));
            Ok::<f64, InputError>(self.work(&mesh, 1.0 / count as f64, ray, cell)?.cycles)
        };
        let (few, many) = (2, 12);
        let each = (cycles(many)? - cycles(few)?) / (many - few) as f64;
        let beside = Ray::new(Vec3::new(9.0, 9.0, -1.0), Vec3::Z);
        let mut mesh = Mesh::default();
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|point| mesh.add_point(point));
        mesh.add_face(&points, 0);
        Ok([self.work(&mesh, 1.0, beside, cell)?.cycles, each])
    }

    /// What a cell of the macro-pipeline does on a ray.
    fn work(&self, mesh: &Mesh, coefficient: f64, ray: Ray, cell: usize) -> Result<Work, InputError> {
        let pipeline = ArrayProgram::standard("pipeline").unwrap_or_else(|| Err(InputError::new("no pipeline")))?;
        let pipeline = ArrayProgram { grid_coefficient: coefficient, ..pipeline };
        let mut workload = Workload::new(mesh, &pipeline, self.times, &[ray])?;
        if let Some(options) = self.programs {
            workload = workload.with_programs(options)?;
        }
        let mut tracer = Tracer::new(&workload);
        let mut cells = vec![OpStream::default(); workload.cells()];
        tracer.trace_cells(0, &ray, &mut cells);
        if let Some(fault) = tracer.fault {
            return Err(InputError::new(format!("Figure 7 cannot be measured: {fault}")));
        }
        let computes = |op: &&crate::machine::Op| matches!(op.kind(), OpKind::Compute(_));
        let cycles: u64 = cells[cell].ops().iter().filter(computes).map(|op| op.count() as u64).sum();
        Ok(Work { cycles: cycles as f64, voxels: tracer.counts.voxels as f64 })
    }
}
