//! What a run tells: statistics, tables, hits, activity traces. Nothing here measures anything.

pub mod activity;
pub mod bottleneck;
pub mod files;
pub mod hits;
pub mod kinds;
pub mod stats;
pub mod summary;
