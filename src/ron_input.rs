//! RON files that people write: read whole, with errors that point.

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::error::InputError;

/// Reads a text file.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    let bytes = std::fs::read(path).map_err(|error| InputError::in_file(path, format!("cannot be read: {error}")))?;
    String::from_utf8(bytes).map_err(|error| {
        let line = 1 + error.as_bytes()[..error.utf8_error().valid_up_to()].iter().filter(|&&b| b == b'\n').count();
        InputError::in_file(path, format!("is no UTF-8 text (line {line})"))
    })
}

/// Parses RON; `path` is for the errors.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, InputError> {
    options().from_str(text).map_err(|error| {
        let (start, end) = (error.span.start, error.span.end);
        let width = if end.line == start.line { end.col.saturating_sub(start.col) } else { 0 };
        InputError::in_text(path, text, start.line, start.col, width, error.code.to_string())
    })
}

fn options() -> ron::Options {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}
