//! Nodes that wait for each other.

use std::fmt;

use crate::host::shading::RayKind;

/// A node that has a ray for which another has no slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Waiting {
    /// The node.
    pub node: usize,
    /// The ray.
    pub ray: u32,
    /// What the ray is for.
    pub kind: RayKind,
    /// The pixel that it is for, or the sample.
    pub tree: u32,
    /// The node that has no slot.
    pub to: usize,
}

/// No node can go on: each of a circle waits for the next.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Stuck {
    /// The circle, in its order.
    pub circle: Vec<Waiting>,
    /// How many slots a node has.
    pub slots: u32,
    /// How many it takes for rays never to get stuck.
    pub enough: u32,
}

impl Stuck {
    /// The circle among nodes that wait.
    pub fn new(waiting: &[Waiting], slots: u32, enough: u32) -> Stuck {
        let of = |node: usize| waiting.iter().find(|waiting| waiting.node == node).copied();
        let mut way: Vec<Waiting> = Vec::new();
        let mut at = waiting.first().copied();
        while let Some(waits) = at {
            if let Some(start) = way.iter().position(|earlier| earlier.node == waits.node) {
                way.drain(..start);
                break;
            }
            way.push(waits);
            at = of(waits.to);
        }
        Stuck { circle: way, slots, enough }
    }
}

impl fmt::Display for Stuck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the nodes are stuck: each waits for a slot of the next, which none gives free")?;
        for Waiting { node, ray, kind, tree, to } in &self.circle {
            let (kind, slots) = (kind.name(), self.slots);
            write!(
                f,
                "\n  node {node} waits to send ray {ray} ({kind}, pixel {tree}) to node {to} ({slots} of {slots} slots taken)"
            )?;
        }
        let enough = self.enough;
        write!(
            f,
            "\nhelp: --flow classes with --queue-rays {enough} or more never gets stuck; with more slots or --pixel-order strided, \
            block may get through"
        )
    }
}
