//! `pcs-sim farm`, run as a user runs it.

use crate::support::command::Folder;
use serde_json::Value;

#[test]
fn a_farm_is_told_in_a_table_and_a_sentence() {
    let folder = Folder::new();
    insta::assert_snapshot!(folder.run("farm rectangles --size 40x30 --tasks 3").success());
}

#[test]
fn a_range_of_workers_is_compared() {
    let folder = Folder::new();
    insta::assert_snapshot!(folder.run("farm rectangles --size 40x30 --tasks 1..8 --scene-by broadcast").success());
}

#[test]
fn a_scene_of_polygons_is_counted_and_priced() {
    let folder = Folder::new();
    insta::assert_snapshot!(
        folder.run("farm room --size 24x16 --tasks 2 --items tiles --tile 4 --hand-out dealt").success()
    );
}

/// Statistics are one step from a run: their configuration makes the same bytes, on any number of threads.
#[test]
fn a_configuration_makes_the_farm_again() {
    let folder = Folder::new();
    let flags = "--size 20x16 --tasks 3 --items lines --message-ms 2 --samples 2 --grid-coefficient 20";
    folder.run(&format!("farm room {flags} --stats a.json --threads 1")).success();
    folder.run("farm --config a.json --stats b.json --threads 3").success();
    assert_eq!(folder.read("a.json"), folder.read("b.json"));
    let stats: Value = serde_json::from_str(&folder.read("a.json")).unwrap();
    assert_eq!(stats["tasks"][4]["name"], "CAP 3");
    for task in stats["tasks"].as_array().unwrap() {
        let busy: u64 = task["busy"].as_object().unwrap().values().map(|time| time.as_u64().unwrap()).sum();
        let rest = task.as_object().unwrap().values().filter_map(Value::as_u64).sum::<u64>();
        assert_eq!(Some(busy + rest), stats["cycles"].as_u64());
    }
    let changed = folder.run("farm --config a.json --tasks 2 --stats c.json").success();
    assert!(changed.starts_with("farm of 2 workers: scene room"), "{changed}");
    let told = folder.run("compare a.json c.json --all").stdout;
    assert!(told.contains("tasks.CAP 3.sending") && told.contains("speed_up"), "{told}");
}

#[test]
fn a_farm_has_all_views() {
    let folder = Folder::new();
    let farm = "farm rectangles --size 30x20 --tasks 3";
    let stdout = folder.run(&format!("{farm} --plot plots --page run.html --trace run.vcd")).success();
    for name in ["tasks", "segments", "latency"] {
        assert!(stdout.contains(&format!("wrote plots/{name}.svg\nwrote plots/{name}.png\n")), "{stdout}");
    }
    assert!(folder.read("plots/tasks.svg").contains("Maitre"));
    assert!(folder.read("plots/latency.svg").contains("How long segments take, from when a worker begins them"));
    let page = folder.read("run.html");
    for told in ["The farm", "CAP 3", "segments done", "tasks' time", "waiting master"] {
        assert!(page.contains(told), "{told}");
    }
    for told in ["{% if", "{{ ", "What the FIFOs held", "all cells", "The array"] {
        assert!(!page.contains(told), "{told}");
    }
    for (format, name) in [("vcd", "CAP_3"), ("pftrace", "Maitre"), ("fst", "farm")] {
        let flags = "--trace-window 1750000000..1900000000 --force";
        folder.run(&format!("{farm} --trace run.{format} {flags}")).success();
        let bytes = std::fs::read(folder.path(&format!("run.{format}"))).unwrap();
        let is_there = bytes.windows(name.len()).any(|window| window == name.as_bytes());
        assert!(is_there || format == "fst", "{name} in {format}");
        assert!(!bytes.windows(4).any(|window| window == b"host"), "{format} has no host");
    }
    let wave = wellen::simple::read(folder.path("run.fst")).unwrap();
    let scopes: Vec<&str> = wave.hierarchy().iter_scopes().map(|scope| scope.name(wave.hierarchy())).collect();
    assert!(scopes.contains(&"farm") && scopes.contains(&"CAP_3"), "{scopes:?}");
}

