//! A run's layers: whoever changes one thing redoes only what reads it, and gets what a whole run gives.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;

use pcs_sim::cancel::Cancel;
use pcs_sim::run::{self, Keys, Layers, PlannedRun, RecordingMemory, RunError, RunOptions, RunSpec, Watching, Workers};

use crate::support::command::Folder;

/// The first layer that is another one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Layer {
    Scene,
    Prepared,
    LaidOut,
    Traced,
    Timed,
    None,
}

fn planned(parameters: &[(&str, &str)]) -> PlannedRun {
    let mut options = RunOptions::default();
    for (name, value) in parameters {
        options.set(name, value).unwrap();
    }
    PlannedRun::new(RunSpec::new(&options, None).unwrap()).unwrap()
}

fn first_change(a: &Keys, b: &Keys) -> Layer {
    let layers = [
        (a.scene == b.scene, Layer::Scene),
        (a.prepared == b.prepared, Layer::Prepared),
        (a.laid_out == b.laid_out, Layer::LaidOut),
        (a.traced == b.traced, Layer::Traced),
        (a.timed == b.timed, Layer::Timed),
    ];
    let first = layers.iter().position(|(same, _)| !same);
    // A layer is made of the one before it.
    assert!(first.is_none_or(|first| layers[first..].iter().all(|(same, _)| !same)), "{layers:?}");
    first.map_or(Layer::None, |first| layers[first].1)
}

/// Each parameter with another value than its own, and the first layer that reads it, in a run that reads them all.
const CHANGES: &[(&str, &str, Layer)] = &[
    ("scene", "room", Layer::Scene),
    ("size_factor", "4", Layer::Scene),
    ("resolution", "9", Layer::Scene),
    ("size", "8x8", Layer::Prepared),
    ("rays", "some.csv", Layer::Prepared),
    ("order", "stride", Layer::Prepared),
    ("screen_rectangles", "objects", Layer::Prepared),
    ("mode", "pipeline", Layer::LaidOut),
    ("cells", "4", Layer::LaidOut),
    ("groups", "3", Layer::LaidOut),
    ("partition", "polygons", Layer::LaidOut),
    ("numbering", "front", Layer::LaidOut),
    ("grid_coefficient", "20", Layer::LaidOut),
    ("mailbox", "true", Layer::Traced),
    ("stop_words", "3", Layer::Traced),
    ("forward_ahead", "2", Layer::Traced),
    ("rays_per_message", "2", Layer::Traced),
    ("message_us", "1", Layer::Traced),
    ("bounded_walk", "true", Layer::Traced),
    ("masks", "boxes", Layer::Traced),
    ("edges", "closed", Layer::Prepared),
    ("cells_run", "programs", Layer::Traced),
    ("clock_ns", "25", Layer::Timed),
    ("word_bytes", "8", Layer::Timed),
    ("fifo_words", "64", Layer::Timed),
    ("link_mb_s", "20", Layer::Timed),
    ("rate_counts", "channel", Layer::Timed),
    ("latency_cycles", "3", Layer::Timed),
    ("memory_words", "1000000", Layer::Timed),
    ("x_fifo_words", "32", Layer::Timed),
    ("y_fifo_words", "32", Layer::Timed),
    ("z_fifo_words", "32", Layer::Timed),
    ("host_ray_us", "1", Layer::Timed),
    ("host_hit_us", "1", Layer::Timed),
    ("host_filter_us", "1", Layer::Timed),
    ("host_mask_us", "1", Layer::Timed),
    ("grid_start", "1", Layer::Timed),
    ("grid_voxel", "1", Layer::Timed),
    ("slabs_start", "1", Layer::Timed),
    ("slabs_polygon", "1", Layer::Timed),
    ("intersection_start", "2", Layer::Timed),
    ("intersection_polygon", "1", Layer::Timed),
];

