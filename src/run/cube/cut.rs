//! How a scene is cut into regions of equal work, by a sub-sample of the image (RR-0992, §4.1).

use std::convert::Infallible;

use super::spec::RegionSpec;
use super::trees::{Traced, Tracing};
use super::{CellCuts, Percent};
use crate::error::InputError;
use crate::geometry::partition::{SubVolume, assign};
use crate::geometry::regions::Rectangle;
use crate::geometry::{CellPlane, Grid, Pyramids, Regions};
use crate::host::camera::ImageSize;
use crate::machine::Ipsc2;
use crate::program::cube::{Part, Space};
use crate::program::{NotLaidOut, Workload};
use crate::run::render::Picture;
use crate::run::{RunError, Workers};

/// A scene's regions, and what the sub-sample told of them.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cut {
    /// The regions.
    pub regions: Regions,
    /// How many pixels were sampled.
    pub sampled: usize,
    /// Cycles of work in each cell, on the sample.
    pub cells: Vec<u64>,
    /// Rays of the sample from each region to each other, row by row.
    pub between: Vec<u64>,
    /// Each region's part of the scene.
    pub parts: Vec<Part>,
}

/// Bytes of a word.
const WORD_BYTES: u64 = 4;

/// Bytes that the host sends each node beside its polygons: its box, its cells, lights and camera.
const HEAD_BYTES: u64 = 256;

/// Bytes of the connectivity of a cell.
const CELL_BYTES: u64 = 8;

impl Cut {
    /// A scene that is not cut.
    pub(super) fn none(regions: Regions, workload: &Workload) -> Cut {
        let parts = parts(&regions, workload);
        Cut { regions, sampled: 0, cells: vec![0], between: vec![0], parts }
    }

    /// A scene cut so that each node has a region of equal work on a sub-sample.
    pub(super) fn by_sample<E>(
        spec: &RegionSpec,
        picture: &Picture<'_>,
        (grid, machine, pyramids): (&Grid, &Ipsc2, Option<&Pyramids>),
        workers: &Workers,
    ) -> Result<Cut, RunError<E>> {
        let sampled = match spec.cell_cuts {
            CellCuts::Equal => CellPlane::new(grid, spec.cell_grid),
            CellCuts::Quantiles => CellPlane::finest(grid),
            CellCuts::Pyramids => CellPlane::of_screen(spec.cell_grid),
        };
        let of_cells = Regions::of_cells(sampled.clone());
        let pixels = lattice(picture.size, spec.sub_sample);
        let space = Space { pyramids, ..Space::of(&of_cells) };
        let tracing = Tracing { picture: *picture, space, pages: None, hits: false };
        let traced = tracing.trace((pixels.len(), |sample| pixels[sample]), workers, |_| Ok::<_, Infallible>(()));
        let traced = traced.map_err(|error| match error {
            RunError::Unfit(error) => RunError::Unfit(error),
            RunError::Cancelled(cancelled) => RunError::Cancelled(cancelled),
            // The others are of the timing half, or of an observer that cannot fail.
            other => RunError::Unfit(InputError::new(other.to_string())),
        })?;
        let work = work(&traced, machine, of_cells.count());
        let (plane, cells, cell_of) = match spec.cell_cuts {
            CellCuts::Quantiles => joined(&sampled, &work, spec.cell_grid),
            CellCuts::Equal | CellCuts::Pyramids => (sampled, work, (0..of_cells.count() as u16).collect()),
        };
        let regions = Regions::of_equal_work(plane, &cells, machine.nodes).map_err(|few| {
            InputError::new(few.to_string()).help("take fewer nodes, more --cell-grid, or a larger --grid-coefficient")
        })?;
        let region_of: Vec<u16> = cell_of.iter().map(|&cell| regions.by_cell()[usize::from(cell)]).collect();
        let between = between(&traced, &region_of, regions.count());
        let parts = match pyramids {
            Some(pyramids) => parts_of_pyramids(&regions, pyramids, (picture.workload, grid)),
            None => parts(&regions, picture.workload),
        };
        Ok(Cut { regions, sampled: pixels.len(), cells, between, parts })
    }

    /// A grid for each region, of `coefficient` voxels for each of its polygons.
    ///
    /// Fails if one would be too large, and if it is told to stop.
    pub(super) fn own_grids(
        &mut self,
        workload: &Workload,
        coefficient: f64,
        workers: &Workers,
    ) -> Result<Vec<Grid>, NotLaidOut> {
        let polygons = workload.polygons();
        let volumes = workload.grids().next().map(|grid| self.regions.volumes(grid)).unwrap_or_default();
        let fill = |(region, SubVolume { volume, members }): (usize, SubVolume)| {
            let grid = Grid::new(polygons, &members, volume, coefficient, &workers.cancel)?;
            let bytes = WORD_BYTES * polygons.memory_words(&members);
            self.parts[region] = Part {
                polygons: members.len(),
                bytes: bytes + head_bytes(&self.regions.rectangles()[region]),
                references: grid.reference_count() as u64,
                holds: bytes + WORD_BYTES * grid.memory_words(),
            };
            Ok(grid)
        };
        assign(polygons, &volumes).into_iter().enumerate().map(fill).collect()
    }

