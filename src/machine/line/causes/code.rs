//! What cycles of a line's path are spent on.

use crate::machine::chains::Code;
use crate::seam::{Channel, Vocabulary};

impl Code {
    pub const MOVE: Code = Code(Vocabulary::MOST_UNITS as u8);

    pub fn latency(channel: Channel) -> Code {
        Code(Code::MOVE.0 + 1 + channel as u8)
    }

    pub fn wire(channel: Channel) -> Code {
        Code(Code::MOVE.0 + 4 + channel as u8)
    }

    pub fn slot(channel: Channel) -> Code {
        Code(Code::MOVE.0 + 7 + channel as u8)
    }
}
