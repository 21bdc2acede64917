//! Plots and pages of a run, as files and in a browser.

use crate::support::browser::{Browser, Page};
use crate::support::command::Folder;
use crate::support::pictures::decoded;
use pcs_sim::machine::{Array, Cycles, MachineSpec};
use pcs_sim::report::plot::{self, Caption, Run};
use serde_json::{Value, json};

const ALL: std::ops::Range<Cycles> = Cycles(0)..Cycles(u64::MAX);

const RUN: &str = "--mode hybrid --cells 4 --scene room --size 12x10 --fifo-words 16";

#[test]
fn plots_are_pictures_in_both_formats() {
    let folder = Folder::new();
    let stdout = folder.run(&format!("{RUN} --plot plots")).success();
    for name in ["fifos", "fifo-histograms", "cells", "space-time", "rays", "latency"] {
        assert!(stdout.contains(&format!("wrote plots/{name}.svg\nwrote plots/{name}.png\n")), "{stdout}");
        let svg = folder.read(&format!("plots/{name}.svg"));
        assert!(
            svg.contains("hybrid on 4 cells in 2 groups of 2: scene room (45 polygons), 120 rays, partition regular"),
            "{name} tells what ran"
        );
        assert!(svg.contains("@font-face"), "{name} brings its font");
        assert!(!svg.contains("href"), "{name} asks for nothing");
        let pixels = decoded(&folder.path(&format!("plots/{name}.png"))).bytes;
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
        // Only of a scene is it known what single rays come to.
        let data = &page[start..start + page[start..].find("\"looks\"").unwrap()];
        let (before, after) = (data.find("\"cells\"").unwrap(), data.find("\"fifos\"").unwrap());
        format!("{}{}", &data[..before], &data[after..])
    };
    assert_eq!(figures("run.html"), figures("replay.html"));
}

/// Turns the wheel over one chart of a page, at first without Ctrl, and moves in it by keys. Tells whether the page scrolls then,
/// whether anything is wider than the window or cut off, which colours its overviews have that no legend tells, how many
/// charts stand on the stretch that one was zoomed to, and which window the page then names.
const USE: &str = "(async () => {
  const pause = () => new Promise((done) => setTimeout(done, 50));
  const { over } = charts[0].chart, { left, top, width } = over.getBoundingClientRect();
  const turned = { deltaY: -1, clientX: left + width / 2, clientY: top + 5, bubbles: true, cancelable: true };
  const scrolls = over.dispatchEvent(new WheelEvent('wheel', turned));
  const stays = view.max - view.min === run.end;
  const known = [...document.querySelectorAll('.legend i')].map((square) => getComputedStyle(square).backgroundColor);
  const ours = new Set([...known, 'rgb(255, 255, 255)']);
  const foreign = new Set();
  for (const { chart: { ctx, bbox }, place } of charts.filter(({ place }) => place.parentElement.id === 'overview').slice(1)) {
    const { data } = ctx.getImageData(bbox.left, bbox.top, bbox.width, bbox.height);
    for (let at = 0; at < data.length; at += 4) {
      const color = `rgb(${data[at]}, ${data[at + 1]}, ${data[at + 2]})`;
      if (!ours.has(color)) foreign.add(`${color} in ${place.getAttribute('aria-label')}`);
    }
  }
  const drawing = document.querySelector('#array svg'), around = document.getElementById('array');
  const whole = around.scrollHeight <= around.clientHeight && drawing.getBoundingClientRect().height <= around.clientHeight;
  over.dispatchEvent(new WheelEvent('wheel', { ...turned, ctrlKey: true }));
  await pause();
  const shown = document.getElementById('window').textContent;
  const near = (a, b) => Math.abs(a - b) < 0.01 * run.end;
  const zoomed = charts.filter(({ chart: { scales: { x } } }) => near(x.min, run.end / 8) && near(x.max, run.end * 7 / 8)).length;
  const fits = document.documentElement.scrollWidth <= innerWidth;
  charts[0].place.focus();
  const press = (key) => charts[0].place.dispatchEvent(new KeyboardEvent('keydown', { key, cancelable: true }));
  press('d');
  const moved = near(view.min, run.end / 4) || near(view.min, run.end * 5 / 16);
  press('0');
  const back = view.min === 0 && view.max === run.end;
  document.querySelector('.station.selected').dispatchEvent(new MouseEvent('click'));
  await pause();
  return { scrolls, stays, whole, window: shown, zoomed, fits, moved, back, foreign: [...foreign].slice(0, 9), charts: charts.length };
})()";

