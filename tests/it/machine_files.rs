//! Machine files that have only what differs from another.

use crate::support::command::Folder;

#[test]
fn a_file_on_a_base_is_the_base_with_its_changes() {
    let folder = Folder::new();
    let run = "--scene room --size 8x6 --json";
    let flags = folder.run(&format!("{run} --fifo-words 64 --grid-voxel 3.9 --y-fifo-words 8")).success();
    folder.file("fast.ron", r#"(base: "standard", fifo_words: 64, times_us: (grid_voxel: 3.9), y_fifo_words: 8)"#);
    assert_eq!(folder.run(&format!("{run} --machine fast.ron")).success(), flags);
    // A base stands beside the file that names it, wherever the command is called.
    std::fs::create_dir(folder.path("machines")).unwrap();
    folder.file("machines/deep.ron", r#"(base: "standard", fifo_words: 64, times_us: (grid_voxel: 12))"#);
    folder.file("machines/fast.ron", r#"(base: "deep.ron", times_us: (grid_voxel: 3.9), y_fifo_words: 8)"#);
    assert_eq!(folder.run(&format!("{run} --machine machines/fast.ron")).success(), flags);
    folder.file("instructions.ron", r#"(base: "standard", link_mb_s: 40)"#);
    folder.run("--scene tetra --size-factor 2 --size 4 --cells-run programs --machine instructions.ron").success();
    let farm = "farm rectangles --size 20x10 --tasks 2 --json";
    folder.file("capitan.ron", r#"(base: "standard", bus_mb_s: 5)"#);
    let with_file = folder.run(&format!("{farm} --machine capitan.ron")).success();
    assert_eq!(with_file, folder.run(&format!("{farm} --bus-mb-s 5")).success());
}

#[test]
fn mistakes_in_a_file_on_a_base_are_told() {
    let folder = Folder::new();
    let refused = |text: &str| {
        folder.file("m.ron", text);
        folder.run("--scene room --machine m.ron").refused()
    };
    let error = refused("(base: \"standard\",\n fifo_word: 3)");
    assert!(error.contains("m.ron:2") && error.contains("fifo_word"), "{error}");
    let error = refused("(base: \"standard\",\n fifo_words: 0)");
    assert!(error.contains("m.ron:2") && error.contains("fifo_words is 0"), "{error}");
    let error = refused("(base: \"standard\",\n fifo_words: many)");
    assert!(error.contains("m.ron:2"), "{error}");
    assert!(refused("(base: \"none.ron\")").contains("none.ron"));
    assert!(refused("(base: \"m.ron\")").contains("stand on each other"));
    let error = refused("(fifo_words: 3)");
    assert!(error.contains("missing"), "a file without a base is a whole one: {error}");
}

/// What a base says is part of a sweep.
#[test]
fn a_sweep_minds_bases() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: "room", size: 6, machine: "m.ron", fifo_words: [8, 16])"#);
    folder.file("m.ron", r#"(base: "below.ron")"#);
    folder.file("below.ron", r#"(base: "standard", clock_ns: 25)"#);
    folder.run("sweep sweep.ron -o t.csv").success();
    assert!(folder.run("sweep sweep.ron -o t.csv").success().starts_with("2 points: 2 done (0 now)"));
    folder.file("below.ron", r#"(base: "standard", clock_ns: 50)"#);
    assert!(folder.run("sweep sweep.ron -o t.csv").refused().contains("the files of this one changed"));
}
