//! Work in shards: whoever runs them, in which order, how often and how far, what is joined is what one process makes.
//!
//! Engines are played by scripts here, and the test runs the shards itself; `tests/clusters` has the real ones.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::process::Command;

use crate::support::command::{Finished, Folder};

/// Points that fail and points that are rounded among others, in nine groups that share a recording.
const SWEEP: &str = r#"(scene: ["room", "wedge.obj"], size: 6, mode: ["pipeline", "hybrid"], grid_coefficient: [5, 50],
    stop_words: [0, 16], fifo_words: [4, 8, 64], link_mb_s: [80, 30])"#;
const OBJECT: &str = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 2 3\nf 1 3 4\n";

/// Slurm, as far as it is called: it takes all jobs and runs none. It says of tasks what stands in the file `tasks`.
const SBATCH: &str = "[ \"$1\" = --version ] && exit\n[ -e refuse ] && { echo 'sbatch: error: no such partition' >&2; exit 1; }\n\
    echo \"$*\" >>submitted\necho 7\n";
const SQUEUE: &str =
    "if [ -e tasks ]; then cat tasks; else echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1; fi\n";
const SCANCEL: &str = "echo \"$*\" >>cancelled\nrm -f tasks\n";

/// A folder with scripts in place of Slurm.
fn cluster() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("bin")).unwrap();
    for (name, text) in [("sbatch", SBATCH), ("squeue", SQUEUE), ("scancel", SCANCEL)] {
        let path = folder.file(&format!("bin/{name}"), format!("#!/bin/sh\n{text}"));
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).unwrap();
    }
    folder.file("wedge.obj", OBJECT);
    folder.file("m.mtl", "newmtl red\nKd 1 0 0\n");
    folder.file("s.ron", SWEEP);
    folder
}

