//! Result files: opened before the long run, seen under their name only when they are whole.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::error::InputError;

/// A file under way: written beside its place, under another name, until it is finished.
#[derive(Debug)]
pub struct OutputFile {
    path: PathBuf,
    writer: BufWriter<Target>,
    overwrite: bool,
}

/// Where the bytes go.
#[derive(Debug)]
enum Target {
    /// To a file that takes its name when it is finished.
    Part(NamedTempFile),
    /// Straight to a device or a pipe, which is no file to be replaced.
    Device(File),
}

impl OutputFile {
    /// Opens a file to be. Fails if it cannot be written there, or if it exists and `overwrite` was not asked for.
    pub fn create(path: &Path, overwrite: bool) -> Result<OutputFile, InputError> {
        let target = Target::open(&followed(path), path, overwrite)?;
        Ok(OutputFile { path: path.to_owned(), writer: BufWriter::with_capacity(1 << 16, target), overwrite })
    }

    /// Where it will be, as the user named it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the whole file in its place.
    pub fn finish(self) -> std::io::Result<PathBuf> {
        let Target::Part(part) = self.writer.into_inner().map_err(|error| error.into_error())? else {
            return Ok(self.path);
        };
        make_readable(part.path())?;
        let place = followed(&self.path);
        let done = if self.overwrite { part.persist(place) } else { part.persist_noclobber(place) };
        done.map_err(|error| error.error)?;
        Ok(self.path)
    }
}

impl Target {
    /// Opens `place`, which the user knows as `name`.
    fn open(place: &Path, name: &Path, overwrite: bool) -> Result<Target, InputError> {
        let refuse = |reason: String| InputError::in_file(name, format!("cannot write the file: {reason}"));
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
        let part = tempfile::Builder::new().prefix(".pcs-sim-").suffix(".part").tempfile_in(folder);
        part.map(Target::Part).map_err(|error| refuse(error.kind().to_string()))
    }
}

/// The file that a name leads to: a link stands for its target.
fn followed(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Target::Part(file) => file.write(bytes),
            Target::Device(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self {
            Target::Part(file) => file.flush(),
            Target::Device(file) => file.flush(),
        }
    }
}

/// Temporary files are their owner's alone; results are like any file that a program writes.
#[cfg(unix)]
fn make_readable(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_: &Path) -> std::io::Result<()> {
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
