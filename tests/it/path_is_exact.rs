//! Critical paths against a walk back through all that the ticking model did, and their slopes against exact replays.

use std::collections::BTreeMap;

use crate::support::looking_back::{LookedBack, bins_in_words, in_words, look_back};
use crate::support::random_ops::{RayPlan, batches_of, case, costs};
use pcs_sim::machine::{Array, Cycles, MachineSpec, Unfinished, Words};
use pcs_sim::measure::{Cause, CriticalPath};
use pcs_sim::seam::{Costs, OpBatch, OpKind, Unit};
use proptest::prelude::*;

/// The path of the batches, found with so many ops at a time. `None` if they are stuck.
fn path(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch], most_ops: usize) -> Option<CriticalPath> {
    let cells = batches[0].cells.len();
    let attempt = |limit: Cycles| {
        let mut array = Array::until(spec, costs, cells, limit).explained(most_ops).probed();
        for batch in batches {
            array.feed(batch.clone()).expect("an array can do it");
            array.run()?;
        }
        array.finish_observed()
    };
    let mut result = attempt(Cycles(u64::MAX));
    if let Err(Unfinished::Outlived(cycles)) = result {
        result = attempt(cycles);
    }
    match result {
        Ok((measured, observed)) => {
            let path = observed.path.expect("it was asked for");
            assert_eq!(path.cycles, measured.cycles);
            // Pages show the path beside the profile.
            let profile = observed.profile.expect("it was asked for");
            assert_eq!((path.bin, path.bins.len()), (profile.bin, profile.jobs.len()));
            Some(path)
        }
        Err(Unfinished::Stuck(_)) => None,
        Err(Unfinished::Outlived(_)) => panic!("it ended before"),
    }
}

/// How long the same ops take in another machine.
fn cycles(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch]) -> i64 {
    path(spec, costs, batches, usize::MAX).expect("it does not get stuck by other times").cycles.0 as i64
}

/// Random cases, half of them with FIFOs of a few words: where these are full the path goes through them.
fn cases() -> impl Strategy<Value = (MachineSpec, usize, Vec<RayPlan>, usize)> {
    (case(), any::<bool>()).prop_map(|((spec, cells, rays, per_batch), shallow)| {
        let fifo_words = Words(if shallow { 1 + spec.fifo_words.0 % 4 } else { spec.fifo_words.0 });
        (MachineSpec { fifo_words, ..spec }, cells, rays, per_batch)
    })
}

/// What the judge says of each bin of a path.
fn bins(judged: &LookedBack, bin: Cycles) -> Vec<BTreeMap<(String, String), u64>> {
    let of = |cycles: &[(String, String)]| {
        let mut sums = BTreeMap::new();
        cycles.iter().for_each(|cause| *sums.entry(cause.clone()).or_default() += 1);
        sums
    };
    judged.cycles.chunks(bin.0 as usize).map(of).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn every_part_equals_the_walk_back(
        (spec, cells, rays, per_batch) in cases(),
        most_ops in prop_oneof![Just(0usize), 1usize..400, Just(usize::MAX)],
    ) {
        let batches = batches_of(cells, &rays, per_batch);
        let costs = costs();
        let found = path(&spec, &costs, &batches, most_ops);
        let judged = look_back(&spec, &costs, &batches);
        prop_assert_eq!(found.is_some(), judged.is_some());
        if let (Some(found), Some(judged)) = (found, judged) {
            prop_assert_eq!(in_words(&found), judged.parts.clone());
            prop_assert_eq!(found.parts().iter().map(|part| part.cycles.0).sum::<u64>(), found.cycles.0);
            prop_assert_eq!(bins_in_words(&found), bins(&judged, found.bin));
        }
    }
}

