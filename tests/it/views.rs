//! Plots and pages of a run, as files and in a browser.

use std::process::Command;

use crate::support::command::Folder;
use pcs_sim::machine::{Array, MachineSpec};
use pcs_sim::report::plot::{self, Caption};

const RUN: &str = "--mode hybrid --cells 4 --scene room --size 12x10 --fifo-words 16";

#[test]
fn plots_are_pictures_in_both_formats() {
    let folder = Folder::new();
    let stdout = folder.run(&format!("{RUN} --plot plots")).success();
    for name in ["fifos", "fifo-histograms", "cells", "rays", "latency"] {
        assert!(stdout.contains(&format!("wrote plots/{name}.svg\nwrote plots/{name}.png\n")), "{stdout}");
        let svg = folder.read(&format!("plots/{name}.svg"));
        assert!(svg.contains("hybrid on 4 cells in 2 groups of 2: scene room"), "{name} tells what ran");
        assert!(svg.contains("@font-face"), "{name} brings its font");
        assert!(!svg.contains("href"), "{name} asks for nothing");
        let file = std::io::BufReader::new(std::fs::File::open(folder.path(&format!("plots/{name}.png"))).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert!(pixels.iter().any(|&value| value < 100), "{name} is not blank");
    }
    assert!(folder.read("plots/cells.svg").contains("cell 3"));
    assert!(folder.read("plots/fifos.svg").contains("Yhost: at most"));
}

#[test]
fn a_folder_with_files_is_kept_unless_asked() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("plots")).unwrap();
    folder.file("plots/mine.txt", "precious");
    let error = folder.run(&format!("{RUN} --plot plots")).refused();
    assert!(error.contains("plots") && error.contains("is not empty"), "{error}");
    folder.run(&format!("{RUN} --plot plots --force")).success();
    assert_eq!(folder.read("plots/mine.txt"), "precious");
}

#[test]
fn a_replay_has_the_same_views_as_its_run() {
    let folder = Folder::new();
    folder.run(&format!("{RUN} --ops a.ops --page run.html")).success();
    folder.run("replay a.ops --fifo-words 16 --page replay.html").success();
    let figures = |name: &str| {
        let page = folder.read(name);
        let start = page.find("\"bins\"").unwrap();
        let data = &page[start..start + page[start..].find("</script>").unwrap()];
        let (before, after) = (data.find("\"cells\"").unwrap(), data.find("\"fifos\"").unwrap());
        format!("{}{}", &data[..before], &data[after..])
    };
    assert_eq!(figures("run.html"), figures("replay.html"));
}

/// What a page does once it is open: turns the wheel over one chart, tells on which stretch each of them then stands and
/// whether anything is wider than the window, and hides a cell's charts by a click.
const USE: &str = "<script>
setTimeout(() => {
  const { over } = charts[0].chart, { left, top, width } = over.getBoundingClientRect();
  over.dispatchEvent(new WheelEvent('wheel', { deltaY: -1, clientX: left + width / 2, clientY: top + 5, bubbles: true }));
  const told = document.body.dataset;
  setTimeout(() => {
    const near = (a, b) => Math.abs(a - b) < 0.01 * run.end;
    told.zoomed = charts.filter(({ chart: { scales: { x } } }) => near(x.min, run.end / 8) && near(x.max, run.end * 7 / 8)).length;
    told.fits = document.documentElement.scrollWidth <= innerWidth;
    document.querySelector('.station.selected').dispatchEvent(new MouseEvent('click'));
  }, 200);
}, 200);
</script>";

