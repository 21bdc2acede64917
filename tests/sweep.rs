//! Sweeps and comparisons: the table, points that fail alone, and sweeps that are killed.

mod support;

use std::process::{Command, Stdio};
use std::time::Duration;

use support::command::Folder;

const SWEEP: &str = r#"(
    scene: "room",
    size: "12x10",
    mode: ["pipeline", "broadcast"],
    fifo_words: (from: 2, to: 32, times: 4),
    link_mb_s: [80.0, 13],
)"#;

/// The rows of a table, the heading first.
fn rows(table: &str) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(table.as_bytes());
    reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect()
}

fn column(rows: &[Vec<String>], name: &str) -> Vec<String> {
    let index = rows[0].iter().position(|heading| heading == name).unwrap();
    rows[1..].iter().map(|row| row[index].clone()).collect()
}

#[test]
fn a_point_is_what_a_run_with_its_flags_is() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    let stdout = folder.run("sweep sweep.ron --table t.csv").success();
    assert_eq!(stdout, "12 points, 12 of them done now\nwrote t.csv\n");
    assert_eq!(folder.names(), ["sweep.ron", "t.csv"]);
    let rows = rows(&folder.read("t.csv"));
    assert_eq!(rows[0][..5], ["scene", "size", "mode", "fifo_words", "link_mb_s"]);
    assert_eq!(column(&rows, "fifo_words")[..6], ["2", "2", "8", "8", "32", "32"]);
    for (index, cycles) in column(&rows, "cycles").iter().enumerate() {
        let row = &rows[index + 1];
        let flags =
            format!("--scene room --size 12x10 --mode {} --fifo-words {} --link-mb-s {}", row[2], row[3], row[4]);
        folder.run(&format!("{flags} --stats s.json --force")).success();
        let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        assert_eq!(stats["cycles"].to_string(), *cycles, "{flags}");
        let rate = format!("\"rays_per_second\": {},", column(&rows, "rays_per_second")[index]);
        assert!(folder.read("s.json").contains(&rate), "{flags}: {rate}");
        assert_eq!(stats["counts"]["hits"].to_string(), column(&rows, "hits")[index]);
    }
}

#[test]
fn points_fail_alone_with_their_reason() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: ["room", "atlantis"], size: "4x4", fifo_words: [0, 4, "many"])"#);
    folder.run("sweep sweep.ron --table t.csv").success();
    let rows = rows(&folder.read("t.csv"));
    let errors = column(&rows, "error");
    assert!(errors[0].contains("fifo_words is 0"), "{errors:?}");
    assert_eq!(errors[1], "");
    assert!(errors[2].contains("invalid value 'many'"), "{errors:?}");
    assert!(errors[3..].iter().all(|error| !error.is_empty()), "{errors:?}");
    assert!(errors[4].contains("atlantis"), "{errors:?}");
    assert_eq!(column(&rows, "ray_count"), ["", "16", "", "", "", ""]);
}

#[test]
fn mistakes_in_the_file_are_told() {
    let folder = Folder::new();
    folder.file("unknown.ron", "(fifo_word: [1, 2])");
    let error = folder.run("sweep unknown.ron --table t.csv").refused();
    assert!(error.contains("fifo_word") && error.contains("unknown.ron:1"), "{error}");
    folder.file("range.ron", "(fifo_words: (from: 1, to: 9))");
    let error = folder.run("sweep range.ron --table t.csv").refused();
    assert!(error.contains("a step above 0 or times above 1"), "{error}");
    folder.file("sweep.ron", SWEEP);
    folder.file("t.csv", "precious");
    let error = folder.run("sweep sweep.ron --table t.csv").refused();
    assert!(error.contains("exists already"), "{error}");
    assert_eq!(folder.read("t.csv"), "precious");
}

/// Killed again and again at whatever moment, a sweep ends with the table of one that was left alone.
#[test]
fn a_killed_sweep_goes_on() {
    let folder = Folder::new();
    let sweep = r#"(scene: "teapot", size: "24x24", mode: ["pipeline", "broadcast", "hybrid"],
                    fifo_words: (from: 4, to: 40, step: 4), link_mb_s: [80, 40, 20])"#;
    folder.file("sweep.ron", sweep);
    folder.run("sweep sweep.ron --table whole.csv").success();
    let mut interrupted = 0;
    for kill in 0..20u64 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_pcs-sim"))
            .args(["sweep", "sweep.ron", "--table", "killed.csv"])
            .current_dir(folder.path("."))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(5 + kill * 37 % 60));
        let _ = child.kill();
        let status = child.wait().unwrap();
        if status.success() {
            break;
        }
        interrupted += 1;
    }
    assert!(interrupted > 0, "it was killed at least once");
    if !folder.path("killed.csv").exists() {
        folder.run("sweep sweep.ron --table killed.csv").success();
    }
    assert!(folder.read("killed.csv") == folder.read("whole.csv"));
    assert!(!folder.path("killed.csv.journal").exists());
    assert_eq!(folder.read("whole.csv").lines().count(), 91);
}

#[test]
fn a_journal_of_another_sweep_is_kept() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    folder.file("t.csv.journal", "\"another\"\n");
    let error = folder.run("sweep sweep.ron --table t.csv").refused();
    assert!(error.contains("journal of another sweep"), "{error}");
    assert_eq!(folder.read("t.csv.journal"), "\"another\"\n");
}

#[test]
fn two_runs_are_compared() {
    let folder = Folder::new();
    folder.run("--scene room --size 8x6 --stats a.json").success();
    folder.run("--scene room --size 8x6 --fifo-words 4 --stats b.json").success();
    let same = folder.run("compare a.json a.json").success();
    assert!(same.contains("values are the same"), "{same}");
    let text = folder.run("compare a.json b.json").success();
    let line = text.lines().find(|line| line.starts_with("configuration.machine.fifo_words")).unwrap();
    assert_eq!(line.split_whitespace().collect::<Vec<_>>()[1..], ["512", "4", "-508", "-99.22", "%"]);
    assert!(text.lines().any(|line| line.starts_with("cycles ")), "{text}");
    folder.file("c.json", "{}");
    let error = folder.run("compare a.json c.json").refused();
    assert!(error.contains("it has no cycles"), "{error}");
}