#[test]
fn each_parameter_changes_the_layers_that_read_it_and_no_other() {
    let changes: BTreeMap<&str, (&str, Layer)> =
        CHANGES.iter().map(|&(name, value, layer)| (name, (value, layer))).collect();
    // Of files, and of cells that run programs: below. Another machine than the array has layers of its own.
    let elsewhere = ["program", "machine", "cell_programs", "instruction_limit", "early_slabs", "stepped_walk", "on"];
    for parameter in RunOptions::parameters().filter(|parameter| !elsewhere.contains(&parameter.name)) {
        let &(value, layer) = changes.get(parameter.name).unwrap_or_else(|| panic!("no row for {}", parameter.name));
        let mut parameters = vec![("scene", "balls"), ("mode", "hybrid"), ("groups", "2")];
        // Whatever is given last counts; groups and cells, mode and rays cannot both be given.
        parameters.retain(|(name, _)| *name != parameter.name && (*name, parameter.name) != ("groups", "cells"));
        if parameter.name == "mode" {
            parameters.retain(|(name, _)| *name != "groups");
        }
        let before = planned(&[("scene", "balls"), ("mode", "hybrid"), ("groups", "2")]);
        // Four cells are the two groups that there are.
        let layer = if parameter.name == "cells" { Layer::None } else { layer };
        parameters.push((parameter.name, value));
        assert_eq!(first_change(&before.keys, &planned(&parameters).keys), layer, "{}", parameter.name);
    }
}

/// Times are in cycles, and know of rates only what these make in cycles. They do know between which words these count.
#[test]
fn rates_that_are_the_same_in_cycles_are_the_same() {
    let on = |rate: &str, counts: &str| planned(&[("link_mb_s", rate), ("rate_counts", counts)]).keys;
    assert_eq!(first_change(&on("75", "link"), &on("60", "link")), Layer::None);
    assert_eq!(first_change(&on("75", "link"), &on("39", "link")), Layer::Timed);
    assert_eq!(first_change(&on("75", "link"), &on("75", "channel")), Layer::Timed);
    let words = |bytes: &str, rate: &str| planned(&[("word_bytes", bytes), ("link_mb_s", rate)]).keys;
    assert_eq!(first_change(&words("4", "80"), &words("8", "160")), Layer::None);
}

/// Prices are read by the cut that weighs work by them, and by that alone.
#[test]
fn a_cut_by_work_reads_the_times_that_it_weighs_by() {
    let base = [("mode", "broadcast"), ("cells", "8"), ("partition", "work")];
    let change =
        |name, value| first_change(&planned(&base).keys, &planned(&[&base[..], &[(name, value)]].concat()).keys);
    assert_eq!(change("grid_voxel", "1"), Layer::LaidOut);
    assert_eq!(change("intersection_polygon", "1"), Layer::LaidOut);
    assert_eq!(change("host_ray_us", "1"), Layer::Timed);
    assert_eq!(change("clock_ns", "25"), Layer::LaidOut);
    assert_eq!(change("fifo_words", "8"), Layer::Timed);
    // One group is not cut.
    let one = [("mode", "broadcast"), ("cells", "1")];
    let regular = planned(&[&one[..], &[("partition", "regular")]].concat());
    assert_eq!(first_change(&regular.keys, &planned(&[&one[..], &[("partition", "work")]].concat()).keys), Layer::None);
}

/// A cut that is measured in the parts reads all that their cells do; of an image it reads the light too, as a numbering from front to
/// back does.
#[test]
fn a_measured_cut_reads_what_the_cells_do() {
    let base = [("mode", "hybrid"), ("groups", "2"), ("partition", "measured")];
    let image = |parameters: &[(&str, &str)]| {
        let mut options = RunOptions::default();
        parameters.iter().for_each(|(name, value)| options.set(name, value).unwrap());
        PlannedRun::new(RunSpec::of_image(&options, None).unwrap()).unwrap().keys
    };
    let change = |name, value| {
        let changed = [&base[..], &[(name, value)]].concat();
        (first_change(&planned(&base).keys, &planned(&changed).keys), first_change(&image(&base), &image(&changed)))
    };
    for (name, value) in [("grid_start", "1"), ("mailbox", "true"), ("stop_words", "3"), ("bounded_walk", "true")] {
        assert_eq!(change(name, value), (Layer::LaidOut, Layer::LaidOut), "{name}");
    }
    assert_eq!(change("forward_ahead", "3").0, Layer::Traced);
    assert_eq!(change("fifo_words", "8").0, Layer::Timed);
    assert_eq!(change("depth", "1"), (Layer::None, Layer::LaidOut));
    let light = |base: &[(&str, &str)]| first_change(&image(base), &image(&[base, &[("depth", "1")]].concat()));
    assert_eq!(light(&[("mode", "broadcast"), ("partition", "work")]), Layer::Traced);
    assert_eq!(light(&[("mode", "broadcast"), ("numbering", "front")]), Layer::LaidOut);
}

