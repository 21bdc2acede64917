//! `pcs-sim figure7`: the six numbers of the paper's Figure 7, measured.

use pcs_sim::isa::Processor;
use pcs_sim::machine::MachineFile;
use pcs_sim::machine::MachineSpec;
use pcs_sim::program::cells::CellOptions;
use pcs_sim::program::figure7::{NUMBERS, numbers, us};
use pcs_sim::report::summary::{aligned, table};

use super::cell_args::Figure7Args;
use super::{Failure, print};

/// Prints what the paper says, what each kind of cell takes, and the differences.
pub fn figure7(args: &Figure7Args) -> Result<(), Failure> {
    let machine = args.machine.as_deref().map_or_else(MachineFile::standard, MachineFile::read)?.build()?;
    let timings = numbers(&machine.times, None)?;
    let programs = match machine.instructions {
        Some(cycles) => {
            let options = CellOptions {
                cycles,
                folder: args.cell_programs.clone(),
                instruction_limit: Processor::INSTRUCTION_LIMIT,
            };
            Some(numbers(&machine.times, Some(&options))?)
        }
        None => {
            super::note("the machine file does not say what instructions cost; `pcs-sim calibrate` adds it");
            None
        }
    };
    print(&rows(&machine.spec, &timings, programs.as_ref()))
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
