//! Messages of several rays, and messages that take the processors' time: an iPSC/2's nodes in a row (RR-0992, §4.2).

use serde_json::Value;

use crate::support::command::Folder;
use crate::support::ticking::{self, Ticked};
use crate::support::{machine, ops, program, scene};
use pcs_sim::geometry::Ray;
use pcs_sim::machine::{Array, Cycles, KernelTimes, MachineSpec, Words};
use pcs_sim::program::work::{self, MESSAGE};
use pcs_sim::program::{ArrayProgram, Workload};
use pcs_sim::scene::Mesh;
use pcs_sim::seam::{OpKind, OpStream};

fn workload(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray], message: Option<u64>) -> Workload {
    let times = KernelTimes { message: message.map(Cycles), ..machine().times };
    Workload::new(mesh, program, times, rays).unwrap()
}

/// What a line moves and how many messages it works on; other work is one star.
fn told(stream: &OpStream) -> Vec<String> {
    let op = |kind: OpKind, count: u32| match kind {
        OpKind::Work(MESSAGE) => format!("m{count}"),
        OpKind::Work(_) => "*".to_owned(),
        moves => format!("{}{count}", moves.letter().unwrap()),
    };
    let line = |ops: &[pcs_sim::seam::Op]| {
        let mut told: Vec<String> = ops.iter().map(|found| op(found.kind(), found.count())).collect();
        told.dedup_by(|next, before| next == "*" && before == "*");
        told.join(" ")
    };
    stream.lines().map(|(_, ops)| line(ops)).collect()
}

/// Three rays, two a message, on a row of three cells: the whole order of all, by hand.
#[test]
fn two_rays_a_message_by_hand() {
    let (scene, rays) = scene("room", 1, 4);
    let program = ArrayProgram { rays_per_message: 2, ..program("broadcast", 3) };
    let batches = ops(&workload(&scene.mesh, &program, &rays[..3], Some(5)), &rays[..3]);
    assert_eq!(told(&batches[0].host), ["*", "* m1 w16", "* m1 w8"]);
    let cells: Vec<Vec<String>> = batches[0].cells.iter().map(told).collect();
    // A bundle is taken as a whole, and passed on as a whole; the first has no hits to its left, the last nobody to its right.
    assert_eq!(cells[0], ["r16 m2 w16 *", "* m1 o10", "r8 m2 w8 * m1 o5"]);
    assert_eq!(cells[1], ["r16 m2 w16 *", "* i10 m2 o10", "r8 m2 w8 * i5 m2 o5"]);
    assert_eq!(cells[2], ["r16 m1 *", "* i10 m2 o10", "r8 m1 * i5 m2 o5"]);
    // Where messages take no time, words are passed on as they come.
    let batches = ops(&workload(&scene.mesh, &program, &rays[..3], None), &rays[..3]);
    assert_eq!(told(&batches[0].host), ["*", "* w16", "* w8"]);
    assert_eq!(told(&batches[0].cells[1]), ["x16 *", "* i10 o10", "x8 * i5 o5"]);
}

/// Each message is sent once and taken once, but for those that the host takes.
#[test]
fn messages_are_counted_at_both_ends() {
    let (scene, rays) = scene("teapot", 2, 9);
    for (mode, groups) in [("broadcast", 1), ("broadcast", 5), ("pipeline", 1), ("hybrid", 3), ("hybrid-3", 2)] {
        for bundle in [1, 4, 100] {
            let program = ArrayProgram { rays_per_message: bundle, ..program(mode, groups) };
            let batches = ops(&workload(&scene.mesh, &program, &rays, Some(1)), &rays);
            let (mut sent, mut taken, mut counted) = (0u64, 0u64, 0u64);
            let streams = batches.iter().flat_map(|batch| batch.cells.iter().chain([&batch.host]));
            for op in streams.flat_map(OpStream::ops) {
                match op.kind() {
                    OpKind::Work(MESSAGE) => counted += u64::from(op.count()),
                    OpKind::WriteX | OpKind::WriteY => sent += 1,
                    OpKind::ReadX | OpKind::ReadY => taken += 1,
                    _ => {}
                }
            }
            let of_hits = rays.len().div_ceil(bundle as usize) as u64;
            assert_eq!(sent, taken + of_hits, "{mode}: the host takes the last cell's hits for nothing");
            assert_eq!(counted, sent + taken, "{mode}, {bundle} rays a message");
        }
    }
}

