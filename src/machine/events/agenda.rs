//! Which task is to wake up next.

/// When tasks wake up: each at one time at the most. A tree of matches, of which each is won by the earlier task, and of two that
/// wake up together by the one with the lower number.
#[derive(Debug)]
pub struct Agenda {
    /// Who won each match, whose players are the winners of the matches 2n and 2n + 1: the first is the final, the last half are the tasks
    /// themselves.
    matches: Vec<Wake>,
}

/// When a task wakes up, and which that is: the time before the number, in one word, of which the lesser is found without a guess.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Wake(u128);

impl Wake {
    /// At [`NEVER`], if it does not.
    fn new(at: u64, task: usize) -> Wake {
        Wake(u128::from(at) << 64 | task as u128)
    }

    fn at(self) -> u64 {
        (self.0 >> 64) as u64
    }

    fn task(self) -> usize {
        self.0 as u64 as usize
    }
}

const NEVER: u64 = u64::MAX;

impl Agenda {
    /// All tasks wake up at time 0.
    pub fn new(tasks: usize) -> Agenda {
        let width = tasks.next_power_of_two();
        let at = |task: usize| if task < tasks { 0 } else { NEVER };
        let players = (0..width).map(|task| Wake::new(at(task), task));
        let mut matches: Vec<Wake> = vec![Wake::new(NEVER, 0); width].into_iter().chain(players).collect();
        for place in (1..width).rev() {
            matches[place] = matches[2 * place];
        }
        Agenda { matches }
    }

    /// A task wakes up at that time, unless it does so earlier.
    #[inline]
    pub fn wake(&mut self, task: usize, at: u64) {
        let mut place = self.matches.len() / 2 + task;
        let wake = Wake::new(at, task);
        if wake >= self.matches[place] {
            return;
        }
        self.matches[place] = wake;
        // It wins what it has won before, and may win more; behind a match that it loses nothing changes.
        while place > 1 && wake < self.matches[place ^ 1] {
            place /= 2;
            self.matches[place] = wake;
        }
    }

    /// The next task that wakes up, and when. Of those that wake up together it is the one with the lowest number. What it has won is
    /// played again by [`Agenda::settle`], when it is known when it wakes up again.
    #[inline]
    pub fn next(&mut self) -> Option<(u64, usize)> {
        let (at, task) = (self.matches[1].at(), self.matches[1].task());
        if at == NEVER {
            return None;
        }
        let place = self.matches.len() / 2 + task;
        self.matches[place] = Wake::new(NEVER, task);
        Some((at, task))
    }

    /// Plays all matches of the task again that was the next.
    #[inline]
    pub fn settle(&mut self, task: usize) {
        let mut place = self.matches.len() / 2 + task;
        let mut winner = self.matches[place];
        while place > 1 {
            winner = winner.min(self.matches[place ^ 1]);
            place /= 2;
            self.matches[place] = winner;
        }
    }
}
