//! A run step by step: what single rays come to, and the stepper of a page, in a browser, against the recording.

use std::convert::Infallible;

use crate::support::browser::{Browser, Page};
use crate::support::command::Folder;
use crate::support::pictures::decoded;
use crate::support::{bits, cell_options, ops, program, recorded, scene, workload};
use pcs_sim::isa::InstructionCycles;
use pcs_sim::measure::{Actor, JobSpan, Recording};
use pcs_sim::program::cells::CellOptions;
use pcs_sim::program::{ArrayProgram, Counts, Said, Visit, Workload};
use pcs_sim::quantities::{Cycles, Words};
use pcs_sim::run::{self, Setup, Workers};
use pcs_sim::seam::OpKind;
use serde_json::{Value, json};

/// What a visit would have been counted as.
fn counted(workload: &Workload, visit: &Visit) -> Counts {
    let has_slabs = workload.kernels_of(0).len() == 3 || workload.cells() / workload.groups() > 1;
    let voxels = || visit.groups.iter().flat_map(|group| &group.voxels);
    let tests = || voxels().flat_map(|voxel| &voxel.tests);
    let intersected = |said: &Said| matches!(said, Said::Missed | Said::Behind(_) | Said::Nearest(_));
    Counts {
        spared: Default::default(),
        voxels: voxels().count() as u64,
        slab_tests: tests().filter(|test| has_slabs && (intersected(&test.said) || test.said == Said::Dropped)).count()
            as u64,
        intersection_tests: tests().filter(|test| intersected(&test.said)).count() as u64,
        hits: visit.hit.is_hit() as u64,
    }
}

