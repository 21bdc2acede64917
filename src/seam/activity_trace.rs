//! The activity trace: one line per job and station with what the station did, `job cell op op ...`.
//!
//! In its form of units it begins with `pcs-sim trace 2 cells N answer WORDS` and a line `unit CODE NAME ACTIVITY CYCLES`
//! for each unit of work, with what that cost when the trace was recorded; ops that work are a unit's code and a count. In
//! its form of cycles it has no heading: work is an activity's letter and cycles, which no machine prices again.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{Activity, Costs, MOST_CELLS, Op, OpBatch, OpKind, OpStream, Unit, UnitOfWork, Vocabulary};
use crate::error::InputError;
use crate::quantities::Cycles;

/// Lines that a batch of a replay has at the most.
const BATCH_LINES: usize = 4096;

/// The longest line that is read, in bytes: far more than any job makes.
const LONGEST_LINE: u64 = 1 << 24;

/// What an activity trace counts work in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Units of work, which any machine prices: `gv12`.
    #[default]
    Units,
    /// Cycles of the machine that it was recorded for: `g1872`.
    Cycles,
}

/// Writes what a run does as an activity trace.
#[derive(Debug)]
pub struct TraceWriter<W> {
    out: W,
    form: Form,
    costs: Costs,
    line: Vec<u8>,
}

impl<W: Write> TraceWriter<W> {
    /// Begins a trace of `cells` cells whose units cost what `costs` say.
    pub fn new(mut out: W, cells: usize, costs: Costs, form: Form) -> std::io::Result<TraceWriter<W>> {
        match form {
            Form::Units => write_heading(&mut out, cells, &costs)?,
            Form::Cycles => writeln!(out, "# pcs-sim activity trace of {cells} cells: ray cell op op ...")?,
        }
        Ok(TraceWriter { out, form, costs, line: Vec::new() })
    }

    /// Writes a batch: for each job the host's line, then the cells' from left to right.
    pub fn write(&mut self, batch: &OpBatch) -> std::io::Result<()> {
        let mut cells: Vec<_> = batch.cells.iter().map(OpStream::lines).collect();
        for (job, ops) in batch.host.lines() {
            self.line.clear();
            self.add_line(job, "host", ops)?;
            for (index, lines) in cells.iter_mut().enumerate() {
                if let Some((job, ops)) = lines.next() {
                    self.add_line(job, index, ops)?;
                }
            }
            self.out.write_all(&self.line)?;
        }
        Ok(())
    }

    /// Gives back where it was written.
    pub fn into_inner(self) -> W {
        self.out
    }

    fn add_line(&mut self, job: u32, cell: impl std::fmt::Display, ops: &[Op]) -> std::io::Result<()> {
        write!(self.line, "{job} {cell}")?;
        match self.form {
            Form::Units => ops.iter().for_each(|op| self.add_op(*op)),
            Form::Cycles => self.add_priced(ops),
        }
        self.line.push(b'\n');
        Ok(())
    }

    fn add_op(&mut self, op: Op) {
        let TraceWriter { line, costs, .. } = self;
        line.push(b' ');
        match op.kind() {
            OpKind::Work(unit) => {
                let unit = costs.vocabulary().unit(unit);
                line.extend_from_slice(unit.map_or("?", |unit| unit.code.as_str()).as_bytes());
            }
            moves => line.push(moves.letter().unwrap_or('?') as u8),
        }
        add_number(line, op.count() as u64);
    }

    /// Adds ops in cycles: those of one activity, one after the other, are one.
    fn add_priced(&mut self, ops: &[Op]) {
        let mut works: Option<(u8, u64)> = None;
        for op in ops {
            match op.unit() {
                Some(unit) => {
                    let letter = self.letter(unit);
                    let cycles = op.count() as u64 * self.costs.of(unit).0;
                    match &mut works {
                        Some((same, sum)) if *same == letter => *sum += cycles,
                        _ => self.add_work(works.replace((letter, cycles))),
                    }
                }
                None => {
                    self.add_work(works.take());
                    self.add_op(*op);
                }
            }
        }
        self.add_work(works);
    }

