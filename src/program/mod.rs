//! Array programs: which cell runs which kernels on which part of the scene, and what each cell then does for each ray.
//!
//! This is the functional half: it turns rays into hits and into the cells' ops, with no notion of time beyond the
//! cycles that a kernel computes (Figure 7).

mod array_program;
pub mod cells;
pub mod cube;
mod cut;
pub mod farm;
pub mod figure7;
mod layout;
mod masks;
pub mod messages;
mod stop_words;
mod tracer;
pub mod work;
mod workload;

pub use array_program::{ArrayProgram, Kernel, Masks, Stages};
pub use cut::{Sample, sub_sample};
pub use layout::{Layout, NotLaidOut, Surfaces};
pub(crate) use masks::Screening;
pub use tracer::{Counts, GroupVisit, Said, Spared, Test, Tracer, Visit, VoxelVisit};
pub use workload::{CellMemory, Workload};
