//! The header of a PLY file: which elements it has, and what each is made of.

use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;

use crate::error::InputError;
use crate::input::text::{Text, Token, decode, nearest};

/// What a PLY file says of itself.
pub(crate) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Things of one kind.
pub(crate) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
    /// Where the header speaks of it.
    pub span: Range<usize>,
}

pub(crate) struct Property {
    pub name: String,
    pub shape: Shape,
    /// Where the header speaks of it.
    pub span: Range<usize>,
}

#[derive(Clone, Copy)]
pub(crate) enum Shape {
    Scalar(Type),
    List { count: Type, item: Type },
}

/// The type of a number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Type {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Float32,
    Float64,
}

impl Type {
    /// Both names of each type, the older one first.
    const NAMES: [(&'static str, &'static str, Type); 8] = [
        ("char", "int8", Type::Int8),
        ("uchar", "uint8", Type::Uint8),
        ("short", "int16", Type::Int16),
        ("ushort", "uint16", Type::Uint16),
        ("int", "int32", Type::Int32),
        ("uint", "uint32", Type::Uint32),
        ("float", "float32", Type::Float32),
        ("double", "float64", Type::Float64),
    ];

    fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(old, new, _)| *old == name || *new == name).map(|&(_, _, kind)| kind)
    }

    /// The older name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, _, kind)| *kind == self).map_or("", |&(old, _, _)| old)
    }

    pub fn is_integer(self) -> bool {
        !matches!(self, Type::Float32 | Type::Float64)
    }

    /// The least and the largest value of an integer type.
    pub fn range(self) -> Option<(i64, i64)> {
        match self {
            Type::Int8 => Some((i8::MIN.into(), i8::MAX.into())),
            Type::Uint8 => Some((0, u8::MAX.into())),
            Type::Int16 => Some((i16::MIN.into(), i16::MAX.into())),
            Type::Uint16 => Some((0, u16::MAX.into())),
            Type::Int32 => Some((i32::MIN.into(), i32::MAX.into())),
            Type::Uint32 => Some((0, u32::MAX.into())),
            Type::Float32 | Type::Float64 => None,
        }
    }
}

impl Element {
    /// The place of a property in the list of them.
    pub fn position(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| names.contains(&property.name.as_str()))
    }

    /// Whether it has all of these as numbers, not as lists.
    pub fn has_numbers(&self, names: &[&str]) -> bool {
        let is_number = |property: &Property| matches!(property.shape, Shape::Scalar(_));
        names.iter().all(|name| self.position(&[name]).is_some_and(|at| is_number(&self.properties[at])))
    }
}

impl Header {
    pub fn element(&self, name: &str) -> Option<&Element> {
        self.elements.iter().find(|element| element.name == name)
    }
}

/// The bytes of the header, `end_header` and its line end included.
///
/// What the first line ends with, all others do: where that is CR alone, an LF behind `end_header` is data.
pub(crate) fn extent(file: &Path, bytes: &[u8]) -> Result<usize, InputError> {
    let mark = bytes.strip_prefix(b"\xEF\xBB\xBF").map_or(0, |_| 3);
    let first = bytes[mark..].iter().position(|byte| matches!(byte, b'\r' | b'\n')).map_or(bytes.len(), |at| mark + at);
    let line_end =
        if bytes[first..].first() == Some(&b'\r') && bytes.get(first + 1) != Some(&b'\n') { b'\r' } else { b'\n' };
    if bytes.is_empty() {
        return Err(InputError::in_file(file, "file is empty"));
    }
    if bytes[mark..first].trim_ascii() != b"ply" {
        return Err(no_ply(file, &bytes[mark..first]));
    }
    let mut end = 0;
    for line in bytes.split_inclusive(|&byte| byte == line_end) {
        end += line.len();
        if line.trim_ascii() == b"end_header" {
            return Ok(end);
        }
    }
    let source = decode(bytes.to_vec());
    let text = Text { file, text: &source };
    Err(text.error(text.end(), "file ends in its header, before `end_header`"))
}

fn no_ply(file: &Path, line: &[u8]) -> InputError {
    let shown: String = String::from_utf8_lossy(line).trim_end().chars().take(80).collect();
    InputError::in_text(file, &shown, 1, 1, shown.chars().count(), "no PLY file: its first line must be `ply`")
}

