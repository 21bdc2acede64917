//! Files that are packed by gzip or Zstandard: known by their first bytes when they are read, by their names when they are written.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;

/// How a file is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packing {
    Gzip,
    Zstandard,
}

impl Packing {
    fn of_name(path: &Path) -> Option<Packing> {
        match path.extension()?.to_str()? {
            "gz" => Some(Packing::Gzip),
            "zst" => Some(Packing::Zstandard),
            _ => None,
        }
    }

    fn of_bytes(bytes: &[u8]) -> Option<Packing> {
        match bytes {
            [0x1f, 0x8b, ..] => Some(Packing::Gzip),
            [0x28, 0xb5, 0x2f, 0xfd, ..] => Some(Packing::Zstandard),
            _ => None,
        }
    }
}

/// How others pack, which is not unpacked here: the ending of their names, how their files begin, and what unpacks them.
const OTHERS: [(&str, &[u8], &str); 4] = [
    ("xz", b"\xfd7zXZ\0", "xz -d"),
    ("bz2", b"BZh91AY&SY", "bzip2 -d"),
    ("zip", b"PK\x03\x04", "unzip"),
    ("7z", b"7z\xbc\xaf\x27\x1c", "7z x"),
];

/// Whether a file that begins so is packed.
pub(crate) fn is_packed(bytes: &[u8]) -> bool {
    Packing::of_bytes(bytes).is_some() || other(bytes).is_some()
}

/// The name of what is packed in a file: without the ending that tells how it is packed.
pub fn name_inside(path: &Path) -> PathBuf {
    if Packing::of_name(path).is_some() { path.with_extension("") } else { path.to_owned() }
}

/// What unpacks files with that ending, where it has to be done before.
pub(crate) fn unpacked_by(ending: &str) -> Option<&'static str> {
    OTHERS.iter().find(|(known, ..)| *known == ending).map(|(.., by)| *by)
}

/// What has packed a file that begins so, if it is not unpacked here.
fn other(bytes: &[u8]) -> Option<std::io::Error> {
    let (ending, _, by) = OTHERS.iter().find(|(_, start, _)| bytes.starts_with(start))?;
    Some(std::io::Error::other(format!(
        "it is packed as .{ending}: unpack it first by `{by}`, or pack it by gzip or zstd"
    )))
}

/// What was packed, or the bytes as they are.
pub(crate) fn unpacked<'a>(file: impl Read + 'a) -> std::io::Result<Box<dyn BufRead + 'a>> {
    let mut file = BufReader::with_capacity(1 << 16, file);
    let start = file.fill_buf()?;
    if let Some(error) = other(start) {
        return Err(error);
    }
    Ok(match Packing::of_bytes(start) {
        None => Box::new(file),
        Some(Packing::Gzip) => Box::new(BufReader::with_capacity(1 << 16, MultiGzDecoder::new(file))),
        Some(Packing::Zstandard) => Box::new(BufReader::with_capacity(1 << 16, zstd::Decoder::with_buffer(file)?)),
    })
}

/// A writer that packs, if a file's name asks for it.
pub(crate) enum Packer<W: Write> {
    Plain(W),
    Gzip(GzEncoder<W>),
    Zstandard(Box<zstd::Encoder<'static, W>>),
}

impl<W: Write> Packer<W> {
    /// A packer of what goes to `path`.
    pub fn new(path: &Path, to: W) -> std::io::Result<Packer<W>> {
        Ok(match Packing::of_name(path) {
            None => Packer::Plain(to),
            Some(Packing::Gzip) => Packer::Gzip(GzEncoder::new(to, Compression::default())),
            Some(Packing::Zstandard) => Packer::Zstandard(Box::new(zstd::Encoder::new(to, 0)?)),
        })
    }

    /// Writes what is left, and gives back where it went to.
    pub fn finish(self) -> std::io::Result<W> {
        match self {
            Packer::Plain(to) => Ok(to),
            Packer::Gzip(to) => to.finish(),
            Packer::Zstandard(to) => to.finish(),
        }
    }
}

impl<W: Write> Write for Packer<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Packer::Plain(to) => to.write(bytes),
            Packer::Gzip(to) => to.write(bytes),
            Packer::Zstandard(to) => to.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self {
            Packer::Plain(to) => to.flush(),
            // What is packed ends when it is finished; to end a part of it before would cost space.
            Packer::Gzip(_) | Packer::Zstandard(_) => Ok(()),
        }
    }
}

impl<W: Write> std::fmt::Debug for Packer<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Packer")
    }
}
