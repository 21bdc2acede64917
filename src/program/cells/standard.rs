//! The standard programs of the cells, which are built in.

use crate::isa::Sources;

/// The texts of `pcs-programs/cells`, by their names there.
pub const STANDARD: Sources = Sources::BuiltIn(TEXTS);

macro_rules! texts {
    ($($name:literal)*) => {
        &[$(($name, include_str!(concat!("../../../pcs-programs/cells/", $name)))),*]
    };
}

const TEXTS: &[(&str, &str)] = texts! {
    "broadcast.pcs"
    "grid-intersection.pcs"
    "grid-slabs.pcs"
    "grid.pcs"
    "intersection.pcs"
    "slabs-intersection.pcs"
    "slabs.pcs"
    "kernels/bound.pcs"
    "kernels/bound-passed.pcs"
    "kernels/candidate.pcs"
    "kernels/grid-start.pcs"
    "kernels/grid-step.pcs"
    "kernels/grid-voxel.pcs"
    "kernels/intersection-start.pcs"
    "kernels/intersection-test.pcs"
    "kernels/merge.pcs"
    "kernels/pass.pcs"
    "kernels/ray.pcs"
    "kernels/registers.pcs"
    "kernels/slabs-first.pcs"
    "kernels/slabs-start.pcs"
    "kernels/slabs-test.pcs"
};