/// Reads a header, `end_header` included.
pub(crate) fn parse(text: Text) -> Result<Header, InputError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    // What has a name already: elements, and the properties of the last one.
    let (mut named, mut properties) = (HashSet::new(), HashSet::new());
    for line in text.text.lines().skip(1) {
        let tokens: Vec<Token> = text.tokens(line).collect();
        let Some((&keyword, arguments)) = tokens.split_first() else { continue };
        match keyword.text {
            "comment" | "obj_info" | "end_header" => {}
            "format" => encoding = Some(format(text, keyword, arguments)?),
            "element" => {
                elements.push(element(text, keyword, arguments, &mut named)?);
                properties.clear();
            }
            "property" => match elements.last_mut() {
                Some(element) => {
                    element.properties.push(property(text, keyword, arguments, &element.name, &mut properties)?);
                }
                None => return Err(text.error_at(keyword, "property stands before any element")),
            },
            _ => {
                return Err(unknown(
                    text,
                    keyword,
                    "PLY header statement",
                    &["format", "element", "property", "comment"],
                ));
            }
        }
    }
    let Some(encoding) = encoding else {
        return Err(text.error(0..3, "header has no `format` line"));
    };
    Ok(Header { encoding, elements })
}

fn format(text: Text, keyword: Token, arguments: &[Token]) -> Result<Encoding, InputError> {
    let [name, version] = *arguments else {
        return Err(text.error_at(keyword, "`format` needs an encoding and a version"));
    };
    if version.text != "1.0" {
        return Err(text.error_at(version, format!("unknown PLY version `{}`, expected 1.0", version.text)));
    }
    match name.text {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(unknown(text, name, "PLY encoding", &["ascii", "binary_little_endian", "binary_big_endian"])),
    }
}

fn element<'a>(
    text: Text,
    keyword: Token,
    arguments: &[Token<'a>],
    named: &mut HashSet<&'a str>,
) -> Result<Element, InputError> {
    let [name, count] = *arguments else {
        return Err(text.error_at(keyword, "`element` needs a name and a number"));
    };
    if !named.insert(name.text) {
        return Err(text.error_at(name, format!("there are two elements `{}`", name.text)));
    }
    let parsed: i128 =
        count.text.parse().map_err(|_| text.error_at(count, format!("`{}` is not a whole number", count.text)))?;
    if parsed < 0 {
        return Err(text.error_at(count, format!("number of elements is negative: {parsed}")));
    }
    if parsed > i128::from(u32::MAX) {
        return Err(text.error_at(count, format!("{parsed} elements are too many, there may be up to {}", u32::MAX)));
    }
    Ok(Element { name: name.text.to_owned(), count: parsed as u64, properties: Vec::new(), span: name.span() })
}

fn property<'a>(
    text: Text,
    keyword: Token,
    arguments: &[Token<'a>],
    element: &str,
    named: &mut HashSet<&'a str>,
) -> Result<Property, InputError> {
    let (name, shape) = match *arguments {
        [list, count, item, name] if list.text == "list" => {
            let count_type = number_type(text, count)?;
            if !count_type.is_integer() {
                return Err(text.error_at(count, "length of a list must be of an integer type"));
            }
            (name, Shape::List { count: count_type, item: number_type(text, item)? })
        }
        [kind, name] => (name, Shape::Scalar(number_type(text, kind)?)),
        _ => {
            let message = "`property` needs a type and a name, or `list`, two types and a name";
            return Err(text.error_at(keyword, message));
        }
    };
    if !named.insert(name.text) {
        let message = format!("element `{element}` has two properties `{}`", name.text);
        return Err(text.error_at(name, message));
    }
    Ok(Property { name: name.text.to_owned(), shape, span: name.span() })
}

fn number_type(text: Text, token: Token) -> Result<Type, InputError> {
    let names: Vec<&str> = Type::NAMES.iter().flat_map(|&(old, new, _)| [old, new]).collect();
    Type::named(token.text).ok_or_else(|| unknown(text, token, "PLY type", &names))
}

fn unknown(text: Text, token: Token, what: &str, known: &[&str]) -> InputError {
    let error = text.error_at(token, format!("unknown {what} `{}`", token.text));
    match nearest(token.text, known.iter().copied()) {
        Some(name) => error.help(format!("did you mean `{name}`?")),
        None => error.help(format!("known are {}", known.join(", "))),
    }
}
