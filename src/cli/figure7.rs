//! `pcs-sim figure7`: the six numbers of the paper's Figure 7, measured, and how many machines make them as well.

use std::path::{Path, PathBuf};

use pcs_sim::cancel::Cancel;
use pcs_sim::isa::{Class, InstructionCycles, Processor};
use pcs_sim::machine::{Machine, MachineFile, MachineSpec};
use pcs_sim::program::cells::{Annex, CellOptions};
use pcs_sim::program::figure7::fits::{Fit, fits};
use pcs_sim::program::figure7::two_constants::two_constants;
use pcs_sim::program::figure7::{NUMBERS, numbers, us};
use pcs_sim::program::work;
use pcs_sim::report::figure7::{by_two_constants, run_times, within};
use pcs_sim::report::summary::{aligned, table};
use pcs_sim::report::table::{self, Column, Kind, Table};
use pcs_sim::run::{Fitting, OutputFile};
use pcs_sim::seam::activity_trace::ActivityTrace;

use super::cell_args::Figure7Args;
use super::{Failure, outputs, print};

/// Prints what the paper says, what each kind of cell takes, the differences, and what that says about the instructions' costs.
pub fn figure7(args: &Figure7Args) -> Result<(), Failure> {
    let files = args.fits.as_ref().map(|path| Files::open(path, args.force)).transpose()?;
    let machine = args.machine.as_deref().map_or_else(MachineFile::standard, MachineFile::read)?.build()?;
    let mut trace = args.ops.as_deref().map(|ops| ActivityTrace::open(ops, &work::cycles_vocabulary())).transpose()?;
    let fitting = trace.as_mut().map(|trace| Fitting::new(trace, &machine)).transpose()?;
    let timings = numbers(&machine.times, None)?;
    let programs = match machine.instructions {
        Some(cycles) => {
            let options = CellOptions {
                cycles,
                folder: args.cell_programs.clone(),
                instruction_limit: Processor::INSTRUCTION_LIMIT,
                annex: Annex::default(),
            };
            Some(numbers(&machine.times, Some(&options))?)
        }
        None => {
            super::note("the machine file does not say what instructions cost; `pcs-sim calibrate` adds it");
            None
        }
    };
    print(&rows(&machine.spec, &timings, programs.as_ref()))?;
    if programs.is_none() && files.is_none() && fitting.is_none() {
        return Ok(());
    }
    print_fits(args, &machine, (fitting, files))
}

/// The machines that fit: how many, what a run takes on them, and all of them as a table if that is asked for.
fn print_fits(
    args: &Figure7Args,
    machine: &Machine,
    (mut fitting, files): (Option<Fitting<'_>>, Option<Files>),
) -> Result<(), Failure> {
    let mut all: Vec<Vec<String>> = Vec::new();
    let visit = |fit: Fit| {
        fitting.iter_mut().for_each(|fitting| fitting.take(&fit));
        if files.is_some() {
            let costs = Class::ALL.iter().map(|&class| fit.cycles.of(class).to_string());
            all.push(std::iter::once(format!("{:.6}", 100.0 * fit.off)).chain(costs).collect());
        }
    };
    if let Some(cycles) = machine.instructions.filter(InstructionCycles::counts_waits) {
        let best = two_constants(&machine.spec, &cycles, args.cell_programs.clone())?;
        print(&format!("\n{}", by_two_constants(&best, &machine.spec)))?;
    }
    let counted = fits(&machine.spec, args.cell_programs.clone(), visit)?;
    print(&format!("\n{}", within(&counted, &machine.spec)))?;
    if let Some(fitting) = fitting {
        let (here, ranges) = fitting.times(&Cancel::default())?;
        print(&format!("\n{}", run_times(here, &ranges, machine.spec.clock())))?;
    }
    let Some(files) = files else { return Ok(()) };
    let costs = Class::ALL.map(|class| Column::new(class.name(), Kind::Whole, class.name()));
    let off = Column::new("off_percent", Kind::Number, "how far the worst of the six numbers is off (%)");
    let columns: Vec<Column<'_>> = std::iter::once(off).chain(costs).collect();
    let table = Table { columns: &columns, rows: all.iter().map(Vec::as_slice).collect() };
    print(&outputs::list(&files.write(&table)?))
}

/// The table of all machines that fit, in both forms.
struct Files {
    csv: OutputFile,
    parquet: OutputFile,
}

impl Files {
    fn open(path: &Path, force: bool) -> Result<Files, Failure> {
        table::check_name(path)?;
        let [csv, parquet] = ["csv", "parquet"].map(|ending| outputs::create(&path.with_extension(ending), force));
        Ok(Files { csv: csv?, parquet: parquet? })
    }

    fn write(self, table: &Table<'_>) -> Result<Vec<PathBuf>, Failure> {
        let mut written = Vec::new();
        outputs::finish(Some(self.csv), &mut written, |file| table::write_csv(file, table))?;
        outputs::finish(Some(self.parquet), &mut written, |file| table::write_parquet(file, table, &[]))?;
        Ok(written)
    }
}

fn rows(spec: &MachineSpec, timings: &[f64; 6], programs: Option<&[f64; 6]>) -> String {
    let mut header = vec!["Figure 7, µs", "paper", "timings cell", "off"];
    if programs.is_some() {
        header.extend(["program cell", "off"]);
    }
    let mut rows = table(&header);
    for (index, number) in NUMBERS.iter().enumerate() {
        let mut row = vec![number.name.to_owned(), number.paper_us.to_string()];
        for simulated in std::iter::once(timings).chain(programs) {
            let simulated = us(simulated[index], spec);
            row.push(format!("{simulated:.2}"));
            row.push(format!("{:+.1} %", 100.0 * (simulated / number.paper_us - 1.0)));
        }
        rows.add_row(row);
    }
    aligned(rows)
}
