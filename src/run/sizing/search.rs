//! The search for the fewest words: depths are tried by timing the run under them.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rayon::prelude::*;

use super::{Depths, Fewer, Recorded, SizingError};
use crate::cancel::Cancel;
use crate::machine::{Array, Cycles, FifoName, MachineSpec, Stuck, Unfinished, Words};
use crate::measure::{Actor, Measured, StateTimes};
use crate::quantities::common_divisor;
use crate::run::timed::UNLIMITED;
use crate::seam::{Channel, OpBatch, OpKind};

/// What a search works with. `timed` is called after each run.
pub(super) struct Search<'a, N> {
    recorded: Recorded<'a>,
    cells: usize,
    cancel: &'a Cancel,
    timed: &'a N,
    pub fifos: Vec<FifoName>,
    /// What each FIFO must hold at the least.
    pub least: Vec<Words>,
    /// The words that each FIFO carries at a time: a divisor of all its messages.
    message: Vec<u64>,
    /// The cycles that each cell works in any run, if a run lasts at the least until all cells have done all their work.
    works: Option<Vec<Cycles>>,
    /// How many starts of the search there is time for.
    starts: usize,
}

/// A run under some depths.
struct Trial {
    end: End,
    /// The most that each FIFO held.
    most: Vec<Words>,
}

/// What is known of the depths of a FIFO below one that is enough.
#[derive(Clone, Copy, Debug)]
struct Below {
    /// As many words are too few.
    too_few: u64,
    /// So many messages below what is enough is tried next; a word, for 0. `None` if that has been too little.
    step: Option<u64>,
}

enum End {
    /// It took so many cycles.
    Done(Cycles),
    /// It takes more than it may.
    TooSlow,
    Stuck(Stuck),
}

/// A search from one start takes some twenty runs a FIFO. With fewer ops than that, times FIFOs, there is time for a second start, with
/// half as many for a third, and so on.
const SECOND_START: usize = 40_000_000;

/// In how many parts the unlimited depths are cut where the search begins with the same share of all.
const PARTS: u64 = 1024;

