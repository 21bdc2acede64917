//! Whose matter there is at a point of a solid.

use glam::{DAffine3, DVec3};

use super::Solid;
use super::shell::Shell;

/// A ray's direction that is parallel to no face or edge that people model.
const ANY_WAY: DVec3 = DVec3::new(0.362_187_3, 0.517_430_9, 0.775_289_1);

/// A tree of solids that can be asked what a point is made of.
pub(super) enum Owner {
    Leaf(Leaf),
    Union(Vec<Owner>),
    Intersection(Vec<Owner>),
    Difference(Vec<Owner>),
}

/// A shell in its final place.
pub(super) struct Leaf {
    triangles: Vec<[DVec3; 3]>,
    low: DVec3,
    high: DVec3,
    material: u32,
}

impl Owner {
    /// The tree of a solid.
    pub fn new(solid: &Solid) -> Owner {
        Owner::of(solid, &DAffine3::IDENTITY)
    }

    fn of(solid: &Solid, map: &DAffine3) -> Owner {
        let all = |solids: &[Solid]| {
            let mut sorted: Vec<&Solid> = solids.iter().collect();
            sorted.sort_by_key(|solid| std::cmp::Reverse(solid.priority()));
            sorted.into_iter().map(|solid| Owner::of(solid, map)).collect()
        };
        match solid {
            Solid::Leaf { shell, .. } => Owner::Leaf(Leaf::new(shell.clone().placed(map))),
            Solid::Union(solids) => Owner::Union(all(solids)),
            Solid::Intersection(solids) => Owner::Intersection(all(solids)),
            Solid::Difference(solids) => Owner::Difference(solids.iter().map(|solid| Owner::of(solid, map)).collect()),
            Solid::Place(own, solid) => Owner::of(solid, &(*map * *own)),
        }
    }

    /// The material of the shell whose matter is at a point; none outside.
    pub fn material_at(&self, point: DVec3) -> Option<u32> {
        match self {
            Owner::Leaf(leaf) => leaf.has(point).then_some(leaf.material),
            Owner::Union(owners) => owners.iter().find_map(|owner| owner.material_at(point)),
            Owner::Intersection(owners) => {
                let mut materials = owners.iter().map(|owner| owner.material_at(point));
                let first = materials.next().flatten();
                first.filter(|_| materials.all(|other| other.is_some()))
            }
            Owner::Difference(owners) => {
                let mut materials = owners.iter().map(|owner| owner.material_at(point));
                let first = materials.next().flatten();
                first.filter(|_| materials.all(|other| other.is_none()))
            }
        }
    }
}

impl Leaf {
    fn new(shell: Shell) -> Leaf {
        let (low, high) = shell.bounds();
        let triangles = shell.triangles();
        let corners = triangles.iter().map(|(triangle, _)| triangle.map(|corner| shell.points[corner as usize]));
        let material = shell.faces.first().map(|face| face.material).unwrap_or_default();
        Leaf { triangles: corners.collect(), low, high, material }
    }

    /// Whether a ray from a point leaves the shell once more than it enters it.
    fn has(&self, point: DVec3) -> bool {
        let within = point.cmpge(self.low).all() && point.cmple(self.high).all();
        within && self.triangles.iter().filter(|triangle| is_hit(point, triangle)).count() % 2 == 1
    }
}

fn is_hit(from: DVec3, [a, b, c]: &[DVec3; 3]) -> bool {
    let (one, other) = (*b - *a, *c - *a);
    let across = ANY_WAY.cross(other);
    let turn = one.dot(across);
    if turn == 0.0 {
        return false;
    }
    let way = from - *a;
    let alpha = way.dot(across) / turn;
    let up = way.cross(one);
    let beta = ANY_WAY.dot(up) / turn;
    alpha >= 0.0 && beta >= 0.0 && alpha + beta < 1.0 && other.dot(up) / turn > 0.0
}
