//! Sweeps and comparisons: the table in both formats, points that fail alone, files that are kept.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::command::Folder;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

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
    assert_eq!(stdout, "12 points: 12 done\nwrote t.csv\nwrote t.parquet\nwrote t.sweep.ron\n");
    assert_eq!(folder.names(), ["sweep.ron", "t.csv", "t.journal", "t.parquet", "t.sweep.ron"]);
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

/// Rates that are as many cycles a word are timed once, and each point tells what it would by itself: of a recording, and while the rays
/// are traced.
#[test]
fn points_that_share_their_times_tell_their_own() {
    let folder = Folder::new();
    let sweep = |rates: &str| format!("(scene: \"room\", size: \"9x8\", fifo_words: [4, 64], link_mb_s: {rates})");
    folder.file("all.ron", sweep("[80, 75, 60, 27]"));
    folder.run("sweep all.ron --table all.csv").success();
    folder.run("sweep all.ron --table step.csv --recording-memory 1kB").success();
    let all = rows(&folder.read("all.csv"));
    assert_eq!(rows(&folder.read("step.csv")), all);
    let cycles = column(&all, "cycles");
    assert_eq!((&cycles[1], &cycles[5]), (&cycles[2], &cycles[6]), "75 and 60 are two cycles a word");
    for (place, rate) in ["80", "75", "60", "27"].into_iter().enumerate() {
        folder.file("one.ron", sweep(rate));
        folder.run("sweep one.ron --table one.csv --force").success();
        assert_eq!(rows(&folder.read("one.csv"))[1..], [all[1 + place].clone(), all[5 + place].clone()], "{rate}");
    }
}

/// What a machine lacks is its own point's affair, whichever machine comes first.
#[test]
fn machines_that_cannot_run_programs_fail_alone() {
    let folder = Folder::new();
    let text = std::fs::read_to_string("pcs-programs/pcs.ron").unwrap();
    let without = format!("{})\n", &text[..text.find("    instruction_cycles").unwrap()]);
    folder.file("costs.ron", &text);
    folder.file("plain.ron", without);
    for (order, runs) in [(r#""costs.ron", "plain.ron""#, 0), (r#""plain.ron", "costs.ron""#, 1)] {
        let sweep = r#"scene: "tetra", size_factor: 2, size: 4, cells_run: "programs", machine:"#;
        folder.file("sweep.ron", format!("({sweep} [{order}])"));
        folder.run("sweep sweep.ron -o t.csv --force --accept-failures").success();
        let rows = rows(&folder.read("t.csv"));
        let (errors, cycles) = (column(&rows, "error"), column(&rows, "cycles"));
        assert_eq!((errors[runs].as_str(), cycles[1 - runs].as_str()), ("", ""), "{rows:?}");
        assert!(errors[1 - runs].starts_with("the machine file does not say what instructions cost"), "{rows:?}");
        assert!(cycles[runs].parse::<u64>().unwrap() > 0);
    }
}

/// A parameter that only images have makes a point an image.
#[test]
fn a_point_of_an_image_is_what_the_command_makes() {
    let folder = Folder::new();
    let sweep = r#"(scene: "balls", size_factor: 1, size: "10x8", mode: ["pipeline", "broadcast"], fifo_words: [8, 32],
        host_hit_us: [0, 2000], samples: 2, policy: ["secondaries", "primaries"])"#;
    folder.file("sweep.ron", sweep);
    folder.run("sweep sweep.ron --table t.csv").success();
    let rows = rows(&folder.read("t.csv"));
    assert_eq!(rows.len(), 1 + 16);
    let cell = |name: &str, row: usize| column(&rows, name)[row].clone();
    for row in 0..16 {
        let names = ["scene", "size_factor", "size", "mode", "fifo_words", "host_hit_us", "samples", "policy"];
        let flags = names[1..].iter().map(|name| format!(" --{} {}", name.replace('_', "-"), cell(name, row)));
        let flags = flags.collect::<String>();
        folder.run(&format!("image balls -o i.png --stats s.json --force{flags}")).success();
        let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        assert_eq!(cell("error", row), "");
        assert_eq!(stats["cycles"].to_string(), cell("cycles", row), "{flags}");
        for name in ["hits", "voxels", "slab_tests", "intersection_tests"] {
            assert_eq!(stats["counts"][name].to_string(), cell(name, row), "{flags}: {name}");
        }
    }
    let mut cycles = column(&rows, "cycles");
    cycles.sort();
    cycles.dedup();
    assert_eq!(cycles.len(), 16, "machines, hosts and policies take different times");
}

