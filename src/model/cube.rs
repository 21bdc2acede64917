//! What an image on a hypercube takes at the least, whatever waits for whom: a run can be no shorter than the work of its busiest node, than
//! the longest chain of work that follows from each other in one pixel, and than an equal part of all work.

use crate::geometry;
use crate::machine::events::Cube;
use crate::machine::{Cycles, Ipsc2};
use crate::program::cube::{PACKET_PIXELS, RESULT_BYTES, TaskGraph, packet_bytes};

/// Three bounds of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// What each node has to do, messages too; none where nodes ask for their pixels as they go.
    pub work: Vec<Cycles>,
    /// The longest chain of one pixel: from its beginning to its last result.
    pub chain: Cycles,
    /// An equal part of all work.
    pub equal: Cycles,
    /// Rays that are sent from node to node.
    pub ray_messages: u64,
}

/// How many of some regions a random line meets that meets all of them together: one that meets a convex body meets a convex part of it as
/// often as that has a part of its surface (Cauchy).
pub fn regions_of_random_line(regions: &[geometry::Bounds], volume: &geometry::Bounds) -> f64 {
    regions.iter().map(geometry::Bounds::surface).sum::<f64>() / volume.surface()
}

/// Work that is added up.
struct Work<'a> {
    machine: &'a Ipsc2,
    graph: &'a TaskGraph,
    cube: Cube,
    nodes: Vec<Cycles>,
    ray_messages: u64,
}

impl Bounds {
    /// Those of nodes with regions: each region is on the node that `node_of` tells, each tree is begun by the node in `owners`.
    pub fn of_regions(machine: &Ipsc2, graph: &TaskGraph, node_of: &[u16], owners: &[u16]) -> Bounds {
        let mut work = Work::new(machine, graph);
        let node = |region: u16| usize::from(node_of[usize::from(region)]);
        let mut chain = Cycles(0);
        // When each ray of a tree can begin, and on which node it is then.
        let mut begins = Vec::new();
        for (tree, &owner) in owners.iter().enumerate() {
            let (rays, owner) = (graph.tree(tree), usize::from(owner));
            let first = rays.start;
            begins.clear();
            begins.resize(rays.len(), (Cycles(0), owner));
            begins[0].0 = machine.costs.pixel;
            work.nodes[owner] += machine.costs.pixel;
            for ray in rays {
                let (mut now, mut at) = begins[(ray - first) as usize];
                for (leg, task) in (graph.rays[ray as usize].first_leg..).zip(graph.legs_of(ray)) {
                    let next = node(task.region);
                    now += work.message(at, next, graph.ray_bytes());
                    work.ray_messages += u64::from(next != at);
                    at = next;
                    let time = graph.time(ray, leg, &machine.times).all();
                    work.nodes[at] += time;
                    now += time;
                }
                let (children, count) = graph.rays[ray as usize].children;
                (children..children + count).for_each(|child| begins[(child - first) as usize] = (now, at));
                now += work.message(at, owner, RESULT_BYTES);
                if at != owner {
                    work.nodes[owner] += machine.costs.result;
                    now += machine.costs.result;
                }
                chain = chain.max(now);
            }
        }
        work.packets(owners);
        work.bounds(chain, true)
    }

    /// Those of nodes with a shared memory, of which `owners` tells who traces each tree, if that is known before.
    pub fn of_shared_memory(machine: &Ipsc2, graph: &TaskGraph, owners: Option<&[u16]>) -> Bounds {
        let mut work = Work::new(machine, graph);
        let mut chain = Cycles(0);
        for tree in 0..graph.trees.len() {
            let rays = graph.tree(tree).map(|ray| graph.time_in_one(ray, &machine.times).all());
            let time = machine.costs.pixel + rays.sum();
            chain = chain.max(time);
            let node = owners.map(|owners| usize::from(owners[tree]));
            let lookups = node.map_or(Cycles(0), |node| work.lookups(tree, node));
            work.nodes[node.unwrap_or(0)] += time + lookups;
        }
        if let Some(owners) = owners {
            work.packets(owners);
        }
        work.bounds(chain, owners.is_some())
    }

