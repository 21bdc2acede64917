//! What a run takes at the least, by what its rays make the nodes do.

use super::{CubeOutcome, CubeScene, CubeSetup, CubeSpec};
use crate::machine::Ipsc2;
use crate::model::Bounds;
use crate::program::cube::Dealt;

impl CubeSetup {
    /// What the run takes at the least.
    pub fn bounds(&self, outcome: &CubeOutcome) -> Bounds {
        self.spec.bounds(&self.scene, &self.machine, &outcome.node_of)
    }
}

impl CubeSpec {
    /// The same, where it is told which node each region is on.
    pub(crate) fn bounds(&self, scene: &CubeScene, machine: &Ipsc2, node_of: &[u16]) -> Bounds {
        let graph = &scene.graph;
        match &self.regions {
            Some(spec) => Bounds::of_regions(machine, graph, node_of, &self.owners(spec, graph, node_of)),
            None => {
                let owners = tracers(&self.dealt(machine.nodes), graph.trees.len());
                Bounds::of_shared_memory(machine, graph, owners.as_deref())
            }
        }
    }
}

/// The node that traces each of so many trees, where that is known before.
fn tracers(dealt: &Dealt, trees: usize) -> Option<Vec<u16>> {
    let Dealt::Before(nodes) = dealt else { return None };
    let mut owners = vec![0; trees];
    for (node, own) in nodes.iter().enumerate() {
        own.iter().for_each(|&tree| owners[tree as usize] = node as u16);
    }
    Some(owners)
}