#[test]
fn a_page_opens_in_a_browser_and_its_charts_move_together() {
    let Some(browser) = Browser::start() else { return };
    let folder = Folder::new();
    // Four cells, the rays done and those on their way, eight FIFOs.
    folder.run(&format!("{RUN} --page few.html")).success();
    let few = used(&browser, &folder, "few", (1280, 800));
    assert!(few["scrolls"] == true && few["stays"] == true, "the wheel scrolls the page");
    assert_eq!(few["zoomed"], 14, "all charts stand on the stretch that one was zoomed to");
    assert!(few["moved"] == true && few["back"] == true, "keys move along the run");
    assert_eq!(few["charts"], 12, "a click has hidden a cell and its FIFO");
    let shown = few["window"].as_str().unwrap();
    folder.run(&format!("{RUN} {shown} --page part.html")).success();
    let part = folder.read("part.html");
    let (from, until) = shown.trim_start_matches("--trace-window ").split_once("..").unwrap();
    assert!(
        part.contains(&format!("\"window\":{{\"from\":{from},\"until\":{until},")),
        "{shown} is what the page says"
    );
    let few = folder.read("few.html");
    assert!(few.contains("cell 3") && few.contains("data:image/png"), "the array and the picture are there");
    for (cells, window) in [(40, (1280, 800)), (130, (900, 800)), (256, (1920, 1080))] {
        let run = format!("--mode broadcast --cells {cells} --scene teapot --size 8x6 --page many.html --force");
        folder.run(&run).success();
        let many = used(&browser, &folder, "many", window);
        assert_eq!(many["fits"], true, "nothing is wider than a window of {window:?}");
        assert_eq!(many["whole"], true, "the array is not cut off");
        assert_eq!(many["foreign"], json!([]), "{cells} cells have no colour that the legend lacks");
    }
}

#[test]
fn a_farms_page_opens_in_a_browser() {
    let Some(browser) = Browser::start() else { return };
    let folder = Folder::new();
    // Five tasks and the segments; and 22 tasks, of which four are shown beside the picture of all.
    folder.run("farm rectangles --size 20x15 --tasks 3 --page few.html").success();
    let few = used(&browser, &folder, "few", (1280, 800));
    assert!(few["zoomed"] == 6 && few["charts"] == 5, "charts move, and can be hidden");
    folder.run("farm rectangles --size 20x15 --tasks 20 --processors 21 --page many.html").success();
    for window in [(1280, 800), (900, 800)] {
        let many = used(&browser, &folder, "many", window);
        assert!(many["zoomed"] == 6 && many["fits"] == true, "{window:?}");
    }
}

/// A hypercube's page has its nodes, each with the queue, and all links that carried anything.
#[test]
fn a_hypercubes_page_opens_in_a_browser() {
    let Some(browser) = Browser::start() else { return };
    let folder = Folder::new();
    // Five nodes and the host, five queues, the legs.
    folder.run("ipsc2 teapot --size 16x16 --nodes 5 --page few.html --stats few.json").success();
    let few = used(&browser, &folder, "few", (1280, 800));
    assert!(few["zoomed"] == 12 && few["charts"] == 10, "charts move, and a node's can be hidden: {few}");
    let page = opened(&browser, &folder, "few", (1280, 800));
    let stats: Value = serde_json::from_str(&folder.read("few.json")).unwrap();
    let links = stats["links"].as_array().unwrap();
    let used_links = links.iter().filter(|link| link["messages"] != 0);
    assert_eq!(page.eval("document.querySelectorAll('#array .link').length"), json!(used_links.count()));
    let bytes = &links.iter().max_by_key(|link| link["busy"].as_u64()).unwrap()["bytes"];
    let told = page.eval("[...document.querySelectorAll('#array .link title')].at(-1).textContent");
    let told = told.as_str().unwrap().replace(' ', "");
    assert!(told.contains(&format!("messages,{bytes}bytes")), "the busiest is on top: {told}");
    folder.run("ipsc2 teapot --size 32x32 --nodes 64 --page many.html").success();
    for window in [(1280, 800), (900, 800)] {
        let many = used(&browser, &folder, "many", window);
        assert!(many["fits"] == true && many["whole"] == true, "{window:?}: {many}");
        assert_eq!(many["foreign"], json!([]), "no colour that the legend lacks");
    }
    folder.run("ipsc2 teapot --size 16x16 --nodes 4 --mode shared-memory --page memory.html").success();
    let memory = used(&browser, &folder, "memory", (1280, 800));
    assert!(memory["zoomed"] == 6 && memory["charts"] == 5, "there are no queues: {memory}");
}

