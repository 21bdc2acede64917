//! What can go wrong, as data: the command draws it, a user of the crate can match on it.

use std::fmt;
use std::path::{Path, PathBuf};

/// A mistake in an input: what is wrong, where, and what to do about it.
///
/// The command ends with exit status 2 on one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError {
    /// What is wrong and what was expected, as one sentence without a final stop.
    pub message: String,
    /// Where it stands, if it stands in a file.
    pub place: Option<Place>,
    /// What the user can do about it.
    pub help: Option<String>,
}

/// A place in an input file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, named as the user named it.
    pub file: PathBuf,
    /// The place inside the file, if the fault is not with the file as a whole.
    pub spot: Option<Spot>,
}

/// A place inside a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Spot {
    /// A stretch of a line of text.
    Text {
        /// Line, from 1.
        line: usize,
        /// Column of the first character, from 1.
        column: usize,
        /// Number of characters that are at fault; 0 points between two characters.
        width: usize,
        /// The whole line, for the caret to point into.
        source: String,
    },
    /// A position in a binary file.
    Byte {
        /// Bytes from the start of the file.
        offset: u64,
    },
}

impl InputError {
    /// A mistake that stands in no file (a flag, or flags that contradict each other).
    pub fn new(message: impl Into<String>) -> Self {
        InputError { message: message.into(), place: None, help: None }
    }

    /// A mistake of the file as a whole.
    pub fn in_file(file: &Path, message: impl Into<String>) -> Self {
        let place = Place { file: file.to_owned(), spot: None };
        InputError { message: message.into(), place: Some(place), help: None }
    }

    /// A file that cannot be opened or read.
    pub fn unreadable(file: &Path, error: &std::io::Error) -> Self {
        // Without the number that Rust appends to the operating system's reason.
        let text = error.to_string();
        let reason = text.split(" (os error").next().unwrap_or(&text);
        InputError::in_file(file, format!("cannot read the file: {reason}"))
    }

    /// A mistake in a text file. `line` and `column` count from 1; `text` is the whole file, of which the line is kept.
    pub fn in_text(
        file: &Path,
        text: &str,
        line: usize,
        column: usize,
        width: usize,
        message: impl Into<String>,
    ) -> Self {
        let source = text.lines().nth(line.saturating_sub(1)).unwrap_or("");
        InputError::in_line(file, source, line, column, width, message)
    }

    /// A mistake in a text file of which only the line `source` is at hand.
    pub fn in_line(
        file: &Path,
        source: &str,
        line: usize,
        column: usize,
        width: usize,
        message: impl Into<String>,
    ) -> Self {
        let source = source.to_owned();
        let place = Place { file: file.to_owned(), spot: Some(Spot::Text { line, column, width, source }) };
        InputError { message: message.into(), place: Some(place), help: None }
    }

    /// A mistake in a binary file, `offset` bytes from its start.
    pub fn in_bytes(file: &Path, offset: u64, message: impl Into<String>) -> Self {
        let place = Place { file: file.to_owned(), spot: Some(Spot::Byte { offset }) };
        InputError { message: message.into(), place: Some(place), help: None }
    }

    /// The same mistake with advice.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{}", place.file.display())?;
            match &place.spot {
                Some(Spot::Text { line, column, .. }) => write!(f, ":{line}:{column}")?,
                Some(Spot::Byte { offset }) => write!(f, ": byte {offset}")?,
                None => {}
            }
            write!(f, ": ")?;
        }
        write!(f, "{}", self.message)?;
        if let Some(help) = &self.help {
            write!(f, " ({help})")?;
        }
        Ok(())
    }
}

impl std::error::Error for InputError {}
