//! The activity trace: one line per ray and cell with what the cell did, `ray cell op op ...`.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};

use crate::error::InputError;
use crate::machine::{Op, OpBatch, OpKind, OpStream};
use crate::program::ArrayProgram;

/// Lines that a batch of a replay has at the most.
const BATCH_LINES: usize = 4096;

/// The longest line that is read, in bytes: far more than any ray makes.
const LONGEST_LINE: u64 = 1 << 24;

/// Writes the comment that heads a trace.
pub fn write_header(out: &mut impl Write, cells: usize) -> std::io::Result<()> {
    writeln!(out, "# pcs-sim activity trace of {cells} cells: ray cell op op ...")
}

/// Writes a batch: for each ray the host's line, then the cells' from left to right.
pub fn write_batch(out: &mut impl Write, batch: &OpBatch) -> std::io::Result<()> {
    let mut cells: Vec<_> = batch.cells.iter().map(OpStream::lines).collect();
    let mut line = Vec::new();
    for (ray, ops) in batch.host.lines() {
        write_line(&mut line, ray, "host", ops)?;
        for (index, lines) in cells.iter_mut().enumerate() {
            if let Some((ray, ops)) = lines.next() {
                write_line(&mut line, ray, index, ops)?;
            }
        }
        out.write_all(&line)?;
        line.clear();
    }
    Ok(())
}

fn write_line(line: &mut Vec<u8>, ray: u32, cell: impl std::fmt::Display, ops: &[Op]) -> std::io::Result<()> {
    write!(line, "{ray} {cell}")?;
    for op in ops {
        line.push(b' ');
        line.push(op.kind().letter() as u8);
        write_number(line, op.count());
    }
    line.push(b'\n');
    Ok(())
}

/// Decimal digits; several times as fast as the formatting machinery, which would take longer than the run.
fn write_number(line: &mut Vec<u8>, mut number: u32) {
    let start = line.len();
    loop {
        line.push(b'0' + (number % 10) as u8);
        number /= 10;
        if number == 0 {
            break;
        }
    }
    line[start..].reverse();
}

/// A trace file that has been read through once, and found well formed.
#[derive(Debug)]
pub struct ActivityTrace {
    path: PathBuf,
    file: File,
    cells: usize,
    rays: u64,
    /// The place of each ray among the host's lines.
    order: HashMap<u32, u64>,
}

/// Who did what a line tells.
#[derive(Clone, Copy, PartialEq)]
enum Actor {
    Host,
    Cell(usize),
}

