//! The first pass: files, macros and conditions become lines, and lines become words whose places are known.

use std::ops::Range;
use std::path::Path;

use super::expression::{Reader, Wrong};
use super::line::{Kind, Line, Token};
use super::{Assembler, Macro, Pending, Sources, Word};
use crate::error::InputError;
use crate::input::text::nearest;
use crate::isa::kernels::KERNELS;
use crate::isa::program::{SourceFile, SourceLine};
use crate::isa::register::Register;
use crate::isa::table::{Opcode, TABLE};
use crate::seam::Activity;

/// How deep files, macros and conditions may be nested in each other.
const DEEPEST: usize = 64;

/// The most lines that may be followed, macros expanded: two macros that use each other twice would double them for ever.
const MOST_LINES: usize = 1 << 22;

/// The longest line of an expanded macro, in bytes: arguments that are given on twice double it.
const LONGEST_LINE: usize = 1 << 16;

/// The most words of a program and of its data.
const MOST_WORDS: usize = 1 << 17;

const DIRECTIVES: [&str; 15] = [
    ".code", ".count", ".data", ".else", ".end", ".float", ".if", ".include", ".kernel", ".loaded", ".macro",
    ".option", ".reg", ".space", ".word",
];

impl Assembler {
    /// Follows a file.
    pub fn file(&mut self, path: &Path) -> Result<(), InputError> {
        let text = self.sources.open(path)?;
        let file = self.program.files.len() as u32;
        let lines = text.lines().zip(1..).map(|(text, line)| {
            let place = SourceLine { file, line };
            Line { place, text: text.to_owned(), expanded_from: None }
        });
        let lines: Vec<Line> = lines.collect();
        self.program.files.push(SourceFile { path: path.to_owned(), text });
        self.block(&lines)
    }

    /// Follows lines one after the other; blocks up to their `.end` at once.
    fn block(&mut self, lines: &[Line]) -> Result<(), InputError> {
        let mut next = 0;
        while let Some(line) = lines.get(next) {
            self.followed += 1;
            if self.followed > MOST_LINES {
                let message = format!("files and macros come to more than {MOST_LINES} lines");
                return Err(self.error(line, Wrong::new(line.first_span(), message)));
            }
            match opens_block(line) {
                Some(opener) => {
                    let tokens = self.tokens(line)?;
                    let block = self.find_block(lines, next)?;
                    let (then, otherwise) = (&lines[block.then.clone()], &lines[block.otherwise.clone()]);
                    let mut reader = Reader::new(&tokens);
                    reader.take();
                    let result = match opener {
                        ".if" => reader
                            .expression(&|token| self.value_of(token))
                            .and_then(|value| reader.expect_end().map(|()| Some(value != 0))),
                        _ => self.define_macro(line, &mut reader, then).map(|()| None),
                    };
                    if opener == ".macro" && !block.otherwise.is_empty() {
                        let wrong = Wrong::new(tokens[0].span(), "a macro has no `.else`");
                        return Err(self.error(line, wrong));
                    }
                    let chosen = match result.map_err(|wrong| self.error(line, wrong))? {
                        Some(true) => then,
                        Some(false) => otherwise,
                        None => &[],
                    };
                    self.deeper(line, tokens[0].span(), |this| this.block(chosen))?;
                    next = block.after;
                }
                None => {
                    self.line(line, &self.tokens(line)?)?;
                    next += 1;
                }
            }
        }
        Ok(())
    }

    /// The lines of the block that is opened in line `start`.
    fn find_block(&self, lines: &[Line], start: usize) -> Result<Block, InputError> {
        let mut depth = 0;
        let mut otherwise = None;
        for (index, line) in lines.iter().enumerate().skip(start) {
            match line.first_word() {
                _ if opens_block(line).is_some() => depth += 1,
                ".else" if depth == 1 && otherwise.is_some() => {
                    let wrong = Wrong::new(line.first_span(), "the block has an `.else` already");
                    return Err(self.error(line, wrong));
                }
                ".else" if depth == 1 => otherwise = Some(index),
                ".end" if depth == 1 => {
                    let middle = otherwise.unwrap_or(index);
                    let second = otherwise.map_or(index, |index| index + 1);
                    return Ok(Block { then: start + 1..middle, otherwise: second..index, after: index + 1 });
                }
                ".end" => depth -= 1,
                _ => {}
            }
        }
        let line = &lines[start];
        Err(self.error(line, Wrong::new(line.first_span(), "the block has no `.end`")))
    }

