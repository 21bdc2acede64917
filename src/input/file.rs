//! Files read whole, as far as they have an end.

use std::fs::File;
use std::io::{Read, Seek, Write};
use std::path::Path;

use super::reading;
use crate::error::InputError;

const GIB: u64 = 1 << 30;

/// Largest number of bytes that is read from what does not tell its length: a pipe or a device may have no end.
const LARGEST_STREAM: u64 = 1 << 28;

/// The name that stands for standard input, or for standard output where a result goes.
pub const STREAM: &str = "-";

/// Opens a file to be read any number of times: standard input is kept in a file without a name.
pub(crate) fn open(path: &Path) -> std::io::Result<File> {
    if path != Path::new(STREAM) {
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
    if path == Path::new(STREAM) {
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
    Ok(bytes)
}

/// The bytes of a pipe or a device.
fn read_stream(path: &Path, stream: impl Read) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let length = stream.take(LARGEST_STREAM + 1).read_to_end(&mut bytes);
    if length.map_err(|error| InputError::unreadable(path, &error))? as u64 > LARGEST_STREAM {
        return Err(endless(path));
    }
    reading::note(path, &bytes);
    Ok(bytes)
}

fn endless(path: &Path) -> InputError {
    let message = "no end was found within 256 MiB, and it is no regular file but a pipe or a device";
    InputError::in_file(path, message).help("write what it has into a file first, if that has an end")
}
