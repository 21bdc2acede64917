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

    /// Adds a message that was just sent, which arrives at that time from that task. Most arrive after all others.
    #[inline(always)]
    pub fn add(&mut self, arrival: (u64, usize), mail: impl Fn() -> Mail<M>) {
        match self.0.back() {
            Some(last) if arrival < (last.at, last.from) => self.add_before(mail()),
            _ => self.0.push_back(mail()),
        }
    }

    /// Adds a message that arrives before others which were sent earlier.
    #[inline(never)]
    fn add_before(&mut self, mail: Mail<M>) {
        let place = self.0.partition_point(|other| (other.at, other.from) <= (mail.at, mail.from));
        self.0.insert(place, mail);
    }

    /// All of them.
    pub fn all(&mut self) -> impl Iterator<Item = &mut Mail<M>> {
        self.0.iter_mut()
    }

    /// When the first message of a sender arrives.
    pub fn arrival(&self, from: Sender) -> Option<u64> {
        self.0.iter().find(|mail| from.is(mail.from)).map(|mail| mail.at)
    }

    /// The first message of a sender and its place, if it has arrived.
    #[inline(always)]
    pub fn first(&self, from: Sender, now: u64) -> Option<(usize, &Mail<M>)> {
        let place = match from {
            Sender::Anyone => 0,
            Sender::Task(_) => self.0.iter().position(|mail| from.is(mail.from))?,
        };
        self.0.get(place).filter(|mail| mail.at <= now).map(|mail| (place, mail))
    }

    /// Removes the message in a place.
    #[inline(always)]
    pub fn remove(&mut self, place: usize) {
        if place == 0 {
            self.0.pop_front()
        } else {
            self.0.remove(place)
        };
    }
}
