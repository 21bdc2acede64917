//! What was seen of a run, beside its measures.

use super::path::CriticalPath;
use super::profile::Profile;
use super::recording::{JobSpan, Recording};
use super::snapshot::Snapshot;
use crate::quantities::Cycles;

/// What was seen of a run beside its measures, as far as it was asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Observed {
    /// The run over time, if the machine was probed.
    pub profile: Option<Profile>,
    /// A window of it cycle by cycle, if the machine was recorded.
    pub recording: Option<Recording>,
    /// The chain of causes that the run's length is made of, if the machine was explained.
    pub path: Option<CriticalPath>,
    /// The cycle that was looked for, if it was come to.
    pub looked_at: Option<Cycles>,
    /// What everybody did in that cycle, if it was known before.
    pub snapshot: Option<Snapshot>,
    /// All jobs by their numbers, if that was asked for. In a line each is there from the cycle in which the host writes its first
    /// word to that in which it reads the last of its answer; elsewhere from where the first task begins it to where the last has done it.
    pub spans: Vec<JobSpan>,
}
