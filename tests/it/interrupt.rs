//! Ctrl-C, sent as a real signal at some point of every command: it ends at once, leaves no file that it did not finish,
//! and says how far it came.
#![cfg(unix)]

use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::support::command::Folder;

/// Starts a command in the folder, sends it a signal once `ready`, and gives what it says and leaves there.
fn interrupted(folder: &Folder, args: &str, ready: impl Fn(&Folder) -> bool) -> (String, Vec<String>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pcs-sim"));
    command.args(args.split_whitespace()).current_dir(folder.path("")).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child: Child = command.spawn().unwrap();
    while !ready(folder) {
        assert!(child.try_wait().unwrap().is_none(), "`{args}` has ended by itself");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{told}");
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "");
    (told, folder.names())
}

/// Result files are opened under hidden names before anything takes time.
fn opened(folder: &Folder) -> bool {
    folder.names().iter().any(|name| name.ends_with(".part"))
}

/// Whether some result has grown: tracing is under way.
fn growing(folder: &Folder) -> bool {
    let length = |name: &String| folder.path(name).metadata().map_or(0, |file| file.len());
    folder.names().iter().any(|name| name.ends_with(".part") && length(name) > 0)
}

fn nothing() -> Vec<String> {
    Vec::new()
}

/// A pipe that nobody writes to: who reads it waits for ever.
fn silent_pipe(folder: &Folder, name: &str) {
    assert!(Command::new("mkfifo").arg(folder.path(name)).status().unwrap().success());
}

#[test]
fn a_run_that_traces() {
    let folder = Folder::new();
    let run = "--scene teapot --size 2000x2000 --ops a.ops --stats s.json --hits h.csv --image i.png --plot new/plots";
    let (told, left) = interrupted(&folder, run, growing);
    assert!(told.starts_with("stopped after "), "{told}");
    assert!(told.ends_with(" of 4 000 000 rays; nothing was written\n"), "{told}");
    assert_eq!(left, nothing());
}

#[test]
fn an_image_that_grows() {
    let folder = Folder::new();
    let image = "image teapot --size 2000x2000 --samples 8 -o i.png --ops a.ops --stats s.json";
    let (told, left) = interrupted(&folder, image, growing);
    assert!(told.starts_with("stopped after "), "{told}");
    assert!(told.ends_with(" of 256 000 000 samples; nothing was written\n"), "{told}");
    assert_eq!(left, nothing());
}

/// The files are opened an instant before the scene is, and nothing outside shows that instant's end.
fn preparing(folder: &Folder) -> bool {
    let opened = opened(folder);
    std::thread::sleep(Duration::from_millis(if opened { 300 } else { 0 }));
    opened
}

#[test]
fn a_scene_that_is_read() {
    for command in ["--scene slow.obj --stats s.json", "image slow.obj -o i.png --stats s.json"] {
        let folder = Folder::new();
        silent_pipe(&folder, "slow.obj");
        let (told, left) = interrupted(&folder, command, preparing);
        assert_eq!(told, "stopped while preparing the scene; nothing was written\n");
        assert_eq!(left, ["slow.obj"]);
    }
}

#[test]
fn a_scene_that_is_laid_out() {
    let folder = Folder::new();
    let run = "--scene reference --size-factor 2000 --mode broadcast --cells 64 --partition work --stats s.json";
    let (told, left) = interrupted(&folder, run, preparing);
    assert_eq!(told, "stopped while preparing the scene; nothing was written\n");
    assert_eq!(left, nothing());
}

#[test]
fn a_replay() {
    let folder = Folder::new();
    silent_pipe(&folder, "slow.ops");
    let (told, left) = interrupted(&folder, "replay slow.ops --stats s.json --page p.html", preparing);
    assert_eq!(told, "stopped while reading the trace; nothing was written\n");
    assert_eq!(left, ["slow.ops"]);
}

/// A sweep keeps what is done, as it says, and goes on there when it is called again.
#[test]
fn a_sweep() {
    let folder = Folder::new();
    let file = |last: u32| {
        format!("(scene: \"teapot\", size: \"64x64\", fifo_words: (from: 4, to: {last}, step: 1), link_mb_s: [80, 40])")
    };
    folder.file("sweep.ron", file(3000));
    let lines = |folder: &Folder| std::fs::read_to_string(folder.path("t.journal")).map_or(0, |j| j.lines().count());
    let under_way = |folder: &Folder| lines(folder) > 2 && folder.path("t.parquet").exists();
    let (told, left) = interrupted(&folder, "sweep sweep.ron --table t.csv", under_way);
    assert!(told.starts_with("stopped after "), "{told}");
    assert!(told.ends_with(" of 5 994 points; the same command goes on from there\n"), "{told}");
    assert_eq!(left, ["sweep.ron", "t.csv", "t.journal", "t.parquet", "t.sweep.ron"]);
}