/// Cells that run programs read what instructions cost, and not Figure 7's times.
#[test]
fn programs_read_the_costs_of_instructions() {
    let base = [("cells_run", "programs")];
    let change =
        |name, value| first_change(&planned(&base).keys, &planned(&[&base[..], &[(name, value)]].concat()).keys);
    assert_eq!(change("instruction_limit", "1000"), Layer::Traced);
    assert_eq!(change("early_slabs", "true"), Layer::Traced);
    assert_eq!(change("stepped_walk", "true"), Layer::Traced);
    assert_eq!(change("cell_programs", "some-folder"), Layer::Traced);
    assert_eq!(change("grid_voxel", "1"), Layer::None);
    assert_eq!(change("host_ray_us", "1"), Layer::Timed);
    let costing = |costs: &[(&str, u32)]| {
        let mut other = planned(&base).spec;
        let mut text = serde_json::to_value(&other.machine).unwrap();
        costs.iter().for_each(|&(class, cycles)| text["instruction_cycles"][class] = cycles.into());
        other.machine = serde_json::from_value(text).unwrap();
        PlannedRun::new(other).unwrap().keys
    };
    assert_eq!(first_change(&planned(&base).keys, &costing(&[("load", 99)])), Layer::Timed);
    // Where floating-point results have a latency, waits are counted, whatever it is.
    let latency = |cycles| costing(&[("float_latency", cycles)]);
    assert_eq!(first_change(&planned(&base).keys, &latency(0)), Layer::Traced);
    assert_eq!(first_change(&latency(0), &latency(28)), Layer::Timed);
}

/// A name tells nothing.
#[test]
fn a_programs_name_is_read_by_no_layer() {
    let run = planned(&[]);
    let mut spec = run.spec.clone();
    spec.program.name = "another".to_owned();
    spec.version = "another".to_owned();
    assert_eq!(first_change(&run.keys, &PlannedRun::new(spec).unwrap().keys), Layer::None);
}

/// Timed in step with its tracing, a run is what it is timed from its recording: those that get stuck and those that a cell outlives
/// among them, in one round and in many.
#[test]
fn what_is_timed_in_step_is_what_its_recording_gives() {
    let bases: &[&[(&str, &str)]] = &[
        &[("scene", "teapot"), ("size_factor", "3"), ("size", "30x30"), ("mode", "broadcast"), ("cells", "4")],
        &[("scene", "room"), ("size", "20x20"), ("mode", "pipeline"), ("stop_words", "16")],
        &[("scene", "tetra"), ("size_factor", "2"), ("size", "5x5"), ("cells_run", "programs")],
    ];
    let changes =
        [("fifo_words", "2"), ("fifo_words", "64"), ("link_mb_s", "3"), ("grid_voxel", "1"), ("host_ray_us", "90")];
    let workers = Workers::new(2);
    for base in bases {
        let runs: Vec<PlannedRun> = changes.iter().map(|change| planned(&[base, &[*change][..]].concat())).collect();
        assert!(runs.iter().all(|run| run.keys.traced == runs[0].keys.traced), "one recording");
        let machines: Vec<_> = runs.iter().map(|run| &run.machine).collect();
        let traced = Layers::default().traced(&runs[0], &workers).unwrap();
        let recorded = machines.iter().map(|machine| {
            let timed = traced.time(machine, &Watching::default(), &workers.cancel);
            timed.map(|(stats, _)| stats).map_err(|error| error.to_string())
        });
        let recorded: Vec<_> = recorded.collect();
        // Two at a time, or all; and again for those that a cell outlives.
        for (memory, rounds) in [(RecordingMemory(0), 2..=6), (RecordingMemory::UNBOUNDED, 1..=2)] {
            let step = Layers::default().timed_in_step(&runs[0], &machines, &workers, memory).unwrap();
            let times: Vec<_> = step.times.into_iter().map(|stats| stats.map_err(|error| error.to_string())).collect();
            assert_eq!((&times, step.counts), (&recorded, traced.counts()), "{base:?} {memory}");
            assert!(rounds.contains(&step.rounds), "{base:?} {memory}: {} rounds", step.rounds);
        }
        let fits = |memory: u64| {
            let kept = Layers::default().traced_within(&runs[0], &workers, RecordingMemory(memory)).unwrap();
            kept.is_some()
        };
        assert_eq!((fits(traced.bytes()), fits(traced.bytes() / 2)), (true, false), "{base:?}");
    }
}

