//! Which task is to wake up next.

/// When tasks wake up: each at one time at the most. A tree of matches, of which each is won by the earlier task, and of two that
/// wake up together by the one with the lower number.
#[derive(Debug)]
pub struct Agenda {
    /// When each task wakes up; [`NEVER`] if it does not.
    wakes: Vec<u64>,
    /// The winner of each match, whose players are those of the matches 2n and 2n + 1: the first is the final, the last half are
    /// the tasks themselves.
    winners: Vec<u32>,
}

const NEVER: u64 = u64::MAX;

impl Agenda {
    /// All tasks wake up at time 0.
    pub fn new(tasks: usize) -> Agenda {
        let width = tasks.next_power_of_two();
        let mut wakes = vec![0; tasks];
        wakes.resize(width, NEVER);
        let mut winners: Vec<u32> = vec![0; width].into_iter().chain(0..width as u32).collect();
        for place in (1..width).rev() {
            winners[place] = winners[2 * place];
        }
        Agenda { wakes, winners }
    }

    /// A task wakes up at that time, unless it does so earlier.
    #[inline]
    pub fn wake(&mut self, task: usize, at: u64) {
        if at < self.wakes[task] {
            self.set(task, at);
        }
    }

    /// The next task that wakes up, and when. Of those that wake up together it is the one with the lowest number.
    #[inline]
    pub fn next(&mut self) -> Option<(u64, usize)> {
        let task = self.winners[1] as usize;
        let at = self.wakes[task];
        if at == NEVER {
            return None;
        }
        self.set(task, NEVER);
        Some((at, task))
    }

    #[inline]
    fn set(&mut self, task: usize, at: u64) {
        self.wakes[task] = at;
        let mut place = (self.winners.len() / 2 + task) / 2;
        while place > 0 {
            let (low, high) = (self.winners[2 * place], self.winners[2 * place + 1]);
            let is_high = self.wakes[high as usize] < self.wakes[low as usize];
            self.winners[place] = if is_high { high } else { low };
            place /= 2;
        }
    }
}
