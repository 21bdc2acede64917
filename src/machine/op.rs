//! The seam between the two halves: what a cell does, op by op, without a clock.

use super::Channel;

/// What a computing cell is busy with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Work {
    /// The walk through the grid.
    Grid,
    /// The slabs test.
    Slabs,
    /// The intersection test.
    Intersection,
    /// Anything else.
    Other,
}

impl Work {
    /// All kinds, in the order in which reports name them.
    pub const ALL: [Work; 4] = [Work::Grid, Work::Slabs, Work::Intersection, Work::Other];
}

/// What an op does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OpKind {
    /// `x`: reads words from X and passes each on to the right in the cycle in which it is read (the last cell does not).
    PassX,
    /// `g`, `s`, `n`, `c`: computes, for so many cycles.
    Compute(Work),
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
    /// All ops with their letters, each at the place of its code; those of no op are never used.
    const TABLE: [(OpKind, char); 16] = {
        let mut table = [(OpKind::Await, 'a'); 16];
        table[OpKind::PassX.code() as usize] = (OpKind::PassX, 'x');
        table[OpKind::ReadY.code() as usize] = (OpKind::ReadY, 'i');
        table[OpKind::WriteY.code() as usize] = (OpKind::WriteY, 'o');
        table[OpKind::ReadX.code() as usize] = (OpKind::ReadX, 'r');
        table[OpKind::WriteX.code() as usize] = (OpKind::WriteX, 'w');
        table[OpKind::ReadZ.code() as usize] = (OpKind::ReadZ, 'b');
        table[OpKind::WriteZ.code() as usize] = (OpKind::WriteZ, 'z');
        table[OpKind::Compute(Work::Grid).code() as usize] = (OpKind::Compute(Work::Grid), 'g');
        table[OpKind::Compute(Work::Slabs).code() as usize] = (OpKind::Compute(Work::Slabs), 's');
        table[OpKind::Compute(Work::Intersection).code() as usize] = (OpKind::Compute(Work::Intersection), 'n');
        table[OpKind::Compute(Work::Other).code() as usize] = (OpKind::Compute(Work::Other), 'c');
        table
    };

    /// The letter of the op in an activity trace.
    pub fn letter(self) -> char {
        Self::TABLE[self.code() as usize].1
    }

    /// The op with that letter.
    pub fn from_letter(letter: char) -> Option<OpKind> {
        Self::TABLE.iter().find(|entry| entry.1 == letter).map(|entry| entry.0)
    }

    /// The channel that the op reads from.
    pub fn reads(self) -> Option<Channel> {
        match self {
            OpKind::PassX | OpKind::ReadX => Some(Channel::X),
            OpKind::ReadY => Some(Channel::Y),
            OpKind::ReadZ => Some(Channel::Z),
            OpKind::Compute(_) | OpKind::WriteX | OpKind::WriteY | OpKind::WriteZ | OpKind::Await => None,
        }
    }

    /// The channel that the op writes to.
    pub fn writes(self) -> Option<Channel> {
        match self {
            OpKind::PassX | OpKind::WriteX => Some(Channel::X),
            OpKind::WriteY => Some(Channel::Y),
            OpKind::WriteZ => Some(Channel::Z),
            OpKind::Compute(_) | OpKind::ReadX | OpKind::ReadY | OpKind::ReadZ | OpKind::Await => None,
        }
    }

    /// Four bits; the highest says that the op computes.
    #[inline]
    const fn code(self) -> u32 {
        match self {
            OpKind::PassX => 0,
            OpKind::ReadY => 1,
            OpKind::WriteY => 2,
            OpKind::ReadX => 3,
            OpKind::WriteX => 4,
            OpKind::Await => 5,
            OpKind::ReadZ => 6,
            OpKind::WriteZ => 7,
            OpKind::Compute(work) => 8 + work as u32,
        }
    }
}

/// One op: a kind and a count (cycles for computing, words for moving), packed into 32 bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Op(u32);

impl Op {
    /// The largest count of one op; longer ones are written as several.
    pub const MAX_COUNT: u32 = (1 << 28) - 1;

    /// An op of `count` cycles or words, at most [`Op::MAX_COUNT`].
    #[inline]
    pub fn new(kind: OpKind, count: u32) -> Op {
        debug_assert!(count <= Op::MAX_COUNT);
        Op(kind.code() << 28 | count)
    }

    /// What the op does.
    #[inline]
    pub fn kind(self) -> OpKind {
        OpKind::TABLE[(self.0 >> 28) as usize].0
    }

