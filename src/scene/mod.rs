//! What is traced: polygons, materials, lights and a camera; read from files or generated.

pub mod builtin;
pub mod camera;
pub mod convex;
pub mod format;
pub mod mesh;
pub mod solid;
mod surfaces;
pub mod tessellate;

pub use camera::Camera;
pub use convex::split_concave;
pub use format::{Arrays, ReadOptions, load, write_ply};
pub use mesh::{Corner, Face, Mesh, Object};
pub use surfaces::surfaces;

use glam::Vec3;

/// A whole scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Its name: the built-in's, or the file's.
    pub name: String,
    /// All polygons, in file order.
    pub mesh: Mesh,
    /// What the faces are made of; [`Face::material`] counts into this list, which is never empty.
    pub materials: Vec<Material>,
    /// The light sources; may be empty.
    pub lights: Vec<Light>,
    /// The colour where a ray hits nothing (linear RGB, 0 to 1).
    pub background: Vec3,
    /// The eye.
    pub camera: Camera,
    /// What reading changed and the user should know, one sentence each ("3 concave faces were cut into 12 triangles").
    pub notes: Vec<String>,
    /// What each of its solids came to, in file order.
    pub solids: Vec<solid::Report>,
}

/// How a surface takes light (Phong's model, as NFF's `f` has it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Colour (linear RGB, 0 to 1).
    pub color: Vec3,
    /// Share of light that is scattered evenly.
    pub diffuse: f32,
    /// Share of light that makes highlights and mirror images.
    pub specular: f32,
    /// Phong's exponent of the highlight.
    pub shine: f32,
    /// Share of light that passes through.
    pub transmittance: f32,
    /// Index of refraction.
    pub refraction: f32,
}

impl Default for Material {
    /// A matt light grey.
    fn default() -> Self {
        Material {
            color: Vec3::splat(0.8),
            diffuse: 1.0,
            specular: 0.0,
            shine: 1.0,
            transmittance: 0.0,
            refraction: 1.0,
        }
    }
}

/// A light source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where its light comes from.
    pub from: LightFrom,
    /// Its colour and strength (linear RGB); it does not fall off with distance.
    pub color: Vec3,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightFrom {
    /// A point.
    Point(Vec3),
    /// One direction everywhere, as from the sun: this one, from the scene towards the light.
    Direction(Vec3),
}

impl Light {
    /// A light that shines from a point.
    pub fn point(at: Vec3, color: Vec3) -> Light {
        Light { from: LightFrom::Point(at), color }
    }

    /// A light that shines from one direction everywhere; `towards` leads from the scene to the light.
    pub fn directional(towards: Vec3, color: Vec3) -> Light {
        Light { from: LightFrom::Direction(towards), color }
    }
}
