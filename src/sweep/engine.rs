//! Running the points: those that share something do it once.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Sweep;
use super::cube_point::CubePoint;
use super::effective::{self, OF_ARRAYS};
use super::farm_point::FarmPoint;
use super::laid_out::LaidOut;
use super::parameters::Points;
use super::point::{self, Outcome};
use crate::cancel::Cancelled;
use crate::machine::Machine;
use crate::measure::Measured;
use crate::program::{Counts, Workload};
use crate::run::{InStep, Key, Keys, Layers, PlannedRun, RecordingMemory, Workers};
use crate::scene::Scene;

/// What had to be rounded, in some points of a sweep.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// What, in a sentence.
    pub text: String,
    /// In how many points.
    pub points: usize,
    /// The number of the first of them.
    pub first: usize,
}

/// The recordings that found no room in memory, whose points were timed while their rays were traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unkept {
    /// How many recordings.
    pub recordings: usize,
    /// How many points they are of.
    pub points: usize,
    /// How often their rays were traced, all together.
    pub rounds: usize,
}

/// What is to be said of points that were run, beside their results.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Account {
    /// What had to be rounded, in the order of the points.
    pub notes: Vec<Note>,
    /// What was not kept.
    pub unkept: Unkept,
}

impl Account {
    /// Adds what is to be said of other points.
    pub fn add(&mut self, other: Account) {
        self.notes.extend(other.notes);
        self.notes.sort_by(|a, b| a.text.cmp(&b.text));
        self.notes.dedup_by(|again, note| {
            let same = again.text == note.text;
            if same {
                (note.points, note.first) = (note.points + again.points, note.first.min(again.first));
            }
            same
        });
        self.notes.sort_by_key(|note| note.first);
        self.unkept.recordings += other.unkept.recordings;
        self.unkept.points += other.unkept.points;
        self.unkept.rounds += other.unkept.rounds;
    }
}

/// What a point gives: its results, and what had to be rounded for it.
type Given = Result<(Vec<String>, Vec<String>), String>;