impl<'a, N: Fn() + Sync> Search<'a, N> {
    pub fn new(recorded: Recorded<'a>, cancel: &'a Cancel, timed: &'a N) -> Search<'a, N> {
        let cells = recorded.batches.first().map_or(1, |batch| batch.cells.len());
        let messages = messages(recorded.batches);
        let fifos: Vec<FifoName> = messages.keys().copied().collect();
        let least = |fifo: &FifoName| if fifo.channel == Channel::Z { recorded.least_z_words } else { Words(1) };
        let ops = |batch: &Arc<OpBatch>| batch.cells.iter().map(|cell| cell.ops().len()).sum::<usize>();
        let all = recorded.batches.iter().map(ops).sum::<usize>() * fifos.len();
        Search {
            recorded,
            cells,
            cancel,
            timed,
            least: fifos.iter().map(least).collect(),
            message: messages.into_values().collect(),
            works: None,
            starts: 1 + SECOND_START / all.max(1),
            fifos,
        }
    }

    /// Whether it is certain already that a run takes more than so many cycles: the words that have come back tell it, and so does the
    /// time in which a cell did not work, for all of its work adds to that.
    fn is_too_slow(&self, array: &Array, answers: &mut u64, most: Cycles) -> bool {
        while let Some(Cycles(returned)) = array.returned_in(*answers) {
            *answers += 1;
            if returned >= most.0 {
                return true;
            }
        }
        let Some(works) = self.works.as_ref().filter(|_| most != UNLIMITED) else { return false };
        let so_far = array.so_far();
        let stood = |times: &StateTimes| times.total() - so_far.topology.states.works(times);
        so_far.stations.iter().zip(works).any(|(times, &works)| stood(times) + works > most)
    }

    /// Times the run. It is broken off as soon as it is known to take more than `most` cycles.
    fn time(&self, words: &[Words], most: Cycles) -> Result<Trial, SizingError> {
        let depths = self.fifos.iter().copied().zip(words.iter().copied());
        let spec = MachineSpec { own_words: depths.collect(), ..self.recorded.spec.clone() };
        let mut array = Array::new(&spec, self.recorded.costs, self.cells);
        let (mut answers, mut end) = (0, None);
        for batch in self.recorded.batches {
            self.cancel.check()?;
            array.feed(Arc::clone(batch))?;
            if let Err(stuck) = array.run() {
                end = Some(End::Stuck(stuck));
                break;
            }
            if self.is_too_slow(&array, &mut answers, most) {
                end = Some(End::TooSlow);
                break;
            }
        }
        (self.timed)();
        let so_far = array.so_far();
        let named = so_far.topology.fifos.iter().zip(&so_far.fifos);
        let held: BTreeMap<FifoName, Words> =
            named.filter_map(|(info, (stats, _))| Some((info.name.parse().ok()?, stats.max))).collect();
        Ok(Trial {
            end: end.unwrap_or_else(|| ended(array, most)),
            most: self.fifos.iter().filter_map(|fifo| held.get(fifo).copied()).collect(),
        })
    }

    /// What each FIFO must hold so that no word ever waits for room.
    pub fn unlimited(&mut self) -> Result<Depths, SizingError> {
        let recorded = self.recorded;
        let mut array = Array::unlimited(recorded.spec, recorded.costs, self.cells);
        for batch in recorded.batches {
            self.cancel.check()?;
            array.feed(Arc::clone(batch))?;
            array.run()?;
        }
        (self.timed)();
        let so_far = array.so_far();
        let names = so_far.topology.fifos.iter().filter_map(|info| info.name.parse().ok());
        let enough: BTreeMap<FifoName, Words> = names.zip(array.enough()).collect();
        let own = |(fifo, &least): (&FifoName, &Words)| enough.get(fifo).map_or(least, |&words| words.max(least));
        let words = self.fifos.iter().zip(&self.least).map(own).collect();
        let works = so_far.stations.iter().map(|times| so_far.topology.states.works(times)).collect();
        let cycles = match ended(array, UNLIMITED) {
            End::Done(cycles) => cycles,
            End::TooSlow => UNLIMITED,
            End::Stuck(stuck) => return Err(stuck.into()),
        };
        self.works = last_op_answers(self.recorded.batches).then_some(works);
        Ok(Depths { words, cycles })
    }

    /// The fewest words with which the run takes no more than so many thousandths longer than with unlimited FIFOs. `faster` are
    /// depths that are found for a faster one.
    pub fn fewest(&self, unlimited: &Depths, slower: u64, faster: Option<Vec<Words>>) -> Result<Depths, SizingError> {
        let most = unlimited.slowed(slower);
        if let End::Done(cycles) = self.time(&self.least, most)?.end {
            return Ok(Depths { words: self.least.clone(), cycles });
        }
        let deepest = unlimited.words.iter().map(|words| words.0).max().unwrap_or(1);
        // Where the search begins: at what is fast enough already, at the unlimited depths, at the least one that all may share, or at
        // the least share of each. Each of these leads to other depths; the first is the shortest way.
        let capped = |words: u64| self.each(unlimited, |own| own.min(words));
        let shared = |part: u64| self.each(unlimited, |own| (own * part).div_ceil(PARTS));
        let begin = |start: usize| match (start, &faster) {
            (0, Some(faster)) => Ok(faster.clone()),
            (0 | 1, _) => Ok(unlimited.words.clone()),
            (2, _) => self.least_of(deepest, most, capped),
            _ => self.least_of(PARTS, most, shared),
        };
        let starts = match (&faster, slower) {
            (Some(_), _) => vec![0, 1, 2, 3],
            (None, 0) => vec![1, 2, 3],
            (None, _) => vec![2, 1, 3],
        };
        let starts: Vec<usize> = starts.into_iter().take(self.starts).collect();
        let descend = |start: usize| self.descend(begin(start)?, most);
        let found = starts.into_par_iter().map(descend).collect::<Result<Vec<Depths>, SizingError>>()?;
        let found = found.into_iter().min_by_key(|depths| (depths.total(), depths.cycles));
        Ok(found.unwrap_or_else(|| unlimited.clone()))
    }

    /// What of some depths is enough, given the most that each FIFO held. No word needs more places than the FIFO holds, but the one in
    /// which another is read in the same cycle.
    fn needed(&self, words: &[Words], held: &[Words]) -> Vec<Words> {
        let enough = words.iter().zip(held).zip(&self.least);
        enough.map(|((&words, held), &least)| words.min(Words(held.0 + 1)).max(least)).collect()
    }

    /// Depths that are worked out from the unlimited ones.
    fn each(&self, unlimited: &Depths, depth: impl Fn(u64) -> u64) -> Vec<Words> {
        let own = unlimited.words.iter().zip(&self.least);
        own.map(|(words, least)| Words(depth(words.0)).max(*least)).collect()
    }

    /// The first depths that are fast enough, of some that grow with a number from 1 to `last`, which are.
    fn least_of(
        &self,
        last: u64,
        most: Cycles,
        depths: impl Fn(u64) -> Vec<Words> + Sync,
    ) -> Result<Vec<Words>, SizingError> {
        let (mut too_few, mut enough) = (0, last);
        while enough - too_few > 1 {
            let middle = between(too_few, enough);
            let second = (self.starts == 1 && enough - middle > 1).then(|| between(middle, enough));
            let tried: Vec<u64> = std::iter::once(middle).chain(second).collect();
            let fits = |&number: &u64| self.fits(&depths(number), most);
            let found = tried.par_iter().map(fits).collect::<Result<Vec<_>, SizingError>>()?;
            let first = found.iter().position(Option::is_some).unwrap_or(tried.len());
            too_few = tried[..first].last().copied().unwrap_or(too_few);
            enough = tried.get(first).copied().unwrap_or(enough);
        }
        Ok(depths(enough))
    }

    /// The most that the FIFOs hold in a run that is fast enough; `None` if it is not.
    fn fits(&self, words: &[Words], most: Cycles) -> Result<Option<Vec<Words>>, SizingError> {
        let trial = self.time(words, most)?;
        Ok(matches!(trial.end, End::Done(_)).then_some(trial.most))
    }

    /// Lowers depths that are fast enough until none can be lowered by itself: the deepest FIFO first.
    fn descend(&self, mut words: Vec<Words>, most: Cycles) -> Result<Depths, SizingError> {
        let mut order: Vec<usize> = (0..words.len()).collect();
        order.sort_by_key(|&index| (std::cmp::Reverse(words[index]), index));
        // Many cannot be lowered any more, or by little only: the first steps down are short, and each is twice the last.
        let mut below: Vec<Below> =
            self.least.iter().map(|least| Below { too_few: least.0 - 1, step: Some(0) }).collect();
        loop {
            let mut left = order.iter().copied().filter(|&index| words[index].0 - below[index].too_few > 1);
            let Some(index) = left.next() else { break };
            let tried = self.tried((index, left.next()), &below, &words);
            let fits = |&(index, depth): &(usize, u64)| {
                let mut tried = words.clone();
                tried[index] = Words(depth);
                let held = self.fits(&tried, most)?;
                Ok(held.map(|held| self.needed(&tried, &held)))
            };
            let found = tried.par_iter().map(fits).collect::<Result<Vec<_>, SizingError>>()?;
            // What is too little for a FIFO stays so whatever becomes of the others. Of what is enough the first is taken: of the depths of
            // one FIFO, which rise, the least.
            let mut lower = None;
            for ((index, depth), enough) in tried.into_iter().zip(found) {
                match enough {
                    None => below[index].too_few = below[index].too_few.max(depth),
                    Some(enough) => lower = lower.or(Some((index, enough))),
                }
            }
            below[index].step = below[index].step.filter(|_| lower.as_ref().is_some_and(|(lower, _)| *lower == index));
            if let Some((index, lower)) = lower {
                below[index].step = below[index].step.map(|step| (2 * step).max(1));
                words = lower;
            }
        }
        match self.time(&words, UNLIMITED)?.end {
            End::Done(cycles) => Ok(Depths { words, cycles }),
            End::Stuck(stuck) => Err(stuck.into()),
            End::TooSlow => Ok(Depths { words, cycles: most }),
        }
    }

    /// What is tried at once: depths of a FIFO, rising. Where there is but one search, two are tried, as another core would have nothing to
    /// do: a word below what is enough for it, and for the next FIFO that is left; else a depth between what is too little and what is
    /// enough, and one that is `step` messages below that, or if that has been too little, a second one between. With more searches one is
    /// tried, a word below before all others.
    fn tried(&self, (index, next): (usize, Option<usize>), below: &[Below], words: &[Words]) -> Vec<(usize, u64)> {
        let (message, enough, Below { too_few, step }) = (self.message[index], words[index].0, below[index]);
        let a_word_below = |index: usize| (index, words[index].0 - 1);
        if step == Some(0) {
            let next = next.filter(|&next| self.starts == 1 && below[next].step == Some(0));
            return std::iter::once(index).chain(next).map(a_word_below).collect();
        }
        let close = step.map(|step| ((enough - 1) / message).saturating_sub(step - 1) * message);
        let middle = self.next(index, too_few, enough);
        let tried: BTreeSet<u64> = match close.filter(|&depth| depth > too_few) {
            _ if self.starts > 1 => [middle].into(),
            Some(close) => [middle, close].into(),
            None if enough - middle > 1 => [middle, self.next(index, middle, enough)].into(),
            None if middle - too_few > 1 => [self.next(index, too_few, middle), middle].into(),
            None => [middle].into(),
        };
        tried.into_iter().map(|depth| (index, depth)).collect()
    }

    /// The depth of a FIFO to be tried between one that is too little and one that is enough: whole messages, as a part of one is
    /// seldom worth more than none.
    fn next(&self, index: usize, too_few: u64, enough: u64) -> u64 {
        let message = self.message[index];
        let (below, above) = (too_few / message, enough.div_ceil(message));
        match above > below + 1 {
            true => message * between(below, above),
            false if enough.is_multiple_of(message) => enough - 1,
            false => between(too_few, enough),
        }
    }

    /// The run with one word fewer in each FIFO alone.
    pub fn one_fewer(&self, words: &[Words]) -> Result<Vec<Option<Fewer>>, SizingError> {
        let fewer = |index: usize| {
            let mut fewer = words.to_vec();
            fewer[index] = Words(words[index].0.saturating_sub(1));
            (fewer[index] >= self.least[index]).then(|| self.fewer(&fewer)).transpose()
        };
        (0..words.len()).into_par_iter().map(fewer).collect()
    }

    pub fn fewer(&self, words: &[Words]) -> Result<Fewer, SizingError> {
        Ok(match self.time(words, UNLIMITED)?.end {
            End::Done(cycles) => Fewer::Cycles(cycles),
            End::Stuck(stuck) => Fewer::Stuck(stuck),
            End::TooSlow => Fewer::Cycles(UNLIMITED),
        })
    }
}

/// How a run ended all of whose ops have been fed.
fn ended(array: Array, most: Cycles) -> End {
    match array.finish() {
        Err(Unfinished::Stuck(stuck)) => End::Stuck(stuck),
        Ok(Measured { cycles, .. }) | Err(Unfinished::Outlived(cycles)) if cycles <= most => End::Done(cycles),
        Ok(_) | Err(Unfinished::Outlived(_)) => End::TooSlow,
    }
}

/// A number between two that are more than 1 apart: depths are of all magnitudes, so the middle of these as long as they differ much.
fn between(below: u64, above: u64) -> u64 {
    let middle = if above > 4 * (below + 1) { ((below + 1) * above).isqrt() } else { below + (above - below) / 2 };
    middle.clamp(below + 1, above.saturating_sub(1).max(below + 1))
}

/// Whether the last thing that each cell does is to write words of an answer, which go on to the host through all cells behind it: no run
/// then ends before all work is done.
fn last_op_answers(batches: &[Arc<OpBatch>]) -> bool {
    let last = |cell: usize| batches.iter().rev().find_map(|batch| batch.cells[cell].ops().last());
    let cells = batches.first().map_or(0, |batch| batch.cells.len());
    (0..cells).all(|cell| last(cell).is_some_and(|op| op.kind() == OpKind::WriteY))
}

/// The FIFOs that carry words, and for each the largest number that all messages through it can be divided by.
fn messages(batches: &[Arc<OpBatch>]) -> BTreeMap<FifoName, u64> {
    let mut messages = BTreeMap::new();
    for batch in batches {
        let cells = batch.cells.len();
        let cell = |cell: usize| if cell < cells { Actor::Station(cell) } else { Actor::Host };
        let streams = std::iter::once(&batch.host).chain(&batch.cells);
        for (right, stream) in streams.enumerate() {
            for (channel, op) in stream.ops().iter().filter_map(|op| Some((op.kind().writes()?, op))) {
                let reader = if channel == Channel::Z { cell(right.saturating_sub(2)) } else { cell(right) };
                let message = messages.entry(FifoName { channel, reader }).or_insert(0);
                *message = common_divisor(*message, u64::from(op.count()));
            }
        }
    }
    // The last cell passes no rays on; and an op may be of no words.
    messages.retain(|fifo, words| *words > 0 && *fifo != FifoName { channel: Channel::X, reader: Actor::Host });
    messages
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seam::Costs;

    /// The next depth is always one that has not been tried.
    #[test]
    fn the_next_depth_is_between() {
        let words = [0, 1, 4, 5, 7, 8, 9, 15, 16, 17, 1000, 1 << 20];
        let (costs, spec) =
            (Costs::new(crate::program::work::vocabulary(false), |_| Cycles(1)), MachineSpec::default());
        let recorded = Recorded { batches: &[], costs: &costs, spec: &spec, least_z_words: Words(1) };
        let (cancel, timed) = (Cancel::default(), || ());
        let mut search = Search::new(recorded, &cancel, &timed);
        for message in [1, 5, 8] {
            search.message = vec![message];
            for too_few in words {
                for enough in words.into_iter().filter(|&enough| enough > too_few + 1) {
                    let next = search.next(0, too_few, enough);
                    assert!(too_few < next && next < enough, "{too_few} {next} {enough}");
                }
            }
        }
    }

    #[test]
    fn the_number_between_is_between() {
        for (below, above) in [(0, 2), (0, 3), (1, 3), (0, 1 << 20), (7, 9), (7, 10), (1000, 5000)] {
            let middle = between(below, above);
            assert!(below < middle && middle < above, "{below} {middle} {above}");
        }
    }
}
