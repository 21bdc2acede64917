//! The result files of a command: opened before the run, put in their places after it.

use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::host::rules::Rules;
use pcs_sim::input::{STREAM, is_stream};
use pcs_sim::run::{OutputFile, OutputFolder, noting};

use super::{Failure, interrupt, take_stdout};

/// Opens a result file, if one is asked for.
pub fn open(path: Option<&Path>, force: bool) -> Result<Option<OutputFile>, InputError> {
    path.map(|path| create(path, force)).transpose()
}

/// Opens a result file.
pub fn create(path: &Path, force: bool) -> Result<OutputFile, InputError> {
    if is_stream(path) {
        take_stdout();
    }
    interrupt::outputs().file(path, force)
}

/// Fails if a picture that is written as PNG goes to standard output under the name of another format.
pub fn check_png(path: Option<&Path>) -> Result<(), InputError> {
    match path.filter(|path| is_stream(path) && path.extension().is_some_and(|ending| ending != "png")) {
        Some(path) => Err(InputError::in_file(path, "the picture is written as PNG").help("-.png is standard output")),
        None => Ok(()),
    }
}

/// Fails if a list of hits is asked for that would lack some, as a rule knows of rays that they hit without sending them.
pub fn check_hits(path: Option<&Path>, rules: Rules) -> Result<(), InputError> {
    if path.is_none() || !rules.a4c {
        return Ok(());
    }
    let error = InputError::new(
        "--hits lists the first hits of all rays, and with the rule a4c some are known to hit without being sent",
    );
    Err(error.help("leave it out, or a4c out of --rules"))
}

/// Makes a folder for result files, unless it is there.
pub fn folder(path: &Path) -> std::io::Result<OutputFolder> {
    if is_stream(path) {
        return Err(std::io::Error::other("standard output is no folder"));
    }
    interrupt::outputs().folder(path)
}

/// Reads a command's inputs. Fails if a result would replace one of the files that were read, be it one that another names.
pub fn reading<T, E: From<InputError>>(
    outputs: &[Option<&PathBuf>],
    read: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    let (result, files) = noting(read);
    let files: Vec<Option<&Path>> = files.iter().map(|file| Some(file.path.as_path())).collect();
    check_distinct(outputs, &files)?;
    result
}

/// Fails if two results have the same file, or if a result would replace an input.
pub fn check_distinct(outputs: &[Option<&PathBuf>], inputs: &[Option<&Path>]) -> Result<(), InputError> {
    let outputs: Vec<(&PathBuf, PathBuf)> = outputs.iter().copied().flatten().map(|path| (path, place(path))).collect();
    for (index, (path, its_place)) in outputs.iter().enumerate() {
        if outputs[..index].iter().any(|(_, other)| other == its_place) && !is_device(path) {
            let what = if is_stream(path) { "standard output" } else { "the file" };
            return Err(InputError::in_file(path, format!("{what} is named for two results")));
        }
        let mut inputs = inputs.iter().flatten().filter(|input| !is_stream(input));
        if inputs.any(|input| place(input) == *its_place) {
            return Err(InputError::in_file(path, "the file is an input of this run"));
        }
    }
    Ok(())
}

fn is_device(path: &Path) -> bool {
    !is_stream(path) && path.exists() && !path.is_file()
}

/// One name for each place, however it is spelt: the file's true path, or its folder's where it does not exist yet.
fn place(path: &Path) -> PathBuf {
    if is_stream(path) {
        return PathBuf::from(STREAM);
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(beside).unwrap_or_else(|| path.to_owned())
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
