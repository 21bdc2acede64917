//! How far the shards of a plan are, and their image.

use glam::Vec3;

use super::cut::Part;
use super::engine::{Fate, Job};
use super::folder::Folder;
use super::plan::Plan;
use super::shard::Found;
use crate::error::InputError;
use crate::program::Counts;
use crate::run::{ByKind, KindCounts, Rendered};

/// How far a shard is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// It has found all that it was to find.
    Done,
    /// It is at work.
    Running,
    /// It has not begun, or begins again.
    Waiting,
    /// It is not done and nobody works on it: why.
    Missing(String),
}

/// How far each shard is, and how much of its part it has found: points, or 1 for an image's lines.
///
/// # Errors
///
/// If files of the folder cannot be read.
pub fn states(folder: &Folder, plan: &Plan, job: Option<&Job>) -> Result<Vec<(State, usize)>, InputError> {
    let fates = job.map(|job| job.fates(folder, plan.shards)).unwrap_or_default();
    (0..plan.shards)
        .map(|number| {
            let (found, all) = found_of(folder, plan, number)?;
            let state = match fates.get(number) {
                _ if found == all => State::Done,
                Some(Fate::Running) => State::Running,
                Some(Fate::Waiting) => State::Waiting,
                Some(Fate::Ended(reason)) => State::Missing(folder.refusal(number).unwrap_or_else(|| reason.clone())),
                None => State::Missing(folder.refusal(number).unwrap_or_else(|| "its shard was not run".to_owned())),
            };
            Ok((state, found))
        })
        .collect()
}

/// How much of its part a shard has found, and how much there is.
fn found_of(folder: &Folder, plan: &Plan, number: usize) -> Result<(usize, usize), InputError> {
    Ok(match (folder.part(number)?, folder.found(number)?) {
        (Part::Points(points), Some(Found::Points(found))) => {
            (points.iter().filter(|(_, key)| found.results.contains_key(key)).count(), points.len())
        }
        (Part::Points(points), _) => (0, points.len()),
        (Part::Lines(lines), Some(Found::Lines(found))) => {
            (usize::from(found.plan == plan.key && found.lines == lines), 1)
        }
        (Part::Lines(_), _) => (0, 1),
    })
}

/// The image of all shards; `None` if one is missing.
///
/// # Errors
///
/// If files of the folder cannot be read.
pub fn joined_image(folder: &Folder, plan: &Plan) -> Result<Option<Rendered>, InputError> {
    let (mut pixels, mut counts, mut kinds): (Vec<Vec3>, _, ByKind<KindCounts>) =
        (Vec::new(), Counts::default(), Default::default());
    let (mut samples, mut refined) = (0, Vec::new());
    for number in 0..plan.shards {
        let Some(Found::Lines(lines)) = folder.found(number)?.filter(|_| found_of(folder, plan, number) == Ok((1, 1)))
        else {
            return Ok(None);
        };
        let damaged = || InputError::in_file(&folder.results(number), "has no pixels: remove it and go on");
        pixels.extend(lines.pixels().ok_or_else(damaged)?);
        counts += lines.counts;
        samples += lines.samples;
        refined.extend(lines.refined);
        kinds.iter_mut().zip(lines.kinds).for_each(|(all, new)| *all += new);
    }
    Ok(Some(Rendered { pixels, counts, kinds, samples, refined, timing: None }))
}
