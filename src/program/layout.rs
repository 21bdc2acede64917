//! Laying a scene out: cutting it into sub-volumes and filling each one's grid.

use crate::error::InputError;
use crate::geometry::grid::GridTooLarge;
use crate::geometry::{Bounds, Grid, Partition, Polygons, Ray, Slabs, partition};
use crate::scene::Mesh;

use super::array_program::{ArrayProgram, Stages};
use super::kernel::KernelTimes;
use super::trace::{Tracer, WorkSample};
use super::workload::{Group, Workload};

/// One ray in so many is traced ahead to find where the work is (§4.1: 1.5 % of the pixels).
const SAMPLE_EVERY: usize = 67;

impl Workload {
    /// Lays a scene out. `rays` are those of the run, of which the partition by work traces a few ahead.
    ///
    /// Fails if there are more groups than polygons, or if a grid would be too large.
    pub fn new(mesh: &Mesh, program: &ArrayProgram, times: KernelTimes, rays: &[Ray]) -> Result<Workload, InputError> {
        program.check()?;
        let polygons = Polygons::for_rays(mesh, rays);
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
            programs: None,
        };
        let boxes = workload.cut(program, rays)?;
        workload.groups = workload.fill_groups(&boxes, program.grid_coefficient)?;
        Ok(workload)
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
        let too_large = |error: GridTooLarge| InputError::new(error.to_string());
        let fill = |sub_volume: partition::SubVolume| {
            let grid = Grid::new(&self.polygons, &sub_volume.members, sub_volume.volume, coefficient);
            Ok(Group { grid: grid.map_err(too_large)?, members: sub_volume.members })
        };
        partition::assign(&self.polygons, boxes).into_iter().map(fill).collect()
    }
}
