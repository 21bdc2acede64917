//! What was seen of a machine at work, whichever machine it was: reports are made of this and of nothing else.
//!
//! A [`Topology`] says what there is: the stations, the FIFOs between them, and the states that a station can be in. The
//! figures stand beside it, in its order: [`Measured`] for a whole run, [`Profile`] for a run over time, [`Recording`] for
//! a window of it cycle by cycle, [`Moment`] for one cycle of that and [`Waits`] for who waits then for whom, [`SoFar`] for a run
//! that goes on. Every cycle of a station is in just one state, so a station's states sum to the run.

mod clock;
mod moment;
mod observed;
mod path;
mod profile;
mod recording;
mod snapshot;
mod so_far;
mod state;
mod stats;
mod topology;
mod waits;

pub use clock::Clock;
pub use moment::{Moment, OpMoment, StationMoment};
pub use observed::Observed;
pub use path::{Cause, CriticalPath, PathPart, PathUnit};
pub use profile::{FifoBin, FifoProfile, Latency, Profile};
pub use recording::{FifoLevels, JobSpan, MessageSpan, OpSpan, Recording, StationRecord, Stretch, WordsOf};
pub use snapshot::{At, Doing, Snapshot, What, When};
pub use so_far::SoFar;
pub use state::{State, StateId, StateKind, StateTimes, States, Toward};
pub use stats::{FifoStats, LinkMessages, LinkStats, Measured};
pub use topology::{Actor, FifoInfo, Names, Shape, Topology};
pub use waits::{WaitAt, Waiting, Waits};
