//! Expressions of constants and labels.

use std::ops::Range;

use super::line::{Kind, Token};

/// What is wrong with some bytes of the line, and what could be done.
#[derive(Debug)]
pub(super) struct Wrong {
    pub span: Range<usize>,
    pub message: String,
    pub help: Option<String>,
}

impl Wrong {
    pub fn new(span: Range<usize>, message: impl Into<String>) -> Wrong {
        Wrong { span, message: message.into(), help: None }
    }

    pub fn help(self, help: impl Into<String>) -> Wrong {
        Wrong { help: Some(help.into()), ..self }
    }
}

/// How deep parentheses and signs may be nested.
const DEEPEST: usize = 64;

/// Reads tokens of a line one after the other.
pub(super) struct Reader<'t, 'a> {
    tokens: &'t [Token<'a>],
    next: usize,
    /// Where the line's last token ends.
    end: usize,
    depth: usize,
}

impl<'t, 'a> Reader<'t, 'a> {
    pub fn new(tokens: &'t [Token<'a>]) -> Reader<'t, 'a> {
        Reader { tokens, next: 0, end: tokens.last().map_or(0, |token| token.span().end), depth: 0 }
    }

    pub fn peek(&self) -> Option<&'t Token<'a>> {
        self.tokens.get(self.next)
    }

    pub fn take(&mut self) -> Option<&'t Token<'a>> {
        let token = self.tokens.get(self.next);
        self.next += 1;
        token
    }

    /// Takes a sign if it comes next.
    pub fn take_sign(&mut self, sign: &str) -> bool {
        let found = self.peek().is_some_and(|token| token.is(sign));
        self.next += found as usize;
        found
    }

    pub fn expect_sign(&mut self, sign: &str) -> Result<(), Wrong> {
        if self.take_sign(sign) { Ok(()) } else { Err(self.expected(&format!("`{sign}`"))) }
    }

    /// Takes a name.
    pub fn expect_name(&mut self, what: &str) -> Result<&'t Token<'a>, Wrong> {
        match self.peek() {
            Some(token) if token.kind == Kind::Name => {
                self.next += 1;
                Ok(token)
            }
            _ => Err(self.expected(what)),
        }
    }

    /// What should come next does not.
    pub fn expected(&self, what: &str) -> Wrong {
        match self.peek() {
            Some(token) => Wrong::new(token.span(), format!("expected {what}, found `{}`", token.text)),
            None => Wrong::new(self.end..self.end, format!("expected {what} here")),
        }
    }

    pub fn expect_end(&self) -> Result<(), Wrong> {
        match self.peek() {
            Some(token) => Err(Wrong::new(token.span(), format!("`{}` is too much here", token.text))),
            None => Ok(()),
        }
    }

    /// How many tokens have been read.
    pub fn position(&self) -> usize {
        self.next
    }

    /// Passes over what stands before the next comma.
    pub fn skip_to_comma(&mut self) {
        self.next = (self.next..self.tokens.len()).find(|&at| self.tokens[at].is(",")).unwrap_or(self.tokens.len());
    }

    /// Bytes from the next token to the end.
    pub fn rest_span(&self) -> Range<usize> {
        let start = self.peek().map_or(self.end, |token| token.at);
        start..self.end
    }

    /// The value of the expression that comes next; `value_of` knows the names.
    pub fn expression(&mut self, value_of: &impl Fn(&Token) -> Result<i64, Wrong>) -> Result<i64, Wrong> {
        self.binary(0, value_of)
    }

    /// Operators by how loosely they bind: `|`, `&`, shifts, sums, products.
    fn binary(&mut self, level: usize, value_of: &impl Fn(&Token) -> Result<i64, Wrong>) -> Result<i64, Wrong> {
        const LEVELS: [&[&str]; 5] = [&["|"], &["&"], &["<<", ">>"], &["+", "-"], &["*", "/"]];
        let Some(operators) = LEVELS.get(level) else { return self.unary(value_of) };
        let mut value = self.binary(level + 1, value_of)?;
        while let Some(operator) = self.peek().filter(|token| operators.iter().any(|sign| token.is(sign))) {
            self.next += 1;
            let right = self.binary(level + 1, value_of)?;
            let result = match operator.text {
                "|" => Some(value | right),
                "&" => Some(value & right),
                "<<" => u32::try_from(right).ok().filter(|bits| *bits < 32).map(|bits| value << bits),
                ">>" => u32::try_from(right).ok().filter(|bits| *bits < 64).map(|bits| value >> bits),
                "+" => value.checked_add(right),
                "-" => value.checked_sub(right),
                "*" => value.checked_mul(right),
                _ => value.checked_div(right),
            };
            value = result.ok_or_else(|| {
                Wrong::new(operator.span(), format!("{value} {} {right} has no value", operator.text))
            })?;
        }
        Ok(value)
    }

    fn unary(&mut self, value_of: &impl Fn(&Token) -> Result<i64, Wrong>) -> Result<i64, Wrong> {
        let Some(token) = self.take() else {
            self.next -= 1;
            return Err(self.expected("a value"));
        };
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(Wrong::new(token.span(), "the expression is nested too deeply"));
        }
        let value = match (&token.kind, token.text) {
            (Kind::Integer(value), _) => Ok(*value),
            (Kind::Name, _) => value_of(token),
            (Kind::Sign, "-") => self.unary(value_of).map(i64::wrapping_neg),
            (Kind::Sign, "~") => self.unary(value_of).map(|value| !value),
            (Kind::Sign, "(") => {
                let value = self.binary(0, value_of)?;
                self.expect_sign(")").map(|()| value)
            }
            (Kind::Float(_), text) => Err(Wrong::new(token.span(), format!("{text} is no integer"))
                .help("floating-point numbers stand in `.float`, in the data")),
            _ => {
                self.next -= 1;
                Err(self.expected("a value"))
            }
        };
        self.depth -= 1;
        value
    }
}
