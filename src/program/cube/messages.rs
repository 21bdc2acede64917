//! What nodes tell each other, by kind, and how long it is.

use crate::machine::Cycles;
pub use crate::program::messages::MessageKind;

/// The messages of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MessageCounts {
    /// How many were sent.
    pub sent: u64,
    /// How many were taken.
    pub taken: u64,
    /// Their bytes.
    pub bytes: u64,
    /// The links that they passed.
    pub hops: u64,
    /// What the processors at both ends spend on them, but for what is in them.
    pub processor: Cycles,
}

impl MessageCounts {
    /// One is sent over so many links, on which its sender spends some time.
    pub(super) fn send(&mut self, bytes: u64, hops: u64, time: Cycles) {
        self.sent += 1;
        self.bytes += bytes;
        self.hops += hops;
        self.processor += time;
    }

    /// One is taken, on which that takes some time.
    pub(super) fn take(&mut self, time: Cycles) {
        self.taken += 1;
        self.processor += time;
    }
}

/// The messages of each kind, in the order of [`MessageKind::ALL`].
pub type Messages = [MessageCounts; MessageKind::ALL.len()];

/// What was sent from one to another, of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sent {
    /// How many messages.
    pub messages: u64,
    /// Their bytes.
    pub bytes: u64,
}

/// Bytes of a ray: pixel 4, owner 2, kind, turns and hops 2, credit 4, origin 12, direction 12, end 4, weight 12. With the rule `own` it has one more word,
/// the polygon that it starts on.
pub const RAY_BYTES: u64 = 52;
/// Bytes of a result: pixel 4, credit 4, light 12.
pub const RESULT_BYTES: u64 = 20;
/// Bytes of a packet of pixels, beside them.
pub const PACKET_BYTES: u64 = 8;
/// Bytes of a pixel in it.
pub const PIXEL_BYTES: u64 = 16;
/// Pixels of a packet at the most.
pub const PACKET_PIXELS: u32 = 64;
/// Bytes of a word that only says that something is so.
pub const WORD_BYTES: u64 = 4;
/// Bytes of a token, and of a request for a page.
pub const TOKEN_BYTES: u64 = 16;
/// Bytes of a page's message beside the page.
pub const PAGE_HEAD_BYTES: u64 = 8;
/// Bytes of a block of the scene.
pub const BLOCK_BYTES: u64 = 4096;

/// Bytes of a packet of so many pixels.
pub fn packet_bytes(pixels: u32) -> u64 {
    PACKET_BYTES + PIXEL_BYTES * u64::from(pixels)
}
