//! Words for a cell to read, as people write them: integers, hexadecimal digits, floating-point numbers.

use std::path::Path;

use crate::error::InputError;
use crate::input::fields;
use crate::input::text::{Text, Token};

/// Reads a file of words, between white space or commas; a semicolon begins a comment. `-` is stdin.
pub fn read(path: &Path) -> Result<Vec<u32>, InputError> {
    let text = if path == Path::new("-") {
        std::io::read_to_string(std::io::stdin()).map_err(|error| InputError::unreadable(path, &error))?
    } else {
        fields::read_text(path)?
    };
    parse(path, &text)
}

fn parse(path: &Path, text: &str) -> Result<Vec<u32>, InputError> {
    let file = Text { file: path, text };
    let without_comment = |line: &'_ str| line.find(';').unwrap_or(line.len());
    let lines = text.lines().map(|line| &line[..without_comment(line)]);
    let tokens = lines.flat_map(|line| line.split(|c: char| c.is_whitespace() || c == ','));
    let words = tokens.filter(|token| !token.is_empty()).map(|token| {
        word(token).ok_or_else(|| {
            let token = Token { text: token, at: file.offset_of(token) };
            let error = file.error_at(token, format!("`{}` is no word of 32 bits", token.text));
            error.help("words are written as 7, -1, 0xffffffff, 1.5 or 2e-3")
        })
    });
    words.collect()
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
