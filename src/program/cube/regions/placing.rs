//! Where rays go on that follow from one that has done its work, and how they get slots there.

use super::{Next, Node, Note, RegionNodes, Visit};
use crate::machine::events::{Act, Turn};
use crate::program::cube::causes::takes;
use crate::program::cube::messages::{MessageKind, RESULT_BYTES, TOKEN_BYTES, WORD_BYTES};
use crate::program::cube::pool::{Aside, Flow, Placing};
use crate::program::cube::states::{BLOCKED, RECEIVING};
use crate::program::cube::stuck::{Stuck, Waiting};

impl RegionNodes<'_> {
    /// A ray has a slot here, and waits for its turn.
    pub(super) fn keep(&mut self, task: usize, visit: Visit) {
        if let Flow::Classes(_) = self.rules.flow {
            self.take_slot(task);
        }
        self.nodes[task].own.push(visit);
        self.note_queue(task);
    }

    #[inline(always)]
    fn take_slot(&mut self, node: usize) {
        let free = &mut self.free[node];
        *free = free.saturating_sub(1);
        if let Flow::Block(all) | Flow::Classes(all) = self.rules.flow {
            let seen = &mut self.seen.nodes[node];
            seen.most_slots = seen.most_slots.max(all - *free);
        }
        self.note_slots(node);
    }

    /// A ray leaves the queue, and the node that has waited longest may send.
    pub(super) fn grant(&mut self, task: usize, turn: &mut impl Turn<Note>) {
        let node = &mut self.nodes[task];
        match node.slots.waiting.pop_front() {
            Some(other) => {
                turn.act(Act::Wake(other.into()));
                let other = &mut self.nodes[usize::from(other)];
                if let Next::Places { is_granted, .. } = &mut other.next {
                    *is_granted = true;
                }
            }
            None => {
                self.free[task] += 1;
                self.note_slots(task);
            }
        }
    }

    /// A ray has placed all that follows from it.
    #[inline]
    pub(super) fn leave(&mut self, task: usize, turn: &mut impl Turn<Note>) {
        if let Flow::Classes(_) = self.rules.flow {
            self.free[task] += 1;
            self.note_slots(task);
            if self.rules.asks_for_slots {
                self.give(task);
            }
            let mut blocked = self.blocked & self.nodes[task].slots.wanted_by;
            while blocked != 0 {
                let other = blocked.trailing_zeros() as usize;
                blocked &= blocked - 1;
                if self.has_room(task, self.nodes[other].slots.first_rank(task)) {
                    turn.act(Act::Wake(other));
                }
            }
        }
    }

    /// Places what follows from a ray until that takes time. False if its turn is over.
    #[inline(always)]
    pub(super) fn place(
        &mut self,
        task: usize,
        mut placing: Placing,
        is_granted: bool,
        turn: &mut impl Turn<Note>,
    ) -> bool {
        while let Some((visit, to)) = self.itinerary.follower(placing) {
            if to == task && self.is_the_rest(placing, visit) {
                // It has its line and its slot in common with the ray that met a blocker.
                self.nodes[task].own.push(visit);
                self.note_queue(task);
                return !placing.is_last || self.end(task, placing.visit, turn);
            }
            if !is_granted && self.lacks_slot(task, to, visit) {
                return self.wait_for_slot(task, (to, visit), placing, turn);
            }
            placing = self.itinerary.after(placing);
            if to == task {
                self.keep(task, visit);
                continue;
            }
            if !is_granted && self.free[to] != u32::MAX {
                self.take_slot(to);
            }
            self.nodes[task].next = Next::Places { placing, is_granted: false };
            return turn.act(self.send_ray(task, to, visit));
        }
        if !placing.is_new {
            self.leave(task, turn);
        }
        !placing.is_last || self.end(task, placing.visit, turn)
    }

    /// Whether a ray is the rest of a shadow ray behind what it has hit.
    fn is_the_rest(&self, placing: Placing, visit: Visit) -> bool {
        let is_shadow = |visit| self.itinerary.is_shadow(visit);
        visit.head != placing.visit.head && is_shadow(visit) && is_shadow(placing.visit)
    }

    /// All that follows from a ray is placed, which has ended: it makes a result. False if its turn is over.
    fn end(&mut self, task: usize, visit: Visit, turn: &mut impl Turn<Note>) -> bool {
        let (tree, owner) = self.itinerary.tree(visit);
        if owner == task {
            self.count(task, tree);
            return true;
        }
        self.nodes[task].account.sent();
        if self.nodes[task].script.is_empty() {
            return turn.act(self.send_result(task, owner, tree));
        }
        // Who has been given the slot that is free now is told first.
        let result = self.send_result(task, owner, tree);
        self.nodes[task].script.push_back(result);
        true
    }

    /// Whether a ray has to wait for a slot at a node, or to ask for one.
    #[inline]
    fn lacks_slot(&self, task: usize, to: usize, visit: Visit) -> bool {
        match self.rules.flow {
            Flow::Block(_) => to != task && self.free[to] == 0,
            Flow::Classes(_) => {
                (to != task && self.rules.asks_for_slots) || !self.has_room(to, self.itinerary.rank(visit))
            }
            Flow::Unlimited | Flow::Window(_) => false,
        }
    }

    /// What a node does then. False if its turn is over.
    #[inline(always)]
    fn wait_for_slot(
        &mut self,
        task: usize,
        (to, visit): (usize, Visit),
        placing: Placing,
        turn: &mut impl Turn<Note>,
    ) -> bool {
        match self.rules.flow {
            Flow::Block(_) => {
                self.nodes[to].slots.waiting.push_back(task as u16);
                self.nodes[task].next = Next::Places { placing, is_granted: false };
                turn.act(Act::Sleep(BLOCKED))
            }
            _ if to != task && self.rules.asks_for_slots => turn.act(self.ask(task, to, placing)),
            _ => {
                self.ages += 1;
                let aside = Aside { placing, age: self.ages };
                let rank = self.itinerary.rank(visit);
                self.nodes[task].slots.put_aside(to, rank, aside);
                self.nodes[to].slots.wanted_by |= 1 << task;
                true
            }
        }
    }

    /// Whether a node has a slot for such a rank.
    fn has_room(&self, node: usize, rank: u32) -> bool {
        self.free[node] > self.highest_rank - rank
    }

    #[inline(always)]
    fn send_ray(&mut self, task: usize, to: usize, visit: Visit) -> Act<Note> {
        self.nodes[task].account.sent();
        self.seen.sent[task * self.nodes.len() + to] += 1;
        self.send(task, to, (MessageKind::VirtualObject, self.ray_bytes), Note::Ray(visit))
    }

    #[inline(always)]
    fn send_result(&mut self, task: usize, owner: usize, tree: u32) -> Act<Note> {
        self.send(task, owner, (MessageKind::Calculation, RESULT_BYTES), Note::Result(tree))
    }

    /// Asks another node for a slot for what follows next from a ray.
    fn ask(&mut self, task: usize, to: usize, placing: Placing) -> Act<Note> {
        let node = &mut self.nodes[task];
        node.asked += 1;
        self.send(task, to, (MessageKind::Information, TOKEN_BYTES), Note::Asks(placing))
    }

    /// What a node does that is asked for a slot, or has been given one. False if its turn is over.
    pub(super) fn about_slots(&mut self, task: usize, turn: &mut impl Turn<Note>) -> Option<bool> {
        let node = &mut self.nodes[task];
        let (next, bytes) = match (node.requests.pop_front(), node.given.is_empty()) {
            (Some(placing), _) => (Next::Answers(placing), TOKEN_BYTES),
            (None, true) => return None,
            (None, false) => {
                node.asked -= 1;
                (Next::Places { placing: node.given.pop_front()?, is_granted: true }, WORD_BYTES)
            }
        };
        node.next = next;
        let time = self.took(MessageKind::Information, bytes);
        Some(turn.act(Act::Work(RECEIVING, time, takes(MessageKind::Information))))
    }

    /// A node has taken a request for a slot: it gives one, or remembers who waits.
    pub(super) fn answer(&mut self, task: usize, placing: Placing) -> bool {
        if let Some((visit, _)) = self.itinerary.follower(placing) {
            self.ages += 1;
            let aside = Aside { placing, age: self.ages };
            let rank = self.itinerary.rank(visit);
            self.nodes[task].slots.wait(rank, aside);
        }
        self.give(task);
        true
    }

    /// Gives slots to those who wait for them, as far as there are any.
    fn give(&mut self, task: usize) {
        let highest = self.highest_rank;
        while let Some(placing) = self.nodes[task].slots.take_waiting(|rank| self.free[task] > highest - rank) {
            self.take_slot(task);
            let to = self.asker(placing);
            let act = self.send(task, to, (MessageKind::Information, WORD_BYTES), Note::Gives(placing));
            self.nodes[task].script.push_back(act);
        }
    }

    /// The node that places something.
    fn asker(&self, placing: Placing) -> usize {
        match placing.is_new {
            true => self.itinerary.tree(placing.visit).1,
            false => self.itinerary.leg(placing.visit).node(),
        }
    }

    /// What a node has asked another for a slot for, and that other.
    fn asked_for(&self, node: usize) -> Option<(usize, Placing)> {
        let waits =
            |(to, other): (usize, &Node)| Some((to, other.slots.waiting_of(|placing| self.asker(placing) == node)?));
        self.nodes.iter().enumerate().find_map(waits)
    }

    /// Who waits for whom, when no node can go on.
    pub fn stuck(&self) -> Stuck {
        let waits = |(node, state): (usize, &Node)| {
            let (to, placing) = match (self.rules.flow, state.next) {
                (Flow::Block(_), Next::Places { placing, .. }) => (self.itinerary.follower(placing)?.1, placing),
                _ => state.slots.first_aside().or_else(|| self.asked_for(node))?,
            };
            let ray = self.itinerary.ray(self.itinerary.follower(placing)?.0);
            let task = &self.graph.rays[ray as usize];
            Some(Waiting { node, ray, kind: task.kind, tree: task.tree, to })
        };
        let slots = match self.rules.flow {
            Flow::Block(slots) | Flow::Classes(slots) => slots,
            Flow::Unlimited | Flow::Window(_) => 0,
        };
        let waiting: Vec<Waiting> = self.nodes.iter().enumerate().filter_map(waits).collect();
        Stuck::new(&waiting, slots, self.highest_rank + 1)
    }
}
