//! The profile of a run, bin by bin, against the model that ticks every cycle.

use crate::support::random_ops::{batches_of, case, costs};
use crate::support::ticking::{self, History, Ticked};
use pcs_sim::machine::{Array, Cycles, MachineSpec, RateCounts, Unfinished, Words};
use pcs_sim::measure::{FifoBin, FifoProfile, Latency, Measured, Profile, StateId, StateTimes};
use pcs_sim::program::ArrayProgram;
use pcs_sim::seam::{Costs, OpBatch, OpKind, Unit};
use proptest::prelude::*;

/// Words of a ray's message.
const RAY_WORDS: usize = 8;

/// Times the ops in batches with a probe. `None` if they are stuck.
fn profile(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch]) -> Option<(Measured, Profile)> {
    let attempt = |limit: Cycles| {
        let mut array = Array::until(spec, costs, batches[0].cells.len(), limit).probed();
        for batch in batches {
            array.feed(batch.clone()).expect("an array can do it");
            array.run()?;
        }
        array.finish_observed()
    };
    let (stats, observed) = match attempt(Cycles(u64::MAX)) {
        Err(Unfinished::Outlived(cycles)) => attempt(cycles).expect("it ended before"),
        Err(Unfinished::Stuck(_)) => return None,
        Ok(finished) => finished,
    };
    Some((stats, observed.profile.expect("the array has a probe")))
}

/// The naive profile: what happened in every cycle, sorted into bins of a given width.
fn naive_profile(stats: &Ticked, history: &History, seen: &Profile) -> Profile {
    let bin = seen.bin;
    let width = bin.0 as usize;
    let bins = (stats.cycles.0 as usize).div_ceil(width);
    let mut jobs = vec![0; bins];
    let mut latency = Latency::default();
    history.returned.iter().for_each(|&returned| jobs[returned as usize / width] += 1);
    for (sent, returned) in history.sent.iter().step_by(RAY_WORDS).zip(&history.returned) {
        latency.add((returned + 1).saturating_sub(*sent));
    }
    Profile {
        topology: seen.topology.clone(),
        bin,
        cycles: stats.cycles,
        stations: history.states.iter().map(|states| states.chunks(width).map(count_states).collect()).collect(),
        fifos: (stats.fifos.iter().zip(&history.occupancies))
            .map(|((_, capacity, _), occupancies)| naive_fifo(*capacity, occupancies, width))
            .collect(),
        jobs,
        latency,
    }
}

fn count_states(states: &[StateId]) -> StateTimes {
    let mut times = StateTimes::default();
    states.iter().for_each(|&state| *times.of_mut(state) += Cycles(1));
    times
}

fn naive_fifo(capacity: Words, occupancies: &[u64], width: usize) -> FifoProfile {
    let capacity = capacity.0;
    let mut histogram = vec![Cycles(0); capacity as usize + 1];
    occupancies.iter().for_each(|&occupancy| histogram[occupancy as usize] += Cycles(1));
    let bin = |part: &[u64]| FifoBin {
        min: Words(part.iter().copied().min().unwrap()),
        max: Words(part.iter().copied().max().unwrap()),
        word_cycles: part.iter().sum(),
        full: Cycles(part.iter().filter(|&&occupancy| occupancy == capacity).count() as u64),
    };
    let bins = occupancies.chunks(width).map(bin).collect();
    FifoProfile { bins, histogram, step: Words(1) }
}

fn assert_exact(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch]) -> Profile {
    let (stats, profile) = profile(spec, costs, batches).expect("it ends");
    let (ticked, history) = ticking::run_recorded(spec, costs, batches).expect("it ends");
    assert_eq!(Ticked::from(&stats), ticked);
    let naive = naive_profile(&ticked, &history, &profile);
    for ((fifo, naive), info) in profile.fifos.iter().zip(&naive.fifos).zip(&profile.topology.fifos) {
        assert_eq!(fifo.bins, naive.bins, "bins of {}", info.name);
    }
    for (cell, (bins, naive)) in profile.stations.iter().zip(&naive.stations).enumerate() {
        assert_eq!(bins, naive, "bins of cell {cell}");
    }
    assert_eq!((&profile.jobs, &profile.latency), (&naive.jobs, &naive.latency));
    assert!(profile == naive, "{profile:?}\n{naive:?}");
    profile
}

/// A hundred rays of the room, in batches of a few, in a mode.
fn hundred_rays(program: &ArrayProgram) -> (Vec<OpBatch>, Costs) {
    let (scene, rays) = crate::support::scene("room", 1, 10);
    let rays: Vec<_> = rays.into_iter().collect();
    let workload = crate::support::workload(&scene.mesh, program, &rays);
    (crate::support::ops(&workload, &rays), workload.costs().clone())
}

