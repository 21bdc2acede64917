//! `pcs-sim model` as a user types it.

use crate::support::command::Folder;

#[test]
fn predictions_stand_beside_what_is_counted_and_measured() {
    let folder = Folder::new();
    insta::assert_snapshot!(folder.run("model room --mode hybrid --groups 2 --size 32x24").success());
    insta::assert_snapshot!(
        folder.run("model room --mode pipeline --size 32x24 --predict-only --link-mb-s 0.2").success()
    );
    insta::assert_snapshot!(folder.run("model room --predict-only --size 32x24 --host-ray-us 5000").success());
}

#[test]
fn the_documentation_shows_a_real_prediction() {
    let page = include_str!("../../docs/cost-model.md");
    let command = "$ pcs-sim model teapot --mode pipeline\n";
    let shown = page.split(command).nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    assert_eq!(Folder::new().run(command["$ pcs-sim ".len()..].trim()).success(), shown);
}

#[test]
fn the_table_is_a_file_as_well() {
    let folder = Folder::new();
    let run = "model room --mode broadcast --cells 3 --size 24x18 --stats m.json";
    assert!(folder.run(run).success().ends_with("wrote m.json\n"));
    let json: serde_json::Value = serde_json::from_str(&folder.read("m.json")).unwrap();
    let rows = json["quantities"].as_array().unwrap();
    assert!(rows.iter().any(|row| row["quantity"] == "rays a second" && row["measured"].is_number()));
    assert!(json["best_grid_coefficient"].is_number() && json["limit"].is_string());
    assert!(folder.run(run).refused().contains("m.json"), "an existing file is kept");
}

#[test]
fn threads_change_no_byte() {
    let folder = Folder::new();
    let run = |threads| folder.run(&format!("model teapot --size-factor 3 --size 40x30 --threads {threads}")).success();
    assert_eq!(run(1), run(5));
}

#[test]
fn what_it_would_not_look_at_is_refused() {
    let refused = |args: &str| Folder::new().run(&format!("model room --size 8x8 {args}")).refused();
    assert!(refused("--mailbox").contains("knows no mailbox"));
    assert!(refused("--mode pipeline --stop-words 2").contains("knows neither stop words"));
    assert!(refused("--forward-ahead 1").contains("nor rays forwarded ahead"));
    assert!(refused("--mode broadcast --bounded-walk").contains("knows no walk that is bounded"));
    assert!(refused("--predict-only --memory-words 64").contains("--memory-words is about the simulation"));
}

/// The order of the rays and the depth of the FIFOs are told, and change what is expected without anything being run.
#[test]
fn orders_and_depths_are_predicted() {
    let folder = Folder::new();
    let cycles = |flags: &str| {
        let run =
            format!("model reference --size-factor 10 --mode broadcast --cells 16 --size 96x96 --predict-only {flags}");
        let told = folder.run(&format!("{run} --stats s.json --force")).success();
        assert!(told.contains("lost to waiting, %"), "{told}");
        let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        let waiting = &stats["waiting"];
        assert!(waiting["lost"].as_f64() >= waiting["lost_with_deep_fifos"].as_f64(), "{waiting}");
        (waiting["cycles_per_ray"].as_f64().unwrap(), waiting["depths"].clone())
    };
    let (raster, deep) = (cycles("").0, cycles("--fifo-words 65536").0);
    let (shuffled, depths) = cycles("--order shuffle:1");
    assert!(shuffled < 0.8 * raster && deep < 0.9 * raster, "{raster} {deep} {shuffled}");
    // What it says of depths holds for a run with them.
    let depth = depths.as_array().unwrap().iter().find(|depth| depth["lost"] == 0.1).unwrap();
    let flags =
        format!("--order shuffle:1 --x-fifo-words {} --y-fifo-words {}", depth["x_fifo_words"], depth["y_fifo_words"]);
    let run = "--scene reference --size-factor 10 --mode broadcast --cells 16 --size 96x96";
    folder.run(&format!("{run} {flags} --stats r.json")).success();
    let stats: serde_json::Value = serde_json::from_str(&folder.read("r.json")).unwrap();
    let losses = &stats["losses"];
    let lost: f64 = ["order", "variance", "first_and_last"].iter().filter_map(|part| losses[part].as_f64()).sum();
    let share = lost / stats["cycles"].as_f64().unwrap();
    assert!(share < 0.12, "{share} {losses}");
}

/// Whatever the scene and the cut, every figure is a number.
#[test]
fn every_figure_is_a_number() {
    let folder = Folder::new();
    for (scene, cells) in
        [("reference --size-factor 4", 16), ("room", 32), ("sombrero", 64), ("balls --size-factor 2", 48)]
    {
        for partition in ["regular", "polygons", "work"] {
            let run = format!("model {scene} --mode broadcast --cells {cells} --partition {partition} --size 24x24");
            let told = folder.run(&format!("{run} --stats s.json --force")).success();
            assert!(!told.contains("NaN") && !told.contains("inf"), "{told}");
            let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
            let rows = stats["quantities"].as_array().unwrap();
            assert!(rows.iter().all(|row| row["model"].is_number()), "{stats}");
        }
    }
}

#[test]
fn impossible_grids_are_refused() {
    let error = Folder::new().run("model reference --grid-coefficient 1000000 --predict-only --size 8x8").refused();
    assert!(error.contains("smaller grid coefficient"), "{error}");
}

/// Of polygons without area no ray meets any, and every figure is a number.
#[test]
fn polygons_without_area_have_figures_too() {
    let folder = Folder::new();
    folder.file("points.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 1 1\nf 1 2 3\nf 2 2 3\n");
    for program in ["", "--mode broadcast --cells 2", "--mode hybrid --cells 2"] {
        let told = folder.run(&format!("model points.obj --size 4x4 {program} --stats s.json --force")).success();
        assert!(!told.contains("NaN") && !told.contains("inf"), "{told}");
        let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        let rows = stats["quantities"].as_array().unwrap();
        assert!(rows.iter().all(|row| row["model"].is_number()), "{stats}");
    }
}
