//! Where a program waits for results of a floating-point unit that is a pipeline.
//!
//! The unit takes an addition, multiplication or comparison after the other, and gives each result some cycles later: its
//! latency. An instruction that names a register whose result is still under way waits for the whole latency, behind which all
//! results before it are there. Nothing is under way where another piece of code begins: behind a branch, where one leads to, at
//! a word that is moved. So whether an instruction waits is told by its address alone, and what a program waits, by how often it
//! is executed. (A jump to an address that is calculated finds the waits that are there.) Divisions are no part of the pipeline:
//! they take what they take.

use bitvec::vec::BitVec;

use super::encoding::{Instruction, InvalidInstruction};
use super::register::Register;
use super::table::{Class, Format};

/// The waits of an instruction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Waits {
    /// Before it reads anything.
    pub before: bool,
    /// Behind what it computes, and before it writes to a queue or leads elsewhere.
    pub behind: bool,
}

impl Waits {
    /// How many.
    pub fn count(self) -> u64 {
        u64::from(self.before) + u64::from(self.behind)
    }

    /// The waits of each instruction of a program.
    pub fn of(instructions: &[Result<Instruction, InvalidInstruction>]) -> Vec<Waits> {
        let entries = entries(instructions);
        let mut under_way = Registers::default();
        let waits = |(address, decoded): (usize, &Result<Instruction, _>)| match decoded {
            Ok(instruction) => under_way.pass(instruction, entries[address + 1]),
            Err(_) => Waits::default(),
        };
        instructions.iter().enumerate().map(waits).collect()
    }
}

/// Which addresses branches and jumps lead to, up to the one behind the last.
fn entries(instructions: &[Result<Instruction, InvalidInstruction>]) -> BitVec {
    let mut entries = BitVec::repeat(false, instructions.len() + 1);
    for (address, instruction) in instructions.iter().enumerate().filter_map(|(at, found)| Some((at, found.ok()?))) {
        let leads = matches!(instruction.opcode.entry().format, Format::Branch | Format::Jump | Format::Call);
        if let Some(to) = address.checked_add_signed(instruction.constant as isize).filter(|_| leads)
            && let Some(mut entry) = entries.get_mut(to)
        {
            *entry = true;
        }
    }
    entries
}

/// Some registers, a bit for each: those whose results are under way.
#[derive(Clone, Copy, Debug, Default)]
struct Registers(u64);

impl Registers {
    /// Executes an instruction, behind which another piece of code may begin.
    fn pass(&mut self, instruction: &Instruction, ends: bool) -> Waits {
        let class = instruction.opcode.entry().class;
        let stops = class == Class::Branch || instruction.words() > 0;
        let before = self.0 & named(instruction) != 0 || stops && self.0 != 0;
        if before {
            self.0 = 0;
        }
        // What is wanted outside of the registers is wanted at once: by a queue, or by a branch.
        let mut outside = false;
        if matches!(class, Class::FloatAdd | Class::FloatMultiply | Class::FloatCompare) {
            match instruction.written() {
                Some(register) if register.queue().is_none() => self.0 |= bit(register),
                _ => outside = true,
            }
        }
        let behind = outside || ends && self.0 != 0;
        if behind {
            self.0 = 0;
        }
        Waits { before, behind }
    }
}

/// The registers that an instruction reads and writes.
fn named(instruction: &Instruction) -> u64 {
    let read = instruction.reads().map(|field| instruction.register(field));
    read.chain(instruction.written()).map(bit).fold(0, |all, register| all | register)
}

/// A register's bit. Queues and `r0`, whose results are for nobody, have none.
fn bit(register: Register) -> u64 {
    if register == Register::ZERO || register.queue().is_some() { 0 } else { 1 << register.number() }
}
