//! The messages between the host and the cells, and their words (32 bits each); and the kinds that the messages of any machine are of.

use super::work::MESSAGE;
use super::workload::Workload;
use crate::measure::{Actor, Measured};
use crate::seam::{Channel, OpKind, OpStream};

/// RAY, on X: id, origin x y z, direction x y z, t_max.
pub const RAY_WORDS: u64 = 8;

/// The word of a RAY more that names the polygon that it starts on and does not hit, if rays say so.
pub const OWN_WORDS: u64 = 1;

/// Sub-volumes that a word of a RAY with a mask tells of, a bit each, behind its other words.
pub const MASK_BITS: u64 = 32;

/// CANDIDATE, on Y: a polygon's index; END, behind the last one, is as long.
pub const CANDIDATE_WORDS: u64 = 1;

/// HIT, on Y: the ray's id, the polygon's index, t, alpha, beta.
pub const HIT_WORDS: u64 = 5;

/// VOXEL, on Y, and the WORD on Z that answers it: see [stop words](super::ArrayProgram::stop_words).
pub const VOXEL_WORDS: u64 = 1;

/// Whether it takes who sends or takes a message time, beside that of its words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Messaging {
    pub takes_time: bool,
}

impl Messaging {
    /// A message of so many words is taken: when it has come, there is work on it.
    #[inline(always)]
    pub fn take(self, cell: &mut OpStream, kind: OpKind, words: u64) {
        cell.push(kind, words);
        if self.takes_time {
            cell.push(OpKind::Work(MESSAGE), 1);
        }
    }

    /// A message of so many words is sent: there is work on it, and then it goes.
    #[inline(always)]
    pub fn send(self, cell: &mut OpStream, kind: OpKind, words: u64) {
        if self.takes_time {
            cell.push(OpKind::Work(MESSAGE), 1);
        }
        cell.push(kind, words);
    }

    /// A message on X is passed on, if there is a neighbour: word by word as it comes, or where it takes time, as a whole.
    pub fn pass(self, cell: &mut OpStream, words: u64, has_neighbor: bool) {
        if !self.takes_time {
            return cell.push(OpKind::PassX, words);
        }
        self.take(cell, OpKind::ReadX, words);
        if has_neighbor {
            self.send(cell, OpKind::WriteX, words);
        }
    }
}

/// What is in a message, by the kinds of the chapter on graphs (I.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageKind {
    /// Part of the scene.
    RealObject,
    /// A ray.
    VirtualObject,
    /// What was computed: the light of a ray, or pixels.
    Calculation,
    /// What it takes to work together.
    Information,
}

impl MessageKind {
    /// All kinds, in the order of reports.
    pub const ALL: [MessageKind; 4] =
        [MessageKind::RealObject, MessageKind::VirtualObject, MessageKind::Calculation, MessageKind::Information];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            MessageKind::RealObject => "real object",
            MessageKind::VirtualObject => "virtual object",
            MessageKind::Calculation => "calculation",
            MessageKind::Information => "information",
        }
    }

    /// The same as a key of statistics: `real_object`.
    pub fn key(self) -> String {
        self.name().replace(' ', "_")
    }
}

/// What FIFOs carried, of one kind of messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Carried {
    /// How many messages were written to them. One that a cell passes on is written again.
    pub sent: u64,
    /// Their words.
    pub words: u64,
}

/// What FIFOs carried of each kind, in the order of [`MessageKind::ALL`].
pub type CarriedByKind = [Carried; MessageKind::ALL.len()];

impl Workload {
    /// What the FIFO of a channel carried that `reader` reads, by kind: rays are virtual objects; candidates and their END stand for real
    /// ones; hits are what was computed; voxels and stop words are there to work together.
    pub fn carried(&self, stats: &Measured, channel: Channel, reader: Actor) -> CarriedByKind {
        let words = |channel: Channel, reader| stats.words_into(&channel.to_string(), reader).0;
        let all = words(channel, reader);
        let mut carried = CarriedByKind::default();
        let bundle = u64::from(self.program.rays_per_message.max(1));
        let mut add = |kind: MessageKind, things: u64, words_each: u64| {
            // Rays and hits may go several in a message.
            let rays = matches!(kind, MessageKind::VirtualObject | MessageKind::Calculation);
            let sent = if rays { things.div_ceil(bundle) } else { things };
            carried[kind as usize] = Carried { sent, words: things * words_each };
        };
        let stage = |cell: usize| cell % self.stages.count();
        match (channel, reader) {
            (Channel::X, _) => add(MessageKind::VirtualObject, all / self.ray_words(), self.ray_words()),
            (Channel::Z, _) => add(MessageKind::Information, all, VOXEL_WORDS),
            (Channel::Y, Actor::Station(cell)) if stage(cell) > 0 => {
                let hits = if cell > stage(cell) { stats.jobs } else { 0 };
                let answers = words(Channel::Z, Actor::Station(cell - 1));
                let head_start = self.stop_words.map_or(0, |words| words.head_start(stage(cell)));
                let voxels = answers.saturating_sub(head_start);
                let candidates = all.saturating_sub(HIT_WORDS * hits + VOXEL_WORDS * voxels);
                add(MessageKind::Calculation, hits, HIT_WORDS);
                add(MessageKind::Information, voxels, VOXEL_WORDS);
                add(MessageKind::RealObject, candidates, CANDIDATE_WORDS);
            }
            (Channel::Y, _) => add(MessageKind::Calculation, all / HIT_WORDS, HIT_WORDS),
        }
        carried
    }

    /// What all FIFOs carried together, by kind.
    pub fn messages(&self, stats: &Measured) -> CarriedByKind {
        let mut sums = CarriedByKind::default();
        for fifo in &stats.topology.fifos {
            let channel = Channel::ALL.into_iter().find(|channel| channel.to_string() == fifo.group);
            let carried = channel.map(|channel| self.carried(stats, channel, fifo.to)).unwrap_or_default();
            for (sum, more) in sums.iter_mut().zip(carried) {
                *sum = Carried { sent: sum.sent + more.sent, words: sum.words + more.words };
            }
        }
        sums
    }
}
