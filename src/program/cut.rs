//! Cutting a scene into sub-volumes (§4.1, §4.2), one for each group of cells, and laying it out so.

use std::sync::Arc;

use crate::cancel::Cancel;
use crate::error::InputError;
use crate::geometry::partition::{self, SubVolume, Weight};
use crate::geometry::{Bounds, Partition, Ray};
use crate::machine::KernelTimes;
use crate::scene::Mesh;

use super::array_program::{ArrayProgram, Stages};
use super::layout::{Layout, NotLaidOut, Surfaces};
use super::tracer::{Tracer, WorkSample};
use super::workload::Workload;

/// One ray in so many is traced ahead to find where the work is (§4.1: 1.5 % of the pixels).
const SAMPLE_EVERY: usize = 67;

impl Workload {
    /// Lays a mesh out for an array program. `rays` are those of the run.
    ///
    /// Fails as [`Layout::new`] does.
    pub fn new(mesh: &Mesh, program: &ArrayProgram, times: KernelTimes, rays: &[Ray]) -> Result<Workload, InputError> {
        let surfaces = Arc::new(Surfaces::new(mesh, rays));
        match Layout::new(surfaces, program, times, rays, &Cancel::default()) {
            Ok(layout) => Ok(Workload::of(Arc::new(layout), program, times)),
            Err(NotLaidOut::Unfit(error)) => Err(error),
            Err(NotLaidOut::Cancelled(cancelled)) => Err(InputError::new(cancelled.to_string())),
        }
    }
}

impl Layout {
    /// Lays surfaces out. The partition by work weighs what it finds by `times`, and traces a few of `rays` ahead, which are
    /// those of the run; nothing else looks at either.
    ///
    /// # Errors
    ///
    /// If there are more groups than polygons, if a grid would be too large, and if it is told to stop.
    pub fn new(
        surfaces: Arc<Surfaces>,
        program: &ArrayProgram,
        times: KernelTimes,
        rays: &[Ray],
        cancel: &Cancel,
    ) -> Result<Layout, NotLaidOut> {
        let boxes = cut(&surfaces, program, times, rays, cancel)?;
        Layout::in_boxes(surfaces, &boxes, program.grid_coefficient, cancel)
    }
}

impl Surfaces {
    /// The sub-volumes that [`Layout::new`] would give the groups, without filling the groups' grids. It fails as that does.
    pub fn sub_volumes(
        self: &Arc<Surfaces>,
        program: &ArrayProgram,
        times: KernelTimes,
        rays: &[Ray],
        cancel: &Cancel,
    ) -> Result<Vec<SubVolume>, NotLaidOut> {
        Ok(partition::assign(&self.polygons, &cut(self, program, times, rays, cancel)?))
    }
}

/// The boxes of the sub-volumes.
fn cut(
    surfaces: &Arc<Surfaces>,
    program: &ArrayProgram,
    times: KernelTimes,
    rays: &[Ray],
    cancel: &Cancel,
) -> Result<Vec<Bounds>, NotLaidOut> {
    program.check()?;
    let polygons = &surfaces.polygons;
    if program.groups > polygons.len() {
        let message = format!("{} groups are more than the scene's {} polygons", program.groups, polygons.len());
        return Err(InputError::new(message).help("use fewer cells or a larger scene").into());
    }
    let all: Vec<u32> = (0..polygons.len() as u32).collect();
    let volume = partition::reached(polygons, &all);
    if volume.is_empty() || program.groups == 1 {
        return Ok(vec![volume; program.groups]);
    }
    let weighted = |mut weights: Vec<Weight>| partition::weighted(volume, &mut weights, program.groups);
    Ok(match program.partition {
        Partition::Regular => partition::regular(volume, program.groups),
        Partition::Polygons => weighted(partition::polygon_weights(polygons)),
        Partition::Work => weighted(sample_work(surfaces, volume, program, times, rays, cancel)?),
    })
}

/// Traces a sub-sample of the rays through the whole scene in one cell and notes where it worked how long.
fn sample_work(
    surfaces: &Arc<Surfaces>,
    volume: Bounds,
    program: &ArrayProgram,
    times: KernelTimes,
    rays: &[Ray],
    cancel: &Cancel,
) -> Result<Vec<Weight>, NotLaidOut> {
    let layout = Layout::in_boxes(surfaces.clone(), &[volume], program.grid_coefficient, cancel)?;
    let slabs = program.placement().slabs.map(|_| 0);
    let whole = Workload { stop_words: None, screening: None, ..Workload::of(Arc::new(layout), program, times) };
    let whole = Workload { stages: Stages { slabs, intersection: 0 }, ..whole };
    let mut sample = WorkSample::default();
    let mut tracer = Tracer::new(&whole);
    for ray in rays.iter().step_by(SAMPLE_EVERY) {
        cancel.check()?;
        tracer.sample(ray, &mut sample);
    }
    Ok(sample.weights)
}
