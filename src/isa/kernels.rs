//! What instructions work for, and the units of work that they are.

use super::table::Class;
use crate::seam::{Activity, Unit};

/// What `.kernel` can say that the instructions behind it work for, in the order of the activities.
pub const KERNELS: [&str; 4] = ["grid", "slabs", "intersection", "other"];

/// What instructions work for where nothing is said.
pub const OTHER: Activity = Activity(3);

/// The units with lower numbers are not instructions: they are for cells that run none, and for the host.
pub const FIRST_UNIT: u8 = 10;

/// An executed instruction of a class, as a unit of work.
pub fn unit(kernel: Activity, class: Class) -> Unit {
    Unit(FIRST_UNIT + kernel.0 * Class::ALL.len() as u8 + class as u8)
}
