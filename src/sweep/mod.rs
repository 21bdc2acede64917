//! Many runs at once: which points a sweep has, and the record that lets a killed one go on.

mod cube_point;
mod effective;
mod engine;
mod farm_point;
mod file;
mod journal;
mod laid_out;
mod parameters;
mod point;
mod range;
mod record;
mod told;

pub use engine::{Account, Note, Unkept};
pub use file::Sweep;
pub use parameters::{Parameter, Points};
pub use record::{Record, Unrecorded};
pub use told::{label, what_ran};
