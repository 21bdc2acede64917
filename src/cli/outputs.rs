//! The result files of a command: opened before the run, put in their places after it.

use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::report::files::OutputFile;

use super::Failure;

/// Opens a result file, if one is asked for.
pub fn open(path: Option<&Path>, force: bool) -> Result<Option<OutputFile>, InputError> {
    path.map(|path| OutputFile::create(path, force)).transpose()
}

/// Fails if two results have the same file.
pub fn check_distinct(files: &[Option<&PathBuf>]) -> Result<(), InputError> {
    let files: Vec<&PathBuf> = files.iter().copied().flatten().collect();
    match files.iter().enumerate().find(|(index, file)| files[..*index].contains(file)) {
        Some((_, file)) => Err(InputError::in_file(file, "the file is named for two results")),
        None => Ok(()),
    }
}

/// Writes a result file, if there is one, and puts it in its place; notes its name in `written`.
pub fn finish<E: std::fmt::Display>(
    file: Option<OutputFile>,
    written: &mut Vec<PathBuf>,
    write: impl FnOnce(&mut OutputFile) -> Result<(), E>,
) -> Result<(), Failure> {
    let Some(mut file) = file else { return Ok(()) };
    let path = file.path().to_owned();
    let failed = |reason: String| Failure::Output(format!("cannot write {}: {reason}", path.display()));
    write(&mut file).map_err(|error| failed(error.to_string()))?;
    file.flush().map_err(|error| failed(error.to_string()))?;
    written.push(file.finish().map_err(|error| failed(error.to_string()))?);
    Ok(())
}

/// The last lines of a run: the files that it has written.
pub fn list(written: &[PathBuf]) -> String {
    written.iter().map(|path| format!("wrote {}\n", path.display())).collect()
}
