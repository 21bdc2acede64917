//! Files read whole, as far as they have an end.

use std::fs::File;
use std::io::{Read, Seek, Write};
use std::path::Path;

use super::{packed, reading};
use crate::error::InputError;

const GIB: u64 = 1 << 30;

/// Largest number of bytes that is read from what does not tell its length: a pipe or a device may have no end.
const LARGEST_STREAM: u64 = 1 << 28;

/// The name that stands for standard input, or for standard output where a result goes.
pub const STREAM: &str = "-";

/// Whether a name stands for standard input or output: [`STREAM`], or the same with an ending that tells what comes or goes there, as
/// `-.obj` and `-.png`.
pub fn is_stream(path: &Path) -> bool {
    let is_bare = path.parent().is_some_and(|folder| folder.as_os_str().is_empty());
    is_bare && path.as_os_str().to_str().is_some_and(|name| name == STREAM || name.starts_with("-."))
}

/// Opens a file to be read any number of times: standard input is kept in a file without a name.
pub(crate) fn open(path: &Path) -> std::io::Result<File> {
    if !is_stream(path) {
        return File::open(path);
    }
    let mut file = tempfile::tempfile()?;
    std::io::copy(&mut std::io::stdin().lock(), &mut file)?;
    file.flush()?;
    file.rewind()?;
    Ok(file)
}

/// The bytes of a file of up to `gib` GiB; of one that is no regular file, up to 256 MiB.
pub(crate) fn read(path: &Path, gib: u64) -> Result<Vec<u8>, InputError> {
    let unreadable = |error: std::io::Error| InputError::unreadable(path, &error);
    reading::check(path)?;
    if is_stream(path) {
        return read_stream(path, std::io::stdin().lock());
    }
    let file = File::open(path).map_err(unreadable)?;
    let about = file.metadata().map_err(unreadable)?;
    if !about.is_file() {
        return read_stream(path, file);
    }
    let too_large = || InputError::in_file(path, format!("file is too large, it may have up to {gib} GiB"));
    if about.len() > gib * GIB {
        return Err(too_large());
    }
    // Even a regular file can grow while it is read.
    let mut bytes = Vec::new();
    let length = file.take(gib * GIB + 1).read_to_end(&mut bytes).map_err(unreadable)? as u64;
    if length > gib * GIB {
        return Err(too_large());
    }
    reading::note(path, &bytes);
    unpack(bytes, gib * GIB, unreadable, too_large)
}

/// What was packed in some bytes, which may be so many, or the bytes as they are.
fn unpack(
    bytes: Vec<u8>,
    most: u64,
    unreadable: impl Fn(std::io::Error) -> InputError,
    too_large: impl Fn() -> InputError,
) -> Result<Vec<u8>, InputError> {
    if !packed::is_packed(&bytes) {
        return Ok(bytes);
    }
    let mut unpacked = Vec::new();
    let reader = packed::unpacked(bytes.as_slice()).map_err(&unreadable)?;
    let length = reader.take(most + 1).read_to_end(&mut unpacked).map_err(unreadable)? as u64;
    if length > most { Err(too_large()) } else { Ok(unpacked) }
}

/// The bytes of a pipe or a device.
fn read_stream(path: &Path, stream: impl Read) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let length = stream.take(LARGEST_STREAM + 1).read_to_end(&mut bytes);
    if length.map_err(|error| InputError::unreadable(path, &error))? as u64 > LARGEST_STREAM {
        return Err(endless(path));
    }
    reading::note(path, &bytes);
    unpack(bytes, LARGEST_STREAM, |error| InputError::unreadable(path, &error), || endless(path))
}

fn endless(path: &Path) -> InputError {
    let message = "no end was found within 256 MiB, and it is no regular file but a pipe or a device";
    InputError::in_file(path, message).help("write what it has into a file first, if that has an end")
}
