//! How nodes find out that pixels, and all of them, are done.

use super::{Ends, Next, Note, RegionNodes};
use crate::machine::Cycles;
use crate::machine::events::{Act, Turn};
use crate::program::cube::causes::takes;
use crate::program::cube::messages::{MessageKind, PACKET_PIXELS, TOKEN_BYTES, WORD_BYTES, packet_bytes};
use crate::program::cube::states::RECEIVING;

impl RegionNodes<'_> {
    /// A result of a tree has come to its node.
    pub(super) fn count(&mut self, task: usize, tree: u32) {
        let left = &mut self.left[tree as usize];
        *left -= 1;
        if *left > 0 {
            return;
        }
        self.trees_left -= 1;
        if self.trees_left == 0 {
            self.seen.true_end = Cycles(self.now);
        }
        let node = &mut self.nodes[task];
        node.done += 1;
        node.packet += 1;
        if self.rules.ends == Ends::Credit
            && (node.packet == PACKET_PIXELS || (node.pixels.is_empty() && node.done == node.begun))
        {
            self.send_packet(task, false);
        }
    }

    pub(super) fn send_packet(&mut self, task: usize, is_last: bool) {
        let count = std::mem::take(&mut self.nodes[task].packet);
        let host = self.nodes.len();
        let act = self.send(task, host, (MessageKind::Calculation, packet_bytes(count)), Note::Pixels(count, is_last));
        self.nodes[task].script.push_back(act);
    }

    /// Takes the token if it is here and there is nothing else to do. False if its turn is over.
    pub(super) fn token(&mut self, task: usize, turn: &mut impl Turn<Note>) -> Option<bool> {
        let node = &self.nodes[task];
        let is_passive = node.pixels.is_empty() && !node.slots.wants_any() && node.asked == 0;
        node.account.token.filter(|_| is_passive)?;
        self.nodes[task].next = Next::Passes;
        // Node 0 has the first token without having been sent it. A token that took no time would go round for ever while a ray is
        // under way.
        let was_sent = task > 0 || self.seen.probes > 0;
        let time = if was_sent { self.took(MessageKind::Information, TOKEN_BYTES).max(Cycles(1)) } else { Cycles(0) };
        Some(turn.act(Act::Work(RECEIVING, time, takes(MessageKind::Information))))
    }

    /// Passes the token on, or knows that all is over. False if its turn is over.
    pub(super) fn pass(&mut self, task: usize, now: Cycles, turn: &mut impl Turn<Note>) -> bool {
        let account = &mut self.nodes[task].account;
        let is_alone = self.ring.len() == 1;
        if task == 0 && (account.is_over() || is_alone) {
            account.token = None;
            self.seen.told_at = now;
            let others = 1..self.nodes.len();
            for other in others {
                let act = self.send(0, other, (MessageKind::Information, WORD_BYTES), Note::Stop);
                self.nodes[0].script.push_back(act);
            }
            return self.stop(0);
        }
        let token = if task == 0 { Some(account.begin()) } else { account.pass() };
        self.seen.probes += u64::from(task == 0);
        let Some(token) = token else { return true };
        let place = self.ring.iter().position(|&node| usize::from(node) == task).unwrap_or(0);
        let to = usize::from(self.ring[(place + 1) % self.ring.len()]);
        turn.act(self.send(task, to, (MessageKind::Information, TOKEN_BYTES), Note::Token(token)))
    }

    /// Is to send the host all its pixels, if only to say that there are none. Its turn goes on.
    pub(super) fn stop(&mut self, task: usize) -> bool {
        let mut left = std::mem::take(&mut self.nodes[task].packet);
        loop {
            let count = left.min(PACKET_PIXELS);
            left -= count;
            self.nodes[task].packet = count;
            self.send_packet(task, left == 0);
            if left == 0 {
                return true;
            }
        }
    }
}
