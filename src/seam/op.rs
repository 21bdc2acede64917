//! Ops: what a station of a line does, one after the other, without a clock.

use super::{Channel, Unit};

/// What an op does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OpKind {
    /// `x`: reads words from X and passes each on to the right in the cycle in which it is read (the last cell does not).
    PassX,
    /// Works: so many units, which take as long as the machine's [costs](super::Costs) say.
    Work(Unit),
    /// `i`: reads words from Y.
    ReadY,
    /// `o`: writes words to the right neighbour's Y.
    WriteY,
    /// `r`: reads words from X without passing them on.
    ReadX,
    /// `w`: writes words to the right neighbour's X.
    WriteX,
    /// `b`: reads words from Z, which the right neighbour sends back.
    ReadZ,
    /// `z`: writes words to the left neighbour's Z.
    WriteZ,
    /// `a`, host only: waits until the last word of the n-th message (from 0) has come back from the array.
    Await,
}

impl OpKind {
    /// The kinds that move words or wait, each at the place of its code, with their letters in an activity trace.
    const MOVES: [(OpKind, char); 8] = [
        (OpKind::PassX, 'x'),
        (OpKind::ReadY, 'i'),
        (OpKind::WriteY, 'o'),
        (OpKind::ReadX, 'r'),
        (OpKind::WriteX, 'w'),
        (OpKind::Await, 'a'),
        (OpKind::ReadZ, 'b'),
        (OpKind::WriteZ, 'z'),
    ];

    /// The letter of an op that moves words or waits; work has the code of its unit.
    pub fn letter(self) -> Option<char> {
        Self::MOVES.iter().find(|entry| entry.0 == self).map(|entry| entry.1)
    }

    /// The op that moves words or waits with that letter.
    pub fn from_letter(letter: char) -> Option<OpKind> {
        Self::MOVES.iter().find(|entry| entry.1 == letter).map(|entry| entry.0)
    }

    /// The op that moves words or waits and that a trace calls so.
    pub(super) fn from_word(word: &str) -> Option<OpKind> {
        word.chars().next().filter(|_| word.len() == 1).and_then(OpKind::from_letter)
    }

    /// The channel that the op reads from.
    pub fn reads(self) -> Option<Channel> {
        match self {
            OpKind::PassX | OpKind::ReadX => Some(Channel::X),
            OpKind::ReadY => Some(Channel::Y),
            OpKind::ReadZ => Some(Channel::Z),
            OpKind::Work(_) | OpKind::WriteX | OpKind::WriteY | OpKind::WriteZ | OpKind::Await => None,
        }
    }

    /// The channel that the op writes to.
    pub fn writes(self) -> Option<Channel> {
        match self {
            OpKind::PassX | OpKind::WriteX => Some(Channel::X),
            OpKind::WriteY => Some(Channel::Y),
            OpKind::WriteZ => Some(Channel::Z),
            OpKind::Work(_) | OpKind::ReadX | OpKind::ReadY | OpKind::ReadZ | OpKind::Await => None,
        }
    }

    /// An op of the kind with count 0.
    #[inline]
    const fn code(self) -> u32 {
        match self {
            OpKind::PassX => 0,
            OpKind::ReadY => 1 << MOVE_BITS,
            OpKind::WriteY => 2 << MOVE_BITS,
            OpKind::ReadX => 3 << MOVE_BITS,
            OpKind::WriteX => 4 << MOVE_BITS,
            OpKind::Await => 5 << MOVE_BITS,
            OpKind::ReadZ => 6 << MOVE_BITS,
            OpKind::WriteZ => 7 << MOVE_BITS,
            OpKind::Work(unit) => WORKS | (unit.0 as u32) << WORK_BITS,
        }
    }

    /// A bit for each kind that moves words or waits, in the order of [`OpKind::MOVES`], and one for all work.
    #[inline]
    const fn bit(self) -> u16 {
        match self {
            OpKind::Work(_) => 1 << OpKind::MOVES.len(),
            _ => 1 << (self.code() >> MOVE_BITS),
        }
    }

