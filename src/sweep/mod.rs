//! Many runs at once: which points a sweep has, and the journal that lets a killed one go on.

mod file;
mod journal;

pub use file::Sweep;
pub use journal::Journal;
