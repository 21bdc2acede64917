//! RON text whose values know where they stand.

use std::marker::PhantomData;

use ron::Options;
use ron::error::{Error, Position, SpannedError};
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::de::{Deserialize, DeserializeOwned, Deserializer};

use super::text::{Text, nearest};
use crate::error::InputError;

/// A value of a RON file that is read only when it is asked for, by when its place is known.
///
/// What serde reads in one go has lost its place by the time that its meaning is checked.
pub(crate) struct Located<'a, T> {
    text: &'a str,
    kind: PhantomData<T>,
}

impl<'de: 'a, 'a, T> Deserialize<'de> for Located<'a, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let raw = <&'a RawValue>::deserialize(deserializer)?;
        Ok(Located { text: raw.trim().get_ron(), kind: PhantomData })
    }
}

impl<T: DeserializeOwned> Located<'_, T> {
    /// The value.
    pub fn read(&self, file: Text) -> Result<T, InputError> {
        read(file, self.text)
    }
}

impl<'a, T> Located<'a, T> {
    /// A mistake in what the value means.
    pub fn error(&self, file: Text, message: impl Into<String>) -> InputError {
        let at = file.offset_of(self.text);
        file.error(at..at + self.text.len(), message)
    }
}

/// Reads a part of a RON file, or all of it.
pub(crate) fn read<'a, T: Deserialize<'a>>(file: Text, part: &'a str) -> Result<T, InputError> {
    // An optional value is written without `Some`.
    let options = Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
    options.from_str(part).map_err(|error| explain(file, part, &error))
}

fn explain(file: Text, part: &str, error: &SpannedError) -> InputError {
    let start = file.offset_of(part);
    let from = start + offset(part, error.span.start);
    let to = start + offset(part, error.span.end);
    let place = |message: String| file.error(from..to.max(from), message);
    match &error.code {
        Error::NoSuchStructField { expected, found, .. } => {
            suggest(place(format!("unknown field `{found}`")), found, expected, "fields")
        }
        Error::NoSuchEnumVariant { expected, found, .. } => {
            suggest(place(format!("unknown name `{found}`")), found, expected, "names")
        }
        Error::MissingStructField { field, .. } => place(format!("field `{field}` is missing")),
        Error::DuplicateStructField { field, .. } => place(format!("field `{field}` is given twice")),
        Error::ExpectedRawValue => place("expected a value".to_owned()),
        Error::ExceededRecursionLimit => place("values are nested too deeply".to_owned()),
        other => place(lower_first(&other.to_string())),
    }
}

/// Adds what could have been meant instead of an unknown name.
pub(crate) fn suggest(error: InputError, found: &str, known: &[&str], what: &str) -> InputError {
    match nearest(found, known.iter().copied()) {
        Some(name) => error.help(format!("did you mean `{name}`?")),
        None => error.help(format!("known {what} are {}", known.join(", "))),
    }
}

/// The library counts lines and columns, both from 1.
fn offset(text: &str, position: Position) -> usize {
    let line: usize = text.split_inclusive('\n').take(position.line.saturating_sub(1)).map(str::len).sum();
    let columns = text[line..].chars().take(position.col.saturating_sub(1));
    line + columns.map(char::len_utf8).sum::<usize>()
}

fn lower_first(sentence: &str) -> String {
    let mut chars = sentence.chars();
    chars.next().map_or(String::new(), |first| first.to_lowercase().chain(chars).collect())
}
