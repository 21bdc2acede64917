//! Scenes that are made of arrays of numbers, not of a file.

use std::path::Path;

use glam::Vec3;

use super::{Draft, check_size};
use crate::error::InputError;
use crate::input::text::{amount, coordinate, plural};
use crate::scene::{Camera, Light, Scene};

/// A scene's parts, in double precision as numeric programs have them.
#[derive(Clone, Debug)]
pub struct Arrays<'a> {
    /// What the scene is called.
    pub name: &'a str,
    /// The points.
    pub points: &'a [[f64; 3]],
    /// For each face its points, counted from 0, in order; those with fewer than 3 are passed over.
    pub faces: &'a [&'a [i64]],
    /// The points' own colours (linear RGB, from 0 up): one for each, or none at all.
    pub colors: &'a [[f64; 3]],
    /// Points that white light shines from; without any, images have light from the eye alone.
    pub lights: &'a [[f64; 3]],
    /// The colour where a ray hits nothing.
    pub background: [f64; 3],
    /// The eye, and the point in the middle of the image; without, a camera frames the scene.
    pub view: Option<([f64; 3], [f64; 3])>,
    /// The direction that is up in the image.
    pub up: [f64; 3],
    /// Full angle of view of the image's height, in degrees, where there is a `view`.
    pub angle: f64,
}

impl Arrays<'_> {
    /// The scene: whatever the arrays, it is as one that was [read](super::load).
    ///
    /// # Errors
    ///
    /// If a face has a point that there is not, if a number is none that the array's 32 bits can take, if the camera is
    /// impossible, and if there are no faces.
    pub fn scene(&self) -> Result<Scene, InputError> {
        let wrong = |what: String| move |why: String| InputError::new(format!("{what}: {why}"));
        let up = vector(self.up, coordinate).map_err(wrong("up".to_owned()))?;
        let mut draft = Draft::new(up);
        if !self.colors.is_empty() && self.colors.len() != self.points.len() {
            let (points, colors) = (plural(self.points.len() as u64, "point"), self.colors.len());
            return Err(InputError::new(format!("there are {points} and {colors} colours: it takes one for each")));
        }
        for (number, &point) in self.points.iter().enumerate() {
            draft.mesh.add_point(vector(point, coordinate).map_err(wrong(format!("point {number}")))?);
            if let Some(&color) = self.colors.get(number) {
                draft.mesh.color_point(vector(color, amount).map_err(wrong(format!("colour {number}")))?);
            }
        }
        self.add_faces(&mut draft)?;
        for (number, &light) in self.lights.iter().enumerate() {
            let at = vector(light, coordinate).map_err(wrong(format!("light {number}")))?;
            draft.lights.push(Light::point(at, Vec3::ONE));
        }
        draft.background = vector(self.background, amount).map_err(wrong("background".to_owned()))?;
        draft.camera = self.camera(up)?;
        draft.notes.extend(super::short_faces(draft.short_faces));
        draft.finish(Path::new(self.name))
    }

    fn add_faces(&self, draft: &mut Draft) -> Result<(), InputError> {
        let count = self.points.len();
        let mut corners = Vec::new();
        for (number, face) in self.faces.iter().enumerate() {
            corners.clear();
            for &point in *face {
                let index = usize::try_from(point).ok().filter(|&index| index < count).ok_or_else(|| {
                    let points = plural(count as u64, "point");
                    InputError::new(format!("face {number}: there is no point {point}, there are {points}, from 0"))
                })?;
                corners.push(index as u32);
            }
            check_size(&draft.mesh, corners.len() as u64).map_err(InputError::new)?;
            match corners.len() {
                0..3 => draft.pass_over_face(),
                _ => draft.mesh.add_face(&corners, 0),
            }
        }
        Ok(())
    }

    fn camera(&self, up: Vec3) -> Result<Option<Camera>, InputError> {
        let Some((from, at)) = self.view else { return Ok(None) };
        let point = |numbers| vector(numbers, coordinate).map_err(|why| InputError::new(format!("camera: {why}")));
        let camera = Camera { from: point(from)?, at: point(at)?, up, angle: self.angle as f32 };
        camera.check().map_err(|fault| InputError::new(fault.message()))?;
        Ok(Some(camera))
    }
}

fn vector([x, y, z]: [f64; 3], check: fn(f64) -> Result<f32, String>) -> Result<Vec3, String> {
    Ok(Vec3::new(check(x)?, check(y)?, check(z)?))
}
