//! What is done before the first ray: the host sends each node its part of the scene, the nodes make their voxels' lists, and the host
//! lets all begin when the last has done so (RR-0992, §4.1).

use super::messages::{BLOCK_BYTES, WORD_BYTES};
use super::states::{GRID, RECEIVING, WAITING};
use crate::machine::events::{Act, Delivery, Message, Sender};
use crate::machine::{Cycles, Ipsc2};

/// A node's part of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Part {
    /// Its polygons.
    pub polygons: usize,
    /// Bytes of what the host sends it.
    pub bytes: u64,
    /// References to polygons in the lists that it makes.
    pub references: u64,
    /// Bytes of all that it then holds.
    pub holds: u64,
}

/// When each phase ended, from the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phases {
    /// The last node had its part.
    pub loaded: Cycles,
    /// The last node was told to begin.
    pub subdivided: Cycles,
}

/// The host and the nodes before the first ray. Messages tell nothing but how long they are.
#[derive(Clone, Debug)]
pub struct Preparation<'a> {
    machine: &'a Ipsc2,
    parts: &'a [Part],
    /// What each task has done, in steps.
    steps: Vec<u64>,
    /// When each phase ended.
    pub phases: Phases,
}

impl<'a> Preparation<'a> {
    /// At the start, with a part for each node.
    pub fn new(machine: &'a Ipsc2, parts: &'a [Part]) -> Preparation<'a> {
        Preparation { machine, parts, steps: vec![0; machine.nodes + 1], phases: Phases::default() }
    }

    /// What a task does next. The last is the host.
    pub fn next(&mut self, task: usize, now: Cycles) -> Act<()> {
        let step = self.steps[task];
        self.steps[task] += 1;
        if task == self.machine.nodes { self.host(step) } else { self.node(task, step, now) }
    }

    fn blocks(&self, node: usize) -> u64 {
        self.parts[node].bytes.div_ceil(BLOCK_BYTES).max(1)
    }

    fn host(&self, step: u64) -> Act<()> {
        let count = self.machine.nodes as u64;
        let mut left = step;
        for node in 0..self.machine.nodes {
            let blocks = self.blocks(node);
            if left < blocks {
                let bytes = if left + 1 == blocks { self.parts[node].bytes - left * BLOCK_BYTES } else { BLOCK_BYTES };
                return self.send(node, bytes);
            }
            left -= blocks;
        }
        match left {
            left if left < 2 * count && left % 2 == 0 => Act::Receive(Sender::Anyone, WAITING),
            left if left < 2 * count => self.take(WORD_BYTES),
            left if left < 3 * count => self.send((left - 2 * count) as usize, WORD_BYTES),
            _ => Act::End,
        }
    }

    fn node(&mut self, task: usize, step: u64, now: Cycles) -> Act<()> {
        let blocks = self.blocks(task);
        match step {
            step if step < 2 * blocks && step % 2 == 0 => Act::Receive(Sender::Anyone, WAITING),
            step if step < 2 * blocks => self.take(BLOCK_BYTES.min(self.parts[task].bytes)),
            step if step == 2 * blocks => {
                self.phases.loaded = self.phases.loaded.max(now);
                Act::Spend(GRID, Cycles(self.parts[task].references * self.machine.costs.fill.0))
            }
            step if step == 2 * blocks + 1 => self.send(self.machine.nodes, WORD_BYTES),
            step if step == 2 * blocks + 2 => Act::Receive(Sender::Anyone, WAITING),
            step if step == 2 * blocks + 3 => self.take(WORD_BYTES),
            _ => {
                self.phases.subdivided = self.phases.subdivided.max(now);
                Act::End
            }
        }
    }

    fn send(&self, to: usize, bytes: u64) -> Act<()> {
        let time = self.machine.messages.of(bytes);
        Act::Send(Message { delivery: Delivery::Post(to), time, bytes, content: () })
    }

    fn take(&self, bytes: u64) -> Act<()> {
        Act::Spend(RECEIVING, self.machine.messages.of(bytes))
    }
}
