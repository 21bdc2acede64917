//! RON files that people write: read whole, with errors that point.

use std::io::Read;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::text::Text;
use super::{reading, ron_text};
use crate::error::InputError;

/// The largest text file that is read whole, in bytes: more than 10 million rays.
const LARGEST_TEXT: u64 = 1 << 30;

/// Reads a text file.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    let unreadable = |error: std::io::Error| InputError::unreadable(path, &error);
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(unreadable)?;
    file.take(LARGEST_TEXT + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST_TEXT {
        return Err(InputError::in_file(path, "the file is too large: it may have up to 1 GiB"));
    }
    reading::note(path, &bytes);
    Ok(Text::decode(path, &bytes)?.text.to_owned())
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
