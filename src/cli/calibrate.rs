//! `pcs-sim calibrate`: what instructions cost, fitted to Figure 7.

use std::io::Write;
use std::path::Path;

use pcs_sim::isa::Processor;
use pcs_sim::machine::MachineFile;
use pcs_sim::program::cells::{Annex, CellOptions};
use pcs_sim::program::figure7::calibrate::calibrate as fit;
use pcs_sim::program::figure7::{machine_text, numbers};
use pcs_sim::run::read_text;

use super::cell_args::CalibrateArgs;
use super::{Failure, outputs, print};

/// Writes the machine file with the costs that come nearest to Figure 7.
pub fn calibrate(args: &CalibrateArgs) -> Result<(), Failure> {
    let named = [args.output.as_ref()];
    outputs::check_distinct(&named, &[args.machine.as_deref()])?;
    let output = outputs::open(args.output.as_deref(), args.force)?;
    let path = args.machine.as_deref().unwrap_or(Path::new("pcs.ron"));
    let text = match &args.machine {
        Some(path) => read_text(path)?,
        None => MachineFile::STANDARD_TEXT.to_owned(),
    };
    let machine = MachineFile::parse(path, &text)?.build()?;
    let cycles = outputs::reading(&named, || fit(&machine.spec, args.cell_programs.clone()))?;
    let options = CellOptions {
        cycles,
        folder: args.cell_programs.clone(),
        instruction_limit: Processor::INSTRUCTION_LIMIT,
        annex: Annex::default(),
    };
    let numbers = numbers(&machine.times, Some(&options))?;
    let text = machine_text(path, &text, &machine.spec, &cycles, &numbers)?;
    if output.is_none() {
        return print(&text);
    }
    let mut written = Vec::new();
    outputs::finish(output, &mut written, |file| file.write_all(text.as_bytes()))?;
    print(&outputs::list(&written))
}