    /// Those of an image of which these are of a share of the pixels, one in so many.
    pub fn scaled(&self, times: f64) -> Bounds {
        let scaled = |number: u64| (number as f64 * times).round() as u64;
        Bounds {
            work: self.work.iter().map(|work| Cycles(scaled(work.0))).collect(),
            chain: self.chain,
            equal: Cycles(scaled(self.equal.0)),
            ray_messages: scaled(self.ray_messages),
        }
    }

    /// The node that has most to do, the first of several, and what that takes.
    pub fn busiest(&self) -> Option<(usize, Cycles)> {
        let nodes = self.work.iter().copied().enumerate();
        nodes.rev().max_by_key(|(_, work)| *work)
    }

    /// The highest of the three.
    pub fn least(&self) -> Cycles {
        let busiest = self.busiest().map_or(Cycles(0), |(_, work)| work);
        busiest.max(self.chain).max(self.equal)
    }
}

impl<'a> Work<'a> {
    fn new(machine: &'a Ipsc2, graph: &'a TaskGraph) -> Work<'a> {
        Work { machine, graph, cube: machine.cube(), nodes: vec![Cycles(0); machine.nodes], ray_messages: 0 }
    }

    /// A node sends another a message, if it is another. Returns what that takes from when it begins to until it has been taken.
    fn message(&mut self, from: usize, to: usize, bytes: u64) -> Cycles {
        if from == to {
            return Cycles(0);
        }
        let time = self.machine.messages.of(bytes);
        self.nodes[from] += time;
        self.nodes[to] += time;
        time + self.cube.least_time(from, to, bytes) + time
    }

    /// Each node sends its pixels, of which `owners` are the nodes, to the host.
    fn packets(&mut self, owners: &[u16]) {
        let mut pixels = vec![0u32; self.nodes.len()];
        owners.iter().for_each(|&owner| pixels[usize::from(owner)] += 1);
        for (work, pixels) in self.nodes.iter_mut().zip(pixels) {
            let packet = |pixels: u32| self.machine.messages.of(packet_bytes(pixels)).0;
            let (whole, rest) = (pixels / PACKET_PIXELS, pixels % PACKET_PIXELS);
            work.0 += u64::from(whole) * packet(PACKET_PIXELS) + if rest > 0 { packet(rest) } else { 0 };
        }
    }

    /// What a node spends on looking the pages of others up which a tree reads.
    fn lookups(&self, tree: usize, node: usize) -> Cycles {
        let Some(uses) = &self.graph.pages else { return Cycles(0) };
        let count = self.nodes.len() as u32;
        let of_others = |&&(page, _): &&(u32, u32)| (page % count) as usize != node;
        let reads = self.graph.tree(tree).flat_map(|ray| uses.of_ray(ray)).filter(of_others);
        Cycles(reads.map(|&(_, reads)| u64::from(reads)).sum::<u64>() * self.machine.costs.lookup.0)
    }

    fn bounds(self, chain: Cycles, is_known: bool) -> Bounds {
        let all: u64 = self.nodes.iter().map(|work| work.0).sum();
        let equal = Cycles(all.div_ceil(self.nodes.len().max(1) as u64));
        let work = if is_known { self.nodes } else { Vec::new() };
        Bounds { work, chain, equal, ray_messages: self.ray_messages }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// A cube has a surface of 6, each half of it one of 4: every third line of those that meet it meets both.
    #[test]
    fn lines_meet_regions_by_their_surface() {
        let cube = geometry::Bounds { low: DVec3::ZERO, high: DVec3::ONE };
        let (left, right) = cube.cut(0, 0.5);
        assert_eq!(regions_of_random_line(&[cube], &cube), 1.0);
        assert_eq!(regions_of_random_line(&[left, right], &cube), 8.0 / 6.0);
    }
}
