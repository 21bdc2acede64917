//! Sweeps that are killed at random moments, again and again.

use std::collections::HashSet;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::command::Folder;
use parquet::file::reader::{FileReader, SerializedFileReader};

const SWEEP: &str = r#"(
    scene: "teapot",
    size: 24,
    mode: ["pipeline", "hybrid"],
    stop_words: [16, 64],
    fifo_words: (from: 4, to: 40, step: 4),
    link_mb_s: [80, 40, 20],
)"#;
const POINTS: usize = 120;
const KILLS: usize = 20;

/// Numbers that look random, the same each time.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

/// Some points fail, as their FIFOs are too shallow for their stop words: with the same words, whether alone or in company.
///
/// Killed whenever, a sweep ends with the table of one that was left alone, and no point is lost or done twice.
#[test]
fn a_killed_sweep_goes_on() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    folder.run("sweep sweep.ron -o whole.csv --accept-failures").success();
    let (mut chance, mut kills, mut partial) = (Chance(1989), 0, 0);
    while kills < KILLS {
        let points = entries(&folder) + chance.below(12) as usize;
        let mut child = start(&folder);
        let begun = Instant::now();
        while entries(&folder) < points && child.try_wait().unwrap().is_none() {
            assert!(begun.elapsed() < Duration::from_secs(60), "it goes on");
        }
        std::thread::sleep(Duration::from_micros(chance.below(20_000)));
        let _ = child.kill();
        if child.wait().unwrap().success() {
            check_end(&folder);
            for name in ["t.csv", "t.parquet", "t.sweep.ron", "t.journal"] {
                std::fs::remove_file(folder.path(name)).unwrap();
            }
        } else {
            kills += 1;
            partial += check_under_way(&folder) as usize;
        }
    }
    folder.run("sweep sweep.ron -o t.csv --accept-failures").success();
    check_end(&folder);
    assert!(partial > 0, "the table grew as points finished");
}

fn start(folder: &Folder) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pcs-sim"));
    command.args(["sweep", "sweep.ron", "-o", "t.csv", "--accept-failures"]).current_dir(folder.path("."));
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Whole lines of the journal behind its heading.
fn entries(folder: &Folder) -> usize {
    let journal = std::fs::read_to_string(folder.path("t.journal")).unwrap_or_default();
    journal.matches('\n').count().saturating_sub(1)
}

/// The files of a sweep that was killed. Returns whether its table had some rows, but not all.
fn check_under_way(folder: &Folder) -> bool {
    let whole = folder.read("whole.csv");
    let table = std::fs::read_to_string(folder.path("t.csv")).unwrap_or_default();
    let mut expected = whole.lines();
    assert!(table.lines().all(|row| expected.any(|other| other == row)), "rows are whole, and in order:\n{table}");
    if let Ok(file) = std::fs::File::open(folder.path("t.parquet")) {
        let rows = SerializedFileReader::new(file).unwrap().metadata().file_metadata().num_rows();
        assert!((1..=POINTS as i64).contains(&rows), "{rows}");
    }
    (2..=POINTS).contains(&table.lines().count())
}

fn check_end(folder: &Folder) {
    assert!(folder.read("t.csv") == folder.read("whole.csv"));
    let parquet = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(parquet("t.parquet") == parquet("whole.parquet"));
    let journal = folder.read("t.journal");
    let done = journal.lines().skip(1).map(|line| serde_json::from_str::<(String, Vec<String>)>(line).unwrap().0);
    let done: Vec<String> = done.collect();
    assert_eq!((done.len(), done.iter().collect::<HashSet<_>>().len()), (POINTS, POINTS), "each point once");
    assert!(!folder.names().iter().any(|name| name.ends_with(".part")), "{:?}", folder.names());
}

/// A sweep that was stopped does not go on with other files than it began with, be it one behind the scene's.
#[test]
fn a_stopped_sweep_is_of_the_files_that_it_began_with() {
    let folder = Folder::new();
    folder.file("scene.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    folder.file("m.mtl", "newmtl red\nKd 1 0 0\n");
    folder.file("sweep.ron", "(scene: \"scene.obj\", size: \"2x2\", fifo_words: [16, 32])");
    folder.run("sweep sweep.ron -o t.csv").success();
    // As if it had been stopped behind the first point.
    let journal: Vec<String> = folder.read("t.journal").lines().take(2).map(|line| format!("{line}\n")).collect();
    let stop = || folder.file("t.journal", journal.concat());
    stop();
    assert!(folder.run("sweep sweep.ron -o t.csv").success().contains("2 points: 2 done (1 now)"));
    stop();
    folder.file("m.mtl", "newmtl red\nKd 0 1 0\n");
    let error = folder.run("sweep sweep.ron -o t.csv").refused();
    assert!(error.contains("is the journal of another sweep, or the files of this one changed"), "{error}");
    // It goes on once the file is what it was, and not without it.
    std::fs::remove_file(folder.path("m.mtl")).unwrap();
    folder.run("sweep sweep.ron -o t.csv").refused();
    folder.file("m.mtl", "newmtl red\nKd 1 0 0\n");
    assert!(folder.run("sweep sweep.ron -o t.csv").success().contains("2 points: 2 done (1 now)"));
}
