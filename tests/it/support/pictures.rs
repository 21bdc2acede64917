//! PNG files as they were written.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// A picture: what is told of it, and its bytes, line by line.
pub struct Picture {
    pub info: png::Info<'static>,
    pub bytes: Vec<u8>,
}

/// A file's.
pub fn decoded(path: &Path) -> Picture {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    Picture { info: reader.info().clone(), bytes }
}
