//! Nodes of a hypercube by themselves: against nodes that tick every cycle, by hand, and whether they ever get stuck.

use std::collections::BTreeMap;
use std::convert::Infallible;

use pcs_sim::host::shading::RayKind;
use pcs_sim::machine::events::{Act, Cube, Delivery, Events, Message, Sender, Turn, WireTimes};
use pcs_sim::machine::{Cycles, HostTimes, Ipsc2, Ipsc2File, KernelTimes, MessageTimes, NodeCosts, Times};
use pcs_sim::measure::{
    Actor, Cause, Clock, CriticalPath, LinkMessages, LinkStats, Measured, Observed, Recording, StateId, StateTimes,
    StationRecord,
};
use pcs_sim::model::Bounds;
use pcs_sim::program::cube::{
    Dealt, Ends, Flow, Leg, MemoryNodes, MessageKind, PageUses, RayTask, RegionNodes, Rules, Seen, Stuck, TaskGraph,
    gray_order, highest_rank,
};
use pcs_sim::run::{CubeMode, CubeRunOptions, CubeSpec, Workers};
use proptest::prelude::*;

use crate::support::cube_ticking::{Stopped, tick};
use crate::support::cube_wires::Ticked;
use crate::support::{heap_events, memory_ticking};

/// What a run came to, in the oracle's terms.
fn ticked(nodes: usize, stats: &Measured, recording: &Recording, seen: &Seen) -> Ticked {
    let states = &stats.topology.states;
    let task = |record: &StationRecord| {
        let mut all: Vec<(String, u64)> = Vec::new();
        for stretch in &record.states {
            let name = states.get(stretch.state).unwrap().name.clone();
            match all.last_mut() {
                Some((last, until)) if *last == name => *until = stretch.until.0,
                _ => all.push((name, stretch.until.0)),
            }
        }
        all
    };
    let kind = |kind: MessageKind| {
        let counts = &seen.messages[kind as usize];
        [counts.sent, counts.taken, counts.bytes, counts.hops, counts.processor.0]
    };
    let queue = |node: usize| stats.fifos.get(node).copied().unwrap_or_default();
    Ticked {
        cycles: stats.cycles.0,
        tasks: recording.stations.iter().map(task).collect(),
        links: links(stats),
        messages: MessageKind::ALL.map(kind),
        true_end: seen.true_end.0,
        told_at: seen.told_at.0,
        probes: seen.probes,
        longest_queues: (0..nodes).map(|node| queue(node).max.0 as usize).collect(),
        queues: (0..nodes).map(|node| (queue(node).word_cycles as u64, queue(node).full.0)).collect(),
    }
}

/// What each link did, in the oracle's terms.
fn links(stats: &Measured) -> Vec<[u64; 4]> {
    let link = |link: &LinkStats| {
        let LinkMessages { sent, bytes, waited } = link.messages.unwrap();
        [link.busy.0, sent, bytes, waited.0]
    };
    stats.links.iter().map(link).collect()
}

/// What was seen of queues over time adds up to what they held in all, and each message is seen from end to end.
fn adds_up(stats: &Measured, observed: &Observed, seen: &Seen) -> Result<(), TestCaseError> {
    let (profile, recording) = (observed.profile.as_ref().unwrap(), observed.recording.as_ref().unwrap());
    for (queue, (held, (bins, levels))) in
        stats.fifos.iter().zip(profile.fifos.iter().zip(&recording.fifos)).enumerate()
    {
        prop_assert_eq!(bins.bins.len(), profile.jobs.len(), "queue {}", queue);
        prop_assert_eq!(bins.bins.iter().map(|bin| bin.word_cycles).sum::<u128>(), held.word_cycles);
        prop_assert_eq!(bins.bins.iter().map(|bin| bin.full).sum::<Cycles>(), held.full);
        prop_assert_eq!(bins.bins.iter().map(|bin| bin.max).max().unwrap_or_default(), held.max);
        prop_assert_eq!(bins.histogram.iter().copied().sum::<Cycles>(), stats.cycles);
        prop_assert_eq!(bins.histogram.first().copied().unwrap_or_default(), held.empty);
        let ends = levels.levels.iter().skip(1).map(|(at, _)| at.0).chain([stats.cycles.0]);
        let spans = levels.levels.iter().zip(ends).map(|((from, level), until)| (level.0, until - from.0));
        prop_assert_eq!(
            spans.map(|(level, cycles)| u128::from(level) * u128::from(cycles)).sum::<u128>(),
            held.word_cycles
        );
    }
    let sent: u64 = seen.messages.iter().map(|kind| kind.sent).sum();
    prop_assert_eq!(recording.messages.len() as u64, sent);
    prop_assert!(
        recording.messages.iter().all(|message| message.sent <= message.arrived && message.from != message.to)
    );
    Ok(())
}

/// Lets nodes run, each with the region of its number.
fn run(machine: &Ipsc2, graph: &TaskGraph, owners: &[u16], rules: Rules) -> Result<(Measured, Seen), Stuck> {
    run_watched(machine, graph, owners, rules).map(|(stats, _, seen)| (stats, seen))
}

