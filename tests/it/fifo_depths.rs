//! FIFOs with depths of their own, as a machine file gives them.

use crate::support::command::Folder;
use crate::support::ticking;
use pcs_sim::machine::{MachineFile, MachineSpec};
use serde_json::Value;

/// A standard machine file with a field more.
fn machine(field: &str) -> String {
    MachineFile::STANDARD_TEXT.replacen("    times_us:", &format!("    {field},\n    times_us:"), 1)
}

fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&folder.read(name)).unwrap()
}

const DEPTHS: &str = r#"fifo_words_of: {"X1": 8, "Y1": 3, "Y2": 700, "Yhost": 2}"#;

#[test]
fn everything_that_is_told_of_a_run_knows_them() {
    let folder = Folder::new();
    folder.file("m.ron", machine(DEPTHS));
    let run = "--mode pipeline --scene room --size 20x15";
    let text = folder
        .run(&format!("{run} --machine m.ron --fifo-words 64 --ops a.ops --stats a.json --page a.html --plot plots --trace t.pftrace"))
        .success();
    assert!(text.contains("64-word FIFOs (4 with depths of their own)"), "{text}");
    let stats = json(&folder, "a.json");
    let capacities: Vec<(&str, u64)> = stats["fifos"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fifo| (fifo["name"].as_str().unwrap(), fifo["capacity"].as_u64().unwrap()))
        .collect();
    assert_eq!(capacities, [("X0", 64), ("X1", 8), ("X2", 64), ("Y1", 3), ("Y2", 700), ("Yhost", 2)]);
    assert_eq!(stats["configuration"]["machine"]["fifo_words_of"]["Y1"], 3);
    // The same run again, from its description; the recording under that machine; and under none such.
    folder.run("--config a.json --stats b.json").success();
    assert_eq!(folder.read("b.json"), folder.read("a.json"));
    folder.run("replay a.ops --machine m.ron --fifo-words 64 --stats c.json").success();
    folder.run("replay a.ops --fifo-words 64 --stats d.json").success();
    assert_eq!(json(&folder, "c.json")["cells"], stats["cells"]);
    assert!(json(&folder, "d.json")["cycles"].as_u64() < stats["cycles"].as_u64());
    folder.file(
        "sweep.ron",
        r#"(scene: "room", size: "20x15", mode: "pipeline", machine: "m.ron", fifo_words: [64, 512])"#,
    );
    folder.run("sweep sweep.ron -o t.csv").success();
    assert!(folder.read("t.csv").lines().nth(1).unwrap().contains(&stats["cycles"].to_string()));
    let html = folder.read("a.html");
    assert!(html.contains(r#""Y2""#) && html.contains("700"));
}

#[test]
fn are_timed_as_ticking_does() {
    let folder = Folder::new();
    folder.file("m.ron", machine(DEPTHS));
    folder.run("--mode pipeline --scene room --size 8x6 --machine m.ron --stats a.json").success();
    let size = pcs_sim::host::camera::ImageSize { width: 8, height: 6 };
    let scene = pcs_sim::scene::builtin::generate("room", None, None).unwrap();
    let rays = pcs_sim::host::camera::primary_rays(&scene.camera, size);
    let workload = crate::support::workload(&scene.mesh, &crate::support::program("pipeline", 1), &rays);
    let machine = MachineFile::parse(&folder.path("m.ron"), &folder.read("m.ron")).unwrap().build().unwrap();
    let ops = crate::support::ops(&workload, &rays);
    let cycles = |spec: &MachineSpec| ticking::run(spec, workload.costs(), &ops).unwrap().cycles.0;
    assert_eq!(json(&folder, "a.json")["cycles"], cycles(&machine.spec));
    assert!(cycles(&MachineSpec::default()) < cycles(&machine.spec));
}

/// More rows than pictures have room for, of depths that histograms count in other steps.
#[test]
fn pictures_of_many_cells_show_fifos_of_all_depths() {
    let folder = Folder::new();
    folder.file("m.ron", machine(r#"fifo_words_of: {"X1": 3000, "Y1": 20000, "Y70": 8, "Yhost": 4}"#));
    folder
        .run("--mode broadcast --cells 71 --scene teapot --size 8x6 --machine m.ron --plot plots --page a.html")
        .success();
    assert!(
        folder.path("plots").join("fifo-levels.png").exists()
            || std::fs::read_dir(folder.path("plots")).unwrap().count() > 6
    );
}

#[test]
fn impossible_ones_are_refused() {
    let folder = Folder::new();
    let refused = |field: &str, flags: &str| {
        folder.file("m.ron", machine(field));
        folder.run(&format!("--scene room --size 8x6 --machine m.ron {flags}")).refused()
    };
    insta::assert_snapshot!(refused(r#"fifo_words_of: {"Y1": 0}"#, ""));
    insta::assert_snapshot!(refused(r#"fifo_words_of: {"Y0": 5}"#, ""));
    insta::assert_snapshot!(refused(r#"fifo_words_of: {"X5": 5}"#, "--mode pipeline"));
    folder.run("--mode pipeline --scene room --size 8x6 --ops a.ops").success();
    let error = folder.run("replay a.ops --machine m.ron").refused();
    assert!(error.contains("FIFO X5"), "{error}");
    let error = refused(r#"fifo_words_of: {"Z0": 1}"#, "--mode pipeline --stop-words 9");
    assert!(error.contains("these hold 1 word"), "{error}");
}