#[test]
fn images_and_primary_rays_stand_in_one_table() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: "room", size: 6, image: [true, false])"#);
    folder.run("sweep sweep.ron --table t.csv").success();
    let rows = rows(&folder.read("t.csv"));
    assert_eq!(column(&rows, "image"), ["true", "false"]);
    let rays: Vec<u32> = column(&rows, "ray_count").iter().map(|count| count.parse().unwrap()).collect();
    assert!(rays[0] > rays[1] && rays[1] == 36, "{rays:?}");
    assert_eq!(in_parquet(&folder, "t.parquet"), rows);
    folder.file("none.ron", r#"(scene: "room", size: 6, image: false, depth: 2)"#);
    folder.file("off.ron", r#"(scene: "room", size: 6, timing: "off")"#);
    for (name, reason) in [("none", "depth is for images, and image is false"), ("off", "timing is off")] {
        folder.run(&format!("sweep {name}.ron --table {name}.csv")).failed();
        let table = folder.read(&format!("{name}.csv"));
        assert!(table.contains(reason), "{table}");
    }
}

#[test]
fn a_point_accounts_for_all_of_its_cells_time_and_words() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: "room", size: "12x10", program: ["pipeline", "broadcast", "hybrid"])"#);
    folder.run("sweep sweep.ron --table t.csv").success();
    let rows = rows(&folder.read("t.csv"));
    let number = |row: usize, name: &str| column(&rows, name)[row].parse::<f64>().unwrap();
    assert_all_time_is_there(&rows);
    // A ray of 8 words and a hit of 5 go through every link of a broadcast.
    assert_eq!(number(1, "busiest_link_words"), 13.0 * 120.0);
    assert!(number(0, "busiest_link_words") > 13.0 * 120.0, "a pipeline's links carry candidates, too");
    assert_eq!(number(0, "placed_polygons"), number(0, "polygons"));
    assert!(number(1, "placed_polygons") > number(1, "polygons"), "polygons on cuts are in both parts");
}

#[test]
fn a_point_with_stop_words_does_so_too() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: "room", size: "12x10", program: ["pipeline", "hybrid"], stop_words: [1, 4])"#);
    folder.run("sweep sweep.ron --table t.csv").success();
    assert_all_time_is_there(&rows(&folder.read("t.csv")));
}

/// The states of all cells add up to the cells' time.
fn assert_all_time_is_there(rows: &[Vec<String>]) {
    assert!(rows.len() > 1);
    for row in 0..rows.len() - 1 {
        let number = |name: &str| column(rows, name)[row].parse::<f64>().unwrap();
        let states = ["grid", "slabs", "intersection", "moving", "waiting", "blocked", "idle"];
        let spent: f64 = states.iter().map(|state| number(&format!("{state}_us"))).sum();
        let all = number("array_cells") * number("us_per_ray");
        assert!((spent - all).abs() < 0.01, "{spent} of {all} us");
        let us = 1e6 * number("seconds") / number("ray_count");
        assert!((us - number("us_per_ray")).abs() < 1e-4);
    }
}

