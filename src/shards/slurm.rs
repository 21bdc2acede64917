//! Slurm: an array of jobs, a shard each, and a job behind it that joins them.

use std::process::Output;

use super::engine::{AtOnce, Fate, Job, call, command};
use super::folder::Folder;
use super::plan::Plan;
use crate::error::InputError;

/// Submits shards, and what joins them.
pub(super) fn start(
    folder: &Folder,
    plan: &Plan,
    shards: &[usize],
    (lines, at_once): (&[String], AtOnce),
) -> Result<Job, InputError> {
    let unwritten = |error: std::io::Error| InputError::in_file(folder.path(), format!("cannot be written: {error}"));
    let limit = at_once.map(|most| format!("%{most}")).unwrap_or_default();
    let run = script(folder, plan, (lines, &format!("{}{limit}", ranges(shards))))?;
    let run = folder.keep_script("run.sh", &run).map_err(unwritten)?;
    let collect = folder.keep_script("collect.sh", &collector(folder, plan, lines)?).map_err(unwritten)?;
    let array = submit(&["--parsable", &run.to_string_lossy()])?;
    let behind = format!("--dependency=afterany:{array}");
    match submit(&["--parsable", &behind, &collect.to_string_lossy()]) {
        Ok(collector) => Ok(Job::Slurm { array, collector, shards: shards.to_vec() }),
        Err(error) => {
            let _ = call("scancel", &[&array]);
            Err(error)
        }
    }
}

/// The script of the array.
fn script(folder: &Folder, plan: &Plan, (lines, array): (&[String], &str)) -> Result<String, InputError> {
    let mut text = head(folder, plan, "a shard for each task of this array")?;
    text += &format!("#SBATCH --array={array}\n");
    text += &format!("#SBATCH --output={}\n", pattern(&folder.place("logs/%a.log").to_string_lossy(), "logs/%a.log"));
    text += "#SBATCH --open-mode=append\n#SBATCH --requeue\n";
    text += &format!("#SBATCH --cpus-per-task={}\n", plan.threads);
    text += &user_lines(lines);
    Ok(text + &format!("exec {} \"$SLURM_ARRAY_TASK_ID\"\n", command("shard", folder.path())?))
}

/// The script of the job that joins the results.
fn collector(folder: &Folder, plan: &Plan, lines: &[String]) -> Result<String, InputError> {
    let mut text = head(folder, plan, "joins the shards when the array has ended")?;
    text += &format!("#SBATCH --output={}\n", pattern(&folder.place("collect.log").to_string_lossy(), ""));
    text += &user_lines(lines);
    Ok(text + &format!("exec {}\n", command("collect --unless-waited-for", folder.path())?))
}

fn head(folder: &Folder, plan: &Plan, what: &str) -> Result<String, InputError> {
    let result = plan.result();
    let name: String = result.file_stem().unwrap_or_default().to_string_lossy().replace(char::is_whitespace, "-");
    Ok(format!(
        "#!/bin/bash\n# Made by pcs-sim {} for {}: {what}.\n# pcs-sim sweep status|collect|cancel {} goes on with it.\n\
         #SBATCH --job-name={name}\n#SBATCH --chdir={}\n",
        plan.version,
        one_line(&result.to_string_lossy()),
        one_line(&folder.path().to_string_lossy()),
        quoted(&plan.folder.to_string_lossy()),
    ))
}

/// A comment ends with its line.
fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

/// A value of `#SBATCH`.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A name of a log, in which a % stands for itself but in `end`.
fn pattern(path: &str, end: &str) -> String {
    let start = path.strip_suffix(end).unwrap_or(path);
    quoted(&(start.replace('%', "%%") + end))
}

/// The user's own lines, behind ours: the later of two counts.
fn user_lines(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
}

/// `0-9,12`: numbers as Slurm's arrays take them.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b).map(|run| match run {
        [one] => one.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    });
    runs.collect::<Vec<_>>().join(",")
}

/// Submits a script; returns the number of its job.
fn submit(args: &[&str]) -> Result<String, InputError> {
    let output = call("sbatch", args).map_err(|error| InputError::new(format!("sbatch cannot be called: {error}")))?;
    let answer = String::from_utf8_lossy(&output.stdout);
    // With several clusters the number is followed by the cluster's name.
    let number = answer.trim().split(';').next().unwrap_or_default();
    match output.status.success() && !number.is_empty() {
        true => Ok(number.to_owned()),
        false => {
            let error = InputError::new(format!("sbatch did not take the job: {}", said(&output)));
            Err(error
                .help("the script is run.sh in the folder of shards; --slurm-partition, --sbatch-arg ... add to it"))
        }
    }
}

