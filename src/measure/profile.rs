//! A run over time, as a probe saw it. Every figure is an exact integer.

use std::sync::Arc;

use super::state::{StateKind, StateTimes};
use super::topology::Topology;
use crate::quantities::{Cycles, Words};

/// What a run did when: its time cut into bins of one width.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Profile {
    /// What the figures are of.
    pub topology: Arc<Topology>,
    /// Width of a bin: a power of two.
    pub bin: Cycles,
    /// Length of the run; the last bin ends with it.
    pub cycles: Cycles,
    /// For each station, its states in each bin.
    pub stations: Vec<Vec<StateTimes>>,
    /// The FIFOs.
    pub fifos: Vec<FifoProfile>,
    /// In each bin, how many answers' last words the host read.
    pub jobs: Vec<u64>,
    /// From a job's first word, written by the host, to the last word of its answer, read by the host; both included.
    pub latency: Latency,
}

impl Profile {
    /// The same run and what follows it, in which nobody does anything, until it is so long; unchanged if it is as long already.
    pub fn extended(&self, cycles: Cycles) -> Profile {
        let mut longer = self.clone();
        while longer.bin.0.saturating_mul(Profile::MOST_EXTENDED) < cycles.0 {
            longer.widen();
        }
        let idle = self.topology.states.all().iter().find(|state| state.kind == StateKind::Idle).map(|state| state.id);
        let mut end = self.cycles.0;
        while let Some(from) = Some(end).filter(|&end| end < cycles.0) {
            // The run's last bin goes on; whole ones follow it.
            let until = (from / longer.bin.0 + 1).saturating_mul(longer.bin.0).min(cycles.0);
            let (at, length) = ((from / longer.bin.0) as usize, Cycles(until - from));
            for bins in &mut longer.stations {
                bins.resize(bins.len().max(at + 1), StateTimes::default());
                idle.into_iter().for_each(|idle| *bins[at].of_mut(idle) += length);
            }
            for fifo in &mut longer.fifos {
                fifo.bins.resize(fifo.bins.len().max(at + 1), FifoBin::default());
                fifo.bins[at].min = Words(0);
            }
            longer.jobs.resize(longer.jobs.len().max(at + 1), 0);
            end = until;
        }
        longer.cycles = Cycles(end);
        longer
    }

    /// Bins of a run that is extended, at the most.
    const MOST_EXTENDED: u64 = 1024;

    /// Makes two bins one.
    fn widen(&mut self) {
        fn pairs<B>(bins: &mut Vec<B>, join: impl Fn(&[B]) -> B) {
            *bins = bins.chunks(2).map(join).collect();
        }
        let joined = |bins: &[StateTimes]| {
            let mut sum = StateTimes::default();
            bins.iter().for_each(|bin| sum.add(bin));
            sum
        };
        self.bin = Cycles(2 * self.bin.0);
        self.stations.iter_mut().for_each(|bins| pairs(bins, joined));
        self.fifos.iter_mut().for_each(|fifo| pairs(&mut fifo.bins, FifoBin::of_all));
        pairs(&mut self.jobs, |bins| bins.iter().sum());
    }
}

/// One FIFO over time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoProfile {
    /// What it held in each bin.
    pub bins: Vec<FifoBin>,
    /// Cycles for each occupancy: entry i is for the occupancies from i times `step` to just below (i + 1) times `step`.
    pub histogram: Vec<Cycles>,
    /// Occupancies that share an entry of the histogram: 1, unless the FIFO is very deep.
    pub step: Words,
}

/// What a FIFO held at the ends of some cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FifoBin {
    /// The lowest occupancy.
    pub min: Words,
    /// The highest occupancy.
    pub max: Words,
    /// The sum of the occupancies, in words times cycles.
    pub word_cycles: u128,
    /// Cycles at whose end it was full.
    pub full: Cycles,
}

impl Default for FifoBin {
    /// Of no cycle.
    fn default() -> FifoBin {
        FifoBin { min: Words(u64::MAX), max: Words(0), word_cycles: 0, full: Cycles(0) }
    }
}

