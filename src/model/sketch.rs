//! A sub-volume in outline: how much of which polygons lies where, and how a few of the rays run through it.

use std::ops::ControlFlow;

use glam::DVec3;

use super::footprint::{Footprint, area_vector};
use crate::cancel::Cancel;
use crate::geometry::grid::Unfilled;
use crate::geometry::{Bounds, Grid, Hit, Polygons, Ray, RaySlabs, Slabs};
use crate::program::{Masks, Screening};
use crate::scene::Camera;

/// The sketch's grid has so many times fewer voxels than the one that it is made for. Walks that stop at a hit see the
/// front of what stands in a voxel: much coarser ones would spread it over too much empty space.
const COARSER: f64 = 6.0;

/// The fewest and the most voxels of a sketch.
const FEWEST_VOXELS: f64 = 64.0;
const MOST_VOXELS: f64 = 1e6;

/// The share of a voxel's mean chord that lies behind a point on it, on average over the points of random chords.
const REST_OF_VOXEL: f64 = 0.6;

/// A ray that passes a polygon within its slabs shares a voxel with it the less often, the more voxels (so many) it spans.
const NEAR_VOXELS: f64 = 4.0;

/// What a sub-volume's cells do for a ray, on average over all rays, those that miss it among them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayWork {
    /// nb_steps: voxels walked through.
    pub voxels: f64,
    /// nb_filter1: polygons that the grid lets through.
    pub candidates: f64,
    /// nb_filter2: polygons that the slabs let through, too.
    pub survivors: f64,
    /// Share of the rays that have any candidate.
    pub finds: f64,
    /// Share of the rays that have any survivor.
    pub meets: f64,
    /// Share of the rays whose mask spares them the sub-volume: its cells only pass them on.
    pub spared: f64,
}

impl RayWork {
    /// Share of the rays that the cells begin.
    pub fn begun(&self) -> f64 {
        1.0 - self.spared
    }
}

/// A sub-volume with a coarse grid, and a sample of the rays.
#[derive(Debug)]
pub(super) struct Sketch<'a> {
    polygons: &'a Polygons,
    slabs: &'a Slabs,
    grid: Grid,
    /// How near to a face of the volume counts as at the face.
    tolerance: f64,
    /// Which of the sub-volume's polygons, counting from 0, each of the scene's is.
    place: Vec<u32>,
    /// The footprint of each of the sub-volume's polygons in a unit of each coarse voxel that lists it.
    shares: Vec<Footprint>,
    /// All polygons' footprint.
    pub all: Footprint,
    /// The sum of their areas.
    pub area: f64,
    /// The sum of their perimeters.
    pub perimeter: f64,
    /// The rays, each cut off where its walk ends.
    rays: Vec<Ray>,
    /// Share of them that masks spare the sub-volume.
    spared: f64,
}

