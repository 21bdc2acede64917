//! Cutting a scene into sub-volumes (§4.1, §4.2), one for each group of cells, and laying it out so.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::cancel::Cancel;
use crate::error::InputError;
use crate::geometry::partition::{self, SubVolume, Weight};
use crate::geometry::{Bounds, Numbering, Partition, Ray};
use crate::input::text::plural;
use crate::machine::KernelTimes;
use crate::scene::Mesh;

use super::array_program::{ArrayProgram, Kernel};
use super::layout::{Layout, NotLaidOut, Surfaces};
use super::tracer::{Tracer, WorkSample};
use super::workload::Workload;

/// One ray in so many is traced ahead to find where the work is (§4.1: 1.5 % of the pixels).
const SAMPLE_EVERY: usize = 67;

/// How often the parts are cut again at the most, and how often in a row to no avail.
const MOST_ROUNDS: usize = 24;
const ROUNDS_IN_VAIN: usize = 6;

/// Of how many rounds the measurements count, each half of the one after it: from the last one alone parts swing to and fro.
const ROUNDS_REMEMBERED: usize = 4;

/// What a cut looks at before it is made.
#[derive(Clone, Debug, Default)]
pub struct Sample {
    /// A few of the run's rays, which are traced ahead.
    pub rays: Vec<Ray>,
    /// The surfaces laid out for one cell, if they are: their grid need not be filled again.
    pub in_one_cell: Option<Arc<Layout>>,
}

/// The rays that a cut looks at, of those of a run.
pub fn sub_sample(rays: &[Ray]) -> Vec<Ray> {
    rays.iter().step_by(SAMPLE_EVERY).copied().collect()
}

impl Workload {
    /// Lays a mesh out for an array program. `rays` are those of the run.
    ///
    /// Fails as [`Layout::new`] does.
    pub fn new(mesh: &Mesh, program: &ArrayProgram, times: KernelTimes, rays: &[Ray]) -> Result<Workload, InputError> {
        let surfaces = Arc::new(Surfaces::new(mesh, rays));
        let sample = Sample { rays: sub_sample(rays), in_one_cell: None };
        match Layout::new(surfaces, program, times, sample, &Cancel::default()) {
            Ok(layout) => Ok(Workload::of(Arc::new(layout), program, times)),
            Err(NotLaidOut::Unfit(error)) => Err(error),
            Err(NotLaidOut::Cancelled(cancelled)) => Err(InputError::new(cancelled.to_string())),
        }
    }
}

impl Layout {
    /// Lays surfaces out. Cuts by work weigh what they find by `times`, and trace the sample's rays ahead; so does a numbering from front
    /// to back. Nothing else looks at either.
    ///
    /// # Errors
    ///
    /// If there are more groups than polygons, if a grid would be too large, and if it is told to stop.
    pub fn new(
        surfaces: Arc<Surfaces>,
        program: &ArrayProgram,
        times: KernelTimes,
        sample: Sample,
        cancel: &Cancel,
    ) -> Result<Layout, NotLaidOut> {
        let Sample { rays, in_one_cell } = sample;
        let boxes = Cut { surfaces: &surfaces, program, times, sample: &rays, cancel }.boxes(in_one_cell)?;
        Layout::in_boxes(surfaces, &boxes, program.grid_coefficient, cancel)
    }
}

impl Surfaces {
    /// The sub-volumes that [`Layout::new`] would give the groups, without filling the groups' grids. It fails as that does.
    pub fn sub_volumes(
        self: &Arc<Surfaces>,
        program: &ArrayProgram,
        times: KernelTimes,
        sample: &[Ray],
        cancel: &Cancel,
    ) -> Result<Vec<SubVolume>, NotLaidOut> {
        let cut = Cut { surfaces: self, program, times, sample, cancel };
        Ok(partition::assign(&self.polygons, &cut.boxes(None)?))
    }
}

/// What a cut depends on.
struct Cut<'a> {
    surfaces: &'a Arc<Surfaces>,
    program: &'a ArrayProgram,
    times: KernelTimes,
    /// The rays that are traced ahead.
    sample: &'a [Ray],
    cancel: &'a Cancel,
}