#[test]
fn a_rays_visit_is_what_the_run_counts() {
    let (scene, rays) = scene("room", 1, 24);
    let programs = [
        program("pipeline", 1),
        program("broadcast", 3),
        program("hybrid", 2),
        ArrayProgram { mailbox: true, ..program("pipeline", 1) },
        ArrayProgram { mailbox: true, ..program("hybrid", 3) },
        ArrayProgram { bounded_walk: true, ..program("broadcast", 3) },
    ];
    for program in programs {
        let workload = workload(&scene.mesh, &program, &rays);
        let outcome =
            run::run(&workload, &Default::default(), &rays, &Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap();
        let mut counts = Counts::default();
        for (ray, hit) in rays.iter().zip(&outcome.hits) {
            let visit = workload.visit(ray);
            assert_eq!(bits(&visit.hit), bits(hit), "{}", program.name);
            counts += counted(&workload, &visit);
        }
        assert_eq!(counts, outcome.counts, "{}, mailbox {}", program.name, program.mailbox);
        assert_eq!(
            workload.look(&rays).iter().map(bits).collect::<Vec<_>>(),
            outcome.hits.iter().map(bits).collect::<Vec<_>>()
        );
    }
}

/// With stop words a test that is counted may be of a candidate that another cell has not had.
#[test]
fn a_visit_ends_where_stop_words_end_the_walk() {
    let (scene, rays) = scene("room", 1, 24);
    for ahead in [1, 3] {
        let program = ArrayProgram { stop_words: Some(ahead), ..program("pipeline", 1) };
        let workload = workload(&scene.mesh, &program, &rays);
        let outcome =
            run::run(&workload, &Default::default(), &rays, &Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap();
        let visits: Vec<Visit> = rays.iter().map(|ray| workload.visit(ray)).collect();
        let voxels: usize = visits.iter().map(|visit| visit.groups[0].voxels.len()).sum();
        assert_eq!(voxels as u64, outcome.counts.voxels);
        let sums = visits.iter().fold(Counts::default(), |mut sum, visit| {
            sum += counted(&workload, visit);
            sum
        });
        assert_eq!(sums.intersection_tests, outcome.counts.intersection_tests);
        assert!(visits.iter().zip(&outcome.hits).all(|(visit, hit)| bits(&visit.hit) == bits(hit)));
    }
}

/// A cell's instructions and their waits take the cycles of its ops, and move their words.
#[test]
fn a_cells_instructions_are_its_ops() {
    for float_latency in [None, Some(28)] {
        let options = cell_options();
        let cycles = InstructionCycles { float_latency, ..options.cycles };
        instructions_are_ops(&CellOptions { cycles, ..options });
    }
}

fn instructions_are_ops(options: &CellOptions) {
    let (scene, rays) = scene("tetra", 1, 5);
    let workload = workload(&scene.mesh, &program("hybrid", 2), &rays).with_programs(options).unwrap();
    let batches = ops(&workload, &rays);
    let costs = workload.costs();
    for (id, ray) in (0..).zip(&rays) {
        for cell in 0..workload.cells() {
            let mut lines = batches.iter().flat_map(|batch| batch.cells[cell].lines());
            let ops = lines.find(|(job, _)| *job == id).unwrap().1;
            let work = ops.iter().filter_map(|op| Some(costs.of(op.unit()?).0 * u64::from(op.count()))).sum::<u64>();
            let moved = ops.iter().filter(|op| !matches!(op.kind(), OpKind::Work(_))).map(|op| op.count()).sum::<u32>();
            let steps = workload.instructions(cell, id, ray, usize::MAX);
            let executable = workload.executable(cell).unwrap();
            let cycles = |address| {
                let (before, behind) = executable.waits_at(address);
                executable.cycles_at(address) + (before + behind) * executable.wait_cycles()
            };
            assert_eq!(steps.iter().map(|step| cycles(step.address)).sum::<u64>(), work);
            let words = |address| executable.words_at(address).0 + executable.words_at(address).1;
            assert_eq!(steps.iter().map(|step| words(step.address)).sum::<usize>(), moved as usize);
            assert_eq!(steps[0].address, 0);
        }
    }
    assert_eq!(workload.instructions(0, 0, &rays[0], 7).len(), 7);
}

/// A run of the command with its page, and the same recorded here.
struct Shown {
    folder: Folder,
    setup: Setup,
    recording: Recording,
}

impl Shown {
    fn new(args: &str) -> Shown {
        let folder = Folder::new();
        folder.run(&format!("{args} --page run.html --stats run.json")).success();
        let stats = serde_json::from_str(&folder.read("run.json")).unwrap();
        let (setup, recording) = recorded(stats);
        Shown { folder, setup, recording }
    }

    fn open<'a>(&self, browser: &'a Browser, size: (u32, u32)) -> Page<'a> {
        browser.open_file(&self.folder.path("run.html"), size)
    }

    /// What the stepper is to say of a cycle.
    fn state(&self, at: Cycles) -> Value {
        let Recording { topology, stations, units, .. } = &self.recording;
        let moment = self.recording.moment(at).unwrap();
        let actors = [Actor::Host].into_iter().chain((0..stations.len()).map(Actor::Station));
        let states = moment.host.iter().chain(&moment.stations).map(|station| station.stretch.state);
        let station = |(actor, state): (Actor, _)| {
            let op = self.recording.op(actor, at).map(|told| {
                let what = match told.span.op.kind() {
                    OpKind::Work(unit) => units[usize::from(unit.0)].name.clone(),
                    kind => kind.letter().unwrap().to_string(),
                };
                let (from, until) = (told.span.from.0, told.span.until.0);
                json!({
                    "what": what, "count": told.span.op.count(), "job": told.span.job, "from": from, "until": until,
                    "done": told.done, "of": told.of,
                })
            });
            json!({ "state": topology.states.get(state).unwrap().name, "op": op })
        };
        let held = |fifo: usize| {
            let words = self.recording.words(fifo, at).unwrap();
            let runs = words.chunk_by(|a, b| a == b).map(|run| json!([run[0], run.len()]));
            (topology.fifos[fifo].name.clone(), runs.collect::<Value>())
        };
        json!({
            "cycle": at.0,
            "stations": actors.zip(states).map(station).collect::<Value>(),
            "fifos": Value::Object((0..topology.fifos.len()).map(held).collect()),
        })
    }
}

const RUN: &str = "--mode hybrid --cells 4 --scene room --size 12x10 --fifo-words 16";

#[test]
fn two_hundred_events_forward_and_back_are_the_recordings() {
    let Some(browser) = Browser::start() else { return };
    let shown = Shown::new(RUN);
    let page = shown.open(&browser, (1600, 900));
    // A cycle in which something changes; the way back from others leads to them, too.
    let start = shown.recording.stations[1].jobs[2].from;
    let quiet = "(async () => { stepper.go(9001); const first = JSON.stringify(stepper.state()); \
        for (let n = 0; n < 200; n++) await stepper.step('event', 1); \
        for (let n = 0; n < 200; n++) await stepper.step('event', -1); return JSON.stringify(stepper.state()) === first; })()";
    assert_eq!(page.eval(quiet), true);
    let seen = page.eval(&format!(
        "(async () => {{
          stepper.go({});
          const first = JSON.stringify(stepper.state()), forward = [], back = [];
          for (let n = 0; n < 200; n++) {{ await stepper.step('event', 1); forward.push(stepper.state()); }}
          for (let n = 0; n < 200; n++) {{ await stepper.step('event', -1); back.push(stepper.state()); }}
          return {{ forward, back, same: JSON.stringify(stepper.state()) === first }};
        }})()",
        start.0
    ));
    let next = std::iter::successors(Some(start), |&at| shown.recording.next_change(at));
    let expected: Vec<Value> = next.take(201).map(|at| shown.state(at)).collect();
    let [forward, back] = ["forward", "back"].map(|way| seen[way].as_array().unwrap());
    for (place, (seen, expected)) in forward.iter().zip(&expected[1..]).enumerate() {
        assert_eq!(seen, expected, "event {place}");
    }
    assert_eq!(back.iter().collect::<Vec<_>>(), expected[..200].iter().rev().collect::<Vec<_>>());
    assert_eq!(seen["same"], true);
    page.assert_quiet();
}

