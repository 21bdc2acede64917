//! An image in shards of its lines.

use std::path::Path;

use pcs_sim::error::InputError;
use pcs_sim::report::summary::plural;
use pcs_sim::run::{FileRead, Rendered, RunSpec};
use pcs_sim::shards::{Engine, Folder, Job, Lock, Plan, State, Work, joined_image, states};

use super::super::args::ImageArgs;
use super::super::image::{Format, write_image};
use super::super::{Failure, interrupt, outputs, print, progress};
use super::{detached, kept, locked, reasons, tell_missing, under_way, wait};

/// Makes the image of a run that was made of these files. `None` if it is not to be waited for.
pub fn image(
    engine: &Engine,
    args: &ImageArgs,
    spec: &RunSpec,
    files: Vec<FileRead>,
) -> Result<Option<Rendered>, Failure> {
    engine.check()?;
    let manner = args.engine.manner(args.tracing.threads, None, args.results.force);
    let (plan, parts) = Plan::of_image(spec, files, &args.output, manner)?;
    let folder = Folder::beside(&args.output)?;
    let _lock = locked(&folder)?;
    let is_same = |other: &Plan| other.key == plan.key && other.version == plan.version;
    let (plan, job) = match (under_way(&folder, is_same)?, folder.plan().ok().flatten().filter(is_same)) {
        (Some((plan, job)), _) => (plan, Some(job)),
        // Lines that were made before are not made again.
        (None, Some(plan)) => start(engine, args, &folder, plan)?,
        (None, None) => {
            folder.begin(&plan, &parts, None)?;
            start(engine, args, &folder, plan)?
        }
    };
    if let Some(job) = &job {
        if args.engine.detach {
            detached(&folder, &plan, job)?;
            return Ok(None);
        }
        let bar = progress::shards(plan.shards as u64);
        interrupt::keeping(kept(&folder));
        wait(&folder, job, || {
            let done = (0..plan.shards).filter(|&shard| folder.results(shard).exists()).count();
            bar.set_position(done as u64);
            Ok(done == plan.shards)
        })?;
        bar.finish_and_clear();
    }
    let rendered = join(&folder, &plan)?;
    mark(&folder)?;
    Ok(Some(rendered))
}

/// Starts the shards that are not done.
fn start(engine: &Engine, args: &ImageArgs, folder: &Folder, plan: Plan) -> Result<(Plan, Option<Job>), Failure> {
    let states = states(folder, &plan, None)?;
    let missing: Vec<usize> = (0..plan.shards).filter(|&shard| states[shard].0 != State::Done).collect();
    let job = match missing.is_empty() {
        true => None,
        false => Some(engine.start(folder, &plan, &missing, args.engine.at_once)?),
    };
    Ok((plan, job))
}

/// The whole image.
fn join(folder: &Folder, plan: &Plan) -> Result<Rendered, Failure> {
    if let Some(rendered) = joined_image(folder, plan)? {
        return Ok(rendered);
    }
    let states = states(folder, plan, folder.job()?.as_ref())?;
    let missing = states.iter().filter(|(state, _)| matches!(state, State::Missing(_))).count();
    tell_missing(folder, missing);
    let open = states.iter().filter(|(state, _)| *state != State::Done).count();
    let all = plural(plan.shards as u64, "shard");
    Err(Failure::Output(match missing {
        0 => format!("{open} of {all} under way"),
        _ => format!("{missing} of {all} missing, which the same command makes:\n{}", reasons(&states).trim_end()),
    }))
}

/// Joins the lines of all shards.
pub fn collect(folder: &Folder, plan: &Plan, output: &Path, _lock: Lock) -> Result<(), Failure> {
    let Work::Image { spec, .. } = &plan.work else {
        return Err(InputError::in_file(folder.path(), "is of no image").into());
    };
    let rendered = join(folder, plan)?;
    let mut written = Vec::new();
    let format = Format::of(output).unwrap_or(Format::Png);
    write_image(outputs::open(Some(output), plan.overwrite)?, format, spec.size, &rendered.pixels, &mut written)?;
    mark(folder)?;
    print(&outputs::list(&written))
}

fn mark(folder: &Folder) -> Result<(), Failure> {
    let kept = folder.keep_joined();
    kept.map_err(|error| Failure::Output(format!("cannot write {}: {error}", folder.path().display())))
}
