//! The second pass: operands to fields.

use super::expression::{Reader, Wrong};
use super::line::{Kind, Token};
use super::{Assembler, Pending, Word};
use crate::error::InputError;
use crate::input::text::nearest;
use crate::isa::encoding::Instruction;
use crate::isa::field::Field;
use crate::isa::register::Register;
use crate::isa::table::{Opcode, Operand};

impl Assembler {
    /// The instruction that a line is.
    pub fn instruction(&self, pending: &Pending, address: u32) -> Result<Instruction, InputError> {
        let Word::Instruction(opcode) = pending.what else { return Ok(Instruction::new(Opcode::Halt)) };
        let tokens = self.tokens(&pending.line)?;
        let mut reader = Reader::new(&tokens[pending.skip..]);
        let mnemonic = &tokens[pending.skip - 1];
        self.operands(opcode, address, mnemonic, &mut reader).map_err(|wrong| self.error(&pending.line, wrong))
    }

    /// The word of data that a line's expression is.
    pub fn data_word(&self, pending: &Pending) -> Result<u32, InputError> {
        if let Word::Value(value) = pending.what {
            return Ok(value);
        }
        let tokens = self.tokens(&pending.line)?;
        let mut reader = Reader::new(&tokens[pending.skip..]);
        let span = reader.rest_span();
        let value = reader.expression(&|token| self.value_of(token)).and_then(|value| {
            if !reader.peek().is_none_or(|token| token.is(",")) {
                return Err(reader.expected("a comma"));
            }
            let fits = (i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(&value);
            if fits {
                Ok(value as u32)
            } else {
                Err(Wrong::new(span, format!("{value} does not fit a word of 32 bits")))
            }
        });
        value.map_err(|wrong| self.error(&pending.line, wrong))
    }

    fn operands(
        &self,
        opcode: Opcode,
        address: u32,
        mnemonic: &Token,
        reader: &mut Reader,
    ) -> Result<Instruction, Wrong> {
        let entry = opcode.entry();
        let mut instruction = Instruction::new(opcode);
        let written = format!("{} {}", entry.mnemonic, entry.format.syntax());
        for (index, &operand) in entry.format.operands().iter().enumerate() {
            if index > 0 && !reader.take_sign(",") || reader.peek().is_none() {
                let wrong = match reader.peek() {
                    Some(_) => reader.expected("a comma"),
                    None => Wrong::new(mnemonic.span(), format!("`{}` has too few operands", entry.mnemonic)),
                };
                return Err(wrong.help(format!("it is written `{written}`")));
            }
            self.operand(operand, address, reader, &mut instruction)?;
        }
        reader.expect_end().map_err(|wrong| wrong.help(format!("it is written `{}`", written.trim())))?;
        Ok(instruction)
    }

    fn operand(
        &self,
        operand: Operand,
        address: u32,
        reader: &mut Reader,
        instruction: &mut Instruction,
    ) -> Result<(), Wrong> {
        match operand {
            Operand::Write(field) => {
                let span = reader.rest_span();
                let register = self.expect_register(reader)?;
                if register == Register::PASS_X {
                    return Err(Wrong::new(span.start..span.start + 2, "`xp` can only be read")
                        .help("`x` writes to the right neighbour's X"));
                }
                instruction.set_register(field, register);
            }
            Operand::Read(field) => instruction.set_register(field, self.expect_register(reader)?),
            Operand::Constant(field) => instruction.constant = self.constant_of(reader, field, 0, "constant")?,
            Operand::Target(field) => {
                instruction.constant = self.constant_of(reader, field, i64::from(address), "distance")?;
            }
            Operand::Memory(base, offset) => {
                reader
                    .expect_sign("[")
                    .map_err(|wrong| wrong.help("a word of memory is written `[register + constant]`"))?;
                let register = reader.peek().and_then(|token| self.register(token.text));
                if let Some(register) = register {
                    reader.take();
                    instruction.set_register(base, register);
                }
                let ends = reader.peek().is_some_and(|token| token.is("]"));
                // Behind a register there must be a sign, which the expression's own could be.
                if !ends {
                    let minus = reader.peek().is_some_and(|token| token.is("-"));
                    if register.is_some() && !minus {
                        reader.expect_sign("+")?;
                    }
                    instruction.constant = self.constant_of(reader, offset, 0, "constant")?;
                }
                reader.expect_sign("]")?;
            }
        }
        Ok(())
    }

    fn expect_register(&self, reader: &mut Reader) -> Result<Register, Wrong> {
        match reader.peek() {
            Some(token) if token.kind == Kind::Name => {
                let register = self.register(token.text).ok_or_else(|| self.no_register(token))?;
                reader.take();
                Ok(register)
            }
            _ => Err(reader.expected("a register")),
        }
    }

    /// A name that is no register's.
    pub fn no_register(&self, token: &Token) -> Wrong {
        let wrong = Wrong::new(token.span(), format!("`{}` is no register", token.text));
        let known: Vec<String> = Register::all().map(|register| register.to_string()).collect();
        let names = self.registers.keys().chain(&known).map(String::as_str);
        match nearest(token.text, names) {
            Some(similar) => wrong.help(format!("did you mean `{similar}`?")),
            None => wrong.help("there are r0 to r59, the queues x, xp and y, and names given by `.reg`"),
        }
    }

    /// The value of an expression, less `from`, which must fit the field.
    fn constant_of(&self, reader: &mut Reader, field: Field, from: i64, what: &str) -> Result<i32, Wrong> {
        let span = reader.rest_span();
        let value = reader.expression(&|token| self.value_of(token))?;
        let span = span.start..reader.rest_span().start.min(span.end).max(span.start + 1);
        let distance = value - from;
        let range = field.range();
        if !range.contains(&distance) {
            let message =
                format!("a {what} of {distance} does not fit: from {} to {} does", range.start(), range.end());
            return Err(Wrong::new(span, message));
        }
        Ok(distance as i32)
    }
}
