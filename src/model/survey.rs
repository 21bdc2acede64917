//! What is measured of a scene and its rays before anything is predicted.

use rayon::prelude::*;

use super::prediction::{Group, Prediction};
use super::sketch::Sketch;
use super::throughput::ArrayModel;
use crate::geometry::grid::{Unfilled, voxels_for};
use crate::geometry::partition::SubVolume;
use crate::geometry::{Polygons, Ray, Slabs};
use crate::program::Masks;
use crate::scene::Camera;

/// How many of the rays are looked at.
const SAMPLE: usize = 2000;

/// How many of them the search for the best coefficient looks at: it compares ten predictions, and what is amiss in a
/// smaller sample is amiss in all of them alike.
const SEARCH_SAMPLE: usize = SAMPLE / 4;

/// The coefficients of the grids that the search really builds: one that stands for the coarse grids, and the annex's.
const COARSE: f64 = 4.0;
const FINE: f64 = 50.0;

/// Coefficients above this one are nearer to the fine grid: about the geometric mean of the two.
const NEARER_TO_FINE: f64 = 14.0;

/// The coefficients among which the best is sought.
const COEFFICIENTS: [f64; 10] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];

/// A scene, cut into sub-volumes, with its rays: what predictions are made from.
#[derive(Debug)]
pub struct Survey<'a> {
    polygons: &'a Polygons,
    slabs: Slabs,
    sub_volumes: &'a [SubVolume],
    rays: Vec<Ray>,
    masks: Option<(Masks, &'a Camera)>,
}

impl<'a> Survey<'a> {
    /// Surveys a scene. Of the rays a sample is kept, spread evenly over all of them.
    pub fn new(polygons: &'a Polygons, sub_volumes: &'a [SubVolume], rays: &[Ray]) -> Survey<'a> {
        Survey { polygons, slabs: Slabs::new(polygons), sub_volumes, rays: sample(rays), masks: None }
    }

    /// The same where masks spare sub-volumes rays. `camera` is the one whose eye the rays are from.
    pub fn masked(self, masks: Masks, camera: &'a Camera) -> Survey<'a> {
        Survey { masks: Some((masks, camera)), ..self }
    }

    /// What an array will have to do, with so many voxels a polygon.
    ///
    /// Fails if the grids would be larger than any that can be built.
    pub fn predict(&self, array: &ArrayModel, coefficient: f64) -> Result<Prediction, Unfilled> {
        self.sub_volumes.iter().try_for_each(|part| voxels_for(part.members.len(), coefficient).map(drop))?;
        let groups = self.sketch(array, coefficient)?;
        Ok(self.price(&groups, array, coefficient))
    }

    /// The coefficient with the fewest cycles a ray, of 0.5, 1, 2, 5, ... 500, and what to expect of it.
    pub fn best_coefficient(&self, array: &ArrayModel) -> Result<(f64, Prediction), Unfilled> {
        let few = Survey { rays: sample_of(&self.rays, SEARCH_SAMPLE), slabs: self.slabs.clone(), ..*self };
        let sketches = [few.sketch(array, COARSE)?, few.sketch(array, FINE)?];
        let price = |&coefficient: &f64| {
            let prediction = few.price(&sketches[usize::from(coefficient > NEARER_TO_FINE)], array, coefficient);
            (coefficient, prediction)
        };
        let priced: Vec<(f64, Prediction)> = COEFFICIENTS.par_iter().map(price).collect();
        let cycles = |entry: &(f64, Prediction)| entry.1.bound.cycles_per_ray;
        // COEFFICIENTS is not empty.
        Ok(priced.into_iter().min_by(|a, b| cycles(a).total_cmp(&cycles(b))).unwrap_or_default())
    }

    fn sketch(&self, array: &ArrayModel, coefficient: f64) -> Result<Vec<Sketch<'_>>, Unfilled> {
        let scene = (self.polygons, &self.slabs);
        let sketch = |part: &SubVolume| {
            let sketch = Sketch::new(scene, (part.volume, &part.members), &self.rays, array.walks_stop(), coefficient)?;
            Ok(match self.masks {
                Some(masks) => sketch.masked(&self.rays, masks),
                None => sketch,
            })
        };
        self.sub_volumes.par_iter().map(sketch).collect()
    }

    fn price(&self, sketches: &[Sketch<'_>], array: &ArrayModel, coefficient: f64) -> Prediction {
        let group = |(sketch, part): (&Sketch<'_>, &SubVolume)| {
            Group::new(sketch, part.members.len() as f64, coefficient, 4.0 * self.polygons.margin())
        };
        let groups = sketches.par_iter().zip(self.sub_volumes).map(group).collect();
        Prediction::new(groups, array, coefficient)
    }
}

fn sample(rays: &[Ray]) -> Vec<Ray> {
    sample_of(rays, SAMPLE)
}

/// So many of the rays, spread evenly: steps of the golden section never fall in with an image's lines.
fn sample_of(rays: &[Ray], count: usize) -> Vec<Ray> {
    if rays.len() <= count {
        return rays.to_vec();
    }
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    (0..count).map(|k| rays[((k as f64 * golden).fract() * rays.len() as f64) as usize]).collect()
}
