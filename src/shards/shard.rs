//! A shard: one process that does one part.

use std::collections::{BTreeMap, HashMap};
use std::convert::Infallible;
use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::cut::Part;
use super::folder::Folder;
use super::plan::{Plan, Work};
use crate::cancel::Cancelled;
use crate::error::InputError;
use crate::program::{Counts, NotLaidOut};
use crate::run::{
    self, ByKind, KindCounts, Layers, PlannedRun, RecordingMemory, Rendered, RunError, RunSpec, Setup, Workers,
};
use crate::sweep::{Account, Sweep};

/// What a shard has found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Found {
    /// Results of points.
    Points(Points),
    /// Lines of an image.
    Lines(Lines),
}

/// Results of points of a sweep, by their [`Sweep::identity`], and what is to be said beside them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Points {
    /// A cell for each of [`Sweep::results`].
    pub results: BTreeMap<String, Vec<String>>,
    /// What is to be said, once the shard is done.
    pub account: Account,
}

/// Lines of an image, and what they took.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lines {
    /// The key of the plan.
    pub plan: String,
    /// Which lines.
    pub lines: Range<u32>,
    /// What was counted.
    pub counts: Counts,
    /// What was counted by the kind of ray.
    pub kinds: ByKind<KindCounts>,
    /// How many samples were taken.
    #[serde(default)]
    pub samples: u64,
    /// The pixels that got more samples.
    #[serde(default)]
    pub refined: Vec<u32>,
    /// Pixels: red, green and blue in 32 bits each, little end first, as base64.
    pixels: String,
}

/// Why a shard is not done.
#[derive(Debug, thiserror::Error)]
pub enum ShardError {
    /// This is not the program, or these are not the files, that it was planned with.
    #[error(transparent)]
    Refused(#[from] InputError),
    /// The image could not be made.
    #[error(transparent)]
    Failed(#[from] RunError<Infallible>),
    /// It was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// What it found could not be kept.
    #[error("what the shard found cannot be kept: {0}")]
    Unwritten(#[from] std::io::Error),
}

impl From<NotLaidOut> for ShardError {
    fn from(not: NotLaidOut) -> ShardError {
        ShardError::Failed(not.into())
    }
}

/// What is found is put into the folder no more often.
const PAUSE: Duration = Duration::from_secs(1);

/// Does one part of a plan, but for what was found before, and puts it into the folder as it comes. The process works in the folder of the plan
/// from then on.
///
/// # Errors
///
/// If program or files are not those of the plan, if the image cannot be made, if it is told to stop, and if results cannot
/// be written.
pub fn run_shard(folder: &Folder, plan: &Plan, number: usize, workers: &Workers) -> Result<(), ShardError> {
    let ended = plan.check_version().map_err(ShardError::from).and_then(|()| done(folder, plan, number, workers));
    let reason = match &ended {
        Err(ShardError::Cancelled(_)) => return ended,
        Err(error) => Some(error.to_string()),
        Ok(()) => None,
    };
    folder.keep_refusal(number, reason.as_deref())?;
    ended
}

fn done(folder: &Folder, plan: &Plan, number: usize, workers: &Workers) -> Result<(), ShardError> {
    enter(&plan.folder)?;
    plan.check()?;
    match (&plan.work, folder.part(number)?) {
        (Work::Sweep { .. }, Part::Points(points)) => {
            let memory =
                plan.recording_memory.map_or_else(|| RecordingMemory::fitting(workers.threads), RecordingMemory);
            points_done(folder, &points, number, workers, memory)
        }
        (Work::Image { spec, .. }, Part::Lines(lines)) => {
            let found = lines_done(spec, lines, plan, workers)?;
            Ok(folder.keep_found(number, &Found::Lines(found))?)
        }
        _ => Err(InputError::in_file(folder.path(), "has parts of something else than its plan").into()),
    }
}

fn enter(folder: &Path) -> Result<(), InputError> {
    std::env::set_current_dir(folder).map_err(|error| {
        let error = InputError::in_file(folder, format!("cannot be entered: {error}"));
        error.help("all machines must see the folder in which the shards were planned, under the same name")
    })
}

fn points_done(
    folder: &Folder,
    points: &[(usize, String)],
    number: usize,
    workers: &Workers,
    memory: RecordingMemory,
) -> Result<(), ShardError> {
    let sweep = Sweep::read(&folder.sweep_file())?;
    let of_sweep = |index: usize, key: &str| index < sweep.points() && sweep.identity(index) == key;
    if !points.iter().all(|(index, key)| of_sweep(*index, key)) {
        let error = InputError::in_file(&folder.sweep_file(), "does not have the points that were planned");
        return Err(error.help("begin anew with --force").into());
    }
    let found = match folder.found(number) {
        Ok(Some(Found::Points(found))) => found,
        _ => Points::default(),
    };
    let keys: HashMap<usize, &str> = points.iter().map(|(index, key)| (*index, key.as_str())).collect();
    let todo = points.iter().filter(|(_, key)| !found.results.contains_key(key)).map(|(index, _)| *index);
    let todo: Vec<usize> = todo.collect();
    let state = Mutex::new((found, Instant::now() + PAUSE, Ok(())));
    let ended = sweep.run(&todo, workers, memory, |index, results| {
        let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
        let (found, due, written) = &mut *state;
        let Some(key) = keys.get(&index) else { return };
        found.results.insert((*key).to_owned(), results);
        if Instant::now() < *due || written.is_err() {
            return;
        }
        *written = folder.keep_found(number, &Found::Points(found.clone()));
        *due = Instant::now() + PAUSE;
    });
    let (mut found, _, written) = state.into_inner().unwrap_or_else(PoisonError::into_inner);
    written?;
    found.account.add(ended?);
    Ok(folder.keep_found(number, &Found::Points(found))?)
}

fn lines_done(spec: &RunSpec, lines: Range<u32>, plan: &Plan, workers: &Workers) -> Result<Lines, ShardError> {
    let run = PlannedRun::new(spec.clone())?;
    let setup = Setup::new(run, &mut Layers::default(), &workers.cancel)?;
    let picture = setup.picture();
    let Rendered { pixels, counts, kinds, samples, refined, .. } =
        run::render_lines(&picture, lines.clone(), workers, |_| Ok::<_, Infallible>(()))?;
    let bytes: Vec<u8> =
        own(&pixels, &lines, spec).iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes).collect();
    Ok(Lines { plan: plan.key.clone(), lines, counts, kinds, samples, refined, pixels: STANDARD.encode(bytes) })
}

/// The pixels of some lines.
fn own<'a>(pixels: &'a [Vec3], lines: &Range<u32>, spec: &RunSpec) -> &'a [Vec3] {
    let width = spec.size.width as usize;
    &pixels[lines.start as usize * width..lines.end as usize * width]
}

impl Lines {
    /// The pixels, line by line. `None` if they are none.
    pub(super) fn pixels(&self) -> Option<Vec<Vec3>> {
        let bytes = STANDARD.decode(&self.pixels).ok()?;
        let values = bytes.chunks_exact(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap_or_default()));
        let values: Vec<f32> = values.collect();
        Some(values.chunks_exact(3).map(Vec3::from_slice).collect())
    }
}
