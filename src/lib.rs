//! pcs-sim.

pub mod error;
pub mod geometry;
pub mod host;
mod input;
pub mod machine;
pub mod program;
pub mod report;
pub mod scene;
pub mod simulation;
