//! A program under way on given words, message by message, an instruction at a time.

use super::executable::Executable;
use super::fault::Fault;
use super::processor::{Processor, Stop};
use super::queues::Queues;
use crate::seam::{OpKind, OpStream};

/// A cell that runs a program on given words.
#[derive(Debug)]
pub struct Stepper<'a> {
    processor: Processor<'a>,
    /// The words.
    pub queues: Queues,
    /// Words moved for the message; each takes a cycle.
    moved: u64,
    messages: u64,
    /// The message is done, and the next not begun.
    done: bool,
}

impl<'a> Stepper<'a> {
    /// A cell before its first instruction, which may execute so many for one message.
    pub fn new(executable: &'a Executable, queues: Queues, instruction_limit: u64) -> Stepper<'a> {
        let processor = Processor::new(executable, &executable.program().data, &[], instruction_limit);
        Stepper { processor, queues, moved: 0, messages: 0, done: false }
    }

    /// The cell.
    pub fn processor(&self) -> &Processor<'a> {
        &self.processor
    }

    /// The address of the next instruction. Behind `done`, the next message begins at address 0.
    pub fn address(&self) -> u32 {
        if self.done { 0 } else { self.processor.address() }
    }

    /// The message that it works on, or has just done.
    pub fn message(&self) -> u64 {
        self.messages - self.done as u64
    }

    /// How many messages are done.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// The cycles that this message has taken, if no word is waited for.
    pub fn cycles(&self) -> u64 {
        self.processor.cycles() + self.moved
    }

    /// Executes an instruction, and tells why the cell stands still if it then does.
    pub fn step(&mut self) -> Result<Option<Stop>, Fault> {
        let mut ops = OpStream::default();
        if std::mem::take(&mut self.done) {
            // Just puts the cell at the start of the next message.
            self.processor.step(&mut self.queues, &mut ops)?;
            self.moved = 0;
        }
        let message = self.messages;
        let stop = self.processor.step(&mut self.queues, &mut ops).map_err(|fault| Fault { message, ..fault })?;
        let words = ops.ops().iter().filter(|op| !matches!(op.kind(), OpKind::Work(_)));
        self.moved += words.map(|op| u64::from(op.count())).sum::<u64>();
        if stop == Some(Stop::Done) {
            self.done = true;
            self.messages += 1;
        }
        Ok(stop)
    }
}
