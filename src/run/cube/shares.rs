//! Who has what: each region's node, each node's part of the scene, its slots and its pixels.

use std::ops::Range;

use super::options::{Distribution, FlowKind, Mapping, PixelOrder, PixelsOf, QueueRays};
use super::{CubeScene, CubeSpec, Cut, RegionSpec};
use crate::error::InputError;
use crate::host::camera::ImageSize;
use crate::machine::Ipsc2;
use crate::program::cube::{Dealt, Part, TaskGraph, gray_order, swapped};

/// Pixels along the side of a tile.
const TILE: u32 = 8;

impl CubeSpec {
    /// Each region's node.
    pub(super) fn node_of(&self, cut: &Cut, machine: &Ipsc2) -> Vec<u16> {
        let gray = gray_order(machine.nodes);
        match self.regions.map(|regions| regions.mapping) {
            None => vec![0],
            Some(Mapping::Gray) => gray,
            Some(Mapping::Swapped) => swapped(gray, &cut.between),
        }
    }

    /// Each node's part of the scene.
    pub(super) fn parts(&self, scene: &CubeScene, machine: &Ipsc2, node_of: &[u16]) -> Vec<Part> {
        let mut parts = vec![Part::default(); machine.nodes];
        match &scene.graph.pages {
            None => scene.cut.parts.iter().zip(node_of).for_each(|(part, &node)| parts[usize::from(node)] = *part),
            Some(uses) => {
                let pages = u64::from(uses.pages).div_ceil(machine.nodes as u64);
                let bytes = pages * u64::from(uses.page_bytes);
                parts.fill(Part { bytes, holds: bytes, ..Part::default() });
            }
        }
        parts
    }

    /// How many slots each node has, if these are limited.
    ///
    /// Fails if the scene and they do not fit into a node's memory.
    pub(super) fn slots(&self, graph: &TaskGraph, parts: &[Part], machine: &Ipsc2) -> Result<Option<u32>, InputError> {
        let asked = self.regions.and_then(|regions| regions.queue_rays);
        let fullest = parts.iter().enumerate().max_by_key(|(node, part)| (part.holds, std::cmp::Reverse(*node)));
        let Some((node, part)) = fullest else { return Ok(None) };
        let room = machine.memory_bytes.checked_sub(part.holds);
        let fits = room.map(|bytes| u32::try_from(bytes / graph.ray_bytes()).unwrap_or(u32::MAX - 1));
        let slots = match asked {
            Some(QueueRays::Count(count)) => count,
            Some(QueueRays::Memory) => fits.unwrap_or(0).max(1),
            None => 0,
        };
        if fits.is_some_and(|most| slots <= most) {
            return Ok(asked.is_some().then_some(slots));
        }
        let message = format!(
            "the scene does not fit: node {node} needs {} bytes for it and {} for {slots} rays, and has {}",
            part.holds,
            graph.ray_bytes() * u64::from(slots),
            machine.memory_bytes
        );
        Err(InputError::new(message)
            .help("take more nodes, a smaller --grid-coefficient, fewer --queue-rays or more --node-kbyte"))
    }

    /// Fails if there are too few slots for classes.
    pub(super) fn check_slots(&self, slots: Option<u32>, highest_rank: u32) -> Result<(), InputError> {
        let is_pool = self.regions.is_some_and(|regions| regions.flow == FlowKind::Classes);
        let Some(slots) = slots.filter(|&slots| is_pool && slots <= highest_rank) else { return Ok(()) };
        let message =
            format!("classes need a slot for each rank: {} of them, and a node has {slots}", highest_rank + 1);
        Err(InputError::new(message).help("ask for more --queue-rays, or for another --flow"))
    }

    /// The node that each tree belongs to, of nodes that have regions.
    pub(super) fn owners(&self, spec: &RegionSpec, graph: &TaskGraph, node_of: &[u16]) -> Vec<u16> {
        let per_pixel = (self.rays.samples as usize).pow(2);
        let owner = |tree: usize| match spec.pixels {
            PixelsOf::Owner => node_of[usize::from(graph.start_of(graph.trees[tree]))],
            PixelsOf::Shared => (tree / per_pixel % node_of.len()) as u16,
        };
        (0..graph.trees.len()).map(owner).collect()
    }

    /// The owners of pixels, of those of their samples: the first one's.
    pub(super) fn of_pixels(&self, owners: Vec<u16>) -> Vec<u16> {
        owners.into_iter().step_by((self.rays.samples as usize).pow(2).max(1)).collect()
    }

    /// The trees of nodes that share a memory.
    pub(super) fn dealt(&self, nodes: usize) -> Dealt {
        let ImageSize { width, height } = self.size;
        let per_pixel = self.rays.samples.pow(2);
        let trees = |y: u32, across: Range<u32>| {
            let line = y * width;
            (line + across.start) * per_pixel..(line + across.end) * per_pixel
        };
        match self.distribution {
            Distribution::Lines => {
                let lines = |node: usize| (node as u32..height).step_by(nodes);
                Dealt::Before((0..nodes).map(|node| lines(node).flat_map(|y| trees(y, 0..width)).collect()).collect())
            }
            Distribution::Tiles => {
                let tiles = self.size.tiles(TILE);
                let trees = |pixel: usize| (0..per_pixel).map(move |sample| pixel as u32 * per_pixel + sample);
                Dealt::AsAsked(tiles.map(|tile| tile.flat_map(trees).collect()).collect())
            }
        }
    }
}

/// Trees in the order in which each node begins its own.
pub(super) fn order(spec: &RegionSpec, trees: usize) -> Vec<u32> {
    let bits = trees.next_power_of_two().ilog2();
    match spec.pixel_order {
        PixelOrder::Strided if bits > 0 => {
            let all = (0..1u64 << bits).map(|number| number.reverse_bits() >> (64 - bits));
            all.filter(|&tree| tree < trees as u64).map(|tree| tree as u32).collect()
        }
        _ => (0..trees as u32).collect(),
    }
}