/// Any cycle of any window, with words that go to the left, slow wires, a long latency: the page says what the recording says.
#[test]
fn what_is_drawn_is_what_is_recorded() {
    let Some(browser) = Browser::start() else { return };
    let runs = [
        RUN.to_owned(),
        "--mode pipeline --scene room --size 9x7 --fifo-words 5 --link-mb-s 20 --latency-cycles 7".to_owned(),
        "--mode broadcast --cells 3 --scene tetra --size 9x7 --order shuffle:4 --rate-counts channel".to_owned(),
        "--mode hybrid --cells 4 --scene tetra --size 6x5 --cells-run programs".to_owned(),
        "--mode pipeline --scene room --size 6x5 --stop-words 2 --fifo-words 9".to_owned(),
    ];
    for run in runs {
        let shown = Shown::new(&run);
        let page = shown.open(&browser, (1280, 800));
        let end = shown.recording.window.end.0.min(page.eval("tape.until").as_u64().unwrap());
        assert!(end > 1000, "{run}: {end}");
        let cycles: Vec<u64> = (0..150).map(|n| n * 7919 * end / 1_000_003 % end).chain([0, end - 1]).collect();
        let seen = page.eval(&format!("{cycles:?}.map((cycle) => {{ stepper.go(cycle); return stepper.state(); }})"));
        for (&cycle, seen) in cycles.iter().zip(seen.as_array().unwrap()) {
            let mut expected = shown.state(Cycles(cycle));
            clip(&mut expected, end);
            assert_eq!(seen, &expected, "{run}, cycle {cycle}");
        }
        // What is read on the page is that too.
        let drawn = page.eval(
            "[...document.querySelectorAll('.store span')].map((label) => label.textContent.replaceAll(/\\s+/g, ' '))",
        );
        let last = shown.recording.moment(Cycles(end - 1)).unwrap();
        for (info, &Words(level)) in shown.recording.topology.fifos.iter().zip(&last.levels) {
            let label = format!("{} {level} of {}", info.name, info.capacity.unwrap().0);
            assert!(drawn.as_array().unwrap().iter().any(|text| *text == *label), "{run}: {label} in {drawn}");
        }
        page.assert_quiet();
    }
}

/// Ops end where the page's window does.
fn clip(state: &mut Value, end: u64) {
    for station in state["stations"].as_array_mut().unwrap() {
        if let Some(until) = station["op"]["until"].as_u64() {
            station["op"]["until"] = until.min(end).into();
        }
    }
}

#[test]
fn moments_are_found_by_questions() {
    let Some(browser) = Browser::start() else { return };
    let shown = Shown::new(RUN);
    let page = shown.open(&browser, (1280, 800));
    let Recording { topology, stations, fifos, answers, host, .. } = &shown.recording;
    let job = |jobs: &[JobSpan], ray: u32| jobs.iter().find(|span| span.job == ray).unwrap().from.0;
    let full = |name: &str| {
        let place = topology.fifos.iter().position(|fifo| fifo.name == name).unwrap();
        let capacity = topology.fifos[place].capacity;
        fifos[place].levels.iter().find(|level| Some(level.1) == capacity).unwrap().0.0
    };
    let waits = |cell: usize| {
        let kind = |stretch: &&pcs_sim::measure::Stretch| {
            topology.states.is(stretch.state, pcs_sim::measure::StateKind::Waits) && stretch.from > Cycles(0)
        };
        stations[cell].states.iter().find(kind).unwrap().from.0
    };
    let asked = [
        ("next time X2 is full", full("X2")),
        ("x2 full", full("X2")),
        ("cell 2 waits", waits(2)),
        ("ray 17 comes to cell 3", job(&stations[3].jobs, 17)),
        ("ray 17", job(&host.as_ref().unwrap().jobs, 17)),
        ("ray 17 comes back", job(answers, 17)),
        ("cycle 1 234", 1234),
        ("pixel 5 1", job(&host.as_ref().unwrap().jobs, 17)),
    ];
    for (text, expected) in asked {
        let found = page.eval(&format!("stepper.go(0), stepper.seek({text:?}).then(() => stepper.cycle)"));
        assert_eq!(found, expected, "{text}");
    }
    for wrong in ["X9 is full", "ray 9999", "what?", "cell 77 waits", "pixel 99 99", ""] {
        page.eval(&format!("stepper.go(5), stepper.seek({wrong:?})"));
        assert_eq!(page.eval("stepper.cycle"), 5, "{wrong}");
        let told = page.eval("document.querySelector('.told').textContent");
        let told = told.as_str().unwrap();
        assert!(
            told.contains("is no moment") || told.contains("does not come") || told.contains("is not among"),
            "{told}"
        );
    }
    page.assert_quiet();
}