/// Runs the command with the scripts at hand.
fn run(folder: &Folder, args: &str) -> Finished {
    let path = format!("{}:{}", folder.path("bin").display(), std::env::var("PATH").unwrap());
    let mut command = Command::new(env!("CARGO_BIN_EXE_pcs-sim"));
    command.args(args.split_whitespace()).current_dir(folder.path("")).env("PATH", path);
    let output = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Finished { status: output.status.code().unwrap(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// As many shards as a folder has.
fn count(folder: &Folder, shards: &str) -> usize {
    std::fs::read_dir(folder.path(&format!("{shards}/parts"))).unwrap().count()
}

fn run_shard(folder: &Folder, shards: &str, number: usize) {
    // From elsewhere, as on a node.
    let args = ["sweep", "shard", &folder.path(shards).display().to_string(), &number.to_string()].join(" ");
    crate::support::command::run_in(&std::env::temp_dir(), &args).success();
}

fn same(folder: &Folder, a: &str, b: &str) {
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(bytes(a) == bytes(b), "{a} and {b}");
}

/// The cells of the column `error`.
fn errors(folder: &Folder, table: &str) -> Vec<String> {
    let text = folder.read(table);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let column = reader.headers().unwrap().iter().position(|name| name == "error").unwrap();
    reader.records().map(|row| row.unwrap()[column].to_owned()).collect()
}

#[test]
fn shards_in_any_order_and_twice_make_the_same_table() {
    let folder = cluster();
    let told = run(&folder, "sweep s.ron -o local.csv --accept-failures").success();
    assert!(told.contains(" failed"), "{told}");
    for shards in [1, 5, 1000] {
        let name = format!("t{shards}");
        let told =
            run(&folder, &format!("sweep s.ron -o {name}.csv --engine slurm --shards {shards} --detach")).success();
        assert!(told.contains("Slurm's job 7") && told.contains("status|collect|cancel"), "{told}");
        let name = format!("{name}.shards");
        let count = count(&folder, &name);
        assert!((1..=96).contains(&count) && count >= shards.min(96), "{count} of {shards}");
        let backwards = (0..count).rev().chain([0, count / 2]);
        backwards.for_each(|number| run_shard(&folder, &name, number));
        let told = run(&folder, &format!("sweep collect {name}")).success();
        assert!(told.contains("96 points: "), "{told}");
        for ending in ["csv", "parquet"] {
            same(&folder, &format!("local.{ending}"), &format!("t{shards}.{ending}"));
        }
    }
    // The one that planned finds all of it done, but for what failed, which is tried again.
    let failed = errors(&folder, "t5.csv").iter().filter(|error| !error.is_empty()).count();
    run(&folder, "sweep s.ron -o t5.csv --engine slurm --shards 1 --detach").success();
    let part = folder.read("t5.shards/parts/0.json");
    assert_eq!(part.matches('[').count() - 1, failed, "{part}");
    run_shard(&folder, "t5.shards", 0);
    run(&folder, "sweep collect t5.shards").success();
    same(&folder, "local.csv", "t5.csv");
}

#[test]
fn farms_go_to_shards_too() {
    let folder = cluster();
    folder
        .file("farm.ron", r#"(farm: true, scene: "room", size: 12, tasks: [1, 2, 3, 4], items: ["lines", "pixels"])"#);
    run(&folder, "sweep farm.ron -o local.csv --accept-failures").success();
    run(&folder, "sweep farm.ron -o t.csv --engine slurm --shards 3 --detach").success();
    (0..count(&folder, "t.shards")).for_each(|number| run_shard(&folder, "t.shards", number));
    run(&folder, "sweep collect t.shards").success();
    same(&folder, "local.csv", "t.csv");
}

/// What shares a recording stays together, as far as a shard's share goes.
#[test]
fn shards_keep_recordings_together() {
    let folder = cluster();
    folder.file(
        "one.ron",
        r#"(scene: "room", size: 4, mode: ["pipeline", "broadcast"], link_mb_s: [80, 40], fifo_words: [8, 16, 32])"#,
    );
    run(&folder, "sweep one.ron -o t.csv --engine slurm --shards 2 --detach").success();
    let part = |number| {
        let text = folder.read(&format!("t.shards/parts/{number}.json"));
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        value["Points"].as_array().unwrap().iter().map(|point| point[0].as_u64().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(part(0), [0, 1, 2, 3, 4, 5], "the pipeline");
    assert_eq!(part(1), [6, 7, 8, 9, 10, 11], "broadcast");
}

/// Half of its points are there, of an earlier process that was killed; they are not run again.
#[test]
fn a_shard_goes_on_where_it_was_killed() {
    let folder = cluster();
    run(&folder, "sweep s.ron -o t.csv --engine slurm --shards 2 --detach").success();
    run_shard(&folder, "t.shards", 0);
    let results = "t.shards/results/0.json";
    let whole: serde_json::Value = serde_json::from_str(&folder.read(results)).unwrap();
    let mut half = whole.clone();
    let points = half["Points"]["results"].as_object_mut().unwrap();
    let keys: Vec<String> = points.keys().cloned().collect();
    keys.iter().step_by(2).for_each(|key| drop(points.remove(key)));
    // One that is kept is marked, to see that it is not made again.
    points[&keys[1]][0] = "marked".into();
    folder.file(results, half.to_string());
    run_shard(&folder, "t.shards", 0);
    let again: serde_json::Value = serde_json::from_str(&folder.read(results)).unwrap();
    for (key, cells) in whole["Points"]["results"].as_object().unwrap() {
        let found = &again["Points"]["results"][key];
        assert!(if *key == keys[1] { found[0] == "marked" } else { found == cells }, "{key}");
    }
}

#[test]
fn what_slurm_ended_is_told_and_run_again() {
    let folder = cluster();
    run(&folder, "sweep s.ron -o local.csv --accept-failures").success();
    run(&folder, "sweep s.ron -o t.csv --engine slurm --shards 6 --detach").success();
    let shards = count(&folder, "t.shards");
    assert!(shards >= 6);
    let states = ["TIMEOUT", "OUT_OF_MEMORY", "NODE_FAIL", "CANCELLED", "FAILED"];
    let tasks = |states: &[&str]| -> String {
        states.iter().enumerate().map(|(task, state)| format!("{task}|{state}\n")).collect()
    };
    folder.file("tasks", tasks(&["TIMEOUT", "PENDING", "RUNNING"]));
    (5..shards).for_each(|number| run_shard(&folder, "t.shards", number));
    let status = run(&folder, "sweep status t.shards").success();
    assert!(status.contains("1 running, 1 waiting, 3 missing"), "{status}");
    let error = run(&folder, "sweep collect t.shards").failed();
    assert!(error.contains("under way"), "{error}");

    folder.file("tasks", tasks(&states));
    let error = run(&folder, "sweep collect t.shards").failed();
    assert!(error.contains("the same sweep command runs them again"), "{error}");
    let reasons = errors(&folder, "t.csv");
    assert_eq!(reasons.len(), 96);
    for reason in [
        "its shard took longer than the time that it had",
        "its shard took more memory than it had",
        "the node of its shard was lost",
        "its shard was cancelled",
        "its shard ended before it was done",
    ] {
        assert!(reasons.iter().any(|error| error == reason), "{reason}: {reasons:?}");
    }
    // Slurm forgets its jobs, but not what it wrote to their logs.
    std::fs::remove_file(folder.path("tasks")).unwrap();
    folder.file(
        "t.shards/logs/1.log",
        "slurmstepd: error: *** JOB 7 ON n1 CANCELLED AT 2026-01-01T00:00:00 DUE TO TIME LIMIT ***\n",
    );
    folder.file("t.shards/logs/2.log", "slurmstepd: error: Detected 1 oom-kill event(s) in StepId=7.batch.\n");
    let status = run(&folder, "sweep status t.shards").success();
    for reason in ["1 missing: its shard took longer", "1 missing: its shard took more memory"] {
        assert!(status.contains(reason), "{status}");
    }

    // The next call runs what is missing and what failed, and nothing else.
    let told = run(&folder, "sweep s.ron -o t.csv --engine slurm --shards 3 --detach").success();
    assert!(told.contains("shards under way"), "{told}");
    let planned: usize = (0..count(&folder, "t.shards"))
        .map(|number| folder.read(&format!("t.shards/parts/{number}.json")).matches('[').count() - 1)
        .sum();
    assert_eq!(planned, reasons.iter().filter(|error| !error.is_empty()).count());
    (0..count(&folder, "t.shards")).for_each(|number| run_shard(&folder, "t.shards", number));
    run(&folder, "sweep collect t.shards").success();
    same(&folder, "local.csv", "t.csv");
    same(&folder, "local.parquet", "t.parquet");
}

/// What a lost process still writes later belongs to no point of this sweep.
#[test]
fn results_of_others_have_no_place() {
    let folder = cluster();
    folder.file("small.ron", r#"(scene: "room", size: 4, fifo_words: [8, 16])"#);
    run(&folder, "sweep small.ron -o local.csv").success();
    run(&folder, "sweep small.ron -o t.csv --engine slurm --shards 2 --detach").success();
    run_shard(&folder, "t.shards", 0);
    let other = folder.read("t.shards/results/0.json").replace("\"results\":{\"", "\"results\":{\"0");
    folder.file("t.shards/results/1.json", other);
    let error = run(&folder, "sweep collect t.shards").failed();
    assert!(error.contains("1 of 2 points missing"), "{error}");
    run_shard(&folder, "t.shards", 1);
    run(&folder, "sweep collect t.shards").success();
    same(&folder, "local.csv", "t.csv");
}

#[test]
fn what_is_cancelled_goes_on() {
    let folder = cluster();
    run(&folder, "sweep s.ron -o local.csv --accept-failures").success();
    run(&folder, "sweep s.ron -o t.csv --engine slurm --shards 4 --detach").success();
    run_shard(&folder, "t.shards", 1);
    folder.file("tasks", "0|RUNNING\n1|COMPLETED\n2|PENDING\n");
    let error = run(&folder, "sweep small.ron -o t.csv --engine slurm").refused();
    assert!(error.contains("small.ron"), "{error}");
    folder.file("small.ron", r#"(scene: "room", size: 4, fifo_words: [8, 16])"#);
    let error = run(&folder, "sweep small.ron -o t.csv --engine slurm --force").refused();
    assert!(error.contains("is under way here"), "{error}");
    let told = run(&folder, "sweep cancel t.shards").success();
    assert!(told.contains("cancelled with 1 of "), "{told}");
    assert_eq!(folder.read("cancelled"), "7 7\n");
    assert_eq!(run(&folder, "sweep cancel t.shards").success(), "nothing is under way\n");
    run(&folder, "sweep collect t.shards").failed();
    let cancelled = errors(&folder, "t.csv").iter().filter(|error| *error == "its shard was cancelled").count();
    assert!((60..96).contains(&cancelled), "{cancelled}");
    run(&folder, "sweep s.ron -o t.csv --accept-failures").success();
    same(&folder, "local.csv", "t.csv");
}

#[test]
fn another_program_or_another_file_is_refused() {
    let folder = cluster();
    run(&folder, "sweep s.ron -o t.csv --engine slurm --shards 2 --detach").success();
    let plan = folder.read("t.shards/plan.json");
    let refused = |part: &str| {
        let error = run(&folder, "sweep shard t.shards 0").refused();
        assert!(error.contains(part), "{error}");
        let status = run(&folder, "sweep status t.shards").success();
        assert!(status.contains("1 missing: ") && status.contains(part), "{status}");
        assert!(!folder.path("t.shards/results/0.json").exists());
    };
    let version = format!("\"version\":\"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(plan.contains(&version));
    folder.file("t.shards/plan.json", plan.replace(&version, "\"version\":\"0.0.9\""));
    refused("the shards were planned by pcs-sim 0.0.9");
    let error = run(&folder, "sweep collect t.shards").refused();
    assert!(error.contains("all machines must run the same program"), "{error}");
    folder.file("t.shards/plan.json", &plan);
    // A file behind the scene's.
    folder.file("m.mtl", "newmtl red\nKd 0 1 0\n");
    refused("is not what it was when the shards were planned");
    std::fs::remove_file(folder.path("m.mtl")).unwrap();
    refused("cannot read the file");
    folder.file("m.mtl", "newmtl red\nKd 1 0 0\n");
    folder.file("t.shards/plan.json", plan.replace("\"folder\":\"", "\"folder\":\"/nowhere"));
    refused("all machines must see the folder in which the shards were planned");
    // In its place again, it runs.
    folder.file("t.shards/plan.json", &plan);
    run_shard(&folder, "t.shards", 0);
    let status = run(&folder, "sweep status t.shards").success();
    assert!(status.contains("1 done, ") && !status.contains("cannot be entered"), "{status}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = cluster();
    let refusals = [
        ("sweep s.ron -o t.csv --shards 3", "--shards is for --engine slurm or --engine parallel"),
        ("sweep s.ron -o t.csv --engine local --detach", "--detach is for --engine slurm or --engine parallel"),
        ("sweep s.ron -o t.csv --engine parallel --slurm-time 5", "--slurm-time is for --engine slurm"),
        ("sweep s.ron -o t.csv --engine slurm --sshlogin n1", "--sshlogin is for --engine parallel"),
        ("sweep s.ron -o t.csv --engine slurm --sbatch-arg qos=low", "'qos=low' is no argument of sbatch"),
        ("sweep s.ron -o t.csv --engine slurm --sbatch-file none", "cannot read the file"),
        ("sweep s.ron -o t.csv --engine pigeons", "invalid value 'pigeons'"),
        ("sweep s.ron -o t.csv --recording-memory much", "expected a number of bytes with its unit"),
        ("sweep status none", "is no folder of shards"),
        ("sweep collect .", "is no folder of shards"),
        ("sweep", "SWEEP.ron"),
        ("image room -o i.png --engine slurm", "an image that is timed is one array, and stays on one machine"),
    ];
    for (args, expected) in refusals {
        let error = run(&folder, args).refused();
        assert!(error.contains(expected), "{args}: {error}");
        assert!(!folder.path("t.shards/plan.json").exists() && !folder.path("i.png").exists(), "{args}");
    }
    // A folder of that name that is of something else is left alone.
    std::fs::create_dir_all(folder.path("t.shards/logs")).unwrap();
    folder.file("t.shards/logs/mine", "");
    let error = run(&folder, "sweep s.ron -o t.csv --engine slurm").refused();
    assert!(error.contains("is no folder of shards"), "{error}");
    assert!(folder.path("t.shards/logs/mine").exists());
    std::fs::remove_dir_all(folder.path("t.shards")).unwrap();
    folder.file("refuse", "");
    let error = run(&folder, "sweep s.ron -o t.csv --engine slurm").refused();
    assert!(error.contains("sbatch did not take the job: sbatch: error: no such partition"), "{error}");
    let none = Command::new(env!("CARGO_BIN_EXE_pcs-sim"))
        .args(["sweep", "s.ron", "-o", "t.csv", "--engine", "slurm"])
        .current_dir(folder.path(""))
        .env("PATH", folder.path("nothing"))
        .output()
        .unwrap();
    assert_eq!(none.status.code(), Some(2));
    assert!(String::from_utf8(none.stderr).unwrap().contains("there is no sbatch here"));
}

/// The script is for people, and has their own lines behind ours.
#[test]
fn the_script_can_be_read() {
    let folder = cluster();
    folder.file("small.ron", r#"(scene: "room", size: 4, fifo_words: [8, 16, 32])"#);
    folder.file("lines", "#SBATCH --constraint=fast\nmodule load pcs-sim\n");
    let flags = "--slurm-account me --slurm-partition long --slurm-memory 4G --slurm-time 1:00:00 --sbatch-arg=--qos=low --sbatch-file lines";
    run(
        &folder,
        &format!("sweep small.ron -o t.csv --engine slurm --shards 3 --at-once 2 --threads 4 --detach {flags}"),
    )
    .success();
    let path = folder.path("").canonicalize().unwrap().display().to_string();
    let shown = |name: &str| {
        let text = folder.read(name).replace(&path, "FOLDER").replace(env!("CARGO_BIN_EXE_pcs-sim"), "pcs-sim");
        text.replace(env!("CARGO_PKG_VERSION"), "VERSION")
    };
    insta::assert_snapshot!("shards_script_of_slurm", shown("t.shards/run.sh"));
    insta::assert_snapshot!("shards_script_of_the_collector", shown("t.shards/collect.sh"));
    let submitted = folder.read("submitted");
    assert!(submitted.lines().nth(1).is_some_and(|line| line.contains("--dependency=afterany:7")), "{submitted}");
}

#[test]
fn an_image_in_shards_is_the_image() {
    let folder = cluster();
    let image = "image room --size 20x17 --samples 3 --adaptive --timing off";
    let local = run(&folder, &format!("{image} -o local.pfm")).success();
    run(&folder, &format!("{image} -o local.png")).success();
    for (name, shards) in [("a.pfm", 4), ("b.png", 1000)] {
        let told = run(&folder, &format!("{image} -o {name} --engine slurm --shards {shards} --detach")).success();
        let folder_of = format!("{}.shards", &name[..1]);
        assert_eq!(count(&folder, &folder_of), shards.min(17), "{told}");
        run_shard(&folder, &folder_of, 1);
        let error = run(&folder, &format!("sweep collect {folder_of}")).failed();
        assert!(error.contains("missing, which the same command makes"), "{error}");
        assert!(!folder.path(name).exists(), "no half of an image");
        (0..shards.min(17)).rev().for_each(|number| run_shard(&folder, &folder_of, number));
        let joined = match name {
            "a.pfm" => run(&folder, &format!("sweep collect {folder_of}")).success(),
            // The command that was called before finds all of it done.
            _ => run(&folder, &format!("{image} -o {name} --engine slurm")).success(),
        };
        assert!(joined.ends_with(&format!("{name}\n")), "{joined}");
        let wrote = format!("wrote {name}\n");
        assert!(name == "a.pfm" || joined.strip_suffix(&wrote) == local.strip_suffix("wrote local.pfm\n"), "{joined}");
        same(&folder, &format!("local.{}", &name[2..]), name);
    }
}

/// A recording that finds no room changes nothing but the summary.
#[test]
fn recordings_are_bounded() {
    let folder = cluster();
    folder.file(
        "small.ron",
        r#"(scene: "room", size: 12, mode: ["pipeline", "broadcast"], fifo_words: [8, 16, 32, 64, 128])"#,
    );
    let kept = run(&folder, "sweep small.ron -o kept.csv").success();
    let bounded = run(&folder, "sweep small.ron -o bounded.csv --recording-memory 1kB --threads 2").success();
    same(&folder, "kept.csv", "bounded.csv");
    assert!(kept.starts_with("10 points: 10 done\nwrote kept.csv\n"), "{kept}");
    let summary = "2 recordings larger than --recording-memory: 10 points timed while the rays were traced, 6 times\n";
    assert!(bounded.starts_with(&format!("10 points: 10 done\n{summary}wrote bounded.csv\n")), "{bounded}");
    run(&folder, "sweep small.ron -o t.csv --recording-memory 1kB --engine slurm --shards 2 --detach").success();
    (0..2).for_each(|number| run_shard(&folder, "t.shards", number));
    let joined = run(&folder, "sweep collect t.shards").success();
    assert!(joined.contains("2 recordings larger than --recording-memory: 10 points"), "{joined}");
    same(&folder, "kept.csv", "t.csv");
}
