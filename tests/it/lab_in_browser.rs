//! The lab in a real browser: sliders, addresses, two runs, sweeps, dropped scenes, keys and names for screen readers.

use serde_json::{Value, json};

use crate::support::browser::{Browser, Page};
use crate::support::command::Folder;
use crate::support::lab::Lab;

/// A page of the lab whose first runs are done.
fn opened<'a>(browser: &'a Browser, lab: &Lab, address: &str, runs: usize, size: (u32, u32)) -> Page<'a> {
    let page = browser.open(&lab.url(address), size);
    done(&page, runs);
    page
}

/// Waits until so many runs have been drawn, and nothing is under way.
fn done(page: &Page<'_>, runs: usize) {
    page.wait_for(&format!("Number(document.body.dataset.runs) >= {runs} && !isBusy()"));
}

/// What the frame of a run shows, as text and as its picture.
fn shown(page: &Page<'_>, side: &str) -> (String, String) {
    let of = |what: &str| page.eval(&format!("sides.{side}.frame.contentDocument.{what}")).as_str().unwrap().to_owned();
    (of("getElementById('run').innerHTML"), of("querySelector('header img').src"))
}

#[test]
fn a_slider_changes_the_picture_and_its_address_shows_the_same() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=room&size=32x32", 1, (1600, 900));
    let first = shown(&page, "a");
    page.eval("document.getElementById('p-fifo_words').focus()");
    for _ in 0..7 {
        page.key("ArrowLeft");
    }
    page.wait_for("location.search.includes('fifo_words=4') && !isBusy()");
    let second = shown(&page, "a");
    assert!(first.0 != second.0 && second.0.contains("4-word FIFOs"), "{}", second.0);
    assert_eq!(first.1, second.1, "the clockwork changes no pixel");
    page.eval("set('size', '64x64')");
    page.wait_for("location.search.includes('size=64x64') && !isBusy()");
    let third = shown(&page, "a");
    assert_ne!(second.1, third.1);
    let address = page.eval("location.search").as_str().unwrap().to_owned();
    assert_eq!(address, "?scene=room&size=64x64&fifo_words=4");
    let again = opened(&browser, &lab, &address, 1, (1600, 900));
    assert_eq!(shown(&again, "a"), third);
    let command = again.eval("sides.a.command.textContent");
    assert_eq!(command, "pcs-sim --scene room --size 64x64 --fifo-words 4");
    assert_eq!(again.eval("controls.get('fifo_words').exact.value"), "4");
    // What was run stands in the list, and can be shown again.
    page.click_on("#tab-last");
    assert!(page.eval("document.querySelectorAll('#last tbody tr').length").as_u64().unwrap() >= 3);
    page.eval("document.querySelector('#last tbody tr:last-child button').click()");
    page.wait_for("location.search === '?scene=room&size=32x32' && !isBusy()");
    assert_eq!(shown(&page, "a"), first);
    [page, again].iter().for_each(Page::assert_quiet);
}

#[test]
fn what_makes_no_run_is_told_and_the_page_goes_on() {
    let Some(browser) = Browser::start() else { return };
    let (lab, folder) = (Lab::start(""), Folder::new());
    let page = opened(&browser, &lab, "?scene=room&size=16x16", 1, (1280, 800));
    page.eval("set('fifo_words', '0')");
    page.wait_for("!sides.a.failure.hidden && !isBusy()");
    let told = page.eval("sides.a.failure.textContent");
    assert_eq!(told, folder.run("--fifo-words 0").refused().trim_end());
    page.eval("set('fifo_words', '8')");
    page.wait_for("sides.a.failure.hidden && !isBusy()");
    // A parameter without effect keeps its value, and says why.
    page.eval("set('partition', 'work')");
    page.wait_for("!isBusy() && !controls.get('partition').row.querySelector('.moot').hidden");
    assert_eq!(page.eval("sides.a.command.textContent"), "pcs-sim --scene room --size 16x16 --fifo-words 8");
    // A number of cells that the mode cannot have is taken back.
    page.eval("set('mode', 'hybrid')");
    page.eval("set('cells', '6')");
    page.eval("set('mode', 'pipeline')");
    page.wait_for("!isBusy()");
    assert!(!page.eval("location.search").as_str().unwrap().contains("cells"));
    assert_eq!(page.eval("sides.a.failure.hidden"), true);
    let refused = |text: &String| !text.contains("422");
    let log: Vec<String> = page.log().into_iter().filter(refused).collect();
    assert!(log.is_empty(), "{log:?}");
    let unknown = browser.open(&lab.url("?fifo_wrods=8"), (1280, 800));
    unknown.wait_for("!sides.a.failure.hidden");
    assert!(unknown.eval("sides.a.failure.textContent").as_str().unwrap().contains("unknown parameter `fifo_wrods`"));
}

