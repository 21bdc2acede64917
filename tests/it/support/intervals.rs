//! Solids along a ray by the algebra of intervals (Argence's thesis, chapter 1, section 3.1.2), in double precision: what evaluated
//! polygons are judged by.

use glam::{DAffine3, DVec3};
use pcs_sim::scene::Mesh;
use pcs_sim::scene::solid::{Options, Shell, Solid, evaluate};

/// A tree of operations.
#[derive(Clone, Debug)]
pub enum Node {
    Leaf(Shell, DAffine3),
    Union(Vec<Node>),
    Intersection(Vec<Node>),
    Difference(Vec<Node>),
}

#[derive(Clone, Copy, Debug)]
pub struct Ray {
    from: DVec3,
    along: DVec3,
}

/// How near two places along a ray, or a ray and an edge, may come before nothing is said of it.
const NEAR: f64 = 1e-3;

impl Node {
    /// The same as the library has it.
    pub fn solid(&self) -> Solid {
        let all = |nodes: &[Node]| nodes.iter().map(Node::solid).collect();
        match self {
            Node::Leaf(shell, map) => Solid::leaf(shell.clone()).placed(*map),
            Node::Union(nodes) => Solid::Union(all(nodes)),
            Node::Intersection(nodes) => Solid::Intersection(all(nodes)),
            Node::Difference(nodes) => Solid::Difference(all(nodes)),
        }
    }

    /// Where a ray enters and leaves the solid; none if it passes too near to an edge, or crosses two faces in one place.
    pub fn changes(&self, ray: &Ray) -> Option<Vec<f64>> {
        let mut crossings = Vec::new();
        self.leaves(ray, &mut crossings)?;
        let mut places: Vec<f64> = crossings.iter().flatten().copied().collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let mut changes = Vec::new();
        let mut inside = false;
        for place in &places {
            // Just behind the place: it is inside a leaf that it has crossed an odd number of times.
            let within: Vec<bool> =
                crossings.iter().map(|leaf| leaf.iter().filter(|&other| other <= place).count() % 2 == 1).collect();
            let now = self.holds(&mut within.iter().copied());
            if now != inside {
                changes.push(*place);
                inside = now;
            }
        }
        // Faces that coincide make changes in nearly the same place: they cancel, or nothing can be said.
        let mut kept: Vec<f64> = Vec::new();
        for change in changes {
            match kept.last() {
                Some(last) if change - last < 1e-9 => drop(kept.pop()),
                Some(last) if change - last < NEAR => return None,
                _ => kept.push(change),
            }
        }
        Some(kept)
    }

    /// The crossings of each leaf, in order.
    fn leaves(&self, ray: &Ray, found: &mut Vec<Vec<f64>>) -> Option<()> {
        match self {
            Node::Leaf(shell, map) => {
                let alone = Solid::leaf(shell.clone()).placed(*map);
                found.push(crossings(&evaluate(&alone, Options::default()).ok()?.mesh, ray)?);
                Some(())
            }
            Node::Union(nodes) | Node::Intersection(nodes) | Node::Difference(nodes) => {
                nodes.iter().try_for_each(|node| node.leaves(ray, found))
            }
        }
    }

    /// Whether a point is in the solid that is in these leaves.
    fn holds(&self, leaves: &mut impl Iterator<Item = bool>) -> bool {
        let mut all = |nodes: &[Node]| nodes.iter().map(|node| node.holds(leaves)).collect::<Vec<bool>>();
        match self {
            Node::Leaf(..) => leaves.next().unwrap(),
            Node::Union(nodes) => all(nodes).contains(&true),
            Node::Intersection(nodes) => !all(nodes).contains(&false),
            Node::Difference(nodes) => {
                let within = all(nodes);
                within[0] && !within[1..].contains(&true)
            }
        }
    }
}

/// Rays from all around through the middle, none of them along an axis.
pub fn rays(seed: u64) -> impl Iterator<Item = Ray> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    std::iter::repeat_with(move || {
        let away = DVec3::new(next(), next(), next()).normalize_or(DVec3::ONE);
        let at = DVec3::new(next(), next(), next()) * 1.5;
        let from = at + away * 10.0;
        Ray { from, along: (at - from).normalize() }
    })
}

/// Where a ray crosses the polygons of a closed mesh, in order; none if it passes too near to an edge to say.
pub fn crossings(mesh: &Mesh, ray: &Ray) -> Option<Vec<f64>> {
    let mut found = Vec::new();
    for face in mesh.faces() {
        let points: Vec<DVec3> = mesh.face_points(face).map(|point| point.as_dvec3()).collect();
        let normal: DVec3 = points.windows(2).map(|pair| (pair[0] - points[0]).cross(pair[1] - points[0])).sum();
        let normal = normal.normalize_or_zero();
        let steep = normal.dot(ray.along);
        if steep.abs() < 1e-9 {
            continue;
        }
        let t = (points[0] - ray.from).dot(normal) / steep;
        let place = ray.from + ray.along * t;
        let beyond = |at: usize| {
            let (from, to) = (points[at], points[(at + 1) % points.len()]);
            (to - from).normalize_or_zero().cross(place - from).dot(normal)
        };
        let depth = (0..points.len()).map(beyond).fold(f64::INFINITY, f64::min);
        if depth.abs() < 1e-5 || (depth > 0.0 && steep.abs() < 1e-2) {
            return None;
        }
        if depth > 0.0 {
            found.push(t);
        }
    }
    found.sort_by(f64::total_cmp);
    Some(found)
}