    fn define_macro(&mut self, line: &Line, reader: &mut Reader, lines: &[Line]) -> Result<(), Wrong> {
        let name = reader.expect_name("the macro's name")?;
        if Opcode::named(name.text).is_some() {
            return Err(Wrong::new(name.span(), format!("`{}` is an instruction", name.text)));
        }
        let mut parameters = Vec::new();
        while reader.peek().is_some() {
            if !parameters.is_empty() {
                reader.expect_sign(",")?;
            }
            parameters.push(reader.expect_name("a parameter's name")?.text.to_owned());
        }
        self.define(line, name)?;
        self.macros.insert(name.text.to_owned(), Macro { parameters, lines: lines.to_vec() });
        Ok(())
    }

    /// A line that opens no block.
    fn line(&mut self, line: &Line, tokens: &[Token]) -> Result<(), InputError> {
        let mut rest = tokens;
        while let [label, colon, after @ ..] = rest
            && label.kind == Kind::Name
            && colon.is(":")
        {
            self.label(line, label).map_err(|wrong| self.error(line, wrong))?;
            rest = after;
        }
        let Some(first) = rest.first() else { return Ok(()) };
        let skip = tokens.len() - rest.len() + 1;
        let mut reader = Reader::new(&rest[1..]);
        match first.kind {
            Kind::Directive if first.text == ".include" => return self.include(line, &mut reader),
            Kind::Name if self.macros.contains_key(first.text) => return self.expand(line, first, &rest[1..]),
            Kind::Directive => self.directive(line, first, skip, &mut reader),
            Kind::Name if rest.get(1).is_some_and(|sign| sign.is("=")) => {
                reader.take();
                self.constant(line, first, &mut reader)
            }
            Kind::Name => self.begin_instruction(line, first, skip),
            _ => Err(Reader::new(rest).expected("a label, an instruction or a directive")),
        }
        .map_err(|wrong| self.error(line, wrong))
    }

    /// Notes that a name is taken; fails if it was.
    fn define(&mut self, line: &Line, name: &Token) -> Result<(), Wrong> {
        if Register::named(name.text).is_some() {
            return Err(Wrong::new(name.span(), format!("`{}` is a register", name.text)));
        }
        let place = (self.path(line).to_owned(), line.place.line);
        match self.defined.insert(name.text.to_owned(), place) {
            Some((file, at)) => {
                let message = format!("`{}` is defined already, in line {at} of {}", name.text, file.display());
                Err(Wrong::new(name.span(), message))
            }
            None => Ok(()),
        }
    }

    fn label(&mut self, line: &Line, name: &Token) -> Result<(), Wrong> {
        self.define(line, name)?;
        let (labels, words) = if self.in_data {
            (&mut self.program.data_labels, self.data.len())
        } else {
            (&mut self.program.code_labels, self.instructions.len())
        };
        labels.insert(name.text.to_owned(), words as u32);
        Ok(())
    }

    fn constant(&mut self, line: &Line, name: &Token, reader: &mut Reader) -> Result<(), Wrong> {
        let value = reader.expression(&|token| self.value_of(token))?;
        reader.expect_end()?;
        self.define(line, name)?;
        self.constants.insert(name.text.to_owned(), value);
        Ok(())
    }

    fn begin_instruction(&mut self, line: &Line, mnemonic: &Token, skip: usize) -> Result<(), Wrong> {
        let Some(opcode) = Opcode::named(mnemonic.text) else {
            let wrong = Wrong::new(mnemonic.span(), format!("unknown instruction `{}`", mnemonic.text));
            let known = TABLE.iter().map(|entry| entry.mnemonic).chain(self.macros.keys().map(String::as_str));
            return Err(match nearest(mnemonic.text, known) {
                Some(similar) => wrong.help(format!("did you mean `{similar}`?")),
                None => wrong,
            });
        };
        if self.in_data {
            return Err(Wrong::new(mnemonic.span(), "an instruction cannot stand in the data")
                .help("`.code` goes back to the program"));
        }
        self.check_room(self.instructions.len(), mnemonic)?;
        self.instructions.push(Pending { line: line.clone(), skip, what: Word::Instruction(opcode) });
        self.program.work.push(self.work);
        self.program.lines.push(line.place);
        Ok(())
    }