impl ActivityTrace {
    /// Opens a trace and checks every line of it.
    pub fn open(path: &Path) -> Result<ActivityTrace, InputError> {
        let unreadable = |error: std::io::Error| InputError::unreadable(path, &error);
        let file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Err(InputError::in_file(path, "cannot read the file: it is a directory"));
        }
        let mut trace = ActivityTrace { path: path.to_owned(), file, cells: 0, rays: 0, order: HashMap::new() };
        trace.survey()?;
        Ok(trace)
    }

    /// Number of cells: one more than the highest that has a line.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Number of rays: of the host's lines.
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// Reads the trace from its start and hands it on in batches.
    pub fn for_each_batch<E: From<InputError>>(
        &mut self,
        mut take: impl FnMut(OpBatch) -> Result<(), E>,
    ) -> Result<(), E> {
        let order = std::mem::take(&mut self.order);
        let mut batch = OpBatch::new(self.cells);
        let mut lines = 0;
        let result = self.for_each_line(|line| {
            let stream = match line.actor()? {
                Actor::Host => &mut batch.host,
                Actor::Cell(index) => &mut batch.cells[index],
            };
            line.push_to(stream, &order)?;
            lines += 1;
            if lines % BATCH_LINES == 0 {
                let cells = batch.cells.len();
                take(std::mem::replace(&mut batch, OpBatch::new(cells)))?;
            }
            Ok::<(), E>(())
        });
        self.order = order;
        result?;
        take(batch)
    }

    /// Counts cells and rays, and checks every line.
    fn survey(&mut self) -> Result<(), InputError> {
        let (mut cells, mut order, mut awaited) = (0, HashMap::new(), Vec::new());
        // The last of the cells that write rays themselves or read from the right, and the line.
        let mut writes_x: Option<(usize, usize)> = None;
        let mut reads_z: Option<(usize, usize)> = None;
        let mut rays = 0;
        self.for_each_line(|line| {
            let ray = line.ray()?;
            match line.actor()? {
                Actor::Host => {
                    if order.insert(ray, rays).is_some() {
                        return Err(line.error(line.words[0], format!("the host has two lines for ray {ray}")));
                    }
                    rays += 1;
                    let awaits = line.ops().filter_map(|op| op.ok()).filter(|op| op.0 == OpKind::Await);
                    awaited.extend(awaits.map(|(_, ray)| (ray, line.number)));
                    line.ops().try_for_each(|op| op.map(drop))
                }
                Actor::Cell(index) => {
                    cells = cells.max(index + 1);
                    line.ops().try_for_each(|op| {
                        let (kind, _) = op?;
                        let here = |asked: OpKind| (kind == asked).then_some((index, line.number));
                        writes_x = writes_x.max(here(OpKind::WriteX));
                        reads_z = reads_z.max(here(OpKind::ReadZ));
                        match here(OpKind::WriteZ) {
                            Some((0, _)) => {
                                Err(line.error(line.words[1], "cell 0 writes to Z, which has nobody to read it"))
                            }
                            _ => Ok(()),
                        }
                    })
                }
            }
        })?;
        let sent = |ray: &u64| u32::try_from(*ray).is_ok_and(|ray| order.contains_key(&ray));
        if let Some((ray, line)) = awaited.iter().find(|(ray, _)| !sent(ray)) {
            let message = format!("line {line}: the host waits for ray {ray}, which it never sends");
            return Err(InputError::in_file(&self.path, message));
        }
        if let Some((_, line)) = writes_x.filter(|(cell, _)| cell + 1 == cells) {
            let message = format!("line {line}: the last cell writes to X, which has nobody to read it");
            return Err(InputError::in_file(&self.path, message));
        }
        if let Some((_, line)) = reads_z.filter(|(cell, _)| cell + 1 == cells) {
            let message = format!("line {line}: the last cell reads from Z, to which nobody writes");
            return Err(InputError::in_file(&self.path, message));
        }
        if cells == 0 || rays == 0 {
            let what = if rays == 0 { "the host" } else { "a cell" };
            return Err(InputError::in_file(
                &self.path,
                format!("the file is no activity trace: it has no line of {what}"),
            ));
        }
        (self.cells, self.rays, self.order) = (cells, rays, order);
        Ok(())
    }

    /// Calls `visit` for every line that is neither empty nor a comment.
    fn for_each_line<E: From<InputError>>(
        &mut self,
        mut visit: impl FnMut(Line<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let path = &self.path;
        let unreadable = |error: std::io::Error| InputError::unreadable(path, &error);
        self.file.rewind().map_err(unreadable)?;
        let mut reader = BufReader::with_capacity(1 << 16, &self.file);
        let (mut bytes, mut number) = (Vec::new(), 0);
        loop {
            bytes.clear();
            number += 1;
            if reader.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut bytes).map_err(unreadable)? == 0 {
                return Ok(());
            }
            if bytes.len() as u64 == LONGEST_LINE {
                let message = format!("line {number} is longer than any ray's can be: {LONGEST_LINE} bytes");
                return Err(InputError::in_file(path, message).into());
            }
            let not_text = |_| InputError::in_file(path, format!("line {number} is no text"));
            let text = std::str::from_utf8(&bytes).map_err(not_text)?.trim_end();
            if text.trim_start().is_empty() || text.trim_start().starts_with('#') {
                continue;
            }
            visit(Line::new(path, number, text))?;
        }
    }
}

