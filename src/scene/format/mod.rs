//! Scene files: opening one, choosing its reader, and what is done to every scene that was read.

mod mtl;
mod nff;
mod obj;
mod ply;
mod ron_scene;
mod statements;
mod transform;
mod vertex_color;

use std::fs::File;
use std::io::Read;
use std::ops::RangeInclusive;
use std::path::Path;

use glam::Vec3;

use crate::error::InputError;
use crate::input::reading;
use crate::input::text::nearest;
use crate::scene::mesh::Mesh;
use crate::scene::{Camera, Light, Material, Scene, split_concave};

/// Largest scene file taken, in bytes.
const LARGEST_FILE: u64 = 1 << 32;

/// Largest number of corners of a scene.
const MOST_CORNERS: u64 = 1 << 31;

/// How a scene file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// Slices that the spheres and cones of a file are cut into; one of [`ReadOptions::RESOLUTIONS`].
    ///
    /// Built-in scenes that a RON file takes as meshes are not meant: the file says their resolution itself.
    pub resolution: u32,
}

impl ReadOptions {
    /// The values that [`ReadOptions::resolution`] can have.
    pub const RESOLUTIONS: RangeInclusive<u32> = 3..=256;
}

impl Default for ReadOptions {
    /// 16 slices.
    fn default() -> Self {
        ReadOptions { resolution: 16 }
    }
}

/// Reads a scene file; its extension says what it is: `.ron`, `.obj`, `.ply` or `.nff`.
///
/// Whatever the file, the scene has at least one face, all its faces are flat and convex
/// (see [`split_concave`]), its coordinates are finite, and it has a camera: one that frames it, if the file has none.
///
/// # Errors
///
/// If the file cannot be read, is not of its format or describes no scene; the error says where.
pub fn load(path: &Path, options: &ReadOptions) -> Result<Scene, InputError> {
    if !ReadOptions::RESOLUTIONS.contains(&options.resolution) {
        let (least, most) = ReadOptions::RESOLUTIONS.into_inner();
        let message = format!("resolution is {}, it must be from {least} to {most}", options.resolution);
        return Err(InputError::new(message));
    }
    let draft = match Format::of(path)? {
        Format::Ron => ron_scene::read(path, options)?,
        Format::Obj => obj::read(path)?,
        Format::Ply => ply::read(path)?,
        Format::Nff => nff::read(path, options)?,
    };
    draft.finish(path)
}

/// A kind of scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Ron,
    Obj,
    Ply,
    Nff,
}

impl Format {
    const EXTENSIONS: [(&'static str, Format); 4] =
        [("ron", Format::Ron), ("obj", Format::Obj), ("ply", Format::Ply), ("nff", Format::Nff)];

    /// The format that a file's extension stands for.
    pub fn of(path: &Path) -> Result<Self, InputError> {
        let known = "a scene file ends in .ron, .obj, .ply or .nff";
        let Some(extension) = path.extension() else {
            return Err(InputError::in_file(path, "file name has no extension to tell its format by").help(known));
        };
        let extension = extension.to_string_lossy().to_lowercase();
        if let Some((_, format)) = Self::EXTENSIONS.iter().find(|(name, _)| *name == extension) {
            return Ok(*format);
        }
        let help = match nearest(&extension, Self::EXTENSIONS.map(|(name, _)| name)) {
            Some(name) => format!("did you mean .{name}? {known}"),
            None => known.to_owned(),
        };
        Err(InputError::in_file(path, format!("unknown kind of scene file `.{extension}`")).help(help))
    }
}

/// What a reader finds in a file.
pub(crate) struct Draft {
    pub mesh: Mesh,
    pub materials: Vec<Material>,
    pub lights: Vec<Light>,
    pub background: Vec3,
    pub camera: Option<Camera>,
    /// The vertical of the format, for a camera that frames the scene.
    pub up: Vec3,
    pub notes: Vec<String>,
}

impl Draft {
    /// Nothing yet, but the default material.
    pub fn new(up: Vec3) -> Self {
        Draft {
            mesh: Mesh::default(),
            materials: vec![Material::default()],
            lights: Vec::new(),
            background: Vec3::ZERO,
            camera: None,
            up,
            notes: Vec::new(),
        }
    }

    fn finish(mut self, path: &Path) -> Result<Scene, InputError> {
        let Some((low, high)) = self.mesh.bounds() else {
            return Err(InputError::in_file(path, "empty scene: the file has no faces"));
        };
        let (mesh, report) = split_concave(self.mesh);
        self.notes.extend(report.notes());
        Ok(Scene {
            name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            mesh,
            materials: self.materials,
            lights: self.lights,
            background: self.background,
            camera: self.camera.unwrap_or_else(|| Camera::framing(low, high, self.up)),
            notes: self.notes,
        })
    }
}

/// The bytes of a file of acceptable size.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, InputError> {
    let unreadable = |error| InputError::unreadable(path, &error);
    let too_large = || InputError::in_file(path, "file is too large, a scene file may have up to 4 GiB");
    let file = File::open(path).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.len() > LARGEST_FILE {
        return Err(too_large());
    }
    // A pipe does not tell its length, and a file can grow.
    let mut bytes = Vec::new();
    let length = file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if length as u64 > LARGEST_FILE {
        return Err(too_large());
    }
    reading::note(path, &bytes);
    Ok(bytes)
}

/// Checks that a mesh stays within what a scene may hold when some corners are added.
pub(crate) fn check_size(mesh: &Mesh, added: u64) -> Result<(), String> {
    if mesh.corner_count() + added > MOST_CORNERS {
        return Err(format!("scene is too large, it has over {MOST_CORNERS} corners of faces"));
    }
    Ok(())
}
