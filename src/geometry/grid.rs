//! A.1: the three-dimensional grid, and a ray's walk through it (Amanatides & Woo).

use std::ops::ControlFlow;

use glam::Vec3;

use super::bounds::Bounds;
use super::clearance::Clearance;
use super::partition::reached;
use super::polygon::Polygons;
use super::ray::Ray;
use super::voxels::Lattice;
use super::walk::Walk;
use crate::cancel::{Cancel, Cancelled};

/// The most voxels of a grid.
pub const MOST_VOXELS: f64 = (1u64 << 29) as f64;

/// The most references to polygons in all voxels of a grid: a GiB. With so many voxels a polygon, polygons that lie in most voxels
/// would need a memory that grows with the square of their number.
pub const MOST_REFERENCES: f64 = (1u64 << 28) as f64;

/// A grid that would not fit into the simulator's memory.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the grid would have more than {most} {what}; a smaller grid coefficient makes fewer")]
pub struct GridTooLarge {
    what: &'static str,
    most: f64,
}

/// Why a grid was not filled.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfilled {
    /// It would be too large.
    #[error(transparent)]
    TooLarge(#[from] GridTooLarge),
    /// It was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// nb_voxel = `coefficient` x P, unless that is more than [`MOST_VOXELS`].
pub fn voxels_for(polygons: usize, coefficient: f64) -> Result<f64, GridTooLarge> {
    let voxels = coefficient * polygons as f64;
    if voxels > MOST_VOXELS { Err(GridTooLarge { what: "voxels", most: MOST_VOXELS }) } else { Ok(voxels) }
}

/// A grid over a volume: for each voxel the polygons that lie in it.
#[derive(Clone, Debug)]
pub struct Grid {
    lattice: Lattice,
    /// Along each axis, the planes between voxels; the outermost ones stand off by the margin.
    planes: [Vec<f32>; 3],
    /// 1 / edge of a voxel.
    per_edge: Vec3,
    low: Vec3,
    clearance: Clearance,
    /// Voxel v's list is lists[starts[v]..starts[v + 1]].
    starts: Vec<u32>,
    lists: Vec<u32>,
}

/// The way of a ray through empty voxels to one with polygons.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<'a> {
    /// All voxels of it, the one with polygons among them.
    pub voxels: u64,
    /// The polygons that lie in the last one.
    pub polygons: &'a [u32],
}

/// A voxel that a ray is in.
#[derive(Clone, Copy, Debug)]
pub struct Visit<'a> {
    /// Its number: x runs fastest.
    pub voxel: usize,
    /// The polygons that lie in it.
    pub polygons: &'a [u32],
    /// Where on the ray it is left.
    pub t_exit: f32,
}

impl Grid {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> u64 {
        let planes: usize = self.planes.iter().map(|planes| size_of_val(&planes[..])).sum();
        self.clearance.bytes() + (planes + size_of_val(&self.starts[..]) + size_of_val(&self.lists[..])) as u64
    }

    /// Fills a grid of `coefficient` x P voxels over the part of `volume` that the polygons `members` reach; P is their
    /// number. Fewer voxels where they would be thinner than 32-bit arithmetic can tell apart.
    ///
    /// Every polygon is listed in every voxel that it comes within [`Polygons::margin`] and its [`Polygons::slack`] of. Fails if that makes more than
    /// [`MOST_VOXELS`] voxels or [`MOST_REFERENCES`] references, and if it is told to stop.
    pub fn new(
        polygons: &Polygons,
        members: &[u32],
        volume: Bounds,
        coefficient: f64,
        cancel: &Cancel,
    ) -> Result<Grid, Unfilled> {
        let margin = polygons.margin();
        let reached = volume.intersection(reached(polygons, members));
        let volume = if reached.is_empty() { Bounds { low: volume.low, high: volume.low } } else { reached };
        let voxels = voxels_for(members.len(), coefficient)?;
        let lattice = Lattice::cubic(volume, voxels, 4.0 * margin);
        let (starts, lists) = fill(&lattice, (polygons, members), margin, cancel)?;
        Ok(Grid {
            planes: [0, 1, 2].map(|axis| planes(&lattice, axis, margin)),
            per_edge: (1.0 / lattice.voxel_extent()).as_vec3(),
            low: lattice.volume.low.as_vec3(),
            clearance: Clearance::new(lattice.size, &starts),
            starts,
            lists,
            lattice,
        })
    }

    /// The number of a voxel: x runs fastest.
    pub(super) fn index(&self, voxel: [u32; 3]) -> usize {
        self.lattice.index(voxel)
    }

    /// nb_voxel, the number of voxels.
    pub fn voxel_count(&self) -> usize {
        self.lattice.voxel_count()
    }