/// Against the model that ticks every cycle, with FIFOs that hold a bundle and that hold none; all programs, and stop words.
#[test]
fn bundles_are_timed_exactly() {
    let (scene, rays) = scene("teapot", 2, 6);
    for (mode, groups, stop_words, bundle) in
        [("broadcast", 4, None, 3), ("broadcast", 4, None, 1), ("pipeline", 1, Some(3), 5), ("hybrid", 2, None, 7)]
    {
        for message in [None, Some(0), Some(37)] {
            let program = ArrayProgram { rays_per_message: bundle, stop_words, ..program(mode, groups) };
            let workload = workload(&scene.mesh, &program, &rays, message);
            let batches = ops(&workload, &rays);
            for (fifo_words, latency) in [(512, 1), (3, 9)] {
                let spec =
                    MachineSpec { fifo_words: Words(fifo_words), latency: Cycles(latency), ..MachineSpec::default() };
                let expected = ticking::run(&spec, workload.costs(), &batches).expect("it ends");
                let mut array = Array::new(&spec, workload.costs(), workload.cells());
                for batch in &batches {
                    array.feed(batch.clone()).unwrap();
                    array.run().unwrap();
                }
                assert_eq!(Ticked::from(&array.finish().unwrap()), expected, "{mode}, {message:?}, {fifo_words} words");
            }
        }
    }
}

/// The statistics count messages as they go, bundles and their rest each as one.
#[test]
fn bundles_are_messages() {
    let folder = Folder::new();
    let sent = |flags: &str| {
        let run = format!("--mode broadcast --scene room --size 5x2 --cells 3 {flags} --stats s.json --force");
        folder.run(&run).success();
        let stats: Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        ["virtual_object", "calculation"].map(|kind| stats["messages"][kind]["sent"].as_u64().unwrap())
    };
    // From the host and from two cells to the next; from three cells.
    assert_eq!(sent(""), [30, 30]);
    assert_eq!(sent("--rays-per-message 4"), [9, 9]);
    assert_eq!(sent("--message-us 0"), sent(""));
}

/// A message that takes no time costs what the words cost, or a little more where it is passed on as a whole; a unit that is not used
/// is in no vocabulary.
#[test]
fn without_its_time_there_is_no_such_unit() {
    assert_eq!(work::vocabulary(false).units.len(), usize::from(MESSAGE.0));
    let (scene, rays) = scene("room", 1, 4);
    let costs = workload(&scene.mesh, &program("broadcast", 2), &rays, Some(7)).costs().clone();
    assert_eq!(costs.of(MESSAGE), Cycles(7));
    assert_eq!(costs.vocabulary().unit(MESSAGE).unwrap().name, "message");
}

/// The row of nodes: bundles spread a message's time over their rays; ops keep the unit, and priced anew they are the new machine's.
#[test]
fn bundles_make_a_row_of_nodes_faster() {
    let folder = Folder::new();
    let run = "--on ipsc2 --mode broadcast --scene teapot --size 24x24 --cells 8 --partition work";
    let seconds = |flags: &str| {
        folder.run(&format!("{run} {flags} --stats s.json --force")).success();
        let stats: Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        stats["seconds"].as_f64().unwrap()
    };
    let (one, four, sixteen) = (seconds(""), seconds("--rays-per-message 4"), seconds("--rays-per-message 16"));
    assert!(sixteen < four && four < one, "{one} {four} {sixteen}");
    assert!(seconds("--message-us 0") < seconds("--message-us 160"));
    assert_eq!(seconds("--message-us 160"), one, "the machine file's");
    folder.run(&format!("{run} --rays-per-message 4 --ops m.ops --stats traced.json --force")).success();
    folder.run("replay m.ops --on ipsc2 --stats again.json --force").success();
    let cycles = |name: &str| serde_json::from_str::<Value>(&folder.read(name)).unwrap()["cycles"].clone();
    assert_eq!(cycles("traced.json"), cycles("again.json"));
    folder.run("replay m.ops --on ipsc2 --message-us 0 --stats free.json --force").success();
    assert!(cycles("free.json").as_u64() < cycles("again.json").as_u64());
    // The critical path has the unit's name, and the hits do not know of bundles.
    let why = folder.run(&format!("{run} --why --hits one.csv --force")).success();
    assert!(why.contains("message"), "{why}");
    folder.run(&format!("{run} --rays-per-message 5 --hits many.csv --force")).success();
    assert_eq!(folder.read("one.csv"), folder.read("many.csv"));
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    let refused = |line: &str| folder.run(line).refused();
    let told = [
        "--scene room --size 4x4 --mode broadcast --rays-per-message 0",
        "--scene room --size 4x4 --mode broadcast --rays-per-message 65537",
        "--scene room --size 4x4 --mode broadcast --rays-per-message 2 --forward-ahead 1",
        "--scene room --size 4x4 --mode broadcast --rays-per-message 2 --bounded-walk",
        "--scene room --size 4x4 --mode broadcast --rays-per-message 2 --cells-run programs",
        "--scene room --size 4x4 --mode broadcast --message-us 2 --cells-run programs",
        "--scene room --size 4x4 --mode broadcast --message-us=-1",
        "image room --size 4x4 --mode broadcast --rays-per-message 2 -o x.png",
        "image room --size 4x4 --timing off --rays-per-message 2 -o x.png",
        "model room --size 4x4 --on ipsc2 --mode broadcast",
        "model room --size 4x4 --mode broadcast --rays-per-message 2",
    ];
    insta::assert_snapshot!(told.map(|line| format!("{line}\n{}", refused(line))).join("\n"));
}
