//! A recorded trace gives the very statistics of the run that recorded it, and under another machine what that machine
//! would have taken.

use crate::support::command::Folder;
use crate::support::ticking;
use pcs_sim::machine::line::{IDLE, waiting};
use pcs_sim::machine::{MachineSpec, Words};
use pcs_sim::seam::Channel;
use serde_json::Value;

/// A statistics file without what only the scene tells.
fn timing_of(json: &str) -> serde_json::Value {
    let mut value: serde_json::Value = serde_json::from_str(json).unwrap();
    let object = value.as_object_mut().unwrap();
    object.remove("counts");
    object.remove("messages");
    object.remove("configuration");
    value
}

#[test]
fn gives_the_very_stats_of_the_run() {
    for mode in [
        "--mode pipeline",
        "--mode broadcast --cells 6",
        "--mode broadcast --cells 6 --bounded-walk --partition measured --numbering front",
        "--mode hybrid",
        "--program hybrid-3 --groups 2",
        "--mode pipeline --stop-words 6",
        "--mode hybrid --stop-words 3 --forward-ahead 5",
    ] {
        let folder = Folder::new();
        folder
            .run(&format!("{mode} --scene teapot --size-factor 4 --size 40x30 --ops a.ops --stats run.json"))
            .success();
        folder.run("replay a.ops --stats replay.json").success();
        assert_eq!(timing_of(&folder.read("replay.json")), timing_of(&folder.read("run.json")), "{mode}");
    }
}

#[test]
fn under_another_machine_gives_what_ticking_gives() {
    let folder = Folder::new();
    folder.run("--mode pipeline --scene teapot --size-factor 3 --size 9x7 --ops a.ops --stats run.json").success();
    folder.run("replay a.ops --fifo-words 64 --stats replay.json").success();
    let (scene, _) = crate::support::scene("teapot", 3, 1);
    let size = pcs_sim::host::camera::ImageSize { width: 9, height: 7 };
    let rays = pcs_sim::host::camera::primary_rays(&scene.camera, size);
    let workload = crate::support::workload(&scene.mesh, &crate::support::program("pipeline", 1), &rays);
    let spec = MachineSpec { fifo_words: Words(64), ..MachineSpec::default() };
    let ticked = ticking::run(&spec, workload.costs(), &crate::support::ops(&workload, &rays)).unwrap();
    let replay: serde_json::Value = serde_json::from_str(&folder.read("replay.json")).unwrap();
    assert_eq!(replay["cycles"], ticked.cycles.0);
    for (cell, times) in ticked.stations.iter().enumerate() {
        let waits = [Channel::X, Channel::Y].map(|channel| times.of(waiting(channel)).0);
        assert_eq!(
            [&replay["cells"][cell]["waiting_x"], &replay["cells"][cell]["waiting_y"]],
            waits.map(Value::from).each_ref()
        );
        assert_eq!(replay["cells"][cell]["idle"], times.of(IDLE).0);
    }
    for (index, (name, _, fifo)) in ticked.fifos.iter().enumerate() {
        let told = &replay["fifos"][index];
        assert_eq!((told["name"].as_str(), &told["words"]), (Some(name.as_str()), &Value::from(fifo.words.0)));
        assert_eq!((&told["max"], &told["capacity"]), (&Value::from(fifo.max.0), &Value::from(64)));
    }
    assert_ne!(folder.read("replay.json"), folder.read("run.json"));
}

#[test]
fn a_run_with_other_machine_flags_equals_a_replay_with_them() {
    let folder = Folder::new();
    let machine = "--fifo-words 16 --link-mb-s 25 --rate-counts channel --latency-cycles 7";
    let run = "--mode broadcast --cells 3 --scene room --size 20x20";
    folder.run(&format!("{run} --ops a.ops")).success();
    folder.run(&format!("{run} {machine} --stats run.json")).success();
    folder.run(&format!("replay a.ops {machine} --stats replay.json")).success();
    assert_eq!(timing_of(&folder.read("replay.json")), timing_of(&folder.read("run.json")));
}

#[test]
fn lines_may_stand_in_any_order_across_cells_and_rays_have_any_numbers() {
    let folder = Folder::new();
    let interleaved = "# two cells\n7 host w8\n7 0 x8 g10 o2\n7 1 x8 i2 o5\n3 host w8\n3 0 x8 o2\n3 1 x8 i2 n4 o5\n";
    let sorted = "7 0 x8 g10 o2\n3 0 x8 o2\n\n7 1 x8 i2 o5\n3 1 x8 i2 n4 o5\n7 host w8\n3 host w8\n";
    folder.file("a.ops", interleaved);
    folder.file("b.ops", sorted);
    folder.run("replay a.ops --stats a.json").success();
    folder.run("replay b.ops --stats b.json").success();
    assert_eq!(timing_of(&folder.read("a.json")), timing_of(&folder.read("b.json")));
}

#[test]
fn the_host_waits_for_hits_and_takes_its_time() {
    let folder = Folder::new();
    // Ray 0: written 0-7, read 1-8, HIT 9-13, read by the host 10-14. The host computes 15-24, writes ray 1 in 25-32;
    // it is read in 26-33, its HIT written 34-38, and read by 39.
    folder.file("a.ops", "0 host w8\n1 host a0 c10 w8\n0 0 x8 o5\n1 0 x8 o5\n");
    folder.run("replay a.ops --stats a.json").success();
    let stats: serde_json::Value = serde_json::from_str(&folder.read("a.json")).unwrap();
    assert_eq!(stats["cycles"], 40);
    assert_eq!(stats["cells"][0]["waiting_x"], 1 + (26 - 14));
}

#[test]
fn statistics_end_with_the_last_hit() {
    let folder = Folder::new();
    // Cell 0 goes on computing for long after the host has read the last word, in cycle 1 + 8 + 5 + 1 = 15.
    folder.file("a.ops", "0 host w8\n0 0 x8 o1 c5000\n0 1 x8 i1 o5\n");
    folder.run("replay a.ops --stats a.json").success();
    let stats: serde_json::Value = serde_json::from_str(&folder.read("a.json")).unwrap();
    // Cell 0: read 1-8, out 9, computes from 10. Cell 1: read 2-9, in 10, out 11-15. The host reads the last in 16.
    assert_eq!(stats["cycles"], 17);
    assert_eq!(stats["cells"][0]["busy"]["other"], 7);
    assert_eq!(stats["cells"][0]["idle"], 0);
}
