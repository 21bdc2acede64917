//! Laying a scene out: cutting it into sub-volumes and filling each one's grid.

use crate::error::InputError;
use crate::geometry::grid::GridTooLarge;
use crate::geometry::partition::SubVolume;
use crate::geometry::{Bounds, Grid, Partition, Polygons, Ray, Slabs, partition};
use crate::machine::KernelTimes;
use crate::scene::Mesh;

use super::array_program::{ArrayProgram, Stages};
use super::stop_words::StopWords;
use super::tracer::{Tracer, WorkSample};
use super::work;
use super::workload::{Group, Workload};

/// One ray in so many is traced ahead to find where the work is (§4.1: 1.5 % of the pixels).
const SAMPLE_EVERY: usize = 67;

impl Workload {
    /// Lays a scene out. `rays` are those of the run, of which the partition by work traces a few ahead.
    ///
    /// Fails if there are more groups than polygons, or if a grid would be too large.
    pub fn new(mesh: &Mesh, program: &ArrayProgram, times: KernelTimes, rays: &[Ray]) -> Result<Workload, InputError> {
        let mut workload = Workload::without_groups(mesh, program, times, rays)?;
        let boxes = workload.cut(program, rays)?;
        workload.groups = workload.fill_groups(&boxes, program.grid_coefficient)?;
        Ok(workload)
    }

    /// The polygons and the sub-volumes that [`Workload::new`] would give the groups, without filling the groups' grids.
    pub fn sub_volumes(
        mesh: &Mesh,
        program: &ArrayProgram,
        times: KernelTimes,
        rays: &[Ray],
    ) -> Result<(Polygons, Vec<SubVolume>), InputError> {
        let workload = Workload::without_groups(mesh, program, times, rays)?;
        let sub_volumes = partition::assign(&workload.polygons, &workload.cut(program, rays)?);
        Ok((workload.polygons, sub_volumes))
    }

    fn without_groups(
        mesh: &Mesh,
        program: &ArrayProgram,
        times: KernelTimes,
        rays: &[Ray],
    ) -> Result<Workload, InputError> {
        program.check()?;
        let polygons = Polygons::for_rays(mesh, rays);
        if program.groups > polygons.len() {
            let message = format!("{} groups are more than the scene's {} polygons", program.groups, polygons.len());
            return Err(InputError::new(message).help("use fewer cells or a larger scene"));
        }
        Ok(Workload {
            slabs: Slabs::new(&polygons),
            polygons,
            groups: Vec::new(),
            stages: program.placement(),
            times,
            costs: work::costs(&work::vocabulary(false), &times, None),
            mailbox: program.mailbox,
            stop_words: program.stop_words.map(|ahead| StopWords { ahead, last: program.stages.len() - 1 }),
            forward_ahead: program.forward_ahead,
            kernels: program.stages.clone(),
            programs: None,
        })
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
            stop_words: None,
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
        let fill = |sub_volume: SubVolume| {
            let grid = Grid::new(&self.polygons, &sub_volume.members, sub_volume.volume, coefficient);
            Ok(Group { grid: grid.map_err(too_large)?, members: sub_volume.members })
        };
        partition::assign(&self.polygons, boxes).into_iter().map(fill).collect()
    }
}
