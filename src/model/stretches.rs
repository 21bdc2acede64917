//! A few rays that stand for all of a run, in the order in which the host sends them.

use glam::DVec3;

use crate::geometry::Ray;
use crate::random;

/// How many rays are traced at the most, and how many pass along the row.
const TRACED: usize = 1 << 14;
const PASSED: usize = 1 << 16;

/// The same, times the cells of the row.
const TRACED_BY_CELLS: usize = 1 << 20;
const PASSED_BY_CELLS: usize = 1 << 22;

/// Rays of a stretch where neighbours in the order have nothing in common.
const STRETCH: usize = 256;

/// Neighbours are alike whose squared distance is less than this share of that of any two rays.
const ALIKE: f64 = 0.5;

/// Some of a run's rays, and how they stand for all.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretches {
    /// The rays that are traced, by their places in the order.
    pub traced: Vec<usize>,
    /// What passes along the row: one of those after the other, by its number among them.
    pub order: Vec<u32>,
    /// How many of the run's rays each that passes stands for, one after the other. FIFOs hold so many fewer of them.
    pub each: f64,
    /// Whether neighbours in the order are alike, or all are there.
    is_whole: bool,
}

impl Stretches {
    /// Of rays in the order in which they are sent, along so many cells.
    ///
    /// Few rays are all traced. Of more, where neighbours are alike, one of so many in a row is, and does for these neighbours: what comes
    /// to pass over many rays stays as it is. Where they have nothing in common, as when they are shuffled, that would make chance look
    /// like more than it is: there stretches of neighbours are traced, and done over and over, each time in another order.
    pub fn of(rays: &[Ray], cells: usize) -> Stretches {
        let most = |all: usize, by_cells: usize| rays.len().min(all).min((by_cells / cells.max(1)).max(STRETCH));
        let (traced, passed) = (most(TRACED, TRACED_BY_CELLS), most(PASSED, PASSED_BY_CELLS));
        let spread: Vec<usize> = (0..traced).map(|k| one_of(rays.len(), traced, k)).collect();
        if traced == rays.len() || are_alike(rays, &spread) {
            let order = (0..passed).map(|k| (k * traced / passed) as u32).collect();
            return Stretches { traced: spread, order, each: rays.len() as f64 / passed.max(1) as f64, is_whole: true };
        }
        let stretches = traced / STRETCH;
        let first = |stretch: usize| stretch * (rays.len() - STRETCH) / stretches.max(2).saturating_sub(1);
        let traced = (0..stretches).flat_map(|stretch| first(stretch)..first(stretch) + STRETCH).collect();
        let round = |round: usize| {
            let mut order: Vec<usize> = (0..stretches).collect();
            order.sort_by_cached_key(|&stretch| random::of_item(round as u64, stretch as u64));
            order.into_iter().flat_map(|stretch| stretch * STRETCH..(stretch + 1) * STRETCH)
        };
        let order = (0..).flat_map(round).take(passed).map(|ray| ray as u32).collect();
        Stretches { traced, order, each: 1.0, is_whole: false }
    }

    /// The same with so many times fewer that pass, for who would rather be early than near.
    pub fn fewer(&self, times: usize) -> Stretches {
        let kept = self.order.len().div_ceil(times).max(self.traced.len()).min(self.order.len());
        let times = self.order.len() as f64 / kept.max(1) as f64;
        let (order, each) = match self.is_whole {
            true => ((0..kept).map(|k| self.order[(k as f64 * times) as usize]).collect(), self.each * times),
            false => (self.order[..kept].to_vec(), self.each),
        };
        Stretches { traced: self.traced.clone(), order, each, is_whole: self.is_whole }
    }
}

/// One of the `k`-th of so many equal parts of all, at random.
fn one_of(all: usize, parts: usize, k: usize) -> usize {
    let (from, to) = (k * all / parts, (k + 1) * all / parts);
    from + (random::of_item(0, k as u64) % (to - from).max(1) as u64) as usize
}

/// Whether rays in these places are like their neighbours there, by where they begin and where they go.
fn are_alike(rays: &[Ray], places: &[usize]) -> bool {
    let some: Vec<&Ray> = places.iter().map(|&place| &rays[place]).collect();
    let origins: Vec<DVec3> = some.iter().map(|ray| ray.origin.as_dvec3()).collect();
    let directions: Vec<DVec3> = some.iter().map(|ray| ray.direction.as_dvec3().normalize_or_zero()).collect();
    [origins, directions].iter().all(|points| {
        let count = points.len() as f64;
        let middle = points.iter().sum::<DVec3>() / count;
        // Of any two: twice the variance.
        let any = 2.0 * points.iter().map(|point| point.distance_squared(middle)).sum::<f64>() / count;
        let neighbors = points.windows(2).map(|pair| pair[0].distance_squared(pair[1])).sum::<f64>() / count;
        neighbors <= ALIKE * any
    })
}
