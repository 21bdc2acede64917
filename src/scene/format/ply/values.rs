//! The numbers behind the header of a PLY file, as text or in either byte order.

use std::fmt;
use std::path::Path;

use super::header::{Element, Type};
use crate::error::InputError;
use crate::input::text::{Text, Token, parsed};

const GOES_ON: &str = "file goes on after the last element that its header tells of";

/// One thing of an element, for messages: "`vertex` 3 of 8".
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    pub element: &'a Element,
    /// From 0.
    pub number: u64,
}

impl fmt::Display for Row<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` {} of {}", self.element.name, self.number + 1, self.element.count)
    }
}

/// Where the numbers of a row come from.
pub(crate) trait Values {
    /// Goes to the next row.
    fn begin(&mut self, row: Row) -> Result<(), InputError>;

    /// The next number of a row.
    fn value(&mut self, kind: Type, row: Row) -> Result<f64, InputError>;

    /// Makes sure that the row has no more numbers.
    fn end(&mut self, row: Row) -> Result<(), InputError>;

    /// Makes sure that nothing follows the last row.
    fn finish(&mut self) -> Result<(), InputError>;

    /// The place of the number that was read last, in bytes from the start of the file.
    fn place(&self) -> usize;

    /// A mistake at the number of that place.
    fn error_at(&self, place: usize, message: String) -> InputError;

    /// A mistake at the number that was read last.
    fn error(&self, message: String) -> InputError {
        self.error_at(self.place(), message)
    }
}

/// Numbers as text, one row a line.
pub(crate) struct Ascii<'a> {
    text: Text<'a>,
    rest: &'a str,
    line: &'a str,
    last: Token<'a>,
}

impl<'a> Ascii<'a> {
    /// The numbers after a header of `start` bytes.
    pub fn new(text: Text<'a>, start: usize) -> Self {
        Ascii { text, rest: text.text.get(start..).unwrap_or(""), line: "", last: Token { text: "", at: start } }
    }

    fn token(&mut self) -> Option<Token<'a>> {
        let line = self.line.trim_ascii_start();
        let (word, rest) = line.split_at(line.find(|c: char| c.is_ascii_whitespace()).unwrap_or(line.len()));
        if word.is_empty() {
            return None;
        }
        self.line = rest;
        self.last = Token { text: word, at: self.text.offset_of(word) };
        Some(self.last)
    }
}

impl Values for Ascii<'_> {
    fn begin(&mut self, row: Row) -> Result<(), InputError> {
        self.line = "";
        while self.line.is_empty() {
            if self.rest.is_empty() {
                return Err(self.text.error(self.text.end(), format!("file ends before {row}")));
            }
            let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
            self.line = line.trim_ascii_end();
            self.rest = rest;
        }
        Ok(())
    }

    fn value(&mut self, kind: Type, row: Row) -> Result<f64, InputError> {
        let Some(token) = self.token() else {
            let end = self.last.span().end;
            return Err(self.text.error(end..end, format!("line ends in the middle of {row}")));
        };
        let value = match kind.range() {
            Some((least, most)) => {
                let integer: Option<i64> = token.text.parse().ok();
                integer.filter(|n| (least..=most).contains(n)).map(|n| n as f64)
            }
            None => parsed(token.text),
        };
        value.ok_or_else(|| self.error(format!("`{}` is no number of type {}", token.text, kind.name())))
    }

    fn end(&mut self, row: Row) -> Result<(), InputError> {
        match self.token() {
            Some(_) => Err(self.error(format!("line goes on after the end of {row}"))),
            None => Ok(()),
        }
    }

    fn finish(&mut self) -> Result<(), InputError> {
        match self.text.tokens(self.rest).next() {
            Some(token) => Err(self.text.error_at(token, GOES_ON)),
            None => Ok(()),
        }
    }

    fn place(&self) -> usize {
        self.last.at
    }

    fn error_at(&self, place: usize, message: String) -> InputError {
        let token = self.text.tokens(&self.text.text[place..]).next();
        self.text.error(token.map_or(place..place, |token| token.span()), message)
    }
}

/// Numbers as bytes.
pub(crate) struct Binary<'a> {
    file: &'a Path,
    bytes: &'a [u8],
    next: usize,
    last: usize,
    big_endian: bool,
}

impl<'a> Binary<'a> {
    /// The numbers after a header of `start` bytes.
    pub fn new(file: &'a Path, bytes: &'a [u8], start: usize, big_endian: bool) -> Self {
        Binary { file, bytes, next: start, last: start, big_endian }
    }

    /// The next bytes, least significant first.
    fn take<const N: usize>(&mut self, row: Row) -> Result<[u8; N], InputError> {
        let Some(bytes) = self.bytes[self.next..].first_chunk::<N>() else {
            let message = format!("file ends in the middle of {row}");
            return Err(InputError::in_bytes(self.file, self.bytes.len() as u64, message));
        };
        self.last = self.next;
        self.next += N;
        let mut bytes = *bytes;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl Values for Binary<'_> {
    fn begin(&mut self, _: Row) -> Result<(), InputError> {
        Ok(())
    }

    fn value(&mut self, kind: Type, row: Row) -> Result<f64, InputError> {
        Ok(match kind {
            Type::Int8 => i8::from_le_bytes(self.take(row)?).into(),
            Type::Uint8 => u8::from_le_bytes(self.take(row)?).into(),
            Type::Int16 => i16::from_le_bytes(self.take(row)?).into(),
            Type::Uint16 => u16::from_le_bytes(self.take(row)?).into(),
            Type::Int32 => i32::from_le_bytes(self.take(row)?).into(),
            Type::Uint32 => u32::from_le_bytes(self.take(row)?).into(),
            Type::Float32 => f32::from_le_bytes(self.take(row)?).into(),
            Type::Float64 => f64::from_le_bytes(self.take(row)?),
        })
    }

    fn end(&mut self, _: Row) -> Result<(), InputError> {
        Ok(())
    }

    fn finish(&mut self) -> Result<(), InputError> {
        // What edits a file as text ends its last line, and DOS marks its end.
        let is_data = |byte: &u8| !matches!(byte, b'\r' | b'\n' | b'\x1a');
        if self.bytes[self.next..].iter().any(is_data) {
            return Err(InputError::in_bytes(self.file, self.next as u64, GOES_ON));
        }
        Ok(())
    }

    fn place(&self) -> usize {
        self.last
    }

    fn error_at(&self, place: usize, message: String) -> InputError {
        InputError::in_bytes(self.file, place as u64, message)
    }
}
