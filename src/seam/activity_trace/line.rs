//! The lines of a trace.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, Read, Seek};
use std::path::Path;

use super::MOST_OF_AN_OP;
use crate::error::InputError;
use crate::input::packed;
use crate::seam::{MOST_CELLS, OpKind, OpStream, Vocabulary};

/// The longest line that is read, in bytes: far more than any job makes.
const LONGEST_LINE: u64 = 1 << 24;

/// Calls `visit` with the number and the text of every line that is neither empty nor a comment.
pub(super) fn lines<E: From<InputError>>(
    path: &Path,
    mut file: &File,
    mut visit: impl FnMut(usize, &str) -> Result<(), E>,
) -> Result<(), E> {
    let unreadable = |error: std::io::Error| InputError::unreadable(path, &error);
    file.rewind().map_err(unreadable)?;
    let mut reader = packed::unpacked(file).map_err(unreadable)?;
    let (mut bytes, mut number) = (Vec::new(), 0);
    loop {
        bytes.clear();
        number += 1;
        if reader.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut bytes).map_err(unreadable)? == 0 {
            return Ok(());
        }
        if bytes.len() as u64 == LONGEST_LINE {
            let message = format!("line {number} is longer than any ray's can be: {LONGEST_LINE} bytes");
            return Err(InputError::in_file(path, message).into());
        }
        let not_text = |_| InputError::in_file(path, format!("line {number} is no text"));
        let text = std::str::from_utf8(&bytes).map_err(not_text)?.trim_end();
        if !text.trim_start().is_empty() && !text.trim_start().starts_with('#') {
            visit(number, text)?;
        }
    }
}

/// Who did what a line tells.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Actor {
    Host,
    Cell(usize),
}

/// One line of a trace.
pub(super) struct Line<'a> {
    path: &'a Path,
    pub(super) number: usize,
    pub(super) text: &'a str,
    /// Job and cell, if they are there, or "".
    pub(super) words: [&'a str; 2],
    rest: &'a str,
    /// The units that its ops may count; `None` in a heading.
    vocabulary: Option<&'a Vocabulary>,
}

impl<'a> Line<'a> {
    /// A line of a heading.
    pub(super) fn of_heading(path: &'a Path, number: usize, text: &'a str) -> Line<'a> {
        Line { path, number, text, words: ["", ""], rest: text, vocabulary: None }
    }

    /// A line of ops.
    pub(super) fn new(path: &'a Path, number: usize, text: &'a str, vocabulary: &'a Vocabulary) -> Line<'a> {
        let (job, rest) = split_word(text);
        let (cell, rest) = split_word(rest);
        Line { path, number, text, words: [job, cell], rest, vocabulary: Some(vocabulary) }
    }

    pub(super) fn job(&self) -> Result<u32, InputError> {
        let word = self.words[0];
        word.parse().map_err(|_| self.error(word, "expected a ray's number at the start of the line"))
    }

    pub(super) fn actor(&self) -> Result<Actor, InputError> {
        let word = self.words[1];
        if word == "host" {
            return Ok(Actor::Host);
        }
        match word.parse() {
            Ok(index) if index < MOST_CELLS => Ok(Actor::Cell(index)),
            Ok(_) => Err(self.error(word, format!("there can be no more than {MOST_CELLS} cells"))),
            Err(_) => Err(self.error(word, "expected a cell's number or 'host'")),
        }
    }

    /// The ops, each as its kind and its count.
    pub(super) fn ops(&self) -> impl Iterator<Item = Result<(OpKind, u64), InputError>> + '_ {
        let host = self.words[1] == "host";
        let mut rest = self.rest;
        std::iter::from_fn(move || {
            let (word, after) = split_word(rest);
            rest = after;
            (!word.is_empty()).then(|| self.op(word, host))
        })
    }

    fn op(&self, word: &'a str, host: bool) -> Result<(OpKind, u64), InputError> {
        let (code, digits) = word.split_at(word.find(|c: char| !c.is_ascii_lowercase()).unwrap_or(word.len()));
        let Some(kind) = self.kind(code).filter(|kind| is_allowed(*kind, host)) else {
            return Err(self.error(word, self.no_op(word, host)));
        };
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(self.error(word, format!("expected a whole number after '{code}'")));
        }
        match digits.parse() {
            Ok(count) if count <= MOST_OF_AN_OP => Ok((kind, count)),
            _ => Err(self.error(word, format!("no op may count more than {MOST_OF_AN_OP}"))),
        }
    }

    fn kind(&self, code: &str) -> Option<OpKind> {
        let unit = || self.vocabulary.and_then(|vocabulary| vocabulary.unit_coded(code)).map(OpKind::Work);
        OpKind::from_word(code).or_else(unit)
    }

    fn no_op(&self, word: &str, host: bool) -> String {
        let units = self.vocabulary.iter().flat_map(|vocabulary| &vocabulary.units);
        let units: Vec<&str> = units.map(|unit| unit.code.as_str()).collect();
        match host {
            true => {
                format!("'{word}' is no op of the host, whose ops are w, a and units of work ({})", units.join(", "))
            }
            false => format!(
                "'{word}' is no op of a cell, whose ops are x, i, o, r, w, b, z and units of work ({})",
                units.join(", ")
            ),
        }
    }

    /// Adds the line to a stream; waits for a job become waits for the message in the job's place.
    pub(super) fn push_to(&self, stream: &mut OpStream, order: &HashMap<u32, u64>) -> Result<(), InputError> {
        for op in self.ops() {
            let (kind, count) = op?;
            let count = match kind {
                OpKind::Await => u32::try_from(count).ok().and_then(|job| order.get(&job).copied()).unwrap_or(count),
                _ => count,
            };
            stream.push(kind, count);
        }
        stream.end_line(self.job()?);
        Ok(())
    }

    /// An error at a word of the line.
    pub(super) fn error(&self, word: &str, message: impl Into<String>) -> InputError {
        let offset = (word.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize).min(self.text.len());
        let column = 1 + self.text.get(..offset).map_or(0, |before| before.chars().count());
        InputError::in_line(self.path, self.text, self.number, column, word.chars().count(), message)
    }
}

/// The host sends, works and waits; cells do everything but wait for answers.
fn is_allowed(kind: OpKind, host: bool) -> bool {
    match kind {
        OpKind::Await => host,
        OpKind::WriteX | OpKind::Work(_) => true,
        _ => !host,
    }
}

fn split_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    text.split_at(text.find(char::is_whitespace).unwrap_or(text.len()))
}
