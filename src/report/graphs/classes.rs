//! What of the three graphs is known before a run, what is estimated, and what the run makes: the classification of ways to trace rays that
//! the chapter proposes (I.5, I.6).

use serde::Serialize;

use super::graph::Graph;
use super::labels::Labels;

/// How rays are shared out, as far as the classification tells ways apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// One cell does all.
    OneCell,
    /// One group of cells, each with a part of the computation.
    Pipeline,
    /// Groups of cells, each with a part of the scene; all rays come to all.
    Groups {
        /// Whether the parts are cut by the work of a sub-sample.
        by_work: bool,
    },
    /// Nodes with a region each, and rays between them.
    Regions,
    /// Nodes with whole pixels, and a scene that they share.
    SharedMemory,
}

/// A graph, before and after.
#[derive(Serialize)]
struct Known {
    before: &'static str,
    because: &'static str,
    vertices: usize,
    edges: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    topology: Option<Labels>,
}

#[derive(Serialize)]
struct Classification {
    class: &'static str,
    #[serde(rename = "G_p")]
    processes: Known,
    #[serde(rename = "G_r")]
    real: Known,
    #[serde(rename = "G_v")]
    rays: Known,
}

/// How much is known of a graph before the run, and why.
type Before = (&'static str, &'static str);

impl Way {
    /// The chapter's class.
    fn class(self) -> &'static str {
        match self {
            Way::OneCell => "I.5 example 1, but for the grid",
            Way::Pipeline => "I.5 example 4: a pipeline",
            Way::Groups { by_work: false } => "I.5 example 2 for objects, example 4 for rays",
            Way::Groups { by_work: true } => {
                "I.5 example 2 for objects, example 4 for rays; cut by a pre-sampling (BBP89)"
            }
            Way::Regions => "I.5 example 3, I.6 2): voxels of space, cut by a pre-sampling (BBP89)",
            Way::SharedMemory => "I.5 example 2, I.6 1) (2): primary rays in groups, the scene distributed (BP90)",
        }
    }

    /// G_p before the run.
    fn processes(self) -> Before {
        match self {
            Way::OneCell => ("known", "one vertex beside the host"),
            Way::Pipeline => ("known", "a chain of kernels"),
            Way::Groups { .. } => ("known", "a chain of cells"),
            Way::Regions | Way::SharedMemory => ("known", "the connectivity of the hypercube"),
        }
    }

    /// G_r before the run.
    fn real(self) -> Before {
        match self {
            Way::OneCell | Way::Pipeline => ("over-estimated", "the grid lists a polygon in several voxels"),
            Way::Groups { .. } => ("over-estimated", "sub-volumes share polygons; each is tied to a group of cells"),
            Way::Regions => ("over-estimated", "regions share polygons; each is tied to a node"),
            Way::SharedMemory => {
                ("estimated", "pages are dealt out to nodes, and completed by messages of real objects")
            }
        }
    }

    /// G_v before the run.
    fn rays(self) -> Before {
        match self {
            Way::OneCell | Way::Pipeline => {
                ("unknown", "one vertex: the rays are no more than a set; the host makes the trees")
            }
            Way::Groups { by_work: false } => ("unknown", "as of a pipeline, and every process has every ray"),
            Way::Groups { by_work: true } => ("estimated", "by a sub-sample of the rays; every process has every ray"),
            Way::Regions => ("estimated", "by a sub-sample of whole trees; made by messages of virtual objects"),
            Way::SharedMemory => ("under-estimated", "primary rays alone are known; they are tied to nodes"),
        }
    }
}

/// The classification of a run with these graphs (G_r, G_v, G_p), as JSON.
pub fn classification(way: Way, [real, rays, processes]: [&Graph; 3]) -> String {
    let known = |(before, because): Before, graph: &Graph| Known {
        before,
        because,
        vertices: graph.vertices.len(),
        edges: graph.edges.len(),
        topology: None,
    };
    let told = Classification {
        class: way.class(),
        processes: Known { topology: Some(Labels::of(processes)), ..known(way.processes(), processes) },
        real: known(way.real(), real),
        rays: known(way.rays(), rays),
    };
    // Words and numbers alone, which JSON can tell in any case.
    serde_json::to_string_pretty(&told).unwrap_or_default() + "\n"
}
