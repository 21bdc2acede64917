//! The lab as those who ask it see it: what it answers, whom it refuses, and that nothing is left of who goes away.

use std::io::Read;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use pcs_sim::measure::{Moment, Recording, StateKind, StationMoment};
use pcs_sim::quantities::{Cycles, Words};
use pcs_sim::report::page;
use serde_json::{Value, json};

use crate::support::command::Folder;
use crate::support::lab::{Answer, Lab};
use crate::support::recorded;

/// Bytes as a page sends them.
fn base64(bytes: &[u8]) -> String {
    use base64::Engine;
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

fn files(files: &[(&str, &[u8])]) -> Value {
    let files: Vec<Value> =
        files.iter().map(|(name, bytes)| json!({ "name": name, "base64": base64(bytes) })).collect();
    json!({ "files": files })
}

#[test]
fn a_run_is_what_the_command_makes_of_the_same_parameters() {
    let (lab, folder) = (Lab::start(""), Folder::new());
    let run = lab.get("/run?scene=room&mode=broadcast&cells=4&size=24x18&fifo_words=8");
    let done = run.done();
    assert_eq!(done["command"], "pcs-sim --scene room --mode broadcast --cells 4 --size 24x18 --fifo-words 8");
    let flags = done["command"].as_str().unwrap().strip_prefix("pcs-sim ").unwrap();
    let stats: Value = serde_json::from_str(&folder.run(&format!("{flags} --json")).success()).unwrap();
    assert_eq!(done["stats"], stats);
    assert_eq!(done["replayed"], false);
    // What a page of the command draws, the lab's page is told to draw.
    let mut figures: Value = serde_json::from_str(&run.event("figures")).unwrap();
    figures["looks"] = serde_json::from_str(&run.event("looks")).unwrap();
    folder.run(&format!("{flags} --page page.html")).success();
    let page = folder.read("page.html");
    let drawn = page.rsplit("show(").next().unwrap().split(");</script>").next().unwrap();
    assert_eq!(figures, serde_json::from_str::<Value>(drawn).unwrap());
}

#[test]
fn what_only_the_clockwork_changes_is_replayed() {
    let lab = Lab::start("");
    let replayed = |query: &str| lab.get(&format!("/run?scene=room&size=16x16&{query}")).done()["replayed"].clone();
    assert_eq!(replayed("mode=broadcast"), false);
    for change in ["fifo_words=4", "grid_voxel=3.9", "link_mb_s=20", "latency_cycles=9", "clock_ns=100"] {
        assert_eq!(replayed(&format!("mode=broadcast&{change}")), true, "{change}");
    }
    for change in ["mode=pipeline", "mode=broadcast&cells=4", "mode=broadcast&grid_coefficient=7"] {
        assert_eq!(replayed(change), false, "{change}");
    }
    assert_eq!(replayed("mode=broadcast"), true, "runs before the last one are at hand, too");
}

#[test]
fn the_critical_path_is_told_when_it_is_asked_for() {
    let lab = Lab::start("");
    let [with, without] = ["why", "run"].map(|path| lab.get(&format!("/{path}?scene=room&size=8x8")));
    assert!(with.done()["stats"].get("why").is_some() && without.done()["stats"].get("why").is_none());
    let is_told = |answer: &Answer| answer.event("text").contains("The critical path:");
    assert!(is_told(&with) && !is_told(&without));
}

#[test]
fn what_makes_no_run_is_refused_in_the_commands_words() {
    let (lab, folder) = (Lab::start(""), Folder::new());
    let refused = |query: &str| {
        let answer = lab.get(&format!("/run?{query}"));
        assert_eq!(answer.status, 422, "{}", answer.body);
        answer.body
    };
    for (query, flags) in [("cells=8", "--cells 8"), ("clock_ns=0", "--clock-ns 0"), ("fifo_words=0", "--fifo-words 0")]
    {
        assert_eq!(refused(query), folder.run(flags).refused());
    }
    assert!(refused("fifo_wrods=8").contains("unknown parameter `fifo_wrods`"));
    assert!(refused("fifo_wrods=8").contains("fifo_words"));
    assert!(refused("samples=4").contains("unknown parameter `samples`"));
    assert!(refused("cells=3&cells=3").contains("given twice"));
    assert!(refused("size=4096x4096").contains("at most 4194304 pixels"));
    for query in ["rays=/etc/passwd", "machine=/etc/passwd", "cell_programs=/etc", "program=/etc/passwd"] {
        let refusal = refused(query);
        assert!(refusal.contains("names a file") && !refusal.contains("root:"), "{refusal}");
    }
    for query in ["scene=/etc/passwd", "scene=../x.obj", "scene=x.obj", "scene=-.obj"] {
        assert!(refused(query).contains("is not at hand"), "{query}");
    }
}

#[test]
fn what_a_run_does_not_look_at_is_told_and_in_no_command() {
    let lab = Lab::start("");
    let done = lab.get("/run?scene=room&size=8x8&partition=work&resolution=9").done();
    let moot: Vec<&String> = done["moot"].as_object().unwrap().keys().collect();
    assert_eq!(moot, ["partition", "resolution"]);
    assert_eq!(done["command"], "pcs-sim --scene room --size 8x8");
}

#[test]
fn a_run_that_cannot_go_on_says_so_in_the_commands_words() {
    let (lab, folder) = (Lab::start(""), Folder::new());
    let answer = lab.get("/run?scene=room&size=8x8&stop_words=64&fifo_words=31");
    let command = folder.run("--scene room --size 8x8 --stop-words 64 --fifo-words 31");
    assert_ne!(command.status, 0);
    assert_eq!(answer.event("failed").trim_end(), command.stderr.trim_end());
}

#[test]
fn a_scene_that_is_dropped_is_run_and_one_that_is_wrong_is_told_as_by_the_command() {
    let (mut lab, folder) = (Lab::start(""), Folder::new());
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    let taken = lab.post("/scenes", &files(&[("a.mtl", b"newmtl red\nKd 1 0 0\n"), ("a.obj", obj.as_bytes())]));
    assert_eq!(taken.status, 200, "{}", taken.body);
    let scene = serde_json::from_str::<Value>(&taken.body).unwrap()["scene"].as_str().unwrap().to_owned();
    let done = lab.get(&format!("/run?scene={scene}&size=8x8")).done();
    assert!(done["title"].as_str().unwrap().contains("scene a (1 polygon)"), "{done}");
    assert_eq!(done["command"], "pcs-sim --scene a.obj --size 8x8");
    // The same again has the same address, in this lab as in any.
    let again =
        Lab::start("").post("/scenes", &files(&[("a.mtl", b"newmtl red\nKd 1 0 0\n"), ("a.obj", obj.as_bytes())]));
    assert_eq!(again.body, taken.body);

    let wrong: [(&str, &str); 4] = [
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        ("b.ron", "(camera: (eye: (0, 0, 5), look_at: (0, 0, 0), fov: 40), meshes: [(faces: 1)])"),
        ("c.nff", "s 0 0 zero 1\n"),
        ("d.ply", "ply\nformat ascii 1.0\nelement vertex x\n"),
    ];
    for (name, text) in wrong {
        folder.file(name, text);
        let told = lab.post("/scenes", &files(&[(name, text.as_bytes())]));
        assert_eq!(told.status, 422);
        assert_eq!(told.body, folder.run(&format!("--scene {name}")).refused(), "{name}");
    }
    // As Ctrl-C ends the lab, what was dropped goes too.
    let places = |lab: &Lab| std::fs::read_dir(lab.places.path()).unwrap().count();
    assert_eq!(places(&lab), 1);
    assert_eq!(lab.interrupt(), Some(130));
    assert_eq!(places(&lab), 0);
}

#[test]
fn a_scene_that_is_dropped_reads_nothing_else() {
    let (lab, folder) = (Lab::start(""), Folder::new());
    let secret = folder.file("secret.obj", "the secret\n");
    let ron = |file: &str| format!(r#"(meshes: [(shape: File("{file}"))])"#);
    let up = format!("../../../../..{}", secret.display());
    for file in [secret.display().to_string(), up, "/dev/zero".to_owned()] {
        let told = lab.post("/scenes", &files(&[("a.ron", ron(&file).as_bytes())]));
        assert!(!told.body.contains("the secret"), "{}", told.body);
        assert_eq!(told.status, 422, "{}", told.body);
        assert!(told.body.contains("beside the scene"), "{}", told.body);
    }
    folder.file("a.ron", ron(&secret.display().to_string()));
    assert!(folder.run("--scene a.ron").refused().contains("the secret"), "the command reads it");
    // With a file that came along it is a scene.
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let told = lab.post("/scenes", &files(&[("b.obj", obj), ("a.ron", ron("b.obj").as_bytes())]));
    assert_eq!(told.status, 200, "{}", told.body);
    for name in ["../a.obj", "/a.obj", "a/b.obj", "-.obj", ".obj", ""] {
        let told = lab.post("/scenes", &files(&[(name, b"v 0 0 0\n")]));
        assert!(told.status == 422 && told.body.contains("is no name of a file"), "{name}: {}", told.body);
    }
}

#[test]
fn scenes_have_a_limit() {
    let lab = Lab::start("--max-upload 1");
    let large = "# nothing\n".repeat(200_000);
    let told = lab.post("/scenes", &files(&[("large.obj", large.as_bytes())]));
    assert_eq!(told.status, 413);
    assert!(told.body.contains("up to 1 Mbyte") || told.body.is_empty(), "{}", told.body);
    assert_eq!(lab.get("/run?scene=room&size=4x4").status, 200, "the lab goes on");
}

#[test]
fn other_sites_get_nothing() {
    let lab = Lab::start("");
    let host = &lab.host;
    let port = host.rsplit(':').next().unwrap();
    let status = |path: &str, lines: &str| lab.ask(&format!("GET {path} HTTP/1.1\r\n{lines}"), "").status;
    assert_eq!(status("/", &format!("Host: {host}\r\n")), 200);
    assert_eq!(status("/", &format!("Host: localhost:{port}\r\n")), 200);
    assert_eq!(status("/run?size=4x4", &format!("Host: {host}\r\nOrigin: http://{host}\r\n")), 200);
    for foreign in [
        "example.org",
        &format!("example.org:{port}"),
        "127.0.0.1",
        "127.0.0.1:1",
        &format!("127.0.0.1.example.org:{port}"),
    ] {
        assert_eq!(status("/", &format!("Host: {foreign}\r\n")), 403, "{foreign}");
    }
    for foreign in ["http://example.org", "null", &format!("https://{host}"), &format!("http://{host}.example.org")] {
        assert_eq!(status("/run", &format!("Host: {host}\r\nOrigin: {foreign}\r\n")), 403, "{foreign}");
    }
    assert_eq!(status("/run", &format!("Host: {host}\r\nSec-Fetch-Site: cross-site\r\n")), 403);
    assert_eq!(
        status("/", &format!("Host: {host}\r\nSec-Fetch-Site: cross-site\r\n")),
        200,
        "a lecture can link to it"
    );
    assert_eq!(status("/run?size=4x4", &format!("Host: {host}\r\nSec-Fetch-Site: same-origin\r\n")), 200);
    let page = lab.get("/");
    assert!(page.head.contains("frame-ancestors 'self'") && page.head.contains("nosniff"), "{}", page.head);
    assert!(!page.body.contains("https://") && !page.body.contains("http://"), "it asks the network for nothing");
    assert_eq!(lab.get("/secret.html").status, 404);
}

#[test]
fn a_sweep_is_the_commands_table_point_by_point() {
    let (lab, folder) = (Lab::start(""), Folder::new());
    let sweep = json!({ "scene": "room", "size": "12x12", "mode": "broadcast", "cells": 4, "fifo_words": [1, 4, 512] });
    let events = lab.post("/sweep", &sweep).events();
    let names: Vec<&str> = events.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["columns", "point", "point", "point", "done"]);
    folder.file("sweep.ron", r#"(scene: "room", size: "12x12", mode: "broadcast", cells: 4, fifo_words: [1, 4, 512])"#);
    folder.run("sweep sweep.ron -o table.csv").success();
    let mut rows: Vec<String> = events[1..4]
        .iter()
        .map(|(_, data)| {
            let row = serde_json::from_str::<Value>(data).unwrap()["row"].clone();
            row.as_array().unwrap().iter().map(|cell| cell.as_str().unwrap().to_owned()).collect::<Vec<_>>().join(",")
        })
        .collect();
    rows.sort();
    let mut table: Vec<String> = folder.read("table.csv").lines().skip(1).map(str::to_owned).collect();
    table.sort();
    assert_eq!(rows, table);
    let refused = |sweep: Value| {
        let answer = lab.post("/sweep", &sweep);
        assert_eq!(answer.status, 422, "{}", answer.body);
        answer.body
    };
    assert!(refused(json!({ "fifo_wrods": [1] })).contains("unknown parameter"));
    assert!(refused(json!({ "fifo_words": { "from": 1, "to": 5000, "step": 1 } })).contains("up to 1000"));
    for of_others in [
        json!({ "farm": true }),
        json!({ "on": "ipsc2", "mode": "regions" }),
        json!({ "image": true }),
        json!({ "samples": [2, 4] }),
        json!({ "host_hit_us": 1 }),
    ] {
        assert!(refused(of_others).contains("are of arrays, without images"));
    }
    // Each of its runs is one that the lab would do.
    for sizes in [json!("4096x4096"), json!([16, [[4096]]]), json!({ "from": 1024, "to": 4096, "times": 2 })] {
        assert!(refused(json!({ "scene": "tetra", "size": sizes })).contains("at most 4194304 pixels"));
    }
}

/// However deep it stands in lists, no value is taken for a file's name.
#[test]
fn a_sweep_reads_no_file() {
    let (lab, folder) = (Lab::start(""), Folder::new());
    let scene = folder.file("secret.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").display().to_string();
    let own = std::fs::read_dir(lab.places.path()).unwrap().next().unwrap().unwrap().path().join("../secret.obj");
    let up = format!("../../../../..{scene}");
    for path in [&scene, &up, &own.display().to_string(), "/etc/passwd", "./secret.obj", "secret.obj", "-.obj"] {
        let nested =
            [json!(path), json!([path]), json!([[path]]), json!([["room", [[path]]], "room"]), json!({ "from": path })];
        for values in nested {
            for name in ["scene", "program", "machine", "rays", "cell_programs"] {
                let told = lab.post("/sweep", &json!({ "size": 4, name: values }));
                assert_eq!(told.status, 422, "{name} {values}: {}", told.body);
                let is_refused =
                    ["names a file", "is not at hand", "invalid type"].iter().any(|why| told.body.contains(why));
                assert!(is_refused, "{name} {values}: {}", told.body);
            }
        }
    }
    // The standard programs are no files, whatever lies about.
    folder.file("broadcast", "no program");
    let flags = "--scene tetra --size 4x4 --cells 2 --json";
    let named = folder.run(&format!("{flags} --program broadcast")).success();
    let (named, moded): (Value, Value) = (
        serde_json::from_str(&named).unwrap(),
        serde_json::from_str(&folder.run(&format!("{flags} --mode broadcast")).success()).unwrap(),
    );
    assert_eq!(named["cycles"], moded["cycles"]);
    assert!(folder.run("--program ./broadcast").refused().contains("broadcast"));
}

/// Where the lab keeps a dropped scene is nobody's affair: it is named as by its user, in all that is told.
#[test]
fn a_dropped_scene_has_its_own_name_everywhere() {
    let (lab, folder) = (Lab::start(""), Folder::new());
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.4 0.3 0\nv 0 1 0\nf 1 2 3 4 5\n";
    folder.file("a.obj", obj);
    let taken = lab.post("/scenes", &files(&[("a.obj", obj.as_bytes())]));
    let scene = serde_json::from_str::<Value>(&taken.body).unwrap()["scene"].clone();
    let own = |answer: &Answer| {
        assert!(!answer.body.contains(lab.places.path().to_str().unwrap()), "{}", answer.body);
        assert!(!answer.body.contains("pcs-sim-lab-"), "{}", answer.body);
    };
    let run = lab.get(&format!("/run?scene={}&size=8x8", scene.as_str().unwrap()));
    own(&run);
    let stats: Value = serde_json::from_str(&folder.run("--scene a.obj --size 8x8 --json").success()).unwrap();
    assert_eq!(run.done()["stats"], stats);
    // A memory that is too small makes the points fail, with a reason.
    for memory in [100_000, 1] {
        let sweep = json!({ "scene": scene, "size": 8, "fifo_words": [4, 8], "memory_words": memory });
        let answer = lab.post("/sweep", &sweep);
        own(&answer);
        let columns: Value = serde_json::from_str(&answer.event("columns")).unwrap();
        assert!(columns["file"].as_str().unwrap().contains("scene: \"a.obj\""), "{columns}");
        let point: Value = serde_json::from_str(&answer.event("point")).unwrap();
        assert_eq!(point["row"][0], "a.obj");
    }
}

#[test]
fn two_runs_are_compared_as_by_the_command() {
    let (lab, folder) = (Lab::start(""), Folder::new());
    let [a, b] =
        ["size=8x8", "size=8x8&grid_voxel=3.9"].map(|query| lab.get(&format!("/run?scene=room&{query}")).done());
    let told = lab.post("/compare", &json!({ "a": a["stats"], "b": b["stats"] })).body;
    folder.file("a.json", a["stats"].to_string());
    folder.file("b.json", b["stats"].to_string());
    let compared = folder.run("compare a.json b.json");
    assert_eq!(compared.status, 1);
    assert!(compared.stdout.ends_with(&told), "{told}");
}

#[test]
fn what_is_compared_and_what_is_swept_have_limits() {
    let lab = Lab::start("");
    let stats = lab.get("/run?scene=tetra&size=2x2&mode=broadcast&cells=4096").done()["stats"].clone();
    assert!(stats.to_string().len() > 1_000_000);
    let told = lab.post("/compare", &json!({ "a": stats, "b": stats }));
    assert_eq!(told.status, 200, "{}", told.body);
    let long = "x".repeat(33_000_000);
    let refused = |path: &str, body: &Value, why: &str| {
        let told = lab.post(path, body);
        assert_eq!(told.status, 413, "{path}: {}", told.body);
        // A client that goes on writing may find the connection closed before it reads.
        assert!(told.body.contains(why) || told.body.is_empty(), "{}", told.body);
    };
    refused("/compare", &json!({ "a": long, "b": 1 }), "`pcs-sim compare` takes more");
    refused("/sweep", &json!({ "scene": long[..2_000_000] }), "`pcs-sim sweep` takes longer ones");
    assert_eq!(lab.get("/run?scene=room&size=4x4").status, 200, "the lab goes on");
}

/// What holds in each cycle of a run: the levels of its FIFOs, and what everybody is at.
struct Cycle {
    levels: Vec<Words>,
    /// The host's, then the cells'.
    kinds: Vec<StateKind>,
}

fn cycles_of(recording: &Recording) -> Vec<Cycle> {
    assert_eq!(recording.window, Cycles(0)..recording.cycles, "it has all of the run");
    let kind = |station: &StationMoment| recording.topology.states.get(station.stretch.state).unwrap().kind;
    let cycle = |at: u64| {
        let Moment { host, stations, levels, .. } = recording.moment(Cycles(at)).unwrap();
        Cycle { levels, kinds: host.iter().chain(&stations).map(kind).collect() }
    };
    (0..recording.cycles.0).map(cycle).collect()
}

/// All that can be sought, against a look at each cycle.
#[test]
fn moments_are_found_wherever_they_are() {
    let lab = Lab::start("");
    let query = "scene=tetra&size=4x4&mode=hybrid&cells=4&fifo_words=8";
    let (_, recording) = recorded(lab.get(&format!("/run?{query}")).done()["stats"].clone());
    let cycles = cycles_of(&recording);
    let found = |after: usize, what: &str| {
        let answer = lab.get(&format!("/find/{after}/{what}?{query}"));
        assert_eq!(answer.status, 200, "{}", answer.body);
        serde_json::from_str::<Value>(&answer.body).unwrap()
    };
    let begins = |after: usize, holds: &dyn Fn(&Cycle) -> bool| {
        (after + 1..cycles.len()).find(|&at| holds(&cycles[at]) && !holds(&cycles[at - 1]))
    };
    let mut some = 0;
    let mut check = |what: &str, holds: &dyn Fn(&Cycle) -> bool| {
        for after in [0, cycles.len() / 3, cycles.len() - 1] {
            let expected = begins(after, holds);
            some += usize::from(expected.is_some());
            assert_eq!(found(after, what), json!(expected), "{what} after {after}");
        }
    };
    for (place, fifo) in recording.topology.fifos.iter().enumerate() {
        check(&format!("{}/full", fifo.name), &|cycle| Some(cycle.levels[place]) == fifo.capacity);
        check(&format!("{}/empty", fifo.name.to_lowercase()), &|cycle| cycle.levels[place] == Words(0));
    }
    let kinds = [
        ("waits", StateKind::Waits),
        ("blocked", StateKind::Blocked),
        ("works", StateKind::Works),
        ("moves", StateKind::Moves),
    ];
    for (name, kind) in kinds {
        check(&format!("host/{name}"), &|cycle| cycle.kinds[0] == kind);
        for cell in 0..4 {
            check(&format!("cell/{cell}/{name}"), &|cycle| cycle.kinds[cell + 1] == kind);
        }
    }
    assert!(some > 40, "{some}");
    for ray in [0, 7, 15] {
        let when = |jobs: &[pcs_sim::measure::JobSpan]| json!(jobs.iter().find(|span| span.job == ray).unwrap().from.0);
        assert_eq!(found(0, &format!("ray/{ray}")), when(&recording.host.as_ref().unwrap().jobs));
        assert_eq!(found(0, &format!("ray/{ray}/back")), when(&recording.answers));
        for (cell, station) in recording.stations.iter().enumerate() {
            assert_eq!(found(0, &format!("ray/{ray}/cell/{cell}")), when(&station.jobs), "ray {ray}, cell {cell}");
        }
    }
    for nowhere in ["X99/full", "cell/99/waits", "ray/16", "ray/16/back", "ray/0/cell/4"] {
        assert_eq!(found(0, nowhere), Value::Null, "{nowhere}");
    }
    for wrong in ["X1", "X1/fuller", "cell/x/waits", "ray", "ray/-1", "ray/0/cell"] {
        let answer = lab.get(&format!("/find/0/{wrong}?{query}"));
        assert!(answer.status == 422 && answer.body.contains("no moment is called"), "{wrong}: {}", answer.body);
    }
    for (from, until) in [(5, 5), (6, 5)] {
        let answer = lab.get(&format!("/window/{from}/{until}?{query}"));
        assert!(answer.status == 422 && answer.body.contains("at least one cycle"), "{}", answer.body);
    }
}

#[test]
fn pixels_have_their_rays_in_any_order_and_none_where_none_is_sent() {
    let lab = Lab::start("");
    for order in ["raster", "columns", "tiles:2", "hilbert", "stride", "shuffle:3"] {
        for rectangles in ["off", "objects"] {
            let query = format!("scene=teapot&size=8x6&order={order}&screen_rectangles={rectangles}");
            let run = lab.get(&format!("/run?{query}"));
            let (setup, _) = recorded(run.done()["stats"].clone());
            let rays = setup.prepared.rays.len();
            assert_eq!(rays < 48, rectangles == "objects", "{rays} rays");
            let numbers: Vec<usize> = (0..rays).map(|place| setup.prepared.number(place)).collect();
            for pixel in 0..48 {
                let told = lab.get(&format!("/ray/{}/{}?{query}", pixel % 8, pixel / 8)).body;
                let expected = numbers.iter().position(|&number| number == pixel);
                assert_eq!(told, json!(expected).to_string(), "{query}, pixel {pixel}");
            }
            // The picture is whole, whichever rays are sent and when.
            let image = |answer: &Answer| {
                answer.event("text").split("base64,").nth(1).unwrap().split('"').next().unwrap().to_owned()
            };
            assert_eq!(image(&run), image(&lab.get("/run?scene=teapot&size=8x6")), "{query}");
        }
    }
    for outside in ["/ray/8/0", "/ray/0/6"] {
        assert_eq!(lab.get(&format!("{outside}?scene=teapot&size=8x6")).body, "null");
    }
}

#[test]
fn rays_are_looked_at_and_their_instructions_told() {
    let lab = Lab::start("");
    let query = "scene=tetra&size=6x5&mode=hybrid&cells=4&cells_run=programs";
    let run = lab.get(&format!("/run?{query}"));
    let (setup, _) = recorded(run.done()["stats"].clone());
    let looks: Value = serde_json::from_str(&run.event("looks")).unwrap();
    let told = |path: &str| serde_json::from_str::<Value>(&lab.get(&format!("{path}?{query}")).body).unwrap();
    for ray in [0, 13, 29] {
        let look = told(&format!("/look/{ray}"));
        assert_eq!(look, serde_json::from_str::<Value>(&page::look(&setup, ray).unwrap()).unwrap());
        for cell in 0..4 {
            let steps = told(&format!("/instructions/{cell}/{ray}"));
            assert_eq!(steps, serde_json::from_str::<Value>(&page::instructions(&setup, cell, ray).unwrap()).unwrap());
        }
    }
    // What the run told of its first ray is that too.
    assert_eq!(told("/look/0")["look"], looks["visits"]["0"]);
    assert_eq!(told("/instructions/1/0"), looks["instructions"]["1 0"]);
    for nothing in ["/look/30", "/instructions/4/0", "/instructions/0/30"] {
        assert_eq!(told(nothing), Value::Null, "{nothing}");
    }
    assert_eq!(lab.get("/instructions/0/0?scene=tetra&size=6x5").body, "null", "cells that run no programs");
}

/// What the page says holds where nothing is set: setting it changes nothing, and the help says the same.
#[test]
fn the_defaults_of_the_controls_are_the_commands() {
    let lab = Lab::start("");
    let page = lab.get("/").body;
    let between = |text: &str, from: &str, to: &str| Some(text.split_once(from)?.1.split_once(to)?.0.to_owned());
    let mut told = 0;
    for row in page.split("<div class=\"control\"").skip(1) {
        let attribute = |name: &str| between(row, &format!(" data-{name}=\""), "\"").unwrap();
        let (name, default) = (attribute("name"), attribute("default"));
        // `X`, or `the machine file's; X in the standard one`: other words tell on what it depends.
        let said = between(row, "[default: ", "]").map(|said| {
            let of_standard = said.rsplit("; ").next().unwrap();
            of_standard.split(" in the standard one").next().unwrap().to_owned()
        });
        let is_value = |said: &String| !said.contains(' ') && said != "none" && said != "fifo_words";
        if let Some(said) = said.filter(is_value) {
            assert_eq!(default, said, "{name}");
            told += 1;
        }
        if default.is_empty() {
            continue;
        }
        let base = match name.as_str() {
            "scene" => "size=4x4",
            "size" => "scene=tetra",
            _ => "scene=tetra&size=4x4",
        };
        let [set, unset] = [format!("{base}&{name}={default}"), base.to_owned()].map(|query| {
            let mut done = lab.get(&format!("/run?{query}")).done();
            (done["cycles"].take(), done["title"].take(), done["bottleneck"].take(), done["stats"]["cells"].take())
        });
        assert_eq!(set, unset, "{name}");
    }
    assert!(told > 15, "{told}");
}

/// What a process has, as Linux tells it.
#[cfg(target_os = "linux")]
#[derive(Debug)]
struct Held {
    threads: usize,
    files: usize,
    kilobytes: usize,
}

#[cfg(target_os = "linux")]
impl Held {
    fn by(lab: &Lab) -> Held {
        let folder = format!("/proc/{}", lab.pid());
        let status = std::fs::read_to_string(format!("{folder}/status")).unwrap();
        let number = |name: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(name)).unwrap();
            line.split_whitespace().next().unwrap().parse().unwrap()
        };
        let files = std::fs::read_dir(format!("{folder}/fd")).unwrap().count();
        Held { threads: number("Threads:"), files, kilobytes: number("VmRSS:") }
    }

    /// What it has once its threads are those that stay: others end after a second without work.
    fn at_rest(lab: &Lab) -> Held {
        let mut last = Held::by(lab);
        loop {
            std::thread::sleep(Duration::from_millis(1200));
            let held = Held::by(lab);
            if held.threads == last.threads && held.files == last.files {
                return held;
            }
            last = held;
        }
    }

    /// What it has once it has no more threads and files than before.
    fn settled(lab: &Lab, before: &Held) -> Held {
        let begun = Instant::now();
        loop {
            let held = Held::by(lab);
            if held.threads <= before.threads && held.files <= before.files || begun.elapsed() > Duration::from_secs(60)
            {
                return held;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn who_goes_away_stops_what_they_have_asked_for() {
    let lab = Lab::start("");
    lab.get("/run?scene=room&size=4x4").done();
    let before = Held::at_rest(&lab);
    // Cells that execute each instruction: it would take minutes, and what is left of it is waited for only one.
    let query = "scene=reference&size=2048x2048&mode=broadcast&cells=64&cells_run=programs";
    let head = format!("GET /run?{query} HTTP/1.1\r\nHost: {}\r\n", lab.host);
    let mut stream = lab.send(&head, "");
    let (mut heard, mut bytes) = (String::new(), [0; 4096]);
    while !heard.contains("event: progress") {
        let count = stream.read(&mut bytes).unwrap();
        assert!(count > 0, "{heard}");
        heard += &String::from_utf8_lossy(&bytes[..count]);
    }
    assert!(Held::by(&lab).threads > before.threads);
    drop(stream);
    let after = Held::settled(&lab, &before);
    assert!(after.threads <= before.threads && after.files <= before.files, "{before:?} {after:?}");
}

/// Twenty at once, as who goes along a run quickly asks for them: a few are worked on, and all are answered, but those that are given up.
#[cfg(target_os = "linux")]
#[test]
fn moments_are_looked_up_a_few_at_a_time() {
    let lab = Lab::start("");
    let query = "scene=teapot&size=128x128&mode=hybrid&cells=4&fifo_words=16";
    lab.get(&format!("/run?{query}")).done();
    let before = Held::at_rest(&lab);
    let ask = |from: u64| {
        lab.send(&format!("GET /window/{from}/{}?{query} HTTP/1.1\r\nHost: {}\r\n", from + 1_000_000, lab.host), "")
    };
    let mut most = 0;
    let mut asked: Vec<_> = (0..20).map(|at| ask(1_000_000 * at)).collect();
    let is_answered = |stream: &TcpStream| {
        stream.set_nonblocking(true).unwrap();
        let is_answered = stream.peek(&mut [0]).is_ok();
        stream.set_nonblocking(false).unwrap();
        is_answered
    };
    while !asked.iter().any(is_answered) {
        most = most.max(Held::by(&lab).threads);
    }
    // As the first one ends, its thread may still be there beside that of the next.
    assert!(before.threads < most && most <= before.threads + 6, "{before:?}, then {most}");
    for stream in &mut asked[..3] {
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        assert!(text.starts_with("HTTP/1.1 200"), "{text}");
    }
    // The others are given up.
    drop(asked);
    let after = Held::settled(&lab, &before);
    assert!(after.threads <= before.threads && after.files <= before.files, "{before:?} {after:?}");
}

/// Ten tabs, in which sliders are moved a thousand times, each time before the run before is over, for the most part.
#[cfg(target_os = "linux")]
#[test]
fn a_thousand_slider_moves_in_ten_tabs_leave_nothing_behind() {
    let lab = Lab::start("");
    let query = |tab: usize, at: usize| {
        let mode = ["pipeline", "broadcast", "hybrid"][(tab + at / 20) % 3];
        format!("/run?scene=teapot&size=64x64&mode={mode}&fifo_words={}&grid_coefficient={}", 1 + at % 600, 5 + at % 7)
    };
    let move_sliders = |moves: usize| {
        std::thread::scope(|scope| {
            for tab in 0..10 {
                let (lab, query) = (&lab, &query);
                scope.spawn(move || {
                    for at in 0..moves / 10 {
                        let head = format!("GET {} HTTP/1.1\r\nHost: {}\r\n", query(tab, at), lab.host);
                        let mut stream = lab.send(&head, "");
                        // The last one of every ten is waited for.
                        if at % 10 == 9 {
                            let mut bytes = Vec::new();
                            stream.read_to_end(&mut bytes).unwrap();
                            assert!(String::from_utf8_lossy(&bytes).contains("event: done"), "tab {tab}, move {at}");
                        } else {
                            std::thread::sleep(Duration::from_millis(at as u64 % 7));
                        }
                    }
                });
            }
        });
        std::thread::sleep(Duration::from_millis(1500));
    };
    // Threads that share work are there from the first run on.
    lab.get(&query(0, 0)).done();
    let at_first = Held::at_rest(&lab);
    move_sliders(1000);
    let before = Held::settled(&lab, &at_first);
    move_sliders(1000);
    let after = Held::settled(&lab, &at_first);
    println!("at first {at_first:?}, after 1000 moves {before:?}, after 1000 more {after:?}");
    assert!(after.threads <= at_first.threads && after.files <= at_first.files, "{at_first:?} {after:?}");
    // What is kept of runs has a bound, and so has what ten runs take at once: how much that is, is chance, and what the allocator
    // gives back of it is its own affair. A run's page alone is a megabyte: were those kept, a thousand more would be a gigabyte.
    assert!(after.kilobytes < before.kilobytes + (512 << 10), "{before:?} {after:?}");
}