    /// Number of voxels along each axis.
    pub fn size(&self) -> [u32; 3] {
        self.lattice.size
    }

    /// The volume that the voxels fill.
    pub fn volume(&self) -> Bounds {
        self.lattice.volume
    }

    /// Every voxel's list of polygons, x running fastest.
    pub fn lists(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|pair| &self.lists[pair[0] as usize..pair[1] as usize])
    }

    /// Number of references to polygons in all voxels' lists.
    pub fn reference_count(&self) -> usize {
        self.lists.len()
    }

    /// Words of the voxel table and the index lists (equation 4): a word a voxel, one that closes the table, and a word
    /// a reference.
    pub fn memory_words(&self) -> u64 {
        self.starts.len() as u64 + self.lists.len() as u64
    }

    /// Along an axis, the planes between voxels; the outermost ones stand off by the margin.
    pub fn planes(&self, axis: usize) -> &[f32] {
        &self.planes[axis]
    }

    /// The corner with the smallest coordinates.
    pub fn low(&self) -> Vec3 {
        self.low
    }

    /// Along each axis, 1 / edge of a voxel.
    pub fn per_edge(&self) -> Vec3 {
        self.per_edge
    }

    /// The voxel table: where each voxel's list begins among all [`Grid::lists`], and at last where the last one ends.
    pub fn table(&self) -> &[u32] {
        &self.starts
    }

    /// The box of a voxel, by its number.
    pub fn bounds_of(&self, voxel: usize) -> Bounds {
        let [x, y, _] = self.size().map(|side| side as usize);
        let at = glam::DVec3::from_array([voxel % x, voxel / x % y, voxel / x / y].map(|at| at as f64));
        let (low, extent) = (self.lattice.volume.low, self.lattice.voxel_extent());
        Bounds { low: low + at * extent, high: low + (at + 1.0) * extent }
    }

    /// The middle of the voxel that holds a point, or the nearest one to it.
    pub fn voxel_center(&self, point: Vec3) -> glam::DVec3 {
        let voxel = self.voxel_at(point);
        let position = glam::DVec3::from_array(voxel.map(|n| n as f64 + 0.5));
        self.lattice.volume.low + position * self.lattice.voxel_extent()
    }

    /// Calls `visit` for each voxel along a ray, from the one it starts in or enters by, until it leaves the volume,
    /// passes t_max, or is told to stop. A ray that misses the volume visits none.
    ///
    /// A ray from out of reach (see [`super::rounding`]) is `strayed` from its true course by up to so much: if it enters the
    /// volume grown by that, it visits every voxel, at any of which it might be.
    #[inline]
    pub fn walk<'a>(&'a self, ray: &Ray, strayed: f32, mut visit: impl FnMut(Visit<'a>) -> ControlFlow<()>) {
        if self.lists.is_empty() {
            return;
        }
        let Some(t_enter) = self.enter(ray, strayed) else { return };
        if strayed > 0.0 {
            let all = (0..self.voxel_count()).map(|voxel| Visit {
                voxel,
                polygons: self.list(voxel),
                t_exit: f32::NEG_INFINITY,
            });
            let _ = { all }.try_for_each(visit);
            return;
        }
        let mut walk = Walk::new(self, ray, t_enter);
        loop {
            let (axis, t_exit) = walk.next_crossing();
            let polygons = if self.clearance.of(walk.voxel) == 0 { self.list(walk.voxel) } else { &[] };
            if visit(Visit { voxel: walk.voxel, polygons, t_exit }).is_break() {
                return;
            }
            if t_exit >= ray.t_max || !walk.cross(self, axis) {
                return;
            }
        }
    }

    /// The same walk for who does nothing in empty voxels but count them: calls `visit` for each voxel with polygons, which tells
    /// from where on the ray on nothing counts any more. The walk ends in the voxel that is left there. Returns the number of
    /// voxels behind the last one with polygons.
    #[inline]
    pub fn walk_occupied<'a>(&'a self, ray: &Ray, strayed: f32, mut visit: impl FnMut(Stretch<'a>) -> f32) -> u64 {
        if strayed > 0.0 {
            let mut voxels = 0;
            self.walk(ray, strayed, |voxel| {
                voxels += 1;
                if !voxel.polygons.is_empty() {
                    visit(Stretch { voxels: std::mem::take(&mut voxels), polygons: voxel.polygons });
                }
                ControlFlow::Continue(())
            });
            return voxels;
        }
        let Some(t_enter) = self.enter(ray, strayed).filter(|_| !self.lists.is_empty()) else { return 0 };
        let (mut walk, mut voxels, mut t_end) = (Walk::new(self, ray, t_enter), 0, ray.t_max);
        loop {
            let clearance = self.clearance.of(walk.voxel);
            if clearance > 1 {
                let leap = walk.leap(self, clearance, t_end);
                voxels += leap.voxels;
                if !leap.goes_on {
                    return voxels;
                }
                continue;
            }
            let (axis, t_exit) = walk.next_crossing();
            voxels += 1;
            if clearance == 0 {
                let polygons = self.list(walk.voxel);
                t_end = visit(Stretch { voxels: std::mem::take(&mut voxels), polygons }).min(t_end);
            }
            if t_exit >= t_end || !walk.cross(self, axis) {
                return voxels;
            }
        }
    }

    /// Whether a ray meets the volume, if any polygons lie in it: if it meets none, [`Grid::walk`] visits no voxel.
    pub fn meets(&self, ray: &Ray, strayed: f32) -> bool {
        !self.lists.is_empty() && self.enter(ray, strayed).is_some()
    }

    /// The box that a ray must enter to be walked, if the ray is strayed by no more than so much.
    pub fn entered(&self, strayed: f32) -> Bounds {
        if self.lists.is_empty() {
            return Bounds::EMPTY;
        }
        let low = [0, 1, 2].map(|axis| self.planes[axis][0]);
        let high = [0, 1, 2].map(|axis| self.planes[axis][self.lattice.size[axis] as usize]);
        let [low, high] = [low, high].map(|corner| Vec3::from_array(corner).as_dvec3());
        Bounds { low, high }.grown(f64::from(strayed))
    }

    /// Where a ray enters the volume grown by `margin`, or 0 if it starts inside; `None` if it misses it.
    fn enter(&self, ray: &Ray, margin: f32) -> Option<f32> {
        let (mut enters, mut leaves) = (0.0f32, ray.t_max);
        for axis in 0..3 {
            let low = self.planes[axis][0] - margin;
            let high = self.planes[axis][self.lattice.size[axis] as usize] + margin;
            let (o, inverse) = (ray.origin[axis], 1.0 / ray.direction[axis]);
            if inverse.is_finite() {
                let (a, b) = ((low - o) * inverse, (high - o) * inverse);
                enters = enters.max(a.min(b));
                leaves = leaves.min(a.max(b));
            } else if o < low || o > high {
                return None;
            }
        }
        (enters <= leaves).then_some(enters)
    }

    #[inline]
    fn list(&self, voxel: usize) -> &[u32] {
        &self.lists[self.starts[voxel] as usize..self.starts[voxel + 1] as usize]
    }

    pub(super) fn voxel_at(&self, point: Vec3) -> [u32; 3] {
        let steps = (point - self.low) * self.per_edge;
        // `as` takes what is below 0, or not a number in a flat volume, to 0.
        [0, 1, 2].map(|axis| (steps[axis] as u32).min(self.lattice.size[axis] - 1))
    }
}