fn run_watched(
    machine: &Ipsc2,
    graph: &TaskGraph,
    owners: &[u16],
    rules: Rules,
) -> Result<(Measured, Observed, Seen), Stuck> {
    let node_of: Vec<u16> = (0..machine.nodes as u16).collect();
    let order: Vec<u32> = (0..graph.trees.len() as u32).collect();
    let mut nodes = RegionNodes::new(machine, graph, &node_of, (owners, &order), rules).unwrap();
    let events = Events::new(nodes.topology(), machine.cube(), RegionNodes::SENDING_AND_IDLE);
    let all = || (Cycles(0)..Cycles(u64::MAX), Recording::MOST_EVENTS);
    let mut events = events.probed().recorded(all().0, all().1);
    nodes.queues = nodes.queues.probed(machine.nodes + 1).recorded(all().0, all().1);
    while !nodes.is_over() && events.step(&mut |task, now, turn| nodes.next(task, now, turn)) {}
    if !nodes.is_over() {
        return Err(nodes.stuck());
    }
    let (mut stats, mut observed) = events.stop(|task| nodes.rests(task));
    nodes.queues.tell(&mut stats, &mut observed);
    Ok((stats, observed, nodes.seen))
}

/// The same with its chain of causes.
fn run_explained(machine: &Ipsc2, graph: &TaskGraph, owners: &[u16], rules: Rules) -> (Measured, CriticalPath, Seen) {
    let node_of: Vec<u16> = (0..machine.nodes as u16).collect();
    let order: Vec<u32> = (0..graph.trees.len() as u32).collect();
    let mut nodes = RegionNodes::new(machine, graph, &node_of, (owners, &order), rules).unwrap();
    let explanation = nodes.explain();
    let events = Events::new(nodes.topology(), machine.cube(), RegionNodes::SENDING_AND_IDLE);
    let mut events = events.explained(explanation, RegionNodes::sending);
    while !nodes.is_over() && events.step(&mut |task, now, turn| nodes.next(task, now, turn)) {}
    let (mut stats, mut observed) = events.stop(|task| nodes.rests(task));
    nodes.queues.tell(&mut stats, &mut observed);
    (stats, observed.path.unwrap(), nodes.seen)
}

fn machine(nodes: usize, t: [u64; 20]) -> Ipsc2 {
    let times = |at: usize| Times { start: Cycles(t[at]), each: Cycles(t[at + 1]) };
    Ipsc2 {
        nodes,
        clock: Clock { cycle_ns: 62.5 },
        memory_bytes: 1 << 22,
        wires: WireTimes {
            short_bytes: 30,
            short: Cycles(t[0]),
            long: Cycles(t[1]),
            hop: Cycles(t[2]),
            byte_millicycles: 100 * t[3],
        },
        messages: MessageTimes { short_bytes: 30, short: Cycles(t[4]), long: Cycles(t[5]) },
        costs: NodeCosts {
            pixel: Cycles(t[6]),
            result: Cycles(t[7]),
            fill: Cycles(0),
            lookup: Cycles(t[8]),
            serve: Cycles(t[9]),
        },
        times: KernelTimes {
            grid: times(10),
            slabs: times(12),
            intersection: times(14),
            host: HostTimes { hit: Cycles(t[16]), ..HostTimes::default() },
            message: None,
        },
        notes: Vec::new(),
    }
}

/// Makes trees out of a list of numbers, which it takes one after the other.
struct Maker<'a> {
    numbers: std::iter::Cycle<std::slice::Iter<'a, u32>>,
    nodes: u32,
    graph: TaskGraph,
}

