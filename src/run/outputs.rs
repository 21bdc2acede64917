//! Result files: opened before the long run, seen under their name only when they are whole.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Stdout, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tempfile::TempPath;

use crate::error::InputError;
use crate::input::is_stream;
use crate::input::packed::Packer;

/// Result files under way, which stand in their places all whole or not at all. A handle: clones stand for the same files,
/// so that a thread that is told to stop everything can remove them, whoever writes them.
#[derive(Clone, Debug, Default)]
pub struct Outputs(Arc<Mutex<Desk>>);

/// A file under way: written beside its place, under another name, until it is finished. One whose name ends in `.gz` or `.zst` is
/// packed.
#[derive(Debug)]
pub struct OutputFile {
    path: PathBuf,
    writer: Packer<BufWriter<Target>>,
    overwrite: bool,
}

/// Where the bytes go.
#[derive(Debug)]
enum Target {
    /// To a file that takes its name when it is finished.
    Part(Part),
    /// Straight to a device or a pipe, which is no file to be replaced.
    Device(File),
    /// To standard output.
    Stdout(Stdout),
}

/// A file that is removed unless it is put in its place.
#[derive(Debug)]
struct Part {
    file: File,
    /// Its key in [`Desk::parts`].
    number: u64,
    outputs: Outputs,
}

/// A folder for result files. Those that had to be made for it are removed again if they are still empty when it is
/// dropped.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    /// From the innermost outwards.
    made: Vec<PathBuf>,
}

/// What is known of the files of some [`Outputs`].
#[derive(Debug, Default)]
struct Desk {
    /// The files that are not finished; a path that is dropped is removed.
    parts: BTreeMap<u64, TempPath>,
    opened: u64,
    /// The folders that were made for result files, each after those in it.
    folders: Vec<PathBuf>,
    finished: Vec<PathBuf>,
    abandoned: bool,
}

impl Outputs {
    /// Opens a file to be. Fails if it cannot be written there, if it exists and `overwrite` was not asked for, and after
    /// [`Outputs::abandon`]. A name that [stands for it](is_stream) is standard output.
    pub fn file(&self, path: &Path, overwrite: bool) -> Result<OutputFile, InputError> {
        let target = Target::open(self, &followed(path), path, overwrite)?;
        let unwritable = |error: std::io::Error| InputError::in_file(path, format!("cannot write the file: {error}"));
        let writer = Packer::new(path, BufWriter::with_capacity(1 << 16, target)).map_err(unwritable)?;
        Ok(OutputFile { path: path.to_owned(), writer, overwrite })
    }

    /// Makes a folder for result files, unless it is there. Fails if it cannot be made, and after [`Outputs::abandon`].
    pub fn folder(&self, path: &Path) -> std::io::Result<OutputFolder> {
        let mut desk = self.open_desk()?;
        if let Some(file) = path.ancestors().find(|above| above.is_file()) {
            return Err(std::io::Error::other(format!("{} is a file, and no folder", file.display())));
        }
        if let Some((reason, _)) = path.ancestors().find_map(broken_link) {
            return Err(std::io::Error::other(reason));
        }
        let missing = path.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        let made: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        desk.folders.extend_from_slice(&made);
        std::fs::create_dir_all(path)?;
        Ok(OutputFolder { path: path.to_owned(), made })
    }

    /// Removes all files that are not finished and the folders that were made for nothing. No file can be opened or finished
    /// any more. Returns the files that have been finished.
    pub fn abandon(&self) -> Vec<PathBuf> {
        let mut desk = self.desk();
        desk.abandoned = true;
        desk.parts.clear();
        remove_empty(&desk.folders);
        desk.finished.clone()
    }

    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The same, as long as the files have not been abandoned.
    fn open_desk(&self) -> std::io::Result<MutexGuard<'_, Desk>> {
        let desk = self.desk();
        match desk.abandoned {
            true => Err(std::io::Error::new(std::io::ErrorKind::Interrupted, "the files of this run were abandoned")),
            false => Ok(desk),
        }
    }
}

