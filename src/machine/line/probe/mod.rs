//! Sees what an array does over time, in bounded memory. An array without a probe pays nothing for it.

mod cell;
mod fifo;
mod jobs;

use std::sync::Arc;

use super::fifo::Fifo;
use super::link::Link;
use crate::machine::timeline::bins_for;
use crate::measure::{FifoProfile, Profile, StateTimes, Topology};
use crate::quantities::Cycles;
use crate::seam::{Channel, OpStream};
use cell::CellLane;
use fifo::FifoLane;
use jobs::JobLane;

/// Follows all cells and FIFOs of an array, and its jobs.
#[derive(Debug)]
pub(super) struct Probe {
    cells: Vec<CellLane>,
    /// X, Y and Z of each link, where there is such a FIFO.
    links: Vec<[Option<FifoLane>; 3]>,
    jobs: JobLane,
}

impl Probe {
    /// A probe for an array with these links.
    pub fn new(links: &[Link]) -> Probe {
        let cells = links.len() - 1;
        let bins = bins_for(cells);
        let lane = |exists: bool, fifo: &Fifo| exists.then(|| FifoLane::new(fifo.capacity(), bins));
        let lanes = |(index, link): (usize, &Link)| {
            [lane(index < cells, &link.x), lane(index > 0, &link.y), lane(index > 0 && index < cells, &link.z)]
        };
        Probe {
            cells: (0..cells).map(|_| CellLane::new(bins)).collect(),
            links: links.iter().enumerate().map(lanes).collect(),
            jobs: JobLane::new(bins),
        }
    }

    /// The watcher of one cell.
    pub fn cell(&mut self, index: usize) -> &mut CellLane {
        &mut self.cells[index]
    }

    /// Follows the FIFOs of a link, after each stretch of reads or writes.
    pub fn follow(&mut self, index: usize, link: &Link) {
        for (lane, fifo) in self.links[index].iter_mut().zip([&link.x, &link.y, &link.z]) {
            if let Some(lane) = lane {
                lane.follow(fifo);
            }
        }
        if index == 0 {
            self.jobs.follow(&link.x);
        }
    }

    /// The host's next lines are known.
    pub fn fed(&mut self, host: &OpStream) {
        self.jobs.fed(host);
    }

    /// The host read the last word of the next answer in that cycle.
    pub fn returned(&mut self, cycle: u64) {
        self.jobs.returned(cycle);
    }

    /// All that was seen in a run of `cycles` cycles. `clocks` are those of the cells at its end, `times` what they have spent in each
    /// state.
    pub fn finish(
        self,
        topology: &Arc<Topology>,
        links: &[Link],
        (clocks, times): (impl Iterator<Item = u64>, &[StateTimes]),
        cycles: u64,
    ) -> Profile {
        let mut fifos: [Vec<FifoProfile>; 3] = Default::default();
        for (lanes, link) in self.links.into_iter().zip(links) {
            for (lane, channel) in lanes.into_iter().zip(Channel::ALL) {
                let fifo = link.fifo(channel);
                let lane = lane.filter(|_| channel != Channel::Z || fifo.words_written() > 0);
                fifos[channel as usize].extend(lane.map(|lane| lane.finish(fifo, cycles)));
            }
        }
        let (jobs, latency, bin) = self.jobs.finish(cycles);
        Profile {
            topology: Arc::clone(topology),
            bin: Cycles(bin),
            cycles: Cycles(cycles),
            stations: self
                .cells
                .into_iter()
                .zip(clocks.zip(times))
                .map(|(lane, then)| lane.finish(then, cycles))
                .collect(),
            fifos: fifos.into_iter().flatten().collect(),
            jobs,
            latency,
        }
    }
}