/// One line of a trace.
struct Line<'a> {
    path: &'a Path,
    number: usize,
    text: &'a str,
    /// Ray and cell, if they are there, or "".
    words: [&'a str; 2],
    rest: &'a str,
}

impl<'a> Line<'a> {
    fn new(path: &'a Path, number: usize, text: &'a str) -> Line<'a> {
        let (ray, rest) = split_word(text);
        let (cell, rest) = split_word(rest);
        Line { path, number, text, words: [ray, cell], rest }
    }

    fn ray(&self) -> Result<u32, InputError> {
        let word = self.words[0];
        word.parse().map_err(|_| self.error(word, "expected a ray's number at the start of the line"))
    }

    fn actor(&self) -> Result<Actor, InputError> {
        let word = self.words[1];
        if word == "host" {
            return Ok(Actor::Host);
        }
        match word.parse() {
            Ok(index) if index < ArrayProgram::MOST_CELLS => Ok(Actor::Cell(index)),
            Ok(_) => Err(self.error(word, format!("there can be no more than {} cells", ArrayProgram::MOST_CELLS))),
            Err(_) => Err(self.error(word, "expected a cell's number or 'host'")),
        }
    }

    /// The ops, each as its kind and its count.
    fn ops(&self) -> impl Iterator<Item = Result<(OpKind, u64), InputError>> + '_ {
        let host = self.words[1] == "host";
        let mut rest = self.rest;
        std::iter::from_fn(move || {
            let (word, after) = split_word(rest);
            rest = after;
            (!word.is_empty()).then(|| self.op(word, host))
        })
    }

    fn op(&self, word: &'a str, host: bool) -> Result<(OpKind, u64), InputError> {
        let letter = word.chars().next().unwrap_or(' ');
        let kind = OpKind::from_letter(letter);
        let allowed = |kind: &OpKind| match kind {
            OpKind::Await => host,
            OpKind::WriteX => true,
            OpKind::Compute(work) => !host || *work == crate::machine::Work::Other,
            _ => !host,
        };
        let Some(kind) = kind.filter(allowed) else {
            let (who, ops) =
                if host { ("the host", "w, a and c") } else { ("a cell", "x, g, s, n, c, i, o, r, w, b and z") };
            return Err(self.error(word, format!("'{word}' is no op of {who}, whose ops are {ops}")));
        };
        let digits = &word[letter.len_utf8()..];
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(self.error(word, format!("expected a whole number after '{letter}'")));
        }
        match digits.parse() {
            Ok(count) if count <= MOST_OF_AN_OP => Ok((kind, count)),
            _ => Err(self.error(word, format!("no op may count more than {MOST_OF_AN_OP}"))),
        }
    }

    /// Adds the line to a stream; waits for a ray become waits for the message in the ray's place.
    fn push_to(&self, stream: &mut OpStream, order: &HashMap<u32, u64>) -> Result<(), InputError> {
        for op in self.ops() {
            let (kind, count) = op?;
            let count = match kind {
                OpKind::Await => u32::try_from(count).ok().and_then(|ray| order.get(&ray).copied()).unwrap_or(count),
                _ => count,
            };
            stream.push(kind, count);
        }
        stream.end_line(self.ray()?);
        Ok(())
    }

    /// An error at a word of the line.
    fn error(&self, word: &str, message: impl Into<String>) -> InputError {
        let offset = (word.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize).min(self.text.len());
        let column = 1 + self.text.get(..offset).map_or(0, |before| before.chars().count());
        InputError::in_line(self.path, self.text, self.number, column, word.chars().count(), message)
    }
}

/// The longest op of a trace, in cycles or words.
const MOST_OF_AN_OP: u64 = Op::MAX_COUNT as u64;

fn split_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    text.split_at(text.find(char::is_whitespace).unwrap_or(text.len()))
}
