//! `pcs-sim disasm FILE`: an object file as source text.

use pcs_sim::isa::{listing, object};

use super::cell_args::DisasmArgs;
use super::{Failure, print};

/// Prints source text that assembles to the same words.
pub fn disasm(args: &DisasmArgs) -> Result<(), Failure> {
    print(&listing::disassembly(&object::load(&args.file)?))
}
