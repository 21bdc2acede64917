//! The messages on their way to a task, and those that it has not taken yet.

use std::collections::VecDeque;

/// Whose message a task wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sender {
    /// Anyone's.
    Anyone,
    /// That of one task.
    Task(usize),
}

impl Sender {
    pub(super) fn is(self, task: usize) -> bool {
        self == Sender::Anyone || self == Sender::Task(task)
    }
}

/// A message to a task.
#[derive(Clone, Debug)]
pub struct Mail<M> {
    /// When it arrives.
    pub at: u64,
    /// The chain of causes by which it arrives, where these are followed.
    pub cause: u32,
    /// Who sent it.
    pub from: usize,
    /// Whether the sender waits until it is taken.
    pub is_held: bool,
    /// What is in it.
    pub content: M,
}

/// The messages to a task in the order in which they are to be taken: by arrival, then by sender, then as they were sent.
#[derive(Clone, Debug)]
pub struct Mailbox<M>(VecDeque<Mail<M>>);

impl<M> Mailbox<M> {
    pub fn new() -> Mailbox<M> {
        Mailbox(VecDeque::new())
    }

    /// Adds a message that was just sent. Most arrive after all others.
    pub fn add(&mut self, mail: Mail<M>) {
        let is_before = |other: &Mail<M>| (other.at, other.from) <= (mail.at, mail.from);
        match self.0.iter().rposition(is_before).map_or(0, |before| before + 1) {
            place if place == self.0.len() => self.0.push_back(mail),
            place => self.0.insert(place, mail),
        }
    }

    /// All of them.
    pub fn all(&mut self) -> impl Iterator<Item = &mut Mail<M>> {
        self.0.iter_mut()
    }

    /// When the first message of a sender arrives.
    pub fn arrival(&self, from: Sender) -> Option<u64> {
        self.0.iter().find(|mail| from.is(mail.from)).map(|mail| mail.at)
    }

    /// Takes the first message of a sender, if it has arrived.
    #[inline]
    pub fn take(&mut self, from: Sender, now: u64) -> Option<Mail<M>> {
        let place = self.0.iter().position(|mail| from.is(mail.from))?;
        match self.0[place].at <= now {
            true if place == 0 => self.0.pop_front(),
            true => self.0.remove(place),
            false => None,
        }
    }
}
