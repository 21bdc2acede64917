//! The functional half: what a ray meets in each region on its way, and which pages of a shared memory it reads.

use std::ops::ControlFlow;

use super::graph::Leg;
use crate::geometry::{Grid, Hit, Polygons, Pyramids, Ray, RaySlabs, Regions};
use crate::program::{Spared, Workload};

/// Traces rays through the regions of a scene. Each thread has its own.
#[derive(Debug)]
pub struct Walker<'a> {
    workload: &'a Workload,
    space: Space<'a>,
    pages: Option<PageMap>,
    /// What was spared as rays leave out the polygons that they start on.
    pub spared: Spared,
}

/// A ray on its way, and the polygon that it starts on, if it says that it does not hit that.
pub type Leaving<'a> = (&'a Ray, Option<u32>);

/// How a scene is told apart into regions.
#[derive(Clone, Copy, Debug)]
pub struct Space<'a> {
    /// The regions.
    pub regions: &'a Regions,
    /// Their own grids, if they have any.
    pub own: &'a [Grid],
    /// The pyramids that their cells are, if they are.
    pub pyramids: Option<&'a Pyramids>,
}

impl<'a> Space<'a> {
    /// Regions that are parts of the one grid.
    pub fn of(regions: &'a Regions) -> Space<'a> {
        Space { regions, own: &[], pyramids: None }
    }
}

/// Where a scene is in a shared memory: the table of voxels, their lists, then the polygons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PageMap {
    page_bytes: u64,
    lists: u64,
    polygons: u64,
    polygon_bytes: u64,
    end: u64,
}

/// Bytes of a word of tables and lists.
const WORD: u64 = 4;

/// Bytes of the database for each polygon, its grid included: 140 Mbyte for 1 048 576 polygons (Ray Tracing News).
const BYTES_PER_POLYGON: u64 = 134;

impl PageMap {
    /// The memory of a scene with a grid, in pages of so many bytes.
    pub fn new(grid: &Grid, polygons: &Polygons, page_bytes: u32) -> PageMap {
        let lists = WORD * (grid.voxel_count() as u64 + 1);
        let start = lists + WORD * grid.reference_count() as u64;
        let count = polygons.len() as u64;
        let own = WORD * polygons.memory_words(&(0..polygons.len() as u32).collect::<Vec<_>>()) / count.max(1);
        let polygon_bytes = ((BYTES_PER_POLYGON * count).saturating_sub(start) / count.max(1)).max(own);
        let end = start + polygon_bytes * count;
        PageMap { page_bytes: u64::from(page_bytes.max(1)), lists, polygons: start, polygon_bytes, end }
    }

    /// Bytes of the whole scene.
    pub fn bytes(&self) -> u64 {
        self.end
    }

    /// How many pages there are.
    pub fn pages(&self) -> u32 {
        self.end.div_ceil(self.page_bytes) as u32
    }

    fn of_voxel(&self, voxel: usize) -> u32 {
        (WORD * voxel as u64 / self.page_bytes) as u32
    }

    fn of_list(&self, first: u32) -> u32 {
        ((self.lists + WORD * u64::from(first)) / self.page_bytes) as u32
    }

    fn of_polygon(&self, polygon: u32) -> u32 {
        ((self.polygons + self.polygon_bytes * u64::from(polygon)) / self.page_bytes) as u32
    }
}

