//! What is counted on rays as they are traced.

use serde::{Deserialize, Serialize};

/// How often the kernels did their work, over all cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Voxels walked through.
    pub voxels: u64,
    /// Polygons tested against slabs.
    pub slab_tests: u64,
    /// Polygons tested for intersection.
    pub intersection_tests: u64,
    /// Rays that hit a polygon.
    pub hits: u64,
    /// What rules spared.
    #[serde(default)]
    pub spared: Spared,
}

/// What [rules](crate::host::rules) spared, and what they cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spared {
    /// Polygons that were dropped before the slabs, as rays start on them.
    pub slab_tests: u64,
    /// Those among them that would have been tested for intersection.
    pub intersection_tests: u64,
    /// Shadow rays that were not sent, as they meet nothing.
    pub lit_rays: u64,
    /// Objects that the host looked at for that.
    pub object_tests: u64,
    /// Shadow rays that were not sent, as something stands in their way.
    pub shaded_rays: u64,
    /// Polygons that the host looked at for that.
    pub polygon_tests: u64,
}

impl std::ops::AddAssign for Spared {
    fn add_assign(&mut self, other: Spared) {
        self.slab_tests += other.slab_tests;
        self.intersection_tests += other.intersection_tests;
        self.lit_rays += other.lit_rays;
        self.object_tests += other.object_tests;
        self.shaded_rays += other.shaded_rays;
        self.polygon_tests += other.polygon_tests;
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.voxels += other.voxels;
        self.slab_tests += other.slab_tests;
        self.intersection_tests += other.intersection_tests;
        self.hits += other.hits;
        self.spared += other.spared;
    }
}
