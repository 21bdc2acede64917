//! The graphs of a run, after the chapter *Définitions* of a thesis on parallel ray tracing: G_r of what is real, G_v of what is virtual
//! (the rays), G_p of the processes; and which of them are known before the run, which are estimated, and which it makes.
//!
//! | graph | vertices | edges |
//! | --- | --- | --- |
//! | G_r | sub-volumes, regions or memories; by choice objects or polygons beside | contiguity; containment, which is the relation (process, object) where parts of the scene belong to processes |
//! | G_v | rays of a kind and generation, in a region if they start in one; by choice single rays | which ask for which; which hit which object: the function f |
//! | G_p | host, cells or nodes | channels or links, with their messages by kind and a label |

mod classes;
mod cube;
mod files;
mod graph;
mod labels;
mod line;
mod rays;
mod real;

pub use cube::of_cube;
pub use files::Format;
pub use graph::{Attributes, Edge, Graph, Value, Vertex};
pub use labels::Labels;
pub use line::{Gathered, of_line};
pub use rays::{PixelWindow, RayNote};

use crate::run::Watching;

/// What the vertices of G_r are beside the parts of the scene that processes have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Of {
    /// Nothing else.
    #[default]
    Regions,
    /// The objects of the scene.
    Objects,
    /// Its polygons, if they are no more than 10 000.
    Polygons,
}

/// What is asked of graphs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// The vertices of G_r.
    pub of: Of,
    /// The pixels of which G_v has each ray, if it is to have single rays.
    pub pixels: Option<PixelWindow>,
}

impl Asked {
    /// What is to be watched of the run for them.
    pub fn watching(&self) -> Watching {
        Watching { spans: self.pixels.is_some(), ..Watching::default() }
    }
}

/// The graphs of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Graphs {
    /// G_r.
    pub real: Graph,
    /// G_v.
    pub rays: Graph,
    /// G_p.
    pub processes: Graph,
    /// What is known of them when, as JSON.
    pub classification: String,
}

impl Graphs {
    /// The three graphs.
    pub fn all(&self) -> [&Graph; 3] {
        [&self.real, &self.rays, &self.processes]
    }
}
