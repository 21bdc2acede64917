//! Where the faces of an evaluated solid come from.

use glam::{DAffine3, DVec3};

use super::shell::Shell;

/// The faces of all shells of a solid, in their final places. The Boolean operations carry their numbers.
#[derive(Debug, Default)]
pub(super) struct Sources {
    pub faces: Vec<Source>,
    pub leaves: u32,
}

/// A face of a shell.
#[derive(Debug)]
pub(super) struct Source {
    /// The shell that it is a face of.
    pub leaf: u32,
    /// The shell's smooth surface.
    pub surface: u32,
    pub material: u32,
    points: Vec<DVec3>,
    /// A normal for each point, or none; towards the outside of the whole solid.
    normals: Vec<DVec3>,
}

impl Sources {
    /// Adds a shell's faces and returns the number of the first; `map` takes it to its final place, and `inverted` says that it
    /// is cut out there.
    pub fn add(&mut self, shell: &Shell, map: &DAffine3, inverted: bool) -> u32 {
        let first = self.faces.len() as u32;
        let shell = shell.clone().placed(map);
        let sign = if inverted { -1.0 } else { 1.0 };
        let leaf = self.leaves;
        self.leaves += 1;
        self.faces.extend(shell.faces.iter().map(|face| Source {
            leaf,
            surface: face.surface,
            material: face.material,
            points: shell.face_points(face).collect(),
            normals: face.normals.iter().map(|&normal| normal * sign).collect(),
        }));
        first
    }

    /// A face by its number.
    pub fn of(&self, face: u32) -> &Source {
        &self.faces[face as usize]
    }
}

impl Source {
    /// What tells the face's object: its shell and its surface.
    pub fn thing(&self) -> (u32, u32) {
        (self.leaf, self.surface)
    }

    /// The face's normal at a point on it, if it has normals: between those of its corners.
    pub fn normal_at(&self, point: DVec3) -> Option<DVec3> {
        let first = self.normals.first()?;
        let fan = (1..self.points.len().saturating_sub(1)).map(|at| [0, at, at + 1]);
        let weighed = fan.map(|corners| (corners, weights(corners.map(|corner| self.points[corner]), point)));
        // The triangle that the point is in, or the one that it is least outside of.
        let inmost = weighed.max_by(|(_, one), (_, other)| least(one).total_cmp(&least(other)));
        let Some((corners, weights)) = inmost else { return Some(*first) };
        let normal: DVec3 = corners.iter().zip(weights).map(|(&corner, weight)| self.normals[corner] * weight).sum();
        Some(normal.normalize_or(*first))
    }
}

fn least(weights: &[f64; 3]) -> f64 {
    weights.iter().copied().fold(f64::INFINITY, f64::min)
}

/// A point's barycentric coordinates in a triangle.
fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    if area == 0.0 {
        return [f64::NEG_INFINITY; 3];
    }
    let of = |p: DVec3, q: DVec3| (p - point).cross(q - point).dot(normal) / area;
    [of(b, c), of(c, a), of(a, b)]
}