#[test]
fn the_occupancy_curves_of_a_hundred_rays_are_the_ticking_models() {
    for (program, groups, stop_words) in
        [("pipeline", 1, None), ("broadcast", 5, None), ("hybrid", 2, None), ("pipeline", 1, Some(5))]
    {
        let (batches, costs) = hundred_rays(&ArrayProgram { stop_words, ..crate::support::program(program, groups) });
        for (fifo_words, latency, link_mb_s, rate_counts) in [
            (512, 1, 80.0, RateCounts::Link),
            (8, 1, 80.0, RateCounts::Link),
            (3, 7, 13.0, RateCounts::Channel),
            (64, 20, 160.0, RateCounts::Link),
        ] {
            let spec = MachineSpec {
                fifo_words: Words(fifo_words),
                latency: Cycles(latency),
                link_mb_s,
                rate_counts,
                ..MachineSpec::default()
            };
            let profile = assert_exact(&spec, &costs, &batches);
            assert_eq!(profile.latency.jobs, 100);
            assert!(profile.bin > Cycles(1), "the bins have been merged");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5_000, ..ProptestConfig::default() })]

    #[test]
    fn every_bin_equals_the_ticking_model((spec, cells, rays, per_batch) in case()) {
        let batches = batches_of(cells, &rays, per_batch);
        let costs = costs();
        if ticking::run(&spec, &costs, &batches).is_some() {
            assert_exact(&spec, &costs, &batches);
        }
    }
}

/// Bursts of all lengths through one cell that reads them late, at once, or while they come.
#[test]
fn bursts_are_entered_word_by_word() {
    for (burst, fifo_words, wait, latency) in
        (1..=20).flat_map(|burst| [1, 2, 7, 64].map(|words| (burst, words, burst * words % 29, 1 + words % 3)))
    {
        let mut batch = OpBatch::new(2);
        for ray in 0..60 {
            batch.host.push(OpKind::WriteX, burst);
            batch.host.end_line(ray);
            batch.cells[0].push(OpKind::Work(Unit(0)), wait * (ray as u64 % 3));
            batch.cells[0].push(OpKind::PassX, burst);
            batch.cells[0].push(OpKind::WriteY, 2);
            batch.cells[0].end_line(ray);
            batch.cells[1].push(OpKind::PassX, burst);
            batch.cells[1].push(OpKind::ReadY, 2);
            batch.cells[1].push(OpKind::WriteY, 5);
            batch.cells[1].end_line(ray);
        }
        let (fifo_words, latency) = (Words(fifo_words), Cycles(latency));
        assert_burst(&MachineSpec { fifo_words, latency, ..MachineSpec::default() }, &batch);
    }
}

fn assert_burst(spec: &MachineSpec, batch: &OpBatch) {
    let (stats, profile) = profile(spec, &costs(), std::slice::from_ref(batch)).expect("it ends");
    let (ticked, history) = ticking::run_recorded(spec, &costs(), std::slice::from_ref(batch)).expect("it ends");
    assert_eq!(Ticked::from(&stats), ticked);
    let naive = naive_profile(&ticked, &history, &profile);
    assert_eq!(profile.fifos, naive.fifos);
    assert_eq!(profile.stations, naive.stations);
}

/// A word that the host writes after the last hit has come back, and that nobody reads, is none of the run's.
#[test]
fn what_comes_after_the_run_is_not_in_the_profile() {
    let mut batch = OpBatch::new(1);
    batch.host.push(OpKind::WriteX, 8);
    batch.host.push(OpKind::Work(Unit(3)), 10_000);
    batch.host.push(OpKind::WriteX, 3);
    batch.host.end_line(0);
    batch.cells[0].push(OpKind::PassX, 8);
    batch.cells[0].push(OpKind::WriteY, 5);
    batch.cells[0].end_line(0);
    let (stats, profile) = profile(&MachineSpec::default(), &costs(), &[batch]).expect("it ends");
    assert_eq!(profile.fifos[0].histogram.iter().copied().sum::<Cycles>(), stats.cycles);
    assert_eq!(profile.fifos[0].bins.last().map(|bin| bin.max), Some(Words(0)));
}

#[test]
fn bins_are_as_many_however_long_the_run() {
    let (mut batches, costs) = hundred_rays(&crate::support::program("pipeline", 1));
    let batch = batches.remove(0);
    let bins = |repeats: usize| {
        let batches: Vec<OpBatch> = (0..repeats).map(|_| batch.clone()).collect();
        let (stats, profile) = profile(&MachineSpec::default(), &costs, &batches).expect("it ends");
        assert_eq!(profile.jobs.iter().sum::<u64>(), 100 * repeats as u64);
        for (cell, total) in profile.stations.iter().zip(&stats.stations) {
            for state in (0..16).map(StateId) {
                assert_eq!(cell.iter().map(|bin| bin.of(state)).sum::<Cycles>(), total.of(state));
            }
        }
        for (fifo, total) in profile.fifos.iter().zip(&stats.fifos) {
            assert_eq!(fifo.bins.iter().map(|bin| bin.word_cycles).sum::<u64>(), total.word_cycles);
            assert_eq!(fifo.bins.iter().map(|bin| bin.max).max(), Some(total.max));
            assert_eq!(fifo.bins.iter().map(|bin| bin.full).sum::<Cycles>(), total.full);
            assert_eq!(fifo.histogram[0], total.empty);
        }
        profile.jobs.len()
    };
    for repeats in [1, 7, 300] {
        assert!((512..=1024).contains(&bins(repeats)), "{repeats}");
    }
}
