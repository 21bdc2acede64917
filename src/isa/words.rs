//! Words for a cell to read, as people write them: integers, hexadecimal digits, floating-point numbers.

use std::path::Path;

use crate::error::InputError;
use crate::input::fields;
use crate::input::text::{Text, Token};

/// Words that somebody wrote.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Words {
    /// The words.
    pub words: Vec<u32>,
    /// How many of them are written as integers in decimal digits.
    whole: usize,
}

impl Words {
    /// Whether there are words, and all are written as integers: as numbers with a fraction none of them is what it seems.
    pub fn are_all_whole(&self) -> bool {
        self.whole > 0 && self.whole == self.words.len()
    }
}

/// Reads a file of words, between white space or commas; a semicolon begins a comment. `-` is stdin.
pub fn read(path: &Path) -> Result<Words, InputError> {
    parse(path, &fields::read_text(path)?)
}

fn parse(path: &Path, text: &str) -> Result<Words, InputError> {
    let file = Text { file: path, text };
    let without_comment = |line: &'_ str| line.find(';').unwrap_or(line.len());
    let lines = text.lines().map(|line| &line[..without_comment(line)]);
    let tokens = lines.flat_map(|line| line.split(|c: char| c.is_whitespace() || c == ','));
    let mut words = Words::default();
    for token in tokens.filter(|token| !token.is_empty()) {
        let Some(word) = word(token) else {
            let token = Token { text: token, at: file.offset_of(token) };
            let error = file.error_at(token, format!("`{}` is no word of 32 bits", token.text));
            return Err(error.help("words are written as 7, -1, 0xffffffff, 1.5 or 2e-3"));
        };
        words.words.push(word);
        words.whole += usize::from(token.parse::<i64>().is_ok());
    }
    Ok(words)
}

fn word(text: &str) -> Option<u32> {
    if let Some(digits) = text.strip_prefix("0x") {
        return u32::from_str_radix(digits, 16).ok();
    }
    match text.parse::<i64>() {
        Ok(value) if (i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(&value) => Some(value as u32),
        Ok(_) => None,
        Err(_) => text.parse::<f32>().ok().map(f32::to_bits),
    }
}

/// A word as it is most likely meant: a small integer, else a floating-point number of usual size, else its bits.
pub fn likely(word: u32) -> String {
    let (integer, float) = (word as i32, f32::from_bits(word));
    if integer.unsigned_abs() < 1 << 22 {
        integer.to_string()
    } else if float.is_infinite() || (1e-9..1e9).contains(&float.abs()) {
        format!("{float:?}")
    } else {
        format!("{word:#010x}")
    }
}