#[test]
fn points_fail_alone_with_their_reason() {
    let folder = Folder::new();
    folder.file(
        "sweep.ron",
        r#"(scene: ["room", "atlantis"], size: 4, fifo_words: [0, 4], mode: ["pipeline", "sideways"])"#,
    );
    let failed = folder.run("sweep sweep.ron --table t.csv").failed();
    assert!(failed.contains("error: 7 of 8 points failed: the column `error` says why"), "{failed}");
    let told = folder.run("sweep sweep.ron --table t.csv --accept-failures").success();
    insta::assert_snapshot!("failures are counted", told);
    let rows = rows(&folder.read("t.csv"));
    let errors = column(&rows, "error");
    assert!(errors[0].contains("fifo_words is 0"), "{errors:?}");
    assert_eq!(errors[1], "");
    assert!(errors[2].contains("invalid value 'sideways'"), "{errors:?}");
    assert!(errors[3..].iter().all(|error| !error.is_empty()), "{errors:?}");
    assert!(errors[5].contains("atlantis"), "{errors:?}");
    assert_eq!(column(&rows, "ray_count"), ["", "16", "", "", "", "", "", ""]);
    assert_eq!(in_parquet(&folder, "t.parquet"), rows);
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
    folder.file("range.ron", "(fifo_words: (from: 1, to: 1e9, step: 1))");
    let error = folder.run("sweep range.ron --table t.csv").refused();
    assert!(error.contains("the range has 1000000000 values, and a parameter may have up to 1000000"), "{error}");
    folder.file("range.ron", "(fifo_words: (from: 1, to: 9999, step: 1), clock_ns: (from: 1, to: 2, step: 0.001))");
    let error = folder.run("sweep range.ron --table t.csv").refused();
    assert!(error.contains("has 10008999 points, and may have up to 1000000"), "{error}");
    folder.file("kind.ron", "(\n    fifo_words: [1, \"many\"],\n)");
    let error = folder.run("sweep kind.ron --table t.csv").refused();
    assert!(error.contains("expected a whole number") && error.contains("kind.ron:2:"), "{error}");
    folder.file("half.ron", "(cells: (from: 1, to: 3, step: 0.5))");
    let error = folder.run("sweep half.ron --table t.csv").refused();
    assert!(error.contains("1.5") && error.contains("expected a whole number"), "{error}");
    folder.file("sweep.ron", SWEEP);
    let error = folder.run("sweep sweep.ron --table t.xls").refused();
    assert!(error.contains("must end in .csv or .parquet"), "{error}");
    assert_eq!(folder.names(), ["half.ron", "kind.ron", "range.ron", "sweep.ron", "unknown.ron"]);
}

#[test]
fn parquet_and_csv_have_the_same_cells() {
    let folder = Folder::new();
    let sweep = r#"(scene: "room", size: ["6x4", "4x6"], mailbox: [true, false], grid_coefficient: [0.5, 50],
                    fifo_words: (from: 2, to: 8, step: 6), link_mb_s: [80, 0.1, 13.5])"#;
    folder.file("sweep.ron", sweep);
    folder.run("sweep sweep.ron -o t.parquet").success();
    let rows = rows(&folder.read("t.csv"));
    assert_eq!(rows.len(), 49);
    assert_eq!(in_parquet(&folder, "t.parquet"), rows);
    let file = SerializedFileReader::new(std::fs::File::open(folder.path("t.parquet")).unwrap()).unwrap();
    let schema = file.metadata().file_metadata().schema();
    let kind = |name: &str| {
        let field = schema.get_fields().iter().find(|field| field.name() == name).unwrap();
        format!("{} {:?}", field.get_physical_type(), field.get_basic_info().logical_type_ref())
    };
    assert_eq!(kind("mailbox"), "BOOLEAN None");
    assert_eq!(kind("fifo_words"), "INT64 None");
    assert_eq!(kind("link_mb_s"), "DOUBLE None");
    assert_eq!(kind("size"), "BYTE_ARRAY Some(String)");
}

/// All cells of a Parquet file as CSV would have them, the heading first.
fn in_parquet(folder: &Folder, name: &str) -> Vec<Vec<String>> {
    let file = SerializedFileReader::new(std::fs::File::open(folder.path(name)).unwrap()).unwrap();
    let fields = file.metadata().file_metadata().schema().get_fields();
    let mut rows: Vec<Vec<String>> = vec![fields.iter().map(|field| field.name().to_owned()).collect()];
    let cell = |field: &Field| match field {
        Field::Null => String::new(),
        Field::Bool(value) => value.to_string(),
        Field::Long(value) => value.to_string(),
        Field::Double(value) => value.to_string(),
        Field::Str(value) => value.clone(),
        other => panic!("no column holds {other:?}"),
    };
    let cells = |row: parquet::record::Row| row.get_column_iter().map(|(_, field)| cell(field)).collect();
    rows.extend(file.get_row_iter(None).unwrap().map(|row| cells(row.unwrap())));
    rows
}