/// The critical path in words, on a page, as a picture and in statistics, where it sums to the run; a change of a cost changes the
/// run by how often that lies on it.
#[test]
fn why_a_farm_takes_as_long() {
    let folder = Folder::new();
    let farm = "farm rectangles --size 30x20 --tasks 3 --hand-out dealt";
    let stdout = folder.run(&format!("{farm} --why --stats a.json --page a.html --plot plots")).success();
    let (_, why) = stdout.split_once("\nwhy ").unwrap();
    insta::assert_snapshot!(why);
    assert!(folder.read("a.html").contains("where the critical path is, and why"));
    let read = |name: &str| serde_json::from_str::<Value>(&folder.read(name)).unwrap();
    let a = read("a.json");
    for list in ["times", "parts"] {
        let sum: u64 = a["why"][list].as_array().unwrap().iter().map(|part| part["cycles"].as_u64().unwrap()).sum();
        assert_eq!(Some(sum), a["cycles"].as_u64(), "{list}");
    }
    let count = |time: &str| {
        let times = a["why"]["times"].as_array().unwrap().iter();
        times.filter(|known| known["time"] == time).map(|known| known["count"].as_u64().unwrap()).sum::<u64>()
    };
    // By a nanosecond each.
    for (flag, time) in [("--segment-ms 7.000001", "segment_ms"), ("--fixed-ms 1750.000001", "fixed_ms")] {
        folder.run(&format!("{farm} {flag} --stats b.json --force")).success();
        let later = read("b.json")["cycles"].as_u64().unwrap() - a["cycles"].as_u64().unwrap();
        assert!(count(time) > 0 && later == count(time), "{time}: {later}");
    }
    let rooms = folder.run("farm room --size 12x8 --tasks 2 --why --stats c.json --force").success();
    assert!(rooms.contains("intersection, a polygon"), "{rooms}");
    for time in read("c.json")["why"]["times"].as_array().unwrap() {
        let [count, each, all] = ["count", "each", "cycles"].map(|name| time[name].as_u64().unwrap());
        assert!(all == count * each || time["time"] == "bus_message", "{time}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    let standard = std::fs::read_to_string("pcs-programs/capitan.ron").unwrap();
    folder.file("zero.ron", standard.replace("bus_mb_s: 10.0", "bus_mb_s: 0.0"));
    folder.file("unknown.ron", standard.replace("message_ms", "mesage_ms"));
    folder.file("run.json", "{\"cycles\": 1, \"configuration\": {\"scene\": \"room\", \"mode\": \"x\"}}");
    let wrong = [
        "",
        "rectangles --tasks 0",
        "rectangles --tasks 9",
        "rectangles --tasks 5..2",
        "rectangles --tasks many",
        "rectangles --rectangles 0",
        "teapot --size 8x8",
        "rectangles --machine zero.ron",
        "rectangles --machine unknown.ron",
        "rectangles --machine nowhere.ron",
        "rectangles --bus-mb-s 0",
        "rectangles --message-ms -1",
        "rectangles --pixel-ms 1e30",
        "rectangles --processors 1",
        "rectangles --tasks 1..2 --stats a.json",
        "rectangles --tasks 1..2 --why",
        "rectangles --tile 4",
        "rectangles --grid-coefficient 4",
        "rectangles --shade-hit 4",
        "room --seed 4",
        "room --pixel-ms 2",
        "room --adaptive --samples 2",
        "room --grid-coefficient -1",
        "room --items circles",
        "nowhere",
        "rectangles --trace a.txt",
        "--config run.json",
    ];
    let errors = wrong.map(|wrong| format!("farm {wrong}\n{}", folder.run(&format!("farm {wrong}")).refused()));
    insta::assert_snapshot!(errors.join("\n"));
}

const SWEEP: &str = "(scene: \"rectangles\", size: \"20x15\", tasks: (from: 7, to: 10, step: 1), scene_by: [\"copies\", \"broadcast\"])";

#[test]
fn farms_are_swept_and_drawn() {
    let folder = Folder::new();
    folder.file("farms.ron", SWEEP);
    let stdout =
        folder.run("sweep farms.ron -o farms.csv --plot x=tasks y=seconds by=scene_by --accept-failures").success();
    assert!(stdout.starts_with("8 points: 4 done, 4 failed\n"), "{stdout}");
    let table = folder.read("farms.csv");
    insta::assert_snapshot!(table);
    // A point is what the command runs.
    folder.run("farm rectangles --size 20x15 --tasks 7 --scene-by broadcast --stats one.json").success();
    let one: Value = serde_json::from_str(&folder.read("one.json")).unwrap();
    let row: Vec<&str> = table.lines().find(|line| line.contains(",7,broadcast,")).unwrap().split(',').collect();
    let column = table.lines().next().unwrap().split(',').position(|name| name == "seconds").unwrap();
    assert_eq!(row[column].parse::<f64>().unwrap(), one["seconds"].as_f64().unwrap());
    let again = folder.run("sweep farms.ron -o farms.csv --accept-failures").success();
    assert!(again.starts_with("8 points: 4 done, 4 failed (4 now)\n"), "{again}");
}

#[test]
fn a_sweep_is_of_farms_or_of_arrays() {
    let folder = Folder::new();
    for (name, sweep) in [
        ("both", "(tasks: [1, 2], cells: 4)"),
        ("perhaps", "(farm: [true, false])"),
        ("unknown", "(farm: true, task: 2)"),
    ] {
        folder.file(&format!("{name}.ron"), sweep);
    }
    let errors =
        ["both", "perhaps", "unknown"].map(|name| folder.run(&format!("sweep {name}.ron -o {name}.csv")).refused());
    insta::assert_snapshot!(errors.join("\n"));
    folder.file("farm.ron", "(farm: true, scene: \"room\", size: \"8x8\", grid_coefficient: [1, 9])");
    folder.run("sweep farm.ron -o farm.csv").success();
    let (header, rows) = folder.read("farm.csv").split_once('\n').map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    assert!(header.starts_with("farm,scene,size,grid_coefficient,workers,"), "{header}");
    assert_eq!(
        rows.lines().filter(|row| row.starts_with("true,room,8x8,") && row.contains(",8,45,")).count(),
        2,
        "{rows}"
    );
}