    /// The work that the sample told of each region.
    pub fn predicted(&self) -> Vec<u64> {
        let mut sums = vec![0; self.regions.count()];
        self.regions.by_cell().iter().zip(&self.cells).for_each(|(&region, work)| sums[usize::from(region)] += work);
        sums
    }
}

/// The middles of a lattice of pixels that has about that share of them.
pub(super) fn lattice(size: ImageSize, Percent(share): Percent) -> Vec<(f64, f64)> {
    let step = ((100.0 / share).sqrt().round() as u32).max(1);
    let along = |side: u32| (step.min(side) / 2..side).step_by(step as usize);
    let middle = |at: u32| f64::from(at) + 0.5;
    along(size.height).flat_map(|y| along(size.width).map(move |x| (middle(x), middle(y)))).collect()
}

/// The cycles of each cell: a ray's start counts where it starts, and shading where the hit is.
fn work(traced: &Traced, machine: &Ipsc2, cells: usize) -> Vec<u64> {
    let mut work = vec![0; cells];
    let graph = &traced.graph;
    for ray in 0..graph.rays.len() as u32 {
        let mut started = [false; 2];
        let first = graph.rays[ray as usize].first_leg;
        for leg in first..graph.legs_end(ray) {
            let counts = &graph.legs[leg as usize];
            let mut cycles = graph.time(ray, leg, &machine.times).all().0;
            if leg > first {
                cycles -= machine.times.grid.start.0;
            }
            let starts = [
                (counts.slab_tests, machine.times.slabs.start.0),
                (counts.intersection_tests, machine.times.intersection.start.0),
            ];
            for (started, (tests, start)) in started.iter_mut().zip(starts) {
                if tests > 0 && std::mem::replace(started, true) {
                    cycles -= start;
                }
            }
            work[usize::from(counts.region)] += cycles;
        }
    }
    work
}

/// Cells joined of the finest, so that each row and column has an equal part of the work; their work, and which cell each of the finest
/// is in.
fn joined(finest: &CellPlane, work: &[u64], cells: u32) -> (CellPlane, Vec<u64>, Vec<u16>) {
    let (plane, cell_of) = finest.quantiles(work, cells);
    let mut sums = vec![0; plane.size().map(|side| side as usize).iter().product()];
    cell_of.iter().zip(work).for_each(|(&cell, work)| sums[usize::from(cell)] += work);
    (plane, sums, cell_of)
}

/// The rays from each of so many regions to each other, of which `region_of` tells that of each cell.
fn between(traced: &Traced, region_of: &[u16], count: usize) -> Vec<u64> {
    let mut between = vec![0; count * count];
    for ray in 0..traced.graph.rays.len() as u32 {
        for pair in traced.graph.legs_of(ray).windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|leg| usize::from(region_of[usize::from(leg.region)]));
            if from != to {
                between[from * count + to] += 1;
            }
        }
    }
    between
}

/// Each region's part of the scene: the polygons that its voxels list.
fn parts(regions: &Regions, workload: &Workload) -> Vec<Part> {
    parts_by(regions, workload, |voxel| 1 << regions.of_voxel(voxel))
}

/// The same of pyramids: a voxel is in all regions that some of it may be in.
fn parts_of_pyramids(regions: &Regions, pyramids: &Pyramids, (workload, grid): (&Workload, &Grid)) -> Vec<Part> {
    let across = regions.plane().size()[0];
    parts_by(regions, workload, |voxel| {
        let [xs, ys] = pyramids.cells_of(grid.bounds_of(voxel));
        let cells = ys.flat_map(|y| xs.clone().map(move |x| (x + across * y) as usize));
        cells.fold(0u128, |held, cell| held | 1 << regions.by_cell()[cell])
    })
}

/// The same where `held_by` tells the regions of a voxel, a bit each.
fn parts_by(regions: &Regions, workload: &Workload, held_by: impl Fn(usize) -> u128) -> Vec<Part> {
    let mut parts = vec![Part::default(); regions.count()];
    let mut voxels = vec![0u64; regions.count()];
    let polygons = workload.polygons();
    let mut held = vec![0u128; polygons.len()];
    for (voxel, list) in workload.grids().flat_map(|grid| grid.lists().enumerate()) {
        let of_voxel = held_by(voxel);
        for region in (0..parts.len()).filter(|region| of_voxel & 1 << region != 0) {
            voxels[region] += 1;
            parts[region].references += list.len() as u64;
        }
        list.iter().for_each(|&polygon| held[polygon as usize] |= of_voxel);
    }
    for (polygon, &held) in held.iter().enumerate() {
        let bytes = WORD_BYTES * polygons.record_words(polygon as u32);
        for part in (0..parts.len()).filter(|part| held & 1 << part != 0) {
            parts[part].polygons += 1;
            parts[part].bytes += bytes;
        }
    }
    for (region, part) in parts.iter_mut().enumerate() {
        part.holds = part.bytes + WORD_BYTES * (voxels[region] + 1 + part.references);
        part.bytes += head_bytes(&regions.rectangles()[region]);
    }
    parts
}

/// What the host sends a node beside its polygons.
fn head_bytes(Rectangle { low, high }: &Rectangle) -> u64 {
    HEAD_BYTES + CELL_BYTES * 2 * u64::from(high[0] - low[0] + high[1] - low[1])
}
