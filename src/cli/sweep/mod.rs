//! `pcs-sim sweep SWEEP.ron`: many runs, and one table of them.

mod latest;
mod plots;

use std::path::{Path, PathBuf};

use pcs_sim::report::summary::{WIDTH, plural, wrapped};
use pcs_sim::report::table::check_name;
use pcs_sim::run::RecordingMemory;
use pcs_sim::shards::Folder;
use pcs_sim::sweep::{Account, Note, Record, Sweep, Unkept};

use super::args::SweepArgs;
use super::run::workers;
use super::shards::{self, Missing};
use super::{Failure, interrupt, note, outputs, print, progress};
use latest::Latest;
use plots::Plots;

/// Kinds of failures and of roundings that are told; the table has the others.
const TOLD: usize = 5;

/// Runs the points that are not done yet; the table grows as they finish.
pub fn sweep(args: &SweepArgs) -> Result<(), Failure> {
    let file = match (&args.shards, &args.sweep) {
        (Some(command), _) => return shards::shards(command),
        (None, file) => file.as_deref().unwrap_or(Path::new("")),
    };
    let sweep = Sweep::read(file)?;
    match &args.table {
        Some(table) => run(args, &sweep, (file, table)),
        None => print(&format!("{}\n", points(sweep.points()))),
    }
}

fn run(args: &SweepArgs, sweep: &Sweep, (file, table): (&Path, &Path)) -> Result<(), Failure> {
    check_name(table)?;
    let engine = args.engine.engine()?;
    let results = ["csv", "parquet", "sweep.ron", "journal"].map(|ending| table.with_extension(ending));
    let inputs: Vec<Option<&Path>> = sweep.files().map(|file| file.path.as_path()).chain([file]).map(Some).collect();
    outputs::check_distinct(&results.each_ref().map(Some), &inputs)?;
    if engine.is_some() && args.force {
        shards::check_idle(table)?;
    }
    let plots = Plots::open(args, table, &sweep.columns())?;
    let mut record = Record::open(sweep, table, args.force)?;
    let before = record.done();
    let bar = progress::points(sweep.points() as u64);
    let from = |done: usize| {
        bar.set_position(done as u64);
        bar.reset_eta();
    };
    let mut latest = Latest::new(sweep, &bar, args.watch);
    let seen = |row: &[String]| {
        latest.add(row);
        bar.inc(1);
    };
    let ended = match engine {
        None => {
            from(before);
            Some((here(args, sweep, &mut record, seen)?, Missing(0)))
        }
        Some(engine) => {
            let begun = |folder: &Folder, done: usize| {
                from(done);
                interrupt::keeping(shards::kept(folder));
            };
            shards::sweep((&engine, args), (sweep, table), &mut record, begun, seen)?
        }
    };
    bar.finish_and_clear();
    let Some((beside, missing)) = ended else { return Ok(()) };
    tell(&beside.notes);
    let mut written: Vec<PathBuf> = record.table_paths().map(PathBuf::from).into();
    let undrawn = plots.write(&record.table(), &mut written)?;
    print(&format!("{}{}", account(&record, before, &beside.unkept), outputs::list(&written)))?;
    let failed = record.failures().count();
    let help = "the column `error` says why; --accept-failures takes such a table for a success";
    let failed = (failed > 0 && !args.accept_failures && missing.0 == 0)
        .then(|| format!("{failed} of {} failed: {help}", points(sweep.points())));
    let missing = (missing.0 > 0).then(|| missing.told(sweep.points()));
    let undrawn = (!undrawn.is_empty())
        .then(|| format!("{}; `pcs-sim plot` draws the table, which is whole", undrawn.join("; ")));
    match [missing, failed, undrawn].into_iter().flatten().collect::<Vec<_>>() {
        told if told.is_empty() => Ok(()),
        told => Err(Failure::Output(told.join("\n"))),
    }
}

/// Runs the points in this process.
fn here(
    args: &SweepArgs,
    sweep: &Sweep,
    record: &mut Record,
    seen: impl FnMut(&[String]) + Send,
) -> Result<Account, Failure> {
    let workers = workers(args.threads);
    let memory = args.recording_memory.unwrap_or_else(|| RecordingMemory::fitting(workers.threads));
    let ended = record.run(sweep, &workers, memory, seen);
    ended.map_err(|unrecorded| Failure::Output(unrecorded.to_string()))
}

/// What had to be rounded.
pub fn tell(notes: &[Note]) {
    for Note { text, points: count, .. } in notes.iter().take(TOLD) {
        note(format!("{text} (in {})", points(*count)));
    }
    if notes.len() > TOLD {
        let others = notes.len() - TOLD;
        note(format!("so were {others} other values; the table has what was simulated beside what was asked for"));
    }
}

/// How many points are done and how many failed, with the first reasons, and which recordings found no room.
pub fn account(record: &Record, before: usize, unkept: &Unkept) -> String {
    let (all, failed) = (record.done(), record.failures().count());
    let mut text = format!("{}: {} done", points(all), all - failed);
    if failed > 0 {
        text += &format!(", {failed} failed");
    }
    if before > 0 {
        text += &format!(" ({} now)", all - before);
    }
    text += "\n";
    let Unkept { recordings, points: timed, rounds } = *unkept;
    if recordings > 0 {
        let (larger, timed) = (plural(recordings as u64, "recording"), points(timed));
        let times = plural(rounds as u64, "time");
        text +=
            &format!("{larger} larger than --recording-memory: {timed} timed while the rays were traced, {times}\n");
    }
    let mut reasons: Vec<(&str, usize)> = Vec::new();
    for reason in record.failures() {
        match reasons.iter().position(|(known, _)| *known == reason) {
            Some(place) => reasons[place].1 += 1,
            None if reasons.len() < TOLD => reasons.push((reason, 1)),
            None => {}
        }
    }
    for (reason, count) in &reasons {
        text += &format!("  {}\n", wrapped(&format!("{count} failed: {reason}"), WIDTH - 4).replace('\n', "\n    "));
    }
    match failed - reasons.iter().map(|(_, count)| count).sum::<usize>() {
        0 => text,
        others => text + &format!("  {others} failed for other reasons\n"),
    }
}

/// `1 point`, `2 points`.
pub fn points(count: usize) -> String {
    plural(count as u64, "point")
}
