//! Which task is to wake up next.

/// When tasks wake up: each at one time at the most. A tree of matches, of which each is won by the earlier task, and of two that
/// wake up together by the one with the lower number.
#[derive(Debug)]
pub struct Agenda {
    /// Who won each match, whose players are the winners of the matches 2n and 2n + 1: the first is the final, the last half are the tasks
    /// themselves.
    matches: Vec<Wake>,
}

/// When a task wakes up, and which that is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Wake {
    /// [`NEVER`] if it does not.
    at: u64,
    task: usize,
}

const NEVER: u64 = u64::MAX;

impl Agenda {
    /// All tasks wake up at time 0.
    pub fn new(tasks: usize) -> Agenda {
        let width = tasks.next_power_of_two();
        let at = |task: usize| if task < tasks { 0 } else { NEVER };
        let players = (0..width).map(|task| Wake { at: at(task), task });
        let mut matches: Vec<Wake> = vec![Wake { at: NEVER, task: 0 }; width].into_iter().chain(players).collect();
        for place in (1..width).rev() {
            matches[place] = matches[2 * place];
        }
        Agenda { matches }
    }

    /// A task wakes up at that time, unless it does so earlier.
    #[inline]
    pub fn wake(&mut self, task: usize, at: u64) {
        let mut place = self.matches.len() / 2 + task;
        let wake = Wake { at, task };
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
        let Wake { at, task } = self.matches[1];
        if at == NEVER {
            return None;
        }
        let place = self.matches.len() / 2 + task;
        self.matches[place] = Wake { at: NEVER, task };
        Some((at, task))
    }

    /// Plays all matches of the task again that was the next.
    #[inline]
    pub fn settle(&mut self, task: usize) {
        let mut place = self.matches.len() / 2 + task;
        let mut winner = self.matches[place];
        while place > 1 {
            let other = self.matches[place ^ 1];
            // Of two that wake up together the left one wins, which has the lower number.
            let loses = other.at < winner.at || (other.at == winner.at && place & 1 == 1);
            winner = if loses { other } else { winner };
            place /= 2;
            self.matches[place] = winner;
        }
    }
}