#[test]
fn keys_the_picture_and_the_charts_move_the_moment() {
    let Some(browser) = Browser::start() else { return };
    let shown = Shown::new(RUN);
    let page = shown.open(&browser, (1280, 800));
    page.eval("stepper.go(100); document.querySelector('.around').focus()");
    let cycle = || page.eval("stepper.cycle").as_u64().unwrap();
    ["ArrowRight", "ArrowRight", "ArrowLeft"].into_iter().for_each(|key| page.key(key));
    assert_eq!(cycle(), 101);
    page.key("Shift+ArrowRight");
    assert_eq!(Some(Cycles(cycle())), shown.recording.next_change(Cycles(101)));
    page.key("Home");
    assert_eq!(cycle(), 0);
    page.eval("stepper.choose(0)");
    let at = cycle();
    page.key("]");
    let ops = &shown.recording.stations[0].ops;
    assert_eq!(cycle(), ops.iter().find(|op| op.from.0 > at).unwrap().from.0);
    page.key(" ");
    page.wait_for("stepper.cycle > 500");
    page.key(" ");
    assert_eq!(page.eval("stepper.playing"), Value::Null);
    // The first pixel's ray is followed, from the host to the host.
    page.eval("document.querySelector('#run header img').scrollIntoView()");
    let corner = page.eval(
        "(({ left, top }) => [left + 3, top + 3])(document.querySelector('#run header img').getBoundingClientRect())",
    );
    page.click(corner[0].as_f64().unwrap(), corner[1].as_f64().unwrap());
    page.wait_for("stepper.followed === 0");
    page.eval("stepper.go(0)");
    let mut stops = Vec::new();
    for _ in 0..30 {
        page.eval("stepper.stop(1)");
        stops.push(cycle());
    }
    let last = stops.last().unwrap();
    assert_eq!(*last, shown.recording.answers[0].from.0, "{stops:?}");
    // A click into a chart.
    let place = page.eval(
        "(() => { const { over } = charts[1].chart; over.scrollIntoView({ block: 'center' }); const { left, top, width, height } = over.getBoundingClientRect(); \
         return [left + width / 2, top + height / 2]; })()",
    );
    page.click(place[0].as_f64().unwrap(), place[1].as_f64().unwrap());
    let half = shown.recording.cycles.0 / 2;
    page.wait_for(&format!("Math.abs(stepper.cycle - {half}) < {half} / 100"));
    // A cell is chosen by a click, and its walk is drawn.
    page.click_on(".box[aria-pressed=false]");
    assert_eq!(page.eval("document.querySelectorAll('.box[aria-pressed=true]').length"), 1);
    assert!(page.eval("document.querySelectorAll('.walk rect').length").as_u64().unwrap() > 3);
    page.assert_quiet();
}