/// The planes between voxels along an axis.
fn planes(lattice: &Lattice, axis: usize, margin: f64) -> Vec<f32> {
    let count = lattice.size[axis];
    let (low, edge) = (lattice.volume.low[axis], lattice.voxel_extent()[axis]);
    let mut planes: Vec<f32> = (0..=count).map(|n| (low + n as f64 * edge) as f32).collect();
    planes[0] = (low - margin) as f32;
    planes[count as usize] = (lattice.volume.high[axis] + margin) as f32;
    planes
}

/// The voxel table and the index lists, each list in rising order: the voxels of all polygons are found and counted first, then
/// the lists are filled.
fn fill(
    lattice: &Lattice,
    (polygons, members): (&Polygons, &[u32]),
    margin: f64,
    cancel: &Cancel,
) -> Result<(Vec<u32>, Vec<u32>), Unfilled> {
    // Of each voxel what its list has, two places on: in the end each place holds where its voxel's list begins.
    let mut starts = vec![0u32; lattice.voxel_count() + 2];
    let mut reached: Vec<u32> = Vec::new();
    let mut ends = Vec::with_capacity(members.len());
    for &polygon in members {
        lattice.for_each_voxel(polygons, polygon, margin + polygons.slack(polygon), |voxel| {
            starts[voxel + 2] += 1;
            reached.push(voxel as u32);
        });
        if reached.len() as f64 > MOST_REFERENCES {
            return Err(GridTooLarge { what: "references to polygons", most: MOST_REFERENCES }.into());
        }
        ends.push(reached.len());
        cancel.check()?;
    }
    for voxel in 2..starts.len() {
        starts[voxel] += starts[voxel - 1];
    }
    let mut lists = vec![0u32; reached.len()];
    let mut first = 0;
    for (&polygon, end) in members.iter().zip(ends) {
        cancel.check()?;
        for &voxel in &reached[first..end] {
            let next = &mut starts[voxel as usize + 1];
            lists[*next as usize] = polygon;
            *next += 1;
        }
        first = end;
    }
    starts.pop();
    Ok((starts, lists))
}