#[test]
fn a_finished_sweep_is_not_run_again() {
    let folder = Folder::new();
    folder.file("room.obj", OBJ);
    folder.file("sweep.ron", r#"(scene: "room.obj", size: 8, fifo_words: [4, 8])"#);
    folder.run("sweep sweep.ron -o t.csv").success();
    let before = folder.read("t.csv");
    let again = folder.run("sweep sweep.ron -o t.csv").success();
    assert!(again.starts_with("2 points: 2 done (0 now)\n"), "{again}");
    assert_eq!(folder.read("t.csv"), before);
    // The scene is part of the sweep: another one needs another table.
    folder.file("room.obj", OBJ.replace("v 0 1 0", "v 0 2 0"));
    let error = folder.run("sweep sweep.ron -o t.csv").refused();
    assert!(error.contains("journal of another sweep, or the files of this one changed"), "{error}");
    assert_eq!(folder.read("t.csv"), before);
    folder.run("sweep sweep.ron -o t.csv --force").success();
    assert_ne!(folder.read("t.csv"), before);
}

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 3 4\nf 1 3 4\n";

/// A sweep that gets more values runs the new points, and its table is in the order of the new file.
#[test]
fn only_new_points_are_run() {
    let folder = Folder::new();
    let sweep = |depths: &str| folder.file("sweep.ron", format!(r#"(scene: "room", size: 6, fifo_words: {depths})"#));
    sweep("[8, 32]");
    folder.run("sweep sweep.ron -o t.csv").success();
    sweep("[4, 32, 16, 8]");
    let told = folder.run("sweep sweep.ron -o t.csv").success();
    assert!(told.starts_with("4 points: 4 done (2 now)\n"), "{told}");
    folder.run("sweep sweep.ron -o whole.csv").success();
    assert_eq!(folder.read("t.csv"), folder.read("whole.csv"));
    assert_eq!(column(&rows(&folder.read("t.csv")), "fifo_words"), ["4", "32", "16", "8"]);
    // Fewer points: the others would be lost.
    sweep("[8, 16]");
    let error = folder.run("sweep sweep.ron -o t.csv").refused();
    assert!(error.contains("2 of its points are not among these"), "{error}");
    let told = folder.run("sweep sweep.ron -o t.csv --force").success();
    assert!(told.starts_with("2 points: 2 done (0 now)\n"), "what it shares with the other is kept: {told}");
    assert_eq!(rows(&folder.read("t.csv")).len(), 3);
}

#[test]
fn points_are_counted_and_run_on_some_threads() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    assert_eq!(folder.run("sweep sweep.ron --count").success(), "12 points\n");
    assert_eq!(folder.names(), ["sweep.ron"]);
    for threads in [1, 3] {
        folder.run(&format!("sweep sweep.ron --threads {threads} -o t{threads}.csv")).success();
    }
    assert_eq!(folder.read("t1.csv"), folder.read("t3.csv"));
    let error = folder.run("sweep sweep.ron").refused();
    assert!(error.contains("--table <FILE>"), "{error}");
    let error = folder.run("sweep sweep.ron --count -o t.csv").refused();
    assert!(error.contains("cannot be used with"), "{error}");
}

/// What was rounded is told once, and stands in the table.
#[test]
fn what_was_rounded_is_told() {
    let folder = Folder::new();
    let sweep = r#"(scene: "room", size: 6, mode: ["pipeline", "broadcast"], link_mb_s: [80, 30, 160], grid_voxel: [7.8, 7.81])"#;
    folder.file("sweep.ron", sweep);
    let told = folder.run("sweep sweep.ron -o t.csv").stderr;
    insta::assert_snapshot!("roundings", told);
    let rows = rows(&folder.read("t.csv"));
    assert_eq!(column(&rows, "link_cycles_per_word")[..6], ["1", "1", "3", "3", "1", "1"]);
    assert_eq!(column(&rows, "grid_voxel_cycles")[..2], ["156", "157"]);
    assert!(!rows[0].iter().any(|name| name == "grid_start_cycles"), "not asked");
    assert_eq!(in_parquet(&folder, "t.parquet"), rows);
    let all = r#"(scene: "room", size: 6, clock_ns: [50, 300, 301, 302])"#;
    folder.file("all.ron", all);
    let told = folder.run("sweep all.ron -o all.csv").stderr;
    insta::assert_snapshot!("many roundings", told);
}

/// A table says where it comes from, and the sweep can be run again.
#[test]
fn a_table_has_its_sweep() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    folder.run("sweep sweep.ron --table t.csv").success();
    let file = SerializedFileReader::new(std::fs::File::open(folder.path("t.parquet")).unwrap()).unwrap();
    let pairs = file.metadata().file_metadata().key_value_metadata().unwrap();
    let told = |key: &str| pairs.iter().find(|pair| pair.key == key).unwrap().value.clone().unwrap();
    assert_eq!(told("pcs_sim.version"), env!("CARGO_PKG_VERSION"));
    folder.file("again.ron", told("pcs_sim.sweep"));
    let again = folder.run("sweep again.ron --table t.csv").success();
    assert!(again.starts_with("12 points: 12 done (0 now)"), "{again}");
    insta::assert_snapshot!("the sweep of a table", told("pcs_sim.sweep"));
}

#[test]
fn files_of_others_are_kept_unless_asked() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    for name in ["t.csv", "t.parquet"] {
        folder.file(name, "precious");
        let error = folder.run("sweep sweep.ron --table t.csv").refused();
        assert!(error.contains("exists already") && error.contains(name), "{error}");
        assert_eq!(folder.names(), ["sweep.ron", name]);
        assert_eq!(folder.read(name), "precious");
        std::fs::remove_file(folder.path(name)).unwrap();
    }
    for (journal, complaint) in
        [("\"another\"\n", "journal of another sweep"), ("my thoughts\n", "is no journal: line 1")]
    {
        folder.file("t.journal", journal);
        let error = folder.run("sweep sweep.ron --table t.csv").refused();
        assert!(error.contains(complaint), "{error}");
        assert_eq!(folder.read("t.journal"), journal);
    }
    folder.run("sweep sweep.ron --table t.csv --force").success();
    assert_eq!(rows(&folder.read("t.csv")).len(), 13);
}