impl<'a> Walker<'a> {
    /// A walker through the grid of a workload that has one. With `pages`, it notes which are read.
    pub fn new(workload: &'a Workload, space: Space<'a>, pages: Option<PageMap>) -> Walker<'a> {
        Walker { workload, space, pages, spared: Spared::default() }
    }

    /// The first hit of a ray where each region has a grid of its own. Adds its legs.
    ///
    /// Which regions the ray comes to is told by the one grid, as before; in each it walks through that region's, and what lies beyond
    /// the end of its leg is forgotten, as before. A region holds all polygons that come near it, as a group of an array does, so
    /// that the same is found.
    pub fn trace_own(&mut self, leaving: Leaving<'_>, legs: &mut Vec<Leg>) -> Hit {
        let (workload, regions) = (self.workload, self.space.regions);
        let (Some(grid), ray) = (workload.grids().next(), leaving.0) else { return Hit::MISS };
        let strayed = workload.polygons().beyond_margin(ray.origin);
        if strayed > 0.0 {
            return self.trace_strayed(grid, leaving, strayed, legs);
        }
        let (mut hit, mut is_found, mut at) = (Hit::MISS, false, None);
        grid.walk(ray, strayed, |voxel| {
            let region = regions.of_voxel(voxel.voxel);
            if let Some((left, t_exit)) = at.replace((region, voxel.t_exit))
                && left != region
            {
                hit = self.walk_own(leaving, strayed, (left, t_exit), legs);
                is_found = hit.t <= t_exit;
            }
            if is_found { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        match at {
            Some(last) if !is_found => self.walk_own(leaving, strayed, last, legs),
            _ => hit,
        }
    }

    /// All regions work on a ray that has strayed, if it comes near the volume.
    fn trace_strayed(&mut self, grid: &Grid, leaving: Leaving<'_>, strayed: f32, legs: &mut Vec<Leg>) -> Hit {
        let mut comes = false;
        grid.walk(leaving.0, strayed, |_| {
            comes = true;
            ControlFlow::Break(())
        });
        let regions = (0..self.space.regions.count() as u16).filter(|_| comes);
        let hits = regions.map(|region| self.walk_own(leaving, strayed, (region, f32::INFINITY), legs));
        hits.fold(Hit::MISS, Hit::nearer)
    }

    /// A ray's way through the grid of a region, up to where it leaves it, and the nearest hit there. Adds the leg.
    fn walk_own(
        &mut self,
        (ray, own): Leaving<'_>,
        strayed: f32,
        (region, t_exit): (u16, f32),
        legs: &mut Vec<Leg>,
    ) -> Hit {
        let polygons = self.workload.polygons();
        let slabs = &self.workload.layout.surfaces.slabs;
        let ray_slabs = RaySlabs::new(ray, polygons.largest_coordinate());
        let (mut leg, mut hit) = (Leg { region, ..Leg::default() }, Hit::MISS);
        self.space.own[usize::from(region)].walk(ray, strayed, |voxel| {
            leg.voxels += 1;
            for &polygon in voxel.polygons {
                if is_left_out(own, polygon, || slabs.meets(&ray_slabs, polygon), &mut self.spared) {
                    continue;
                }
                leg.slab_tests += 1;
                if slabs.meets(&ray_slabs, polygon) {
                    leg.intersection_tests += 1;
                    hit = polygons.nearer(ray, polygon, hit);
                }
            }
            if hit.t.min(t_exit) <= voxel.t_exit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        legs.push(leg);
        hit
    }

    /// The first hit of a ray. Adds its legs, and the pages that it reads. Without any voxel on its way there is no leg.
    ///
    /// What a region has found beyond its end is forgotten: the next one finds it again.
    pub fn trace(&mut self, leaving: Leaving<'_>, legs: &mut Vec<Leg>, uses: &mut Vec<(u32, u32)>) -> Hit {
        let (ray, own) = leaving;
        let Some(grid) = self.workload.grids().next() else { return Hit::MISS };
        let polygons = self.workload.polygons();
        let slabs = &self.workload.layout.surfaces.slabs;
        let strayed = polygons.beyond_margin(ray.origin);
        let (first, first_use) = (legs.len(), uses.len());
        let mut ray_slabs = None;
        let mut hit = Hit::MISS;
        let table = grid.table();
        if let Some(pyramids) = self.space.pyramids.filter(|_| strayed == 0.0) {
            return self.trace_pyramids((grid, pyramids), leaving, legs);
        }
        grid.walk(ray, strayed, |voxel| {
            let region = self.space.regions.of_voxel(voxel.voxel);
            let leg = leg_in(region, legs, first, strayed > 0.0);
            let leg = match leg {
                Some(leg) => &mut legs[leg],
                None => {
                    legs.push(Leg { region, ..Leg::default() });
                    // All regions work on a ray that has strayed, whose hit is then the nearest of all.
                    hit = if strayed > 0.0 { hit } else { Hit::MISS };
                    let last = legs.len() - 1;
                    &mut legs[last]
                }
            };
            leg.voxels += 1;
            if let Some(pages) = &self.pages {
                read(uses, first_use, pages.of_voxel(voxel.voxel));
                if !voxel.polygons.is_empty() {
                    read(uses, first_use, pages.of_list(table[voxel.voxel]));
                }
            }
            for &polygon in voxel.polygons {
                let mut meets = || {
                    let new = || RaySlabs::new(ray, polygons.largest_coordinate());
                    slabs.meets(ray_slabs.get_or_insert_with(new), polygon)
                };
                if is_left_out(own, polygon, &mut meets, &mut self.spared) {
                    continue;
                }
                leg.slab_tests += 1;
                self.pages.iter().for_each(|pages| read(uses, first_use, pages.of_polygon(polygon)));
                if meets() {
                    leg.intersection_tests += 1;
                    self.pages.iter().for_each(|pages| read(uses, first_use, pages.of_polygon(polygon)));
                    hit = polygons.nearer(ray, polygon, hit);
                }
            }
            if hit.t <= voxel.t_exit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        hit
    }
}

impl Walker<'_> {
    /// The same where cells are pyramids: each voxel is visited in every region that the ray is in there. Between them what was hit
    /// is forgotten, if it does not lie before the border.
    fn trace_pyramids(
        &mut self,
        (grid, pyramids): (&Grid, &Pyramids),
        (ray, own): Leaving<'_>,
        legs: &mut Vec<Leg>,
    ) -> Hit {
        let polygons = self.workload.polygons();
        let slabs = &self.workload.layout.surfaces.slabs;
        let ray_slabs = RaySlabs::new(ray, polygons.largest_coordinate());
        let mut way = pyramids.way(ray, grid.volume().entered_by(ray).unwrap_or(0.0));
        let (first, mut hit) = (legs.len(), Hit::MISS);
        grid.walk(ray, 0.0, |voxel| {
            loop {
                let region = self.space.regions.by_cell()[way.cell()];
                if leg_in(region, legs, first, false).is_none() {
                    legs.push(Leg { region, ..Leg::default() });
                    hit = Hit::MISS;
                }
                if let Some(leg) = legs.last_mut() {
                    leg.voxels += 1;
                    for &polygon in voxel.polygons {
                        if is_left_out(own, polygon, || slabs.meets(&ray_slabs, polygon), &mut self.spared) {
                            continue;
                        }
                        leg.slab_tests += 1;
                        if slabs.meets(&ray_slabs, polygon) {
                            leg.intersection_tests += 1;
                            hit = polygons.nearer(ray, polygon, hit);
                        }
                    }
                }
                // On to the next cell of another region, if that comes before the next voxel.
                let by_cell = self.space.regions.by_cell();
                while by_cell[way.cell()] == region
                    && way.next() < f64::from(voxel.t_exit)
                    && f64::from(hit.t) > way.next()
                {
                    way.advance();
                }
                if by_cell[way.cell()] == region {
                    return if hit.t <= voxel.t_exit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
                }
            }
        });
        hit
    }
}

/// The leg in which a ray is when it visits a voxel of a region: the last, if that is of the region; any, if the ray has strayed.
#[inline]
fn leg_in(region: u16, legs: &[Leg], first: usize, has_strayed: bool) -> Option<usize> {
    match has_strayed {
        false => (legs.len() > first && legs[legs.len() - 1].region == region).then(|| legs.len() - 1),
        true => legs[first..].iter().position(|leg| leg.region == region).map(|place| first + place),
    }
}

/// Whether a polygon is left out, as it is the ray's own; what that spares is counted.
#[inline]
fn is_left_out(own: Option<u32>, polygon: u32, meets: impl FnOnce() -> bool, spared: &mut Spared) -> bool {
    if own != Some(polygon) {
        return false;
    }
    spared.slab_tests += 1;
    spared.intersection_tests += u64::from(meets());
    true
}

/// Notes that a ray reads a page, whose pages begin at `first`.
#[inline]
fn read(uses: &mut Vec<(u32, u32)>, first: usize, page: u32) {
    match uses[first..].iter_mut().rev().find(|(known, _)| *known == page) {
        Some((_, reads)) => *reads += 1,
        None => uses.push((page, 1)),
    }
}