#[test]
fn a_long_run_grows_and_stops() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = browser
        .open(&lab.url("?scene=reference&size=1024x1024&mode=broadcast&cells=16&cells_run=programs"), (1280, 800));
    page.wait_for("!sides.a.growing.hidden && sides.a.growing.querySelector('img').naturalWidth === 1024");
    assert_eq!(page.eval("document.getElementById('stop').disabled"), false);
    page.wait_for("document.getElementById('progress').value > 0");
    page.key("Escape");
    page.wait_for("!isBusy() && document.getElementById('status').textContent === 'stopped'");
    // A newer change drops an older run.
    page.eval("set('size', '512x512')");
    page.wait_for("isBusy()");
    page.eval("sides.a.parameters.set('scene', 'room'); set('size', '16x16')");
    done(&page, 1);
    assert_eq!(page.eval("document.body.dataset.runs"), "1");
    page.assert_quiet();
}

#[test]
fn two_runs_have_one_axis_and_their_address_has_both() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=room&size=16x16", 1, (1600, 900));
    page.click_on("#beside");
    done(&page, 2);
    page.eval("set('grid_voxel', '39')");
    page.wait_for("location.hash.includes('grid_voxel=39') && !isBusy() && document.getElementById('differences').textContent.includes('slower')");
    let seconds = "[sides.a, sides.b].map(({ frame }) => frame.contentWindow.secondsShown())";
    let [a, b] = [0, 1].map(|at| page.eval(seconds)[at].as_f64().unwrap());
    assert!(b > 2.0 * a, "{a} {b}");
    let zoomed = "[sides.a, sides.b].map(({ frame }) => frame.contentWindow.zoomedTo())";
    let stretch = |at: usize| {
        page.eval(zoomed)[at].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect::<Vec<_>>()
    };
    let near =
        |one: Vec<f64>, other: Vec<f64>| one.iter().zip(&other).all(|(one, other)| (one - other).abs() < 1e-6 * b);
    assert!(near(stretch(0), vec![0.0, b]) && near(stretch(1), vec![0.0, b]), "{:?}", page.eval(zoomed));
    page.eval(&format!(
        "sides.b.frame.contentWindow.zoomSeconds({}, {}); sides.b.frame.contentWindow.onZoom({}, {})",
        a / 4.0,
        a / 2.0,
        a / 4.0,
        a / 2.0
    ));
    assert!(near(stretch(0), vec![a / 4.0, a / 2.0]) && near(stretch(1), vec![a / 4.0, a / 2.0]));
    let address = page.eval("location.search + location.hash").as_str().unwrap().to_owned();
    let again = opened(&browser, &lab, &address, 2, (1600, 900));
    for side in ["a", "b"] {
        assert_eq!(shown(&page, side).1, shown(&again, side).1);
        assert_eq!(again.eval(&format!("sides.{side}.told.cycles")), page.eval(&format!("sides.{side}.told.cycles")));
    }
    [page, again].iter().for_each(Page::assert_quiet);
}

#[test]
fn a_sweep_is_drawn_point_by_point() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=room&size=16x16&mode=broadcast", 1, (1280, 800));
    page.click_on("#tab-sweep");
    page.eval("swept.value = 'cells'; over.value = '1, 2, 4, 8'");
    page.click_on("#sweep-start");
    page.wait_for("document.body.dataset.points === '4' && !sweep.stop");
    let rows: Vec<Value> =
        page.eval("sweep.rows.map((row) => row[sweep.columns.indexOf('cycles')])").as_array().unwrap().clone();
    for (cells, cycles) in [1, 2, 4, 8].iter().zip(&rows) {
        let done = lab.get(&format!("/run?scene=room&size=16x16&mode=broadcast&cells={cells}")).done();
        assert_eq!(&Value::String(done["cycles"].to_string()), cycles);
    }
    assert!(page.eval("document.querySelector('#curve').getAttribute('aria-label')").as_str().unwrap().contains("8: "));
    assert!(page.eval("document.querySelector('#curve canvas').width").as_u64().unwrap() > 300);
    page.eval(
        "swept.value = 'mode'; over.value = 'pipeline, broadcast'; sides.a.parameters.delete('mode'); startSweep()",
    );
    page.wait_for("document.body.dataset.points === '2' && !sweep.stop");
    page.assert_quiet();
}

