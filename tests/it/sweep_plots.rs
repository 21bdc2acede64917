//! Plots of a sweep's table, as files.

use crate::support::command::Folder;
use crate::support::pictures::decoded;

const SWEEP: &str = r#"(
    scene: "room",
    size: 8,
    mode: ["pipeline", "broadcast"],
    fifo_words: (from: 4, to: 64, times: 2),
    link_mb_s: [80, 20],
)"#;

/// The name of a plot.
const BY_MODE: &str = "t-rays_per_second-over-fifo_words-by-mode-link_mb_s-80";

#[test]
fn columns_are_plotted_over_each_other() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    let plots =
        "--plot x=fifo_words y=rays_per_second by=mode link_mb_s=80 --plot x=mode y=cycles fifo_words=4 link_mb_s=80";
    let stdout = folder.run(&format!("sweep sweep.ron -o t.csv {plots}")).success();
    for name in [BY_MODE, "t-cycles-over-mode-fifo_words-4-link_mb_s-80"] {
        assert!(stdout.contains(&format!("wrote {name}.svg\nwrote {name}.png\n")), "{stdout}");
        let svg = folder.read(&format!("{name}.svg"));
        assert!(svg.contains("points: scene room; size 8x8; "), "{name} tells what ran");
        assert!(
            svg.contains("mode pipeline, broadcast") && svg.contains("; cells 3"),
            "{name} tells of how many cells"
        );
        let pixels = decoded(&folder.path(&format!("{name}.png"))).bytes;
        // Blue is the first line's, vermilion the second's.
        let has = |color: [u8; 3]| pixels.chunks(3).any(|pixel| pixel == color);
        assert!(has([0, 114, 178]), "{name}");
        assert_eq!(has([213, 94, 0]), name == BY_MODE, "{name}");
    }
    let svg = folder.read(&format!("{BY_MODE}.svg"));
    let text = |text: &str| svg.contains(&format!("\n{text}\n"));
    assert!(["4", "8", "16", "32", "64", "pipeline", "broadcast"].iter().all(|tick| text(tick)), "{svg}");
    assert!(text("depth of each FIFO (words), logarithmic") && text("rays a second of simulated time"), "{svg}");
}

#[test]
fn a_finished_table_is_plotted_without_running_again() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    folder.run("sweep sweep.ron -o t.csv").success();
    let plot = "sweep sweep.ron -o t.csv --plot x=link_mb_s y=mean_works by=mode facet=fifo_words";
    let stdout = folder.run(plot).success();
    assert!(stdout.starts_with("20 points: 20 done (0 now)\n"), "{stdout}");
    let name = "t-mean_works-over-link_mb_s-by-mode-facet-fifo_words.svg";
    assert!(folder.read(name).contains("\ndepth of each FIFO 64\n"));
    let error = folder.run(plot).refused();
    assert!(error.contains("exists already") && error.contains(name), "{error}");
    folder.run(&format!("{plot} --force")).success();
    // What would be averages is not drawn.
    let averages = folder.run("sweep sweep.ron -o t.csv --plot x=link_mb_s y=mean_works by=mode").failed();
    assert!(averages.contains("differ in fifo_words") && averages.contains("facet=fifo_words"), "{averages}");
}

#[test]
fn plots_that_cannot_be_are_refused_before_anything_runs() {
    let folder = Folder::new();
    folder.file("sweep.ron", SWEEP);
    for (plot, complaint) in [
        ("x=fifo_word y=cycles", "did you mean `fifo_words`?"),
        ("x=fifo_words y=seconds by=modes", "did you mean `mode`?"),
        ("x=fifo_words y=mode", "column 'mode' holds no numbers"),
        ("x=fifo_words by=mode", "expected x=COLUMN y=COLUMN"),
        ("x=fifo_words y=cycles z=mode", "the table has no column 'z'"),
        ("x=fifo_words y=cycles y=seconds", "not 'y=seconds'"),
    ] {
        let error = folder.run(&format!("sweep sweep.ron -o t.csv --plot {plot}")).refused();
        assert!(error.contains(complaint), "{plot}: {error}");
        assert_eq!(folder.names(), ["sweep.ron"], "{plot}");
    }
}

#[test]
fn points_that_failed_are_left_out_and_counted() {
    let folder = Folder::new();
    folder.file("sweep.ron", r#"(scene: "room", size: 8, fifo_words: [0, 4, 8])"#);
    folder.run("sweep sweep.ron -o t.csv --plot x=fifo_words y=cycles").failed();
    assert!(folder.read("t-cycles-over-fifo_words.svg").contains("1 point that failed is left out"));
    folder.file("none.ron", r#"(scene: "room", size: 8, fifo_words: [0])"#);
    let error = folder.run("sweep none.ron -o none.csv --plot x=fifo_words y=cycles").failed();
    assert!(error.contains("nothing to draw"), "{error}");
    assert_eq!(folder.names()[..3], ["none.csv", "none.journal", "none.parquet"], "the table is there");
}
