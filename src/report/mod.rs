//! What a run tells: statistics, tables, hits, pictures, pages. Nothing here measures anything.

pub mod account;
pub mod bottleneck;
pub mod comparison;
pub mod cube;
pub mod farm;
pub mod figure7;
pub mod forecast;
pub mod graphs;
pub mod hits;
pub mod kinds;
pub mod links;
pub mod losses;
pub mod moment;
pub mod page;
pub mod palette;
pub mod plot;
pub mod prediction;
pub mod sizing;
pub mod stats;
pub mod summary;
pub mod table;
pub mod time_unit;
pub mod trace;
pub mod why;
