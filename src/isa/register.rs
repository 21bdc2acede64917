//! What an instruction's operands can name: registers and queues.

use std::fmt;

/// A register, or a queue that is read and written like one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Register(u8);

/// A queue as an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Queue {
    /// `x`: read, the next word from X; written, the right neighbour's X.
    X,
    /// `xp`, only to be read: the next word from X, passed on to the right in the cycle in which it is read.
    PassX,
    /// `y`: read, the next word from Y; written, the right neighbour's Y.
    Y,
}

impl Register {
    /// Number of registers, `r0` among them.
    pub const COUNT: u32 = 60;
    /// `r0`, which is always 0; what is written to it is lost.
    pub const ZERO: Register = Register(0);
    /// `x`.
    pub const X: Register = Register(60);
    /// `xp`.
    pub const PASS_X: Register = Register(61);
    /// `y`.
    pub const Y: Register = Register(62);

    /// The register or queue of a number from 0 to 62; 63 names nothing.
    pub fn new(number: u32) -> Option<Register> {
        (number <= 62).then_some(Register(number as u8))
    }

    /// Its number in an instruction's fields.
    pub fn number(self) -> u32 {
        self.0 as u32
    }

    /// All registers and queues.
    pub fn all() -> impl Iterator<Item = Register> {
        (0..63).map(Register)
    }

    /// The register or queue of a name: `r0` to `r59`, `x`, `xp`, `y`.
    pub fn named(name: &str) -> Option<Register> {
        Register::all().find(|register| register.to_string() == name)
    }

    /// The queue that it is, if it is none of the registers.
    pub fn queue(self) -> Option<Queue> {
        match self {
            Register::X => Some(Queue::X),
            Register::PASS_X => Some(Queue::PassX),
            Register::Y => Some(Queue::Y),
            _ => None,
        }
    }
}

impl fmt::Display for Register {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.queue() {
            Some(Queue::X) => f.write_str("x"),
            Some(Queue::PassX) => f.write_str("xp"),
            Some(Queue::Y) => f.write_str("y"),
            None => write!(f, "r{}", self.0),
        }
    }
}