/// How often something lies on a path.
fn count(path: &CriticalPath, what: impl Fn(Cause) -> bool) -> i64 {
    path.parts().iter().filter(|part| what(part.cause)).map(|part| part.count as i64).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, ..ProptestConfig::default() })]

    /// The straight line bounds the true time from below, whatever changes and however much. So for a change by a cycle
    /// either way it is exact wherever the true time is straight there.
    #[test]
    fn slopes_bound_the_true_time(
        (spec, cells, rays, per_batch) in cases(),
        unit in 0usize..12,
        by in prop_oneof![-7i64..=7, Just(100), Just(10_000)],
    ) {
        let batches = batches_of(cells, &rays, per_batch);
        let costs = costs();
        let Some(found) = path(&spec, &costs, &batches, 100) else { return Ok(()) };
        let now = found.cycles.0 as i64;
        let price = |unit: usize| found.units[unit].cycles.0 as i64;
        let slope = count(&found, |cause| cause == Cause::Work(unit));
        let changed = |by: i64| {
            Costs::new(costs.vocabulary().clone(), |other| {
                let by = if other.0 as usize == unit { by } else { 0 };
                Cycles((price(other.0 as usize) + by) as u64)
            })
        };
        let by = by.max(-price(unit));
        prop_assert!(cycles(&spec, &changed(by), &batches) >= now + by * slope);
        if price(unit) > 0 {
            let [less, more] = [-1, 1].map(|by| cycles(&spec, &changed(by), &batches) - now);
            prop_assert!(-less <= slope && slope <= more, "{} <= {slope} <= {more}", -less);
        }
        let slope = count(&found, |cause| matches!(cause, Cause::Latency(_)));
        let latency = spec.latency.0 as i64;
        let by = by.max(1 - latency);
        let other = MachineSpec { latency: Cycles((latency + by) as u64), ..spec.clone() };
        prop_assert!(cycles(&other, &costs, &batches) >= now + by * slope);
        let slope = count(&found, |cause| matches!(cause, Cause::Wire(_)));
        let rate = spec.link_rate().cycles_per_word as i64;
        let by = by.max(1 - rate);
        let other = MachineSpec { link_mb_s: 80.0 / (rate + by) as f64, ..spec.clone() };
        prop_assert_eq!(other.link_rate().cycles_per_word as i64, rate + by);
        prop_assert!(cycles(&other, &costs, &batches) >= now + by * slope);
    }
}

/// All causes occur on the random cases' paths, and most slopes are pinned by both neighbours: else the properties say little.
#[test]
fn random_paths_are_varied() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let (mut pinned, mut slopes) = (0, 0);
    for _ in 0..1000 {
        let (spec, cells, rays, per_batch) = cases().new_tree(&mut runner).unwrap().current();
        let (batches, costs) = (batches_of(cells, &rays, per_batch), costs());
        let Some(found) = path(&spec, &costs, &batches, 0) else { continue };
        let kinds: std::collections::BTreeSet<String> = in_words(&found)
            .into_keys()
            .map(|(who, why)| {
                let who = if who == "the host" { "host" } else { "cell" };
                let why =
                    if why.starts_with("unit") { "unit" } else { why.trim_end_matches(|c: char| c.is_ascii_digit()) };
                format!("{who}: {why}")
            })
            .collect();
        kinds.into_iter().for_each(|kind| *seen.entry(kind).or_default() += 1);
        let slope = count(&found, |cause| matches!(cause, Cause::Latency(_)));
        if spec.latency.0 > 1 {
            let other = |latency: u64| MachineSpec { latency: Cycles(latency), ..spec.clone() };
            let now = found.cycles.0 as i64;
            let less = cycles(&other(spec.latency.0 - 1), &costs, &batches) - now;
            let more = cycles(&other(spec.latency.0 + 1), &costs, &batches) - now;
            slopes += 1;
            pinned += (-less == slope && slope == more) as usize;
        }
    }
    let all = [
        "cell: latency of X",
        "cell: latency of Y",
        "cell: latency of Z",
        "cell: move",
        "cell: slot of X",
        "cell: slot of Y",
        "cell: unit",
        "cell: wire of X",
        "cell: wire of Y",
        "cell: wire of Z",
        "host: latency of Yhost",
        "host: move",
        "host: slot of Yhost",
        "host: unit",
        "host: wire of Yhost",
    ];
    for kind in all {
        assert!(seen.get(kind).is_some_and(|&count| count > 2), "{kind} is rare: {seen:?}");
    }
    assert!(pinned * 4 > slopes * 3, "{pinned} of {slopes} slopes are pinned");
}

