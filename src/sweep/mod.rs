//! Many runs at once: which points a sweep has, and the record that lets a killed one go on.

mod file;
mod journal;
mod parameters;
mod record;

pub use file::Sweep;
pub use parameters::Parameter;
pub use record::Record;
