//! Running the points: those that share something do it once.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::Sweep;
use super::effective::{self, OF_ARRAYS, OF_FARMS};
use super::farm_point::FarmPoint;
use super::parameters::Points;
use super::point::{self, Outcome};
use crate::cancel::Cancelled;
use crate::run::{Key, Keys, Layers, PlannedRun, Workers};
use crate::scene::Scene;

/// What had to be rounded, in some points of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// What, in a sentence.
    pub text: String,
    /// In how many points.
    pub points: usize,
}

/// What a point gives: its results, and what had to be rounded for it.
type Given = Result<(Vec<String>, Vec<String>), String>;

impl Sweep {
    /// Runs points, and hands each one's results to `done` as they come: a cell for each of
    /// [`Sweep::results`]. Returns what had to be rounded, in the order of the points.
    ///
    /// Those of a scene are run one after the other, and among them those that do the same work, so that a scene is
    /// built once, and what its cells do, or what its pixels take, is worked out once.
    ///
    /// Fails if it is told to stop; the points that are not done by then are not handed to `done`.
    pub fn run(
        &self,
        points: &[usize],
        workers: &Workers,
        done: impl Fn(usize, Vec<String>) + Sync,
    ) -> Result<Vec<Note>, Cancelled> {
        // Each sentence, with the first point that it is about and with how many.
        let notes: Mutex<HashMap<String, (usize, usize)>> = Mutex::default();
        let note = |index: usize, text: String| {
            let mut notes = notes.lock().unwrap_or_else(PoisonError::into_inner);
            let (first, points) = notes.entry(text).or_insert((index, 0));
            (*first, *points) = (index.min(*first), *points + 1);
        };
        // What a point comes to that was stopped is no result of it.
        let done = |index, given: Given| {
            if workers.cancel.check().is_err() {
                return;
            }
            let (results, notes) = given.unwrap_or_else(|reason| (self.failed(reason), Vec::new()));
            notes.into_iter().for_each(|text| note(index, text));
            done(index, results);
        };
        on_threads(workers, || match self.of {
            Points::Arrays => self.run_arrays(points, workers, done),
            Points::Farms => self.run_farms(points, workers, done),
        })?;
        let mut notes: Vec<_> = notes.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().collect();
        notes.sort_by(|(text, (first, _)), (other, (others_first, _))| (first, text).cmp(&(others_first, other)));
        Ok(notes.into_iter().map(|(text, (_, points))| Note { text, points }).collect())
    }

    /// The results of a point that failed: all empty but the last.
    fn failed(&self, reason: String) -> Vec<String> {
        let mut row = vec![String::new(); self.results().len() - 1];
        row.push(reason);
        row
    }

    /// Farms whose pixels take the same are laid out once.
    fn run_farms(
        &self,
        points: &[usize],
        workers: &Workers,
        done: impl Fn(usize, Given) + Sync,
    ) -> Result<(), Cancelled> {
        let mut possible = Vec::new();
        for &index in points {
            match FarmPoint::new(self.values(index)) {
                Ok(point) => possible.push((index, point)),
                Err(reason) => done(index, Err(reason)),
            }
        }
        for same_work in by_key(possible.iter().collect(), FarmPoint::work_key) {
            workers.cancel.check()?;
            let scene = same_work[0].1.lay_out(workers);
            let run = |point: &FarmPoint| {
                let results = point.run(scene.as_ref().map_err(String::clone)?, &workers.cancel)?;
                let effective = effective::cells(&OF_FARMS, &self.parameters, &point.machine);
                let of_scene = scene.iter().flat_map(|scene| of_scene(&scene.name, &scene.notes));
                Ok(([effective, results].concat(), point.machine.notes.iter().cloned().chain(of_scene).collect()))
            };
            same_work.par_iter().for_each(|(index, point)| done(*index, run(point)));
        }
        workers.cancel.check()
    }

    /// The names of the parameters with their values in a point.
    fn values(&self, index: usize) -> impl Iterator<Item = (&'static str, String)> {
        self.parameters.iter().map(|parameter| parameter.column.name).zip(self.point(index))
    }