    fn check_room(&self, words: usize, token: &Token) -> Result<(), Wrong> {
        let full = words >= MOST_WORDS;
        if full {
            Err(Wrong::new(token.span(), format!("there can be no more than {MOST_WORDS} words")))
        } else {
            Ok(())
        }
    }

    fn directive(&mut self, line: &Line, name: &Token, skip: usize, reader: &mut Reader) -> Result<(), Wrong> {
        match name.text {
            ".data" => self.in_data = true,
            ".code" => self.in_data = false,
            ".kernel" => {
                let kernel = reader.expect_name("grid, slabs, intersection or other")?;
                let known = KERNELS.iter().position(|name| *name == kernel.text);
                let unknown = || Wrong::new(kernel.span(), format!("there is no kernel `{}`", kernel.text));
                let help = "there are grid, slabs, intersection and other";
                self.work = Activity(known.ok_or_else(|| unknown().help(help))? as u8);
            }
            ".count" => {
                let event = reader.expect_name("the event's name")?;
                let at = self.instructions.len() as u32;
                self.program.counted.entry(event.text.to_owned()).or_default().push(at);
            }
            ".option" => {
                let name = reader.expect_name("the option's name")?;
                let value = reader.expression(&|token| self.value_of(token))?;
                self.define(line, name)?;
                let value = self.options.get(name.text).copied().unwrap_or(value);
                self.constants.insert(name.text.to_owned(), value);
            }
            ".reg" => {
                let name = reader.expect_name("the register's new name")?;
                let token = reader.expect_name("a register")?;
                let register = self.register(token.text).ok_or_else(|| self.no_register(token))?;
                self.define(line, name)?;
                self.registers.insert(name.text.to_owned(), register);
            }
            ".word" | ".float" | ".space" | ".loaded" => {
                if !self.in_data {
                    let wrong = Wrong::new(name.span(), format!("`{}` stands outside the data", name.text));
                    return Err(wrong.help("`.data` begins it"));
                }
                self.data(line, name, skip, reader)?;
            }
            ".end" | ".else" => {
                return Err(Wrong::new(name.span(), format!("`{}` ends no block", name.text)));
            }
            _ => {
                let wrong = Wrong::new(name.span(), format!("unknown directive `{}`", name.text));
                return Err(match nearest(name.text, DIRECTIVES) {
                    Some(similar) => wrong.help(format!("did you mean `{similar}`?")),
                    None => wrong.help(format!("there are {}", DIRECTIVES.join(", "))),
                });
            }
        }
        reader.expect_end()
    }

    fn data(&mut self, line: &Line, directive: &Token, skip: usize, reader: &mut Reader) -> Result<(), Wrong> {
        if directive.text == ".loaded" {
            let here = self.data.len() as u32;
            let Some((name, _)) = self.program.data_labels.iter().find(|(_, address)| **address == here) else {
                return Err(Wrong::new(directive.span(), "a word that the loader fills in needs a label"));
            };
            self.program.loaded.insert(name.clone(), here);
            return self.push_data(line, 0, Word::Value(0), directive);
        }
        if directive.text == ".space" {
            let start = reader.rest_span();
            let words = reader.expression(&|token| self.value_of(token))?;
            let Some(words) = usize::try_from(words).ok().filter(|&words| words <= MOST_WORDS) else {
                return Err(Wrong::new(start, format!("{words} words cannot be: from 0 to {MOST_WORDS} can")));
            };
            return (0..words).try_for_each(|_| self.push_data(line, 0, Word::Value(0), directive));
        }
        loop {
            if directive.text == ".float" {
                let value = float(reader)?;
                self.push_data(line, 0, Word::Value(value.to_bits()), directive)?;
            } else {
                // Labels may follow later: the expression is read when they are known.
                self.push_data(line, skip + reader.position(), Word::Expression, directive)?;
                reader.skip_to_comma();
            }
            if !reader.take_sign(",") {
                return Ok(());
            }
        }
    }

