//! A program as the assembler leaves it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::seam::Activity;

/// A program for a cell: instructions, and the data memory as it is before the loader fills it in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Program {
    /// The instruction words. The program starts at the first one, whose address is 0.
    pub code: Vec<u32>,
    /// What each instruction works for.
    pub work: Vec<Activity>,
    /// Where each instruction stands in the source.
    pub lines: Vec<SourceLine>,
    /// The words of data memory, from address 0 of the memory on.
    pub data: Vec<u32>,
    /// Words of data that the loader must fill in: their names and addresses.
    pub loaded: BTreeMap<String, u32>,
    /// Labels of instructions and their addresses.
    pub code_labels: BTreeMap<String, u32>,
    /// Labels of data and their addresses.
    pub data_labels: BTreeMap<String, u32>,
    /// Names of events, and the addresses of the instructions whose execution is one.
    pub counted: BTreeMap<String, Vec<u32>>,
    /// The files that it was assembled from; the first is the program's own.
    pub files: Vec<SourceFile>,
}

/// A file of source text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceFile {
    /// As the user, or the file that includes it, named it.
    pub path: PathBuf,
    /// All of it.
    pub text: String,
}

/// A line of source text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SourceLine {
    /// Which of the program's files.
    pub file: u32,
    /// Which line of it, from 1.
    pub line: u32,
}

impl Program {
    /// A source line's text.
    pub fn text_of(&self, place: SourceLine) -> &str {
        let file = self.files.get(place.file as usize);
        file.and_then(|file| file.text.lines().nth(place.line as usize - 1)).unwrap_or("")
    }

    /// The instruction at a label, at an address (`@12`), or the first at or behind a line of the program's own file.
    ///
    /// # Errors
    ///
    /// If there is no such place, in words.
    pub fn address_of(&self, place: &str) -> Result<u32, String> {
        if let Some(&address) = self.code_labels.get(place) {
            return Ok(address);
        }
        if let Some(address) = place.strip_prefix('@') {
            let (address, end) = (number(address)?, self.code.len() as u32);
            return if address < end { Ok(address) } else { Err(format!("the program ends before address {end}")) };
        }
        if !place.starts_with(|c: char| c.is_ascii_digit()) {
            return Err(format!("the program has no label `{place}`"));
        }
        let line = number(place)?;
        let lines = self.lines.iter().zip(0..).filter(|(at, _)| at.file == 0 && at.line >= line);
        let first = lines.min_by_key(|&(at, address)| (at.line, address));
        first.map(|(_, address)| address).ok_or_else(|| format!("no instruction stands in line {line} or behind it"))
    }

    /// The label at or before an instruction's address, and the distance from it.
    pub fn label_before(&self, address: u32) -> Option<(&str, u32)> {
        let labels = self.code_labels.iter().filter(|(_, at)| **at <= address);
        labels.max_by_key(|(_, at)| **at).map(|(name, at)| (name.as_str(), address - at))
    }
}

/// A number as people type it: in decimal, or in hexadecimal behind `0x`.
///
/// # Errors
///
/// If it is none of 32 bits, in words.
pub fn number(text: &str) -> Result<u32, String> {
    let number = match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16),
        None => text.parse(),
    };
    number.map_err(|_| format!("`{text}` is no number from 0 to {}", u32::MAX))
}