    /// What the op computes, if it does.
    #[inline]
    pub(super) fn work(self) -> Option<Work> {
        let code = self.0 >> 28;
        (code >= 8).then(|| Work::ALL[code as usize % 4])
    }

    /// For how many cycles or words.
    #[inline]
    pub fn count(self) -> u32 {
        self.0 & Op::MAX_COUNT
    }
}

impl std::fmt::Debug for Op {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

impl std::fmt::Display for Op {
    /// As an activity trace writes it: `x8`, `g600`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.kind().letter(), self.count())
    }
}

/// The end of one line of a stream: all that a cell, or the host, did for one ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpLine {
    /// The ray's number.
    pub ray: u32,
    /// Where the line's ops end in [`OpStream::ops`].
    pub end: u32,
}

/// What one cell, or the host, did, in the order in which it did it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpStream {
    ops: Vec<Op>,
    lines: Vec<OpLine>,
}

impl OpStream {
    /// Adds an op to the line under way, as part of the op before it where both are of one kind.
    #[inline]
    pub fn push(&mut self, kind: OpKind, count: u64) {
        if let Some(last) = self.mergeable(kind)
            && last.count() as u64 + count <= Op::MAX_COUNT as u64
        {
            last.0 += count as u32;
        } else {
            self.append(kind, count);
        }
    }

    /// The last op of the line under way, if it is of that kind. Waits are for a message each, and never add up.
    #[inline]
    fn mergeable(&mut self, kind: OpKind) -> Option<&mut Op> {
        let line_start = self.lines.last().map_or(0, |line| line.end as usize);
        let same = |op: &&mut Op| op.0 >> 28 == kind.code() && kind != OpKind::Await;
        self.ops[line_start..].last_mut().filter(same)
    }

    fn append(&mut self, kind: OpKind, mut count: u64) {
        while count > Op::MAX_COUNT as u64 {
            self.ops.push(Op::new(kind, Op::MAX_COUNT));
            count -= Op::MAX_COUNT as u64;
        }
        self.ops.push(Op::new(kind, count as u32));
    }

    /// Adds a whole line.
    #[inline]
    pub fn push_line(&mut self, ray: u32, ops: &[Op]) {
        self.ops.extend_from_slice(ops);
        self.end_line(ray);
    }

    /// The ops of a line, by its place among the lines.
    #[inline]
    pub fn line(&self, index: usize) -> &[Op] {
        &self.ops[self.line_start(index)..self.lines[index].end as usize]
    }

    /// Ends the line under way: all since the line before it was done for `ray`.
    #[inline]
    pub fn end_line(&mut self, ray: u32) {
        self.lines.push(OpLine { ray, end: self.ops.len() as u32 });
    }

    /// All ops of all lines.
    #[inline]
    pub fn ops(&self) -> &[Op] {
        &self.ops
    }

    /// Each line as the ray's number and its ops.
    pub fn lines(&self) -> impl ExactSizeIterator<Item = (u32, &[Op])> {
        (0..self.lines.len()).map(|index| (self.lines[index].ray, self.line(index)))
    }

    /// The line that op number `index` is in, as the ray's number and the op's position in the line.
    pub fn locate(&self, index: usize) -> Option<(u32, usize)> {
        let line = self.lines.partition_point(|line| line.end as usize <= index);
        self.lines.get(line).map(|found| (found.ray, index - self.line_start(line)))
    }

    /// The line that op number `index` is in.
    pub(super) fn line_of(&self, index: usize) -> Option<OpLine> {
        self.lines.get(self.lines.partition_point(|line| line.end as usize <= index)).copied()
    }

    fn line_start(&self, line: usize) -> usize {
        if line == 0 { 0 } else { self.lines[line - 1].end as usize }
    }

    /// Forgets all lines but keeps the memory.
    pub fn clear(&mut self) {
        self.ops.clear();
        self.lines.clear();
    }
}

/// The ops of the host and of every cell for some rays.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpBatch {
    /// What the host does: `w` to the first cell's X, `a`, `c`.
    pub host: OpStream,
    /// What each cell does, from left to right.
    pub cells: Vec<OpStream>,
}

impl OpBatch {
    /// An empty batch for an array of `cells` cells.
    pub fn new(cells: usize) -> OpBatch {
        OpBatch { host: OpStream::default(), cells: vec![OpStream::default(); cells] }
    }

    /// Forgets all ops but keeps the memory.
    pub fn clear(&mut self) {
        self.host.clear();
        self.cells.iter_mut().for_each(OpStream::clear);
    }
}
