//! What an image's pixels take, before it is priced.

use crate::error::InputError;
use crate::host::camera::ImageSize;
use crate::machine::Capitan;
use crate::program::work;
use crate::quantities::Cycles;
use crate::seam::Unit;

/// Units of work, by their numbers in [`work`].
pub type Counts = [u32; UNITS];
/// How many units there are.
pub const UNITS: usize = work::HOST_HIT.0 as usize + 1;

/// The pixels of an image, line by line from the top left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// The size of the image.
    pub size: ImageSize,
    /// What each takes.
    pub work: PixelWork,
    /// Whether a segment begins with it: a run of pixels of a line that have the same part of the scene before them.
    pub starts: Vec<bool>,
}

/// What pixels take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PixelWork {
    /// Shares of what they take together, which is a time of the machine's for each.
    Weights(Vec<u32>),
    /// Units of work.
    Counts(Vec<Counts>),
}

/// All times of a run together stay below, so that no clock leaves 64 bits.
const LONGEST_RUN: u128 = 1 << 61;

impl Pixels {
    /// What each pixel takes on a machine.
    ///
    /// Fails if the whole would take longer than can be counted.
    pub fn priced(&self, machine: &Capitan) -> Result<Vec<Cycles>, InputError> {
        let times: Vec<Cycles> = match &self.work {
            PixelWork::Weights(weights) => shared(weights, machine.costs.pixel),
            PixelWork::Counts(counts) => {
                let prices = prices(machine);
                let time = |counts: &Counts| {
                    let units = counts.iter().zip(prices);
                    units.map(|(&count, price)| u128::from(count) * u128::from(price.0)).sum::<u128>()
                };
                counts.iter().map(|counts| Cycles(u64::try_from(time(counts)).unwrap_or(u64::MAX))).collect()
            }
        };
        let all: u128 = times.iter().map(|time| u128::from(time.0)).sum();
        match all < LONGEST_RUN {
            true => Ok(times),
            false => Err(InputError::new("the work of all pixels takes longer than can be counted")
                .help("make the image smaller, or the machine faster")),
        }
    }
}

/// What each unit of work takes on a machine.
pub(super) fn prices(machine: &Capitan) -> [Cycles; UNITS] {
    let costs = work::costs(&work::vocabulary(false), &machine.times, None);
    std::array::from_fn(|unit| costs.of(Unit(unit as u8)))
}

/// Shares out `mean` a pixel by their weights, so that the sum is exact.
fn shared(weights: &[u32], mean: Cycles) -> Vec<Cycles> {
    let sum: u128 = weights.iter().map(|&weight| u128::from(weight)).sum();
    let whole = u128::from(mean.0) * weights.len() as u128;
    let (mut weight, mut before) = (0u128, 0u64);
    let share = |&more: &u32| {
        weight += u128::from(more);
        let until = (whole * weight / sum.max(1)) as u64;
        Cycles(until - std::mem::replace(&mut before, until))
    };
    weights.iter().map(share).collect()
}
