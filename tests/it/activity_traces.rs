//! Activity traces in both forms: units of work, which any machine prices, and cycles, which none prices again.

use crate::support::command::Folder;

/// A run and the replay of its trace, by what both write of the machine: stats but for what only a run knows.
fn same_machine(folder: &Folder, run: &str, replay: &str) {
    let [run, replay] =
        [run, replay].map(|name| -> serde_json::Value { serde_json::from_str(&folder.read(name)).unwrap() });
    for part in ["cycles", "seconds", "rays", "cells", "fifos", "bottleneck"] {
        assert_eq!(run[part], replay[part], "{part}");
    }
}

/// Figure 7's times are clockwork: a trace recorded under some gives what a run under others gives.
#[test]
fn a_trace_in_units_is_priced_by_another_machine() {
    let folder = Folder::new();
    let scene = "--scene teapot --size-factor 3 --size 9x7 --force";
    let times = "--grid-start 4 --grid-voxel 0 --slabs-start 1.5 --slabs-polygon 2 --intersection-start 7 \
                 --intersection-polygon 0.05 --host-ray-us 3";
    for program in ["--mode pipeline", "--mode broadcast --cells 3", "--mode hybrid --stop-words 3 --groups 2"] {
        folder.run(&format!("{program} {scene} --ops units.ops --stats own.json")).success();
        folder.run("replay units.ops --stats again.json --force").success();
        same_machine(&folder, "own.json", "again.json");
        folder.run(&format!("{program} {scene} {times} --stats other.json --ops other.ops")).success();
        folder.run(&format!("replay units.ops {times} --stats priced.json --force")).success();
        same_machine(&folder, "other.json", "priced.json");
        let body = |name: &str| folder.read(name).lines().skip_while(|line| !line.contains(" host ")).count();
        assert_eq!(body("units.ops"), body("other.ops"), "the ops are the same, whatever they cost");
    }
}

/// What instructions cost is clockwork too.
#[test]
fn instructions_are_priced_by_another_machine() {
    let folder = Folder::new();
    let text = std::fs::read_to_string("pcs-programs/pcs.ron").unwrap();
    folder.file("slow.ron", text.replace("integer: ", "integer: 1").replace("load: ", "load: 2"));
    let run = "--cells-run programs --scene tetra --size-factor 3 --size 9x7";
    folder.run(&format!("{run} --ops units.ops --stats own.json")).success();
    folder.run(&format!("{run} --machine slow.ron --stats other.json")).success();
    folder.run("replay units.ops --machine slow.ron --stats priced.json").success();
    same_machine(&folder, "other.json", "priced.json");
    assert_ne!(folder.read("own.json"), folder.read("other.json"));
}

#[test]
fn a_trace_in_cycles_keeps_its_times() {
    let folder = Folder::new();
    let run = "--mode hybrid --groups 2 --scene room --size 9x7 --fifo-words 16";
    folder.run(&format!("{run} --ops cycles.ops --ops-form priced --stats own.json")).success();
    assert!(folder.read("cycles.ops").starts_with("# pcs-sim activity trace of 4 cells"));
    folder.run("replay cycles.ops --fifo-words 16 --stats again.json").success();
    same_machine(&folder, "own.json", "again.json");
    let refused = folder.run("replay cycles.ops --grid-voxel 3").refused();
    assert!(refused.contains("--grid-voxel is a time that the trace has recorded"), "{refused}");
}

#[test]
fn the_form_alone_is_refused() {
    assert!(Folder::new().run("--ops-form priced").refused().contains("--ops <FILE>"));
}

const UNITS: &str = "pcs-sim trace 2 cells 1 answer 5\nunit gs grid_start grid 600\nunit gv grid_voxel grid 156\n";

/// Cells 0 to 7 read the ray, 8 to 607 the start, then three voxels and a HIT: worked out by hand.
#[test]
fn a_trace_by_hand() {
    let folder = Folder::new();
    folder.file("a.ops", format!("{UNITS}# a comment\n\n0 host w8\n0 0 x8 gs1 gv3 o5\n"));
    let times = |flags: &str| {
        folder.run(&format!("replay a.ops {flags} --stats s.json --force")).success();
        let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        assert_eq!(stats["cells"][0]["busy"].as_object().unwrap().len(), 1, "the trace has one activity");
        (stats["cycles"].as_u64().unwrap(), stats["cells"][0]["busy"]["grid"].as_u64().unwrap())
    };
    assert_eq!(times(""), (9 + 600 + 3 * 156 + 6, 600 + 3 * 156));
    assert_eq!(times("--grid-voxel 1"), (9 + 600 + 3 * 20 + 6, 600 + 3 * 20));
    assert_eq!(times("--clock-ns 100"), (9 + 600 + 3 * 156 + 6, 600 + 3 * 156), "costs are in cycles");
}

