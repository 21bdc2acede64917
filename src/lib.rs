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
//!   read 8 words, walk 12 voxels, write a word. Rays are independent of each other; all cores work on them.
//!   The cells take Figure 7's times, or run programs that compute the hits themselves ([`isa`], [`program::cells`]);
//! - the **timing half** ([`machine`], above all [`machine::line`]) knows what a unit of work costs, and turns ops into
//!   cycles. It knows no rays. What it saw is in the terms of [`measure`], which fit any machine. Machines whose stations serve
//!   whoever comes first, such as CAPITAN's farm of workers ([`program::farm`]), act in [`machine::events`];
//! - the **[`seam`]** between them is the op. Recorded, ops are an [activity trace](seam::activity_trace), which can be
//!   timed again under any machine without the scene.
//!
//! A [`run`] describes what is traced on which machine. [`scene`] reads or generates it, [`host`] makes rays and images,
//! and [`model`] is what the paper's equations expect. With the feature `report` (in `cli`, and so by default) there are
//! reports and plots, and sweeps of many runs.
//!
//! # A scene on the array
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use pcs_sim::machine::Cycles;
//! use pcs_sim::run::{self, Layers, PlannedRun, RunOptions, RunSpec, Watching, Workers};
//!
//! let mut options = RunOptions::default(); // the macro-pipeline on PCS, unless told otherwise
//! options.set("scene", "room")?;
//! options.set("size", "16x12")?;
//! let spec = RunSpec::new(&options, None)?;
//!
//! let run = PlannedRun::new(spec)?;
//! let (workers, mut layers) = (Workers::new(2), Layers::default());
//! let workload = layers.workload(&run, &workers.cancel)?;
//! let rays = &layers.prepared(&run)?.rays;
//! let outcome = run::run(&workload, &run.machine.spec, rays, &workers, |_| Ok::<(), std::io::Error>(()))?;
//!
//! assert_eq!((outcome.stats.cycles, outcome.counts.hits), (Cycles(805_210), 185));
//! assert!(outcome.stats.stations.iter().all(|cell| cell.total() == outcome.stats.cycles));
//!
//! // Another time of Figure 7 is the same work, timed again.
//! let traced = layers.traced(&run, &workers)?;
//! options.set("grid_voxel", "3.9")?;
//! let faster = PlannedRun::new(RunSpec::new(&options, None)?)?;
//! assert_eq!(run.keys.traced, faster.keys.traced);
//! let (stats, _) = traced.time(&faster.machine, &Watching::default(), &workers.cancel)?;
//! assert!(stats.cycles < Cycles(805_210));
//! # Ok(())
//! # }
//! ```
//!
//! # A machine of your own
//!
//! A machine file is a text; changes, as flags make them, are laid over it:
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use pcs_sim::machine::{Cycles, MachineFile, MachineOptions, Words};
//! use pcs_sim::program::work;
//!
//! let mut file = MachineFile::standard()?;
//! let none = MachineOptions::default();
//! MachineOptions { link_mb_s: Some(20.0), y_fifo_words: Some(64), grid_voxel: Some(3.9), ..none }.change(&mut file);
//! let machine = file.build()?;
//!
//! assert_eq!(machine.spec.link_rate().cycles_per_word, 4); // 4 bytes at 20 Mbyte/s, in cycles of 50 ns
//! assert_eq!(machine.spec.fifo_words_of("Y1".parse()?), Words(64));
//! let costs = work::costs(&work::vocabulary(false), &machine.times, None);
//! assert_eq!((costs.of(work::GRID_START), costs.of(work::GRID_VOXEL)), (Cycles(600), Cycles(78)));
//! # Ok(())
//! # }
//! ```
//!
//! # Ops by hand, and a look inside
//!
//! The timing half takes ops from anywhere. Here one cell starts a ray and walks 10 voxels; a probe keeps the run over
//! time:
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use pcs_sim::machine::{Array, Cycles, MachineFile};
//! use pcs_sim::program::work;
//! use pcs_sim::seam::{OpBatch, OpKind};
//!
//! let mut batch = OpBatch::new(1);
//! batch.host.push(OpKind::WriteX, 8);
//! batch.host.end_line(0);
//! batch.cells[0].push(OpKind::PassX, 8);
//! batch.cells[0].push(OpKind::Work(work::GRID_START), 1);
//! batch.cells[0].push(OpKind::Work(work::GRID_VOXEL), 10);
//! batch.cells[0].push(OpKind::WriteY, 5);
//! batch.cells[0].end_line(0);
//!
//! let machine = MachineFile::standard()?.build()?;
//! let costs = work::costs(&work::vocabulary(false), &machine.times, None);
//! let mut array = Array::new(&machine.spec, &costs, 1).probed();
//! array.feed(batch)?;
//! let (measured, observed) = array.finish_observed()?;
//!
//! // Read in cycles 1 to 8, 600 + 10 * 156 cycles of work, 5 words written, and a cycle until the host has the last one.
//! assert_eq!(measured.cycles, Cycles(9 + 2160 + 5 + 1));
//! let profile = observed.profile.ok_or("it was probed")?;
//! assert_eq!(profile.latency.max, Cycles(2175));
//! let works = profile.stations[0].iter().map(|times| measured.topology.states.works(times)).sum::<Cycles>();
//! assert_eq!(works, Cycles(8 + 2160 + 5));
//! # Ok(())
//! # }
//! ```
//!
//! # A recorded trace under another machine
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use pcs_sim::machine::{Array, Cycles, MachineFile, MachineOptions};
//! use pcs_sim::program::work;
//! use pcs_sim::seam::activity_trace::ActivityTrace;
//!
//! let path = std::env::temp_dir().join(format!("pcs-sim-tour-{}.ops", std::process::id()));
//! let units = "unit gs grid_start grid 600\nunit gv grid_voxel grid 156\n";
//! let ops = "0 host w8\n0 0 x8 gs1 gv10 o5\n";
//! std::fs::write(&path, format!("pcs-sim trace 2 cells 1 answer 5\n{units}{ops}"))?;
//! let mut trace = ActivityTrace::open(&path, &work::cycles_vocabulary())?;
//!
//! let mut file = MachineFile::standard()?;
//! MachineOptions { grid_voxel: Some(3.9), latency_cycles: Some(10), ..MachineOptions::default() }.change(&mut file);
//! let machine = file.build()?;
//! let costs = work::costs(trace.costs().vocabulary(), &machine.times, machine.instructions.as_ref());
//! let mut array = Array::new(&machine.spec, &costs, trace.cells());
//! trace.for_each_batch(|batch| Ok::<_, Box<dyn std::error::Error>>(array.feed(batch)?))?;
//! assert_eq!(array.finish()?.cycles, Cycles(7 + 10 + 1 + 600 + 10 * 78 + 5 + 10));
//! # std::fs::remove_file(path)?;
//! # Ok(())
//! # }
//! ```
//!
//! # A deadlock caught
//!
//! A run that cannot end says who waits for whom. Here cell 0 has more words for Y than the FIFO holds, before it sends
//! on the ray that cell 1 waits for:
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use pcs_sim::machine::{Array, Cycles, MachineSpec, StuckKind, Unfinished, WaitFor, Words};
//! use pcs_sim::program::work;
//! use pcs_sim::seam::{Channel, Costs, OpBatch, OpKind};
//!
//! let mut batch = OpBatch::new(2);
//! batch.host.push(OpKind::WriteX, 8);
//! batch.host.end_line(0);
//! for (kind, words) in [(OpKind::ReadX, 8), (OpKind::WriteY, 600), (OpKind::WriteX, 8)] {
//!     batch.cells[0].push(kind, words);
//! }
//! for (kind, words) in [(OpKind::ReadX, 8), (OpKind::ReadY, 600), (OpKind::WriteY, 5)] {
//!     batch.cells[1].push(kind, words);
//! }
//! batch.cells.iter_mut().for_each(|ops| ops.end_line(0));
//!
//! let costs = Costs::new(work::vocabulary(false), |_| Cycles(1));
//! let mut array = Array::new(&MachineSpec::default(), &costs, 2);
//! array.feed(batch)?;
//! let Err(Unfinished::Stuck(stuck)) = array.finish() else { return Err("it must be stuck".into()) };
//! assert_eq!((stuck.kind, stuck.waits.len()), (StuckKind::Deadlock, 2));
//! let full = WaitFor::Room { channel: Channel::Y, capacity: Words(512) };
//! assert_eq!((stuck.waits[0].for_what, stuck.waits[0].since), (full, Cycles(521)));
//! # Ok(())
//! # }
//! ```
//!
//! # A farm of workers
//!
//! The second kind of machine: tasks that serve whoever comes first ([`machine::events`]), as SKY's did on CAPITAN in 1988.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use std::convert::Infallible;
//!
//! use pcs_sim::cancel::Cancel;
//! use pcs_sim::machine::Cycles;
//! use pcs_sim::run::{FarmRunOptions, FarmSpec, Watching, Workers};
//!
//! let mut options = FarmRunOptions::default(); // CAPITAN, and a made-up scene of rectangles, unless told otherwise
//! options.set("size", "100x100")?;
//! options.set("tasks", "8")?;
//! let spec = FarmSpec::new(&options, None)?;
//!
//! let machine = spec.machine.build()?;
//! let scene = spec.lay_out(&Workers::new(2), |_| Ok::<_, Infallible>(()))?;
//! let items = spec.cut(&scene, &machine)?;
//! let farm = spec.run((&scene, &machine, &items), &Watching::default(), &Cancel::default())?;
//!
//! // Cycles are nanoseconds; the thesis has 6.4 s.
//! assert_eq!((farm.stats.cycles, farm.items), (Cycles(6_238_637_921), 936));
//! # Ok(())
//! # }
//! ```
//!
//! # Guarantees
//!
//! Each with the test in `tests/it` that holds it.
//!
//! - **Exact.** Cycles are integers, and every statistic is what ticking each cycle would count (`timing_is_exact`,
//!   `profile_is_exact`, `recording_is_exact`: against a model that ticks).
//! - **Deterministic.** The same inputs give the same bytes, whatever the number of threads (`command_line`, `modes_agree`).
//! - **The same hits.** Every mode, number of cells, partition and FIFO depth gives the same hits, to the bit, as testing
//!   every polygon with annex A.3 (`modes_agree`, `programs_agree`): the filters' margins bound what 32-bit rounding can
//!   do ([`geometry::rounding`]).
//! - **Accounted for.** Every cycle of every cell is in exactly one state, so the states sum to the run
//!   (`timing_is_exact`, `sweep`).
//! - **A replay is the run.** A recorded trace gives the very statistics of the run that recorded it (`replay`).
//! - **A farm is exact, too.** To the nanosecond, in every state of every task (`farm`: against a model that ticks).
//! - **No run hangs.** One that cannot end is told apart, with its waits (`deadlock`).

pub mod cancel;
pub mod error;
pub mod geometry;
pub mod host;
pub mod input;
pub mod isa;
pub mod machine;
pub mod measure;
pub mod model;
pub mod parameters;
pub mod program;
pub mod quantities;
mod random;
#[cfg(feature = "report")]
pub mod report;
pub mod run;
pub mod scene;
pub mod seam;
#[cfg(feature = "report")]
pub mod shards;
#[cfg(feature = "report")]
pub mod sweep;
