//! The paper's cost model: its equations, one function each, and what they say of a scene, an array and a machine before
//! anything is run.
//!
//! | paper | here |
//! | --- | --- |
//! | §3, T with n filters; T_0 to T_n and property (1) | [`cost::time`], [`cost::times`], [`cost::property_1`] |
//! | (3), T with a grid | [`cost::time_with_grid`] |
//! | A.1, nb_voxel = coeff_grid P | [`grid::voxels`] |
//! | A.1, nb_steps <= cbrt(coeff_grid P) | [`grid::steps_bound`]; exact for random lines: [`grid::steps_of_random_line`] |
//! | A.1, nb_voxel/poly (Cleary & Wyvill) | [`grid::voxels_per_polygon`]; for polygons as they lie: [`Footprint`] |
//! | A.1, nb_poly/voxel, nb_filter1 | [`grid::polygons_per_voxel`], [`grid::candidates`] |
//! | (4), memory of the grid | [`grid::memory_words`] |
//! | (6), memory of the slabs | [`slabs::memory_words`] |
//! | §4.2, what each cell and link has to do, and the bounds that follow | [`throughput`] |
//! | §4.1, what each node of a hypercube has to do, and the bounds that follow | [`cube`] |
//! | §4.2, when messages pass, and what is lost while cells wait | [`passage`]; of a run, by a few of its rays: [`Expectation`] |
//!
//! The paper leaves open how large a scene's polygons are and how its rays run ("must be measured in pre-processing").
//! A [`Survey`] measures both, on a few of the rays and a coarse grid, and turns them into a [`Prediction`].
//!
//! Everything here is plain numbers in double precision: rays, voxels, words, and cycles as a number of any unit of time.

pub mod cost;
pub mod cube;
mod expectation;
mod footprint;
pub mod grid;
pub mod passage;
mod prediction;
mod sketch;
pub mod slabs;
mod stretches;
mod survey;
pub mod throughput;

pub use cube::Bounds;
pub use expectation::{Depth, Expectation, Few};
pub use footprint::Footprint;
pub use prediction::{PaperFormulas, Prediction, Sizes};
pub use sketch::RayWork;
pub use stretches::Stretches;
pub use survey::Survey;
pub use throughput::{ArrayModel, Bound, CellLoad, Limit, LinkLoad, Links, Stage, Times};
