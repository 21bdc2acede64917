//! A sweep in shards.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use pcs_sim::shards::{Engine, Folder, Job, Lock, Part, Plan, State, Work, states};
use pcs_sim::sweep::{Account, Record, Sweep};

use super::super::args::SweepArgs;
use super::super::sweep::{account, points, tell};
use super::super::{Failure, note, outputs, print};
use super::gather::Gathered;
use super::{detached, locked, tell_missing, under_way, wait};

/// How many points nobody has found.
pub struct Missing(pub usize);

/// Runs the points that are not done, and waits for them. `None` if they are not to be waited for. `seen` is told of each new row,
/// `begun` of what is waited for.
pub fn sweep(
    (engine, args): (&Engine, &SweepArgs),
    (sweep, table): (&Sweep, &Path),
    record: &mut Record,
    begun: impl FnOnce(&Folder, usize),
    mut seen: impl FnMut(&[String]),
) -> Result<Option<(Account, Missing)>, Failure> {
    engine.check()?;
    let folder = Folder::beside(table)?;
    let _lock = locked(&folder)?;
    let started = match under_way(&folder, |plan| is_of(plan, &folder, record))? {
        Some(started) => {
            note(format!("these points are under way: {}", started.1.name()));
            Some(started)
        }
        None => {
            // What was found before is not run again, but for what failed.
            if let Some(plan) = folder.plan().ok().flatten() {
                Gathered::default().take((&folder, &plan), sweep, record, |_| ())?;
                record.forget_failures();
            }
            start((engine, args), (sweep, table), record, &folder)?
        }
    };
    begun(&folder, record.done());
    let Some((plan, job)) = started else {
        written(record)?;
        return Ok(Some((Account::default(), Missing(0))));
    };
    if args.engine.detach {
        written(record)?;
        detached(&folder, &plan, &job)?;
        return Ok(None);
    }
    let mut gathered = Gathered::default();
    wait(&folder, &job, || {
        gathered.take((&folder, &plan), sweep, record, &mut seen)?;
        Ok(record.todo().next().is_none())
    })?;
    let missing = miss((&folder, &plan), sweep, record)?;
    written(record)?;
    joined(&folder)?;
    Ok(Some((gathered.account(), missing)))
}

/// Plans the points that are not done, and starts their shards; nothing, if all are.
fn start(
    (engine, args): (&Engine, &SweepArgs),
    (sweep, table): (&Sweep, &Path),
    record: &Record,
    folder: &Folder,
) -> Result<Option<(Plan, Job)>, Failure> {
    let todo: Vec<(usize, &str)> = record.todo().collect();
    if todo.is_empty() {
        return Ok(None);
    }
    let manner = args.engine.manner(args.threads, args.recording_memory, args.force);
    let (plan, parts) = Plan::of_sweep(sweep, &todo, table, manner)?;
    folder.begin(&plan, &parts, Some(&sweep.text()))?;
    let all: Vec<usize> = (0..plan.shards).collect();
    let job = engine.start(folder, &plan, &all, args.engine.at_once)?;
    Ok(Some((plan, job)))
}

/// Whether the points that are not done are those of a plan.
fn is_of(plan: &Plan, folder: &Folder, record: &Record) -> bool {
    let parts = (0..plan.shards).filter_map(|shard| match folder.part(shard) {
        Ok(Part::Points(points)) => Some(points),
        _ => None,
    });
    let planned: HashSet<String> = parts.flatten().map(|(_, point)| point).collect();
    matches!(plan.work, Work::Sweep { .. }) && record.todo().all(|(_, point)| planned.contains(point))
}

/// Says in the table why points are missing, of shards of which nobody works on.
fn miss((folder, plan): (&Folder, &Plan), sweep: &Sweep, record: &mut Record) -> Result<Missing, Failure> {
    let todo: HashMap<String, usize> = record.todo().map(|(index, point)| (point.to_owned(), index)).collect();
    if todo.is_empty() {
        return Ok(Missing(0));
    }
    let (mut points, mut shards) = (0, 0);
    for (shard, (state, _)) in states(folder, plan, folder.job()?.as_ref())?.into_iter().enumerate() {
        let (State::Missing(reason), Part::Points(part)) = (state, folder.part(shard)?) else { continue };
        let missing = part.iter().filter(|(_, point)| todo.contains_key(point));
        let before = points;
        for (index, _) in missing {
            record.miss(sweep, *index, &reason);
            points += 1;
        }
        shards += usize::from(points > before);
    }
    tell_missing(folder, shards);
    Ok(Missing(points))
}

/// Joins what there is by now.
pub fn collect(folder: &Folder, plan: &Plan, table: &Path, _lock: Lock) -> Result<(), Failure> {
    let sweep = Sweep::read(&folder.sweep_file())?;
    let mut record = Record::open(&sweep, table, plan.overwrite)?;
    let mut gathered = Gathered::default();
    gathered.take((folder, plan), &sweep, &mut record, |_| ())?;
    let Missing(missing) = miss((folder, plan), &sweep, &mut record)?;
    written(&record)?;
    let under_way = record.todo().count() - missing;
    let beside = gathered.account();
    tell(&beside.notes);
    let written: Vec<PathBuf> = record.table_paths().map(PathBuf::from).into();
    print(&format!("{}{}", account(&record, record.done(), &beside.unkept), outputs::list(&written)))?;
    match (missing, under_way) {
        (0, 0) => Ok(joined(folder)?),
        (_, 0) => {
            joined(folder)?;
            Err(Failure::Output(Missing(missing).told(sweep.points())))
        }
        _ => Err(Failure::Output(format!("{} under way", points(under_way)))),
    }
}

impl Missing {
    /// What is told of points that are missing.
    pub fn told(&self, all: usize) -> String {
        format!(
            "{} of {} missing: the column `error` says why; the same sweep command runs them again",
            self.0,
            points(all)
        )
    }
}

fn written(record: &Record) -> Result<(), Failure> {
    record.write_table().map_err(|error| Failure::Output(format!("the table cannot be written: {error}")))
}

fn joined(folder: &Folder) -> Result<(), Failure> {
    let kept = folder.keep_joined();
    kept.map_err(|error| Failure::Output(format!("cannot write {}: {error}", folder.path().display())))
}
