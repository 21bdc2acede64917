//! What the model says of a run.

use glam::DVec3;

use super::grid;
use super::sketch::{RayWork, Sketch};
use super::slabs;
use super::throughput::{ArrayModel, Bound, CellLoad, LinkLoad};
use crate::geometry::slabs::DIRECTIONS;
use crate::geometry::voxels::Lattice;

/// The counts that the paper's formulas give: whole walks of rays from everywhere, polygons that lie anyhow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PaperFormulas {
    /// nb_steps by [`grid::steps_bound`].
    pub voxels: f64,
    /// nb_filter1 by [`grid::candidates`].
    pub candidates: f64,
    /// nb_voxel/poly by [`grid::voxels_per_polygon`].
    pub voxels_per_polygon: f64,
    /// nb_poly/voxel by [`grid::polygons_per_voxel`].
    pub polygons_per_voxel: f64,
    /// (4), over all cells.
    pub grid_words: f64,
}

/// Sizes over all groups.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sizes {
    /// P, a polygon in several sub-volumes counted in each.
    pub polygons: f64,
    /// nb_voxel.
    pub voxels: f64,
    /// References to polygons in the voxels' lists.
    pub references: f64,
}

impl Sizes {
    /// nb_voxel/poly.
    pub fn voxels_per_polygon(&self) -> f64 {
        self.references / self.polygons.max(1.0)
    }

    /// nb_poly/voxel.
    pub fn polygons_per_voxel(&self) -> f64 {
        self.references / self.voxels.max(1.0)
    }

    /// (4): words of the voxel tables and the index lists.
    pub fn grid_words(&self) -> f64 {
        self.voxels + self.references
    }

    /// (6): words of the slabs.
    pub fn slabs_words(&self) -> f64 {
        slabs::memory_words(DIRECTIONS as f64, self.polygons)
    }
}

/// What an array will have to do for a scene and its rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prediction {
    /// coeff_grid.
    pub coefficient: f64,
    /// By the paper's formulas, for comparison.
    pub paper: PaperFormulas,
    /// Grids and slabs.
    pub sizes: Sizes,
    /// What each group does for a ray.
    pub groups: Vec<RayWork>,
    /// What each cell does for a ray.
    pub cells: Vec<CellLoad>,
    /// What each link carries for a ray.
    pub links: Vec<LinkLoad>,
    /// What the host does for a ray, in cycles.
    pub host: f64,
    /// What follows.
    pub bound: Bound,
}

/// A group's part of the prediction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    polygons: f64,
    voxels: f64,
    references: f64,
    area: f64,
    perimeter: f64,
    /// The edge of a voxel, if they were cubes.
    edge: f64,
    work: RayWork,
}

impl Group {
    pub fn new(sketch: &Sketch<'_>, polygons: f64, coefficient: f64, thinnest: f64) -> Group {
        let lattice = Lattice::cubic(sketch.volume(), grid::voxels(coefficient, polygons), thinnest);
        // A flat volume has voxels without width, through which nothing moves.
        let least = f64::MIN_POSITIVE.sqrt();
        let edge = lattice.voxel_extent().max(DVec3::splat(least));
        let voxels = lattice.voxel_count() as f64;
        Group {
            polygons,
            voxels,
            references: sketch.all.voxels(edge),
            area: sketch.area,
            perimeter: sketch.perimeter,
            edge: edge.element_product().cbrt().max(least),
            work: sketch.work(edge),
        }
    }

    fn paper(&self, coefficient: f64) -> PaperFormulas {
        let polygons = self.polygons.max(1.0);
        let per_polygon = grid::voxels_per_polygon(self.area / polygons, self.perimeter / polygons, self.edge);
        let per_voxel = grid::polygons_per_voxel(per_polygon, coefficient);
        let steps = grid::steps_bound(coefficient, self.polygons);
        PaperFormulas {
            voxels: steps,
            candidates: grid::candidates(steps, per_voxel),
            voxels_per_polygon: per_polygon,
            polygons_per_voxel: per_voxel,
            grid_words: grid::memory_words(coefficient, per_polygon, self.polygons),
        }
    }
}

impl Prediction {
    pub(super) fn new(groups: Vec<Group>, array: &ArrayModel, coefficient: f64) -> Prediction {
        let sum = |of: fn(&Group) -> f64| groups.iter().map(of).sum::<f64>();
        let sizes =
            Sizes { polygons: sum(|g| g.polygons), voxels: sum(|g| g.voxels), references: sum(|g| g.references) };
        let papers: Vec<(f64, PaperFormulas)> =
            groups.iter().map(|group| (group.polygons, group.paper(coefficient))).collect();
        let total = |of: fn(&PaperFormulas) -> f64| papers.iter().map(|(_, paper)| of(paper)).sum::<f64>();
        let mean = |of: fn(&PaperFormulas) -> f64| {
            papers.iter().map(|(polygons, paper)| polygons * of(paper)).sum::<f64>() / sizes.polygons.max(1.0)
        };
        let paper = PaperFormulas {
            voxels: total(|paper| paper.voxels),
            candidates: total(|paper| paper.candidates),
            voxels_per_polygon: mean(|paper| paper.voxels_per_polygon),
            polygons_per_voxel: mean(|paper| paper.polygons_per_voxel),
            grid_words: total(|paper| paper.grid_words),
        };
        let work: Vec<RayWork> = groups.iter().map(|group| group.work).collect();
        let (cells, links, host) = (array.cell_loads(&work), array.link_loads(&work), array.host_load());
        let bound = Bound::new(host, &cells, &links, array.links);
        Prediction { coefficient, paper, sizes, groups: work, cells, links, host, bound }
    }

    /// What all groups together do for a ray.
    pub fn total(&self, of: impl Fn(&RayWork) -> f64) -> f64 {
        self.groups.iter().map(of).sum()
    }
}
