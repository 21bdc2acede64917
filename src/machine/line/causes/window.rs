//! What happened since the last reckoning, as the array has it: what follows from what.

use std::collections::VecDeque;
use std::sync::Arc;

use super::Stand;
use super::waits::Waits;
use crate::machine::chains::{Chains, Code};
use crate::machine::line::hold::Hold;
use crate::machine::line::link::Link;
use crate::machine::line::prices::Prices;
use crate::seam::{Channel, Op, OpBatch, OpStream};

/// What happened, as far as it is known. Station 0 is the host, and station i + 1 cell i.
#[derive(Debug)]
pub(in crate::machine::line) struct Past<'a> {
    /// The batches that are held, from number `first` on.
    pub batches: &'a VecDeque<Arc<OpBatch>>,
    pub first: usize,
    pub links: &'a [Link],
    pub prices: &'a Prices,
    /// When the host read the last word of each answer.
    pub returned: &'a [u64],
    /// Where each station stands.
    pub stands: Vec<Stand>,
}

/// Where a chain of causes stands that ends in a cycle: somebody at the beginning of a cycle in which it moves a word, or
/// where it stands now.
pub(super) type Point = (usize, u64);

/// The cycle of a point that stands for where a station stands now.
pub(super) const NOW: u64 = u64::MAX;

/// What a wait was for: the point that it follows from, and what lies between them.
pub(super) struct Crossing {
    pub from: Point,
    parts: [Option<Part>; 2],
}

/// Some cycles of a station's, from one on, and how often what they are spent on.
struct Part {
    station: usize,
    code: Code,
    from: u64,
    cycles: u64,
    count: u64,
}

impl Past<'_> {
    pub(super) fn latency(&self) -> u64 {
        self.links[0].x.latency()
    }

    /// The station of the last cell.
    pub(super) fn last(&self) -> usize {
        self.links.len() - 1
    }

    /// Who reads what a station writes to a channel. Of the last cell's words it is the host.
    pub(super) fn reader(&self, station: usize, channel: Channel) -> usize {
        match channel {
            Channel::Z => station - 1,
            _ if station == self.last() => 0,
            _ => station + 1,
        }
    }

    /// Who writes what a station reads from a channel.
    fn writer(station: usize, channel: Channel) -> usize {
        if channel == Channel::Z { station + 1 } else { station - 1 }
    }

    /// The cycle in which the next word that a station reads from a channel is written, if it is.
    pub(super) fn next_written(&self, station: usize, channel: Channel) -> Option<u64> {
        let link = if channel == Channel::Z { station } else { station - 1 };
        Some(self.links[link].fifo(channel).ready()? - self.latency())
    }

    /// What one of a row of waits was for.
    pub(super) fn crossing(&self, station: usize, waits: &Waits, number: u32) -> Crossing {
        let (until, latency) = (waits.stand(number).clock, self.latency());
        let one = |from, station, code, cycles, count| Crossing {
            from,
            parts: [Some(Part { station, code, from: until - cycles, cycles, count }), None],
        };
        match waits.by {
            Hold::Word(channel) => {
                let written = (Past::writer(station, channel), until - latency);
                one(written, station, Code::latency(channel), latency, 1)
            }
            Hold::Slot(channel) => match self.reader(station, channel) {
                0 => self.through_host(until, Code::slot(channel)),
                reader => one((reader, until - 1), reader, Code::slot(channel), 1, 1),
            },
            Hold::Wire(channel) => {
                // Each word of the row waits for the one before it.
                let words = number as u64 + 1;
                let cycles = words * self.links[0].cycles_per_word();
                one((station, until - cycles), self.reader(station, channel), Code::wire(channel), cycles, words)
            }
            Hold::Answer => self.through_host(until, Code::MOVE),
        }
    }

    /// What follows from the host's read of a word of an answer in the cycle before `until`: it reads each word as soon as it
    /// has come.
    pub(super) fn through_host(&self, until: u64, code: Code) -> Crossing {
        let latency = self.latency();
        let written = until - 1 - latency;
        let way = Part { station: 0, code: Code::latency(Channel::Y), from: written, cycles: latency, count: 1 };
        let read = Part { station: 0, code, from: until - 1, cycles: 1, count: 1 };
        Crossing { from: (self.last(), written), parts: [Some(way), Some(read)] }
    }

    /// All points that something may yet follow from which has not happened.
    pub(super) fn live(&self) -> Vec<Point> {
        let last = self.last();
        let clock = |station: usize| self.stands[station].clock;
        let mut live: Vec<Point> = (0..=last).map(|station| (station, NOW)).collect();
        for (left, link) in self.links.iter().enumerate() {
            for channel in Channel::ALL {
                let (writer, reader) = match (channel, left == last) {
                    (Channel::Z, true) => continue,
                    (Channel::Z, false) => (left + 1, left),
                    (_, true) => (left, 0),
                    (_, false) => (left, left + 1),
                };
                let fifo = link.fifo(channel);
                let reads = fifo.reads_awaited_at(clock(writer));
                if reader == 0 && left == last {
                    live.extend(reads.map(|at| (writer, at - self.latency())));
                } else {
                    live.extend(reads.map(|at| (reader, at)));
                    live.extend(fifo.writes_awaited_at(clock(reader)).map(|at| (writer, at)));
                }
                let free = link.wire_free(channel);
                if free > clock(writer) {
                    live.push((writer, free - link.cycles_per_word()));
                }
            }
        }
        let awaited = self.returned.iter().rev().take_while(|&&at| at + 1 > clock(0));
        live.extend(awaited.chain(self.returned.last()).map(|at| (last, at - self.latency())));
        live.extend(self.end().map(|end| end.from));
        live
    }

    /// What a run that is over ends with: the host's read of the last word that comes back, or, if none does, the last op.
    pub(super) fn end(&self) -> Option<Crossing> {
        let inbox = &self.links[self.last()].y;
        (inbox.words_read() > 0).then(|| self.through_host(inbox.last_read() + 1, Code::MOVE))
    }

    /// A station's ops of a batch that is held.
    pub(super) fn ops(&self, station: usize, batch: usize) -> &[Op] {
        self.stream(station, batch).map_or(&[], OpStream::ops)
    }

    /// A station's stream of a batch that is held.
    pub(super) fn stream(&self, station: usize, batch: usize) -> Option<&OpStream> {
        let batch = self.batches.get(batch - self.first)?;
        Some(if station == 0 { &batch.host } else { &batch.cells[station - 1] })
    }
}

impl Crossing {
    /// Enters it.
    pub fn enter(&self, chains: &mut Chains) {
        for part in self.parts.iter().flatten() {
            chains.pen.turn_to(part.station);
            chains.pen.add(part.code, part.from, part.cycles, part.count);
        }
    }
}