    /// The largest count of one op of this kind; longer ones are written as several.
    #[inline]
    pub const fn max_count(self) -> u32 {
        match self {
            OpKind::Work(_) => (1 << WORK_BITS) - 1,
            _ => (1 << MOVE_BITS) - 1,
        }
    }
}

/// The bit that says that an op works. Six bits with its unit follow, else three with its kind.
const WORKS: u32 = 1 << 31;
/// The lowest bits, which hold the count, of an op that works and of any other.
const WORK_BITS: u32 = 25;
const MOVE_BITS: u32 = 28;

/// One op: a kind and a count (units for work, words for moves, a message for waits), packed into 32 bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Op(u32);

impl Op {
    /// Reads a word from Y.
    pub(crate) const ONE_FROM_Y: Op = Op(OpKind::ReadY.code() | 1);
    /// Writes a word to Y.
    pub(crate) const ONE_TO_Y: Op = Op(OpKind::WriteY.code() | 1);

    /// An op of `count` units or words, at most [`OpKind::max_count`].
    #[inline]
    pub fn new(kind: OpKind, count: u32) -> Op {
        debug_assert!(count <= kind.max_count());
        Op(kind.code() | count)
    }

    /// What the op does.
    #[inline]
    pub fn kind(self) -> OpKind {
        // Spelled out: a match on it is then one jump, where a table would make it two.
        match self.0 >> MOVE_BITS {
            0 => OpKind::PassX,
            1 => OpKind::ReadY,
            2 => OpKind::WriteY,
            3 => OpKind::ReadX,
            4 => OpKind::WriteX,
            5 => OpKind::Await,
            6 => OpKind::ReadZ,
            7 => OpKind::WriteZ,
            _ => OpKind::Work(self.worked()),
        }
    }

    /// The unit of work, if the op works.
    #[inline]
    pub fn unit(self) -> Option<Unit> {
        (self.0 & WORKS != 0).then_some(self.worked())
    }

    /// The unit of an op that works.
    #[inline]
    fn worked(self) -> Unit {
        Unit((self.0 >> WORK_BITS & 63) as u8)
    }

    /// How many units or words.
    #[inline]
    pub fn count(self) -> u32 {
        self.0 & if self.0 & WORKS != 0 { (1 << WORK_BITS) - 1 } else { (1 << MOVE_BITS) - 1 }
    }

    /// How many words, of an op that moves some; of a wait, for which message it is.
    #[inline]
    pub(crate) fn words(self) -> u64 {
        u64::from(self.0 & ((1 << MOVE_BITS) - 1))
    }

    /// Whether an op is of a kind.
    #[inline]
    fn is(self, kind: OpKind) -> bool {
        // Equal but for the count.
        self.0 ^ kind.code() <= kind.max_count()
    }
}

impl std::fmt::Debug for Op {
    /// `x8` for moves, `u3*12` for 12 units of number 3: what the unit is called, only a [`Vocabulary`](super::Vocabulary)
    /// knows.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.unit(), self.kind().letter()) {
            (Some(Unit(unit)), _) => write!(f, "u{unit}*{}", self.count()),
            (None, letter) => write!(f, "{}{}", letter.unwrap_or('?'), self.count()),
        }
    }
}

/// The end of one line of a stream: all that a cell, or the host, did for one job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpLine {
    /// The job's number.
    pub job: u32,
    /// Where the line's ops end in [`OpStream::ops`].
    pub end: u32,
}

/// What one cell, or the host, did, in the order in which it did it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpStream {
    ops: Vec<Op>,
    lines: Vec<OpLine>,
    /// Where the line under way begins in `ops`.
    line_start: usize,
    /// The bits of the kinds of all ops, so that nobody need look at each to check them.
    kinds: u16,
}

impl OpStream {
    /// The memory that its ops take, in bytes.
    pub fn bytes(&self) -> u64 {
        (self.ops.capacity() * size_of::<Op>() + self.lines.capacity() * size_of::<OpLine>()) as u64
    }

