//! What a run will take, by the passage of a few of its rays: time, what of it is lost, and how deep FIFOs would have to be.

use rayon::prelude::*;

use super::passage::{Fifos, Passage};
use super::stretches::Stretches;

/// The depths that are tried: powers of two.
const DEPTHS: std::ops::RangeInclusive<u32> = 4..=17;

/// The losses for which depths are sought.
const LOSSES: [f64; 2] = [0.1, 0.02];

/// So many times fewer rays pass while depths are sought: each depth that is tried is a passage of all of them.
const COARSER: usize = 4;

/// What a run will take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expectation {
    /// Cycles a ray.
    pub cycles_per_ray: f64,
    /// The same if no FIFO were ever full.
    pub unlimited: f64,
    /// What the busiest of host, cells and links has to do of these for a ray.
    pub bound: f64,
}

/// A depth of all FIFOs on X, and on Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// The share of the time that is lost at the most, against what the busiest has to do.
    pub loss: f64,
    /// Words of each FIFO on X.
    pub x: u64,
    /// Words of each FIFO on Y.
    pub y: u64,
}

/// The share of a time that is lost against a shorter one.
pub fn loss(least: f64, cycles: f64) -> f64 {
    if cycles > 0.0 { 1.0 - least / cycles } else { 0.0 }
}

impl Expectation {
    /// The share of the time that is lost against what the busiest does.
    pub fn loss(&self) -> f64 {
        loss(self.bound, self.cycles_per_ray)
    }

    /// What of it deeper FIFOs would not give back.
    pub fn least_loss(&self) -> f64 {
        loss(self.bound, self.unlimited)
    }
}

/// A few rays that were traced to stand for all of a run.
#[derive(Clone, Debug)]
pub struct Few {
    /// What the host and the cells do for them.
    pub passage: Passage,
    /// How they stand for all.
    pub stretches: Stretches,
}

/// Words of a ray: a FIFO that holds one is taken to hold one, however many rays each that passes stands for.
const RAY_WORDS: u64 = super::throughput::RAY_WORDS as u64;

impl Few {
    /// What the run will take. `None` if the rays do not come to an end.
    pub fn expect(&self, fifos: &Fifos) -> Option<Expectation> {
        let rays = self.stretches.order.len().max(1) as f64;
        let deep = fifos.with(u64::MAX, u64::MAX);
        let times: Vec<Option<u64>> =
            [fifos, &deep].par_iter().map(|fifos| self.within(&self.stretches, fifos, u64::MAX)).collect();
        Some(Expectation {
            cycles_per_ray: times[0]? as f64 / rays,
            unlimited: times[1]? as f64 / rays,
            bound: self.passage.bound(&self.stretches.order, fifos) as f64 / rays,
        })
    }

    /// For losses that some depth comes down to, the fewest words of FIFOs on Y with deep ones on X, and with these the fewest on X.
    pub fn depths(&self, fifos: &Fifos) -> Vec<Depth> {
        let stretches = self.stretches.fewer(COARSER);
        let bound = self.passage.bound(&stretches.order, fifos) as f64;
        let depth = |loss: f64| {
            let most = (bound / (1.0 - loss)) as u64;
            let fits = |x: u32, y: u32| self.within(&stretches, &fifos.with(1 << x, 1 << y), most).is_some();
            let y = least(|y| fits(*DEPTHS.end(), y))?;
            let x = least(|x| fits(x, y))?;
            Some(Depth { loss, x: 1 << x, y: 1 << y })
        };
        LOSSES.par_iter().filter_map(|&loss| depth(loss)).collect()
    }

    /// The cycles with such FIFOs, if they are no more than `most`. Each ray stands for several: there is room for so many fewer.
    fn within(&self, stretches: &Stretches, fifos: &Fifos, most: u64) -> Option<u64> {
        let fewer = |words: u64| ((words as f64 / stretches.each) as u64).max(words.min(RAY_WORDS));
        let words = fifos.words.iter().map(|words| words.map(fewer)).collect();
        self.passage.cycles(&stretches.order, &Fifos { words, ..*fifos }, most)
    }
}

/// The least of the depths that are tried that fits, if deeper ones fit as well.
fn least(fits: impl Fn(u32) -> bool) -> Option<u32> {
    let depths: Vec<u32> = DEPTHS.collect();
    depths.get(depths.partition_point(|&depth| !fits(depth))).copied()
}
