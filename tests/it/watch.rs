//! `--watch`: what it looks at, what it shows on a terminal, and that it changes nothing.

use std::process::Command;

use crate::support::command::Folder;
use pcs_sim::machine::line::IDLE;
use pcs_sim::machine::{Array, Cycles};
use pcs_sim::measure::{SoFar, StateId};

/// What an array tells while it works only grows, and is in the end what its statistics are.
#[test]
fn what_is_known_so_far_grows_into_the_statistics() {
    let (scene, rays) = crate::support::scene("room", 1, 40);
    for (name, groups) in [("pipeline", 1), ("broadcast", 5), ("hybrid", 3)] {
        let workload = crate::support::workload(&scene.mesh, &crate::support::program(name, groups), &rays);
        let mut array = Array::new(&crate::support::machine().spec, workload.costs(), workload.cells());
        let mut before = SoFar::default();
        for batch in crate::support::ops(&workload, &rays) {
            array.feed(batch).unwrap();
            array.run().unwrap();
            let now = array.so_far();
            assert!(now.cycles > before.cycles && now.returned > before.returned);
            for (now, before) in now.stations.iter().zip(&before.stations) {
                assert!((0..16).map(StateId).all(|state| now.of(state) >= before.of(state)));
            }
            for ((now, until), (before, since)) in now.fifos.iter().zip(&before.fifos) {
                assert!(until >= since && now.word_cycles >= before.word_cycles && now.full >= before.full);
            }
            before = now;
        }
        let stats = array.finish().unwrap();
        assert_eq!((before.cycles, before.returned), (stats.cycles, rays.len() as u64));
        for (so_far, cell) in before.stations.iter().zip(&stats.stations) {
            assert_eq!(so_far.total() + cell.of(IDLE), stats.cycles);
            let mut all_but_idle = (0..IDLE.0).map(StateId);
            assert!(all_but_idle.all(|state| so_far.of(state) == cell.of(state)));
            assert_eq!(so_far.of(IDLE), Cycles(0));
        }
        let fifos = stats.topology.fifos.iter().zip(&stats.fifos);
        for ((so_far, until), (info, fifo)) in before.fifos.iter().zip(fifos) {
            assert!(*until <= stats.cycles);
            assert_eq!((so_far.words, so_far.max, so_far.word_cycles), (fifo.words, fifo.max, fifo.word_cycles));
            assert_eq!(so_far.empty + (stats.cycles - *until), fifo.empty, "{name} {}", info.name);
        }
    }
}

#[test]
fn on_a_pipe_there_is_nothing_to_watch() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: "room", size: 8, fifo_words: [4, 8])"#);
    for command in [
        "--scene room --size 64x64 --watch --ops a.ops",
        "replay a.ops --watch",
        "image room --size 32x32 -o a.png --watch",
        "image room --on ipsc2 --size 32x32 --watch",
        "sweep sweep.ron -o t.csv --watch",
    ] {
        let finished = folder.run(command);
        assert_eq!(finished.stderr, "", "{command}");
        finished.success();
    }
}

/// Runs a command on a terminal of 100 x 40 characters. `None` where there is no `script` to make one.
fn on_a_terminal(folder: &Folder, args: &str) -> Option<String> {
    let command = format!("stty cols 100 rows 40; {} {args}", env!("CARGO_BIN_EXE_pcs-sim"));
    let output = Command::new("script").args(["-qec", &command, "/dev/null"]).current_dir(folder.path(".")).output();
    let output = output.ok()?;
    assert!(output.status.success(), "{output:?}");
    Some(String::from_utf8(output.stdout).unwrap())
}

#[test]
fn on_a_terminal_the_array_is_seen_and_the_results_stay_the_same() {
    let folder = Folder::new();
    folder.run("--size 1024x1024 --stats piped.json").success();
    let Some(screen) = on_a_terminal(&folder, "--size 1024x1024 --watch --stats watched.json") else {
        eprintln!("skipped: there is no script(1) here");
        return;
    };
    for seen in ["cell 0 grid", "works", "FIFO X0", "of 512, full", "rays/s; below, its last", "wrote watched.json"] {
        assert!(screen.contains(seen), "{seen}: {screen:?}");
    }
    // Neither another screen nor a hidden cursor that could outlive the command.
    assert!(!screen.contains("\x1b[?1049h"), "{screen:?}");
    assert_eq!(screen.matches("\x1b[?25l").count(), screen.matches("\x1b[?25h").count(), "{screen:?}");
    assert_eq!(folder.read("watched.json"), folder.read("piped.json"));
}

#[test]
fn on_a_terminal_the_nodes_of_a_hypercube_are_seen() {
    let folder = Folder::new();
    let run = "ipsc2 gears --nodes 8 --size 256x256 --flow unlimited";
    folder.run(&format!("{run} --stats piped.json")).success();
    let Some(screen) = on_a_terminal(&folder, &format!("{run} --watch --stats watched.json")) else { return };
    for seen in ["node 3 ", "host ", "queue 7 ", " rays, full", "legs/s; below, its last", "wrote watched.json"] {
        assert!(screen.contains(seen), "{seen}: {screen:?}");
    }
    assert_eq!(folder.read("watched.json"), folder.read("piped.json"));
}

#[test]
fn on_a_terminal_the_points_of_a_sweep_come_in() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: "teapot", size: 64, mode: ["pipeline", "broadcast"], fifo_words: [0, 4, 8])"#);
    let Some(screen) = on_a_terminal(&folder, "sweep sweep.ron -o t.csv --watch --accept-failures") else { return };
    assert!(screen.contains("mode pipeline, fifo_words 0: failed: impossible machine"), "{screen:?}");
    assert!(screen.contains("mode broadcast, fifo_words 8: ") && screen.contains(" rays/s"), "{screen:?}");
}
