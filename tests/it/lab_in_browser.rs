//! The lab in a real browser: sliders, addresses, two runs, sweeps, dropped scenes, keys and names for screen readers.

use serde_json::{Value, json};

use crate::support::browser::{Browser, Page};
use crate::support::command::Folder;
use crate::support::lab::Lab;

/// The frames of the two runs.
const A: usize = 0;
const B: usize = 1;

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

/// Drops a file, made by an expression, on a window.
fn drop_on(page: &Page<'_>, window: &str, file: &str) {
    page.eval(&format!(
        "{{ const {{ DataTransfer, File, DragEvent, document }} = {window}, dataTransfer = new DataTransfer();
           dataTransfer.items.add({file});
           document.body.dispatchEvent(new DragEvent('drop', {{ dataTransfer, bubbles: true, cancelable: true }})); }}"
    ));
}

/// A scene of so many polygons as such an expression.
fn scene_of(polygons: usize, name: &str) -> String {
    let faces = "f 1 2 3\\n".repeat(polygons);
    format!("new File(['v 0 0 0\\nv 1 0 0\\nv 0 1 0\\n{faces}'], '{name}')")
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
    drop_on(&page, "window", &scene_of(2, "dropped.obj"));
    page.wait_for("location.search.includes('dropped.obj') && !isBusy()");
    assert!(shown(&page, "a").0.contains("scene dropped (2 polygons)"));
    // The same file can be chosen again.
    choose("mine.obj");
    page.wait_for("location.search.includes('mine.obj') && !isBusy()");
    assert_eq!(page.eval("document.getElementById('files').value"), "");
    page.eval("set('scene', 'room')");
    page.wait_for("!isBusy()");
    choose("mine.obj");
    page.wait_for("location.search.includes('mine.obj') && !isBusy()");
    choose("wrong.obj");
    page.wait_for("!sides.a.failure.hidden");
    assert_eq!(page.eval("sides.a.failure.textContent"), folder.run("--scene wrong.obj").refused().trim_end());
}

/// What is dropped on a run is for that run, whichever the controls are about.
#[test]
fn scenes_are_dropped_on_either_run_and_what_fails_is_told_there() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=room&size=8x8#scene=tetra&size=8x8", 2, (1600, 900));
    drop_on(&page, "sides.b.frame.contentWindow", &scene_of(3, "of_b.obj"));
    page.wait_for("location.hash.includes('of_b.obj') && !isBusy()");
    assert!(shown(&page, "b").0.contains("scene of_b (3 polygons)"));
    assert_eq!(page.eval("location.search"), "?scene=room&size=8x8");
    page.click_on("[name=which][value=b]");
    drop_on(&page, "sides.a.frame.contentWindow", &scene_of(4, "of_a.obj"));
    page.wait_for("location.search.includes('of_a.obj') && !isBusy()");
    assert!(page.eval("location.hash").as_str().unwrap().contains("of_b.obj"));
    // The page's own ground is for the run that the controls are about.
    drop_on(&page, "window", &scene_of(5, "of_page.obj"));
    page.wait_for("location.hash.includes('of_page.obj') && !isBusy()");
    assert!(page.eval("location.search").as_str().unwrap().contains("of_a.obj"));
    page.assert_quiet();
    // A file that has gone since, and a thing that is no file.
    page.eval("take([{ name: 'gone.obj' }], sides.b)");
    page.wait_for("!sides.b.failure.hidden");
    let told = page.eval("sides.b.failure.textContent");
    assert!(told.as_str().unwrap().contains("the scene was not taken"), "{told}");
    page.eval(
        "sides.b.failure.hidden = true; FileReader.prototype.readAsDataURL = function () {
        Object.defineProperty(this, 'error', { value: new DOMException('it was moved') }); this.onerror(); }",
    );
    drop_on(&page, "sides.b.frame.contentWindow", &scene_of(1, "moved.obj"));
    page.wait_for("!sides.b.failure.hidden");
    let told = page.eval("sides.b.failure.textContent");
    assert_eq!(told, "error: the scene was not taken: moved.obj cannot be read: it was moved");
    page.eval("take([], sides.b)");
    assert_eq!(page.eval("document.getElementById('status').textContent"), "What was dropped is no file");
}

