//! Traces for viewers, read back: Perfetto's by its message numbers alone, VCD and FST by a waveform library.

use std::collections::{BTreeMap, HashMap};

use crate::support::command::Folder;
use pcs_sim::machine::{Array, Cycles, MachineSpec, Words};
use pcs_sim::measure::{Measured, Recording, StateId, StationRecord};
use pcs_sim::report::plot::Caption;
use pcs_sim::report::trace::{Format, Trace};
use prost::Message;

/// A run of a hybrid of four cells.
struct Run {
    spec: MachineSpec,
    stats: Measured,
    recording: Recording,
}

const NAMES: [&str; 4] = ["grid+slabs", "intersection", "grid+slabs", "intersection"];

fn run(clock_ns: f64) -> Run {
    let (scene, rays) = crate::support::scene("room", 1, 6);
    let workload = crate::support::workload(&scene.mesh, &crate::support::program("hybrid", 2), &rays);
    let spec = MachineSpec { clock_ns, link_mb_s: 4e3 / clock_ns, fifo_words: Words(20), ..MachineSpec::default() };
    let mut array =
        Array::new(&spec, workload.costs(), 4).recorded(Cycles(0)..Cycles(u64::MAX), Recording::MOST_EVENTS);
    for batch in crate::support::ops(&workload, &rays) {
        array.feed(batch).unwrap();
        array.run().unwrap();
    }
    let (stats, observed) = array.finish_observed().unwrap();
    Run { spec, stats, recording: observed.recording.unwrap() }
}

impl Run {
    fn state(&self, id: StateId) -> &str {
        &self.recording.topology.states.get(id).unwrap().name
    }

    /// The FIFOs' names and levels.
    fn fifos(&self) -> impl Iterator<Item = (&str, &[(Cycles, Words)])> {
        let infos = self.recording.topology.fifos.iter().map(|info| info.name.as_str());
        infos.zip(self.recording.fifos.iter().map(|fifo| fifo.levels.as_slice()))
    }

    /// The trace's bytes and its notes.
    fn trace(&self, format: Format) -> (Vec<u8>, Vec<String>) {
        let caption = &Caption { title: "a run".to_owned(), partition: None, machine: "a machine".to_owned() };
        let cell_names = &NAMES.map(str::to_owned);
        let trace = Trace { caption, clock: self.spec.clock(), cell_names, recording: &self.recording };
        let mut bytes = Vec::new();
        trace.write(format, &mut bytes).unwrap();
        (bytes, trace.notes(format))
    }

    /// All that a trace shows of the array, by its name: the host, the cells, the FIFOs.
    fn activities(&self) -> Vec<(String, &StationRecord)> {
        let cells = self.recording.stations.iter().zip(NAMES).enumerate();
        let named = cells.map(|(index, (activity, name))| (format!("cell {index} {name}"), activity));
        std::iter::once(("host sends".to_owned(), self.recording.host.as_ref().unwrap())).chain(named).collect()
    }
}