impl<'a> Maker<'a> {
    /// So many trees on so many nodes, each with up to so many rays.
    fn of(numbers: &'a [u32], nodes: usize, trees: usize, most: usize) -> Maker<'a> {
        let graph = TaskGraph { regions: nodes, ..TaskGraph::default() };
        let mut maker = Maker { numbers: numbers.iter().cycle(), nodes: nodes as u32, graph };
        (0..trees).for_each(|_| maker.tree(most));
        maker
    }

    fn below(&mut self, end: u32) -> u32 {
        self.numbers.next().copied().unwrap_or(0) % end.max(1)
    }

    /// A tree with up to so many rays, generation by generation.
    fn tree(&mut self, most: usize) {
        let (tree, first) = (self.graph.trees.len() as u32, self.graph.rays.len());
        self.graph.trees.push(first as u32);
        // Kind, turns, hop, and where the one that asked for it ended.
        let start = self.below(self.nodes) as u16;
        let mut asked = vec![(RayKind::Primary, 0u8, None::<u16>, start)];
        let mut next = 0;
        while next < asked.len() {
            let (kind, turns, line, at) = asked[next];
            let first_leg = self.graph.legs.len() as u32;
            let starts_there = self.below(4) > 0;
            let mut region = if starts_there { at } else { self.below(self.nodes) as u16 };
            let hop = line.map_or(0, |met| met + u16::from(region != at));
            let count = 1 + self.below(3.min(self.nodes));
            for leg in 0..count {
                if leg > 0 {
                    region = (region + 1 + self.below(self.nodes - 1) as u16) % self.nodes as u16;
                }
                let (voxels, slab_tests) = (self.below(4), self.below(3));
                let intersection_tests = self.below(slab_tests + 1);
                self.graph.legs.push(Leg { region, voxels, slab_tests, intersection_tests });
            }
            let room = most.saturating_sub(asked.len()) as u32;
            let children = asked.len() as u32;
            let is_shadow = kind == RayKind::Shadow;
            let wanted = if is_shadow { self.below(2) } else { self.below(4) }.min(room);
            for child in 0..wanted {
                let last = (hop + count as u16 - 1, region);
                asked.push(match (is_shadow, child) {
                    (true, _) => (RayKind::Shadow, turns, Some(last.0), last.1),
                    (false, 0) => (RayKind::Reflected, turns + 1, None, last.1),
                    (false, _) => (RayKind::Shadow, turns + 1, None, last.1),
                });
            }
            let shaded = !is_shadow && self.below(2) > 0;
            let children = (first as u32 + children, wanted);
            self.graph.rays.push(RayTask { first_leg, children, tree, hop, turns, kind, shaded });
            next += 1;
        }
    }
}

fn graph(numbers: &[u32], nodes: usize, trees: usize) -> TaskGraph {
    Maker::of(numbers, nodes, trees, 60 / trees.max(1)).graph
}

/// Small times, many of which are zero.
fn times() -> impl Strategy<Value = [u64; 20]> {
    prop::array::uniform20(prop_oneof![Just(0u64), 1u64..4, 1u64..30])
}

fn flow() -> impl Strategy<Value = Flow> {
    prop_oneof![
        Just(Flow::Unlimited),
        (1u32..6).prop_map(Flow::Block),
        (1u32..4).prop_map(Flow::Window),
        // As many slots more than it takes.
        (0u32..3).prop_map(Flow::Classes),
    ]
}

fn enough(flow: Flow, graph: &TaskGraph) -> Flow {
    if let Flow::Classes(more) = flow { Flow::Classes(highest_rank(graph) + 1 + more) } else { flow }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// However much legs do, nodes spend on them what the graph says: few do too much for the word that nodes read of a leg.
    #[test]
    fn legs_take_what_they_do_however_much(
        nodes in 1usize..9,
        trees in 1usize..12,
        numbers in prop::collection::vec(any::<u32>(), 200),
        counts in prop::collection::vec(
            prop_oneof![0u32..3, (1u32 << 17) - 2..(1 << 17) + 2, (1u32 << 18) - 2..(1 << 18) + 2, any::<u32>()],
            3..60,
        ),
        times in times(),
    ) {
        let mut graph = graph(&numbers, nodes, trees);
        let mut counts = counts.iter().copied().cycle();
        let mut count = || counts.next().unwrap_or(0);
        for leg in &mut graph.legs {
            (leg.voxels, leg.slab_tests, leg.intersection_tests) = (count(), count(), count());
        }
        let machine = machine(nodes, times);
        let owners: Vec<u16> = graph.trees.iter().map(|&ray| graph.start_of(ray)).collect();
        let (stats, seen) = run(&machine, &graph, &owners, UNLIMITED).unwrap();
        let rays = 0..graph.rays.len() as u32;
        let legs = rays.flat_map(|ray| (graph.rays[ray as usize].first_leg..graph.legs_end(ray)).map(move |leg| (ray, leg)));
        let asked = legs.map(|(ray, leg)| graph.time(ray, leg, &machine.times)).fold([0; 4], |sums: [u64; 4], time| {
            [sums[0] + time.grid.0, sums[1] + time.slabs.0, sums[2] + time.intersection.0, sums[3] + time.shading.0]
        });
        let spent = [0, 1, 2, 3].map(|state| stats.stations.iter().map(|times| times.of(StateId(state)).0).sum::<u64>());
        prop_assert_eq!(spent, asked);
        prop_assert_eq!(seen.nodes.iter().map(|node| node.legs).sum::<u64>(), graph.legs.len() as u64);
    }

    /// Every figure is what ticking each cycle counts, and they get stuck where that does.
    #[test]
    fn nodes_do_what_ticking_each_cycle_does(
        nodes in 1usize..9,
        trees in 1usize..12,
        numbers in prop::collection::vec(any::<u32>(), 200),
        times in times(),
        flow in flow(),
        is_token in any::<bool>(),
        asks_for_slots in any::<bool>(),
        pixels_first in any::<bool>(),
    ) {
        let graph = graph(&numbers, nodes, trees);
        let machine = machine(nodes, times);
        let ends = if is_token && !matches!(flow, Flow::Window(_)) { Ends::Token } else { Ends::Credit };
        let rules = Rules { flow: enough(flow, &graph), ends, asks_for_slots, pixels_first };
        let owners: Vec<u16> = (0..trees).map(|tree| match numbers[tree] % 3 {
            0 => (tree % nodes) as u16,
            _ => graph.start_of(graph.trees[tree]),
        }).collect();
        let node_of: Vec<u16> = (0..nodes as u16).collect();
        let order: Vec<u32> = (0..trees as u32).collect();
        let expected = tick(&machine, &graph, &node_of, (&owners, &order), rules);
        match run_watched(&machine, &graph, &owners, rules) {
            Ok((stats, observed, seen)) => {
                adds_up(&stats, &observed, &seen)?;
                let found = ticked(nodes, &stats, observed.recording.as_ref().unwrap(), &seen);
                if let Ok(expected) = &expected {
                    for (task, (found, expected)) in found.tasks.iter().zip(&expected.tasks).enumerate() {
                        let differs = found.iter().zip(expected).position(|(found, expected)| found != expected);
                        let at = differs.unwrap_or(found.len().min(expected.len()));
                        let around = |spells: &[(String, u64)]| spells[at.saturating_sub(2)..spells.len().min(at + 3)].to_vec();
                        prop_assert_eq!(around(found), around(expected), "task {}", task);
                    }
                }
                prop_assert_eq!(Ok(found), expected);
                conserves(&stats, &seen)?;
                let bounds = Bounds::of_regions(&machine, &graph, &node_of, &owners);
                prop_assert!(stats.cycles >= bounds.least(), "{:?}", bounds);
                for (work, station) in bounds.work.iter().zip(&stats.stations) {
                    prop_assert!(stats.topology.states.works(station) >= *work, "{:?}", bounds);
                }
                if let Flow::Block(slots) | Flow::Classes(slots) = rules.flow {
                    prop_assert!(seen.nodes.iter().all(|node| node.most_slots <= slots));
                }
            }
            Err(_) => prop_assert_eq!(expected, Err(Stopped::Stuck)),
        }
    }

    /// The chain of causes sums to the run, on random graphs, and following it changes nothing else.
    #[test]
    fn the_critical_path_is_as_long_as_the_run(
        nodes in 1usize..9,
        trees in 1usize..12,
        numbers in prop::collection::vec(any::<u32>(), 200),
        times in times(),
        flow in flow(),
        asks_for_slots in any::<bool>(),
        pixels_first in any::<bool>(),
    ) {
        let graph = graph(&numbers, nodes, trees);
        let machine = machine(nodes, times);
        let rules = Rules { flow: enough(flow, &graph), ends: Ends::Credit, asks_for_slots, pixels_first };
        let owners: Vec<u16> = (0..trees).map(|tree| (numbers[tree] as usize % nodes) as u16).collect();
        if let Ok((stats, seen)) = run(&machine, &graph, &owners, rules) {
            let (explained, path, also_seen) = run_explained(&machine, &graph, &owners, rules);
            prop_assert_eq!((&explained, &also_seen), (&stats, &seen));
            prop_assert_eq!(path.parts().iter().map(|part| part.cycles.0).sum::<u64>(), stats.cycles.0);
            prop_assert!(path.parts().iter().all(|part| matches!(part.at, Actor::Station(task) if task <= nodes)));
        }
    }

    /// Classes with a slot more than the highest rank never get stuck.
    #[test]
    fn classes_never_get_stuck(
        nodes in 2usize..9,
        trees in 1usize..40,
        numbers in prop::collection::vec(any::<u32>(), 400),
        times in times(),
        asks_for_slots in any::<bool>(),
    ) {
        let graph = Maker::of(&numbers, nodes, trees, 40).graph;
        let owners: Vec<u16> = graph.trees.iter().map(|&ray| graph.start_of(ray)).collect();
        let rules = Rules { flow: Flow::Classes(highest_rank(&graph) + 1), ends: Ends::Credit, asks_for_slots, pixels_first: true };
        let ended = run(&machine(nodes, times), &graph, &owners, rules);
        prop_assert!(ended.is_ok(), "{}", ended.unwrap_err());
        let most = ended.unwrap().1.nodes.iter().map(|node| node.most_slots).max();
        prop_assert!(most <= Some(highest_rank(&graph) + 1));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// With a shared memory, too, whether each node has its pixels or asks for them, and however few pages a cache holds.
    #[test]
    fn nodes_with_a_shared_memory_do_what_ticking_each_cycle_does(
        nodes in 1usize..9,
        trees in 1usize..12,
        numbers in prop::collection::vec(any::<u32>(), 200),
        times in times(),
        pages in 1u32..20,
        room in 1u64..20,
        tile in prop::option::of(1usize..4),
    ) {
        let mut maker = Maker::of(&numbers, 1, trees, 60 / trees);
        let mut uses = PageUses { pages, page_bytes: 64, ..PageUses::default() };
        for _ in 0..maker.graph.rays.len() {
            let mut read: Vec<u32> = (0..maker.below(5)).map(|_| maker.below(pages)).collect();
            read.sort_unstable();
            read.dedup();
            let by = maker.below(5) as usize % read.len().max(1);
            read.rotate_left(by);
            uses.uses.extend(read.into_iter().map(|page| (page, 1 + page % 3)));
            uses.ends.push(uses.uses.len() as u32);
        }
        let graph = TaskGraph { pages: Some(uses), ..maker.graph };
        let mut machine = machine(nodes, times);
        machine.memory_bytes = 64 * (u64::from(pages).div_ceil(nodes as u64) + room);
        let all: Vec<u32> = (0..trees as u32).collect();
        let dealt = match tile {
            Some(trees) => Dealt::AsAsked(all.chunks(trees).map(<[u32]>::to_vec).collect()),
            None => Dealt::Before((0..nodes).map(|node| all.iter().copied().skip(node).step_by(nodes).collect()).collect()),
        };
        let (expected, fetched) = memory_ticking::tick(&machine, &graph, dealt.clone());
        let mut memory = MemoryNodes::new(&machine, &graph, dealt).unwrap();
        let (topology, states) = (memory.topology(), MemoryNodes::SENDING_AND_IDLE);
        let events = Events::with_helpers(topology, memory.helpers(), machine.cube(), states);
        let mut events = events.recorded(Cycles(0)..Cycles(u64::MAX), Recording::MOST_EVENTS);
        while !memory.is_over() && events.step(&mut |task, now, turn| { let taken = turn.taken(); turn.act(memory.next(task, now, taken.as_ref())); }) {}
        let (stats, observed) = events.stop(|task| memory.rests(task));
        let found = ticked(nodes, &stats, &observed.recording.unwrap(), &memory.seen);
        prop_assert_eq!(found, expected);
        prop_assert_eq!(memory.seen.nodes.iter().map(|node| node.pages).collect::<Vec<_>>(), fetched);
        prop_assert_eq!(memory.seen.nodes.iter().map(|node| node.pixels).sum::<usize>(), trees);
        conserves(&stats, &memory.seen)?;
        let owners: Vec<u16> = (0..trees).map(|tree| (tree % nodes) as u16).collect();
        let bounds = Bounds::of_shared_memory(&machine, &graph, tile.is_none().then_some(&owners[..]));
        prop_assert!(stats.cycles >= bounds.least(), "{:?}", bounds);
        prop_assert_eq!(bounds.busiest().is_some(), tile.is_none());
        for (work, station) in bounds.work.iter().zip(&stats.stations) {
            prop_assert!(stats.topology.states.works(station) >= *work, "{:?}", bounds);
        }
    }
}

/// What a real image's nodes came to: the end, each task's cycles in each state, and the links'.
type Came = (u64, Vec<BTreeMap<u8, u64>>, Vec<[u64; 4]>);

/// The same of the engine's run, in the other scheduler's terms.
fn came(stats: &Measured) -> Came {
    let states = stats.topology.states.all();
    let spent = |times: &StateTimes| {
        let all = states.iter().map(|state| (state.id.0, times.of(state.id).0));
        all.filter(|(_, cycles)| *cycles > 0).collect()
    };
    (stats.cycles.0, stats.stations.iter().map(spent).collect(), links(stats))
}

/// On a real scene, another scheduler, which has all that is to happen in one heap, comes to the same.
#[test]
fn another_scheduler_comes_to_the_same() {
    let scene_of = |mode: CubeMode| {
        let mut options = CubeRunOptions::default();
        options.scene.scene = Some("gears".to_owned());
        options.shape.size = Some("24x24".parse().unwrap());
        options.cube.mode = Some(mode);
        options.machine.nodes = Some(13);
        let spec = CubeSpec::new(&options, None).unwrap();
        let scene = spec.lay_out(false, &Workers::on_all_cores(), |_| Ok::<_, Infallible>(())).unwrap();
        (spec.machine.build().unwrap(), scene.graph)
    };
    let (machine, graph) = scene_of(CubeMode::Regions);
    let node_of = gray_order(machine.nodes);
    let owners: Vec<u16> = graph.trees.iter().map(|&ray| node_of[usize::from(graph.start_of(ray))]).collect();
    let order: Vec<u32> = (0..graph.trees.len() as u32).collect();
    let slots = highest_rank(&graph) + 1;
    for (flow, ends, asks_for_slots) in [
        (Flow::Classes(slots), Ends::Credit, false),
        (Flow::Classes(2 * slots), Ends::Token, true),
        (Flow::Unlimited, Ends::Token, false),
        (Flow::Window(4), Ends::Credit, false),
        (Flow::Block(4096), Ends::Credit, false),
    ] {
        let rules = Rules { flow, ends, asks_for_slots, pixels_first: false };
        let nodes = || RegionNodes::new(&machine, &graph, &node_of, (&owners, &order), rules).unwrap();
        let mut own = nodes();
        let mut events = Events::new(own.topology(), machine.cube(), RegionNodes::SENDING_AND_IDLE);
        while !own.is_over() && events.step(&mut |task, now, turn| own.next(task, now, turn)) {}
        assert!(own.is_over(), "{flow:?}");
        let (stats, _) = events.stop(|task| own.rests(task));
        let mut other = nodes();
        let ended = heap_events::run(
            (&machine, machine.nodes + 1),
            &mut other,
            |nodes, task, now, turn| nodes.next(task, now, turn),
            RegionNodes::is_over,
            RegionNodes::rests,
            RegionNodes::SENDING_AND_IDLE,
        );
        assert_eq!(came(&stats), (ended.cycles, ended.spent, ended.links), "{flow:?}");
        assert_eq!((&own.seen, own.queues.so_far()), (&other.seen, other.queues.so_far()), "{flow:?}");
    }
    let (machine, graph) = scene_of(CubeMode::SharedMemory);
    let all: Vec<u32> = (0..graph.trees.len() as u32).collect();
    let nodes =
        || MemoryNodes::new(&machine, &graph, Dealt::AsAsked(all.chunks(10).map(<[u32]>::to_vec).collect())).unwrap();
    let mut own = nodes();
    let states = MemoryNodes::SENDING_AND_IDLE;
    let mut events = Events::with_helpers(own.topology(), own.helpers(), machine.cube(), states);
    while !own.is_over()
        && events.step(&mut |task, now, turn| {
            let taken = turn.taken();
            turn.act(own.next(task, now, taken.as_ref()));
        })
    {}
    let (stats, _) = events.stop(|task| own.rests(task));
    let mut other = nodes();
    let tasks = machine.nodes + 1 + other.helpers();
    let mut ended = heap_events::run(
        (&machine, tasks),
        &mut other,
        |nodes, task, now, turn| {
            let taken = turn.taken();
            turn.act(nodes.next(task, now, taken.as_ref()));
        },
        MemoryNodes::is_over,
        MemoryNodes::rests,
        states,
    );
    ended.spent.truncate(machine.nodes + 1);
    assert_eq!(came(&stats), (ended.cycles, ended.spent, ended.links));
    assert_eq!(own.seen, other.seen);
}

proptest! {
    /// Whatever messages take, the token never says too early that all is over, and begins at the most two more rounds once it is.
    #[test]
    fn the_token_is_never_early_and_at_most_two_rounds_late(
        nodes in 2usize..9,
        trees in 1usize..12,
        numbers in prop::collection::vec(any::<u32>(), 200),
        times in times(),
        wires in prop::array::uniform6(0u64..3000),
        pixels_first in any::<bool>(),
    ) {
        let graph = graph(&numbers, nodes, trees);
        let mut machine = machine(nodes, times);
        machine.costs.pixel += Cycles(1);
        let [short, long, hop, byte, short_work, long_work] = wires;
        (machine.wires.short, machine.wires.long, machine.wires.hop) = (Cycles(short), Cycles(long), Cycles(hop));
        machine.wires.byte_millicycles = byte;
        (machine.messages.short, machine.messages.long) = (Cycles(short_work % 40), Cycles(long_work % 40));
        let owners: Vec<u16> = (0..trees).map(|tree| (numbers[tree] as usize % nodes) as u16).collect();
        let node_of: Vec<u16> = (0..nodes as u16).collect();
        let order: Vec<u32> = (0..trees as u32).collect();
        let rules = Rules { ends: Ends::Token, pixels_first, ..UNLIMITED };
        let mut run = RegionNodes::new(&machine, &graph, &node_of, (&owners, &order), rules).unwrap();
        let mut events = Events::new(run.topology(), machine.cube(), RegionNodes::SENDING_AND_IDLE);
        let mut begun = None;
        while !run.is_over() && events.step(&mut |task, now, turn| run.next(task, now, turn)) {
            if run.seen.true_end > Cycles(0) {
                begun = begun.or(Some(run.seen.probes));
            } else {
                prop_assert_eq!(run.seen.told_at, Cycles(0), "too early");
            }
        }
        prop_assert!(run.is_over() && run.seen.true_end <= run.seen.told_at);
        prop_assert!(run.seen.probes - begun.unwrap() <= 2, "{} rounds", run.seen.probes - begun.unwrap());
    }
}

/// What must hold of any run: nothing is lost, and times add up.
fn conserves(stats: &Measured, seen: &Seen) -> Result<(), TestCaseError> {
    for station in &stats.stations {
        prop_assert_eq!(station.total(), stats.cycles);
    }
    for (kind, counts) in MessageKind::ALL.iter().zip(&seen.messages) {
        prop_assert_eq!(counts.sent, counts.taken, "{:?}", kind);
    }
    prop_assert!(stats.links.iter().all(|link| link.busy <= stats.cycles));
    prop_assert!(seen.true_end <= seen.told_at && seen.told_at <= stats.cycles);
    Ok(())
}

/// The machine of the standard file with so many nodes.
fn standard(nodes: u32) -> Ipsc2 {
    Ipsc2File { nodes, ..Ipsc2File::standard().unwrap() }.build().unwrap()
}

fn leg(region: u16, voxels: u32, slab_tests: u32, intersection_tests: u32) -> Leg {
    Leg { region, voxels, slab_tests, intersection_tests }
}

/// A pixel whose ray crosses from region 0 to region 1, hits there, and asks for a shadow ray that comes back.
fn there_and_back() -> TaskGraph {
    let ray = |first_leg, children, turns, kind, shaded| RayTask {
        first_leg,
        children,
        tree: 0,
        hop: 0,
        turns,
        kind,
        shaded,
    };
    TaskGraph {
        regions: 2,
        rays: vec![ray(0, (1, 1), 0, RayKind::Primary, true), ray(2, (2, 0), 1, RayKind::Shadow, false)],
        legs: vec![leg(0, 2, 0, 0), leg(1, 1, 1, 1), leg(1, 1, 0, 0), leg(0, 1, 0, 0)],
        trees: vec![0],
        ..TaskGraph::default()
    }
}

const UNLIMITED: Rules =
    Rules { flow: Flow::Unlimited, ends: Ends::Credit, asks_for_slots: false, pixels_first: false };

/// By hand, from the standard file's numbers in cycles of 62.5 ns: a pixel 3200; the grid 4002 and 1040 a voxel, slabs 1201 and 1734,
/// intersection 133 and 4002, shading 83984; a short message 2560 at either end, 480 under way and 5.76 a byte.
#[test]
fn a_ray_goes_there_and_its_shadow_ray_comes_back() {
    let (stats, seen) = run(&standard(2), &there_and_back(), &[0], UNLIMITED).unwrap();
    let first_leg = 3200 + 4002 + 2 * 1040;
    let sent = first_leg + 2560;
    let comes = sent + 480 + 300;
    let hit = comes + 2560 + (4002 + 1040) + (1201 + 1734) + (133 + 4002);
    let result_sent = hit + 83984 + 2560;
    let shadow_sent = result_sent + (4002 + 1040) + 2560;
    let back = shadow_sent + 480 + 300;
    let done = back + 2560 + (4002 + 1040);
    let packet = done + 2560 + 480 + 139;
    let end = packet + 2560;
    assert_eq!((seen.true_end.0, seen.told_at.0, stats.cycles.0), (done, end, end));
    assert_eq!(end, 135_561, "all of it");
    let spent = |node: usize, name: &str| crate::support::spent(&stats, node, name);
    // The result takes node 0 as soon as it comes, while the shadow ray is still under way.
    assert_eq!(spent(0, "receiving"), 2560 + 320 + 2560);
    assert_eq!(spent(0, "waiting"), (result_sent + 480 + 116 - sent) + (back - (result_sent + 480 + 116 + 2880)));
    assert_eq!(spent(0, "idle"), end - (done + 2560));
    assert_eq!(spent(1, "waiting"), comes);
    assert_eq!(spent(1, "idle"), end - shadow_sent);
    // The chain of causes is all of it but for the result, which takes another way.
    let (_, path, _) = run_explained(&standard(2), &there_and_back(), &[0], UNLIMITED);
    let of = |name: &str| {
        let parts = path.parts();
        let named =
            parts.iter().filter(|part| matches!(part.cause, Cause::Work(unit) if path.units[unit].name == name));
        named
            .map(|part| (part.count, part.cycles.0))
            .fold((0, 0), |(times, all), (count, cycles)| (times + count, all + cycles))
    };
    assert_eq!(of("pixel_us"), (1, 3200));
    assert_eq!(of("grid_start"), (4, 4 * 4002));
    assert_eq!(of("grid_voxel"), (5, 5 * 1040));
    assert_eq!(of("shade_hit"), (1, 83984));
    assert_eq!(of("send_virtual_object"), (2, 2 * 2560), "there and back");
    assert_eq!(of("take_virtual_object"), (2, 2 * 2560));
    assert_eq!(of("send_calculation"), (2, 2 * 2560), "the result that goes before the shadow ray, and the packet");
    assert_eq!(of("take_calculation"), (1, 2560), "the packet");
    assert_eq!(of("links"), (3, 300 + 300 + 139));
    assert_eq!(of("way"), (3, 3 * 480));
    // At the least: what each node has to do, and the chain of both rays, which the result does not hold up.
    let bounds = Bounds::of_regions(&standard(2), &there_and_back(), &[0, 1], &[0]);
    let (there, shadow) = (hit + 83984 - comes, 4002 + 1040);
    assert_eq!(bounds.work[0].0, first_leg + 2560 + (2560 + 320) + 2560 + shadow + 2560);
    assert_eq!(bounds.work[1].0, there + 2560 + shadow + 2560);
    assert_eq!((bounds.chain.0, bounds.ray_messages), (done - 2560, 2));
    assert_eq!(bounds.equal.0, (bounds.work[0].0 + bounds.work[1].0).div_ceil(2));
    // A cycle less anywhere is a cycle less in the end.
    let mut faster = standard(2);
    faster.times.host.hit.0 -= 1;
    assert_eq!(run(&faster, &there_and_back(), &[0], UNLIMITED).unwrap().0.cycles.0, end - 1);
}

/// By hand: a token goes round four nodes when node 0 has done its only pixel. To each: 2560 for sending it, 480 and 93 under way, 2560 for
/// taking it.
#[test]
fn a_token_goes_round_once() {
    let ray =
        RayTask { first_leg: 0, children: (1, 0), tree: 0, hop: 0, turns: 0, kind: RayKind::Primary, shaded: false };
    let graph =
        TaskGraph { regions: 4, rays: vec![ray], legs: vec![leg(0, 1, 0, 0)], trees: vec![0], ..TaskGraph::default() };
    let (_, seen) = run(&standard(4), &graph, &[0], Rules { ends: Ends::Token, ..UNLIMITED }).unwrap();
    let done = 3200 + 4002 + 1040;
    assert_eq!((seen.true_end.0, seen.told_at.0), (done, done + 4 * (2560 + 480 + 93 + 2560)));
    assert_eq!(seen.probes, 1);
}

/// Which messages have a link is who sends first, and of those that send together the lowest node: on one link, on ways that
/// cross, and a long message that has its way from when it asks for room.
#[test]
fn messages_wait_for_all_links_of_their_way() {
    let wires =
        WireTimes { short_bytes: 30, short: Cycles(5), long: Cycles(20), hop: Cycles(2), byte_millicycles: 1000 };
    let topology = |tasks: usize| pcs_sim::program::cube::topology(tasks, "message");
    let arrivals = |sends: &[(usize, usize, u64)]| {
        let mut events = Events::new(topology(4), Cube::new(4, wires), RegionNodes::SENDING_AND_IDLE);
        let mut lists: Vec<Vec<Act<usize>>> = vec![Vec::new(); 5];
        for (number, &(from, to, bytes)) in sends.iter().enumerate() {
            let message = Message { delivery: Delivery::Post(to), time: Cycles(0), bytes, content: number };
            lists[from].push(Act::Send(message));
        }
        let mut takes = [0; 5];
        sends.iter().for_each(|&(_, to, _)| takes[to] += 1);
        let mut arrived = vec![0; sends.len()];
        while events.step(&mut |task, now, turn| {
            turn.taken().into_iter().for_each(|number: usize| arrived[number] = now.0);
            if !lists[task].is_empty() {
                turn.act(lists[task].remove(0));
                return;
            }
            takes[task] -= 1;
            turn.act(if takes[task] >= 0 { Act::Receive(Sender::Anyone, StateId(11)) } else { Act::End });
        }) {}
        events.finish().unwrap();
        arrived
    };
    assert_eq!(arrivals(&[(0, 1, 10), (0, 1, 10)]), [15, 25], "the second waits for 10 bytes");
    // 0 to 3 goes by 1, so that 1 waits for the link to 3; 2 has its own.
    assert_eq!(arrivals(&[(0, 3, 10), (1, 3, 10), (2, 3, 10)]), [17, 25, 15]);
    assert_eq!(arrivals(&[(0, 1, 40), (0, 1, 10)]), [60, 75], "a long one has the link for 20 more");
    // The host hangs on node 0.
    assert_eq!(arrivals(&[(4, 3, 10), (3, 4, 10)]), [19, 19]);
}

/// One slot less than it takes, or a rule that gives away one slot more: two rays that each want the other's place.
#[test]
fn with_a_slot_less_classes_get_stuck() {
    // From each of two nodes a ray goes to the other.
    let ray = |first_leg, tree| RayTask {
        first_leg,
        children: (2, 0),
        tree,
        hop: 0,
        turns: 0,
        kind: RayKind::Primary,
        shaded: false,
    };
    let graph = TaskGraph {
        regions: 2,
        rays: vec![ray(0, 0), ray(2, 1)],
        legs: vec![leg(0, 1, 0, 0), leg(1, 1, 0, 0), leg(1, 1, 0, 0), leg(0, 1, 0, 0)],
        trees: vec![0, 1],
        ..TaskGraph::default()
    };
    assert_eq!(highest_rank(&graph), 1);
    let rules = |slots| Rules { flow: Flow::Classes(slots), ..UNLIMITED };
    assert!(run(&standard(2), &graph, &[0, 1], rules(2)).is_ok());
    // With one slot a node cannot even begin.
    assert!(run(&standard(2), &graph, &[0, 1], rules(1)).is_err());
    // What gives the only slot to a ray of the lowest rank is blocking, and that gets stuck: three rays of either side fill both queues.
    let many = TaskGraph {
        rays: (0..12).map(|number| ray(2 * number, number)).collect(),
        legs: (0..12)
            .flat_map(|number| [leg((number % 2) as u16, 1, 0, 0), leg((number + 1) as u16 % 2, 1, 0, 0)])
            .collect(),
        trees: (0..12).collect(),
        ..graph
    };
    let owners: Vec<u16> = (0..12).map(|number| number % 2).collect();
    let stuck = run(&standard(2), &many, &owners, Rules { flow: Flow::Block(1), pixels_first: true, ..UNLIMITED });
    let stuck = stuck.unwrap_err();
    assert_eq!(stuck.circle.iter().map(|waiting| (waiting.node, waiting.to)).collect::<Vec<_>>(), [(0, 1), (1, 0)]);
    assert!(run(&standard(2), &many, &owners, rules(2)).is_ok());
}

/// The credit of a pixel: what a ray gives to its children and keeps for its own result, in shares of 2^-m.
fn credits(graph: &TaskGraph) -> Vec<u32> {
    let mut exponents = vec![0u32; graph.rays.len()];
    let mut results = Vec::new();
    for (ray, task) in graph.rays.iter().enumerate() {
        let (first, count) = task.children;
        let split = (count + 1).next_power_of_two().ilog2();
        (first..first + count).for_each(|child| exponents[child as usize] = exponents[ray] + split);
        results.push((exponents[ray], split, count));
    }
    // A result brings back what its ray did not give away: 2^split - count shares of 2^-(exponent + split).
    results
        .into_iter()
        .flat_map(|(exponent, split, count)| vec![exponent + split; (1 << split) - count as usize])
        .collect()
}

/// Adds powers of a half up, and tells when they are 1.
fn sums_to_one(shares: impl Iterator<Item = u32>) -> bool {
    let mut counts = std::collections::BTreeMap::<u32, u32>::new();
    for share in shares {
        let mut at = share;
        loop {
            let count = counts.entry(at).or_default();
            *count += 1;
            if *count < 2 || at == 0 {
                break;
            }
            *count = 0;
            at -= 1;
        }
    }
    counts.get(&0) == Some(&1) && counts.iter().all(|(at, count)| *at == 0 || *count == 0)
}

proptest! {
    /// Whatever the order in which results come, the credit is 1 with the last of them and not before. Counting one less than the
    /// children of each ray that has come, which is done at -1, ends too early in some orders.
    #[test]
    fn credit_is_whole_with_the_last_result(numbers in prop::collection::vec(any::<u32>(), 60), order in any::<u64>()) {
        let graph = graph(&numbers, 4, 1);
        let all = credits(&graph);
        prop_assert!(sums_to_one(all.iter().copied()));
        // Any proper part of the results is less: shares are above 0.
        let left_out = order as usize % all.len();
        let part = all.iter().enumerate().filter(|(place, _)| *place != left_out).map(|(_, share)| *share);
        prop_assert!(!sums_to_one(part));
    }
}

/// The naive count is done while a ray is under way: a child without children overtakes its parent.
#[test]
fn counting_children_less_one_would_end_early() {
    let graph = there_and_back();
    let add = |ray: usize| i64::from(graph.rays[ray].children.1) - 1;
    let of_root_last = [add(1), add(0)];
    assert_eq!(of_root_last.iter().sum::<i64>(), -1, "done with both");
    assert_eq!(of_root_last[0], -1, "and with the first alone");
}
