//! Constructive solid geometry: unions, intersections and differences of closed shapes, evaluated to polygons before a
//! scene is loaded (RR-0992, section 1; Argence's thesis, chapters 1 and 2).
//!
//! A [`Solid`] is a tree. Its leaves are closed [`Shell`]s: unit primitives, as the language Castor has them, prisms, tori
//! and any closed mesh. [`evaluate`] makes a [`Mesh`](super::Mesh) of it, all of whose faces are flat and convex, and
//! tells what it came to in a [`Report`]. The Boolean operations themselves are those of the crate `manifold-rust`.
//!
//! - **Materials and objects** are by origin: each face has the material of the shell's face that it is a part of, and is of
//!   the same object as all faces of that shell and that smooth surface. Normals of curved surfaces are kept; where a shape
//!   was cut off they are turned over.
//! - **Faces that coincide** are told apart by a rule. The result is regular: it has no sheets without volume. Of two
//!   faces in one plane that look the same way, the one that comes first in the tree stays, or the one of the
//!   shell with the higher priority. Where faces look at each other, a union has neither, and `a - b` keeps that of `a`.
//! - Coordinates are double until the end. Those that differ by less than some parts in 10^13 of the solid's size are one,
//!   so that 0.1 + 0.2 meets 0.3.

mod check;
mod evaluate;
mod import;
mod inside;
mod planes;
mod polygons;
mod primitives;
mod report;
mod shell;
mod sources;

pub use evaluate::{Evaluated, Options, evaluate};
pub use report::Report;
pub use shell::Shell;

use glam::DAffine3;

/// A tree of operations on closed shapes.
#[derive(Clone, Debug)]
pub enum Solid {
    /// A closed shape.
    Leaf {
        /// Its faces.
        shell: Shell,
        /// Which shape's face stays where two coincide: the higher number's. By default it is 0.
        priority: i32,
    },
    /// What is in any of the solids.
    Union(Vec<Solid>),
    /// What is in all of them.
    Intersection(Vec<Solid>),
    /// What is in the first one and in none of the others.
    Difference(Vec<Solid>),
    /// A solid moved, turned, scaled or mirrored; the map has an inverse.
    Place(DAffine3, Box<Solid>),
}

/// What a face is made of where one solid was cut by another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
pub enum Cut {
    /// What the surface that cut it is made of.
    #[default]
    Surface,
    /// What the solid behind the face is made of: the first operand of a difference or an intersection, the first one
    /// there of a union.
    Volume,
}

impl Solid {
    /// A closed shape without a priority.
    pub fn leaf(shell: Shell) -> Solid {
        Solid::Leaf { shell, priority: 0 }
    }

    /// The solid placed by a map.
    pub fn placed(self, map: DAffine3) -> Solid {
        Solid::Place(map, Box::new(self))
    }

    /// Gives each face another material.
    pub(crate) fn change_materials(&mut self, change: &mut impl FnMut(u32) -> u32) {
        match self {
            Solid::Leaf { shell, .. } => shell.change_materials(change),
            Solid::Union(solids) | Solid::Intersection(solids) | Solid::Difference(solids) => {
                solids.iter_mut().for_each(|solid| solid.change_materials(change));
            }
            Solid::Place(_, solid) => solid.change_materials(change),
        }
    }

    /// How many closed shapes it has.
    pub fn leaves(&self) -> usize {
        match self {
            Solid::Leaf { .. } => 1,
            Solid::Union(solids) | Solid::Intersection(solids) | Solid::Difference(solids) => {
                solids.iter().map(Solid::leaves).sum()
            }
            Solid::Place(_, solid) => solid.leaves(),
        }
    }

    /// Which faces stay where those of two solids coincide: the higher number's. A union and an intersection have the
    /// highest of their operands, a difference has its first one's.
    fn priority(&self) -> i32 {
        match self {
            Solid::Leaf { priority, .. } => *priority,
            Solid::Union(solids) | Solid::Intersection(solids) => {
                solids.iter().map(Solid::priority).max().unwrap_or_default()
            }
            Solid::Difference(solids) => solids.first().map(Solid::priority).unwrap_or_default(),
            Solid::Place(_, solid) => solid.priority(),
        }
    }
}
