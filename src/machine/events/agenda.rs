//! Which task is to wake up next.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// When tasks wake up: each at one time at the most.
#[derive(Debug)]
pub struct Agenda {
    /// When each task wakes up; [`NEVER`] if it does not.
    wakes: Vec<u64>,
    /// Those times, and some that no longer hold.
    entries: BinaryHeap<Reverse<(u64, u32)>>,
}

const NEVER: u64 = u64::MAX;

impl Agenda {
    /// All tasks wake up at time 0.
    pub fn new(tasks: usize) -> Agenda {
        Agenda { wakes: vec![0; tasks], entries: (0..tasks as u32).map(|task| Reverse((0, task))).collect() }
    }

    /// A task wakes up at that time, unless it does so earlier.
    pub fn wake(&mut self, task: usize, at: u64) {
        if at < self.wakes[task] {
            self.wakes[task] = at;
            self.entries.push(Reverse((at, task as u32)));
        }
    }

    /// The next task that wakes up, and when. Of those that wake up together it is the one with the lowest number.
    pub fn next(&mut self) -> Option<(u64, usize)> {
        while let Some(Reverse((at, task))) = self.entries.pop() {
            let wake = &mut self.wakes[task as usize];
            if *wake == at {
                *wake = NEVER;
                return Some((at, task as usize));
            }
        }
        None
    }
}
