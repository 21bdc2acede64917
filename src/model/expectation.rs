//! What a run will take, by the passage of a few of its rays: time, what of it is lost, and how deep FIFOs would have to be.

use rayon::prelude::*;

use super::passage::{Fifos, Passage};
use super::stretches::Stretches;

/// The depths that are tried: powers of two.
const DEPTHS: std::ops::RangeInclusive<u32> = 4..=17;

/// The losses for which depths are sought.
const LOSSES: [f64; 5] = [0.2, 0.1, 0.05, 0.02, 0.01];

/// So many times fewer rays pass while depths are sought for more than [`FEW_CELLS`]. (In a pipeline single candidates fill FIFOs, and
/// rays that stand for several make more of that than it is.)
const COARSER: usize = 4;
const FEW_CELLS: usize = 8;

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

    /// The fewest words of FIFOs, as many on X as on Y or fewer on one of them, for losses that some depth comes down to.
    pub fn depths(&self, fifos: &Fifos) -> Vec<Depth> {
        let stretches = self.stretches.fewer(if fifos.words.len() > FEW_CELLS { COARSER } else { 1 });
        let bound = self.passage.bound(&stretches.order, fifos) as f64;
        let most = |loss: f64| (bound / (1.0 - loss)) as u64;
        LOSSES.par_iter().filter_map(|&loss| self.depth((&stretches, fifos), loss, most(loss))).collect()
    }

    /// The cycles with such FIFOs, if they are no more than `most`. Each ray stands for several: there is room for so many fewer.
    fn within(&self, stretches: &Stretches, fifos: &Fifos, most: u64) -> Option<u64> {
        let fewer = |words: u64| ((words as f64 / stretches.each) as u64).max(words.min(RAY_WORDS));
        let words = fifos.words.iter().map(|words| words.map(fewer)).collect();
        self.passage.cycles(&stretches.order, &Fifos { words, ..*fifos }, most)
    }

    /// The fewest words with which the rays take no more than `most` cycles: as many on X as on Y, and then fewer on the channel that
    /// does with fewer.
    fn depth(&self, (stretches, fifos): (&Stretches, &Fifos), loss: f64, most: u64) -> Option<Depth> {
        let fits = |x: u32, y: u32| self.within(stretches, &fifos.with(1 << x, 1 << y), most).is_some();
        let (mut too_few, mut enough) = (DEPTHS.start() - 1, *DEPTHS.end());
        if !fits(enough, enough) {
            return None;
        }
        while enough - too_few > 1 {
            let middle = (too_few + enough) / 2;
            if fits(middle, middle) { enough = middle } else { too_few = middle }
        }
        let (mut x, mut y) = (enough, enough);
        while y > *DEPTHS.start() && fits(x, y - 1) {
            y -= 1;
        }
        while x > *DEPTHS.start() && fits(x - 1, y) {
            x -= 1;
        }
        Some(Depth { loss, x: 1 << x, y: 1 << y })
    }
}
