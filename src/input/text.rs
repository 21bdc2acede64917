//! Text files as the readers see them: tokens that know where they stand, and numbers that are checked.

use std::ops::Range;
use std::path::Path;

use glam::Vec3;

use super::lines::grouped;
use crate::error::InputError;

pub(crate) use super::lines::plural;

/// Largest coordinate taken, in absolute value: its square and its cube's products still fit 32-bit arithmetic.
pub(crate) const LARGEST_COORDINATE: f64 = 1e15;

/// Longest word for which a similar one is looked for, in bytes.
const LONGEST_NAME: usize = 100;

/// Ctrl-Z, with which DOS ended text files.
const END_OF_FILE: char = '\x1a';

/// A text file.
#[derive(Clone, Copy)]
pub(crate) struct Text<'a> {
    pub file: &'a Path,
    pub text: &'a str,
}

/// A stretch of a text file without white space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token<'a> {
    pub text: &'a str,
    /// Bytes from the start of the file.
    pub at: usize,
}

impl Token<'_> {
    /// The bytes that the token takes in the file.
    pub fn span(&self) -> Range<usize> {
        self.at..self.at + self.text.len()
    }
}

impl<'a> Text<'a> {
    /// The tokens of a part of this text.
    pub fn tokens(self, part: &'a str) -> impl Iterator<Item = Token<'a>> {
        part.split_ascii_whitespace().map(move |text| Token { text, at: self.offset_of(text) })
    }

    /// Where a part of this text begins, in bytes from its start.
    pub fn offset_of(&self, part: &str) -> usize {
        part.as_ptr().addr().saturating_sub(self.text.as_ptr().addr())
    }

    /// The place behind the last word, for what is missing there.
    pub fn end(&self) -> Range<usize> {
        let end = self.text.trim_end().len();
        end..end
    }

    /// A mistake at a stretch of the file, given in bytes; an empty one points between two characters.
    pub fn error(&self, span: Range<usize>, message: impl Into<String>) -> InputError {
        let before = self.text.get(..span.start).unwrap_or(self.text);
        let line = 1 + before.matches('\n').count();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let column = 1 + before[line_start..].chars().count();
        let marked = self.text.get(span).unwrap_or("");
        let width = marked.lines().next().unwrap_or("").chars().count();
        InputError::in_text(self.file, self.text, line, column, width, message)
    }

    /// A mistake at a token.
    pub fn error_at(&self, token: Token, message: impl Into<String>) -> InputError {
        self.error(token.span(), message)
    }

    /// The number that a token is, be it infinite or none at all.
    pub fn any_number(&self, token: Token) -> Result<f64, InputError> {
        parsed(token.text).ok_or_else(|| self.error_at(token, format!("`{}` is not a number", token.text)))
    }

    /// The finite number that a token is.
    pub fn number(&self, token: Token) -> Result<f64, InputError> {
        finite(self.any_number(token)?).map_err(|message| self.error_at(token, message))
    }

    /// The coordinate that a token is.
    pub fn coordinate(&self, token: Token) -> Result<f32, InputError> {
        coordinate(self.number(token)?).map_err(|message| self.error_at(token, message))
    }

    /// The point or direction that three tokens are.
    pub fn vector(&self, [x, y, z]: [Token; 3]) -> Result<Vec3, InputError> {
        Ok(Vec3::new(self.coordinate(x)?, self.coordinate(y)?, self.coordinate(z)?))
    }

    /// The line of a place given in bytes, from 1.
    pub fn line(&self, at: usize) -> usize {
        1 + self.text.get(..at).unwrap_or(self.text).matches('\n').count()
    }
}

/// The bytes of a text file as text, whatever they are encoded in: UTF-16 with a byte order mark, or UTF-8, in which a
/// byte that is none stands for the character that it is in Latin-1.
///
/// A byte order mark and DOS' mark of the end are left out, and lines end at LF, with or without a CR before it: a CR
/// alone, the line end of old Macintoshes, becomes LF.
pub(crate) fn decode(bytes: Vec<u8>) -> String {
    let text = match bytes.as_slice() {
        [0xFF, 0xFE, rest @ ..] => from_utf16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, rest @ ..] => from_utf16(rest, u16::from_be_bytes),
        _ => String::from_utf8(bytes).unwrap_or_else(|error| from_latin1(error.as_bytes())),
    };
    plain(text)
}