/// The moments that a page tells of: of some cells at some times.
const ASK: &str = "(() => {
  const asked = [];
  for (const station of [0, 1, 3]) {
    for (const share of [0.02, 0.11, 0.3, 0.57, 0.9]) {
      const cycle = Math.floor(share * run.cycles);
      asked.push([station, cycle, chainOf(station, cycle).map(sentenceOf)]);
    }
  }
  return asked;
})()";

/// The page and `why` tell the same of a moment, but that the page knows states where `why` knows units of work.
#[test]
fn a_page_tells_who_waits_for_whom_as_why_does() {
    let Some(browser) = Browser::start() else { return };
    let folder = Folder::new();
    let run = "--mode hybrid --cells 4 --scene room --size 12x10 --fifo-words 8";
    folder.run(&format!("{run} --page a.html")).success();
    let page = opened(&browser, &folder, "a", (1280, 800));
    let mut waits = 0;
    for asked in page.eval(ASK).as_array().unwrap() {
        let (cell, cycle) = (&asked[0], &asked[1]);
        let why = folder.run(&format!("why {run} --cell {cell} --at {cycle}")).success().replace("\n  ", " ");
        let told: Vec<String> = why.lines().skip_while(|line| !line.starts_with("cycle ")).skip(1).map(plain).collect();
        let told_by_page: Vec<String> =
            asked[2].as_array().unwrap().iter().map(|line| plain(line.as_str().unwrap())).collect();
        assert_eq!(told_by_page, told, "cell {cell} in cycle {cycle}");
        waits += told.iter().filter(|line| line.contains("is full") || line.contains("is empty")).count();
    }
    assert!(waits >= 6, "only {waits} waits");
    page.assert_quiet();
}

/// A line on what somebody does, without what only one of the two knows: what exactly a cell works on, or moves.
fn plain(line: &str) -> String {
    for (what, kept) in [(" works (", " works"), (" moves a word", " moves a word")] {
        if let Some((who, rest)) = line.split_once(what) {
            let ray = rest.rsplit_once(", ray ").map_or("", |ray| ray.1);
            return format!("{who}{kept}, ray {ray}");
        }
    }
    match line.split_once(" waits for a word that ") {
        Some((who, rest)) => {
            let (_, times) = rest.split_once(", from cycle ").unwrap();
            format!("{who} waits for a word on its way, from cycle {times}")
        }
        None => line.to_owned(),
    }
}

/// A page that asks the network for nothing, in a window of that size.
fn opened<'a>(browser: &'a Browser, folder: &Folder, name: &str, size: (u32, u32)) -> Page<'a> {
    let page = folder.read(&format!("{name}.html"));
    assert!(page.matches("http://").count() == page.matches("http://www.w3.org").count());
    assert!(
        !page.contains("src=\"http") && !page.contains("<link rel=\"stylesheet\""),
        "it asks the network for nothing"
    );
    browser.open_file(&folder.path(&format!("{name}.html")), size)
}

/// What is seen of a page that is used.
fn used(browser: &Browser, folder: &Folder, name: &str, size: (u32, u32)) -> Value {
    let page = opened(browser, folder, name, size);
    let seen = page.eval(USE);
    page.assert_quiet();
    seen
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
        let (_, observed) = Array::new(&spec, &crate::support::random_ops::costs(), cells)
            .probed()
            .recorded(ALL, 9)
            .finish_observed()
            .unwrap();
        let caption = Caption { title: "nothing".to_owned(), partition: None, machine: "none".to_owned() };
        let profile = &observed.profile.unwrap();
        let recording = observed.recording.as_ref();
        let run = Run {
            caption: &caption,
            clock: spec.clock(),
            profile,
            recording,
            path: None,
            cell_names: &[],
            regions: None,
        };
        assert!(plot::pictures(&run).unwrap().len() >= 6);
    }
}
