//! Sweeps and images past one machine: cut into shards, which run anywhere, and joined to the same bytes.
//!
//! A [`Plan`] says what is to be done, and lies in a [`Folder`] that all machines see, with what each shard has to do. A shard is
//! a process ([`run_shard`]) that knows nothing of the others, and puts what it finds into the folder: whole files, each in one
//! step. Points have keys of what determines their results, so that what is found has its place whoever finds it, and how
//! often: shards may be lost, repeated, stopped half-way. An [`Engine`] starts the processes.

mod cut;
mod engine;
mod folder;
mod parallel;
mod plan;
mod shard;
mod slurm;
mod states;

pub use cut::{Part, lines_of, parts_of};
pub use engine::{AtOnce, Engine, Job};
pub use folder::{Folder, Lock};
pub use plan::{Manner, Plan, Work};
pub use shard::{Found, Lines, Points, ShardError, run_shard};
pub use states::{State, joined_image, states};
