//! Rays by what they are for.

use serde::Serialize;

use super::summary::{aligned, grouped, table, time};
use crate::host::shading::RayKind;
use crate::measure::Clock;
use crate::run::{ByKind, KindCounts, KindLatencies, Timing};

/// The rays of each kind, for the statistics file.
#[derive(Clone, Debug, Serialize)]
pub struct RaysByKind {
    primary: Kind,
    shadow: Kind,
    reflected: Kind,
    refracted: Kind,
}

#[derive(Clone, Debug, Serialize)]
struct Kind {
    rays: u64,
    hits: u64,
    /// Cycles that the cells computed on them.
    busy: u64,
    /// In cycles, from the host's write of a ray's first word to its read of the hit's last, both counted.
    latency: Latency,
}

#[derive(Clone, Debug, Serialize)]
struct Latency {
    min: u64,
    mean: f64,
    p50: u64,
    p90: u64,
    p99: u64,
    max: u64,
}

impl RaysByKind {
    /// What was counted and timed.
    pub fn new(counts: &ByKind<KindCounts>, timing: &Timing) -> RaysByKind {
        let kind = |kind: RayKind| {
            let KindCounts { rays, hits, busy } = counts[kind as usize];
            Kind { rays, hits, busy, latency: Latency::new(&timing.latencies[kind as usize]) }
        };
        RaysByKind {
            primary: kind(RayKind::Primary),
            shadow: kind(RayKind::Shadow),
            reflected: kind(RayKind::Reflected),
            refracted: kind(RayKind::Refracted),
        }
    }
}

impl Latency {
    fn new(latencies: &KindLatencies) -> Latency {
        let at = |percent| latencies.percentile(percent).0;
        Latency { min: at(0), mean: latencies.mean(), p50: at(50), p90: at(90), p99: at(99), max: at(100) }
    }
}

/// A row a kind, for people: how many, and what they cost the cells; then, how long they took to come back.
pub fn kinds(counts: &ByKind<KindCounts>, timing: Option<(&Timing, Clock)>) -> String {
    let mut table = table(&["rays", "number", "hit", "busy cycles"]);
    table.add_rows(RayKind::ALL.map(|kind| {
        let KindCounts { rays, hits, busy } = counts[kind as usize];
        [kind.name().to_owned(), grouped(rays), grouped(hits), grouped(busy)]
    }));
    let latencies = timing.map(|(timing, clock)| format!("\n{}", latencies(counts, timing, clock)));
    aligned(table) + &latencies.unwrap_or_default()
}

/// A row for each kind that there were rays of.
fn latencies(counts: &ByKind<KindCounts>, timing: &Timing, clock: Clock) -> String {
    let mut table = table(&["latency", "min", "mean", "median", "90 %", "99 %", "max"]);
    for kind in RayKind::ALL.into_iter().filter(|&kind| counts[kind as usize].rays > 0) {
        let latencies = &timing.latencies[kind as usize];
        let cycles = |cycles: f64| time(clock.seconds_of(cycles));
        let at = |percent| cycles(latencies.percentile(percent).0 as f64);
        let figures = [at(0), cycles(latencies.mean()), at(50), at(90), at(99), at(100)];
        table.add_row([kind.name().to_owned()].into_iter().chain(figures));
    }
    aligned(table)
}
