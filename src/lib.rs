//! pcs-sim.

pub mod error;
pub mod scene;