/// The bytes of a text file as text, as [`decode`] has it, but refused if they are not UTF-8.
pub(crate) fn decode_utf8(file: &Path, bytes: Vec<u8>) -> Result<String, InputError> {
    let text = String::from_utf8(bytes);
    text.map(plain).map_err(|error| not_text(file, error.as_bytes(), error.utf8_error().valid_up_to()))
}

fn from_utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|char| char.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

fn from_latin1(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        text.extend(chunk.invalid().iter().map(|&byte| char::from(byte)));
    }
    text
}

/// Leaves out the marks of a text's start and end, and gives it one kind of line end.
fn plain(mut text: String) -> String {
    if let Some(rest) = text.strip_prefix('\u{feff}') {
        text = rest.to_owned();
    }
    let end = text.trim_end_matches(|c: char| c == END_OF_FILE || c.is_ascii_whitespace()).len();
    if let Some(mark) = text[end..].find(END_OF_FILE) {
        text.truncate(end + mark);
    }
    let ends_alone = |(at, _): (usize, &str)| !text[at + 1..].starts_with('\n');
    if text.match_indices('\r').any(ends_alone) { text.replace("\r\n", "\n").replace('\r', "\n") } else { text }
}

fn not_text(file: &Path, bytes: &[u8], valid: usize) -> InputError {
    let before = String::from_utf8_lossy(&bytes[..valid]);
    let end = bytes[valid..].iter().position(|&byte| byte == b'\n').map_or(bytes.len(), |length| valid + length);
    // The faulty line is drawn as far as it can be, so that the place can be seen.
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let shown = String::from_utf8_lossy(&bytes[start..end]).into_owned();
    let line = 1 + before.matches('\n').count();
    let column = 1 + before[start..].chars().count();
    let mut padded = "\n".repeat(line - 1);
    padded.push_str(&shown);
    InputError::in_text(file, &padded, line, column, 1, format!("line {line} is not UTF-8 text"))
        .help("save the file as UTF-8")
}

/// The number that a word is, in the spelling of any program: C libraries write `-nan(ind)` or `1.#QNAN` for no number.
pub(crate) fn parsed(word: &str) -> Option<f64> {
    let spelled = || {
        let lower = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
        let is_none = ["nan", "1.#ind", "1.#qnan", "1.#snan", "1.#inf"].iter().any(|start| lower.starts_with(start));
        is_none.then_some(f64::NAN)
    };
    word.parse().ok().or_else(spelled)
}

/// Checks that a number is neither infinite nor no number at all.
pub(crate) fn finite(number: f64) -> Result<f64, String> {
    if number.is_finite() { Ok(number) } else { Err(format!("{number} is not a finite number")) }
}

/// Checks that a number can be a coordinate.
pub(crate) fn coordinate(number: f64) -> Result<f32, String> {
    if finite(number)?.abs() > LARGEST_COORDINATE {
        let shown = shortest(number);
        return Err(format!("{shown} is too large for the array's 32-bit arithmetic, which takes up to 1e15"));
    }
    Ok(number as f32)
}

/// A number as its author may have written it, were it in single or in double precision.
fn shortest(number: f64) -> String {
    let single = number as f32;
    if f64::from(single) == number { format!("{single:e}") } else { format!("{number:e}") }
}

/// Checks that a number can be a colour's component or a material's coefficient.
pub(crate) fn amount(number: f64) -> Result<f32, String> {
    if finite(number)? < 0.0 {
        return Err(format!("{number} is negative"));
    }
    if number > LARGEST_COORDINATE {
        return Err(format!("{} is too large", shortest(number)));
    }
    Ok(number as f32)
}

/// A note of things passed over, if there are any: "2 faces of fewer than 3 corners were passed over".
pub(crate) fn passed_over(count: u64, one: &str, many: &str) -> Option<String> {
    match count {
        0 => None,
        1 => Some(format!("1 {one} was passed over")),
        _ => Some(format!("{} {many} were passed over", grouped(count))),
    }
}

/// The name of `known` that is most like `name`, if one is like enough to be what was meant.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let close = |&(distance, candidate): &(usize, &str)| {
        let shorter = candidate.len().min(name.len());
        distance <= 1 + shorter / 4 && distance < shorter
    };
    if name.len() > LONGEST_NAME {
        return None;
    }
    let edits = |candidate: &str| strsim::osa_distance(&name.to_lowercase(), &candidate.to_lowercase());
    known.into_iter().map(|candidate| (edits(candidate), candidate)).filter(close).min().map(|(_, best)| best)
}
