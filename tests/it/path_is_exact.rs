//! Critical paths against a walk back through all that the ticking model did, and their slopes against exact replays.

use std::collections::BTreeMap;

use crate::support::looking_back::{LookedBack, bins_in_words, in_words, look_back};
use crate::support::random_ops::{batches_of, case, costs};
use pcs_sim::machine::{Array, Cycles, MachineSpec, Unfinished};
use pcs_sim::measure::{Cause, CriticalPath};
use pcs_sim::seam::{Costs, OpBatch};
use proptest::prelude::*;

/// The path of the batches, found with so many ops at a time. `None` if they are stuck.
fn path(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch], most_ops: usize) -> Option<CriticalPath> {
    let cells = batches[0].cells.len();
    let attempt = |limit: Cycles| {
        let mut array = Array::until(spec, costs, cells, limit).explained(most_ops);
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
        (spec, cells, rays, per_batch) in case(),
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
        (spec, cells, rays, per_batch) in case(),
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