#[test]
fn scenes_are_dropped_on_the_page() {
    let Some(browser) = Browser::start() else { return };
    let (lab, folder) = (Lab::start(""), Folder::new());
    let page = opened(&browser, &lab, "?size=16x16", 1, (1280, 800));
    let choose = |name: &str| {
        let root = page.say("DOM.getDocument", json!({}))["root"]["nodeId"].clone();
        let node = page.say("DOM.querySelector", json!({ "nodeId": root, "selector": "#files" }))["nodeId"].clone();
        page.say("DOM.setFileInputFiles", json!({ "nodeId": node, "files": [folder.path(name)] }));
    };
    folder.file("mine.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.file("wrong.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    choose("mine.obj");
    page.wait_for("location.search.includes('mine.obj') && !isBusy()");
    assert_eq!(page.eval("sides.a.command.textContent"), "pcs-sim --scene mine.obj --size 16x16");
    assert!(shown(&page, "a").0.contains("scene mine (1 polygon)"));
    page.eval(
        "{ const dataTransfer = new DataTransfer();
           dataTransfer.items.add(new File(['v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv 1 1 0\\nf 1 2 3\\nf 2 3 4\\n'], 'dropped.obj'));
           document.body.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true })); }",
    );
    page.wait_for("location.search.includes('dropped.obj') && !isBusy()");
    assert!(shown(&page, "a").0.contains("scene dropped (2 polygons)"));
    choose("wrong.obj");
    page.wait_for("!sides.a.failure.hidden");
    assert_eq!(page.eval("sides.a.failure.textContent"), folder.run("--scene wrong.obj").refused().trim_end());
}

#[test]
fn the_frame_steps_to_cycles_that_it_does_not_hold() {
    let Some(browser) = Browser::start() else { return };
    let (lab, folder) = (Lab::start(""), Folder::new());
    let query = "scene=teapot&size=64x64&mode=hybrid&cells=4&fifo_words=16";
    // The frame by itself, so that what its scripts have can be asked for.
    let page = browser.open(&lab.url("view"), (1280, 800));
    page.eval(&format!(
        "(async () => {{ openDoors('{query}'); const text = await (await fetch('run?{query}')).text();
         const of = (name) => text.split('\\n\\n').find((event) => event.startsWith(`event: ${{name}}`)).split('\\n').slice(1).map((line) => line.slice(6)).join('\\n');
         show(JSON.parse(of('figures')), of('text')); }})()"
    ));
    let held = page.eval("[tape.until, run.cycles]");
    let (until, cycles) = (held[0].as_u64().unwrap(), held[1].as_u64().unwrap());
    assert!(until < cycles, "the page holds all of it");
    let far = until + (cycles - until) / 2;
    page.eval(&format!("stepper.seek('{far}')"));
    page.wait_for(&format!("stepper.cycle === {far}"));
    let there = page.eval(&format!("stateAt({far})"));
    let window = page.eval("`${tape.from}..${tape.until}`");
    let window = window.as_str().unwrap();
    let flags = "--scene teapot --size 64x64 --mode hybrid --cells 4 --fifo-words 16";
    folder.run(&format!("{flags} --page far.html --trace-window {window}")).success();
    let written = browser.open_file(&folder.path("far.html"), (1280, 800));
    let of_page = written.eval(&format!("stateAt({far})"));
    assert_eq!(there["stations"], of_page["stations"]);
    assert_eq!(there["fifos"], of_page["fifos"]);
    // 200 events on and 200 back.
    for (direction, times) in [(1, 200), (-1, 200)] {
        page.eval(&format!(
            "(async () => {{ for (let n = 0; n < {times}; n++) await stepper.step('event', {direction}); }})()"
        ));
    }
    assert_eq!(page.eval("stateAt(stepper.cycle)"), there);
    // Rays and moments anywhere: the last ray in the last cell, and as a FIFO next gets full.
    page.eval("stepper.seek('ray 4095 comes to cell 3')");
    page.wait_for(&format!("stepper.cycle > {far} && recordOf(3).jobs().job.includes(4095)"));
    let op = page.eval("recordOf(3).jobs().from[recordOf(3).jobs().job.indexOf(4095)] - stepper.cycle");
    assert_eq!(op, 0);
    page.assert_quiet();
}

