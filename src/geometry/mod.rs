//! The paper's annex A, in 32-bit floating point as a PCS cell has it, and with no clock.
//!
//! | annex | here |
//! | --- | --- |
//! | A.1, the grid and its walk | [`grid`], filled by [`voxels`] |
//! | A.2, slabs | [`slabs`] |
//! | A.3, polygon intersection | [`polygon`] |
//!
//! The filters never drop a polygon that A.3 would hit: what rounding can do is bounded in [`rounding`].

pub mod bounds;
pub mod brute_force;
mod clearance;
pub mod closed;
pub mod edges;
pub mod grid;
pub mod hit;
pub mod partition;
pub mod polygon;
pub mod pyramids;
pub mod ray;
pub mod regions;
pub mod rounding;
pub mod screen;
pub mod slabs;
pub mod slivers;
pub mod voxels;
mod walk;

pub use bounds::Bounds;
pub use brute_force::brute_force;
pub use edges::Edges;
pub use grid::Grid;
pub use hit::Hit;
pub use partition::{Numbering, Partition};
pub use polygon::Polygons;
pub use pyramids::Pyramids;
pub use ray::Ray;
pub use regions::{CellPlane, Regions};
pub use screen::{Eye, ScreenRectangle};
pub use slabs::{RaySlabs, Slabs};
