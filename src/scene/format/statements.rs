//! The lines of OBJ and MTL files.

use crate::input::text::{Text, Token};

/// Goes through the statements of a file: lines, joined where a backslash ends one, without comments.
pub(crate) struct Statements<'a> {
    text: Text<'a>,
    rest: &'a str,
    /// Where the lines begin that a backslash has joined to the statement, as numbers of its tokens.
    joined: Vec<usize>,
}

impl<'a> Statements<'a> {
    pub fn new(text: Text<'a>) -> Self {
        Statements { text, rest: text.text, joined: Vec::new() }
    }

    /// Puts the tokens of the next statement that is not empty into `tokens`; false at the end of the file.
    pub fn next_into(&mut self, tokens: &mut Vec<Token<'a>>) -> bool {
        tokens.clear();
        while tokens.is_empty() && !self.rest.is_empty() {
            self.joined.clear();
            while self.line_into(tokens) {
                self.joined.push(tokens.len());
            }
        }
        !tokens.is_empty()
    }

    /// A word at the start of a joined line that is one of `keywords`: the line may have been meant for a statement of
    /// its own, and the backslash before it for a part of a name.
    pub fn swallowed(&self, tokens: &[Token<'a>], keywords: impl Fn(&str) -> bool) -> Option<Token<'a>> {
        let starts = self.joined.iter().filter_map(|&start| tokens.get(start));
        starts.copied().find(|token| keywords(token.text))
    }

    /// Adds the tokens of one line; true if the statement goes on in the next one.
    fn line_into(&mut self, tokens: &mut Vec<Token<'a>>) -> bool {
        let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
        self.rest = rest;
        let line = line.trim_end();
        let (line, goes_on) = match line.strip_suffix('\\') {
            Some(line) => (line, true),
            None => (line, false),
        };
        for token in self.text.tokens(line) {
            // Only at the start of a word: names such as `wood#2` are common.
            if token.text.starts_with('#') {
                return false;
            }
            tokens.push(token);
        }
        goes_on
    }
}

/// The text from one token's start to another's end: a name that may contain spaces.
pub(crate) fn name_of<'a>(text: Text<'a>, arguments: &[Token<'a>]) -> &'a str {
    match (arguments.first(), arguments.last()) {
        (Some(first), Some(last)) => text.text.get(first.at..last.span().end).unwrap_or(""),
        _ => "",
    }
}
