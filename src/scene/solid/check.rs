//! Whether a shell encloses something: closed, and nowhere through itself.

use std::collections::HashMap;

use glam::DVec3;

use super::evaluate::manifold;
use super::shell::Shell;

/// What is wrong with a shell, and at which edge.
pub(super) struct Fault {
    what: &'static str,
    edge: Option<[DVec3; 2]>,
}

/// Largest number of triangles among which the place of a crossing is looked for: each edge is held against each triangle.
const MOST_TRIANGLES: usize = 20_000;

impl Fault {
    /// The fault as a sentence without a final stop.
    pub fn message(self) -> String {
        let Some([a, b]) = self.edge else { return self.what.to_owned() };
        format!("{} at the edge from ({}, {}, {}) to ({}, {}, {})", self.what, a.x, a.y, a.z, b.x, b.y, b.z)
    }
}

/// Checks that every edge of a face is that of another face the other way round.
pub(super) fn closed(shell: &Shell) -> Result<(), Fault> {
    let mut edges: HashMap<(u32, u32), i64> = HashMap::new();
    let corners = |face: &[u32]| (0..face.len()).map(|at| (face[at], face[(at + 1) % face.len()])).collect::<Vec<_>>();
    for face in &shell.faces {
        for (from, to) in corners(&face.corners) {
            *edges.entry((from, to)).or_default() += 1;
        }
    }
    for face in &shell.faces {
        for (from, to) in corners(&face.corners) {
            let there = edges[&(from, to)];
            let back = edges.get(&(to, from)).copied().unwrap_or_default();
            if there != back {
                let what = if there + back == 2 {
                    "neighbouring faces of the mesh are turned against each other"
                } else {
                    "the mesh is open"
                };
                return Err(Fault { what, edge: Some([from, to].map(|point| shell.points[point as usize])) });
            }
        }
    }
    Ok(())
}

/// Checks that a closed shell does not cross itself.
pub(super) fn simple(shell: &Shell) -> Result<(), Fault> {
    if !manifold(&shell.points, &shell.triangles()).has_self_intersections() {
        return Ok(());
    }
    Err(Fault { what: "the mesh crosses or touches itself", edge: first_crossing(shell) })
}

/// The first edge that goes through a triangle, or touches one, that it is no neighbour of.
fn first_crossing(shell: &Shell) -> Option<[DVec3; 2]> {
    let triangles = shell.triangles();
    if triangles.len() > MOST_TRIANGLES {
        return None;
    }
    let edges = triangles.iter().flat_map(|([a, b, c], _)| [[*a, *b], [*b, *c], [*c, *a]]);
    edges.into_iter().find_map(|edge| {
        let points = edge.map(|point| shell.points[point as usize]);
        let crosses = |triangle: &[u32; 3]| {
            !edge.iter().any(|point| triangle.contains(point))
                && goes_through(points, triangle.map(|point| shell.points[point as usize]))
        };
        triangles.iter().any(|(triangle, _)| crosses(triangle)).then_some(points)
    })
}

fn goes_through([from, to]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let side = |p: DVec3, q: DVec3, r: DVec3, s: DVec3| (q - p).cross(r - p).dot(s - p);
    let (before, behind) = (side(a, b, c, from), side(a, b, c, to));
    if before * behind > 0.0 || (before == 0.0 && behind == 0.0) {
        return false;
    }
    let around = [side(from, to, a, b), side(from, to, b, c), side(from, to, c, a)];
    around.iter().all(|&turn| turn >= 0.0) || around.iter().all(|&turn| turn <= 0.0)
}