/// A sweep that reads its scene from a named pipe waits there, with its journal open.
#[cfg(unix)]
struct Waiting(std::process::Child);

#[cfg(unix)]
impl Waiting {
    fn start(folder: &Folder) -> Waiting {
        assert!(Command::new("mkfifo").arg(folder.path("pipe.obj")).status().unwrap().success());
        let sweep = r#"(scene: "pipe.obj", size: 8, mode: ["pipeline", "broadcast"], cells: [3], fifo_words: [4, 8],
                        grid_voxel: [7.8, 10])"#;
        folder.file("sweep.ron", sweep);
        let mut command = Command::new(env!("CARGO_BIN_EXE_pcs-sim"));
        command.args(["sweep", "sweep.ron", "-o", "t.csv"]).current_dir(folder.path(".")).stdout(Stdio::null());
        let child = command.spawn().unwrap();
        let start = Instant::now();
        while std::fs::metadata(folder.path("t.journal")).map_or(0, |journal| journal.len()) == 0 {
            assert!(start.elapsed() < Duration::from_secs(30), "it starts");
            std::thread::sleep(Duration::from_millis(2));
        }
        Waiting(child)
    }
}

#[cfg(unix)]
impl Drop for Waiting {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(unix)]
#[test]
fn a_second_process_is_told_that_there_is_a_first() {
    let folder = Folder::new();
    let first = Waiting::start(&folder);
    for flags in ["", "--force"] {
        let error = folder.run(&format!("sweep sweep.ron -o t.csv {flags}")).refused();
        assert!(error.contains("another process is running this sweep") && error.contains("t.journal"), "{error}");
    }
    drop(first);
    folder.file("other.ron", SWEEP);
    folder.run("sweep other.ron -o t.csv --force").success();
}

/// What goes into a pipe can be read once; a second reader would wait for ever.
#[cfg(unix)]
#[test]
fn a_scene_is_read_once() {
    let folder = Folder::new();
    let mut sweep = Waiting::start(&folder);
    std::fs::write(folder.path("pipe.obj"), OBJ).unwrap();
    let start = Instant::now();
    while sweep.0.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(30), "it waits for its scene again");
        std::thread::sleep(Duration::from_millis(2));
    }
    let rows = rows(&folder.read("t.csv"));
    assert_eq!(column(&rows, "error"), [""; 8]);
}

/// A table in CSV has the version and the sweep beside it, which makes the same table again.
#[test]
fn a_table_tells_what_it_is_of() {
    let folder = Folder::new();
    folder.file("s.ron", "(scene: \"room\", size: 4, fifo_words: [4, 8], grid_voxel: (from: 5, to: 10, step: 5))");
    folder.run("sweep s.ron -o t.csv").success();
    let told = folder.read("t.sweep.ron");
    assert!(told.starts_with(&format!("// Made by pcs-sim {}", env!("CARGO_PKG_VERSION"))), "{told}");
    folder.run("sweep t.sweep.ron -o again.csv").success();
    assert_eq!(folder.read("again.csv"), folder.read("t.csv"));
    let error = folder.run("sweep t.sweep.ron -o t.csv --force").refused();
    assert!(error.contains("is an input"), "{error}");
}

