//! Text files as the readers see them: tokens that know where they stand, and numbers that are checked.

use std::ops::Range;
use std::path::Path;

use glam::Vec3;

use crate::error::InputError;

/// Largest coordinate taken, in absolute value: its square and its cube's products still fit 32-bit arithmetic.
pub(crate) const LARGEST_COORDINATE: f64 = 1e15;

/// Longest word for which a similar one is looked for, in bytes.
const LONGEST_NAME: usize = 100;

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
    /// Takes the bytes of a file for UTF-8, with or without a byte order mark.
    pub fn decode(file: &'a Path, bytes: &'a [u8]) -> Result<Self, InputError> {
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let text = std::str::from_utf8(bytes).map_err(|error| not_text(file, bytes, error.valid_up_to()))?;
        Ok(Text { file, text })
    }

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

    /// The finite number that a token is.
    pub fn number(&self, token: Token) -> Result<f64, InputError> {
        let number: f64 =
            token.text.parse().map_err(|_| self.error_at(token, format!("`{}` is not a number", token.text)))?;
        finite(number).map_err(|message| self.error_at(token, message))
    }

    /// The coordinate that a token is.
    pub fn coordinate(&self, token: Token) -> Result<f32, InputError> {
        coordinate(self.number(token)?).map_err(|message| self.error_at(token, message))
    }

    /// The number of 0 or more that a token is: a colour's component or a material's coefficient.
    pub fn amount(&self, token: Token) -> Result<f32, InputError> {
        amount(self.number(token)?).map_err(|message| self.error_at(token, message))
    }

    /// The point or direction that three tokens are.
    pub fn vector(&self, [x, y, z]: [Token; 3]) -> Result<Vec3, InputError> {
        Ok(Vec3::new(self.coordinate(x)?, self.coordinate(y)?, self.coordinate(z)?))
    }

    /// The colour that three tokens are.
    pub fn color(&self, [r, g, b]: [Token; 3]) -> Result<Vec3, InputError> {
        Ok(Vec3::new(self.amount(r)?, self.amount(g)?, self.amount(b)?))
    }
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

/// "1 face", "2 faces".
pub(crate) fn plural(count: u64, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

/// What is said of a face with too few corners.
pub(crate) fn too_few_corners(count: usize) -> String {
    let vertices = if count == 1 { "vertex" } else { "vertices" };
    format!("face has {count} {vertices}, a face needs at least 3")
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
