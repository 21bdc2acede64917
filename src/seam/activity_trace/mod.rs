//! The activity trace: one line per job and station with what the station did, `job cell op op ...`.
//!
//! In its form of units it begins with `pcs-sim trace 2 cells N answer WORDS` and a line `unit CODE NAME ACTIVITY CYCLES`
//! for each unit of work, with what that cost when the trace was recorded; ops that work are a unit's code and a count. In
//! its form of cycles it has no heading: work is an activity's letter and cycles, which no machine prices again.

mod heading;
mod line;
mod reader;
mod survey;
mod writer;

pub use reader::ActivityTrace;
pub use writer::TraceWriter;

/// What an activity trace counts work in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Units of work, which any machine prices: `gv12`.
    #[default]
    Units,
    /// Cycles of the machine that it was recorded for: `g1872`.
    Cycles,
}

/// How the heading of a trace in units begins.
const MAGIC: &str = "pcs-sim trace 2";

/// The longest op of a trace, in cycles, units or words.
const MOST_OF_AN_OP: u64 = (1 << 28) - 1;
