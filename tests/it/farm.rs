//! The farm: the thesis's nine times, closed forms, bounds, and a model that ticks every nanosecond.

use std::collections::BTreeMap;
use std::convert::Infallible;

use proptest::prelude::*;

use crate::support::farm_looking_back::{Parts, look_back};
use crate::support::farm_ticking::{Plan, Ticked, tick, tick_recorded};
use pcs_sim::cancel::Cancel;
use pcs_sim::machine::events::{Buses, Events, Turn};
use pcs_sim::machine::{Capitan, CapitanFile, Cycles, HostTimes, KernelTimes, TaskCosts};
use pcs_sim::measure::{
    Actor, Cause, CriticalPath, JobSpan, Measured, Observed, Recording, StateTimes, StationRecord, Stretch,
};
use pcs_sim::program::farm::{Farm, HandOut, ItemKind, Items, SceneBy};
use pcs_sim::run::{
    self, FarmOutcome, FarmRunOptions, FarmSpec, Layers, Picture, PlannedRun, RunOptions, RunSpec, Watching, Workers,
};

/// A farm by the names of its parameters.
fn farm(parameters: &[(&str, &str)]) -> FarmOutcome {
    let mut options = FarmRunOptions::default();
    parameters.iter().for_each(|(name, value)| options.set(name, value).unwrap());
    let spec = FarmSpec::new(&options, None).unwrap();
    let machine = spec.machine.build().unwrap();
    let scene = spec.lay_out(&Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
    let items = spec.cut(&scene, &machine).unwrap();
    spec.run((&scene, &machine, &items), &Watching::default(), &Cancel::default()).unwrap()
}

fn seconds(outcome: &FarmOutcome) -> f64 {
    Capitan::CLOCK.seconds(outcome.stats.cycles)
}

/// Annex B: 100 x 100 pixels on 1 to 8 workers, and 512 lines of 640 on 8.
const TIMES: [(&str, &str, f64); 9] = [
    ("100x100", "1", 28.8),
    ("100x100", "2", 15.4),
    ("100x100", "3", 11.3),
    ("100x100", "4", 9.4),
    ("100x100", "5", 8.1),
    ("100x100", "6", 7.2),
    ("100x100", "7", 6.5),
    ("100x100", "8", 6.4),
    ("640x512", "8", 76.6),
];

#[test]
fn the_thesis_s_nine_times_come_out() {
    for (size, tasks, published) in TIMES {
        let outcome = farm(&[("scene", "rectangles"), ("size", size), ("tasks", tasks)]);
        let off = seconds(&outcome) / published - 1.0;
        assert!(off.abs() < 0.05, "{tasks} workers at {size}: {:.2} s, {:+.1} %", seconds(&outcome), 100.0 * off);
        if size == "640x512" {
            // One program on the thesis's Sun 3/110: 546.4 s, or 576.4, as its own quotient has it.
            let alone = Capitan::CLOCK.seconds(outcome.one_program);
            assert!((546.4..576.4).contains(&alone), "{alone}");
        }
    }
}

/// The standard machine without a fraction of a nanosecond, to change.
fn capitan() -> Capitan {
    CapitanFile::standard().unwrap().build().unwrap()
}

/// Runs the tasks, watched over all of its time.
fn run(machine: &Capitan, items: &Items, scene: (u64, SceneBy), workers: (usize, HandOut)) -> (Measured, Observed) {
    let mut farm = Farm::new(machine, items, scene, workers);
    let events = Events::new(farm.topology(), machine.buses.clone(), Farm::SENDING_AND_IDLE);
    let events = events.explained(farm.explanation(), Farm::sending);
    let mut events = events.probed().recorded(Cycles(0)..Cycles(u64::MAX), Recording::MOST_EVENTS);
    while events.step(&mut |task, _, turn| {
        let taken = turn.taken();
        turn.act(farm.next(task, taken.as_ref()));
    }) {}
    events.finish().unwrap()
}

fn items(times: &[Vec<u64>]) -> Items {
    let items: Vec<Vec<Cycles>> = times.iter().map(|item| item.iter().copied().map(Cycles).collect()).collect();
    Items::new("item", &items)
}

/// fixed + 2 per_cap + (S + 1) 3 message + S segment + the pixels, and what the buses add to messages that are waited for.
#[test]
fn one_worker_takes_what_the_closed_form_says() {
    for kind in [ItemKind::Segments, ItemKind::Lines, ItemKind::Pixels, ItemKind::Tiles] {
        let name = format!("{}s", kind.noun());
        let outcome = farm(&[("scene", "rectangles"), ("size", "50x40"), ("tasks", "1"), ("items", &name)]);
        let (machine, count) = (capitan(), outcome.items as u64);
        let TaskCosts { fixed, per_cap, message, segment, pixel, .. } = machine.costs;
        let bus = |inside: u64| machine.buses.time(machine.header_bytes + inside).0;
        let expected = fixed.0
            + 2 * (per_cap.0 + bus(16 * 16))
            + (count + 1) * (3 * message.0 + 2 * bus(0))
            + count * (segment.0 + bus(8))
            + bus(4)
            + 2000 * pixel.0;
        assert_eq!(outcome.stats.cycles, Cycles(expected), "{name}");
        assert_eq!(outcome.one_program, Cycles(fixed.0 + count * segment.0 + 2000 * pixel.0));
    }
}

/// Random work on a small machine.
fn plan() -> impl Strategy<Value = Plan> {
    let time = || prop_oneof![Just(0u64), 0u64..12];
    let pixels = prop::collection::vec(time(), 1..5);
    let rest = (1usize..4, prop_oneof![Just(0u64), Just(40), Just(250), Just(1000)], 0u64..20, 0u64..30);
    let ways = (prop::bool::ANY, prop::bool::ANY);
    let costs = (0u64..30, time(), time(), time(), time());
    (1usize..6, prop::collection::vec(pixels, 0..12), costs, rest, ways).prop_map(
        |(workers, items, (fixed, per_cap, message, segment, color), rest, (deals, broadcasts))| {
            let (buses, byte_ps, header, scene_bytes) = rest;
            let hand_out = if deals { HandOut::Dealt } else { HandOut::Request };
            let scene_by = if broadcasts { SceneBy::Broadcast } else { SceneBy::Copies };
            Plan {
                workers,
                items,
                fixed,
                per_cap,
                message,
                segment,
                color,
                buses,
                byte_ps,
                header,
                scene_bytes,
                hand_out,
                scene_by,
            }
        },
    )
}

fn machine(plan: &Plan) -> Capitan {
    let costs = TaskCosts {
        fixed: Cycles(plan.fixed),
        per_cap: Cycles(plan.per_cap),
        message: Cycles(plan.message),
        segment: Cycles(plan.segment),
        pixel: Cycles(0),
        color: Cycles(plan.color),
    };
    Capitan { costs, buses: Buses::new(plan.buses, plan.byte_ps), header_bytes: plan.header, ..capitan() }
}

fn run_plan(plan: &Plan) -> (Measured, Observed) {
    let scene = (plan.scene_bytes, plan.scene_by);
    run(&machine(plan), &items(&plan.items), scene, (plan.workers, plan.hand_out))
}

/// A run in the words of the model that ticks.
fn told(run: &Measured) -> Ticked {
    let states = |times: &StateTimes| {
        let all = run.topology.states.all().iter().map(|state| (state.name.clone(), times.of(state.id).0));
        all.filter(|(_, time)| *time > 0).collect::<BTreeMap<_, _>>()
    };
    Ticked { time: run.cycles.0, tasks: run.stations.iter().map(states).collect() }
}

/// The parts of a cost that can be raised.
const COSTS: usize = 6;

fn raised(plan: &Plan, cost: usize, by: u64) -> Plan {
    let mut plan = plan.clone();
    match cost {
        0 => plan.fixed += by,
        1 => plan.per_cap += by,
        2 => plan.message += by,
        3 => plan.segment += by,
        4 => plan.color += by,
        _ => plan.items.iter_mut().flatten().take(by as usize).for_each(|pixel| *pixel += by),
    }
    plan
}

/// A path in words.
fn in_words(path: &CriticalPath) -> Parts {
    let mut parts = Parts::new();
    for part in path.parts() {
        let (Actor::Station(task), Cause::Work(unit)) = (part.at, part.cause) else { panic!("{part:?}") };
        let name = path.units[unit].name.clone();
        assert!(parts.insert((task, name), (part.cycles.0, part.count)).is_none());
    }
    parts
}

/// What can be changed, by the names that paths have for it.
const CHANGEABLE: [&str; 7] =
    ["fixed_ms", "per_cap_ms", "message_ms", "segment_ms", "color_ms", "pixel_ms", "bus_message"];

/// How often a time lies on the path.
fn slope(plan: &Plan, cost: usize) -> u64 {
    let parts = in_words(&run_plan(plan).1.path.unwrap());
    parts.iter().filter(|((_, name), _)| name == CHANGEABLE[cost]).map(|(_, (_, count))| count).sum()
}

/// The same with that time longer or shorter, if it can be. (A message on a bus is, where a byte takes a nanosecond, by its header.)
fn changed(plan: &Plan, cost: usize, by: i64) -> Option<Plan> {
    let mut plan = plan.clone();
    let mut all: Vec<&mut u64> = match cost {
        0 => vec![&mut plan.fixed],
        1 => vec![&mut plan.per_cap],
        2 => vec![&mut plan.message],
        3 => vec![&mut plan.segment],
        4 => vec![&mut plan.color],
        5 => plan.items.iter_mut().flatten().collect(),
        _ if plan.byte_ps == 1000 => vec![&mut plan.header],
        _ => return None,
    };
    all.iter_mut().try_for_each(|time| {
        **time = time.checked_add_signed(by)?;
        Some(())
    })?;
    Some(plan)
}

/// Most slopes are what a nanosecond more and one less come to, and all causes occur: else the properties say little.
#[test]
fn slopes_are_pinned_by_their_neighbours() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut seen: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for _ in 0..1000 {
        let plan = plan().new_tree(&mut runner).unwrap().current();
        let (whole, history) = tick_recorded(&plan);
        for (cost, name) in CHANGEABLE.iter().enumerate() {
            let slope = slope(&plan, cost) as i64;
            let neighbours = [-1, 1].map(|by| {
                let (after, new) = tick_recorded(&changed(&plan, cost, by)?);
                (new.order() == history.order()).then_some((after.time as i64 - whole.time as i64) * by)
            });
            let [Some(less), Some(more)] = neighbours else { continue };
            let (pinned, all) = seen.entry(name).or_default();
            *all += usize::from(slope > 0);
            *pinned += usize::from(slope > 0 && less == slope && more == slope);
        }
    }
    assert!(seen.len() == CHANGEABLE.len(), "{seen:?}");
    assert!(seen.values().all(|&(pinned, all)| all >= 5 && 2 * pinned > all), "{seen:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// To the nanosecond, in every state of every task; and what is seen over time is the same time.
    #[test]
    fn a_model_that_ticks_agrees(plan in plan()) {
        let (measured, observed) = run_plan(&plan);
        prop_assert_eq!(told(&measured), tick(&plan));
        prop_assert_eq!(measured.jobs as usize, plan.items.len());
        prop_assert!(measured.stations.iter().all(|times| times.total() == measured.cycles));
        let (profile, recording) = (observed.profile.unwrap(), observed.recording.unwrap());
        // A run of no time has no bins to count in.
        let counted = if measured.cycles > Cycles(0) { measured.jobs } else { 0 };
        prop_assert_eq!(profile.jobs.iter().sum::<u64>(), counted);
        prop_assert_eq!(profile.latency.jobs, measured.jobs);
        for (task, times) in measured.stations.iter().enumerate() {
            prop_assert_eq!(&StateTimes::sum(&profile.stations[task]), times);
            let mut recorded = StateTimes::default();
            let mut now = Cycles(0);
            for stretch in &recording.stations[task].states {
                prop_assert_eq!(stretch.from, now, "without a gap");
                now = stretch.until;
                *recorded.of_mut(stretch.state) += stretch.until - stretch.from;
            }
            prop_assert_eq!(&recorded, times);
            let jobs = &recording.stations[task].jobs;
            prop_assert!(jobs.windows(2).all(|pair| pair[0].until <= pair[1].from));
            let lies_over = |stretch: &Stretch, border: Cycles| stretch.from < border && border < stretch.until;
            for border in jobs.iter().flat_map(|job| [job.from, job.until]) {
                let states = &recording.stations[task].states;
                prop_assert!(!states.iter().any(|stretch| lies_over(stretch, border)), "cut where jobs begin and end");
            }
        }
    }

    /// Every part of the critical path is what a walk back through all that the model did comes to; they sum to the run, in its
    /// bins too.
    #[test]
    fn the_critical_path_is_a_walk_back(plan in plan()) {
        let (measured, observed) = run_plan(&plan);
        let (path, profile) = (observed.path.unwrap(), observed.profile.unwrap());
        let (ticked, history) = tick_recorded(&plan);
        prop_assert_eq!(path.cycles, measured.cycles);
        if ticked.time > 0 {
            prop_assert_eq!(in_words(&path), look_back(&history, ticked.time));
        }
        let sum = |bin: &Vec<pcs_sim::measure::PathPart>| bin.iter().map(|part| part.cycles.0).sum::<u64>();
        prop_assert_eq!(path.bins.iter().map(sum).sum::<u64>(), path.cycles.0);
        prop_assert_eq!((path.bin, path.bins.len()), (profile.bin, profile.jobs.len()));
        let last = path.bins.len().saturating_sub(1);
        prop_assert!(path.bins.iter().take(last).all(|bin| sum(bin) == path.bin.0), "each bin is full");
    }

    /// As long as all come in the order in which they did, the straight line bounds the true time from below, whatever changes and
    /// however much; so a slope lies between the changes for a nanosecond less and one more.
    #[test]
    fn slopes_bound_the_true_time(plan in plan(), cost in 0..CHANGEABLE.len(), by in 1u64..40) {
        let (whole, history) = tick_recorded(&plan);
        let slope = slope(&plan, cost);
        if let Some(later) = changed(&plan, cost, by as i64) {
            let (after, new) = tick_recorded(&later);
            if new.order() == history.order() {
                prop_assert!(after.time >= whole.time + by * slope, "{after:?}");
            }
        }
        if let Some(earlier) = changed(&plan, cost, -1) {
            let (after, new) = tick_recorded(&earlier);
            if new.order() == history.order() {
                prop_assert!(after.time + slope >= whole.time, "{after:?}");
            }
        }
    }

    /// No anomaly: where nobody has to wait for another's message, nothing that takes longer makes the whole shorter: that is so
    /// for one worker, and for many whose messages take no time. (Else what comes later may let a more urgent message go first, on
    /// a bus or at the master, and the whole may end a little earlier.)
    #[test]
    fn the_time_never_falls_when_a_cost_rises(plan in plan(), cost in 0..COSTS, by in 1u64..20, alone: bool) {
        let plan = Plan { byte_ps: 0, ..plan };
        let plan = if alone { Plan { workers: 1, ..plan } } else { Plan { message: 0, ..plan } };
        let (before, after) = (run_plan(&plan).0.cycles, run_plan(&raised(&plan, cost, by)).0.cycles);
        prop_assert!(before <= after, "{before} {after}");
    }

    /// A recording that holds fewer events ends earlier, before too many of them, and is else the same.
    #[test]
    fn a_recording_that_is_cut_is_the_start_of_the_whole(plan in plan(), most in 1usize..60, from in 0u64..200) {
        let record = |most| {
            let (machine, items) = (machine(&plan), items(&plan.items));
            let mut farm = Farm::new(&machine, &items, (plan.scene_bytes, plan.scene_by), (plan.workers, plan.hand_out));
            let events = Events::new(farm.topology(), machine.buses.clone(), Farm::SENDING_AND_IDLE);
            let mut events = events.recorded(Cycles(from)..Cycles(u64::MAX), most);
            while events.step(&mut |task, _, turn| { let taken = turn.taken(); turn.act(farm.next(task, taken.as_ref())); }) {}
            events.finish().unwrap().1.recording.unwrap()
        };
        let (whole, part) = (record(usize::MAX / 2), record(most));
        let starts = |recording: &Recording| {
            let events = |station: &StationRecord| {
                let states = station.states.iter().map(|stretch| stretch.from);
                states.chain(station.jobs.iter().map(|job| job.from)).collect::<Vec<_>>()
            };
            let sent = recording.messages.iter().map(|message| message.sent);
            let mut starts: Vec<Cycles> = recording.stations.iter().flat_map(events).chain(sent).collect();
            starts.sort();
            starts
        };
        prop_assert!(whole.messages.is_sorted_by_key(|message| message.sent));
        let end = starts(&whole).get(most).copied();
        prop_assert_eq!((part.window.end, part.cut), (end.unwrap_or(whole.window.end), end.is_some()));
        // The last of a whole run may set out as it ends.
        let sent = whole.messages.iter().filter(|message| message.sent < part.window.end || !part.cut);
        prop_assert!(part.messages.iter().eq(sent));
        for (task, (part_of, whole_of)) in part.stations.iter().zip(&whole.stations).enumerate() {
            let states = whole_of.states.iter().filter(|stretch| stretch.from < part.window.end);
            let states: Vec<_> =
                states.map(|stretch| Stretch { until: stretch.until.min(part.window.end), ..*stretch }).collect();
            let jobs = whole_of.jobs.iter().filter(|job| job.from < part.window.end);
            let jobs: Vec<_> = jobs.map(|job| JobSpan { until: job.until.min(part.window.end), ..*job }).collect();
            prop_assert_eq!(part_of, &StationRecord { states, jobs, ops: Vec::new() }, "task {}", task);
        }
    }

    /// Buses only ever add.
    #[test]
    fn buses_never_make_it_shorter(plan in plan()) {
        let free = Plan { byte_ps: 0, ..plan.clone() };
        prop_assert!(run_plan(&free).0.cycles <= run_plan(&plan).0.cycles);
    }

    /// Free messages, equal items of w, the scene broadcast: fixed + per_cap + ceil(S / n) w.
    #[test]
    fn equal_items_come_in_rounds(plan in plan(), count in 0usize..40, w in 0u64..50) {
        let plan = Plan {
            items: vec![vec![w]; count], message: 0, byte_ps: 0, segment: 0, color: 0,
            scene_by: SceneBy::Broadcast, ..plan
        };
        let rounds = count.div_ceil(plan.workers) as u64;
        prop_assert_eq!(run_plan(&plan).0.cycles, Cycles(plan.fixed + plan.per_cap + rounds * w));
    }

    /// Free messages: the shared work takes no less than its mean and its longest item, and no more than both together.
    #[test]
    fn shared_work_lies_between_its_bounds(plan in plan()) {
        let plan = Plan {
            message: 0, byte_ps: 0, color: 0, scene_by: SceneBy::Broadcast, hand_out: HandOut::Request, ..plan
        };
        let shared = run_plan(&plan).0.cycles.0 - plan.fixed - plan.per_cap;
        let times: Vec<u64> = plan.items.iter().map(|item| plan.segment + item.iter().sum::<u64>()).collect();
        let (total, longest) = (times.iter().sum::<u64>(), times.iter().copied().max().unwrap_or(0));
        let workers = plan.workers as u64;
        prop_assert!(shared >= total.div_ceil(workers) && shared >= longest);
        prop_assert!(shared * workers <= total + longest * workers);
    }
}

/// Weighted pixels make up the mean exactly, whatever they are cut into.
#[test]
fn every_cut_has_all_pixels_once() {
    let pixels = 70 * 45;
    let mut options = FarmRunOptions::default();
    options.set("size", "70x45").unwrap();
    let spec = FarmSpec::new(&options, None).unwrap();
    let scene = spec.lay_out(&Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap();
    let machine = capitan();
    let sorted = |items: &Items| {
        let mut times = items.pixels().to_vec();
        times.sort();
        times
    };
    let cut = |kind, tile| Items::cut(&scene.pixels, kind, tile, &machine).unwrap();
    let segments = cut(ItemKind::Segments, 1);
    assert_eq!(segments.pixels().iter().copied().sum::<Cycles>().0, pixels * machine.costs.pixel.0);
    for (kind, tile, count) in [
        (ItemKind::Lines, 1, 45),
        (ItemKind::Pixels, 1, 70 * 45),
        (ItemKind::Tiles, 8, 9 * 6),
        (ItemKind::Tiles, 99, 1),
    ] {
        let items = cut(kind, tile);
        assert_eq!((items.len(), sorted(&items)), (count, sorted(&segments)));
        let all = (0..items.len()).map(|item| items.time(item)).sum::<Cycles>();
        assert_eq!(all.0, pixels * machine.costs.pixel.0);
    }
}

/// What is counted on a scene is what the array's cells count; more threads count the same.
#[test]
fn the_work_on_a_scene_is_that_of_one_cell() {
    let mut options = FarmRunOptions::default();
    for (name, value) in [("scene", "room"), ("size", "20x16"), ("depth", "0"), ("samples", "2")] {
        options.set(name, value).unwrap();
    }
    let spec = FarmSpec::new(&options, None).unwrap();
    let scene = |threads| spec.lay_out(&Workers::new(threads), |_| Ok::<_, Infallible>(())).unwrap();
    let one = scene(1);
    assert_eq!(one.pixels, scene(3).pixels);
    let mut options = RunOptions::default();
    for (name, value) in
        [("scene", "room"), ("size", "20x16"), ("depth", "0"), ("samples", "2"), ("mode", "broadcast"), ("cells", "1")]
    {
        options.set(name, value).unwrap();
    }
    let planned = PlannedRun::new(RunSpec::of_image(&options, None).unwrap()).unwrap();
    let (image, machine) = (planned.spec.image.clone().unwrap(), &planned.machine);
    let mut layers = Layers::default();
    let workload = layers.workload(&planned, &Cancel::default()).unwrap();
    let scene = layers.scene(&planned).unwrap();
    let picture = Picture {
        scene: &scene,
        workload: &workload,
        size: planned.spec.size,
        sampling: image.sampling(),
        limits: image.limits(),
        screen: None,
        rules: Default::default(),
    };
    let rendered = run::render(&picture, None, &Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap();
    let counts = one.counts().unwrap();
    let rays: u64 = rendered.kinds.iter().map(|kind| kind.rays).sum();
    assert_eq!(counts[0], rays, "grid starts");
    assert_eq!([counts[1], counts[3], counts[5]], {
        let counts = rendered.counts;
        [counts.voxels, counts.slab_tests, counts.intersection_tests]
    });
    let shaded: u64 = rendered.kinds.iter().map(|kind| kind.hits).sum::<u64>() - rendered.kinds[1].hits;
    assert_eq!(counts[7], shaded);
    // The work is that of the cell, at other prices.
    let busy: u64 = rendered.kinds.iter().map(|kind| kind.busy).sum();
    let prices = Capitan { times: KernelTimes { host: HostTimes::default(), ..machine.times }, ..capitan() };
    let priced: u64 = one.pixels.priced(&prices).unwrap().iter().map(|time| time.0).sum();
    assert_eq!(priced, busy);
}

/// Each limit by itself, made by a cost that outgrows the others.
#[test]
fn the_sentence_names_what_limits_the_farm() {
    let plain = Plan {
        workers: 4,
        items: vec![vec![100; 10]; 80],
        fixed: 1000,
        per_cap: 10,
        message: 5,
        segment: 10,
        color: 1,
        buses: 2,
        byte_ps: 10,
        header: 16,
        scene_bytes: 100,
        hand_out: HandOut::Request,
        scene_by: SceneBy::Copies,
    };
    let plans = [
        plain.clone(),
        Plan { fixed: 90_000, ..plain.clone() },
        Plan { message: 400, ..plain.clone() },
        Plan { message: 90, workers: 12, ..plain.clone() },
        Plan { items: vec![vec![10_000], vec![10], vec![10], vec![10]], ..plain.clone() },
        Plan { color: 90, ..plain.clone() },
        Plan { byte_ps: 5000, ..plain },
    ];
    let sentences = plans.map(|plan| pcs_sim::report::bottleneck::sentence(&run_plan(&plan).0));
    insta::assert_snapshot!(sentences.join("\n"));
}
