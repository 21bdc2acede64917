//! A scene laid out: its polygons in the array's terms, cut into sub-volumes, each with its grid.

use std::sync::Arc;

use crate::cancel::{Cancel, Cancelled};
use crate::error::InputError;
use crate::geometry::grid::Unfilled;
use crate::geometry::partition::{self, SubVolume};
use crate::geometry::{Bounds, Edges, Grid, Polygons, Ray, Slabs};
use crate::scene::Mesh;

/// A scene's polygons as the array has them: in 32 bits, each with its slabs, and with margins that hold for its rays.
#[derive(Clone, Debug)]
pub struct Surfaces {
    pub(super) polygons: Polygons,
    pub(super) slabs: Slabs,
}

impl Surfaces {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> u64 {
        self.polygons.bytes() + self.slabs.bytes()
    }

    /// Those of a mesh that `rays` are traced through.
    pub fn new(mesh: &Mesh, rays: &[Ray]) -> Surfaces {
        Surfaces::with_edges(mesh, rays, Edges::Paper)
    }

    /// The same with an inside of the polygons that is told in one way or another.
    pub fn with_edges(mesh: &Mesh, rays: &[Ray], edges: Edges) -> Surfaces {
        let polygons = Polygons::for_rays(mesh, rays).with_edges(edges);
        Surfaces { slabs: Slabs::new(&polygons), polygons }
    }

    /// The polygons.
    pub fn polygons(&self) -> &Polygons {
        &self.polygons
    }
}

/// A scene laid out: its surfaces, and the grids of the groups of an array program.
#[derive(Clone, Debug)]
pub struct Layout {
    pub(super) surfaces: Arc<Surfaces>,
    pub(super) groups: Vec<Group>,
}

/// A group's part of the scene.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Its part of the scene's box. Those of all groups fill it.
    pub volume: Bounds,
    pub members: Vec<u32>,
    pub grid: Grid,
}

/// Why a scene was not laid out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotLaidOut {
    /// The array program does not go with the scene.
    #[error(transparent)]
    Unfit(#[from] InputError),
    /// It was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<Unfilled> for NotLaidOut {
    fn from(unfilled: Unfilled) -> NotLaidOut {
        match unfilled {
            Unfilled::TooLarge(error) => NotLaidOut::Unfit(InputError::new(error.to_string())),
            Unfilled::Cancelled(cancelled) => NotLaidOut::Cancelled(cancelled),
        }
    }
}

impl Layout {
    /// The memory that it takes beside its surfaces, in bytes.
    pub fn bytes(&self) -> u64 {
        self.groups.iter().map(|group| group.grid.bytes() + size_of_val(&group.members[..]) as u64).sum()
    }

    /// The layout with these sub-volumes, whose grids have `coefficient` voxels a polygon.
    ///
    /// Fails if a grid would be too large, and if it is told to stop.
    pub(super) fn in_boxes(
        surfaces: Arc<Surfaces>,
        boxes: &[Bounds],
        coefficient: f64,
        cancel: &Cancel,
    ) -> Result<Layout, NotLaidOut> {
        let fill = |sub_volume: SubVolume| {
            let SubVolume { members, volume } = sub_volume;
            let grid = Grid::new(&surfaces.polygons, &members, volume, coefficient, cancel)?;
            Ok::<_, NotLaidOut>(Group { volume, grid, members })
        };
        let groups = partition::assign(&surfaces.polygons, boxes).into_iter().map(fill).collect::<Result<_, _>>()?;
        Ok(Layout { surfaces, groups })
    }
}
