//! Work that is cut into shards: started, waited for, joined; and `pcs-sim sweep status|collect|cancel|shard FOLDER`.

mod gather;
mod image;
mod sweep;

use std::path::Path;
use std::time::{Duration, Instant};

use pcs_sim::error::InputError;
use pcs_sim::report::summary::plural;
use pcs_sim::run::Workers;
use pcs_sim::shards::{Folder, Job, Lock, Plan, ShardError, State, Work, run_shard, states};

use super::engine_args::{CollectArgs, FolderArgs, ShardArgs, ShardsCommand};
use super::{Failure, note, print};

pub use image::image;
pub use sweep::{Missing, sweep};

/// Goes on with shards that were started.
pub fn shards(command: &ShardsCommand) -> Result<(), Failure> {
    match command {
        ShardsCommand::Status(args) => status(args),
        ShardsCommand::Collect(args) => collect(args),
        ShardsCommand::Cancel(args) => cancel(args),
        ShardsCommand::Shard(args) => shard(args),
    }
}

fn status(args: &FolderArgs) -> Result<(), Failure> {
    let (folder, plan) = Folder::open(&args.folder)?;
    let job = folder.job()?;
    let states = states(&folder, &plan, job.as_ref())?;
    let count = |wanted: fn(&State) -> bool| states.iter().filter(|(state, _)| wanted(state)).count();
    let name = job.map_or_else(|| "not started".to_owned(), |job| job.name());
    let mut text = format!("{}: {}, {name}\n", plan.result().display(), plural(plan.shards as u64, "shard"));
    text += &format!(
        "{} done, {} running, {} waiting, {} missing\n",
        count(|state| *state == State::Done),
        count(|state| *state == State::Running),
        count(|state| *state == State::Waiting),
        count(|state| matches!(state, State::Missing(_))),
    );
    if let Work::Sweep { .. } = plan.work {
        text += &format!("{} found\n", plural(states.iter().map(|(_, found)| *found as u64).sum(), "point"));
    }
    print(&(text + &reasons(&states)))
}

/// Why shards are missing, each reason once.
fn reasons(states: &[(State, usize)]) -> String {
    let mut reasons: Vec<(&str, usize)> = Vec::new();
    for (state, _) in states {
        let State::Missing(reason) = state else { continue };
        match reasons.iter_mut().find(|(known, _)| known == reason) {
            Some((_, count)) => *count += 1,
            None => reasons.push((reason, 1)),
        }
    }
    reasons.iter().map(|(reason, count)| format!("  {count} missing: {reason}\n")).collect()
}

fn collect(args: &CollectArgs) -> Result<(), Failure> {
    let (folder, plan) = Folder::open(&args.folder)?;
    plan.check_version()?;
    let lock = match folder.lock()? {
        Some(_) if args.unless_waited_for && folder.is_joined() => return Ok(()),
        Some(lock) => lock,
        None if args.unless_waited_for => return Ok(()),
        None => return Err(is_joined_elsewhere(&folder).into()),
    };
    std::env::set_current_dir(&plan.folder).map_err(|error| InputError::in_file(&plan.folder, error.to_string()))?;
    match &plan.work {
        Work::Sweep { table } => sweep::collect(&folder, &plan, table, lock),
        Work::Image { output, .. } => image::collect(&folder, &plan, output, lock),
    }
}

fn cancel(args: &FolderArgs) -> Result<(), Failure> {
    let (folder, plan) = Folder::open(&args.folder)?;
    let Some(job) = folder.job()?.filter(|job| job.is_under_way(&folder)) else {
        return print("nothing is under way\n");
    };
    job.cancel(&folder)?;
    let done = states(&folder, &plan, Some(&job))?.iter().filter(|(state, _)| *state == State::Done).count();
    let share = format!("cancelled with {done} of {} done", plural(plan.shards as u64, "shard"));
    print(&format!("{share}; the command that started them goes on from there\n"))
}

