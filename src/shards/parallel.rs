//! GNU parallel: shards on this machine, or on others by ssh.

use std::collections::HashMap;
use std::process::{Command, Stdio};

use super::engine::{AtOnce, Fate, Job, call, command, quoted};
use super::folder::Folder;
use super::plan::Plan;
use crate::error::InputError;

/// Starts shards in a group of processes of their own, which outlives this one.
pub(super) fn start(
    folder: &Folder,
    plan: &Plan,
    shards: &[usize],
    (args, at_once): (&[String], AtOnce),
) -> Result<Job, InputError> {
    let failed = |error: std::io::Error| InputError::in_file(folder.path(), format!("cannot be used: {error}"));
    for name in ["joblog", "ended"] {
        let _ = std::fs::remove_file(folder.place(name));
    }
    let shard = folder.keep_script("shard.sh", &shard_script(folder)?).map_err(failed)?;
    let run = run_script(folder, plan, (&quoted(&shard.to_string_lossy()), shards), (args, at_once))?;
    let run = folder.keep_script("run.sh", &run).map_err(failed)?;
    let log = std::fs::File::create(folder.place("run.log")).map_err(failed)?;
    let mut command = Command::new("nohup");
    command.arg("sh").arg(&run).stdin(Stdio::null());
    command.stdout(log.try_clone().map_err(failed)?).stderr(log);
    let child = apart(&mut command).spawn();
    let child = child.map_err(|error| InputError::new(format!("GNU parallel cannot be started: {error}")))?;
    Ok(Job::Parallel { host: host(), group: child.id(), shards: shards.to_vec() })
}

/// In a group of its own, so that what ends this process does not end it.
#[cfg(unix)]
fn apart(command: &mut Command) -> &mut Command {
    use std::os::unix::process::CommandExt;
    command.process_group(0)
}

#[cfg(not(unix))]
fn apart(command: &mut Command) -> &mut Command {
    command
}

/// One shard, by its number.
fn shard_script(folder: &Folder) -> Result<String, InputError> {
    let log = quoted(&folder.place("logs").to_string_lossy());
    Ok(format!("#!/bin/sh\nexec {} \"$1\" >>{log}/\"$1\".log 2>&1\n", command("shard", folder.path())?))
}

fn run_script(
    folder: &Folder,
    plan: &Plan,
    (shard, shards): (&str, &[usize]),
    (args, at_once): (&[String], AtOnce),
) -> Result<String, InputError> {
    let place = |name: &str| quoted(&folder.place(name).to_string_lossy());
    // As many as there are cores, but for the threads of each.
    let jobs = at_once.map_or_else(|| format!("{}%", (100 / plan.threads.max(1)).max(1)), |jobs| jobs.to_string());
    let numbers: Vec<String> = shards.iter().map(usize::to_string).collect();
    let args: String = args.iter().map(|arg| format!("{} ", quoted(arg))).collect();
    let comment = |text: &str| text.replace(['\n', '\r'], " ");
    Ok(format!(
        "#!/bin/sh\n# Made by pcs-sim {} for {}: its shards, by GNU parallel.\n\
         # pcs-sim sweep status|collect|cancel {} goes on with it.\ncd {} || exit 1\n\
         parallel --quote --joblog {} --retries 3 --jobs {jobs} {args}sh {shard} '{{}}' ::: {}\n\
         echo $? >{}\nexec {}\n",
        plan.version,
        comment(&plan.result().to_string_lossy()),
        comment(&folder.path().to_string_lossy()),
        quoted(&plan.folder.to_string_lossy()),
        place("joblog"),
        numbers.join(" "),
        place("ended"),
        command("collect --unless-waited-for", folder.path())?,
    ))
}

/// The name of this machine.
fn host() -> String {
    let output = call("uname", &["-n"]).map(|output| output.stdout).unwrap_or_default();
    String::from_utf8_lossy(&output).trim().to_owned()
}

/// Whether it may still run: until it has said that it ended, as far as can be told from this machine.
pub(super) fn is_under_way(folder: &Folder, at: &str, group: u32) -> bool {
    let lives = || call("kill", &["-0", "--", &format!("-{group}")]).is_ok_and(|output| output.status.success());
    !folder.place("ended").exists() && (at != host() || lives())
}

pub(super) fn cancel(folder: &Folder, at: &str, group: u32) -> Result<(), InputError> {
    if !is_under_way(folder, at, group) {
        return Ok(());
    }
    if at != host() {
        let error = InputError::new(format!("GNU parallel was started on {at}, and this is {}", host()));
        return Err(error.help("cancel it there; if that machine is gone, remove job.json in the folder of shards"));
    }
    let output = call("kill", &["-TERM", "--", &format!("-{group}")]);
    if !output.is_ok_and(|output| output.status.success()) {
        return Err(InputError::new(format!("process group {group} cannot be ended")));
    }
    // It says so itself only where it comes to its end.
    let ended = folder.keep_script("ended", "cancelled\n");
    ended.map(drop).map_err(|error| InputError::in_file(folder.path(), format!("cannot be written: {error}")))
}

/// What became of each of so many shards.
pub(super) fn fates(folder: &Folder, (at, group): (&str, u32), count: usize) -> Vec<Fate> {
    let logged = logged(&std::fs::read_to_string(folder.place("joblog")).unwrap_or_default());
    let under_way = is_under_way(folder, at, group);
    let fate = |shard: usize| match logged.get(&shard) {
        Some(reason) => Fate::Ended(reason.clone()),
        None if !under_way => Fate::Ended("its shard was not run to its end".to_owned()),
        None if folder.log(shard).exists() => Fate::Running,
        None => Fate::Waiting,
    };
    (0..count).map(fate).collect()
}

/// The shards that GNU parallel says have ended, with why they may not be done.
fn logged(log: &str) -> HashMap<usize, String> {
    let ended = |line: &str| {
        let fields: Vec<&str> = line.splitn(9, '\t').collect();
        let [_, host, _, _, _, _, status, signal, command] = fields[..] else { return None };
        let shard = command.rsplit(' ').next()?.parse().ok()?;
        let reason = match (status, signal) {
            (_, signal) if signal != "0" => format!("its shard was ended by signal {signal} on {host}"),
            ("255", _) => format!("{host} cannot be reached, or was lost"),
            (status, _) => format!("its shard ended with status {status} on {host}"),
        };
        Some((shard, reason))
    };
    log.lines().skip(1).filter_map(ended).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_of_jobs_are_understood() {
        let log = "Seq\tHost\tStarttime\tJobRuntime\tSend\tReceive\tExitval\tSignal\tCommand\n\
                   1\tn1\t1.5\t0.2\t0\t0\t0\t0\tsh /a\\ b/shard.sh 4\n\
                   2\tn2\t1.5\t0.2\t0\t0\t255\t0\tsh /a/shard.sh 11\n3\tn2\t1.5\t0.2\t0\t0\t0\t9\tsh /a/shard.sh 3\n4\tn";
        let logged = logged(log);
        assert_eq!(logged.len(), 3);
        assert_eq!(logged[&4], "its shard ended with status 0 on n1");
        assert_eq!(logged[&11], "n2 cannot be reached, or was lost");
        assert_eq!(logged[&3], "its shard was ended by signal 9 on n2");
    }
}
