//! pcs-sim.

pub mod error;
pub mod geometry;
pub mod host;
pub mod machine;
pub mod program;
pub mod report;
mod ron_input;
pub mod scene;
pub mod simulation;
