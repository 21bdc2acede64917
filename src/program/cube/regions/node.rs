//! What a node has come to.

use std::collections::VecDeque;
use std::ops::Range;

use super::Note;
use super::itinerary::{Itinerary, Visit};
use crate::machine::Cycles;
use crate::machine::events::Act;
use crate::program::cube::pool::{Placing, Slots};
use crate::program::cube::token::Account;

/// So many rays or trees are looked at together.
const AT_ONCE: usize = 8;

#[derive(Clone, Debug)]
pub(super) struct Node {
    pub next: Next,
    /// What it does before it goes on.
    pub script: VecDeque<Act<Note>>,
    pub own: Vec<Visit>,
    pub received: VecDeque<Visit>,
    /// How many of these have been looked at, and how many of the pixels.
    pub looked_at: usize,
    pub looked_at_pixels: usize,
    pub results: VecDeque<u32>,
    /// What others ask it for slots for, and what it has been given slots for; so many it has asked for and not got.
    pub requests: VecDeque<Placing>,
    pub given: VecDeque<Placing>,
    pub asked: u32,
    /// Its pixels that are not begun, as trees; so many have been, and so many are done.
    pub pixels: Range<u32>,
    pub begun: usize,
    pub done: usize,
    /// Pixels that are done and not sent to the host.
    pub packet: u32,
    pub slots: Slots,
    pub account: Account,
    pub has_stopped: bool,
    /// Since when it has nothing to do.
    pub rests: Option<Cycles>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Next {
    /// Looks at what has come, and chooses.
    Looks,
    /// Has been asked for a slot.
    Answers(Placing),
    /// Places what follows from a ray, and may have been given the slot that it waited for.
    Places { placing: Placing, is_granted: bool },
    /// Has taken a result.
    Counts(u32),
    /// Has taken the token.
    Passes,
    /// Has been told that all is done.
    Stops,
}

impl Node {
    /// A node at the start.
    pub fn new(slots: Slots) -> Node {
        Node {
            next: Next::Looks,
            script: VecDeque::new(),
            own: Vec::new(),
            received: VecDeque::new(),
            looked_at: 0,
            looked_at_pixels: 0,
            results: VecDeque::new(),
            requests: VecDeque::new(),
            given: VecDeque::new(),
            asked: 0,
            pixels: 0..0,
            begun: 0,
            done: 0,
            packet: 0,
            slots,
            account: Account::default(),
            has_stopped: false,
            rests: None,
        }
    }

    /// Takes the first of those that have come.
    #[inline(always)]
    pub fn first_received(&mut self, itinerary: &Itinerary) -> Option<Visit> {
        if self.looked_at == 0 {
            itinerary.look_at(self.received.iter().take(AT_ONCE).copied());
            self.looked_at = AT_ONCE.min(self.received.len());
        }
        let visit = self.received.pop_front()?;
        self.looked_at -= 1;
        Some(visit)
    }

    /// Begins its next pixel.
    #[inline(always)]
    pub fn next_pixel(&mut self, itinerary: &Itinerary) -> Option<u32> {
        if self.looked_at_pixels == 0 {
            let count = AT_ONCE.min(self.pixels.len());
            itinerary.look_at_trees(self.pixels.start..self.pixels.start + count as u32);
            self.looked_at_pixels = count;
        }
        let tree = self.pixels.next()?;
        self.looked_at_pixels -= 1;
        self.begun += 1;
        Some(tree)
    }
}