/// What a program said of its failure, in a line.
fn said(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr);
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ")
}

/// What Slurm says of the tasks of an array: number, state. `None` if it cannot be asked; empty if it has forgotten
/// the array, which it does some time after its end.
fn tasks(array: &str) -> Option<Vec<(usize, String)>> {
    let jobs = format!("--jobs={array}");
    let output = call("squeue", &["--noheader", "--array", "--states=all", &jobs, "--format=%K|%T"]).ok()?;
    if !output.status.success() {
        return said(&output).contains("Invalid job id").then(Vec::new);
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let task = |line: &str| {
        let (number, state) = line.trim().split_once('|')?;
        Some((number.parse().ok()?, state.to_owned()))
    };
    Some(text.lines().filter_map(task).collect())
}

/// States in which Slurm does no more for a task.
const ENDED: [&str; 11] = [
    "BOOT_FAIL",
    "CANCELLED",
    "COMPLETED",
    "DEADLINE",
    "FAILED",
    "LAUNCH_FAILED",
    "NODE_FAIL",
    "OUT_OF_MEMORY",
    "PREEMPTED",
    "REVOKED",
    "TIMEOUT",
];

/// Whether some of its tasks may still run. What cannot be asked may.
pub(super) fn is_under_way(array: &str) -> bool {
    tasks(array).is_none_or(|tasks| tasks.iter().any(|(_, state)| !ENDED.contains(&state.as_str())))
}

pub(super) fn cancel(array: &str, collector: &str) -> Result<(), InputError> {
    let output = call("scancel", &[array, collector]);
    let output = output.map_err(|error| InputError::new(format!("scancel cannot be called: {error}")))?;
    match output.status.success() || said(&output).contains("Invalid job id") {
        true => Ok(()),
        false => Err(InputError::new(format!("scancel did not end job {array}: {}", said(&output)))),
    }
}

/// What became of each of so many shards.
pub(super) fn fates(folder: &Folder, array: &str, count: usize) -> Vec<Fate> {
    let Some(tasks) = tasks(array) else { return vec![Fate::Waiting; count] };
    let mut fates: Vec<Fate> = (0..count).map(|shard| Fate::Ended(logged(folder, shard))).collect();
    for (shard, state) in tasks {
        let Some(fate) = fates.get_mut(shard) else { continue };
        *fate = match state.as_str() {
            "RUNNING" | "COMPLETING" | "SUSPENDED" | "STOPPED" => Fate::Running,
            state if ENDED.contains(&state) => {
                Fate::Ended(told(state).map_or_else(|| logged(folder, shard), str::to_owned))
            }
            _ => Fate::Waiting,
        };
    }
    fates
}

/// What a state of Slurm's means to whoever waits for a shard's results.
fn told(state: &str) -> Option<&'static str> {
    Some(match state {
        "TIMEOUT" | "DEADLINE" => "its shard took longer than the time that it had",
        "OUT_OF_MEMORY" => "its shard took more memory than it had",
        "NODE_FAIL" | "BOOT_FAIL" => "the node of its shard was lost",
        "CANCELLED" | "PREEMPTED" | "REVOKED" => "its shard was cancelled",
        _ => return None,
    })
}

/// What Slurm wrote into the log of a shard when it ended it, for when it has forgotten the job.
fn logged(folder: &Folder, shard: usize) -> String {
    let log = std::fs::read(folder.log(shard)).unwrap_or_default();
    let log = String::from_utf8_lossy(&log);
    let last = log.lines().rev().find(|line| line.contains("slurmstepd") || line.contains("CANCELLED AT"));
    let known = last.and_then(|line| match line {
        line if line.contains("DUE TO TIME LIMIT") => told("TIMEOUT"),
        line if line.contains("oom") => told("OUT_OF_MEMORY"),
        line if line.contains("NODE FAILURE") => told("NODE_FAIL"),
        line if line.contains("CANCELLED") => told("CANCELLED"),
        _ => None,
    });
    known.unwrap_or("its shard ended before it was done").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_as_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 5, 7, 8]), "0-2,5,7-8");
        assert_eq!(ranges(&[3]), "3");
    }

    #[test]
    fn names_of_logs_may_have_any_sign() {
        assert_eq!(pattern("/a b/50% \"x\"/logs/%a.log", "logs/%a.log"), r#""/a b/50%% \"x\"/logs/%a.log""#);
    }
}
