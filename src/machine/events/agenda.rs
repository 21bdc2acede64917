//! Which task is to wake up next.

/// When tasks wake up: each at one time at the most. A tree of matches, of which each is won by the earlier task, and of two that
/// wake up together by the one with the lower number.
#[derive(Debug)]
pub struct Agenda {
    /// Who won each match, whose players are the winners of the matches 2n and 2n + 1: the first is the final, the last half are the tasks
    /// themselves.
    matches: Vec<Wake>,
}

/// A task and when it wakes up; [`NEVER`] if it does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Wake {
    at: u64,
    task: u32,
}

const NEVER: u64 = u64::MAX;

impl Agenda {
    /// All tasks wake up at time 0.
    pub fn new(tasks: usize) -> Agenda {
        let width = tasks.next_power_of_two();
        let at = |task: usize| if task < tasks { 0 } else { NEVER };
        let players = (0..width).map(|task| Wake { at: at(task), task: task as u32 });
        let mut matches: Vec<Wake> = vec![Wake { at: NEVER, task: 0 }; width].into_iter().chain(players).collect();
        for place in (1..width).rev() {
            matches[place] = matches[2 * place];
        }
        Agenda { matches }
    }

    /// A task wakes up at that time, unless it does so earlier.
    #[inline]
    pub fn wake(&mut self, task: usize, at: u64) {
        if at < self.matches[self.matches.len() / 2 + task].at {
            self.set(task, at);
        }
    }

    /// The next task that wakes up, and when. Of those that wake up together it is the one with the lowest number.
    #[inline]
    pub fn next(&mut self) -> Option<(u64, usize)> {
        let Wake { at, task } = self.matches[1];
        if at == NEVER {
            return None;
        }
        self.set(task as usize, NEVER);
        Some((at, task as usize))
    }

    #[inline]
    fn set(&mut self, task: usize, at: u64) {
        let mut place = self.matches.len() / 2 + task;
        self.matches[place].at = at;
        place /= 2;
        while place > 0 {
            let (low, high) = (self.matches[2 * place], self.matches[2 * place + 1]);
            self.matches[place] = if high.at < low.at { high } else { low };
            place /= 2;
        }
    }
}
