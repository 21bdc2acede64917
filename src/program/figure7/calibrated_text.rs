//! A machine file with the costs that a fit has found, and what they make of Figure 7.

use std::fmt::Write;
use std::path::Path;

use crate::error::InputError;
use crate::isa::InstructionCycles;
use crate::machine::{MachineFile, MachineSpec};

use super::calibrate::BOUNDS;
use super::{NUMBERS, us};

/// How what the fit writes begins.
const HEADING: &str = "    // What instructions cost, in cycles,";

/// The text of a machine file with its `instruction_cycles` replaced by, or with, these; and the reasons, and the six
/// `numbers` (in cycles) that they make. Fails if other fields come behind those that are replaced.
pub fn machine_text(
    path: &Path,
    text: &str,
    spec: &MachineSpec,
    cycles: &InstructionCycles,
    numbers: &[f64; 6],
) -> Result<String, InputError> {
    let at = |start: &str| text.find(&format!("\n{start}")).map(|newline| newline + 1);
    let cut = at(HEADING).or_else(|| at("    instruction_cycles:")).or_else(|| text.rfind(')')).unwrap_or(text.len());
    let mut new = format!("{}\n\n", text[..cut].trim_end());
    new.push_str(&block(spec, cycles, numbers));
    new.push_str(")\n");
    let parse = |text: &str| MachineFile::parse(path, text);
    let old = MachineFile { instruction_cycles: Some(*cycles), ..parse(text)? };
    match parse(&new) {
        Ok(file) if file == old => Ok(new),
        _ => {
            let error = InputError::in_file(path, "the new instruction_cycles cannot be put into this file");
            Err(error.help("let instruction_cycles be its last field, with nothing behind it but the closing bracket"))
        }
    }
}

fn block(spec: &MachineSpec, cycles: &InstructionCycles, numbers: &[f64; 6]) -> String {
    let mut text = format!(
        "{HEADING} for cells that run programs. Nothing was published of it: these are fitted to\n    \
         // Figure 7 by `pcs-sim calibrate`, among what is plausible for 1988. They make of its numbers, in us:\n    //\n    \
         //                              paper  program  difference\n"
    );
    for (number, simulated) in NUMBERS.iter().zip(numbers) {
        let simulated = us(*simulated, spec);
        let difference = 100.0 * (simulated / number.paper_us - 1.0);
        let _ = writeln!(
            text,
            "    //   {:<24} {:>7.2}  {simulated:>7.2}  {difference:>+8.1} %",
            number.name, number.paper_us
        );
    }
    text.push_str("    instruction_cycles: (\n");
    for bound in BOUNDS {
        let _ = writeln!(
            text,
            "        // {} to {} ns, typically {}: {}.",
            bound.least_ns, bound.most_ns, bound.typical_ns, bound.why
        );
        let _ = writeln!(text, "        {}: {},", bound.class.name(), cycles.of(bound.class));
    }
    text.push_str("    ),\n");
    text
}
