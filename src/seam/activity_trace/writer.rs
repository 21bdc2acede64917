//! Writing a trace.

use std::io::Write;

use super::{Form, MAGIC, MOST_OF_AN_OP};
use crate::seam::{Costs, Op, OpBatch, OpKind, OpStream, Unit, UnitOfWork};

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
    let used = vocabulary.units.iter().enumerate().filter(|(_, unit)| unit.used);
    for (place, UnitOfWork { code, name, activity, .. }) in used {
        let activity = vocabulary.activities.get(activity.0 as usize).map_or("?", |(_, name)| name.as_str());
        writeln!(out, "unit {code} {name} {activity} {}", costs.of(Unit(place as u8)).0)?;
    }
    Ok(())
}

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
