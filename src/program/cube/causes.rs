//! By what names it is told what the chain of causes of a run is made of, and what each leg of a ray consists of.

use super::graph::{Leg, TaskGraph};
use super::messages::{MessageKind, PAGE_HEAD_BYTES, RESULT_BYTES, TOKEN_BYTES, packet_bytes};
use super::states::{GRID, INTERSECTION, LOOKUP, PIXELS, RECEIVING, SENDING, SERVING, SHADING, SLABS};
use crate::machine::events::{Explanation, PIECE_UNITS, Work};
use crate::machine::{Cycles, Ipsc2};
use crate::measure::{PathUnit, StateId};
use crate::seam::Unit;

/// The first units are those of a leg; of each the machine's file has the price.
const OF_LEGS: usize = 7;

/// Beginning a pixel.
pub(super) const PIXEL: Work = Work::Unit(Unit(OF_LEGS as u8));
/// Looking pages up.
pub(super) const LOOK_UP: Work = Work::Unit(Unit(OF_LEGS as u8 + 1));
/// Serving a page.
pub(super) const SERVE: Work = Work::Unit(Unit(OF_LEGS as u8 + 2));
/// Sending a message of the first kind; those of the others follow, and then taking them.
const SENDS: u8 = OF_LEGS as u8 + 3;
const TAKES: u8 = SENDS + MessageKind::ALL.len() as u8;
/// A message that has its links, and one on its way.
const LINKS: Unit = Unit(TAKES + MessageKind::ALL.len() as u8);
const WAY: Unit = Unit(LINKS.0 + 1);

/// A node, or the host, is at work on sending a message.
pub(super) fn sends(kind: MessageKind) -> Unit {
    Unit(SENDS + kind as u8)
}

/// A node, or the host, takes a message.
pub(super) fn takes(kind: MessageKind) -> Work {
    Work::Unit(Unit(TAKES + kind as u8))
}

/// By what names causes are told, of work that consists of such pieces. What messages take is told of those that are sent most.
pub(super) fn explanation(
    machine: &Ipsc2,
    (page_bytes, ray_bytes): (u32, u64),
    pieces: Vec<[u32; PIECE_UNITS]>,
) -> Explanation {
    let unit = |name: &str, state: StateId, cycles| PathUnit { name: name.to_owned(), state, cycles };
    let (times, costs) = (&machine.times, &machine.costs);
    let bytes = |kind| match kind {
        MessageKind::RealObject => PAGE_HEAD_BYTES + u64::from(page_bytes),
        MessageKind::VirtualObject => ray_bytes,
        MessageKind::Calculation if page_bytes == 0 => RESULT_BYTES,
        MessageKind::Calculation => packet_bytes(1),
        MessageKind::Information => TOKEN_BYTES,
    };
    let messages = |what: &'static str, state| {
        MessageKind::ALL.map(|kind| {
            let name = format!("{what}_{}", kind.name().replace(' ', "_"));
            unit(&name, state, machine.messages.of(bytes(kind)))
        })
    };
    let mut units = vec![
        unit("grid_start", GRID, times.grid.start),
        unit("grid_voxel", GRID, times.grid.each),
        unit("slabs_start", SLABS, times.slabs.start),
        unit("slabs_polygon", SLABS, times.slabs.each),
        unit("intersection_start", INTERSECTION, times.intersection.start),
        unit("intersection_polygon", INTERSECTION, times.intersection.each),
        unit("shade_hit", SHADING, times.host.hit),
        unit("pixel_us", PIXELS, costs.pixel),
        unit("lookup_us", LOOKUP, costs.lookup),
        unit("serve_us", SERVING, costs.serve),
    ];
    units.extend(messages("send", SENDING));
    units.extend(messages("take", RECEIVING));
    let wires = &machine.wires;
    units.push(unit("links", SENDING, Cycles(ray_bytes.saturating_mul(wires.byte_millicycles).div_ceil(1000))));
    units.push(unit("way", SENDING, wires.short));
    Explanation { units, carrying: [LINKS, WAY], pieces }
}

/// How many of each unit a leg consists of, and whether a hit is shaded at its end.
fn piece(leg: &Leg, is_shaded: bool) -> [u32; PIECE_UNITS] {
    let started = |tests: u32| u32::from(tests > 0);
    let mut piece = [0; PIECE_UNITS];
    piece[..OF_LEGS].copy_from_slice(&[
        1,
        leg.voxels,
        started(leg.slab_tests),
        leg.slab_tests,
        started(leg.intersection_tests),
        leg.intersection_tests,
        u32::from(is_shaded),
    ]);
    piece
}

/// What each leg consists of, in the order of the legs.
pub(super) fn of_legs(graph: &TaskGraph) -> Vec<[u32; PIECE_UNITS]> {
    let of_ray = |ray: u32| {
        let last = graph.legs_of(ray).len() - 1;
        let is_shaded = graph.rays[ray as usize].shaded;
        graph.legs_of(ray).iter().enumerate().map(move |(place, leg)| piece(leg, is_shaded && place == last))
    };
    (0..graph.rays.len() as u32).flat_map(of_ray).collect()
}

/// What each ray consists of where all of the scene is one region.
pub(super) fn of_rays(graph: &TaskGraph) -> Vec<[u32; PIECE_UNITS]> {
    (0..graph.rays.len() as u32).map(|ray| piece(&graph.in_one(ray), graph.rays[ray as usize].shaded)).collect()
}