#[test]
fn keys_are_the_pages_in_a_runs_frame_too() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=room&size=8x8#scene=tetra&size=8x8", 2, (1280, 800));
    // To the run by the link for the keyboard: both runs stay, and so does the address.
    page.eval("document.querySelector('.skip').focus()");
    page.key("Enter");
    page.wait_for("document.activeElement.id === 'panels'");
    assert_eq!(
        page.eval("[isPair(), location.search, location.hash]"),
        json!([true, "?scene=room&size=8x8", "#scene=tetra&size=8x8"])
    );
    page.eval("sides.a.parameters = parametersOf('scene=reference&size=1024x1024&mode=broadcast&cells=16&cells_run=programs'); changed(sides.a)");
    page.wait_for("!sides.a.growing.hidden");
    page.eval_in(A, "document.querySelector('.around').focus()");
    assert_eq!(page.eval("document.activeElement === sides.a.frame"), true);
    page.key("Escape");
    page.wait_for("!isBusy() && document.getElementById('status').textContent === 'stopped'");
    page.assert_quiet();
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

#[test]
fn a_run_is_played_past_the_cycles_that_the_page_holds() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=teapot&size=64x64&mode=hybrid&cells=4&fifo_words=16", 1, (1280, 800));
    let held = page.eval_in(A, "[tape.until, run.cycles]");
    let (until, cycles) = (held[0].as_u64().unwrap(), held[1].as_u64().unwrap());
    assert!(until < cycles, "the page holds all of it");
    page.eval_in(A, "stepper.speed = SPEEDS.length - 1; stepper.go(tape.until - 2000); stepper.play()");
    page.wait_in(A, &format!("stepper.cycle > {until} && stepper.playing !== null"));
    // What rays come to may be told meanwhile: nobody is interrupted, and nothing else is chosen.
    page.eval_in(A, "stepper.choose(2); stepper.follow(17); before = stepper; showLooks(run.looks)");
    assert_eq!(
        page.eval_in(A, "[stepper === before, stepper.playing !== null, stepper.station, stepper.followed]"),
        json!([true, true, 2, 17])
    );
    // To the end of the run, where it says so.
    page.eval_in(A, "stepper.seek(String(run.cycles - 3000)).then(() => stepper.play())");
    page.wait_in(A, "stepper.cycle === run.cycles - 1 && stepper.playing === null");
    assert_eq!(page.eval_in(A, "stepper.told.textContent"), "The run ends here.");
    page.assert_quiet();
}

#[test]
fn of_many_questions_the_last_is_answered_and_the_others_are_given_up() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=teapot&size=64x64&mode=hybrid&cells=4&fifo_words=16", 1, (1280, 800));
    page.eval_in(A, "signals = []; asks = fetch; fetch = (path, how) => { if (path.startsWith('window')) signals.push(how.signal); return asks(path, how); }",
    );
    let told = page.eval_in(
        A,
        "(async () => { const cycle = (n) => Math.floor(run.cycles * (0.4 + n * 0.03));
           await Promise.all(Array.from({ length: 20 }, (_, n) => stepper.seek(String(cycle(n)))));
           return [stepper.cycle - cycle(19), signals.length, signals.filter(({ aborted }) => aborted).length, stepper.told.textContent]; })()",
    );
    assert_eq!(told[0], 0);
    assert_eq!((&told[1], &told[2]), (&json!(20), &json!(19)));
    assert!(told[3].as_str().unwrap().starts_with("Cycle "), "{told}");
    page.assert_quiet();
}

/// A click on a pixel, of which the page itself does not know the ray.
#[test]
fn a_pixel_in_the_frame_is_its_ray() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let query = "scene=teapot&size=64x64&order=hilbert&mode=hybrid&cells=4&fifo_words=16";
    let page = opened(&browser, &lab, &format!("?{query}"), 1, (1280, 800));
    page.wait_in(A, "document.querySelector('header img').classList.contains('pickable')");
    let place = page.eval(
        "(() => { const frame = sides.a.frame.getBoundingClientRect(), image = sides.a.frame.contentDocument.querySelector('header img');
           image.scrollIntoView(); const { left, top } = image.getBoundingClientRect();
           return [frame.left + left + image.clientLeft, frame.top + top + image.clientTop, image.clientWidth, image.clientHeight]; })()",
    );
    let [left, top, width, height] = [0, 1, 2, 3].map(|at| place[at].as_f64().unwrap());
    for (x, y) in [(60, 2), (33, 40)] {
        let ray = lab.get(&format!("/ray/{x}/{y}?{query}")).body;
        page.click(left + (f64::from(x) + 0.5) / 64.0 * width, top + (f64::from(y) + 0.5) / 64.0 * height);
        page.wait_in(A, &format!("stepper.followed === {ray}"));
        // The moment is that at which the host sends it.
        let sent = lab.get(&format!("/find/0/ray/{ray}?{query}")).body;
        page.wait_in(A, &format!("stepper.cycle === {sent}"));
    }
    page.assert_quiet();
}