/// Whatever the order of the changes, each run is what it is by itself, and nothing is made twice.
#[test]
fn layers_that_are_kept_give_what_a_whole_run_gives() {
    let base = [("scene", "teapot"), ("size_factor", "3"), ("size", "9x9")];
    let mut layers = Layers::default();
    let (mut scenes, mut last) = (Vec::new(), None);
    let changes: &[&[(&str, &str)]] = &[
        &[],
        &[("grid_voxel", "1")],
        &[("grid_voxel", "1"), ("fifo_words", "8")],
        &[("mailbox", "true")],
        &[("grid_coefficient", "5")],
        &[("size", "7x7")],
        &[("mode", "broadcast"), ("cells", "3")],
        &[("cells_run", "programs")],
        &[("cells_run", "programs"), ("host_ray_us", "20")],
        &[],
    ];
    for change in changes {
        let run = planned(&[&base[..], change].concat());
        let workers = Workers::new(2);
        let traced = layers.traced(&run, &workers).unwrap();
        let (stats, _) = traced.time(&run.machine, &Watching::default(), &workers.cancel).unwrap();
        let mut fresh = Layers::default();
        let workload = fresh.workload(&run, &workers.cancel).unwrap();
        let rays = &fresh.prepared(&run).unwrap().rays;
        let whole = run::run(&workload, &run.machine.spec, rays, &workers, |_| Ok::<_, Infallible>(())).unwrap();
        assert_eq!(
            (&stats, traced.counts(), traced.hits()),
            (&whole.stats, whole.counts, &whole.hits[..]),
            "{change:?}"
        );
        scenes.push(layers.scene(&run).unwrap());
        let same = last.replace((run.keys.traced.clone(), traced.clone()));
        if let Some((key, before)) = same {
            assert_eq!(key == run.keys.traced, Arc::ptr_eq(&before, &traced), "{change:?}");
        }
    }
    assert!(scenes.iter().all(|scene| Arc::ptr_eq(scene, &scenes[0])), "one scene");
}

#[test]
fn laying_out_can_be_stopped() {
    let cancel = Cancel::default();
    cancel.cancel();
    let run = planned(&[("scene", "reference")]);
    let stopped = Layers::default().workload(&run, &cancel).map(drop);
    assert!(matches!(RunError::<Infallible>::from(stopped.unwrap_err()), RunError::Cancelled(_)));
    // What was stopped is no result, and is done when it is asked for again.
    let mut layers = Layers::default();
    assert!(layers.workload(&run, &cancel).is_err());
    assert!(layers.workload(&run, &Cancel::default()).is_ok());
}