    fn add_work(&mut self, works: Option<(u8, u64)>) {
        let Some((letter, mut cycles)) = works else { return };
        while cycles > 0 {
            let part = cycles.min(MOST_OF_AN_OP);
            self.line.extend([b' ', letter]);
            add_number(&mut self.line, part);
            cycles -= part;
        }
    }

    /// The letter of what a unit belongs to.
    fn letter(&self, unit: Unit) -> u8 {
        let activity = self.costs.activity(unit).0 as usize;
        self.costs.vocabulary().activities.get(activity).map_or(b'?', |(letter, _)| *letter as u8)
    }
}

fn write_heading(out: &mut impl Write, cells: usize, costs: &Costs) -> std::io::Result<()> {
    let vocabulary = costs.vocabulary();
    writeln!(out, "{MAGIC} cells {cells} answer {}", vocabulary.answer_words)?;
    for (place, UnitOfWork { code, name, activity }) in vocabulary.units.iter().enumerate() {
        let activity = vocabulary.activities.get(activity.0 as usize).map_or("?", |(_, name)| name.as_str());
        writeln!(out, "unit {code} {name} {activity} {}", costs.of(Unit(place as u8)).0)?;
    }
    Ok(())
}

/// How the heading of a trace in units begins.
const MAGIC: &str = "pcs-sim trace 2";

/// Decimal digits; several times as fast as the formatting machinery, which would take longer than the run.
fn add_number(line: &mut Vec<u8>, mut number: u64) {
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
    form: Form,
    costs: Costs,
    cells: usize,
    jobs: u64,
    /// The place of each job among the host's lines.
    order: HashMap<u32, u64>,
}

/// Who did what a line tells.
#[derive(Clone, Copy, PartialEq)]
enum Actor {
    Host,
    Cell(usize),
}

impl ActivityTrace {
    /// Opens a trace and checks every line of it. `cycles` is the vocabulary of a trace that counts in cycles.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, or some line is none of a trace: with the line and the column.
    pub fn open(path: &Path, cycles: &Arc<Vocabulary>) -> Result<ActivityTrace, InputError> {
        let unreadable = |error: std::io::Error| InputError::unreadable(path, &error);
        let file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Err(InputError::in_file(path, "cannot read the file: it is a directory"));
        }
        let costs = Costs::new(Arc::clone(cycles), |_| Cycles(1));
        let (form, order) = (Form::Cycles, HashMap::new());
        let mut trace = ActivityTrace { path: path.to_owned(), file, form, costs, cells: 0, jobs: 0, order };
        trace.survey()?;
        Ok(trace)
    }

    /// What it counts work in.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Its units, and what they cost when it was recorded.
    pub fn costs(&self) -> &Costs {
        &self.costs
    }

    /// Number of cells: one more than the highest that has a line.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Number of jobs: of the host's lines.
    pub fn jobs(&self) -> u64 {
        self.jobs
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

    /// Counts cells and jobs, and checks every line.
    fn survey(&mut self) -> Result<(), InputError> {
        self.read_heading()?;
        let mut survey = Survey::default();
        self.for_each_line(|line| survey.take(&line))?;
        survey.check(&self.path)?;
        (self.cells, self.jobs, self.order) = (survey.cells, survey.jobs, survey.order);
        Ok(())
    }

    /// Reads the heading of a trace in units, if it has one.
    fn read_heading(&mut self) -> Result<(), InputError> {
        let mut heading: Option<Heading> = None;
        let path = self.path.clone();
        let read = lines(&path, &self.file, |number, text| {
            let line = Line { path: &path, number, text, words: ["", ""], rest: text, vocabulary: None };
            match &mut heading {
                None if text.starts_with(MAGIC) => heading = Some(Heading::begin(&line)?),
                Some(heading) if text.starts_with("unit ") => heading.add(&line)?,
                _ => return Err(Halt::AtBody),
            }
            Ok(())
        });
        match read {
            Err(Halt::Input(error)) => return Err(error),
            Err(Halt::AtBody) | Ok(()) => {}
        }
        if let Some(heading) = heading {
            (self.form, self.costs) = (Form::Units, heading.into_costs());
        }
        Ok(())
    }

    /// Calls `visit` for every line of ops.
    fn for_each_line<E: From<InputError>>(
        &mut self,
        mut visit: impl FnMut(Line<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let vocabulary = Arc::clone(self.costs.vocabulary());
        let has_heading = self.form == Form::Units;
        lines(&self.path, &self.file, |number, text| {
            let is_heading = has_heading && (text.starts_with(MAGIC) || text.starts_with("unit "));
            if is_heading { Ok(()) } else { visit(Line::new(&self.path, number, text, &vocabulary)) }
        })
    }
}

/// Calls `visit` with the number and the text of every line that is neither empty nor a comment.
fn lines<E: From<InputError>>(
    path: &Path,
    mut file: &File,
    mut visit: impl FnMut(usize, &str) -> Result<(), E>,
) -> Result<(), E> {
    let unreadable = |error: std::io::Error| InputError::unreadable(path, &error);
    file.rewind().map_err(unreadable)?;
    let mut reader = BufReader::with_capacity(1 << 16, file);
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
        if !text.trim_start().is_empty() && !text.trim_start().starts_with('#') {
            visit(number, text)?;
        }
    }
}

