//! Lines of source text and their tokens.

use std::ops::Range;
use std::path::Path;

use super::super::program::SourceLine;
use crate::error::InputError;

/// A line to be assembled: of a file, or of a macro's expansion.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// Where it stands, or where the macro's line does.
    pub place: SourceLine,
    /// The text, with the macro's arguments put in.
    pub text: String,
    /// The macro that it is expanded from.
    pub expanded_from: Option<String>,
}

/// A token's kind and value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Name,
    /// `.name`
    Directive,
    Integer(i64),
    Float(f32),
    /// `"text"`, with its quotes
    Text,
    /// One or two characters.
    Sign,
}

/// A token of a line.
#[derive(Clone, Debug)]
pub(super) struct Token<'a> {
    pub kind: Kind,
    pub text: &'a str,
    /// Bytes from the start of the line.
    pub at: usize,
}

impl Token<'_> {
    pub fn span(&self) -> Range<usize> {
        self.at..self.at + self.text.len()
    }

    pub fn is(&self, sign: &str) -> bool {
        self.kind == Kind::Sign && self.text == sign
    }
}

impl Line {
    /// A mistake at some bytes of the line.
    pub fn error(&self, path: &Path, span: Range<usize>, message: impl Into<String>) -> InputError {
        let column = 1 + self.text[..span.start.min(self.text.len())].chars().count();
        let width = self.text.get(span).map_or(0, |marked| marked.chars().count());
        let error = InputError::in_line(path, &self.text, self.place.line as usize, column, width, message);
        match &self.expanded_from {
            Some(name) => error.help(format!("the line is expanded from the macro `{name}`")),
            None => error,
        }
    }

    /// What stands first on the line, before a space or a comment.
    pub fn first_word(&self) -> &str {
        self.text.trim_start().split(|c: char| c.is_whitespace() || c == ';').next().unwrap_or("")
    }

    /// The bytes of the first word.
    pub fn first_span(&self) -> Range<usize> {
        let start = self.text.len() - self.text.trim_start().len();
        start..start + self.first_word().len()
    }

    /// The tokens, without the comment; or the bytes that are no token.
    pub fn tokens(&self) -> Result<Vec<Token<'_>>, (Range<usize>, String)> {
        let mut tokens = Vec::new();
        let mut at = 0;
        while let Some(first) = self.text[at..].chars().next() {
            let rest = &self.text[at..];
            if first == ';' {
                break;
            }
            if first.is_whitespace() {
                at += first.len_utf8();
                continue;
            }
            let (kind, length) = token(rest, first).map_err(|(length, message)| (at..at + length, message))?;
            tokens.push(Token { kind, text: &rest[..length], at });
            at += length;
        }
        Ok(tokens)
    }
}

/// The kind and length of the token at the start of a text; or the length of what is none, and why.
fn token(rest: &str, first: char) -> Result<(Kind, usize), (usize, String)> {
    let length_while = |test: fn(char) -> bool| rest.find(|c| !test(c)).unwrap_or(rest.len());
    match first {
        '"' => match rest[1..].find('"') {
            Some(end) => Ok((Kind::Text, end + 2)),
            None => Err((rest.len(), "the text has no closing quote".to_owned())),
        },
        '.' => {
            let length = 1 + rest[1..].find(|c| !in_name(c)).unwrap_or(rest.len() - 1);
            Ok((Kind::Directive, length))
        }
        '0'..='9' => number(rest),
        _ if in_name(first) => Ok((Kind::Name, length_while(in_name))),
        '<' | '>' if rest[1..].starts_with(first) => Ok((Kind::Sign, 2)),
        ',' | ':' | '[' | ']' | '(' | ')' | '+' | '-' | '*' | '/' | '=' | '&' | '|' | '~' => Ok((Kind::Sign, 1)),
        _ => Err((first.len_utf8(), format!("`{first}` means nothing here"))),
    }
}

fn in_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn number(rest: &str) -> Result<(Kind, usize), (usize, String)> {
    let mut length = 0;
    let mut after_e = false;
    for c in rest.chars() {
        let sign = after_e && (c == '-' || c == '+') && !rest.starts_with("0x");
        if !(in_name(c) || c == '.' || sign) {
            break;
        }
        after_e = c == 'e' || c == 'E';
        length += c.len_utf8();
    }
    let text = rest[..length].replace('_', "");
    let wrong = |what: &str| (length, format!("`{}` is no {what}", &rest[..length]));
    let based = |digits: &str, base, what| i64::from_str_radix(digits, base).map_err(|_| wrong(what));
    let kind = match text.get(..2) {
        Some("0x") => Kind::Integer(based(&text[2..], 16, "hexadecimal number")?),
        Some("0b") => Kind::Integer(based(&text[2..], 2, "binary number")?),
        _ if text.contains(['.', 'e', 'E']) => Kind::Float(text.parse().map_err(|_| wrong("number"))?),
        _ => Kind::Integer(based(&text, 10, "number")?),
    };
    Ok((kind, length))
}