    fn run_arrays(
        &self,
        points: &[usize],
        workers: &Workers,
        done: impl Fn(usize, Given) + Sync,
    ) -> Result<(), Cancelled> {
        let planned: Vec<Result<PlannedRun, String>> = points.par_iter().map(|&index| self.planned(index)).collect();
        let mut possible = Vec::new();
        for (&index, planned) in points.iter().zip(planned) {
            match planned {
                Ok(planned) => possible.push((index, planned)),
                Err(reason) => done(index, Err(reason)),
            }
        }
        let done = |index, planned: &PlannedRun, outcome: Result<Outcome, String>, scene: Option<&Scene>| {
            let effective = || effective::cells(&OF_ARRAYS, &self.parameters, &planned.machine);
            let of_scene = scene.into_iter().flat_map(|scene| of_scene(&planned.spec.scene, &scene.notes));
            let notes = planned.machine.notes.iter().cloned().chain(of_scene).collect();
            done(index, outcome.map(|outcome| ([effective(), outcome.results()].concat(), notes)));
        };
        let mut layers = Layers::default();
        for same_ops in by_layers(&possible) {
            workers.cancel.check()?;
            run_same_ops(&same_ops, &mut layers, workers, &done);
        }
        workers.cancel.check()
    }

    /// What is to be run for a point, or why it cannot be.
    fn planned(&self, index: usize) -> Result<PlannedRun, String> {
        point::planned(self.values(index))
    }
}

/// What was changed in a scene when it was read, which a sweep may have several of.
fn of_scene<'a>(scene: &'a str, notes: &'a [String]) -> impl Iterator<Item = String> + 'a {
    notes.iter().map(move |note| format!("{scene}: {note}"))
}

/// Does something on so many threads as there are workers.
fn on_threads<T: Send>(workers: &Workers, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(workers.threads).build() {
        Ok(pool) => pool.install(work),
        // No threads can be had: what there is has to do.
        Err(_) => work(),
    }
}

/// A point's number and what is to be run for it.
type Point = (usize, PlannedRun);

fn run_same_ops(
    points: &[&Point],
    layers: &mut Layers,
    workers: &Workers,
    done: &(impl Fn(usize, &PlannedRun, Result<Outcome, String>, Option<&Scene>) + Sync),
) {
    let (first, others) = match points {
        [first, others @ ..] => (&first.1, others),
        [] => return,
    };
    // They share their scene, too.
    let scene = layers.scene(first).ok();
    let scene = scene.as_deref();
    if others.is_empty() || first.spec.image.is_some() {
        let run = |(index, planned): &&Point| done(*index, planned, point::run(planned, layers, workers), scene);
        return points.iter().for_each(run);
    }
    let traced = layers.traced(first, workers).map_err(point::reason);
    let time = |planned| point::time(planned, traced.as_ref().map_err(String::clone)?, &workers.cancel);
    points.par_iter().for_each(|(index, planned)| done(*index, planned, time(planned), scene));
}

/// The points by the ops that they share, those of the same scene one after the other, and among them those of the same
/// layout, so that each layer is made once.
fn by_layers(points: &[Point]) -> Vec<Vec<&Point>> {
    let layers: [fn(&Keys) -> &Key; 4] =
        [|keys| &keys.scene, |keys| &keys.prepared, |keys| &keys.laid_out, |keys| &keys.traced];
    layers.iter().fold(vec![points.iter().collect()], |groups, key| {
        groups.into_iter().flat_map(|group| by_key(group, |planned| key(&planned.keys).clone())).collect()
    })
}

/// Puts points with the same key together, in the order in which the keys come first.
fn by_key<P, K: Eq + Hash>(points: Vec<&(usize, P)>, key: impl Fn(&P) -> K) -> Vec<Vec<&(usize, P)>> {
    let mut places = HashMap::new();
    let mut groups: Vec<Vec<&(usize, P)>> = Vec::new();
    for point in points {
        let place = *places.entry(key(&point.1)).or_insert(groups.len());
        if place == groups.len() {
            groups.push(Vec::new());
        }
        groups[place].push(point);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Only what changes the ops is worked out again: no depth, rate, latency or memory.
    #[test]
    fn points_that_only_the_machine_tells_apart_share_their_ops() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("sweep.ron");
        let text = r#"(scene: ["room", "teapot"], mode: ["pipeline", "broadcast"], fifo_words: [4, 8], clock_ns: [50, 100],
            link_mb_s: [80, 40], latency_cycles: [1, 2], memory_words: [1000, 2000], rate_counts: ["link", "channel"])"#;
        std::fs::write(&file, text).unwrap();
        let sweep = Sweep::read(&file).unwrap();
        let points: Vec<Point> = (0..sweep.points()).map(|index| (index, sweep.planned(index).unwrap())).collect();
        let groups = by_layers(&points);
        assert_eq!(groups.iter().map(Vec::len).collect::<Vec<_>>(), [64; 4], "two scenes in two modes");
        let scene = |group: &Vec<&Point>| group[0].1.spec.scene.clone();
        assert_eq!(groups.iter().map(scene).collect::<Vec<_>>(), ["room", "room", "teapot", "teapot"]);
        assert_eq!(groups[0][0].0, 0);
    }
}
