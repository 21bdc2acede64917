//! RON files that people write: read whole, with errors that point.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::text::Text;
use super::{file, ron_text, text};
use crate::error::InputError;

/// The largest text file that is read whole, in GiB: more than 10 million rays.
const LARGEST_TEXT: u64 = 1;

/// Whether a field need not be said.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Reads a text file, which must be UTF-8.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    text::decode_utf8(path, file::read(path, LARGEST_TEXT)?)
}

/// Reads a file whole, whatever it holds.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, InputError> {
    file::read(path, LARGEST_TEXT)
}

/// A file's bytes as text, which must be UTF-8.
#[cfg(feature = "report")]
pub fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String, InputError> {
    text::decode_utf8(path, bytes)
}

/// Reads a text file of any encoding: for what others wrote, and whose numbers alone matter.
pub(crate) fn read_any_text(path: &Path) -> Result<String, InputError> {
    Ok(text::decode(file::read(path, LARGEST_TEXT)?))
}

/// Parses RON; `path` is for the errors.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, InputError> {
    ron_text::read(Text { file: path, text }, text)
}

/// A value that cannot be, in a field of a RON file or from a flag that stands in for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    field: &'static str,
    message: String,
    help: Option<&'static str>,
}

impl Fault {
    /// What is wrong with the value of `field`.
    pub fn new(field: &'static str, message: impl Into<String>) -> Fault {
        Fault { field, message: message.into(), help: None }
    }

    /// The same with advice.
    pub fn help(self, help: &'static str) -> Fault {
        Fault { help: Some(help), ..self }
    }

    /// The error, where the field stands in the file.
    pub fn in_text(self, path: &Path, text: &str) -> InputError {
        let file = Text { file: path, text };
        let error = match ron_text::field(file, self.field) {
            Some(place) => file.error(place, self.message),
            None => InputError::in_file(path, self.message),
        };
        InputError { help: self.help.map(str::to_owned), ..error }
    }

    /// The error of a value that stands in no file.
    pub fn in_flags(self) -> InputError {
        InputError { help: self.help.map(str::to_owned), ..InputError::new(self.message) }
    }
}
