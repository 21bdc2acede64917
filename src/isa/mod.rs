//! The cell as a processor: its instructions, their encoding, an assembler, and an interpreter.
//!
//! RR-0992 says of PCS's inside no more than that its cells are programmable and compute in floating point. What is here is
//! chosen in the spirit of its contemporaries (CMU's Warp): a processor of 32-bit words that reads and writes two queues
//! as operands of its instructions. It blocks on an empty queue and cannot ask whether one is empty, and nothing
//! interrupts it: so what it does depends on the words that it reads, never on when they come.
//!
//! | here | is |
//! | --- | --- |
//! | [`table`] | the one table of instructions: mnemonic, code, format, class, effect |
//! | [`encoding`] | words to instructions and back, by the one layout of [`Field`]s in a word |
//! | [`assemble`] | source text to a [`Program`], with errors that point |
//! | [`object`], [`listing`], [`words`] | programs as object files and listings; words as people write them |
//! | [`Executable`] | a program under given [`InstructionCycles`], ready to run |
//! | [`Processor`] | a cell that runs one: words in, words and [ops](crate::seam::OpStream) out |
//! | [`Stepper`] | the same, an instruction at a time, on words that are all given |
//!
//! A program is started on a *message* (a ray): at its first instruction, with all registers 0 and the data memory as
//! it was loaded; `done` ends the message. So nothing passes from one message to the next. A program that never says
//! `done`, as a filter on a stream, takes all words for one message.

mod ahead;
mod assembler;
mod chains;
mod cycles;
mod effects;
pub mod encoding;
mod executable;
mod fault;
mod field;
mod float_pipe;
pub mod kernels;
pub mod listing;
pub mod object;
mod processor;
mod program;
mod queues;
mod register;
mod stepper;
pub mod table;
mod tally;
pub mod words;

pub use assembler::{Sources, assemble};
pub use cycles::InstructionCycles;
pub use encoding::{Instruction, InvalidInstruction};
pub use executable::Executable;
pub use fault::{Fault, FaultKind, FaultLine};
pub use field::Field;
pub use processor::{Processor, Stop};
pub use program::{Program, SourceFile, SourceLine, number};
pub use queues::Queues;
pub use register::{Queue, Register};
pub use stepper::Stepper;
pub use table::{Class, Format, Opcode, Operand};
