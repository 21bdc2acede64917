//! RON text whose values know where they stand.

use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;

use ron::Options;
use ron::error::{Error, Position, SpannedError};
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::de::{Deserialize, DeserializeOwned, Deserializer, MapAccess, Visitor};

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

impl<'a, T: Deserialize<'a>> Located<'a, T> {
    /// The value, where parts of it know their places, too.
    pub fn nested(&self, file: Text) -> Result<T, InputError> {
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
    options().from_str(part).map_err(|error| explain(file, part, &error))
}

/// An optional value is written without `Some`.
fn options() -> Options {
    Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

/// Where a field with its value stands in a RON file, in bytes: one of the whole, or of a struct within it.
pub(crate) fn field(file: Text, name: &str) -> Option<Range<usize>> {
    let (name, value) = field_in(file.text, name)?;
    Some(file.offset_of(name)..file.offset_of(value) + value.len())
}

fn field_in<'a>(part: &'a str, name: &str) -> Option<(&'a str, &'a str)> {
    let Fields(fields) = options().from_str(part).ok()?;
    let own = fields.iter().find(|field| field.0 == name).copied();
    own.or_else(|| fields.iter().find_map(|(_, value)| field_in(value, name)))
}

/// The fields of any struct, as text.
struct Fields<'a>(Vec<(&'a str, &'a str)>);

impl<'de: 'a, 'a> Deserialize<'de> for Fields<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AnyStruct;
        impl<'de> Visitor<'de> for AnyStruct {
            type Value = Fields<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a struct")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Fields<'de>, A::Error> {
                let mut fields = Vec::new();
                while let Some((name, value)) = map.next_entry::<&str, Located<()>>()? {
                    fields.push((name, value.text));
                }
                Ok(Fields(fields))
            }
        }
        deserializer.deserialize_any(AnyStruct)
    }
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