#[test]
fn headings_that_are_none_are_refused() {
    let folder = Folder::new();
    let refused = |name: &str, heading: &str| {
        folder.file("a.ops", format!("{heading}0 host w8\n0 0 x8 o5\n"));
        insta::assert_snapshot!(format!("heading {name}"), folder.run("replay a.ops").refused());
    };
    refused("without words", "pcs-sim trace 2 cells\n");
    refused("without an answer", "pcs-sim trace 2 cells 1 answer 0\n");
    refused("short unit", "pcs-sim trace 2 cells 1 answer 5\nunit gs grid\n");
    refused("code of a move", "pcs-sim trace 2 cells 1 answer 5\nunit x grid_start grid 1\n");
    refused("code twice", &format!("{UNITS}unit gv voxels grid 1\n"));
    refused("endless unit", "pcs-sim trace 2 cells 1 answer 5\nunit gs grid_start grid 99999999999\n");
    refused("unknown unit", &format!("{UNITS}1 host w8\n1 0 x8 sp1 o5\n"));
    let many: String = (0..9).map(|n| format!("unit {}q n{n} a{n} 1\n", char::from(b'a' + n))).collect();
    refused("too many activities", &format!("pcs-sim trace 2 cells 1 answer 5\n{many}"));
}

/// What is left behind the last HIT is carried out, and is in no figure.
#[test]
fn what_outlives_the_run_is_in_no_figure() {
    let folder = Folder::new();
    let replay = |ops: &str| {
        folder.file("a.ops", ops);
        let told = folder.run("replay a.ops --stats s.json --force").success();
        (told, serde_json::from_str::<serde_json::Value>(&folder.read("s.json")).unwrap())
    };
    // The HIT is written in cycles 0 to 4 and read by 5. The host writes in 10 to 17: of that nothing is in the run.
    let (told, late) = replay("0 host c10 w8\n0 0 o5\n");
    assert_eq!(
        (&late["cycles"], &late["fifos"][0]["words"], &late["fifos"][0]["mean"]),
        (&6.into(), &0.into(), &0.0.into())
    );
    assert_eq!(late["fifos"][0]["empty"], 1.0);
    assert!(!told.contains("The link"), "{told}");
    // Six of the twenty words are written by then, one a cycle: 1 + 2 + ... + 6 words times cycles.
    let (told, unread) = replay("0 host w20\n0 0 o5\n");
    let x0 = &unread["fifos"][0];
    assert_eq!(
        (&unread["cycles"], &x0["words"], &x0["max"], &x0["mean"]),
        (&6.into(), &6.into(), &6.into(), &3.5.into())
    );
    assert!(!told.contains("The link"), "nobody reads these words: {told}");
    // A word takes the link three cycles; the run ends in the middle of the third.
    folder.run("replay a.ops --link-mb-s 27 --stats slow.json").success();
    let slow: serde_json::Value = serde_json::from_str(&folder.read("slow.json")).unwrap();
    assert_eq!((&slow["cycles"], &slow["fifos"][0]["words"]), (&14.into(), &5.into()));
    assert!(slow["bottleneck"].as_str().unwrap().starts_with("The link back to the host limits"), "{slow}");
}

/// `a7` waits for ray 7's own answer: traces in which that is another than the one in its turn are refused.
#[test]
fn answers_come_back_in_the_order_of_the_rays() {
    let folder = Folder::new();
    let refused = |name: &str, ops: &str| {
        folder.file("a.ops", ops);
        insta::assert_snapshot!(format!("answers {name}"), folder.run("replay a.ops").refused());
    };
    let sent = "0 host w8\n1 host w8\n";
    refused("in another order", &format!("{sent}2 host a0 w8\n1 0 x8 o5 g1000\n0 0 x8 o5\n2 0 x8 o5\n"));
    refused("in another order and not awaited", &format!("1 0 r8 o5\n0 0 r8 o5\n{sent}"));
    refused("left out before", &format!("{sent}2 host a1 w8\n0 0 x8\n1 0 x8 o5\n2 0 x8 o5\n"));
    refused("too long before", &format!("{sent}2 host a1 w8\n0 0 x8 o10\n1 0 x8 o5\n2 0 x8 o5\n"));
    refused("not its own", &format!("{sent}2 host a1 w8\n0 0 x8 o5\n1 0 x8\n2 0 x8 o10\n"));
    // In several lines, and of cells that stand in any order.
    folder.file(
        "a.ops",
        format!("1 1 x8\n1 1 o5\n2 1 x8 o5\n2 0 x8\n0 0 x8\n1 0 x8\n{}", "2 host w8\n0 host a2 w8\n1 host w8\n"),
    );
    assert!(folder.run("replay a.ops").refused().contains("answers ray 2 after ray 1"));
    folder.file(
        "a.ops",
        format!(
            "2 1 x8\n2 1 o5\n0 1 x8 o5\n2 0 x8\n0 0 x8\n1 0 x8\n1 1 x8 o1\n{}",
            "2 host w8\n0 host a2 w8\n1 host a0 w8\n"
        ),
    );
    folder.run("replay a.ops").success();
}

/// A FIFO's level is right where it sums to more than 2^64 words times cycles.
#[test]
fn a_deep_fifo_in_a_long_run() {
    let folder = Folder::new();
    let ops =
        "pcs-sim trace 2 cells 1 answer 5\nunit gs start grid 1000000000\n0 host w1000000\n0 0 gs30000 r1000000 o5\n";
    folder.file("a.ops", ops);
    folder.run("replay a.ops --fifo-words 1048576 --stats s.json --page p.html").success();
    let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
    let (mean, max) = (stats["fifos"][0]["mean"].as_f64().unwrap(), &stats["fifos"][0]["max"]);
    assert!((mean - 1e6).abs() < 0.1 && max == 1_000_000, "{mean} {max}");
}