impl Cut<'_> {
    /// The boxes of the sub-volumes, in the order of the groups.
    fn boxes(&self, in_one_cell: Option<Arc<Layout>>) -> Result<Vec<Bounds>, NotLaidOut> {
        self.program.check()?;
        let (polygons, groups) = (&self.surfaces.polygons, self.program.groups);
        if groups > polygons.len() {
            let message =
                format!("{groups} groups are more than the scene's {}", plural(polygons.len() as u64, "polygon"));
            return Err(InputError::new(message).help("use fewer cells or a larger scene").into());
        }
        let all: Vec<u32> = (0..polygons.len() as u32).collect();
        let volume = partition::reached(polygons, &all);
        if volume.is_empty() || groups == 1 {
            return Ok(vec![volume; groups]);
        }
        let weighted = |mut weights: Vec<Weight>| self.numbered(partition::weighted(volume, &mut weights, groups));
        match self.program.partition {
            Partition::Regular => Ok(self.numbered(partition::regular(volume, groups))),
            Partition::Polygons => Ok(weighted(partition::polygon_weights(polygons))),
            Partition::Work => Ok(weighted(self.work_in_one_cell(volume, in_one_cell)?)),
            Partition::Measured => self.measured(weighted(self.work_in_one_cell(volume, in_one_cell)?), weighted),
        }
    }

    fn numbered(&self, boxes: Vec<Bounds>) -> Vec<Bounds> {
        match self.program.numbering {
            Numbering::Cut => boxes,
            Numbering::Front => partition::front_to_back(boxes, self.sample),
        }
    }

    /// Where one cell with the whole scene would work how long.
    fn work_in_one_cell(&self, volume: Bounds, in_one_cell: Option<Arc<Layout>>) -> Result<Vec<Weight>, NotLaidOut> {
        let stage = if self.program.placement().slabs.is_some() {
            vec![Kernel::Grid, Kernel::Slabs, Kernel::Intersection]
        } else {
            vec![Kernel::Grid, Kernel::Intersection]
        };
        let one_cell = ArrayProgram { stages: vec![stage], ..ArrayProgram::one_cell(self.program.grid_coefficient) };
        let layout = in_one_cell.map_or_else(|| self.laid_out(&[volume]), Ok)?;
        Ok(self.work(&one_cell, layout)?.stages.swap_remove(0))
    }

    /// Cuts again where the groups, cut into `boxes`, work how long, until the busiest cell has no less to do for some rounds.
    fn measured(
        &self,
        mut boxes: Vec<Bounds>,
        weighted: impl Fn(Vec<Weight>) -> Vec<Bounds>,
    ) -> Result<Vec<Bounds>, NotLaidOut> {
        let (mut best, mut least, mut in_vain) = (boxes.clone(), f64::INFINITY, 0);
        let mut rounds: VecDeque<Vec<Weight>> = VecDeque::new();
        for _ in 0..MOST_ROUNDS {
            let mut work = self.work(self.program, self.laid_out(&boxes)?)?;
            let busiest = work.groups.iter().flatten().copied().fold(0.0, f64::max);
            if busiest < least {
                (best, least, in_vain) = (boxes, busiest, 0);
            } else {
                in_vain += 1;
            }
            if in_vain == ROUNDS_IN_VAIN {
                break;
            }
            // The stage that has most to do is the one to be evened out.
            let total = |stage: usize| work.groups.iter().map(|cells| cells[stage]).sum::<f64>();
            let stage = (0..work.stages.len()).max_by(|&a, &b| total(a).total_cmp(&total(b))).unwrap_or(0);
            rounds.push_front(work.stages.swap_remove(stage));
            rounds.truncate(ROUNDS_REMEMBERED);
            let aged = |(age, weights): (usize, &Vec<Weight>)| {
                let share = 0.5f64.powi(age as i32);
                weights.iter().map(|weight| Weight { amount: weight.amount * share, ..*weight }).collect::<Vec<_>>()
            };
            boxes = weighted(rounds.iter().enumerate().flat_map(aged).collect());
        }
        Ok(best)
    }

    fn laid_out(&self, boxes: &[Bounds]) -> Result<Arc<Layout>, NotLaidOut> {
        Layout::in_boxes(self.surfaces.clone(), boxes, self.program.grid_coefficient, self.cancel).map(Arc::new)
    }

    /// What the cells of a program do for the sample, when the scene is laid out so.
    fn work(&self, program: &ArrayProgram, layout: Arc<Layout>) -> Result<WorkSample, NotLaidOut> {
        let mut work = WorkSample::new(layout.groups.len(), program.stages.len());
        let workload = Workload { screening: None, ..Workload::of(layout, program, self.times) };
        let mut tracer = Tracer::new(&workload);
        for ray in self.sample {
            self.cancel.check()?;
            tracer.sample(ray, &mut work);
        }
        Ok(work)
    }
}
