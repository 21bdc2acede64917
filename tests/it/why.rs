//! `pcs-sim why`, and `--why` beside a run, an image and a replay.

use crate::support::command::Folder;
use serde_json::Value;

fn stats(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&folder.read(name)).unwrap()
}

fn sum(parts: &Value) -> u64 {
    parts.as_array().unwrap().iter().map(|part| part["cycles"].as_u64().unwrap()).sum()
}

#[test]
fn tells_the_parts_of_a_run() {
    let told = Folder::new().run("why --mode pipeline --scene teapot --size-factor 3 --size 16x16").success();
    insta::assert_snapshot!(told);
}

#[test]
fn tells_the_parts_of_each_cell() {
    let run = "why --mode broadcast --cells 3 --scene room --size 16x16 --link-mb-s 20 --fifo-words 8 --by-cell";
    insta::assert_snapshot!(Folder::new().run(run).success());
}

#[test]
fn tells_classes_of_instructions() {
    let run = "why --mode pipeline --scene teapot --size-factor 3 --size 8x8 --cells-run programs";
    insta::assert_snapshot!(Folder::new().run(run).success());
}

/// Times and parts sum to the run, whoever is asked, and a replay's are the run's.
#[test]
fn sums_to_the_run_in_statistics() {
    for mode in ["--mode pipeline", "--mode broadcast --cells 5 --link-mb-s 30", "--mode hybrid --stop-words 3"] {
        let folder = Folder::new();
        let run = format!("{mode} --scene teapot --size-factor 4 --size 24x18");
        folder.run(&format!("{run} --why --ops a.ops --stats run.json")).success();
        let why = &stats(&folder, "run.json")["why"];
        assert_eq!(sum(&why["times"]), stats(&folder, "run.json")["cycles"].as_u64().unwrap(), "{mode}");
        assert_eq!(sum(&why["parts"]), sum(&why["times"]), "{mode}");
        for command in ["replay a.ops --why", "why a.ops"] {
            let machine = if mode.contains("30") { "--link-mb-s 30" } else { "" };
            folder.run(&format!("{command} {machine} --force --stats replay.json")).success();
            assert_eq!(&stats(&folder, "replay.json")["why"], why, "{mode}: {command}");
        }
        folder.run(&format!("{run} --stats plain.json")).success();
        let mut told = stats(&folder, "run.json");
        told.as_object_mut().unwrap().remove("why");
        assert_eq!(told, stats(&folder, "plain.json"), "nothing else changes");
    }
}

/// An image's path is that of a replay of its ops, which keeps the host's order; what the host does is on it.
#[test]
fn tells_the_parts_of_an_image() {
    let folder = Folder::new();
    let machine = "--host-ray-us 40 --host-hit-us 200 --in-flight 3";
    let run = format!("image room -o a.png --size 12x12 {machine} --why --ops a.ops --stats image.json");
    let told = folder.run(&run).success();
    assert!(told.contains("in the order in\nwhich it sent them"), "{told}");
    let image = stats(&folder, "image.json");
    assert_eq!(sum(&image["why"]["times"]), image["cycles"].as_u64().unwrap());
    folder.run("why a.ops --stats replay.json").success();
    assert_eq!(stats(&folder, "replay.json")["why"], image["why"]);
    let names: Vec<&str> =
        image["why"]["times"].as_array().unwrap().iter().map(|time| time["time"].as_str().unwrap()).collect();
    assert!(names.contains(&"host_ray") && names.contains(&"host_hit"), "{names:?}");
    let refused = folder.run("image room -o b.png --size 12x12 --timing off --why").refused();
    assert!(refused.contains("--why is about the machine at work"), "{refused}");
}

#[test]
fn shows_where_the_path_is_over_time() {
    let folder = Folder::new();
    let run = "--mode broadcast --cells 3 --scene teapot --size-factor 3 --size 12x12 --page a.html --plot plots";
    folder.run(&format!("{run} --why")).success();
    let [page, plot] = ["a.html", "plots/critical-path.svg"].map(|name| folder.read(name));
    assert!(page.contains("The critical path: ") && page.contains("What the run's length is made of"));
    assert!(plot.contains("Where the critical path is, and why") && plot.contains("cell 2"));
    folder.run(&format!("{run} --force")).success();
    assert!(!folder.read("a.html").contains("The critical path: "));
}

#[test]
fn refuses_what_a_trace_would_not_look_at() {
    let folder = Folder::new();
    folder.run("--mode pipeline --scene room --size 4x4 --ops a.ops").success();
    for flag in ["--scene teapot", "--mode broadcast", "--size 3x3", "--hits h.csv", "--threads 2"] {
        let refused = folder.run(&format!("why a.ops {flag}")).refused();
        let name = flag.split(' ').next().unwrap();
        assert!(refused.contains(&format!("{name} is about tracing a scene")), "{refused}");
    }
}

/// What is said to be saved by a tenth less is saved, where the path stays the same.
#[test]
fn a_tenth_less_saves_what_it_says() {
    let folder = Folder::new();
    let run = "--mode pipeline --scene teapot --size-factor 3 --size 16x16";
    folder.run(&format!("why {run} --grid-voxel 10 --stats a.json")).success();
    folder.run(&format!("{run} --grid-voxel 9 --stats b.json")).success();
    let (a, b) = (stats(&folder, "a.json"), stats(&folder, "b.json"));
    let time = |time: &&Value| time["time"] == "grid_voxel";
    let voxels = a["why"]["times"].as_array().unwrap().iter().find(time).unwrap();
    let saved = a["cycles"].as_u64().unwrap() - b["cycles"].as_u64().unwrap();
    assert_eq!(saved, voxels["cycles"].as_u64().unwrap() / 10);
}

/// A cell that waits, and the chain of those that it waits for, down to one that works.
#[test]
fn tells_who_waits_for_whom() {
    let folder = Folder::new();
    folder
        .run("--mode broadcast --cells 4 --scene teapot --size-factor 3 --size 16x16 --fifo-words 16 --ops a.ops")
        .success();
    let machine = "--fifo-words 16";
    insta::assert_snapshot!(folder.run(&format!("why a.ops {machine} --cell 0 --ray 100")).success());
    insta::assert_snapshot!(folder.run(&format!("why a.ops {machine} --cell host --at 2ms")).success());
    let refused = |flags: &str| folder.run(&format!("why a.ops {machine} {flags}")).status;
    for flags in
        ["--cell 0", "--at 5", "--cell 0 --at 5 --ray 3", "--cell x --at 5", "--cell 0 --at -5", "--cell 9 --at 5"]
    {
        assert_eq!(refused(flags), 2, "{flags}");
    }
    for (flags, why) in [
        ("--cell 9 --at 5", "there is no cell 9: the array has 4"),
        ("--cell 0 --at 99s", "the run is over before cycle 1980000000"),
        ("--cell 0 --ray 256", "cell 0 does nothing for that ray"),
        ("--cell host --ray 3", "a ray is looked for in a cell"),
        ("--cell 2", "--cell is about one moment"),
    ] {
        let stderr = folder.run(&format!("why a.ops {machine} {flags}")).refused();
        assert!(stderr.contains(why), "{stderr}");
    }
}
