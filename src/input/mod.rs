//! Text that people write: places in it, numbers checked, RON whose values know where they stand.

pub(crate) mod fields;
pub(crate) mod file;
pub(crate) mod lines;
pub(crate) mod packed;
pub(crate) mod reading;
pub(crate) mod ron_text;
pub(crate) mod text;

pub use file::{STREAM, is_stream};
pub use packed::name_inside;