impl FifoBin {
    /// Some FIFOs at the same time: the lowest and the highest level of any, and the sums of the rest.
    pub fn of_all(fifos: &[FifoBin]) -> FifoBin {
        FifoBin {
            min: fifos.iter().map(|bin| bin.min).min().unwrap_or_default(),
            max: fifos.iter().map(|bin| bin.max).max().unwrap_or_default(),
            word_cycles: fifos.iter().map(|bin| bin.word_cycles).sum(),
            full: fifos.iter().map(|bin| bin.full).sum(),
        }
    }
}

/// How long jobs took: exact extremes and sum, and counts in buckets at most a 32nd wide.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Latency {
    /// How many jobs.
    pub jobs: u64,
    /// The shortest.
    pub min: Cycles,
    /// The longest.
    pub max: Cycles,
    /// The sum of all.
    pub total: u128,
    /// Jobs for each bucket, up to the last that is not empty.
    pub buckets: Vec<u64>,
}

impl Latency {
    /// Buckets between one power of two and the next.
    const PARTS: u64 = 32;

    /// Counts one job.
    pub fn add(&mut self, latency: u64) {
        let bucket = Latency::bucket(latency);
        if bucket >= self.buckets.len() {
            self.buckets.resize(bucket + 1, 0);
        }
        self.buckets[bucket] += 1;
        self.min = Cycles(if self.jobs == 0 { latency } else { self.min.0.min(latency) });
        self.max = Cycles(self.max.0.max(latency));
        self.total += latency as u128;
        self.jobs += 1;
    }

    /// The bucket of a latency: small ones have one each, the others share a 32nd of their power of two.
    fn bucket(latency: u64) -> usize {
        let octave = latency.max(1).ilog2().saturating_sub(Latency::PARTS.ilog2());
        (octave as u64 * Latency::PARTS + (latency >> octave)) as usize
    }

    /// The shortest latency of a bucket.
    pub fn start_of(bucket: usize) -> Cycles {
        let octave = (bucket as u64 / Latency::PARTS).saturating_sub(1);
        Cycles((bucket as u64 - octave * Latency::PARTS) << octave)
    }

    /// The longest latency of a bucket.
    pub fn last_of(bucket: usize) -> Cycles {
        Cycles(Latency::start_of(bucket + 1).0 - 1)
    }

    /// The mean, in cycles.
    pub fn mean(&self) -> f64 {
        if self.jobs == 0 { 0.0 } else { self.total as f64 / self.jobs as f64 }
    }

    /// The latency that a share of the jobs, and no fewer, do not exceed: it is no less than the first and no more than the second, the
    /// bounds of the bucket that it falls into, which are one number for short latencies.
    pub fn quantile(&self, share: f64) -> (Cycles, Cycles) {
        let wanted = (share * self.jobs as f64).ceil() as u64;
        let mut seen = 0;
        let reached = self.buckets.iter().position(|count| {
            seen += count;
            seen >= wanted
        });
        let within = |latency: Cycles| latency.clamp(self.min, self.max);
        reached.map_or((self.max, self.max), |bucket| {
            (within(Latency::start_of(bucket)), within(Latency::last_of(bucket)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_latency_lies_in_its_bucket() {
        for latency in (0..5000).chain([1 << 20, (1 << 20) + 12345, u64::MAX / 4]) {
            let bucket = Latency::bucket(latency);
            assert!(Latency::start_of(bucket).0 <= latency, "{latency}");
            assert!(latency < Latency::start_of(bucket + 1).0, "{latency}");
        }
    }

    #[test]
    fn quantiles_lie_between_their_bounds() {
        let mut latency = Latency::default();
        (1..=1000).for_each(|cycles| latency.add(cycles));
        for (share, exact) in [(0.0, 1), (0.02, 20), (0.5, 500), (0.99, 990), (1.0, 1000)] {
            let (least, most) = latency.quantile(share);
            assert!(
                (least.0..=most.0).contains(&exact) && 32 * (most.0 - least.0) <= least.0,
                "{least} {exact} {most}"
            );
        }
        assert_eq!(latency.quantile(0.02), (Cycles(20), Cycles(20)), "short ones are exact");
        assert_eq!((latency.min, latency.max, latency.mean()), (Cycles(1), Cycles(1000), 500.5));
    }
}