/// Why the reading of a heading ends.
enum Halt {
    /// The lines of ops begin.
    AtBody,
    Input(InputError),
}

impl From<InputError> for Halt {
    fn from(error: InputError) -> Halt {
        Halt::Input(error)
    }
}

/// The heading of a trace in units.
struct Heading {
    vocabulary: Vocabulary,
    cycles: Vec<Cycles>,
}

impl Heading {
    fn begin(line: &Line<'_>) -> Result<Heading, InputError> {
        let form = "expected 'pcs-sim trace 2 cells N answer WORDS'";
        let words: Vec<&str> = line.text[MAGIC.len()..].split_whitespace().collect();
        let &["cells", _, "answer", answer] = words.as_slice() else { return Err(line.error(line.text, form)) };
        match answer.parse() {
            Ok(answer_words @ 1..=1024) => {
                let vocabulary = Vocabulary { activities: Vec::new(), units: Vec::new(), answer_words };
                Ok(Heading { vocabulary, cycles: Vec::new() })
            }
            _ => Err(line.error(answer, "an answer has from 1 to 1024 words")),
        }
    }

    fn add(&mut self, line: &Line<'_>) -> Result<(), InputError> {
        let words: Vec<&str> = line.text.split_whitespace().collect();
        let &["unit", code, name, activity, cycles] = words.as_slice() else {
            return Err(line.error(line.text, "expected 'unit CODE NAME ACTIVITY CYCLES'"));
        };
        let is_code = code.bytes().all(|byte| byte.is_ascii_lowercase());
        if !is_code || OpKind::from_word(code).is_some() || self.vocabulary.unit_coded(code).is_some() {
            let message = "a unit's code is small letters that no other op and no other unit has";
            return Err(line.error(code, message));
        }
        let Some(cycles) = cycles.parse().ok().filter(|cycles| *cycles <= Costs::MOST.0) else {
            return Err(line.error(cycles, format!("expected a number of cycles, at most {}", Costs::MOST.0)));
        };
        let activity = self
            .activity(activity)
            .ok_or_else(|| line.error(activity, format!("more than {} activities", Vocabulary::MOST_ACTIVITIES)))?;
        if self.cycles.len() == Vocabulary::MOST_UNITS {
            return Err(line.error(code, format!("more than {} units", Vocabulary::MOST_UNITS)));
        }
        self.vocabulary.units.push(UnitOfWork { code: code.to_owned(), name: name.to_owned(), activity });
        self.cycles.push(Cycles(cycles));
        Ok(())
    }

