//! The assembler: source text to a [`Program`], in two passes.
//!
//! The first ([`expand`]) follows files, macros and conditions line by line and gives every label its address; the second
//! ([`operands`]) works out the operands, for which all labels are known by then.
//!
//! ```text
//!         .option EARLIER 0          ; a constant that the caller may set otherwise
//! WORDS = 8                          ; a constant
//!         .reg  id r1                ; a name for a register
//!         .kernel grid               ; what the instructions from here on work for
//! next:   mov   id, xp               ; a label, an instruction
//!         .count voxels              ; counts the next instruction's executions
//!         bne   id, r0, next
//!         .macro twice reg           ; a macro: {reg} stands for its argument
//!         add   {reg}, {reg}, {reg}
//!         .end
//!         .if EARLIER                ; lines for a constant that is not 0; `.else` may follow
//!         twice id
//!         .end
//!         .include "more.pcs"
//!         .data                      ; data memory from here on; `.code` goes back
//! table:  .loaded                    ; a word that the loader fills in, known by its label
//! limits: .word 1, WORDS * 2, table
//! one:    .float 1.0, -inf
//! room:   .space 16
//! ```

mod expand;
mod expression;
mod line;
mod operands;

use crate::isa::kernels::OTHER;
use crate::seam::Activity;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use self::expression::Wrong;
use self::line::{Line, Token};
use super::program::Program;
use super::register::Register;
use super::table::Opcode;
use crate::error::InputError;
use crate::input::fields;
use crate::input::text::nearest;

/// Where `.include` finds files, whose names count from the folder of the including file on.
#[derive(Clone, Copy, Debug)]
pub enum Sources {
    /// In the file system.
    Files,
    /// Among texts with names.
    BuiltIn(&'static [(&'static str, &'static str)]),
}

impl Sources {
    /// Reads a program's own file.
    pub fn open(self, path: &Path) -> Result<String, InputError> {
        match self {
            Sources::Files => fields::read_text(path),
            Sources::BuiltIn(texts) => {
                let found = texts.iter().find(|(name, _)| Path::new(name) == path);
                let missing = || InputError::in_file(path, "there is no such built-in program");
                found.map(|(_, text)| (*text).to_owned()).ok_or_else(missing)
            }
        }
    }

    /// Where a file lies that another one includes.
    fn place(from: &Path, name: &str) -> PathBuf {
        from.parent().unwrap_or(Path::new("")).join(name)
    }
}

/// Assembles a program. `options` are values for its `.option`s; those that it does not have are left alone.
pub fn assemble(path: &Path, sources: Sources, options: &[(&str, i64)]) -> Result<Program, InputError> {
    let mut assembler = Assembler {
        sources,
        options: options.iter().map(|&(name, value)| (name.to_owned(), value)).collect(),
        program: Program::default(),
        constants: BTreeMap::new(),
        registers: BTreeMap::new(),
        macros: BTreeMap::new(),
        defined: BTreeMap::new(),
        instructions: Vec::new(),
        data: Vec::new(),
        in_data: false,
        work: OTHER,
        depth: 0,
        followed: 0,
    };
    assembler.file(path)?;
    assembler.finish()
}

/// What is known so far of a program that is being assembled.
struct Assembler {
    sources: Sources,
    options: BTreeMap<String, i64>,
    program: Program,
    constants: BTreeMap<String, i64>,
    registers: BTreeMap<String, Register>,
    macros: BTreeMap<String, Macro>,
    /// Where each constant, label, register name and macro is defined: the file and the line.
    defined: BTreeMap<String, (PathBuf, u32)>,
    instructions: Vec<Pending>,
    data: Vec<Pending>,
    in_data: bool,
    work: Activity,
    /// Files, macros and conditions that are being followed.
    depth: usize,
    /// Lines that have been followed.
    followed: usize,
}

/// A macro: what its lines say, with `{parameter}` where the arguments go.
#[derive(Clone)]
struct Macro {
    parameters: Vec<String>,
    lines: Vec<Line>,
}

/// A word whose value is worked out when all labels are known.
struct Pending {
    line: Line,
    /// Tokens before the operands.
    skip: usize,
    what: Word,
}

enum Word {
    Instruction(Opcode),
    /// One of the `.word`s of a line: the first token of it.
    Expression,
    /// A word that is known.
    Value(u32),
}

impl Assembler {
    fn path(&self, line: &Line) -> &Path {
        &self.program.files[line.place.file as usize].path
    }

    /// The error of what is wrong in a line.
    fn error(&self, line: &Line, wrong: Wrong) -> InputError {
        let error = line.error(self.path(line), wrong.span, wrong.message);
        match wrong.help {
            Some(help) => error.help(help),
            None => error,
        }
    }

    fn tokens<'l>(&self, line: &'l Line) -> Result<Vec<Token<'l>>, InputError> {
        line.tokens().map_err(|(span, message)| self.error(line, Wrong::new(span, message)))
    }

    /// The value of a constant or label.
    fn value_of(&self, token: &Token) -> Result<i64, Wrong> {
        let name = token.text;
        let label = |labels: &BTreeMap<String, u32>| labels.get(name).map(|&address| i64::from(address));
        let constant = self.constants.get(name).copied();
        if let Some(value) =
            constant.or_else(|| label(&self.program.code_labels)).or_else(|| label(&self.program.data_labels))
        {
            return Ok(value);
        }
        if self.register(name).is_some() {
            return Err(Wrong::new(
                token.span(),
                format!("`{name}` is a register; a constant or a label is expected here"),
            ));
        }
        let known = self.constants.keys().chain(self.program.code_labels.keys()).chain(self.program.data_labels.keys());
        let wrong = Wrong::new(token.span(), format!("unknown name `{name}`"));
        Err(match nearest(name, known.map(String::as_str)) {
            Some(similar) => wrong.help(format!("did you mean `{similar}`?")),
            None => wrong.help("labels stand at the start of a line, before a colon; constants before a `=`"),
        })
    }

    /// The register or queue of a name.
    fn register(&self, name: &str) -> Option<Register> {
        self.registers.get(name).copied().or_else(|| Register::named(name))
    }

    /// Works out all words.
    fn finish(mut self) -> Result<Program, InputError> {
        for (address, pending) in self.instructions.iter().enumerate() {
            let instruction = self.instruction(pending, address as u32)?;
            self.program.code.push(instruction.encode());
        }
        for pending in &self.data {
            let word = self.data_word(pending)?;
            self.program.data.push(word);
        }
        Ok(self.program)
    }
}
