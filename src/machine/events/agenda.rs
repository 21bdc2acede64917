//! Which task is to wake up next.

/// When tasks wake up: each at one time at the most. A tree of matches, of which each is won by the earlier task, and of two that
/// wake up together by the one with the lower number.
#[derive(Debug)]
pub struct Agenda {
    /// When each task wakes up.
    times: Vec<u64>,
    /// Who won each match, by its key. The first is the final, the players of match n are the winners of the matches 2n and 2n + 1, and
    /// the last half are the tasks themselves. Nobody is before what stands in place 0. A single task has won without a match.
    matches: Vec<u64>,
    /// A key is a time from `base` on, or [`Agenda::far`] if that is later, before the number of the task, which has so many bits.
    base: u64,
    bits: u32,
}

/// When a task wakes up that has to be woken by another.
pub const NEVER: u64 = u64::MAX;

impl Agenda {
    /// All tasks wake up at time 0.
    pub fn new(tasks: usize) -> Agenda {
        let (times, matches) = (vec![0; tasks], vec![u64::MAX; 2 * tasks.max(1)]);
        let mut agenda = Agenda { times, matches, base: 0, bits: tasks.next_power_of_two().ilog2() };
        agenda.play_all();
        agenda
    }

    /// The first time from `base` on of which keys only tell that it is not earlier.
    #[inline]
    fn far(&self) -> u64 {
        u64::MAX >> self.bits
    }

    #[inline]
    fn key(&self, task: usize, at: u64) -> u64 {
        (at - self.base).min(self.far()) << self.bits | task as u64
    }

    /// A task wakes up at that time, unless it does so earlier. It is not the one that was the next and is not settled yet.
    #[inline]
    pub fn wake(&mut self, task: usize, at: u64) {
        if at >= self.times[task] {
            return;
        }
        self.times[task] = at;
        let key = self.key(task, at);
        // It wins what it has won before, and may win more; behind a match that it loses nothing changes.
        let mut place = self.matches.len() / 2 + task;
        while key < self.matches[place] {
            self.matches[place] = key;
            place /= 2;
        }
    }

    /// The next task that wakes up, and when. Of those that wake up together it is the one with the lowest number. [`Agenda::settle`] is
    /// to be told when it wakes up again.
    #[inline]
    pub fn next(&mut self) -> Option<(u64, usize)> {
        let mut first = self.matches[1];
        if first >> self.bits == self.far() {
            first = self.look_far()?;
        }
        Some((self.base + (first >> self.bits), (first ^ first >> self.bits << self.bits) as usize))
    }

    /// The key of the first task, if none wakes up in the time of which keys can tell.
    #[cold]
    fn look_far(&mut self) -> Option<u64> {
        self.base = self.times.iter().copied().min().filter(|&at| at < NEVER)?;
        self.play_all();
        Some(self.matches[1])
    }

    fn play_all(&mut self) {
        let width = self.matches.len() / 2;
        for task in 0..self.times.len() {
            self.matches[width + task] = self.key(task, self.times[task]);
        }
        for place in (1..width).rev() {
            self.matches[place] = self.matches[2 * place].min(self.matches[2 * place + 1]);
        }
        self.matches[0] = 0;
    }

    /// The task that was the next wakes up at that time: plays all its matches again.
    #[inline]
    pub fn settle(&mut self, task: usize, at: u64) {
        self.times[task] = at;
        let mut winner = self.key(task, at);
        let mut place = self.matches.len() / 2 + task;
        self.matches[place] = winner;
        while place > 1 {
            winner = winner.min(self.matches[place ^ 1]);
            place /= 2;
            self.matches[place] = winner;
        }
    }
}