/// What is read of Perfetto's messages, by their numbers in its documentation.
mod perfetto {
    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Trace {
        #[prost(message, repeated, tag = "1")]
        pub packet: Vec<TracePacket>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct TracePacket {
        #[prost(uint64, tag = "8")]
        pub timestamp: u64,
        #[prost(uint32, tag = "10")]
        pub trusted_packet_sequence_id: u32,
        #[prost(message, optional, tag = "11")]
        pub track_event: Option<TrackEvent>,
        #[prost(message, optional, tag = "12")]
        pub interned_data: Option<InternedData>,
        #[prost(message, optional, tag = "60")]
        pub track_descriptor: Option<TrackDescriptor>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct TrackDescriptor {
        #[prost(uint64, tag = "1")]
        pub uuid: u64,
        #[prost(string, tag = "2")]
        pub name: String,
        #[prost(uint64, tag = "5")]
        pub parent_uuid: u64,
        #[prost(message, optional, tag = "8")]
        pub counter: Option<CounterDescriptor>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct CounterDescriptor {
        #[prost(string, tag = "7")]
        pub y_axis_share_key: String,
    }

    /// Lists are not packed: a reader that expects one number must find it.
    #[derive(Clone, PartialEq, prost::Message)]
    pub struct TrackEvent {
        #[prost(uint64, tag = "3")]
        pub category_iids: u64,
        #[prost(message, repeated, tag = "4")]
        pub debug_annotations: Vec<DebugAnnotation>,
        #[prost(int32, tag = "9")]
        pub r#type: i32,
        #[prost(uint64, tag = "10")]
        pub name_iid: u64,
        #[prost(uint64, tag = "11")]
        pub track_uuid: u64,
        #[prost(string, tag = "23")]
        pub name: String,
        #[prost(int64, tag = "30")]
        pub counter_value: i64,
        #[prost(fixed64, tag = "47")]
        pub flow_ids: u64,
        #[prost(fixed64, tag = "48")]
        pub terminating_flow_ids: u64,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct DebugAnnotation {
        #[prost(uint64, tag = "1")]
        pub name_iid: u64,
        #[prost(uint64, tag = "3")]
        pub uint_value: u64,
        #[prost(string, tag = "6")]
        pub string_value: String,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct InternedData {
        #[prost(message, repeated, tag = "1")]
        pub event_categories: Vec<Name>,
        #[prost(message, repeated, tag = "2")]
        pub event_names: Vec<Name>,
        #[prost(message, repeated, tag = "3")]
        pub debug_annotation_names: Vec<Name>,
    }

    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Name {
        #[prost(uint64, tag = "1")]
        pub iid: u64,
        #[prost(string, tag = "2")]
        pub name: String,
    }
}

/// A slice of a Perfetto trace, in ns.
#[derive(Clone, Debug)]
struct Slice {
    track: String,
    name: String,
    depth: usize,
    from: u64,
    until: u64,
    arguments: BTreeMap<String, u64>,
    /// Who waits for whom, a line each.
    chain: Vec<String>,
}

/// A mark without length, from which arrows lead to the next one with the same flow.
#[derive(Clone, Debug)]
struct Mark {
    track: String,
    name: String,
    at: u64,
    flow: u64,
    is_end: bool,
    /// The slice that it is in, by its name and start.
    inside: (String, u64),
}

/// The slices, in the order in which they begin in the file, the marks, and each counter's values and what its scale is shared by.
struct Read {
    slices: Vec<Slice>,
    marks: Vec<Mark>,
    counters: HashMap<String, Vec<(u64, i64)>>,
    scales: HashMap<String, String>,
}

fn read_perfetto(bytes: &[u8]) -> Read {
    let trace = perfetto::Trace::decode(bytes).unwrap();
    assert!(trace.packet.iter().all(|packet| packet.trusted_packet_sequence_id == 1));
    let tracks: HashMap<u64, String> =
        trace.packet.iter().filter_map(|p| p.track_descriptor.as_ref()).map(|t| (t.uuid, t.name.clone())).collect();
    let interned = trace.packet.iter().find_map(|packet| packet.interned_data.as_ref()).unwrap();
    let named = |names: &[perfetto::Name], iid: u64| names.iter().find(|name| name.iid == iid).unwrap().name.clone();
    let tracked = trace.packet.iter().filter_map(|packet| packet.track_descriptor.as_ref());
    let scales = tracked.filter_map(|track| Some((track.name.clone(), track.counter.clone()?.y_axis_share_key)));
    let (slices, marks, scales) = (Vec::new(), Vec::new(), scales.collect());
    let mut read = Read { slices, marks, counters: HashMap::new(), scales };
    let mut open: HashMap<u64, Vec<usize>> = HashMap::new();
    let mut now: HashMap<u64, u64> = HashMap::new();
    for packet in &trace.packet {
        let Some(event) = &packet.track_event else { continue };
        let track = tracks[&event.track_uuid].clone();
        let stack = open.entry(event.track_uuid).or_default();
        let at = packet.timestamp;
        assert!(now.insert(event.track_uuid, at).is_none_or(|before| before <= at), "{track} goes back in time");
        let name = || match event.name_iid {
            0 => event.name.clone(),
            number => named(&interned.event_names, number),
        };
        match event.r#type {
            1 => {
                let name = name();
                let (texts, arguments): (Vec<_>, Vec<_>) =
                    event.debug_annotations.iter().partition(|a| !a.string_value.is_empty());
                for (number, text) in (1..).zip(&texts) {
                    assert_eq!(named(&interned.debug_annotation_names, text.name_iid), format!("who {number}"));
                }
                let chain = texts.into_iter().map(|text| text.string_value.clone()).collect();
                let arguments =
                    arguments.into_iter().map(|a| (named(&interned.debug_annotation_names, a.name_iid), a.uint_value));
                assert_eq!((event.flow_ids, event.terminating_flow_ids), (0, 0), "an arrow would lead from its end");
                if event.name.is_empty() {
                    let category = named(&interned.event_categories, event.category_iids);
                    assert!(category == category_of(&name) || category == "busy", "{name} is {category}");
                }
                let arguments = arguments.collect();
                stack.push(read.slices.len());
                read.slices.push(Slice { track, name, depth: stack.len() - 1, from: at, until: 0, arguments, chain });
            }
            2 => read.slices[stack.pop().expect("a slice ends that has begun")].until = at,
            3 => {
                let (name, flow) = (name(), event.flow_ids.max(event.terminating_flow_ids));
                let slice = &read.slices[*stack.last().expect("a mark is in a slice")];
                let (is_end, inside) = (event.terminating_flow_ids > 0, (slice.name.clone(), slice.from));
                read.marks.push(Mark { track, name, at, flow, is_end, inside });
            }
            4 => read.counters.entry(track).or_default().push((at, event.counter_value)),
            other => panic!("no event is of type {other}"),
        }
    }
    assert!(open.values().all(Vec::is_empty), "every slice ends");
    read
}

/// What a state is grouped into, unless it is work.
fn category_of(state: &str) -> &str {
    match state {
        "sending" | "receiving" => "moving",
        "waiting master" => "blocked",
        _ => state.split(' ').next().unwrap(),
    }
}

#[test]
fn a_farm_has_a_lane_for_each_task() {
    let folder = Folder::new();
    folder.run("farm rectangles --size 30x20 --tasks 2 --trace run.pftrace --stats run.json").success();
    let read = read_perfetto(&std::fs::read(folder.path("run.pftrace")).unwrap());
    let stats: serde_json::Value = serde_json::from_str(&folder.read("run.json")).unwrap();
    assert!(read.counters.is_empty());
    let mut jobs = 0;
    for task in stats["tasks"].as_array().unwrap() {
        let name = task["name"].as_str().unwrap();
        let on_track = || read.slices.iter().filter(|slice| slice.track == name);
        let computing = &task["busy"]["computing"];
        let others = task.as_object().unwrap().iter().filter(|(_, time)| time.is_u64());
        for (state, time) in others.chain([(&"computing".to_owned(), computing)]) {
            let slices = on_track().filter(|slice| slice.name == state.replace('_', " "));
            assert_eq!(Some(slices.map(|slice| slice.until - slice.from).sum()), time.as_u64(), "{name} {state}");
        }
        let items: Vec<&Slice> = on_track().filter(|slice| slice.name.starts_with("segment ")).collect();
        assert!(items.iter().all(|item| item.name == format!("segment {}", item.arguments["segment"])));
        assert!(items.is_empty() || name.starts_with("CAP "));
        jobs += items.len() as u64;
    }
    assert_eq!(Some(jobs), stats["items"].as_u64());
}

/// Each message of a hypercube's nodes, and of the host, is an arrow from where it is sent to where it arrives; each node's queue is a counter.
#[test]
fn messages_of_a_hypercube_are_arrows_and_its_queues_counters() {
    let folder = Folder::new();
    let run = "ipsc2 teapot --size 12x10 --nodes 5 --flow unlimited";
    folder.run(&format!("{run} --trace run.pftrace --stats run.json")).success();
    let read = read_perfetto(&std::fs::read(folder.path("run.pftrace")).unwrap());
    let stats: serde_json::Value = serde_json::from_str(&folder.read("run.json")).unwrap();
    let sent: u64 = stats["messages"].as_object().unwrap().values().map(|kind| kind["sent"].as_u64().unwrap()).sum();
    let (ends, starts): (Vec<&Mark>, Vec<&Mark>) = read.marks.iter().partition(|mark| mark.is_end);
    // The last packet arrives when the host is the only one left, and has nothing but that to wait for.
    assert_eq!((starts.len() as u64, ends.len() as u64), (sent, sent));
    let by_flow: HashMap<u64, &Mark> = ends.iter().map(|mark| (mark.flow, *mark)).collect();
    for start in starts {
        let end = by_flow[&start.flow];
        assert_eq!((&start.name, &end.name), (&format!("to {}", end.track), &format!("from {}", start.track)));
        assert!(start.at < end.at, "{start:?} {end:?}");
        assert_eq!(start.inside.0, "sending", "who sends has just done so: {start:?}");
    }
    for (node, task) in stats["tasks"].as_array().unwrap().iter().enumerate().take(5) {
        let levels = &read.counters[&format!("queue {node}")];
        let longest = levels.iter().map(|(_, rays)| *rays as u64).max();
        // Rays that come and go in one cycle do not show.
        assert!(longest <= task["counts"]["longest_queue"].as_u64() && longest > Some(0), "{levels:?}");
    }
    folder.run(&format!("{run} --trace run.vcd")).success();
    let waves = read_waves(folder.read("run.vcd").as_bytes(), "vcd");
    for node in 0..5 {
        let name = format!("hypercube.node_{node}.node_{node}_queue_{node}");
        let levels: Vec<&str> = waves[&name].iter().map(|(_, level)| level.as_str()).collect();
        let mut counted: Vec<String> =
            read.counters[&format!("queue {node}")].iter().map(|(_, rays)| rays.to_string()).collect();
        counted.dedup();
        assert_eq!(levels, counted, "{name}");
    }
}

#[test]
fn perfetto_slices_are_the_cells_states_and_sum_up_to_the_statistics() {
    let run = run(50.0);
    let (bytes, notes) = run.trace(Format::Perfetto);
    assert_eq!(notes, Vec::<String>::new());
    let read = read_perfetto(&bytes);
    for (cell, stats) in run.stats.stations.iter().enumerate() {
        let on_track = || read.slices.iter().filter(|slice| slice.track == format!("cell {cell} {}", NAMES[cell]));
        for state in run.stats.topology.states.all() {
            let slices = on_track().filter(|slice| slice.name == state.name);
            assert_eq!(slices.map(|slice| slice.until - slice.from).sum::<u64>(), 50 * stats.of(state.id).0);
        }
        let visits: Vec<&Slice> = on_track().filter(|slice| slice.name.starts_with("ray ")).collect();
        assert_eq!(visits.len() as u64, run.stats.jobs);
        for visit in visits {
            assert_eq!(visit.depth, 0);
            assert_eq!(visit.name, format!("ray {}", visit.arguments["ray"]));
            assert_eq!(visit.from, 50 * visit.arguments["cycle"]);
            assert_eq!(visit.until - visit.from, 50 * visit.arguments["cycles"]);
            let inside = on_track().filter(|s| s.depth == 1 && visit.from <= s.from && s.until <= visit.until);
            let inside = inside.inspect(|slice| assert_eq!(slice.arguments["ray"], visit.arguments["ray"]));
            assert_eq!(inside.map(|slice| slice.until - slice.from).sum::<u64>(), visit.until - visit.from);
        }
    }
    for (name, activity) in run.activities() {
        let states = read.slices.iter().filter(|slice| slice.track == name && !slice.name.starts_with("ray "));
        let states = states.map(|slice| (slice.name.as_str(), slice.from, slice.until));
        let recorded = activity.states.iter().map(|s| (run.state(s.state), 50 * s.from.0, 50 * s.until.0));
        assert_eq!(states.collect::<Vec<_>>(), recorded.collect::<Vec<_>>(), "{name}");
    }
}

/// Each wait tells who waits for whom in its middle, as `why` does of that cycle.
#[test]
fn perfetto_waits_tell_who_waits_for_whom() {
    let folder = Folder::new();
    for machine in ["--fifo-words 16", "--fifo-words 16 --link-mb-s 20 --latency-cycles 9"] {
        let run = format!("--mode pipeline --scene teapot --size-factor 3 --size 6x6 {machine} --host-ray-us 1");
        folder.run(&format!("{run} --trace a.pftrace --force")).success();
        let read = read_perfetto(&std::fs::read(folder.path("a.pftrace")).unwrap());
        let waits = |slice: &&Slice| slice.name.starts_with("waiting") || slice.name.starts_with("blocked");
        assert!(read.slices.iter().all(|slice| waits(&slice) != slice.chain.is_empty()));
        let links: std::collections::BTreeSet<usize> = read.slices.iter().map(|slice| slice.chain.len()).collect();
        assert!(links.len() >= 4, "chains of {links:?} links");
        let all: Vec<&Slice> = read.slices.iter().filter(waits).collect();
        for slice in all.iter().step_by(all.len() / 25) {
            let cell = slice.track.strip_prefix("cell ").map_or("host", |cell| cell.split(' ').next().unwrap());
            let at = slice.arguments["in cycle"];
            let told = folder.run(&format!("why {run} --cell {cell} --at {at}")).success().replace("\n  ", " ");
            let told: Vec<&str> = told.lines().skip_while(|line| !line.starts_with("cycle ")).skip(1).collect();
            assert_eq!(told.len(), slice.chain.len(), "{told:#?} {:#?}", slice.chain);
            let (last, links) = slice.chain.split_last().unwrap();
            for (ours, theirs) in links.iter().zip(&told) {
                assert_eq!(ours.replace(", ray", ""), theirs.replace(", ray", ""));
            }
            let who = |line: &str| line.split([',', '(']).next().unwrap().trim_end().to_owned();
            let theirs = who(told.last().unwrap());
            let on_its_way = |line: &str| line.split(" in cycle").next().unwrap().to_owned();
            assert_eq!(who(last).replace("moves words", "moves a word"), on_its_way(&theirs), "{told:#?}");
        }
    }
}

#[test]
fn perfetto_counters_are_the_fifos_levels() {
    let run = run(50.0);
    let read = read_perfetto(&run.trace(Format::Perfetto).0);
    assert_eq!(read.counters.len(), 8 + 1);
    let scale = "the scale of FIFOs of 20 words";
    assert_eq!(read.counters[scale], [(0, 20)], "a FIFO's scale ends with its capacity");
    assert!(read.counters.keys().all(|name| read.scales[name] == read.scales[scale]));
    for (name, levels) in run.fifos() {
        let levels: Vec<_> = levels.iter().map(|(cycle, words)| (50 * cycle.0, words.0 as i64)).collect();
        assert_eq!(read.counters[&format!("{name} (of 20 words)")], levels);
    }
}

#[test]
fn perfetto_arrows_lead_each_ray_from_the_host_through_every_cell_and_back_and_forward_in_time() {
    let run = run(50.0);
    let read = read_perfetto(&run.trace(Format::Perfetto).0);
    for mark in &read.marks {
        assert_eq!(mark.is_end, mark.name.starts_with("HIT"));
        assert_eq!(mark.inside, (mark.name.clone(), mark.at), "a mark is the start of its slice");
    }
    let mut flows: BTreeMap<u64, Vec<&Mark>> = BTreeMap::new();
    read.marks.iter().for_each(|mark| flows.entry(mark.flow).or_default().push(mark));
    assert_eq!(flows.len() as u64, run.stats.jobs);
    for mut steps in flows.into_values() {
        steps.sort_by_key(|mark| mark.at);
        assert!(steps.windows(2).all(|pair| pair[0].at < pair[1].at), "no two steps begin together: {steps:?}");
        let number = |step: &Mark| step.name.split(' ').nth(1).map(str::to_owned);
        assert!(steps.iter().all(|step| number(step) == number(steps[0])));
        let tracks: Vec<&str> = steps.iter().map(|step| step.track.as_str()).collect();
        let cells = ["cell 0 grid+slabs", "cell 1 intersection", "cell 2 grid+slabs", "cell 3 intersection"];
        assert_eq!(tracks, [&["host sends"], &cells[..], &["host reads HITs"]].concat());
    }
}

/// Every change of every signal as text, numbers in decimal: by its name, in the order of time.
fn read_waves(bytes: &[u8], ending: &str) -> BTreeMap<String, Vec<(u64, String)>> {
    let folder = Folder::new();
    let file = folder.file(&format!("trace.{ending}"), bytes);
    let mut waves = wellen::simple::read(file).unwrap();
    let variables: Vec<(String, wellen::SignalRef)> = {
        let hierarchy = waves.hierarchy();
        hierarchy.iter_vars().map(|variable| (variable.full_name(hierarchy), variable.signal_ref())).collect()
    };
    let signals: Vec<_> = variables.iter().map(|(_, signal)| *signal).collect();
    waves.load_signals(&signals);
    let times = waves.time_table();
    let text = |value: wellen::SignalValue| match value {
        wellen::SignalValue::String(text) => text.to_owned(),
        other => {
            let bits = other.to_bit_string().unwrap();
            u64::from_str_radix(&bits, 2).map_or("none".to_owned(), |number| number.to_string())
        }
    };
    let changes = |signal| {
        let changes = waves.get_signal(signal).unwrap().iter_changes();
        let mut changes: Vec<(u64, String)> =
            changes.map(|(time, value)| (times[time as usize], text(value))).collect();
        // What says no more than where the trace ends.
        changes.dedup_by(|later, earlier| later.1 == earlier.1);
        changes
    };
    variables.into_iter().map(|(name, signal)| (name, changes(signal))).collect()
}

#[test]
fn waves_are_the_states_the_rays_and_the_levels() {
    for (clock_ns, ticks) in [(50.0, 50), (33.25, 33_250)] {
        let run = run(clock_ns);
        let waves = read_waves(&run.trace(Format::Vcd).0, "vcd");
        assert!(waves == read_waves(&run.trace(Format::Fst).0, "fst"), "both formats tell the same");
        for (name, activity) in run.activities() {
            let scope = format!("array.{}", name.replace([' ', '+'], "_"));
            let mut states: Vec<_> = activity.states.iter().map(|s| (ticks * s.from.0, run.state(s.state))).collect();
            states.dedup_by_key(|state| state.1);
            let states: Vec<_> = states.into_iter().map(|(at, name)| (at, name.replace(' ', "_"))).collect();
            assert_eq!(waves[&format!("{scope}.{}_state", &scope["array.".len()..])], states, "{scope}");
            let mut rays = BTreeMap::from([(0, "none".to_owned())]);
            for visit in &activity.jobs {
                rays.insert(ticks * visit.from.0, visit.job.to_string());
                rays.insert(ticks * visit.until.0, "none".to_owned());
            }
            assert_eq!(
                waves[&format!("{scope}.{}_ray", &scope["array.".len()..])],
                rays.into_iter().collect::<Vec<_>>(),
                "{scope}"
            );
        }
        for (fifo, levels) in run.fifos() {
            let levels: Vec<_> = levels.iter().map(|(at, words)| (ticks * at.0, words.0.to_string())).collect();
            let (_, wave) = waves.iter().find(|(name, _)| name.ends_with(&format!("_{fifo}"))).unwrap();
            assert_eq!(wave, &levels, "{fifo}");
        }
        let hits = waves["array.host_reads.host_reads_hit"].iter().filter(|(_, value)| value != "none");
        assert_eq!(hits.count() as u64, run.stats.jobs);
    }
}

/// The save file names each signal as GTKWave does, which gives a range to what has several bits, in decimal or as text.
#[test]
fn a_save_file_shows_all_waves() {
    let folder = Folder::new();
    let stdout = folder.run(&format!("{RUN} --trace run.vcd")).success();
    assert!(stdout.ends_with("wrote run.vcd\nwrote run.vcd.gtkw\n"), "{stdout}");
    let (vcd, save) = (folder.read("run.vcd"), folder.read("run.vcd.gtkw"));
    assert!(save.contains("[dumpfile] \"run.vcd\"\n") && save.contains("\n-cell 1 intersection\n"), "{save}");
    let mut scopes = Vec::new();
    let mut shown = 0;
    for line in vcd.lines() {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["$scope", _, name, _] => scopes.push(name),
            ["$upscope", _] => drop(scopes.pop()),
            ["$var", kind, bits, _, name, _] => {
                let path = format!("{}.{name}", scopes.join("."));
                let line = match (kind, bits.parse::<u32>().unwrap()) {
                    ("string", _) => format!("@820\n{path}\n"),
                    (_, 1) => format!("@24\n{path}\n"),
                    (_, bits) => format!("@24\n{path}[{}:0]\n", bits - 1),
                };
                assert!(save.contains(&line), "{line}");
                shown += 1;
            }
            _ => {}
        }
    }
    assert_eq!(save.matches("\narray.").count(), shown);
    assert!(folder.run(&format!("{RUN} --trace run.vcd")).refused().contains("the file exists already"));
}

#[test]
fn a_clock_that_no_unit_fits_is_said() {
    let run = run(100.0 / 3.0);
    assert!(run.trace(Format::Perfetto).1[0].contains("rounded to ns"));
    assert!(run.trace(Format::Vcd).1[0].contains("rounded to fs"));
    let read = read_perfetto(&run.trace(Format::Perfetto).0);
    let end = read.slices.iter().map(|slice| slice.until).max().unwrap();
    assert!((end as f64 - run.stats.cycles.0 as f64 * 100.0 / 3.0).abs() <= 0.5);
}

const RUN: &str = "--mode hybrid --cells 4 --scene room --size 12x10 --fifo-words 16";

/// The changes of a VCD: what stands behind its declarations.
fn changes(vcd: &str) -> &str {
    &vcd[vcd.find("$enddefinitions").unwrap()..]
}

#[test]
fn runs_replays_and_images_write_traces() {
    let folder = Folder::new();
    folder.run(&format!("{RUN} --threads 1 --trace run.vcd --ops a.ops")).success();
    folder.run(&format!("{RUN} --threads 3 --trace threads.vcd")).success();
    folder.run("replay a.ops --fifo-words 16 --trace replay.vcd").success();
    assert_eq!(folder.read("run.vcd"), folder.read("threads.vcd"));
    assert_eq!(changes(&folder.read("run.vcd")), changes(&folder.read("replay.vcd")));
    let image = "image room --size 12x10 --fifo-words 16 -o image.png --force";
    folder.run(&format!("{image} --ops b.ops --trace image.vcd")).success();
    folder.run("replay b.ops --fifo-words 16 --trace again.vcd").success();
    assert_eq!(changes(&folder.read("image.vcd")), changes(&folder.read("again.vcd")));
    let stdout = folder.run(&format!("{RUN} --trace run.pftrace --page run.html")).success();
    assert!(stdout.ends_with("wrote run.html\nwrote run.pftrace\n"), "{stdout}");
}

#[test]
fn a_window_shows_its_cycles_and_no_others() {
    let folder = Folder::new();
    folder.run(&format!("{RUN} --trace all.vcd")).success();
    folder.run(&format!("{RUN} --trace part.vcd --trace-window 20000..30000")).success();
    let times = |name: &str| {
        let vcd = folder.read(name);
        let stamps = changes(&vcd).lines().filter_map(|line| line.strip_prefix('#'));
        stamps.map(|stamp| stamp.parse::<u64>().unwrap()).collect::<Vec<_>>()
    };
    let inside: Vec<u64> = times("all.vcd").into_iter().filter(|at| (1_000_000..1_500_000).contains(at)).collect();
    let part = times("part.vcd");
    assert_eq!((part.first(), part.last()), (Some(&1_000_000), Some(&1_500_000)));
    let shown: Vec<u64> = part[..part.len() - 1].iter().copied().filter(|at| inside.contains(at)).collect();
    assert_eq!(shown, inside);
    let beyond = folder.run(&format!("{RUN} --trace late.fst --trace-window 99000000.."));
    assert!(beyond.stderr.contains("note: the trace is empty: the run ended before its window"), "{}", beyond.stderr);
    assert!(folder.names().contains(&"late.fst".to_owned()));
}

#[test]
fn a_long_run_is_cut_and_says_where_to_go_on() {
    let folder = Folder::new();
    let run = "--mode pipeline --scene teapot --size 64x64";
    let finished = folder.run(&format!("{run} --trace a.pftrace"));
    let note = finished.stderr.lines().find(|line| line.contains("--trace-window")).unwrap().to_owned();
    let window = note.split("--trace-window ").nth(1).unwrap().split(' ').next().unwrap();
    let size = |name: &str| std::fs::metadata(folder.path(name)).unwrap().len();
    assert!(size("a.pftrace") < 40_000_000, "{}", size("a.pftrace"));
    // What comes next begins where this one ends.
    folder.run(&format!("{run} --trace b.vcd --trace-window {window}")).success();
    let next = folder.read("b.vcd");
    let first = changes(&next).lines().find_map(|line| line.strip_prefix('#')).unwrap();
    assert_eq!(window, format!("{}..", first.parse::<u64>().unwrap() / 50));
}

#[test]
fn bad_flags_are_refused() {
    let folder = Folder::new();
    let error = folder.run("--scene room --trace a.json").refused();
    assert!(
        error.contains("a.json") && error.contains("is no name of a trace") && error.contains(".pftrace"),
        "{error}"
    );
    for window in ["12", "9..9", "a..b", "5..4", "-1..3"] {
        let error = folder.run(&format!("--scene room --trace a.vcd --trace-window={window}")).refused();
        assert!(error.contains("--trace-window"), "{error}");
    }
    assert!(folder.run("--scene room --trace-window 1..2").refused().contains("--trace"));
    let error = folder.run("image room -o a.png --timing off --trace a.vcd").refused();
    assert!(error.contains("--trace is about the machine at work"), "{error}");
    assert_eq!(folder.names(), Vec::<String>::new());
}

/// A scene's name cannot end the comment that it stands in.
#[test]
fn a_name_does_not_break_a_dump() {
    let folder = crate::support::command::Folder::new();
    folder.file("a$end.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.run("--scene a$end.obj --size 2x2 --trace t.vcd").success();
    let dump = folder.read("t.vcd");
    assert_eq!(dump.matches("$comment").count(), 1);
    let comment = dump.split("$comment").nth(1).and_then(|rest| rest.split("$end").next()).unwrap();
    assert!(comment.contains("machine: 50 ns a cycle"), "{comment}");
    wellen::simple::read(folder.path("t.vcd")).unwrap();
}
