//! Simulated time in bins whose number is bounded.

/// What is kept of a stretch of time.
pub trait Bin: Clone + Default {
    /// Takes in what is kept of the stretch that follows.
    fn absorb(&mut self, later: &Self);
}

/// Bins of equal width over the time from cycle 0 on. The width is a power of two and doubles, pair by pair, whenever
/// the time outgrows the bins: the memory is bounded whatever the length of the run, and every bin stays exact.
#[derive(Clone, Debug)]
pub struct Timeline<B> {
    bins: Box<[B]>,
    /// A bin is 2^shift cycles wide.
    shift: u32,
}

impl<B: Bin> Timeline<B> {
    /// So many bins, an even number, each one cycle wide.
    pub fn new(bins: usize) -> Timeline<B> {
        Timeline { bins: vec![B::default(); bins].into(), shift: 0 }
    }

    /// The bin that a cycle lies in.
    #[inline]
    pub fn at(&mut self, cycle: u64) -> &mut B {
        while cycle >> self.shift >= self.bins.len() as u64 {
            self.widen();
        }
        &mut self.bins[(cycle >> self.shift) as usize]
    }

    /// Cuts the cycles `from..to` where bins meet, and visits each bin with the number of its cycles.
    #[inline]
    pub fn for_each(&mut self, mut from: u64, to: u64, mut visit: impl FnMut(&mut B, u64)) {
        while from < to {
            self.at(from);
            let end = (((from >> self.shift) + 1) << self.shift).min(to);
            visit(self.at(from), end - from);
            from = end;
        }
    }

    #[cold]
    fn widen(&mut self) {
        let half = self.bins.len() / 2;
        for index in 0..half {
            let mut both = self.bins[2 * index].clone();
            both.absorb(&self.bins[2 * index + 1]);
            self.bins[index] = both;
        }
        self.bins[half..].fill(B::default());
        self.shift += 1;
    }

    /// The bins of a run of `cycles` cycles, and their width: the smallest at which they hold the run.
    pub fn finish(mut self, cycles: u64) -> (Vec<B>, u64) {
        let Some(last) = cycles.checked_sub(1) else { return (Vec::new(), 1) };
        self.at(last);
        let mut bins = self.bins.into_vec();
        bins.truncate((last >> self.shift) as usize + 1);
        (bins, 1 << self.shift)
    }
}