    /// The activity of that name, which is new if it has not been named before. `None` if there are too many.
    fn activity(&mut self, name: &str) -> Option<Activity> {
        let all = &mut self.vocabulary.activities;
        let place = all.iter().position(|(_, other)| other == name).unwrap_or(all.len());
        if place == all.len() {
            all.push((name.chars().next().unwrap_or('?'), name.to_owned()));
        }
        (place < Vocabulary::MOST_ACTIVITIES).then_some(Activity(place as u8))
    }

    fn into_costs(self) -> Costs {
        let Heading { vocabulary, cycles } = self;
        Costs::new(Arc::new(vocabulary), |unit| cycles[unit.0 as usize])
    }
}

/// What is found out about a trace before it is timed.
#[derive(Default)]
struct Survey {
    cells: usize,
    jobs: u64,
    order: HashMap<u32, u64>,
    /// Jobs whose answers the host waits for, and the lines.
    awaited: Vec<(u64, usize)>,
    /// The last of the cells that have an op that the array's last cell cannot have, and the line.
    writes_x: Option<(usize, usize)>,
    reads_z: Option<(usize, usize)>,
}

impl Survey {
    fn take(&mut self, line: &Line<'_>) -> Result<(), InputError> {
        let job = line.job()?;
        match line.actor()? {
            Actor::Host => self.take_host(job, line),
            Actor::Cell(index) => self.take_cell(index, line),
        }
    }

    fn take_host(&mut self, job: u32, line: &Line<'_>) -> Result<(), InputError> {
        if self.order.insert(job, self.jobs).is_some() {
            return Err(line.error(line.words[0], format!("the host has two lines for ray {job}")));
        }
        self.jobs += 1;
        line.ops().try_for_each(|op| {
            let (kind, count) = op?;
            self.awaited.extend((kind == OpKind::Await).then_some((count, line.number)));
            Ok(())
        })
    }

    fn take_cell(&mut self, index: usize, line: &Line<'_>) -> Result<(), InputError> {
        self.cells = self.cells.max(index + 1);
        line.ops().try_for_each(|op| {
            let (kind, _) = op?;
            let here = |asked: OpKind| (kind == asked).then_some((index, line.number));
            self.writes_x = self.writes_x.max(here(OpKind::WriteX));
            self.reads_z = self.reads_z.max(here(OpKind::ReadZ));
            // Which cell is the last, only the whole trace tells.
            OpBatch::check_op(kind, index, false).map_err(|error| line.error(line.words[1], error.to_string()))
        })
    }

    /// What only the whole trace shows.
    fn check(&self, path: &Path) -> Result<(), InputError> {
        let sent = |job: &u64| u32::try_from(*job).is_ok_and(|job| self.order.contains_key(&job));
        let fail = |message: String| Err(InputError::in_file(path, message));
        if let Some((job, line)) = self.awaited.iter().find(|(job, _)| !sent(job)) {
            return fail(format!("line {line}: the host waits for ray {job}, which it never sends"));
        }
        for (kind, last) in [(OpKind::WriteX, self.writes_x), (OpKind::ReadZ, self.reads_z)] {
            if let Some((cell, line)) = last.filter(|(cell, _)| cell + 1 == self.cells)
                && let Err(error) = OpBatch::check_op(kind, cell, true)
            {
                return fail(format!("line {line}: {error}"));
            }
        }
        if self.cells == 0 || self.jobs == 0 {
            let what = if self.jobs == 0 { "the host" } else { "a cell" };
            return fail(format!("the file is no activity trace: it has no line of {what}"));
        }
        Ok(())
    }
}

