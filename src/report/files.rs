//! Result files: opened before the long run, seen under their name only when they are whole.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::error::InputError;

/// A file under way: written beside its place, under another name, until it is finished.
#[derive(Debug)]
pub struct OutputFile {
    path: PathBuf,
    writer: BufWriter<NamedTempFile>,
    overwrite: bool,
}

impl OutputFile {
    /// Opens a file to be. Fails if it cannot be written there, or if it exists and `overwrite` was not asked for.
    pub fn create(path: &Path, overwrite: bool) -> Result<OutputFile, InputError> {
        if path.is_dir() {
            return Err(InputError::in_file(path, "cannot write the file: it is a directory"));
        }
        if path.exists() && !overwrite {
            return Err(InputError::in_file(path, "the file exists already")
                .help("give another name, or --force to replace it"));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(InputError::in_file(
                path,
                format!("cannot write the file: there is no folder {}", folder.display()),
            ));
        }
        let file = tempfile::Builder::new().prefix(".pcs-sim-").suffix(".part").tempfile_in(folder);
        let file =
            file.map_err(|error| InputError::in_file(path, format!("cannot write the file: {}", error.kind())))?;
        Ok(OutputFile { path: path.to_owned(), writer: BufWriter::with_capacity(1 << 16, file), overwrite })
    }

    /// Where it will be.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the whole file in its place.
    pub fn finish(self) -> std::io::Result<PathBuf> {
        let file = self.writer.into_inner().map_err(|error| error.into_error())?;
        make_readable(file.path())?;
        let done = if self.overwrite { file.persist(&self.path) } else { file.persist_noclobber(&self.path) };
        done.map_err(|error| error.error)?;
        Ok(self.path)
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
