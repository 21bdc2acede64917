//! Moves, turns and scales meshes on their way into a scene.

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

use super::check_size;
use crate::input::text::coordinate;
use crate::scene::mesh::{Corner, Mesh, NO_NORMAL};

/// An affine map for points, and the one that goes with it for normals.
pub(crate) struct Transform {
    points: DAffine3,
    normals: DMat3,
    /// Whether left and right change places.
    mirrors: bool,
}

/// One step of a transform, for lists of them.
pub(crate) enum Step {
    Translate(DVec3),
    /// A factor for each axis, none of which is 0.
    Scale(DVec3),
    /// An axis of unit length and an angle in radians, counter-clockwise seen from the axis' tip.
    Rotate(DVec3, f64),
}

impl Transform {
    /// All steps one after the other, the first one first.
    pub fn of(steps: &[Step]) -> Self {
        let points = steps.iter().fold(DAffine3::IDENTITY, |map, step| step.map() * map);
        let normals = points.matrix3.inverse().transpose();
        Transform { points, normals, mirrors: points.matrix3.determinant() < 0.0 }
    }

    /// Adds what a mesh has to another, transformed; `material` gives the new number of each material.
    ///
    /// The error says what is too large in the outcome.
    pub fn append(&self, to: &mut Mesh, mesh: &Mesh, material: impl Fn(u32) -> u32) -> Result<(), String> {
        check_size(to, mesh.corner_count())?;
        let (first_point, first_normal) = (to.points.len() as u32, to.normals.len() as u32);
        for &point in &mesh.points {
            to.add_point(checked(self.points.transform_point3(point.as_dvec3()))?);
        }
        for &normal in &mesh.normals {
            to.add_normal((self.normals * normal.as_dvec3()).normalize_or_zero().as_vec3());
        }
        if mesh.has_colors() {
            to.colors.resize(first_point as usize, None);
            to.colors.extend(&mesh.colors);
        }
        let moved = |corner: &Corner| Corner {
            point: first_point + corner.point,
            normal: if corner.normal == NO_NORMAL { NO_NORMAL } else { first_normal + corner.normal },
        };
        let first_face = to.face_count();
        to.begin_object();
        to.objects.extend(mesh.objects.iter().filter(|&&first| first > 0).map(|first| first_face + first));
        for face in mesh.faces() {
            let mut corners: Vec<Corner> = mesh.corners(face).iter().map(moved).collect();
            if self.mirrors {
                corners.reverse(); // So that the outside stays outside.
            }
            to.add_piece(corners, material(face.material), first_face + face.number);
        }
        to.passed_over += first_face + mesh.face_count() - to.face_count();
        Ok(())
    }
}

impl Step {
    fn map(&self) -> DAffine3 {
        match *self {
            Step::Translate(by) => DAffine3::from_translation(by),
            Step::Scale(by) => DAffine3::from_scale(by),
            Step::Rotate(axis, angle) => DAffine3::from_quat(DQuat::from_axis_angle(axis, angle)),
        }
    }
}

fn checked(point: DVec3) -> Result<Vec3, String> {
    Ok(Vec3::new(coordinate(point.x)?, coordinate(point.y)?, coordinate(point.z)?))
}
