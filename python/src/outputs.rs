//! Result files, whole or not at all.

use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::run::{OutputFile, Outputs};

use crate::trouble::{Trouble, output};

/// Opens a result file.
pub fn open(path: &Path, force: bool) -> Result<OutputFile, Trouble> {
    Ok(Outputs::default().file(path, force)?)
}

/// Writes a result file, and puts it in its place.
pub fn write<E: Display>(
    path: &Path,
    force: bool,
    write: impl FnOnce(&mut OutputFile) -> Result<(), E>,
) -> Result<PathBuf, Trouble> {
    let mut file = open(path, force)?;
    write(&mut file).map_err(|error| unwritten(path, error))?;
    finish(file)
}

/// Puts a result file that is written in its place.
pub fn finish(mut file: OutputFile) -> Result<PathBuf, Trouble> {
    let path = file.path().to_owned();
    file.flush().and_then(|()| file.finish()).map_err(|error| unwritten(&path, error))
}

/// A result file that could not be written.
pub fn unwritten(path: &Path, error: impl Display) -> Trouble {
    output(format!("cannot write {}: {error}", path.display()))
}
