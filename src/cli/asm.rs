//! `pcs-sim asm FILE`: source text to an object file and a listing.

use std::io::Write;
use std::path::Path;

use pcs_sim::error::InputError;
use pcs_sim::isa::{Executable, Program, Sources, assemble, listing, object};
use pcs_sim::machine::MachineFile;

use super::cell_args::AsmArgs;
use super::{Failure, outputs, print};

/// Assembles; without a file named for it, one result goes to stdout.
pub fn asm(args: &AsmArgs) -> Result<(), Failure> {
    let listing_path = args.listing.as_ref().and_then(Option::as_ref);
    let named = [args.output.as_ref(), listing_path];
    outputs::check_distinct(&named, &[Some(&args.file), args.machine.as_deref()])?;
    let object_file = outputs::open(args.output.as_deref(), args.force)?;
    let listing_file = outputs::open(listing_path.map(|path| path.as_path()), args.force)?;
    let program = outputs::reading(&named, || assemble(&args.file, Sources::Files, &[]))?;
    let object = object::write(&program);
    let listing = match &args.listing {
        Some(_) => listing::listing(&executable(program, args.machine.as_deref())?),
        None => String::new(),
    };
    match (&args.listing, &args.output) {
        (Some(None), _) => print(&listing)?,
        (None, None) => print(&object)?,
        _ => {}
    }
    let mut written = Vec::new();
    outputs::finish(object_file, &mut written, |file| file.write_all(object.as_bytes()))?;
    outputs::finish(listing_file, &mut written, |file| file.write_all(listing.as_bytes()))?;
    print(&outputs::list(&written))
}

/// A program under the instructions' costs of a machine file.
pub fn executable(program: Program, machine: Option<&Path>) -> Result<Executable, InputError> {
    let machine = machine.map_or_else(MachineFile::standard, MachineFile::read)?.build()?;
    Ok(Executable::new(program, &machine.instruction_cycles()?))
}
