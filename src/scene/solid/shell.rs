//! Closed shapes: the leaves of a solid.

use glam::{DAffine3, DVec3};

use crate::scene::convex;

/// A closed surface of flat polygons in double precision, all of whose faces are seen counter-clockwise from outside.
///
/// All primitives are in the unit position that the language Castor has them in.
#[derive(Clone, Debug, Default)]
pub struct Shell {
    pub(super) points: Vec<DVec3>,
    pub(super) faces: Vec<ShellFace>,
}

/// A flat polygon of a shell.
#[derive(Clone, Debug)]
pub(super) struct ShellFace {
    /// Indices of its points.
    pub corners: Vec<u32>,
    /// A normal for each corner, of unit length; none for a face that is meant to look flat.
    pub normals: Vec<DVec3>,
    /// The smooth surface that it belongs to, counted from 0 in rising order.
    pub surface: u32,
    /// What it is made of, counted into the scene's materials.
    pub material: u32,
}

impl Shell {
    /// The same shape, all of one material.
    pub fn of_material(mut self, material: u32) -> Shell {
        self.faces.iter_mut().for_each(|face| face.material = material);
        self
    }

    /// Gives each face another material.
    pub(crate) fn change_materials(&mut self, change: &mut impl FnMut(u32) -> u32) {
        self.faces.iter_mut().for_each(|face| face.material = change(face.material));
    }

    /// How many faces it has.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The points of a face.
    pub(super) fn face_points<'a>(&'a self, face: &'a ShellFace) -> impl ExactSizeIterator<Item = DVec3> + 'a {
        face.corners.iter().map(|&point| self.points[point as usize])
    }

    /// All faces in triangles: the points of each, and the number of the face that it is a piece of.
    pub(super) fn triangles(&self) -> Vec<([u32; 3], u32)> {
        let mut triangles = Vec::new();
        for (number, face) in (0..).zip(&self.faces) {
            if let &[a, b, c] = face.corners.as_slice() {
                triangles.push(([a, b, c], number));
                continue;
            }
            let points: Vec<DVec3> = self.face_points(face).collect();
            triangles
                .extend(convex::triangles(&points).iter().map(|cut| (cut.map(|corner| face.corners[corner]), number)));
        }
        triangles
    }

    /// The shape moved, turned, scaled or mirrored; the map has an inverse.
    pub(super) fn placed(mut self, map: &DAffine3) -> Shell {
        self.points.iter_mut().for_each(|point| *point = map.transform_point3(*point));
        let normals = map.matrix3.inverse().transpose();
        for normal in self.faces.iter_mut().flat_map(|face| &mut face.normals) {
            *normal = (normals * *normal).normalize_or_zero();
        }
        if map.matrix3.determinant() < 0.0 {
            self.faces.iter_mut().for_each(ShellFace::reverse);
        }
        self
    }

    /// The shape with the outside in.
    fn turned_over(mut self) -> Shell {
        for face in &mut self.faces {
            face.reverse();
            face.normals.iter_mut().for_each(|normal| *normal = -*normal);
        }
        self
    }

    /// The volume within; negative for one that is inside out.
    pub(super) fn volume(&self) -> f64 {
        let spat = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|point| self.points[point as usize] - self.points[0]);
            a.cross(b).dot(c) / 6.0
        };
        self.triangles().into_iter().map(|(triangle, _)| spat(triangle)).sum()
    }

    /// Turns a shape over that is inside out, and tells whether it was.
    pub(super) fn turn_outward(self) -> (Shell, bool) {
        if self.volume() < 0.0 { (self.turned_over(), true) } else { (self, false) }
    }

    /// The shape with a hollow in it: itself scaled about the centre of its box by a factor for each axis, each above 0 and
    /// below 1 (Argence's thesis, chapter 2, section 7.3). Its inner side is of surfaces of its own.
    ///
    /// No Boolean operation is needed, if all of the shape can be seen from that centre; the error says so if it cannot.
    pub fn hollow(self, keep: DVec3) -> Result<Shell, String> {
        if !(keep.cmpgt(DVec3::ZERO) & keep.cmplt(DVec3::ONE)).all() {
            return Err(format!(
                "hollow keeps ({}, {}, {}) of its shape, each must be above 0 and below 1",
                keep.x, keep.y, keep.z
            ));
        }
        let (low, high) = self.bounds();
        let center = (low + high) / 2.0;
        if !self.is_seen_from(center) {
            let place = format!("({}, {}, {})", center.x, center.y, center.z);
            return Err(format!(
                "not all of the shape can be seen from the centre of its box, {place}: its hollow would stick out"
            ));
        }
        let map = DAffine3::from_translation(center) * DAffine3::from_scale(keep) * DAffine3::from_translation(-center);
        let inner = self.clone().placed(&map).turned_over();
        Ok(self.with(inner))
    }

    /// Both shapes' faces in one, as surfaces of their own.
    fn with(mut self, other: Shell) -> Shell {
        let first = self.points.len() as u32;
        let surfaces = self.faces.iter().map(|face| face.surface + 1).max().unwrap_or_default();
        self.points.extend(other.points);
        self.faces.extend(other.faces.into_iter().map(|face| ShellFace {
            corners: face.corners.into_iter().map(|corner| first + corner).collect(),
            surface: surfaces + face.surface,
            ..face
        }));
        self
    }

    /// Whether a point is on the inner side of every face's plane.
    fn is_seen_from(&self, point: DVec3) -> bool {
        self.triangles().into_iter().all(|(triangle, _)| {
            let [a, b, c] = triangle.map(|corner| self.points[corner as usize] - point);
            a.cross(b).dot(c) > 0.0
        })
    }

    /// The smallest axis-parallel box around it.
    pub(super) fn bounds(&self) -> (DVec3, DVec3) {
        self.points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
    }
}

impl ShellFace {
    /// The face seen from its other side; its normals stay as they are.
    fn reverse(&mut self) {
        self.corners.reverse();
        self.normals.reverse();
    }
}
