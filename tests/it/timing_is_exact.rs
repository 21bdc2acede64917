//! The timing half against a model that ticks every cycle: every field of the statistics, on random op streams.

use crate::support::random_ops::{batch_of, batches_of, case, costs};
use crate::support::ticking::{self, Ticked};
use pcs_sim::machine::line::{IDLE, MOVING, blocked, waiting, working};
use pcs_sim::machine::{Array, Cycles, MachineSpec, Unfinished, Words};
use pcs_sim::program::ArrayProgram;
use pcs_sim::seam::{Activity, Channel, Costs, OpBatch};
use proptest::prelude::*;

/// Times the batches as the library's users do. `None` if they are stuck.
fn time(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch]) -> Option<Ticked> {
    let cells = batches[0].cells.len();
    let attempt = |limit: Cycles| {
        let mut array = Array::until(spec, costs, cells, limit);
        for batch in batches {
            array.feed(batch.clone()).expect("an array can do it");
            array.run()?;
        }
        array.finish()
    };
    match attempt(Cycles(u64::MAX)) {
        Ok(run) => Some(Ticked::from(&run)),
        Err(Unfinished::Outlived(cycles)) => Some(Ticked::from(&attempt(cycles).expect("it ended before"))),
        Err(Unfinished::Stuck(_)) => None,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, ..ProptestConfig::default() })]

    #[test]
    fn every_field_equals_the_ticking_model((spec, cells, rays, per_batch) in case()) {
        let batches = batches_of(cells, &rays, per_batch);
        let costs = costs();
        prop_assert_eq!(time(&spec, &costs, &batches), ticking::run(&spec, &costs, &batches));
    }
}

/// Real programs on real scenes, with FIFOs that never fill, sometimes, and always.
#[test]
fn on_real_scenes() {
    for (scene, size) in [("room", 1), ("teapot", 3)] {
        let (scene, rays) = crate::support::scene(scene, size, 7);
        for (mode, groups, stop_words, forward_ahead, bounded_walk) in [
            ("pipeline", 1, None, 0, false),
            ("broadcast", 3, None, 0, false),
            ("hybrid", 2, None, 0, false),
            ("hybrid-3", 2, None, 0, false),
            ("pipeline", 1, Some(1), 0, false),
            ("pipeline", 1, Some(10), 0, false),
            ("hybrid", 2, Some(4), 1, false),
            ("hybrid-3", 2, Some(2), 3, false),
            ("broadcast", 3, None, 4, false),
            ("broadcast", 5, None, 0, true),
            ("broadcast", 3, None, 4, true),
            ("hybrid", 2, None, 0, true),
            ("hybrid-3", 2, Some(2), 0, true),
        ] {
            let program =
                ArrayProgram { stop_words, forward_ahead, bounded_walk, ..crate::support::program(mode, groups) };
            let workload = crate::support::workload(&scene.mesh, &program, &rays);
            let batches = crate::support::ops(&workload, &rays);
            for (fifo_words, link_mb_s) in [(512, 80.0), (64, 80.0), (5, 27.0)] {
                let spec = MachineSpec { fifo_words: Words(fifo_words), link_mb_s, ..MachineSpec::default() };
                let expected = ticking::run(&spec, workload.costs(), &batches).expect("it ends");
                let found = time(&spec, workload.costs(), &batches).expect("it ends");
                assert_eq!(found, expected, "{}, {program:?}, {fifo_words} words, {link_mb_s} Mbyte/s", scene.name);
            }
        }
    }
}

/// Every state that a cell can be in occurs in some of the random cases, and so do standstills: else they test too little.
#[test]
fn random_cases_are_varied() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut seen = [0u64; 10];
    let mut stuck = 0;
    for _ in 0..400 {
        let (spec, cells, rays, _) = case().new_tree(&mut runner).unwrap().current();
        match time(&spec, &costs(), &[batch_of(cells, &rays, 0..rays.len())]) {
            None => stuck += 1,
            Some(stats) => {
                for cell in &stats.stations {
                    let [x, y, z] = Channel::ALL;
                    let parts = [
                        (0..4).map(|activity| cell.of(working(Activity(activity)))).sum(),
                        cell.of(MOVING),
                        cell.of(waiting(x)),
                        cell.of(waiting(y)),
                        cell.of(waiting(z)),
                        cell.of(blocked(x)),
                        cell.of(blocked(y)),
                        cell.of(blocked(z)),
                        cell.of(IDLE),
                        stats.fifos.iter().map(|(.., fifo)| fifo.full).sum(),
                    ];
                    seen.iter_mut().zip(parts).for_each(|(seen, part)| *seen += (part.0 > 0) as u64);
                }
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 20), "some state is rare: {seen:?}");
    assert!((20..300).contains(&stuck), "{stuck} of 400 cases are stuck");
}
