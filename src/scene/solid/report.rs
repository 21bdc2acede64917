//! What evaluating a solid came to.

use std::collections::HashMap;

use glam::DVec3;
use serde::Serialize;

use super::sources::Sources;
use crate::input::text::plural;
use crate::scene::mesh::Mesh;

/// What a solid is made of, and what it came to: of the polygons that the array gets.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Its closed shapes.
    pub primitives: u64,
    /// The polygons that these have.
    pub polygons_in: u64,
    /// The polygons that the solid has.
    pub polygons: u64,
    /// The volume that they enclose, in cubed units of length.
    pub volume: f64,
    /// Their area, in squared units of length.
    pub area: f64,
    /// Whether every edge of a polygon is that of another one the other way round.
    pub closed: bool,
    /// Triangles without area, in 32 bits, that were merged into their neighbours.
    pub without_area: u64,
}

impl Report {
    /// Measures a solid.
    pub(super) fn new(mesh: &Mesh, sources: &Sources, slivers: u32) -> Report {
        let (mut volume, mut area) = (0.0, 0.0);
        // From a point of the solid, so that far from the origin no digits are lost.
        let origin = mesh.points.first().copied().unwrap_or_default().as_dvec3();
        for face in mesh.faces() {
            let points: Vec<DVec3> = mesh.face_points(face).map(|point| point.as_dvec3() - origin).collect();
            let twice: DVec3 = points.windows(2).map(|pair| (pair[0] - points[0]).cross(pair[1] - points[0])).sum();
            area += twice.length() / 2.0;
            volume += twice.dot(points[0]) / 6.0;
        }
        Report {
            primitives: sources.leaves.into(),
            polygons_in: sources.faces.len() as u64,
            polygons: mesh.faces().len() as u64,
            volume,
            area,
            closed: is_closed(mesh),
            without_area: slivers.into(),
        }
    }

    /// The report as one sentence without a final stop.
    pub fn sentence(&self) -> String {
        let Report { primitives, polygons_in, polygons, volume, area, closed, without_area } = self;
        let closed = if *closed { "closed" } else { "not closed" };
        let merged = match without_area {
            0 => String::new(),
            count => format!(", {} without area merged away", plural(*count, "triangle")),
        };
        format!(
            "{}, {} in, {polygons} out, volume {volume:.4}, area {area:.4}, {closed}{merged}",
            plural(*primitives, "primitive"),
            plural(*polygons_in, "polygon"),
        )
    }
}

fn is_closed(mesh: &Mesh) -> bool {
    let mut edges: HashMap<(u32, u32), i64> = HashMap::new();
    for face in mesh.faces() {
        let corners = mesh.corners(face);
        for (at, corner) in corners.iter().enumerate() {
            let (from, to) = (corner.point, corners[(at + 1) % corners.len()].point);
            *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    edges.values().all(|&balance| balance == 0)
}
