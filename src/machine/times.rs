//! What the three kernels cost (Figure 7).

use crate::quantities::Cycles;

/// The times of one kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Times {
    /// Once a ray, when the kernel is entered.
    pub start: Cycles,
    /// For each voxel (grid) or polygon (slabs, intersection).
    pub each: Cycles,
}

/// What the host spends, beside writing the words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HostTimes {
    /// On each ray, before it sends it.
    pub ray: Cycles,
    /// On shading a hit.
    pub hit: Cycles,
    /// On telling whether a sample of the picture can hit anything.
    pub filter: Cycles,
    /// On telling whether a ray meets a sub-volume.
    pub mask: Cycles,
}

/// The times of all kernels, and the host's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KernelTimes {
    /// The walk through the grid, a voxel.
    pub grid: Times,
    /// The slabs test, a polygon.
    pub slabs: Times,
    /// The intersection test, a polygon.
    pub intersection: Times,
    /// The host.
    pub host: HostTimes,
    /// A cell, or the host, on each message that it sends or takes, where that is counted.
    pub message: Option<Cycles>,
}
