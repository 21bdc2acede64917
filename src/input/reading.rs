//! Which files have been read: a result is as fresh as all of them, also those that stand behind the one that was named.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::cancel::{Cancel, Cancelled};

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct FileRead {
    /// Where it is, as it was named.
    pub path: PathBuf,
    /// BLAKE3 of its bytes, in hexadecimal digits.
    pub digest: String,
}

thread_local! {
    /// What this thread has read since it was asked to take note. Readers of all formats end here, through whatever
    /// includes, so that none can forget to tell.
    static NOTED: RefCell<Option<Vec<FileRead>>> = const { RefCell::new(None) };
}

/// Takes note of a file that was read.
pub(crate) fn note(path: &Path, bytes: &[u8]) {
    NOTED.with_borrow_mut(|noted| {
        if let Some(files) = noted {
            files.push(FileRead { path: path.to_owned(), digest: blake3::hash(bytes).to_hex().to_string() });
        }
    });
}

/// Takes note of files that were read for this thread.
fn note_all(files: Vec<FileRead>) {
    NOTED.with_borrow_mut(|noted| noted.as_mut().map_or((), |all| all.extend(files)));
}

/// Reads what may take long, as [`Cancel::wait_for`] does; which files were read is noted by this thread.
pub(crate) fn wait_for<T: Send + 'static>(
    cancel: &Cancel,
    read: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Cancelled> {
    let (result, files) = cancel.wait_for(move || noting(read))?;
    note_all(files);
    Ok(result)
}

/// Does something, and tells which files this thread has read for it, each once and in the order of their names: those that
/// stand behind others, too.
pub fn noting<T>(read: impl FnOnce() -> T) -> (T, Vec<FileRead>) {
    let before = NOTED.replace(Some(Vec::new()));
    let result = read();
    let mut files = NOTED.replace(before).unwrap_or_default();
    note_all(files.clone());
    files.sort();
    files.dedup();
    (result, files)
}
