//! What a program can do wrong when it runs.

use std::fmt;
use std::path::PathBuf;

use super::encoding::InvalidInstruction;
use super::program::Program;
use super::register::Queue;

/// A program that cannot go on: what is wrong, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What is wrong.
    pub kind: FaultKind,
    /// The cell, counted from the left.
    pub cell: usize,
    /// The message that it was working on, counted as the caller counts them.
    pub message: u64,
    /// The address of the instruction.
    pub address: u32,
    /// The instruction's line of source, if the program has one.
    pub source: Option<FaultLine>,
}

/// A line of source text, by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultLine {
    /// The file.
    pub path: PathBuf,
    /// The line's number, from 1.
    pub line: u32,
    /// What it says.
    pub text: String,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The word there is no instruction.
    Invalid(u32, InvalidInstruction),
    /// There is no instruction: the program is shorter.
    OutsideProgram {
        /// Instructions of the program.
        length: u32,
    },
    /// A word read from outside the memory.
    Load {
        /// The address of the word.
        address: u32,
        /// Words of the memory.
        words: u32,
    },
    /// A word written outside the data memory.
    Store {
        /// The address of the word.
        address: u32,
        /// Words of the data memory.
        words: u32,
    },
    /// An integer divided by 0.
    DivisionByZero,
    /// More instructions for one message than the limit.
    InstructionLimit(u64),
    /// More words written for one message than the limit.
    WordLimit(u64),
    /// A read from a queue to which nothing more comes for this message.
    Starved(Queue),
    /// The message is done, and words of it have not been read.
    Unread(Queue, usize),
    /// What the last cell wrote on Y for the message is no answer: so many words, instead of so many.
    AnswerLength {
        /// Words that it wrote.
        words: usize,
        /// Words of an answer.
        expected: usize,
    },
    /// The answer names a polygon that there is not.
    AnswerPolygon(u32),
    /// It goes on with the message after its last word to Y: nobody could wait for that.
    LateWork,
    /// The cell has stopped for good, and there are more messages.
    Halted,
}

impl Fault {
    /// A fault of a program in cell 0, on its first message.
    pub fn new(kind: FaultKind, address: u32, program: &Program) -> Fault {
        let place = program.lines.get(address as usize).copied();
        let source = place.map(|place| {
            let path = program.files.get(place.file as usize).map(|file| file.path.clone()).unwrap_or_default();
            FaultLine { path, line: place.line, text: program.text_of(place).trim().to_owned() }
        });
        Fault { kind, cell: 0, message: 0, address, source }
    }
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FaultKind::Invalid(word, why) => write!(f, "the word {word:#010x} is no instruction: {why}"),
            FaultKind::OutsideProgram { length } => write!(f, "the program ends at address {length}"),
            FaultKind::Load { address, words } => {
                write!(f, "no word can be read at address {address}: the memory has {words} words")
            }
            FaultKind::Store { address, words } => {
                write!(f, "no word can be written at address {address}: the data memory has {words} words")
            }
            FaultKind::DivisionByZero => f.write_str("an integer is divided by 0"),
            FaultKind::InstructionLimit(limit) => {
                write!(f, "more than {limit} instructions for one message, which is the limit")
            }
            FaultKind::WordLimit(limit) => write!(f, "more than {limit} words written for one message"),
            FaultKind::Starved(queue) => write!(f, "it reads {}, but no more words come", channel(*queue)),
            FaultKind::Unread(queue, 1) => {
                write!(f, "the message is done, but 1 word from {} is unread", channel(*queue))
            }
            FaultKind::Unread(queue, words) => {
                write!(f, "the message is done, but {words} words from {} are unread", channel(*queue))
            }
            FaultKind::AnswerLength { words, expected } => {
                write!(f, "the last cell wrote {words} words on Y for the message, an answer has {expected}")
            }
            FaultKind::AnswerPolygon(polygon) => write!(f, "the answer names polygon {polygon}, which there is not"),
            FaultKind::LateWork => f.write_str("the cell goes on with the message after its last word to Y"),
            FaultKind::Halted => f.write_str("the cell has halted, but there are more messages"),
        }
    }
}

fn channel(queue: Queue) -> &'static str {
    match queue {
        Queue::X | Queue::PassX => "X",
        Queue::Y => "Y",
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cell {}, ray {}, address {}", self.cell, self.message, self.address)?;
        if let Some(FaultLine { path, line, .. }) = &self.source {
            write!(f, " ({}:{line})", path.display())?;
        }
        write!(f, ": {}", self.kind)
    }
}

impl std::error::Error for Fault {}
