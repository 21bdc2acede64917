//! Masks: cells that a ray cannot meet pass it on, and nothing else changes.

use std::convert::Infallible;

use pcs_sim::geometry::{Partition, brute_force};
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::policy::HostRules;
use pcs_sim::host::sampling::Sampling;
use pcs_sim::host::shading::Limits;
use pcs_sim::machine::{Cycles, MachineSpec};
use pcs_sim::program::{ArrayProgram, Masks, Workload};
use pcs_sim::run::{self, Picture, Seen, Timed, Watching, Workers};

use crate::support::command::Folder;
use crate::support::ticking::{self, Ticked};
use crate::support::{bits, glass, machine, program, scene, workload};

const BOTH: [Masks; 2] = [Masks::Boxes, Masks::Rectangles];

fn hits(workload: &Workload, rays: &[pcs_sim::geometry::Ray]) -> (Vec<[u32; 4]>, u64, run::Outcome) {
    let outcome = run::run(workload, &machine().spec, rays, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
    (outcome.hits.iter().map(bits).collect(), outcome.stats.cycles.0, outcome)
}

/// The bits of testing all polygons, whatever the mode and the cut; and fewer starts.
#[test]
fn masks_lose_no_hit() {
    for (name, size, width) in [("teapot", 3, 16), ("tree", 3, 16), ("room", 1, 12), ("valve", 1, 9)] {
        let (scene, rays) = scene(name, size, width);
        for (mode, groups) in [("broadcast", 8), ("broadcast", 33), ("hybrid", 4), ("hybrid-3", 3), ("pipeline", 1)] {
            for partition in [Partition::Regular, Partition::Work] {
                let plain = ArrayProgram { partition, ..program(mode, groups) };
                let plain_workload = workload(&scene.mesh, &plain, &rays);
                let (expected, ..) = hits(&plain_workload, &rays);
                let brute = |ray| bits(&brute_force(plain_workload.polygons(), ray));
                assert!(expected.iter().copied().eq(rays.iter().map(brute)), "{name} {mode}");
                for masks in BOTH {
                    let masked = ArrayProgram { masks, ..plain.clone() };
                    let masked = workload(&scene.mesh, &masked, &rays).seen_by(&scene.camera);
                    let (found, _, outcome) = hits(&masked, &rays);
                    assert!(found == expected, "{name} {mode} {groups} {partition} {masks:?}");
                    let x = |cell: usize| crate::support::fifo(&outcome.stats, &format!("X{cell}")).words.0;
                    let words = if groups > 32 { 10 } else { 9 };
                    assert!((0..masked.cells()).all(|cell| x(cell) == words * rays.len() as u64));
                }
            }
        }
    }
}

/// As the rule says: where a ray that misses a sub-volume would only have started its grid, it now starts nothing.
#[test]
fn boxes_are_the_trace_without_lone_starts() {
    let folder = Folder::new();
    for flags in ["--cells 8", "--cells 40 --partition work", "--cells 16 --mailbox --fifo-words 40"] {
        let run = format!("--scene teapot --size-factor 3 --mode broadcast --size 14x10 --force {flags}");
        folder.run(&format!("{run} --ops plain.ops --hits plain.csv")).success();
        folder.run(&format!("{run} --masks boxes --stats masked.json --hits masked.csv --ops masked.ops")).success();
        assert_eq!(folder.read("plain.csv"), folder.read("masked.csv"));
        let words = if flags.contains("40 ") { "10" } else { "9" };
        let mut dropped = 0;
        let edit = |line: &str| {
            let mut ops: Vec<String> = line.split(' ').map(str::to_owned).collect();
            if line.starts_with("unit") || line.starts_with("pcs-sim") {
                return line.to_owned();
            }
            for op in &mut ops[2..] {
                match op.as_str() {
                    "x8" => *op = format!("x{words}"),
                    "w8" => *op = format!("w{words}"),
                    _ => {}
                }
            }
            if let Some(place) = ops.iter().position(|op| op == "gs1")
                && ops.get(place + 1).is_none_or(|next| !next.starts_with("gv"))
            {
                ops.remove(place);
                dropped += 1;
            }
            ops.join(" ")
        };
        let edited: Vec<String> = folder.read("plain.ops").lines().map(edit).collect();
        assert!(dropped > 300, "{dropped} of {flags}");
        folder.file("edited.ops", edited.join("\n") + "\n");
        let depth = if flags.contains("fifo") { "--fifo-words 40" } else { "" };
        folder.run(&format!("replay edited.ops --stats edited.json --force {depth}")).success();
        folder.run(&format!("replay masked.ops --stats replayed.json --force {depth}")).success();
        let json = |name: &str| serde_json::from_str::<serde_json::Value>(&folder.read(name)).unwrap();
        let [masked, edited, replayed] = ["masked.json", "edited.json", "replayed.json"].map(json);
        for key in ["cycles", "cells", "fifos"] {
            assert_eq!(masked[key], edited[key], "{flags} {key}");
            assert_eq!(masked[key], replayed[key], "{flags} {key}");
        }
    }
}

/// Without an eye that sees them, rectangles let all rays meet all sub-volumes: a word more, and else the same.
#[test]
fn a_mask_of_ones_changes_nothing_but_its_word() {
    let (scene, rays) = scene("teapot", 3, 12);
    let masked = ArrayProgram { masks: Masks::Rectangles, ..program("broadcast", 6) };
    let (plain, masked) =
        (workload(&scene.mesh, &program("broadcast", 6), &rays), workload(&scene.mesh, &masked, &rays));
    let edited: Vec<_> = crate::support::ops(&plain, &rays);
    let found = crate::support::ops(&masked, &rays);
    for (plain, masked) in edited.iter().zip(&found) {
        for (plain, masked) in plain.cells.iter().zip(&masked.cells) {
            let longer = |op: &pcs_sim::seam::Op| match op.kind() {
                pcs_sim::seam::OpKind::PassX => (op.kind(), op.count() + 1),
                kind => (kind, op.count()),
            };
            assert!(plain.ops().iter().map(longer).eq(masked.ops().iter().map(|op| (op.kind(), op.count()))));
        }
    }
    assert_eq!(hits(&plain, &rays).0, hits(&masked, &rays).0);
}

/// Secondary rays too, and the host's time for each box, as ticking every cycle gives it.
#[test]
fn images_are_the_same_and_timed_as_their_ops_say() {
    let scene = glass();
    let (size, sampling, limits) = (ImageSize { width: 10, height: 8 }, Sampling::default(), Limits::default());
    let mut times = machine().times;
    let render = |masks: Masks, times| {
        let program = ArrayProgram { masks, ..program("broadcast", 5) };
        let workload = Workload::new(&scene.mesh, &program, times, &[]).unwrap().seen_by(&scene.camera);
        let picture = Picture {
            scene: &scene,
            workload: &workload,
            size,
            sampling,
            limits,
            screen: None,
            rules: Default::default(),
        };
        let timed = Timed { spec: &MachineSpec::default(), rules: HostRules::default(), watching: Watching::default() };
        let mut batches = Vec::new();
        let rendered = run::render(&picture, Some(timed), &Workers::new(2), |seen| {
            if let Seen::Sent(ops, ..) = seen {
                batches.push(ops.clone());
            }
            Ok::<_, Infallible>(())
        });
        let rendered = rendered.unwrap();
        let stats = rendered.timing.unwrap().stats;
        assert_eq!(Ticked::from(&stats), ticking::run(&MachineSpec::default(), workload.costs(), &batches).unwrap());
        (rendered.pixels, stats.cycles.0, rendered.kinds)
    };
    let (pixels, cycles, kinds) = render(Masks::Off, times);
    for masks in BOTH {
        let (masked, faster, of_kinds) = render(masks, times);
        assert!(masked == pixels && faster < cycles, "{masks:?}: {faster} of {cycles}");
        let busy = |kinds: &run::ByKind<run::KindCounts>, kind: usize| kinds[kind].busy;
        assert!(busy(&of_kinds, 0) < busy(&kinds, 0));
        // Rectangles are seen by the eye alone.
        assert_eq!(busy(&of_kinds, 1) < busy(&kinds, 1), masks == Masks::Boxes);
    }
    times.host.mask = Cycles(2000);
    let rays: u64 = kinds.iter().map(|kind| kind.rays).sum();
    assert!(render(Masks::Boxes, times).1 >= rays * 5 * 2000);
    let primary = kinds[0].rays * 5 * 2000;
    let (_, by_rectangles, _) = render(Masks::Rectangles, times);
    assert!(by_rectangles >= primary && by_rectangles < rays * 5 * 2000, "{by_rectangles} for {primary}");
}

#[test]
fn files_sweeps_and_configurations_have_them() {
    let folder = Folder::new();
    folder.file("masked.ron", "(name: \"masked\", groups: 8, stages: [[grid, slabs, intersection]], masks: boxes)");
    let run = "--scene teapot --size-factor 3 --size 8x8 --force";
    folder.run(&format!("{run} --program masked.ron --stats a.json")).success();
    folder.run(&format!("{run} --mode broadcast --cells 8 --masks boxes --stats b.json")).success();
    folder.run("--config b.json --stats c.json --force").success();
    let json = |name: &str| serde_json::from_str::<serde_json::Value>(&folder.read(name)).unwrap();
    assert_eq!(json("a.json")["cycles"], json("b.json")["cycles"]);
    assert_eq!(folder.read("b.json"), folder.read("c.json"));
    folder.file(
        "sweep.ron",
        "(scene: \"teapot\", size_factor: 3, size: 8, mode: \"broadcast\", cells: [8, 16], masks: [\"boxes\", \"rectangles\"],
          host_mask_us: [0, 2.5], screen_rectangles: [\"off\", \"objects\"])",
    );
    folder.run("sweep sweep.ron -o table.csv").success();
    let table = folder.read("table.csv");
    assert_eq!(table.lines().count(), 17);
    assert!(table.lines().next().unwrap().contains("masks") && table.contains("host_mask_cycles"), "{table}");
    assert!(table.contains(&format!(",{},", json("b.json")["cycles"])), "{table}");
    // Off is off, whatever a file asks for.
    folder.run(&format!("{run} --mode broadcast --cells 8 --stats plain.json")).success();
    folder.run(&format!("{run} --program masked.ron --masks off --stats off.json")).success();
    assert_eq!(json("off.json")["cycles"], json("plain.json")["cycles"]);
    assert_ne!(json("off.json")["cycles"], json("a.json")["cycles"]);
}

/// The model expects what is counted: fewer cycles with masks, and a host that is held up by its tests.
#[test]
fn the_model_predicts_what_masks_save() {
    let folder = Folder::new();
    let quantity = |flags: &str| {
        folder
            .run(&format!("model sombrero --mode broadcast --cells 8 --size 32x24 {flags} --stats m.json --force"))
            .success();
        let json: serde_json::Value = serde_json::from_str(&folder.read("m.json")).unwrap();
        let rows = json["quantities"].as_array().unwrap();
        let row = rows.iter().find(|row| row["quantity"] == "cycles a ray, at least").unwrap();
        ["model", "counted"].map(|by| row[by].as_f64().unwrap())
    };
    let [model, counted] = quantity("");
    for masks in ["boxes", "rectangles"] {
        let [masked_model, masked_counted] = quantity(&format!("--masks {masks}"));
        let (expected, saved) = (1.0 - masked_model / model, 1.0 - masked_counted / counted);
        assert!(saved > 0.1 && (expected - saved).abs() < 0.02, "{masks}: {expected} expected, {saved} saved");
        // 100 us a test are 2 000 cycles: eight of them, and nine words.
        assert_eq!(quantity(&format!("--masks {masks} --host-mask-us 100")), [16_009.0; 2]);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    folder.file("rays.csv", "ox,oy,oz,dx,dy,dz\n0,0,0,1,0,0\n");
    folder.file("p.ron", "(name: \"p\", groups: 2, stages: [[grid, slabs, intersection]], masks: spheres)");
    let mut report = String::new();
    for flags in [
        "--scene room --size 4x4 --mode broadcast --masks spheres",
        "--scene room --size 4x4 --program p.ron",
        "--scene room --rays rays.csv --mode broadcast --masks rectangles",
        "--scene room --size 4x4 --mode broadcast --masks boxes --cells-run programs",
        "--scene room --size 4x4 --mode broadcast --masks boxes --host-mask-us=-3",
        "--scene room --size 4x4 --mode broadcast --host-mask-us 3",
        "image room --size 4x4 -o i.png --timing off --masks boxes",
    ] {
        report += &format!("{flags}\n{}\n", folder.run(flags).refused());
    }
    folder.run("--scene room --rays rays.csv --mode broadcast --masks boxes").success();
    insta::assert_snapshot!(report);
}