#[test]
fn a_page_opens_in_a_browser_and_its_charts_move_together() {
    let Some(browser) = browser() else { return };
    let folder = Folder::new();
    // Four cells, the rays, eight FIFOs.
    folder.run(&format!("{RUN} --page few.html")).success();
    let few = opened(browser, &folder, "few", "1280,800");
    assert!(few.contains("data-zoomed=\"13\""), "all charts stand on the stretch that one was zoomed to");
    assert!(few.contains("data-charts=\"11\""), "a click has hidden a cell and its FIFO");
    assert!(few.contains("cell 3") && few.contains("data:image/png"), "the array and the picture are there");
    folder.run("--mode broadcast --cells 40 --scene teapot --size 12x10 --page many.html").success();
    for window in ["1280,800", "900,800", "1920,1080"] {
        let many = opened(browser, &folder, "many", window);
        assert!(many.contains("data-fits=\"true\""), "nothing is wider than a window of {window}");
        assert!(many.contains("all FIFOs on Y") && many.contains("class=\"station"), "{window}");
    }
}

#[test]
fn a_farms_page_opens_in_a_browser() {
    let Some(browser) = browser() else { return };
    let folder = Folder::new();
    // Five tasks and the segments; and 22 tasks, of which four are shown beside the picture of all.
    folder.run("farm rectangles --size 20x15 --tasks 3 --page few.html").success();
    let few = opened(browser, &folder, "few", "1280,800");
    assert!(few.contains("data-zoomed=\"6\"") && few.contains("data-charts=\"5\""), "charts move, and can be hidden");
    folder.run("farm rectangles --size 20x15 --tasks 20 --processors 21 --page many.html").success();
    for window in ["1280,800", "900,800"] {
        let many = opened(browser, &folder, "many", window);
        assert!(many.contains("data-zoomed=\"6\"") && many.contains("data-fits=\"true\""), "{window}");
    }
}

/// A browser, if there is one.
fn browser() -> Option<&'static str> {
    let browsers = ["chromium", "chromium-browser", "google-chrome"];
    let is_there =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    let found = browsers.into_iter().find(is_there);
    if found.is_none() {
        eprintln!("skipped: there is no browser among {browsers:?}");
    }
    found
}

/// What is in a page after it was opened in a window of that size, and used.
fn opened(browser: &str, folder: &Folder, name: &str, window: &str) -> String {
    let page = folder.read(&format!("{name}.html"));
    assert!(page.matches("http://").count() == page.matches("http://www.w3.org").count());
    assert!(
        !page.contains("src=\"http") && !page.contains("<link rel=\"stylesheet\""),
        "it asks the network for nothing"
    );
    folder.file("used.html", page.replace("</body>", &format!("{USE}</body>")));
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args("--headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking".split(' '))
        .args("--disable-component-update --disable-sync --enable-logging=stderr --virtual-time-budget=3000".split(' '))
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--window-size={window}"))
        .arg("--dump-dom")
        .arg(format!("file://{}", folder.path("used.html").display()))
        .output()
        .unwrap();
    let log = String::from_utf8_lossy(&output.stderr);
    assert!(!log.contains("CONSOLE"), "{log}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs of one ray and of rays that hit nothing have all views too.
#[test]
fn next_to_nothing_can_be_seen() {
    let folder = Folder::new();
    let header = "ox,oy,oz,dx,dy,dz\n";
    for (name, rays) in [("one", "0,0,50,0,0,-1\n"), ("away", "0,0,500,0,0,1\n0,0,500,0,0,1\n")] {
        folder.file(&format!("{name}.csv"), format!("{header}{rays}"));
        let run = format!("--scene room --mode broadcast --cells 12 --rays {name}.csv");
        folder.run(&format!("{run} --plot {name} --page {name}.html")).success();
        assert!(folder.read(&format!("{name}.html")).contains("cell"), "{name}");
    }
}

#[test]
fn a_run_of_no_cycles_can_be_drawn() {
    for cells in [1, 20] {
        let spec = MachineSpec::default();
        let (_, observed) =
            Array::new(&spec, &crate::support::random_ops::costs(), cells).probed().finish_observed().unwrap();
        let caption = Caption { title: "nothing".to_owned(), machine: "none".to_owned() };
        assert!(plot::pictures(&observed.profile.unwrap(), None, spec.clock(), &caption, &[]).unwrap().len() >= 5);
    }
}