impl<'a> Sketch<'a> {
    /// Sketches a sub-volume for grids of about `coefficient` voxels a polygon. `stops` says whether walks end at hits.
    pub fn new(
        (polygons, slabs): (&'a Polygons, &'a Slabs),
        (volume, members): (Bounds, &[u32]),
        rays: &[Ray],
        stops: bool,
        coefficient: f64,
    ) -> Result<Sketch<'a>, Unfilled> {
        let count = members.len().max(1) as f64;
        let voxels = (coefficient / COARSER * count).clamp(FEWEST_VOXELS, MOST_VOXELS);
        let grid = Grid::new(polygons, members, volume, voxels / count, &Cancel::default())?;
        let mut sketch = Sketch {
            polygons,
            slabs,
            tolerance: 4.0 * polygons.margin(),
            place: vec![u32::MAX; polygons.len()],
            shares: vec![Footprint::default(); members.len()],
            all: Footprint::default(),
            area: 0.0,
            perimeter: 0.0,
            rays: Vec::new(),
            spared: 0.0,
            grid,
        };
        sketch.spread(members);
        sketch.rays = rays.iter().map(|&ray| if stops { sketch.cut_off(ray) } else { ray }).collect();
        Ok(sketch)
    }

    /// The volume that the grid fills.
    pub fn volume(&self) -> Bounds {
        self.grid.volume()
    }

    /// The same where masks spare the sub-volume the rays that cannot meet it.
    pub fn masked(mut self, rays: &[Ray], (masks, camera): (Masks, &Camera)) -> Sketch<'a> {
        if let Some(screening) = Screening::new(masks) {
            let screening = screening.seen_by(camera, self.polygons, [&self.grid]);
            let spared = rays.iter().filter(|ray| !screening.admits(ray, self.polygons, (0, &self.grid)));
            self.spared = spared.count() as f64 / rays.len().max(1) as f64;
        }
        self
    }

    /// Spreads each polygon evenly over the coarse voxels that list it.
    fn spread(&mut self, members: &[u32]) {
        (0..).zip(members).for_each(|(place, &polygon)| self.place[polygon as usize] = place);
        let mut listed = vec![0u32; members.len()];
        self.grid.lists().flatten().for_each(|&polygon| listed[self.place[polygon as usize] as usize] += 1);
        let size = DVec3::from_array(self.grid.size().map(f64::from));
        let voxel = (self.volume().extent() / size).element_product();
        for (place, &polygon) in members.iter().enumerate().filter(|&(place, _)| listed[place] > 0) {
            let corners: Vec<DVec3> = self.polygons.flattened(polygon).collect();
            let footprint = Footprint::within(corners.iter().copied(), self.volume(), self.tolerance);
            self.shares[place] = footprint * (1.0 / (listed[place] as f64 * voxel));
            self.all += footprint;
            self.area += area_vector(&corners).length();
            let edges = (0..corners.len()).map(|k| corners[(k + 1) % corners.len()].distance(corners[k]));
            self.perimeter += edges.sum::<f64>();
        }
    }

    /// The ray up to its first hit in the sub-volume.
    fn cut_off(&self, ray: Ray) -> Ray {
        let mut hit = Hit::MISS;
        self.grid.walk(&ray, 0.0, |voxel| {
            hit = voxel.polygons.iter().fold(hit, |hit, &polygon| self.polygons.nearer(&ray, polygon, hit));
            if hit.t <= voxel.t_exit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        Ray { t_max: ray.t_max.min(hit.t), ..ray }
    }

    /// What a ray does in a grid of voxels with edges `edge`.
    pub fn work(&self, edge: DVec3) -> RayWork {
        let mut seen = vec![u32::MAX; self.shares.len()];
        let mut sum = RayWork::default();
        for (id, ray) in (0..).zip(&self.rays) {
            let Some(span) = self.span(ray) else { continue };
            let one = self.ray_work(ray, span, edge, |polygon| {
                std::mem::replace(&mut seen[self.place[polygon as usize] as usize], id) != id
            });
            sum.voxels += one.voxels;
            sum.candidates += one.candidates;
            sum.survivors += one.survivors;
            // Candidates fall as they may: so many on average leave a ray without any with probability exp(-so many).
            sum.finds += (1.0 - (-one.candidates).exp()).max(one.meets);
            sum.meets += one.meets;
        }
        let share = 1.0 / self.rays.len().max(1) as f64;
        RayWork {
            voxels: sum.voxels * share,
            candidates: sum.candidates * share,
            survivors: sum.survivors * share,
            finds: sum.finds * share,
            meets: sum.meets * share,
            spared: self.spared,
        }
    }

    /// One ray's. `is_new` says whether a polygon is met for the first time on this ray.
    fn ray_work(
        &self,
        ray: &Ray,
        (enters, leaves): (f64, f64),
        edge: DVec3,
        mut is_new: impl FnMut(u32) -> bool,
    ) -> RayWork {
        let crossings = ray.direction.as_dvec3().abs() / edge;
        // Its last voxel is done as a whole: what stands in it behind the ray's end counts.
        let rest = REST_OF_VOXEL / crossings.element_sum();
        let reach = Ray { t_max: (f64::from(ray.t_max).min(leaves) + rest) as f32, ..*ray };
        let ray_slabs = RaySlabs::new(&reach, self.polygons.largest_coordinate());
        let mut work = RayWork::default();
        let mut here = 0.0;
        let mut t = enters;
        self.grid.walk(ray, 0.0, |voxel| {
            let density = voxel.polygons.iter().fold(Footprint::default(), |mut sum, &polygon| {
                sum += self.shares[self.place[polygon as usize] as usize];
                sum
            });
            here = density.voxels(edge) * edge.element_product();
            if work.voxels == 0.0 {
                // The voxel that the ray starts in; half of one if it comes in through a face, where voxels begin.
                let first = if enters > 0.0 { 0.5 } else { 1.0 };
                work.voxels += first;
                work.candidates += first * here;
            }
            let t_exit = f64::from(voxel.t_exit.min(ray.t_max)).max(t);
            let steps = crossings.element_sum() * (t_exit - t);
            work.voxels += steps;
            work.candidates += steps * here;
            t = t_exit;
            for &polygon in voxel.polygons {
                if is_new(polygon) && self.slabs.meets(&ray_slabs, polygon) {
                    work.meets = 1.0;
                    work.survivors += self.shared_voxels(ray, (enters - rest, &reach), polygon, edge);
                }
            }
            ControlFlow::Continue(())
        });
        if work.voxels > 0.0 && leaves < f64::from(ray.t_max) {
            // It leaves through a face, where voxels end.
            work.voxels -= 0.5;
            work.candidates -= 0.5 * here;
        }
        work
    }

    /// The voxels that a ray shares with a polygon whose slabs it meets. Only hits from `from` on, and within `reach`, are in
    /// this sub-volume.
    ///
    /// With an endless plane it would share Σ|d_i|/e_i Σ|n_i|e_i / |n.d|: the voxels on the ray from where they first touch
    /// the plane to where they last do. With a polygon it shares at most one, and one more for each plane between voxels
    /// that the polygon's box spans.
    fn shared_voxels(&self, ray: &Ray, (from, reach): (f64, &Ray), polygon: u32, edge: DVec3) -> f64 {
        let direction = ray.direction.as_dvec3();
        let normal = self.polygons.normal(polygon).as_dvec3();
        let bounds = Bounds::around(self.polygons.flattened(polygon));
        let plane = (direction.abs() / edge).element_sum() * normal.abs().dot(edge) / normal.dot(direction).abs() - 1.0;
        let spanned = (bounds.extent() / edge).element_sum();
        let further = 1.0 / (1.0 / plane).hypot(1.0 / spanned);
        let hit = self.polygons.nearer(reach, polygon, Hit::MISS);
        if !hit.is_hit() || f64::from(hit.t) < from {
            return (1.0 + further) / (1.0 + spanned / NEAR_VOXELS);
        }
        // A walk that ends on the polygon has seen the half before it, or all, where nothing lies behind.
        let ends_here = hit.t >= ray.t_max && !self.is_wall(bounds);
        1.0 + if ends_here { further / 2.0 } else { further }
    }

    /// Whether a polygon lies in a face of the volume.
    fn is_wall(&self, bounds: Bounds) -> bool {
        let volume = self.volume();
        (0..3).any(|axis| {
            let flat = bounds.extent()[axis] <= self.tolerance;
            let low = bounds.low[axis] - volume.low[axis] <= self.tolerance;
            flat && (low || volume.high[axis] - bounds.high[axis] <= self.tolerance)
        })
    }

    /// Where a ray enters the volume, or starts in it, and where it leaves it or ends.
    fn span(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let (a, b) = ((self.volume().low - origin) / direction, (self.volume().high - origin) / direction);
        let enters = a.min(b).max_element().max(0.0);
        let leaves = a.max(b).min_element();
        (enters <= leaves).then_some((enters, leaves))
    }
}