#[test]
fn a_lab_that_has_ended_is_told_in_words() {
    let Some(browser) = Browser::start() else { return };
    let mut lab = Lab::start("");
    let query = "scene=teapot&size=64x64&mode=hybrid&cells=4&fifo_words=16";
    let page = opened(&browser, &lab, &format!("?{query}#{query}"), 2, (1280, 800));
    // Where the page holds no more, its words are the lab's, not those of the command's flags.
    page.eval_in(A, "tell(0, run.cycles - 1)");
    let told = page.eval_in(A, "document.getElementById('moment').textContent");
    assert!(told.as_str().unwrap().ends_with("a click goes to this one"), "{told}");
    page.eval_in(A, "stepper.seek('ray 9999')");
    page.wait_in(A, "stepper.told.textContent === '“ray 9999” does not come in the run.'");
    page.eval_in(A, "stepper.seek('pixel 64 0')");
    page.wait_in(A, "stepper.told.textContent === 'No ray is sent through pixel 64, 0.'");
    page.assert_quiet();
    assert_eq!(lab.interrupt(), Some(130));
    let gone = "error: the lab does not answer: ";
    for asked in
        ["stepper.seek(String(run.cycles - 1))", "stepper.seek('ray 4000 comes back')", "stepper.seek('pixel 60 60')"]
    {
        page.eval_in(A, &format!("stepper.say(''); {asked}"));
        page.wait_in(A, &format!("stepper.told.textContent.startsWith('{gone}')"));
    }
    page.eval_in(A, "stepper.say(''); stepper.speed = SPEEDS.length - 1; stepper.go(tape.until - 2); stepper.play()");
    page.wait_in(A, &format!("stepper.told.textContent.startsWith('{gone}') && stepper.playing === null"));
    page.eval("set('size', '32x32')");
    page.wait_for(&format!("sides.a.failure.textContent.startsWith('{gone}')"));
    page.eval("choose('sweep'); startSweep()");
    page.wait_for(&format!("document.getElementById('sweep-failure').textContent.startsWith('{gone}')"));
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

/// In narrow windows, too, every panel has its width: nothing on the page, in a run, or in the tables' own frames is beyond it. At 900
/// pixels the tables need no sliding either.
#[test]
fn nothing_is_wider_than_its_window() {
    let Some(browser) = Browser::start() else { return };
    let lab = Lab::start("");
    let page = opened(&browser, &lab, "?scene=room&size=16x16#scene=room&size=16x16&fifo_words=8", 2, (1600, 900));
    page.eval("swept.value = 'fifo_words'; over.value = '1, 4, 512'; startSweep()");
    page.wait_for("document.body.dataset.points === '3' && !sweep.stop");
    for width in [1600, 900, 400] {
        page.resize(width, 800);
        for panel in ["run", "differences", "sweep", "last"] {
            page.eval(&format!("choose('{panel}')"));
            let inner = if width < 900 { "" } else { ", .table" };
            let wide = page.eval(&format!(
                "[document.documentElement, ...document.querySelectorAll('#controls, #panels, #panel-{panel}, .command{inner}')]
                 .filter((part) => part.checkVisibility() && part.scrollWidth > part.clientWidth).map((part) => `${{part.id || part.className || part.tagName}}: ${{part.scrollWidth}} > ${{part.clientWidth}}`)"
            ));
            assert_eq!(wide, json!([]), "{panel} at {width} pixels");
        }
        page.eval("choose('run')");
        for side in [A, B] {
            page.wait_in(side, "document.documentElement.scrollWidth <= document.documentElement.clientWidth");
        }
    }
    // What a run took stands there in short.
    assert_eq!(page.eval("document.querySelector('#last tbody td:nth-child(2)').textContent.split(' ').length"), 2);
    page.assert_quiet();
}

/// A browser that never is ready fails a test, and does not hold it up for ever.
#[cfg(unix)]
#[test]
fn a_browser_that_hangs_is_waited_for_no_longer_than_that() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let at = listener.local_addr().unwrap();
    let said = format!("echo DevTools listening on ws://{at}/devtools >&2");
    for (says, why) in [("", "does not say where it listens"), (&said, "does not answer")] {
        let program = folder.file("browser", format!("#!/bin/sh\n{says}\nexec sleep 600\n"));
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
        let begun = std::time::Instant::now();
        let refused = Browser::launch(&program, std::time::Duration::from_secs(2)).err().unwrap();
        assert!(refused.contains(why), "{refused}");
        assert!(begun.elapsed().as_secs() < 30);
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