/// Real programs on real scenes: the parts are the judge's, and slopes bound what a change of one of the machine's times does.
#[test]
fn on_real_scenes() {
    for (scene, size) in [("room", 1), ("teapot", 3)] {
        let (scene, rays) = crate::support::scene(scene, size, 7);
        for (mode, groups) in [("pipeline", 1), ("broadcast", 3), ("hybrid-3", 2)] {
            let program = crate::support::program(mode, groups);
            let workload = crate::support::workload(&scene.mesh, &program, &rays);
            let (batches, costs) = (crate::support::ops(&workload, &rays), workload.costs());
            for (fifo_words, link_mb_s) in [(512, 80.0), (5, 27.0)] {
                let spec = MachineSpec { fifo_words: Words(fifo_words), link_mb_s, ..MachineSpec::default() };
                let found = path(&spec, costs, &batches, 1000).expect("it ends");
                let judged = look_back(&spec, costs, &batches).expect("it ends");
                assert_eq!(in_words(&found), judged.parts, "{}, {mode}, {fifo_words} words", scene.name);
                assert_eq!(bins_in_words(&found), bins(&judged, found.bin));
                let now = found.cycles.0 as i64;
                for (unit, of) in found.units.iter().enumerate().filter(|(_, of)| of.cycles.0 > 0) {
                    let slope = count(&found, |cause| cause == Cause::Work(unit));
                    let price = of.cycles.0 as i64;
                    let at = |by: i64| {
                        let price = |other: Unit| {
                            if other.0 as usize == unit { Cycles((price + by) as u64) } else { costs.of(other) }
                        };
                        cycles(&spec, &Costs::new(costs.vocabulary().clone(), price), &batches) - now
                    };
                    for by in [-price, -price / 2, -price / 10, price / 10, price, 10 * price] {
                        assert!(at(by) >= by * slope, "{} by {by}", of.name);
                    }
                    assert!(-at(-1) <= slope && slope <= at(1), "{}", of.name);
                }
            }
        }
    }
}

/// Slots of Z are too rare for the random cases: cell 1 sends three words back to cell 0, which has room for one.
#[test]
fn slots_of_z_lie_on_the_path() {
    let costs = costs();
    let mut batch = OpBatch::new(2);
    batch.host.push(OpKind::WriteX, 1);
    batch.host.end_line(0);
    for (kind, count) in [(OpKind::PassX, 1), (OpKind::Work(Unit(4)), 5), (OpKind::ReadZ, 3)] {
        batch.cells[0].push(kind, count);
    }
    for (kind, count) in [(OpKind::ReadX, 1), (OpKind::WriteZ, 3), (OpKind::WriteY, 5)] {
        batch.cells[1].push(kind, count);
    }
    batch.cells.iter_mut().for_each(|cell| cell.end_line(0));
    let spec = MachineSpec { fifo_words: Words(1), ..MachineSpec::default() };
    let found = path(&spec, &costs, std::slice::from_ref(&batch), 0).expect("it ends");
    let judged = look_back(&spec, &costs, &[batch]).expect("it ends");
    assert_eq!(in_words(&found), judged.parts);
    // The second word waits for the read of the first behind 35 cycles of work, the third for that of the second.
    assert_eq!(judged.parts[&("cell 0".to_owned(), "slot of Z0".to_owned())], (2, 2));
}
