//! Instructions as 32-bit words, like those of data: a queue moves one, and a word of memory holds one.

use std::fmt;

use super::field::Field;
use super::register::Register;
use super::table::{Opcode, Operand};

/// One instruction. Registers and constants that its format does not have are `r0` and 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Instruction {
    /// Which.
    pub opcode: Opcode,
    /// What its fields [`Field::First`] to [`Field::Third`] name.
    pub registers: [Register; 3],
    /// Its constant, or the distance to its target.
    pub constant: i32,
}

/// A word that is no instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidInstruction {
    /// No instruction has that code.
    #[error("{0:#04x} is no instruction's code")]
    Opcode(u32),
    /// Register 63, or `xp` where a register is written.
    #[error("a register field names nothing that can stand there")]
    Register,
    /// Bits that belong to no field are not 0.
    #[error("bits that belong to no field are not 0")]
    Rest,
}

impl Instruction {
    /// An instruction without operands, to be filled in.
    pub fn new(opcode: Opcode) -> Instruction {
        Instruction { opcode, registers: [Register::ZERO; 3], constant: 0 }
    }

    /// The register in a field, which is one of the first three.
    pub fn register(&self, field: Field) -> Register {
        self.registers[place(field)]
    }

    /// Puts a register into a field, which is one of the first three.
    pub fn set_register(&mut self, field: Field, register: Register) {
        self.registers[place(field)] = register;
    }

    /// The word.
    pub fn encode(&self) -> u32 {
        let mut word = 0;
        Field::Opcode.set(&mut word, self.opcode as u32);
        for &field in self.opcode.fields() {
            match field {
                Field::Short | Field::Long => field.set(&mut word, self.constant as u32),
                _ => field.set(&mut word, self.register(field).number()),
            }
        }
        word
    }

    /// The instruction that a word is. Encoding gives the same word again.
    pub fn decode(word: u32) -> Result<Instruction, InvalidInstruction> {
        let code = Field::Opcode.get(word);
        let mut instruction = Instruction::new(Opcode::from_code(code).ok_or(InvalidInstruction::Opcode(code))?);
        for &field in instruction.opcode.fields() {
            match field {
                Field::Short | Field::Long => instruction.constant = field.get_signed(word),
                _ => {
                    let register = Register::new(field.get(word)).ok_or(InvalidInstruction::Register)?;
                    instruction.set_register(field, register);
                }
            }
        }
        if instruction.written() == Some(Register::PASS_X) {
            return Err(InvalidInstruction::Register);
        }
        if instruction.encode() != word {
            return Err(InvalidInstruction::Rest);
        }
        Ok(instruction)
    }

    /// The register or queue that it writes.
    pub fn written(&self) -> Option<Register> {
        self.operands().find_map(|operand| match operand {
            Operand::Write(field) => Some(self.register(field)),
            _ => None,
        })
    }

    /// The fields of the registers and queues that it reads, in the order in which it reads them.
    pub fn reads(&self) -> impl Iterator<Item = Field> {
        self.operands().filter_map(|operand| match operand {
            Operand::Read(field) | Operand::Memory(field, _) => Some(field),
            _ => None,
        })
    }

    /// The queue operands: how many words it moves.
    pub fn words(&self) -> usize {
        let read = self.reads().filter(|&field| self.register(field).queue().is_some()).count();
        read + self.written().is_some_and(|register| register.queue().is_some()) as usize
    }

    fn operands(&self) -> impl Iterator<Item = Operand> + use<> {
        self.opcode.entry().format.operands().iter().copied()
    }

    /// As source text; a target is written as an address, for which the instruction's own is needed.
    pub fn display_at(&self, address: u32) -> impl fmt::Display + '_ {
        DisplayAt { instruction: self, address }
    }
}

impl Opcode {
    /// The fields of its format, without that of the code.
    pub fn fields(self) -> &'static [Field] {
        use super::table::Format;
        use Field::{First, Long, Second, Short, Third};
        match self.entry().format {
            Format::Three => &[First, Second, Third],
            Format::Two => &[First, Second],
            Format::TwoAndConstant | Format::Load | Format::Store | Format::Branch => &[First, Second, Short],
            Format::Constant | Format::Call => &[First, Long],
            Format::Jump => &[Long],
            Format::One => &[First],
            Format::Bare => &[],
        }
    }
}

fn place(field: Field) -> usize {
    match field {
        Field::First => 0,
        Field::Second => 1,
        _ => 2,
    }
}

struct DisplayAt<'a> {
    instruction: &'a Instruction,
    address: u32,
}

impl fmt::Display for DisplayAt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let instruction = self.instruction;
        f.write_str(instruction.opcode.entry().mnemonic)?;
        for (index, operand) in instruction.operands().enumerate() {
            f.write_str(if index == 0 { " " } else { ", " })?;
            match operand {
                Operand::Write(field) | Operand::Read(field) => write!(f, "{}", instruction.register(field))?,
                Operand::Constant(_) => write!(f, "{}", instruction.constant)?,
                Operand::Memory(field, _) => {
                    let sign = if instruction.constant < 0 { '-' } else { '+' };
                    let base = instruction.register(field);
                    write!(f, "[{base} {sign} {}]", instruction.constant.unsigned_abs())?;
                }
                Operand::Target(_) => write!(f, "{}", i64::from(self.address) + i64::from(instruction.constant))?,
            }
        }
        Ok(())
    }
}
