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

    /// The label at or before an instruction's address, and the distance from it.
    pub fn label_before(&self, address: u32) -> Option<(&str, u32)> {
        let labels = self.code_labels.iter().filter(|(_, at)| **at <= address);
        labels.max_by_key(|(_, at)| **at).map(|(name, at)| (name.as_str(), address - at))
    }
}