/// One line of a trace.
struct Line<'a> {
    path: &'a Path,
    number: usize,
    text: &'a str,
    /// Job and cell, if they are there, or "".
    words: [&'a str; 2],
    rest: &'a str,
    /// The units that its ops may count; `None` in a heading.
    vocabulary: Option<&'a Vocabulary>,
}

impl<'a> Line<'a> {
    fn new(path: &'a Path, number: usize, text: &'a str, vocabulary: &'a Vocabulary) -> Line<'a> {
        let (job, rest) = split_word(text);
        let (cell, rest) = split_word(rest);
        Line { path, number, text, words: [job, cell], rest, vocabulary: Some(vocabulary) }
    }

    fn job(&self) -> Result<u32, InputError> {
        let word = self.words[0];
        word.parse().map_err(|_| self.error(word, "expected a ray's number at the start of the line"))
    }

    fn actor(&self) -> Result<Actor, InputError> {
        let word = self.words[1];
        if word == "host" {
            return Ok(Actor::Host);
        }
        match word.parse() {
            Ok(index) if index < MOST_CELLS => Ok(Actor::Cell(index)),
            Ok(_) => Err(self.error(word, format!("there can be no more than {MOST_CELLS} cells"))),
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
        let (code, digits) = word.split_at(word.find(|c: char| !c.is_ascii_lowercase()).unwrap_or(word.len()));
        let Some(kind) = self.kind(code).filter(|kind| is_allowed(*kind, host)) else {
            return Err(self.error(word, self.no_op(word, host)));
        };
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(self.error(word, format!("expected a whole number after '{code}'")));
        }
        match digits.parse() {
            Ok(count) if count <= MOST_OF_AN_OP => Ok((kind, count)),
            _ => Err(self.error(word, format!("no op may count more than {MOST_OF_AN_OP}"))),
        }
    }

    fn kind(&self, code: &str) -> Option<OpKind> {
        let unit = || self.vocabulary.and_then(|vocabulary| vocabulary.unit_coded(code)).map(OpKind::Work);
        OpKind::from_word(code).or_else(unit)
    }

    fn no_op(&self, word: &str, host: bool) -> String {
        let units = self.vocabulary.iter().flat_map(|vocabulary| &vocabulary.units);
        let units: Vec<&str> = units.map(|unit| unit.code.as_str()).collect();
        match host {
            true => {
                format!("'{word}' is no op of the host, whose ops are w, a and units of work ({})", units.join(", "))
            }
            false => format!(
                "'{word}' is no op of a cell, whose ops are x, i, o, r, w, b, z and units of work ({})",
                units.join(", ")
            ),
        }
    }

    /// Adds the line to a stream; waits for a job become waits for the message in the job's place.
    fn push_to(&self, stream: &mut OpStream, order: &HashMap<u32, u64>) -> Result<(), InputError> {
        for op in self.ops() {
            let (kind, count) = op?;
            let count = match kind {
                OpKind::Await => u32::try_from(count).ok().and_then(|job| order.get(&job).copied()).unwrap_or(count),
                _ => count,
            };
            stream.push(kind, count);
        }
        stream.end_line(self.job()?);
        Ok(())
    }

    /// An error at a word of the line.
    fn error(&self, word: &str, message: impl Into<String>) -> InputError {
        let offset = (word.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize).min(self.text.len());
        let column = 1 + self.text.get(..offset).map_or(0, |before| before.chars().count());
        InputError::in_line(self.path, self.text, self.number, column, word.chars().count(), message)
    }
}

/// The host sends, works and waits; cells do everything but wait for answers.
fn is_allowed(kind: OpKind, host: bool) -> bool {
    match kind {
        OpKind::Await => host,
        OpKind::WriteX | OpKind::Work(_) => true,
        _ => !host,
    }
}

/// The longest op of a trace, in cycles, units or words.
const MOST_OF_AN_OP: u64 = (1 << 28) - 1;

fn split_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    text.split_at(text.find(char::is_whitespace).unwrap_or(text.len()))
}