    fn push_data(&mut self, line: &Line, skip: usize, what: Word, token: &Token) -> Result<(), Wrong> {
        self.check_room(self.data.len(), token)?;
        self.data.push(Pending { line: line.clone(), skip, what });
        Ok(())
    }

    fn include(&mut self, line: &Line, reader: &mut Reader) -> Result<(), InputError> {
        let name = match reader.peek() {
            Some(token) if token.kind == Kind::Text => token,
            _ => return Err(self.error(line, reader.expected("a file's name in quotes"))),
        };
        reader.take();
        reader.expect_end().map_err(|wrong| self.error(line, wrong))?;
        let path = Sources::place(self.path(line), name.text.trim_matches('"'));
        self.deeper(line, name.span(), |this| {
            // A file that cannot be read is a mistake of the line that names it.
            if let Err(error) = this.sources.open(&path) {
                return Err(this.error(line, Wrong::new(name.span(), error.message)));
            }
            this.file(&path)
        })
    }

    fn expand(&mut self, line: &Line, name: &Token, rest: &[Token]) -> Result<(), InputError> {
        let Macro { parameters, lines } = self.macros[name.text].clone();
        let arguments = arguments(line, rest);
        if arguments.len() != parameters.len() {
            let message = format!("`{}` takes {} arguments, not {}", name.text, parameters.len(), arguments.len());
            let help = format!("{} {}", name.text, parameters.join(", "));
            return Err(self.error(line, Wrong::new(name.span(), message).help(help)));
        }
        let put_in = |text: &str| {
            let replace = |text: String, (parameter, argument): (&String, &&str)| {
                text.replace(&format!("{{{parameter}}}"), argument)
            };
            parameters.iter().zip(&arguments).fold(text.to_owned(), replace)
        };
        let expanded: Vec<Line> = lines
            .iter()
            .map(|line| Line { place: line.place, text: put_in(&line.text), expanded_from: Some(name.text.to_owned()) })
            .collect();
        if expanded.iter().any(|line| line.text.len() > LONGEST_LINE) {
            let message = format!("`{}` expands to a line of more than {LONGEST_LINE} bytes", name.text);
            return Err(self.error(line, Wrong::new(name.span(), message)));
        }
        self.deeper(line, name.span(), |this| this.block(&expanded))
    }

    /// Follows something that the line names, unless that has gone too deep.
    fn deeper(
        &mut self,
        line: &Line,
        span: Range<usize>,
        follow: impl FnOnce(&mut Self) -> Result<(), InputError>,
    ) -> Result<(), InputError> {
        if self.depth >= DEEPEST {
            let message = format!(
                "files, macros and conditions are nested more than {DEEPEST} deep; does a file or a macro name itself?"
            );
            return Err(self.error(line, Wrong::new(span, message)));
        }
        self.depth += 1;
        let result = follow(self);
        self.depth -= 1;
        result
    }
}

/// The lines of a block: those up to `.else`, those behind it, and what follows `.end`.
struct Block {
    then: Range<usize>,
    otherwise: Range<usize>,
    after: usize,
}

/// The directive that opens a block, if the line does.
fn opens_block(line: &Line) -> Option<&'static str> {
    [".if", ".macro"].into_iter().find(|opener| line.first_word() == *opener)
}

/// The texts between commas.
fn arguments<'l>(line: &'l Line, tokens: &[Token]) -> Vec<&'l str> {
    let between = |part: &[Token]| match part {
        [] => "",
        [first, .., last] => &line.text[first.at..last.span().end],
        [only] => &line.text[only.span()],
    };
    if tokens.is_empty() { Vec::new() } else { tokens.split(|token| token.is(",")).map(between).collect() }
}

fn float(reader: &mut Reader) -> Result<f32, Wrong> {
    let negative = reader.take_sign("-");
    let value = match reader.peek() {
        Some(Token { kind: Kind::Float(value), .. }) => *value,
        Some(Token { kind: Kind::Integer(value), .. }) => *value as f32,
        Some(token) if token.text == "inf" => f32::INFINITY,
        _ => return Err(reader.expected("a number")),
    };
    reader.take();
    Ok(if negative { -value } else { value })
}
