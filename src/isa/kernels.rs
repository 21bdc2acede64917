//! What instructions work for, and the units of work that they are.

use super::table::Class;
use crate::seam::{Activity, Unit};

/// What `.kernel` can say that the instructions behind it work for, in the order of the activities.
pub const KERNELS: [&str; 4] = ["grid", "slabs", "intersection", "other"];

/// What instructions work for where nothing is said.
pub const OTHER: Activity = Activity(3);

/// The units with lower numbers are not instructions: they are for cells that run none, and for the host.
pub const FIRST_UNIT: u8 = 10;

/// What a wait for a floating-point result is called as a unit of work, and its cycles in machine files.
pub const FLOAT_LATENCY: &str = "float_latency";

/// A wait for a floating-point result, as a unit of work: behind all instructions.
pub const fn float_wait(kernel: Activity) -> Unit {
    Unit(FIRST_UNIT + (KERNELS.len() * Class::ALL.len()) as u8 + kernel.0)
}

/// An executed instruction of a class, as a unit of work.
pub fn unit(kernel: Activity, class: Class) -> Unit {
    Unit(FIRST_UNIT + kernel.0 * Class::ALL.len() as u8 + class as u8)
}