#[test]
fn cells_that_run_programs_are_stepped_by_instruction() {
    let Some(browser) = Browser::start() else { return };
    let shown = Shown::new("--mode hybrid --cells 4 --scene tetra --size 6x5 --cells-run programs");
    let page = shown.open(&browser, (1600, 900));
    // Each cell is done with its instructions for a ray in the cycle in which its ops are.
    let ends = page.eval(
        "Object.entries(run.looks.instructions).map(([key, text]) => {
           const [cell, ray] = key.split(' ').map(Number), times = instructionTimes(cell, ray, stepsOf(text));
           return [cell, ray, times[times.length - 1], times.length - 1];
         })",
    );
    assert!(ends.as_array().unwrap().len() > 60);
    for end in ends.as_array().unwrap() {
        let [cell, ray, until, count] = [0, 1, 2, 3].map(|place| end[place].as_u64().unwrap());
        let jobs = &shown.recording.stations[cell as usize].jobs;
        assert_eq!(
            jobs.iter().find(|span| u64::from(span.job) == ray).unwrap().until.0,
            until,
            "cell {cell}, ray {ray}"
        );
        let sent = &shown.setup.prepared.rays[ray as usize];
        let steps = shown.setup.workload.instructions(cell as usize, ray as u32, sent, usize::MAX);
        assert_eq!(steps.len() as u64, count);
    }
    // The registers behind 40 instructions of cell 0 for ray 3.
    let seen = page.eval(
        "(async () => {
           await stepper.seek('ray 3 comes to cell 0');
           stepper.go(recordOf(0).ops().from[recordOf(0).ops().job.indexOf(3)]);
           for (let n = 0; n < 40; n++) await stepper.step('instruction', 1);
           const there = document.querySelector('.program').textContent;
           for (let n = 0; n < 7; n++) await stepper.step('instruction', -1);
           for (let n = 0; n < 7; n++) await stepper.step('instruction', 1);
           const registers = document.querySelector('.registers').textContent;
           return { there, same: there === document.querySelector('.program').textContent, registers, now: document.querySelector('.listing .now').textContent };
         })()",
    );
    assert_eq!(seen["same"], true);
    assert!(seen["there"].as_str().unwrap().contains("Instruction 41 of"), "{seen}");
    let steps = shown.setup.workload.instructions(0, 3, &shown.setup.prepared.rays[3], 41);
    assert!(seen["now"].as_str().unwrap().starts_with(&steps[40].address.to_string()), "{seen}");
    let mut registers = std::collections::BTreeMap::new();
    steps[..40].iter().filter_map(|step| step.changed).for_each(|(register, word)| {
        registers.insert(register, word);
    });
    for (register, word) in registers.into_iter().filter(|(_, word)| (1..1 << 22).contains(word)) {
        assert!(seen["registers"].as_str().unwrap().contains(&format!("{register} {word}")), "{register}: {seen}");
    }
    page.assert_quiet();
}

/// Whatever the length of a run, its page is of bounded size; and it is the same every time.
#[test]
fn pages_are_bounded() {
    let folder = Folder::new();
    let run = "--mode broadcast --cells 8 --scene teapot --size 96x96 --threads";
    folder.run(&format!("{run} 1 --page a.html")).success();
    folder.run(&format!("{run} 3 --page b.html")).success();
    let page = folder.read("a.html");
    assert!(page == folder.read("b.html"));
    folder.run(&format!("{run} 2 --size 192x192 --page c.html").replacen("--size 96x96 ", "", 1)).success();
    for page in [page, folder.read("c.html")] {
        assert!(page.len() < 1_500_000, "{} bytes", page.len());
    }
}

/// The mean brightness of a picture, from 0 to 255.
fn brightness(path: &std::path::Path) -> f64 {
    let pixels = decoded(path).bytes;
    pixels.iter().map(|&value| f64::from(value)).sum::<f64>() / pixels.len() as f64
}

#[test]
fn the_steps_fit_narrow_and_wide_windows_light_and_dark() {
    let Some(browser) = Browser::start() else { return };
    let shown = Shown::new("--mode broadcast --cells 24 --scene tetra --size 6x5 --fifo-words 16");
    let page = shown.open(&browser, (1600, 900));
    page.eval("stepper.follow(3)");
    for width in [900, 1600] {
        page.resize(width, 900);
        for dark in [false, true] {
            page.dark(dark);
            page.wait_for(&format!("isDark() === {dark}"));
            assert_eq!(page.eval("document.documentElement.scrollWidth <= innerWidth"), true, "{width}");
            let picture = shown.folder.path("page.png");
            page.screenshot(&picture);
            let brightness = brightness(&picture);
            assert!(if dark { brightness < 90.0 } else { brightness > 180.0 }, "{width}, dark {dark}: {brightness}");
        }
    }
    // All that has an action has a name, and what is drawn is told.
    let unnamed = "[...document.querySelectorAll('.around :is(button, input, select)')].filter((one) => \
        !one.getAttribute('aria-label') && !one.textContent.trim() && !one.closest('label')).length";
    assert_eq!(page.eval(unnamed), 0);
    let untold = "[...document.querySelectorAll('.store canvas, .walk')].filter((one) => !one.getAttribute('aria-label')).length";
    assert_eq!(page.eval(untold), 0);
    page.assert_quiet();
}