/// Statistics, or their configuration alone, repeat what they are of, to the bit.
#[test]
fn a_configuration_repeats_runs_images_replays_and_predictions() {
    let folder = Folder::new();
    let machine = "--fifo-words 64 --y-fifo-words 16 --grid-voxel 5 --link-mb-s 40 --host-ray-us 3";
    let scene = "--scene teapot --size-factor 3 --size 9x7";
    folder
        .run(&format!(
            "{scene} --mode broadcast --cells 3 --partition work {machine} --stats a.json --hits a.csv --ops a.ops"
        ))
        .success();
    folder.run("--config a.json --stats b.json --hits b.csv").success();
    assert_eq!(folder.read("a.json"), folder.read("b.json"));
    assert_eq!(folder.read("a.csv"), folder.read("b.csv"));
    let stats: serde_json::Value = serde_json::from_str(&folder.read("a.json")).unwrap();
    folder.file("configuration.json", stats["configuration"].to_string());
    folder.run("--config configuration.json --stats c.json").success();
    assert_eq!(folder.read("a.json"), folder.read("c.json"));

    folder
        .run(&format!(
            "image room -o a.png --size 8x8 --samples 2 --adaptive {machine} --policy primaries --stats ia.json"
        ))
        .success();
    folder.run("image --config ia.json -o b.png --stats ib.json").success();
    assert_eq!(folder.read("ia.json"), folder.read("ib.json"));
    assert_eq!(std::fs::read(folder.path("a.png")).unwrap(), std::fs::read(folder.path("b.png")).unwrap());

    folder.run("replay a.ops --grid-start 9 --latency-cycles 4 --stats ra.json").success();
    folder.run("replay --config ra.json --stats rb.json").success();
    assert_eq!(folder.read("ra.json"), folder.read("rb.json"));
    // A flag beside it changes that and nothing else.
    folder.run("replay --config ra.json --latency-cycles 5 --stats rc.json").success();
    folder.run("replay a.ops --grid-start 9 --latency-cycles 5 --stats rd.json").success();
    assert_eq!(folder.read("rc.json"), folder.read("rd.json"));
    assert_ne!(folder.read("ra.json"), folder.read("rc.json"));

    folder.run(&format!("model teapot --size-factor 3 --size 9x7 --mode broadcast --cells 3 --partition work {machine} --stats ma.json")).success();
    folder.run("model --config a.json --stats mb.json").success();
    folder.run("model --config ma.json --stats mc.json").success();
    assert_eq!(folder.read("ma.json"), folder.read("mb.json"));
    assert_eq!(folder.read("ma.json"), folder.read("mc.json"));
}

#[test]
fn a_configuration_of_something_else_is_refused() {
    let folder = Folder::new();
    let small = "--scene room --size 4x4";
    folder.run(&format!("{small} --ops a.ops --stats run.json")).success();
    folder.run("replay a.ops --stats replay.json").success();
    folder.run("image room -o a.png --size 4x4 --stats image.json").success();
    folder.run(&format!("{small} --cells-run programs --stats programs.json")).success();
    let cases = [
        ("--config image.json", "the configuration is that of a whole image"),
        ("--config replay.json", "describes no run, but a replay"),
        ("replay --config run.json", "describes no replay"),
        ("model --config image.json", "the configuration is that of a whole image"),
        ("model --config programs.json", "the configuration is that of cells that run programs"),
        ("replay", "the following required arguments were not provided"),
        ("model", "the following required arguments were not provided"),
        ("replay --config run.json --stats run.json --force", "run.json"),
    ];
    for (arguments, message) in cases {
        let error = folder.run(arguments).refused();
        assert!(error.contains(message), "{arguments}: {error}");
    }
}

/// A configuration that is given to another command says which one repeats it.
#[test]
fn a_configuration_of_another_command_names_it() {
    let folder = Folder::new();
    for run in [
        "--scene room --size 4x3 --stats run.json --ops run.ops",
        "image room --size 4x3 -o i.png --stats image.json",
        "image room --on ipsc2 --size 16x12 --stats ipsc2.json",
        "image room --on ipsc2 --mode shared-memory --size 16x12 --stats shared.json",
        "farm room --size 4x3 --stats farm.json",
        "replay run.ops --stats replay.json",
    ] {
        folder.run(run).success();
    }
    let repeated = [
        ("run.json", "`pcs-sim --config FILE`"),
        ("image.json", "`pcs-sim image --config FILE -o IMAGE`"),
        ("ipsc2.json", "`pcs-sim ipsc2 --config FILE`"),
        ("shared.json", "`pcs-sim ipsc2 --config FILE`"),
        ("farm.json", "`pcs-sim farm --config FILE`"),
        ("replay.json", "`pcs-sim replay --config FILE`"),
    ];
    let commands = [
        ("", &["run.json", "image.json"][..]),
        ("image -o x.png", &["run.json", "image.json"]),
        ("model", &["run.json", "image.json"]),
        ("size-fifos", &["run.json", "image.json"]),
        ("why", &["run.json", "image.json"]),
        ("ipsc2", &["ipsc2.json", "shared.json"]),
        ("farm", &["farm.json"]),
        ("replay", &["replay.json"]),
    ];
    for (command, own) in commands {
        for (file, by) in repeated.iter().filter(|(file, _)| !own.contains(file)) {
            let error = folder.run(&format!("{command} --config {file}")).refused();
            assert!(
                error.contains(by) && error.contains(file) && !error.contains("unknown field"),
                "{command}: {error}"
            );
        }
    }
}