/// What was changed in a scene when it was read is told once, with the scene and in how many points.
#[test]
fn notes_of_scenes_are_told() {
    let folder = Folder::new();
    folder.file("bent.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3 4\n");
    folder.file("s.ron", "(scene: [\"bent.obj\", \"room\"], size: 4, fifo_words: [4, 8, 16])");
    let run = folder.run("--scene bent.obj --size 4x4");
    let note = run.stderr.lines().find(|line| line.contains("face")).unwrap().trim_start_matches("note: ").to_owned();
    let sweep = folder.run("sweep s.ron -o t.csv");
    assert_eq!(sweep.stderr.matches(&note).count(), 1, "{}", sweep.stderr);
    assert!(sweep.stderr.contains(&format!("note: bent.obj: {note} (in 3 points)")), "{}", sweep.stderr);
}

/// What failed is tried again, also when a file has come that was missing; what is done is not, and is kept.
#[test]
fn points_that_failed_are_tried_again() {
    let folder = Folder::new();
    folder.file("one.ron", r#"(scene: ["room", "late.obj"], size: 4, fifo_words: [4, 8])"#);
    let told = folder.run("sweep one.ron -o t.csv --accept-failures").success();
    assert!(told.starts_with("4 points: 2 done, 2 failed\n"), "{told}");
    folder.file("late.obj", OBJ);
    let told = folder.run("sweep one.ron -o t.csv").success();
    assert!(told.starts_with("4 points: 4 done (2 now)\n"), "{told}");
    folder.run("sweep one.ron -o whole.csv").success();
    assert_eq!(folder.read("t.csv"), folder.read("whole.csv"));
    // The file is now one of points that are done.
    folder.file("late.obj", OBJ.replace("v 0 1 0", "v 0 2 0"));
    let error = folder.run("sweep one.ron -o t.csv").refused();
    assert!(error.contains("2 of its points are not among these"), "{error}");
    // A table is another sweep's even where all of its points failed.
    folder.file("failing.ron", r#"(scene: "attic.obj", size: 4, fifo_words: [4, 8])"#);
    folder.run("sweep failing.ron -o f.csv").failed();
    let error = folder.run("sweep one.ron -o f.csv").refused();
    assert!(error.contains("2 of its points are not among these"), "{error}");
    // A program of the array, likewise.
    folder.file("programs.ron", r#"(scene: "room", size: 4, program: ["pipeline", "own.ron"])"#);
    folder.run("sweep programs.ron -o p.csv").failed();
    folder.file("own.ron", std::fs::read("pcs-programs/broadcast.ron").unwrap());
    let told = folder.run("sweep programs.ron -o p.csv").success();
    assert!(told.starts_with("2 points: 2 done (1 now)\n"), "{told}");
}

/// A picture that cannot be drawn takes nothing from the table.
#[test]
fn a_plot_that_cannot_be_drawn_is_told_behind_the_table() {
    let folder = Folder::new();
    folder.file(
        "sweep.ron",
        r#"(scene: "room", size: 2, mode: ["pipeline", "broadcast"], fifo_words: [4, 8], link_mb_s: [80, 40])"#,
    );
    let sweep = "sweep sweep.ron -o t.csv --plot-format svg --plot x=fifo_words y=cycles --plot x=fifo_words y=cycles by=mode link_mb_s=80";
    let ended = folder.run(sweep);
    let picture = "t-cycles-over-fifo_words-by-mode-link_mb_s-80.svg";
    assert!(ended.stdout.starts_with("8 points: 8 done\n") && ended.stdout.contains(&format!("wrote {picture}\n")));
    assert!(ended.stdout.contains("wrote t.csv\n"), "{}", ended.stdout);
    let error = ended.failed();
    assert!(error.contains("cycles-over-fifo_words: ") && error.contains("`pcs-sim plot` draws the table"), "{error}");
    assert!(!folder.names().contains(&"t-cycles-over-fifo_words.svg".to_owned()), "{:?}", folder.names());
}