    /// Adds an op to the line under way, as part of the op before it where both are of one kind.
    #[inline]
    pub fn push(&mut self, kind: OpKind, count: u64) {
        match self.mergeable(kind) {
            Some(last) if last.count() as u64 + count <= kind.max_count() as u64 => last.0 += count as u32,
            _ if count <= kind.max_count() as u64 => self.append(kind, count as u32),
            _ => self.append_several(kind, count),
        }
    }

    /// The last op of the line under way, if it is of that kind. Waits are for a message each, and never add up.
    #[inline]
    fn mergeable(&mut self, kind: OpKind) -> Option<&mut Op> {
        let is_in_line = self.ops.len() > self.line_start;
        let same = |op: &&mut Op| is_in_line && op.is(kind) && kind != OpKind::Await;
        self.ops.last_mut().filter(same)
    }

    #[inline]
    fn append(&mut self, kind: OpKind, count: u32) {
        self.kinds |= kind.bit();
        self.ops.push(Op::new(kind, count));
    }

    #[cold]
    fn append_several(&mut self, kind: OpKind, mut count: u64) {
        let most = kind.max_count();
        while count > most as u64 {
            self.append(kind, most);
            count -= most as u64;
        }
        self.append(kind, count as u32);
    }

    /// Adds a whole line.
    #[inline]
    pub fn push_line(&mut self, job: u32, ops: &[Op]) {
        self.ops.extend_from_slice(ops);
        self.kinds = ops.iter().fold(self.kinds, |kinds, op| kinds | op.kind().bit());
        self.end_line(job);
    }

    /// The ops of a line, by its place among the lines.
    #[inline]
    pub fn line(&self, index: usize) -> &[Op] {
        &self.ops[self.start_of(index)..self.lines[index].end as usize]
    }

    /// Ends the line under way: all since the line before it was done for `job`.
    #[inline]
    pub fn end_line(&mut self, job: u32) {
        self.line_start = self.ops.len();
        self.lines.push(OpLine { job, end: self.line_start as u32 });
    }

    /// All ops of all lines.
    #[inline]
    pub fn ops(&self) -> &[Op] {
        &self.ops
    }

    /// Whether its ops are of these kinds alone; any unit stands for all work.
    #[inline]
    pub(super) fn has_only(&self, kinds: &[OpKind]) -> bool {
        self.kinds & !kinds.iter().fold(0, |bits, kind| bits | kind.bit()) == 0
    }

    /// The kinds of its ops, each once; for all work one unit stands.
    pub(super) fn kinds(&self) -> impl Iterator<Item = OpKind> {
        let moves = OpKind::MOVES.into_iter().map(|(kind, _)| kind);
        moves.chain([OpKind::Work(Unit(0))]).filter(|kind| self.kinds & kind.bit() != 0)
    }

    /// Each line as the job's number and its ops.
    pub fn lines(&self) -> impl ExactSizeIterator<Item = (u32, &[Op])> {
        (0..self.lines.len()).map(|index| (self.lines[index].job, self.line(index)))
    }

    /// The line that op number `index` is in, as the job's number and the op's position in the line.
    pub fn locate(&self, index: usize) -> Option<(u32, usize)> {
        let line = self.lines.partition_point(|line| line.end as usize <= index);
        self.lines.get(line).map(|found| (found.job, index - self.start_of(line)))
    }

    /// The line that op number `index` is in.
    pub fn line_of(&self, index: usize) -> Option<OpLine> {
        self.lines.get(self.lines.partition_point(|line| line.end as usize <= index)).copied()
    }

    fn start_of(&self, line: usize) -> usize {
        if line == 0 { 0 } else { self.lines[line - 1].end as usize }
    }

    /// Forgets all lines but keeps the memory.
    pub fn clear(&mut self) {
        self.ops.clear();
        self.lines.clear();
        self.line_start = 0;
        self.kinds = 0;
    }
}
