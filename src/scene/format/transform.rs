//! Moves, turns and scales meshes on their way into a scene.

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

use super::check_size;
use crate::input::text::coordinate;
use crate::scene::mesh::Mesh;

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
        let points = Step::map_of(steps);
        let normals = points.matrix3.inverse().transpose();
        Transform { points, normals, mirrors: points.matrix3.determinant() < 0.0 }
    }

    /// Adds what a mesh has to another, transformed; `material` gives the new number of each material.
    ///
    /// The error says what is too large in the outcome.
    pub fn append(&self, to: &mut Mesh, mut mesh: Mesh, material: impl Fn(u32) -> u32) -> Result<(), String> {
        check_size(to, mesh.corner_count())?;
        for point in &mut mesh.points {
            *point = checked(self.points.transform_point3(point.as_dvec3()))?;
        }
        for normal in &mut mesh.normals {
            *normal = (self.normals * normal.as_dvec3()).normalize_or_zero().as_vec3();
        }
        if self.mirrors {
            mesh.reverse_faces(); // So that the outside stays outside.
        }
        to.append(mesh, material);
        Ok(())
    }
}

impl Step {
    /// All steps one after the other, the first one first.
    pub fn map_of(steps: &[Step]) -> DAffine3 {
        steps.iter().fold(DAffine3::IDENTITY, |map, step| step.map() * map)
    }

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
