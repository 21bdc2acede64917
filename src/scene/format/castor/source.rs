//! The words of a Castor file, behind C's preprocessor: comments, `#include "FILE"` and `#define NAME WORDS`.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

use super::super::read_file;
use crate::error::InputError;
use crate::input::text::{self, Text};

/// How deep files may include each other.
const DEEPEST: usize = 16;

/// Most words of a file with all that it includes and that its definitions stand for.
const MOST_WORDS: usize = 10_000_000;

/// A word of a file.
#[derive(Clone, Debug)]
pub struct Token {
    pub text: String,
    /// The file, counted as they were opened, and the bytes from its start.
    file: usize,
    at: usize,
    length: usize,
}

impl Token {
    /// Whether it begins with a letter.
    pub fn is_name(&self) -> bool {
        self.text.starts_with(|first: char| first.is_alphabetic() || first == '_')
    }
}

/// All words, and the files that they stand in.
#[derive(Default)]
pub struct Source {
    tokens: Vec<Token>,
    files: Vec<(PathBuf, String)>,
    definitions: HashMap<String, Vec<Token>>,
    /// How many words there are, those of definitions among them.
    words: usize,
}

/// Reads a file and what it includes.
pub fn read(path: &Path) -> Result<Source, InputError> {
    let mut source = Source::default();
    let folder = path.parent().unwrap_or(Path::new(""));
    source.file(path, folder, 0)?;
    Ok(source)
}

impl Source {
    /// A word by its number.
    pub fn get(&self, at: usize) -> Option<&Token> {
        self.tokens.get(at)
    }

    /// A mistake at a word.
    pub fn error(&self, token: &Token, message: impl Into<String>) -> InputError {
        let (file, text) = &self.files[token.file];
        Text { file, text }.error(token.at..token.at + token.length, message)
    }

    /// A mistake at the end of the first file.
    pub fn ended(&self, message: String) -> InputError {
        let (file, text) = &self.files[0];
        let text = Text { file, text };
        text.error(text.end(), message)
    }

    fn file(&mut self, path: &Path, folder: &Path, depth: usize) -> Result<(), InputError> {
        let whole = text::decode(read_file(path)?);
        let number = self.files.len();
        let bare = without_comments(&whole);
        self.files.push((path.to_owned(), whole));
        let mut at = 0;
        for line in bare.split_inclusive('\n') {
            let start = line.len() - line.trim_start().len();
            match line.trim_start().strip_prefix('#') {
                Some(directive) => self.directive(directive, (number, at + start), folder, depth)?,
                None => {
                    for token in tokens(line, number, at) {
                        self.push(token)?;
                    }
                }
            }
            at += line.len();
        }
        Ok(())
    }

    /// Adds a word, or what it is defined to be.
    fn push(&mut self, token: Token) -> Result<(), InputError> {
        let words = self.meant(token)?;
        self.tokens.extend(words);
        Ok(())
    }

    /// What a word stands for: itself, or what it is defined to be. Words are seen where the name stands, not where it was defined.
    fn meant(&mut self, token: Token) -> Result<Vec<Token>, InputError> {
        let words = match self.definitions.get(&token.text) {
            Some(words) => words.iter().map(|word| Token { text: word.text.clone(), ..token.clone() }).collect(),
            None => vec![token.clone()],
        };
        self.words += words.len();
        if self.words > MOST_WORDS {
            return Err(self.error(&token, format!("the file has more than {MOST_WORDS} words, with its definitions")));
        }
        Ok(words)
    }

    fn directive(
        &mut self,
        text: &str,
        (file, at): (usize, usize),
        folder: &Path,
        depth: usize,
    ) -> Result<(), InputError> {
        let whole = Token { text: text.to_owned(), file, at, length: text.trim_end().len() + 1 };
        let (word, rest) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
        match word {
            "include" => self.include(&whole, rest.trim(), folder, depth),
            "define" => {
                let mut words = tokens(rest, file, at).into_iter();
                let Some(name) = words.next().filter(Token::is_name) else {
                    return Err(self.error(&whole, "`#define` needs a name"));
                };
                // What is defined already stands for itself in later definitions.
                let mut meaning = Vec::new();
                for word in words {
                    meaning.extend(self.meant(word)?);
                }
                self.definitions.insert(name.text, meaning);
                Ok(())
            }
            _ => Err(self
                .error(&whole, format!("`#{word}` is not read"))
                .help("there are #include \"FILE\" and #define NAME WORDS")),
        }
    }

    fn include(&mut self, whole: &Token, name: &str, folder: &Path, depth: usize) -> Result<(), InputError> {
        let Some(name) = name.strip_prefix('"').and_then(|name| name.strip_suffix('"')) else {
            return Err(self.error(whole, "`#include` needs a file's name in quotes"));
        };
        let inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if !inside {
            return Err(self.error(whole, format!("`{name}` is outside the file's folder")));
        }
        if depth >= DEEPEST {
            return Err(self.error(whole, "files include each other too deep, or in a circle"));
        }
        let path = folder.join(name);
        if !path.is_file() {
            return Err(self.error(whole, format!("file `{name}` was not found beside the scene file")));
        }
        self.file(&path, folder, depth + 1)
    }
}

/// The text with blanks where comments stand, so that all else keeps its place.
fn without_comments(text: &str) -> String {
    let mut bare = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find("/*").into_iter().chain(rest.find("//")).min() {
        bare.push_str(&rest[..start]);
        let comment = &rest[start..];
        let end = match comment.starts_with("/*") {
            true => comment[2..].find("*/").map_or(comment.len(), |end| end + 4),
            false => comment.find('\n').unwrap_or(comment.len()),
        };
        bare.extend(comment[..end].bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
        rest = &comment[end..];
    }
    bare.push_str(rest);
    bare
}

/// The words of a line: names, numbers, and signs of one character.
fn tokens(line: &str, file: usize, from: usize) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut rest = line.char_indices().peekable();
    while let Some((start, first)) = rest.next() {
        if first.is_whitespace() {
            continue;
        }
        let is_number = first.is_ascii_digit() || first == '.';
        let mut end = start + first.len_utf8();
        if is_number || first.is_alphabetic() || first == '_' {
            let mut before = first;
            while let Some(&(at, next)) = rest.peek() {
                let exponent = is_number && matches!(before, 'e' | 'E') && matches!(next, '+' | '-');
                if !(next.is_alphanumeric() || next == '_' || (is_number && next == '.') || exponent) {
                    break;
                }
                end = at + next.len_utf8();
                before = next;
                rest.next();
            }
        }
        tokens.push(Token { text: line[start..end].to_owned(), file, at: from + start, length: end - start });
    }
    tokens
}