impl OutputFile {
    /// Where it will be, as the user named it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the whole file in its place. Fails if it cannot stand there, and after [`Outputs::abandon`].
    pub fn finish(self) -> std::io::Result<PathBuf> {
        let target = self.writer.finish()?.into_inner().map_err(|error| error.into_error())?;
        let Target::Part(part) = target else { return Ok(self.path) };
        let mut desk = part.outputs.open_desk()?;
        let Some(path) = desk.parts.remove(&part.number) else { return Ok(self.path) };
        make_readable(&path)?;
        let place = followed(&self.path);
        let done = if self.overwrite { path.persist(place) } else { path.persist_noclobber(place) };
        done.map_err(|error| error.error)?;
        desk.finished.push(self.path.clone());
        drop(desk);
        Ok(self.path)
    }
}

impl OutputFolder {
    /// Where it is, as the user named it.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        remove_empty(&self.made);
    }
}

/// Removes those of the folders that have nothing in them.
fn remove_empty(folders: &[PathBuf]) {
    for folder in folders {
        // One with files in it is not removed, as it should be.
        let _ = std::fs::remove_dir(folder);
    }
}

impl Target {
    /// Opens `place`, which the user knows as `name`.
    fn open(outputs: &Outputs, place: &Path, name: &Path, overwrite: bool) -> Result<Target, InputError> {
        if is_stream(name) {
            return Ok(Target::Stdout(std::io::stdout()));
        }
        let refuse = |reason: String| InputError::in_file(name, format!("cannot write the file: {reason}"));
        if let Some((reason, help)) = broken_link(place) {
            return Err(refuse(reason).help(help));
        }
        if place.is_dir() {
            return Err(refuse("it is a directory".to_owned()));
        }
        if place.exists() && !place.is_file() {
            let device = File::options().write(true).open(place);
            return device.map(Target::Device).map_err(|error| refuse(error.kind().to_string()));
        }
        if place.exists() && !overwrite {
            let error = InputError::in_file(name, "the file exists already");
            return Err(error.help("give another name, or --force to replace it"));
        }
        let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(refuse(format!("there is no folder {}", folder.display())));
        }
        Part::create(outputs, folder).map(Target::Part).map_err(|error| refuse(error.kind().to_string()))
    }
}

impl Part {
    fn create(outputs: &Outputs, folder: &Path) -> std::io::Result<Part> {
        let mut desk = outputs.open_desk()?;
        let part = tempfile::Builder::new().prefix(".pcs-sim-").suffix(".part").tempfile_in(folder)?;
        let (file, path) = part.into_parts();
        let number = desk.opened;
        desk.opened += 1;
        desk.parts.insert(number, path);
        Ok(Part { file, number, outputs: outputs.clone() })
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        self.outputs.desk().parts.remove(&self.number);
    }
}

/// What is wrong with a name that is a link but leads to no file, and what to do.
fn broken_link(place: &Path) -> Option<(String, &'static str)> {
    let target = std::fs::read_link(place).ok()?;
    let error = std::fs::metadata(place).err()?;
    match error.kind() {
        std::io::ErrorKind::NotFound => {
            let reason = format!("it is a link to {}, which does not exist", target.display());
            Some((reason, "remove the link, or make the file that it leads to"))
        }
        // Without the number that Rust appends to the operating system's reason.
        _ => {
            let text = error.to_string();
            let reason = text.split(" (os error").next().unwrap_or(&text);
            Some((format!("it is a link that leads to no file: {reason}"), "remove the link, or give another name"))
        }
    }
}

/// The file that a name leads to: a link stands for its target.
fn followed(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// A reader of standard output that has gone away (`| head`) is no failure: the rest goes nowhere.
fn unless_gone<T>(written: std::io::Result<T>, all: T) -> std::io::Result<T> {
    match written {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(all),
        written => written,
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Target::Part(part) => part.file.write(bytes),
            Target::Device(file) => file.write(bytes),
            Target::Stdout(out) => unless_gone(out.write(bytes), bytes.len()),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self {
            Target::Part(part) => part.file.flush(),
            Target::Device(file) => file.flush(),
            Target::Stdout(out) => unless_gone(out.flush(), ()),
        }
    }
}

/// Temporary files are their owner's alone; results are like any file that a program writes.
#[cfg(unix)]
pub(crate) fn make_readable(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
pub(crate) fn make_readable(_: &Path) -> std::io::Result<()> {
    Ok(())
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.writer.flush()
    }
}
