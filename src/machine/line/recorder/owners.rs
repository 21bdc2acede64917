//! Whose words lie in a FIFO.

use std::collections::VecDeque;

use crate::measure::WordsOf;

/// Whose the words of one FIFO are, from one that matters on.
#[derive(Clone, Debug, Default)]
pub struct Owners {
    /// The number of the first word of the first of them.
    first: u64,
    runs: VecDeque<WordsOf>,
}

impl Owners {
    /// The writer's next ops write so many words, for a job or for none.
    pub fn fed(&mut self, job: Option<u32>, words: u64) {
        match self.runs.back_mut().filter(|last| last.job == job) {
            Some(last) => last.count += words,
            None if words > 0 => self.runs.push_back(WordsOf { job, count: words }),
            None => {}
        }
    }

    /// Words before this one matter no more.
    pub fn forget_before(&mut self, word: u64) {
        while let Some(front) = self.runs.front().filter(|front| self.first + front.count <= word) {
            self.first += front.count;
            self.runs.pop_front();
        }
    }

    /// Whose so many words are, from word `word` on.
    pub fn into_runs(mut self, word: u64, count: u64) -> Vec<WordsOf> {
        self.forget_before(word);
        let mut skipped = word - self.first;
        let mut left = count;
        let runs = self.runs.into_iter().map(|run| {
            let taken = (run.count - skipped).min(left);
            (skipped, left) = (0, left - taken);
            WordsOf { count: taken, ..run }
        });
        runs.take_while(|run| run.count > 0).collect()
    }
}
