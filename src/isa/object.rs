//! Object files: a program's words as text, one a line.
//!
//! ```text
//! pcs object
//! code
//! 0103c000
//! data
//! 3f800000
//! ```
//!
//! They hold words and nothing else: names, lines of source, kernels and counted events stay in the source. The lines of
//! a program that is read from an object file are those of the object file.

use std::path::Path;

use super::assembler::{Sources, assemble};
use super::kernels::OTHER;
use super::program::{Program, SourceFile, SourceLine};
use crate::error::InputError;
use crate::input::fields;

/// The first line of an object file.
const HEADER: &str = "pcs object";

/// A program's object file.
pub fn write(program: &Program) -> String {
    let words = |words: &[u32]| words.iter().map(|word| format!("{word:08x}\n")).collect::<String>();
    format!("{HEADER}\ncode\n{}data\n{}", words(&program.code), words(&program.data))
}

/// Reads a program from source text or from an object file, which the first line tells apart.
pub fn load(path: &Path) -> Result<Program, InputError> {
    let text = fields::read_text(path)?;
    if text.lines().next() == Some(HEADER) { parse(path, text) } else { assemble(path, Sources::Files, &[]) }
}

fn parse(path: &Path, text: String) -> Result<Program, InputError> {
    let mut program = Program::default();
    let mut in_data = None;
    for (line, number) in text.lines().zip(1..).skip(1) {
        let wrong = |message: &str| {
            let width = line.chars().count();
            Err(InputError::in_text(path, &text, number as usize, 1, width, message))
        };
        let is_word = line.len() == 8 && line.bytes().all(|byte| byte.is_ascii_hexdigit());
        match (line, u32::from_str_radix(line, 16)) {
            ("code", _) => in_data = Some(false),
            ("data", _) => in_data = Some(true),
            (_, Ok(word)) if is_word => match in_data {
                Some(false) => {
                    program.code.push(word);
                    program.work.push(OTHER);
                    program.lines.push(SourceLine { file: 0, line: number });
                }
                Some(true) => program.data.push(word),
                None => return wrong("a word stands before `code` and `data`"),
            },
            _ => return wrong("a word is expected here, as eight hexadecimal digits; or `code`, or `data`"),
        }
    }
    program.files.push(SourceFile { path: path.to_owned(), text });
    Ok(program)
}