impl Sweep {
    /// Runs points, and hands each one's results to `done` as they come: a cell for each of
    /// [`Sweep::results`]. Returns what is to be said beside them.
    ///
    /// Those of a scene are run one after the other, and among them those that do the same work, so that a scene is
    /// built once, and what its cells do, or what its pixels take, is worked out once.
    ///
    /// Fails if it is told to stop; the points that are not done by then are not handed to `done`.
    pub fn run(
        &self,
        points: &[usize],
        workers: &Workers,
        memory: RecordingMemory,
        done: impl Fn(usize, Vec<String>) + Sync,
    ) -> Result<Account, Cancelled> {
        // Each sentence, with how many points it is about and the first of them.
        let notes: Mutex<HashMap<String, (usize, usize)>> = Mutex::default();
        let note = |index: usize, text: String| {
            let mut notes = notes.lock().unwrap_or_else(PoisonError::into_inner);
            let (points, first) = notes.entry(text).or_insert((0, index));
            (*points, *first) = (*points + 1, index.min(*first));
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
        let unkept = on_threads(workers, || match self.of {
            Points::Arrays => self.run_arrays(points, workers, memory, done),
            Points::Farms => self.run_laid_out::<FarmPoint>(points, workers, done).map(|()| Unkept::default()),
            Points::Cubes => self.run_laid_out::<CubePoint>(points, workers, done).map(|()| Unkept::default()),
        })?;
        let notes = notes.into_inner().unwrap_or_else(PoisonError::into_inner);
        let notes = notes.into_iter().map(|(text, (points, first))| Note { text, points, first }).collect();
        let mut account = Account::default();
        account.add(Account { notes, unkept });
        Ok(account)
    }

    /// Points in groups that share a recording, those of the same scene one after the other. Those that cannot be run are
    /// the last group.
    pub fn groups(&self, points: &[usize]) -> Vec<Vec<usize>> {
        let mut impossible = Vec::new();
        let refuse = |index, _| impossible.push(index);
        let mut groups = match self.of {
            Points::Arrays => {
                let possible = possible(points, self.planned(points), refuse);
                by_layers(possible.iter().collect()).iter().map(numbers).collect::<Vec<_>>()
            }
            Points::Farms => {
                let possible = possible(points, self.laid_out::<FarmPoint>(points), refuse);
                by_key(possible.iter().collect(), FarmPoint::work_key).iter().map(numbers).collect()
            }
            Points::Cubes => {
                let possible = possible(points, self.laid_out::<CubePoint>(points), refuse);
                by_key(possible.iter().collect(), CubePoint::work_key).iter().map(numbers).collect()
            }
        };
        groups.push(impossible);
        groups.retain(|group| !group.is_empty());
        groups
    }

    /// The results of a point that failed: all empty but the last.
    pub(super) fn failed(&self, reason: String) -> Vec<String> {
        let mut row = vec![String::new(); self.results().len() - 1];
        row.push(reason);
        row
    }

    /// Those whose scene, laid out, is the same have it laid out once.
    fn run_laid_out<P: LaidOut + Send>(
        &self,
        points: &[usize],
        workers: &Workers,
        done: impl Fn(usize, Given) + Sync,
    ) -> Result<(), Cancelled> {
        let possible = possible(points, self.laid_out::<P>(points), |index, reason| done(index, Err(reason)));
        for same_work in by_key(possible.iter().collect(), P::work_key) {
            workers.cancel.check()?;
            let scene = same_work[0].1.lay_out(workers);
            let run = |point: &P| {
                let results = point.run(scene.as_ref().map_err(String::clone)?, &workers.cancel)?;
                let effective = effective::cells(P::EFFECTIVE, &self.parameters, point.machine());
                let of_scene = scene.iter().flat_map(|scene| {
                    let (name, notes) = P::told(scene);
                    of_scene(name, notes)
                });
                Ok(([effective, results].concat(), point.notes().iter().cloned().chain(of_scene).collect()))
            };
            one_by_one(&same_work).for_each(|(index, point)| done(*index, run(point)));
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
        memory: RecordingMemory,
        done: impl Fn(usize, Given) + Sync,
    ) -> Result<Unkept, Cancelled> {
        let possible = possible(points, self.planned(points), |index, reason| done(index, Err(reason)));
        let done = |index, planned: &PlannedRun, outcome: Result<Outcome, String>, scene: Option<&Scene>| {
            let effective = || effective::cells(&OF_ARRAYS, &self.parameters, &planned.machine);
            let of_scene = scene.into_iter().flat_map(|scene| of_scene(&planned.spec.scene, &scene.notes));
            let notes = planned.machine.notes.iter().cloned().chain(of_scene).collect();
            done(index, outcome.map(|outcome| ([effective(), outcome.results()].concat(), notes)));
        };
        let (mut layers, mut unkept) = (Layers::default(), Unkept::default());
        for same_ops in by_layers(possible.iter().collect()) {
            workers.cancel.check()?;
            run_same_ops(&same_ops, &mut layers, (workers, memory, &mut unkept), &done);
        }
        workers.cancel.check()?;
        Ok(unkept)
    }

    /// What is to be run for points, or why it cannot be.
    fn planned(&self, points: &[usize]) -> Vec<Result<PlannedRun, String>> {
        points.par_iter().map(|&index| point::planned(self.values(index))).collect()
    }

    /// The same of farms.
    fn laid_out<P: LaidOut>(&self, points: &[usize]) -> Vec<Result<P, String>> {
        points.iter().map(|&index| P::new(self.values(index))).collect()
    }
}

/// Those of the points that can be run; the others are refused, with the reason.
fn possible<P>(
    points: &[usize],
    planned: Vec<Result<P, String>>,
    mut refuse: impl FnMut(usize, String),
) -> Vec<(usize, P)> {
    let possible = |(&index, planned): (&usize, Result<P, String>)| match planned {
        Ok(planned) => Some((index, planned)),
        Err(reason) => {
            refuse(index, reason);
            None
        }
    };
    points.iter().zip(planned).filter_map(possible).collect()
}

/// The numbers of the points of a group.
fn numbers<P>(group: &Vec<&(usize, P)>) -> Vec<usize> {
    group.iter().map(|(index, _)| *index).collect()
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

/// Each for whichever thread is free next: some take many times as long as others.
fn one_by_one<T: Sync>(many: &[T]) -> impl ParallelIterator<Item = &T> {
    many.par_iter().with_max_len(1)
}

/// A point's number and what is to be run for it.
type Point = (usize, PlannedRun);

fn run_same_ops(
    points: &[&Point],
    layers: &mut Layers,
    (workers, memory, unkept): (&Workers, RecordingMemory, &mut Unkept),
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
    // Those whose machines are the same in cycles share their times.
    let same_times = by_key(points.to_vec(), |planned| planned.keys.timed.clone());
    let tell = |same: &[&Point], stats: Result<Measured, String>, (workload, counts): (&Workload, Counts)| {
        for (index, planned) in same {
            let outcome = stats.clone().map(|stats| Outcome::new(planned, workload, stats, counts));
            done(*index, planned, outcome, scene);
        }
    };
    let fail =
        |reason: String| points.iter().for_each(|(index, planned)| done(*index, planned, Err(reason.clone()), scene));
    match layers.traced_within(first, workers, memory) {
        Ok(Some(traced)) => one_by_one(&same_times).for_each(|same| {
            tell(same, point::time(&same[0].1, &traced, &workers.cancel), (traced.workload(), traced.counts()));
        }),
        // The recording finds no room.
        Ok(None) => {
            let machines: Vec<&Machine> = same_times.iter().map(|same| &same[0].1.machine).collect();
            match layers.timed_in_step(first, &machines, workers, memory) {
                Ok(InStep { workload, counts, times, rounds }) => {
                    unkept.recordings += 1;
                    unkept.points += points.len();
                    unkept.rounds += rounds;
                    for (same, stats) in same_times.iter().zip(times) {
                        tell(same, stats.map_err(point::reason), (&workload, counts));
                    }
                }
                Err(error) => fail(point::reason(error)),
            }
        }
        Err(error) => fail(point::reason(error)),
    }
}

/// The points by the ops that they share, those of the same scene one after the other, and among them those of the same
/// layout, so that each layer is made once.
fn by_layers(points: Vec<&Point>) -> Vec<Vec<&Point>> {
    let layers: [fn(&Keys) -> &Key; 4] =
        [|keys| &keys.scene, |keys| &keys.prepared, |keys| &keys.laid_out, |keys| &keys.traced];
    layers.iter().fold(vec![points], |groups, key| {
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
        let all: Vec<usize> = (0..sweep.points()).collect();
        let points: Vec<Point> = sweep.planned(&all).into_iter().map(Result::unwrap).enumerate().collect();
        let groups = by_layers(points.iter().collect());
        assert_eq!(groups.iter().map(Vec::len).collect::<Vec<_>>(), [64; 4], "two scenes in two modes");
        let scene = |group: &Vec<&Point>| group[0].1.spec.scene.clone();
        assert_eq!(groups.iter().map(scene).collect::<Vec<_>>(), ["room", "room", "teapot", "teapot"]);
        assert_eq!(groups[0][0].0, 0);
    }
}
