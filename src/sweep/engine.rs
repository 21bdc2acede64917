//! Running the points: those that share something do it once.

use std::collections::HashMap;

use rayon::prelude::*;

use super::Sweep;
use super::farm_point::FarmPoint;
use super::parameters::Points;
use super::point::{Outcome, Recording, Setting, Stage};
use crate::run::{Cancelled, Workers};

impl Sweep {
    /// Runs points on all cores, and hands each one's results to `done` as they come: a cell for each of
    /// [`Sweep::results`].
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
    ) -> Result<(), Cancelled> {
        let stopped = || workers.cancel.check().is_err();
        // What a point comes to that was stopped is no result of it.
        let done = |index, result: Result<Vec<String>, String>| {
            if !stopped() {
                done(index, result.unwrap_or_else(|reason| self.failed(reason)))
            }
        };
        match self.of {
            Points::Arrays => self.run_arrays(points, workers, |index, result: Result<Outcome, String>| {
                done(index, result.map(|outcome| outcome.results()));
            }),
            Points::Farms => self.run_farms(points, workers, done),
        }
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
        done: impl Fn(usize, Result<Vec<String>, String>) + Sync,
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
            let run = |point: &FarmPoint| point.run(scene.as_ref().map_err(String::clone)?, &workers.cancel);
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
        done: impl Fn(usize, Result<Outcome, String>) + Sync,
    ) -> Result<(), Cancelled> {
        let settings: Vec<Result<Setting, String>> = points.par_iter().map(|&index| self.setting(index)).collect();
        let mut possible = Vec::new();
        for (&index, setting) in points.iter().zip(settings) {
            match setting {
                Ok(setting) => possible.push((index, setting)),
                Err(reason) => done(index, Err(reason)),
            }
        }
        for same_stage in by_key(possible.iter().collect(), Setting::stage_key) {
            workers.cancel.check()?;
            let stage = same_stage[0].1.stage();
            for same_work in by_key(same_stage, Setting::work_key) {
                workers.cancel.check()?;
                match &stage {
                    Ok(stage) => run_same_work(stage, &same_work, workers, &done),
                    Err(reason) => same_work.iter().for_each(|point| done(point.0, Err(reason.clone()))),
                }
            }
        }
        workers.cancel.check()
    }

    /// What is to be run for a point, or why it cannot be.
    fn setting(&self, index: usize) -> Result<Setting, String> {
        Setting::new(self.values(index))
    }
}

/// A point's number and what is to be run for it.
type Point = (usize, Setting);

fn run_same_work(
    stage: &Stage,
    points: &[&Point],
    workers: &Workers,
    done: &(impl Fn(usize, Result<Outcome, String>) + Sync),
) {
    if let Some(image) = points[0].1.image() {
        return points.iter().for_each(|(index, setting)| done(*index, setting.render(image, stage, workers)));
    }
    match (points[0].1.workload(stage), points) {
        (Err(reason), _) => points.iter().for_each(|(index, _)| done(*index, Err(reason.clone()))),
        (Ok(workload), [(index, setting)]) => done(*index, setting.run(&workload, stage.rays(), workers)),
        (Ok(workload), _) => {
            let recording = Recording::new(&workload, stage.rays(), workers);
            let time = |setting| recording.as_ref().map_err(String::clone)?.time(setting, &workers.cancel);
            points.par_iter().for_each(|(index, setting)| done(*index, time(setting)));
        }
    }
}

/// Puts points with the same key together, in the order in which the keys come first.
fn by_key<P>(points: Vec<&(usize, P)>, key: impl Fn(&P) -> String) -> Vec<Vec<&(usize, P)>> {
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
        let points: Vec<Point> = (0..sweep.points()).map(|index| (index, sweep.setting(index).unwrap())).collect();
        let stages = by_key(points.iter().collect(), Setting::stage_key);
        assert_eq!(stages.iter().map(Vec::len).collect::<Vec<_>>(), [128, 128]);
        let works = by_key(stages.into_iter().next().unwrap(), Setting::work_key);
        assert_eq!(works.iter().map(Vec::len).collect::<Vec<_>>(), [64; 2], "two modes");
        assert_eq!(works[0][0].0, 0);
    }
}