/// What screen readers are told of everything that takes the focus.
#[test]
fn everything_that_takes_the_focus_has_a_name() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=room&size=16x16#scene=room&size=16x16&fifo_words=8", 2, (1600, 900));
    page.say("Accessibility.enable", json!({}));
    let tree = page.say("Accessibility.getFullAXTree", json!({}));
    let mut focusable = 0;
    for node in tree["nodes"].as_array().unwrap().iter().filter(|node| node["ignored"] == false) {
        let properties = node["properties"].as_array().cloned().unwrap_or_default();
        let is_focusable =
            properties.iter().any(|property| property["name"] == "focusable" && property["value"]["value"] == true);
        if is_focusable && node["role"]["value"] != "RootWebArea" {
            focusable += 1;
            let name = node["name"]["value"].as_str().unwrap_or_default();
            assert!(!name.trim().is_empty() || node["role"]["value"] == "generic", "{node}");
        }
    }
    assert!(focusable > 60, "{focusable}");
    // From the keyboard alone: along the tabs, and to a slider by Tab.
    page.eval("document.getElementById('tab-run').focus()");
    page.key("ArrowRight");
    assert_eq!(page.eval("document.activeElement.id"), "tab-differences");
    assert_eq!(page.eval("document.getElementById('panel-differences').hidden"), false);
    page.eval("document.getElementById('p-order').focus()");
    for _ in 0..4 {
        page.key("Tab");
    }
    assert!(
        page.eval(
            "document.activeElement.matches('#controls input, #controls select, #controls button, #controls summary')"
        ) == true
    );
    page.assert_quiet();
}

#[test]
fn nothing_is_cut_off_in_windows_of_any_size_on_white_and_on_black() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    for size in [(900, 700), (1600, 900)] {
        let page = opened(&browser, &lab, "?scene=room&size=16x16#scene=room&size=16x16&fifo_words=8", 2, size);
        for dark in [false, true] {
            page.dark(dark);
            let fits = "document.documentElement.scrollWidth <= innerWidth && document.documentElement.scrollHeight <= innerHeight \
                        && [...document.querySelectorAll('#controls, .command button, #tools')].every((part) => part.getBoundingClientRect().right <= innerWidth)";
            assert_eq!(page.eval(fits), true, "{size:?}");
            let ground = page.eval("getComputedStyle(document.body).backgroundColor");
            assert_eq!(ground == "rgb(255, 255, 255)", !dark);
            let controls =
                "document.getElementById('controls').scrollWidth <= document.getElementById('controls').clientWidth";
            assert_eq!(page.eval(controls), true, "{size:?}");
        }
        page.assert_quiet();
    }
}

/// Writes the README's first picture. `docs/lab.sh` runs it.
#[test]
#[ignore = "it writes docs/lab.png"]
fn the_readmes_picture_is_taken() {
    let browser = Browser::start().expect("a browser is needed");
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=teapot&size=64x64&mode=broadcast", 1, (1600, 1000));
    // The stepper where a cell is held up, with what its ray comes to.
    page.wait_for("sides.a.frame.contentDocument.querySelector('#stepper .walk')");
    page.eval("sides.a.frame.contentDocument.getElementById('step-by-step').scrollIntoView()");
    page.screenshot(std::path::Path::new("docs/lab.png"));
    page.assert_quiet();
}

/// How long the page takes from a slider's last move until the run is drawn: to be looked at on a quiet machine, in a release build.
#[test]
#[ignore = "it measures"]
fn a_sliders_answers_are_timed() {
    let browser = Browser::start().expect("a browser is needed");
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=teapot&size=256x256", 1, (1600, 900));
    for (name, values) in
        [("fifo_words", ["256", "128"]), ("grid_coefficient", ["40", "30"]), ("grid_voxel", ["7", "8"])]
    {
        let mut times: Vec<u64> = (0..10)
            .map(|at| {
                page.eval(&format!("document.body.dataset.runs = 0; set('{name}', '{}')", values[at % 2]));
                done(&page, 1);
                page.eval("document.body.dataset.answered").as_str().unwrap().parse().unwrap()
            })
            .collect();
        times.sort();
        println!("{name}: {} ms in the middle, {} ms at the most", times[times.len() / 2], times[times.len() - 1]);
    }
}
