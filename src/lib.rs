//! pcs-sim.

pub mod error;
pub mod geometry;
pub mod machine;
pub mod program;
mod ron_input;
pub mod scene;
pub mod simulation;
