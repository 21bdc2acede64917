//! Arrays whose FIFOs are as deep as the ops want them: how deep that is.

use super::array::Array;
use super::fifo::Fifo;
use crate::machine::MachineSpec;
use crate::quantities::Words;
use crate::seam::{Channel, Costs, OpBatch};

/// Knows how many words will have been written to each FIFO when the ops fed so far are done.
#[derive(Debug)]
pub(super) struct Coming {
    /// Of each link, on X, Y and Z.
    words: Vec<[u64; 3]>,
}

impl Coming {
    /// The batch comes, too.
    fn add(&mut self, batch: &OpBatch) {
        let last = self.words.len() - 1;
        let streams = std::iter::once(&batch.host).chain(&batch.cells);
        for (right, stream) in streams.enumerate() {
            for op in stream.ops() {
                if let Some(channel) = op.kind().writes() {
                    let link = if channel == Channel::Z { right.saturating_sub(1) } else { right };
                    self.words[link][channel as usize] += u64::from(op.count());
                }
            }
        }
        // The last cell passes no rays on.
        self.words[last][Channel::X as usize] = 0;
    }
}

impl Array {
    /// An array whose FIFOs get as deep as it needs for no word to wait for room, but no deeper than can be simulated.
    pub fn unlimited(spec: &MachineSpec, costs: &Costs, cells: usize) -> Array {
        let latency = spec.link_latency().0;
        let mut array = Array::new(spec, costs, cells);
        for link in &mut array.links {
            Channel::ALL.into_iter().for_each(|channel| *link.fifo_mut(channel) = Fifo::growing(latency));
        }
        array.coming = Some(Coming { words: vec![[0; 3]; array.links.len()] });
        array
    }

    /// Makes room for what a batch will write, in an array that is unlimited.
    pub(super) fn make_room(&mut self, batch: &OpBatch) {
        let Array { coming: Some(coming), links, host, cells, .. } = self else { return };
        coming.add(batch);
        let clock = |right: usize| right.checked_sub(1).map_or(&*host, |cell| &cells[cell]).cell.now.clock;
        for (index, (link, words)) in links.iter_mut().zip(&coming.words).enumerate() {
            for (channel, &until) in Channel::ALL.into_iter().zip(words) {
                let writer = if channel == Channel::Z { index + 1 } else { index };
                if until > 0 {
                    link.fifo_mut(channel).make_room(until, clock(writer), MachineSpec::MAX_FIFO_WORDS);
                }
            }
        }
    }

    /// How deep each FIFO must be for no word to wait for room in it, in an array that is unlimited: in the order of reports.
    pub fn enough(&self) -> Vec<Words> {
        self.fifos().map(|(link, channel)| Words(self.links[link].fifo(channel).places())).collect()
    }
}
