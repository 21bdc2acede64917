//! `pcs-sim` simulates ray tracing on a linear array of PCS processors, as Badouel, Bodin and Priol described it in
//! *Lancer de rayon : approches parallèles* (INRIA RR-0992, 1989), exact to the cycle.
//!
//! A host sends rays into a row of cells. Each cell reads words from two FIFOs, computes, and writes words to its right
//! neighbour's; the last one sends hits back to the host:
//!
//! ```text
//!            X0         X1         X2
//!   host ──> FIFO cell0 FIFO cell1 FIFO cell2 ──> host
//!                       FIFO       FIFO       FIFO
//!                       Y1         Y2         Yhost
//! ```
//!
//! # Two halves and a seam
//!
//! What a cell does for a ray depends on the ray and on the words that it receives, never on the clock, as every read
//! and write blocks. So the work falls into two halves:
//!
//! - the **functional half** ([`geometry`] and [`program`]) turns rays into hits and into what each cell does, op by op:
//!   read 8 words, compute 600 cycles, write a word. Rays are independent of each other; all cores work on them.
//!   The cells take Figure 7's times, or run programs that compute the hits themselves ([`isa`], [`program::cells`]);
//! - the **timing half** ([`machine`]) turns ops into cycles. It knows no rays;
//! - the **op stream** ([`machine::OpStream`]) lies between them. Recorded, it is an activity trace, which can be timed
//!   again under any machine without the scene.
//!
//! [`run`] runs both halves together. [`scene`] reads or generates what is traced, [`host`] makes rays and images,
//! [`report`] tells what came out, and [`model`] what the paper's equations expect to.
//!
//! # Guarantees
//!
//! - **Exact.** Cycles are integers, and every statistic is what ticking each cycle would count. The tests keep such a
//!   ticking model and compare every field.
//! - **Deterministic.** The same inputs give the same bytes, whatever the number of threads.
//! - **The same hits.** Every mode, number of cells, partition and FIFO depth gives the same hits, to the bit, as testing
//!   every polygon with annex A.3: the filters' margins bound what 32-bit rounding can do ([`geometry::rounding`]).
//! - **Accounted for.** Every cycle of every cell is in exactly one state, so the states sum to the run.
//!
//! # In a few lines
//!
//! ```
//! use pcs_sim::host::camera::{ImageSize, primary_rays};
//! use pcs_sim::program::{ArrayProgram, Workload};
//! use pcs_sim::machine::MachineFile;
//! use pcs_sim::run::{self, Workers};
//! use pcs_sim::scene::builtin;
//!
//! let scene = builtin::generate("room", None, None)?;
//! let rays = primary_rays(&scene.camera, ImageSize { width: 16, height: 12 });
//! let machine = MachineFile::standard()?.build()?;
//! let pipeline = ArrayProgram::standard("pipeline").ok_or("no such program")??;
//! let workload = Workload::new(&scene.mesh, &pipeline, machine.times, &rays)?;
//! let outcome = run::run(&workload, &machine.spec, &rays, &Workers::new(2), |_| Ok::<(), std::io::Error>(()))?;
//! println!("{} in {}", outcome.counts.hits, outcome.stats.cycles);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod error;
pub mod geometry;
pub mod host;
mod input;
pub mod isa;
pub mod machine;
pub mod measure;
pub mod model;
mod parameters;
pub mod program;
pub mod quantities;
pub mod report;
pub mod run;
pub mod scene;
pub mod seam;
pub mod sweep;