fn shard(args: &ShardArgs) -> Result<(), Failure> {
    let (folder, plan) = Folder::open(&args.folder)?;
    let ended = run_shard(&folder, &plan, args.number, &Workers::new(plan.threads.into()));
    ended.map_err(|error| match error {
        ShardError::Refused(error) => error.into(),
        ShardError::Failed(error) => error.into(),
        ShardError::Cancelled(_) | ShardError::Unwritten(_) => Failure::Output(error.to_string()),
    })
}

fn is_joined_elsewhere(folder: &Folder) -> InputError {
    let error = InputError::in_file(folder.path(), "another process waits for these shards and joins them");
    error.help("wait for it, or end it")
}

/// Lets nobody else join the shards of a folder.
fn locked(folder: &Folder) -> Result<Lock, InputError> {
    folder.lock()?.ok_or_else(|| is_joined_elsewhere(folder))
}

/// Fails if shards of the table are under way: what they work on is not to be begun anew.
pub fn check_idle(table: &Path) -> Result<(), InputError> {
    under_way(&Folder::beside(table)?, |_| false).map(drop)
}

/// A job that is under way in a folder, if it is of such work.
///
/// Fails if another is.
fn under_way(folder: &Folder, is_same: impl Fn(&Plan) -> bool) -> Result<Option<(Plan, Job)>, InputError> {
    let Some(job) = folder.job()?.filter(|job| job.is_under_way(folder)) else { return Ok(None) };
    match folder.plan()?.filter(is_same) {
        Some(plan) => Ok(Some((plan, job))),
        None => {
            let error = InputError::in_file(folder.path(), format!("{} is under way here", job.name()));
            Err(error.help("wait for it, or end it with `pcs-sim sweep cancel FOLDER`; then begin something else"))
        }
    }
}

/// What is told of shards that are not waited for.
fn detached(folder: &Folder, plan: &Plan, job: &Job) -> Result<(), Failure> {
    let shown = shown(folder);
    let shards = plural(plan.shards as u64, "shard");
    print(&format!("{shards} under way: {}\n`pcs-sim sweep status|collect|cancel {shown}` goes on\n", job.name()))
}

/// A folder's name as people see it from where they are.
fn shown(folder: &Folder) -> String {
    let here = std::env::current_dir().and_then(|folder| folder.canonicalize()).unwrap_or_default();
    folder.path().strip_prefix(here).unwrap_or(folder.path()).display().to_string()
}

/// What becomes of shards if nobody waits for them any more.
pub fn kept(folder: &Folder) -> String {
    format!("the shards run on; `pcs-sim sweep status|collect|cancel {}` goes on", shown(folder))
}

/// The engine is first asked whether its job has ended after so long, then after longer and longer.
const FIRST_PAUSE: Duration = Duration::from_millis(500);
const LONGEST_PAUSE: Duration = Duration::from_secs(10);
/// The folder is looked through so often.
const GLANCE: Duration = Duration::from_millis(200);

/// Waits until all is found or the job has ended. `look` takes what is new, and says whether it is all.
fn wait(folder: &Folder, job: &Job, mut look: impl FnMut() -> Result<bool, Failure>) -> Result<(), Failure> {
    let (mut pause, mut asked) = (FIRST_PAUSE, Instant::now());
    while !look()? {
        if asked.elapsed() > pause {
            if !job.is_under_way(folder) {
                return look().map(drop);
            }
            asked = Instant::now();
            pause = (pause * 3 / 2).min(LONGEST_PAUSE);
        }
        std::thread::sleep(GLANCE);
    }
    Ok(())
}

/// Tells where the logs of shards are, if some are missing.
fn tell_missing(folder: &Folder, missing: usize) {
    if missing > 0 {
        let logs = Path::new(&shown(folder)).join("logs");
        note(format!("{} missing; what they said is in {}", plural(missing as u64, "shard"), logs.display()));
    }
}
