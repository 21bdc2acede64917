//! Scene files: opening one, choosing its reader, and what is done to every scene that was read.

mod arrays;
mod castor;
mod mtl;
mod nff;
mod obj;
mod ply;
mod ron_scene;
mod statements;
mod transform;
mod vertex_color;

pub use arrays::Arrays;
pub use ply::write_ply;

use std::collections::HashMap;
use std::ops::RangeInclusive;
use std::path::Path;

use glam::Vec3;

use crate::error::InputError;
use crate::input::text::{coordinate, nearest, passed_over};
use crate::input::{file, packed};
use crate::scene::mesh::Mesh;
use crate::scene::solid::Report;
use crate::scene::{Camera, Light, Material, Scene, split_concave};

/// Largest scene file taken, in GiB.
const LARGEST_FILE: u64 = 4;

/// Largest number of corners of a scene.
const MOST_CORNERS: u64 = 1 << 31;

/// Beyond so many times its size from the origin, secondary rays of a scene begin a thousandth of its size off their
/// surfaces.
const FARTHEST: f32 = 500.0;

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

/// Reads a scene file; its extension says what it is: `.ron`, `.obj`, `.ply`, `.nff` or `.cas`, each also packed (`.obj.gz`,
/// `.obj.zst`).
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
    Format::of(path)?.read(path, options)?.finish(path)
}

/// A kind of scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Ron,
    Obj,
    Ply,
    Nff,
    Castor,
}

impl Format {
    const EXTENSIONS: [(&'static str, Format); 5] = [
        ("ron", Format::Ron),
        ("obj", Format::Obj),
        ("ply", Format::Ply),
        ("nff", Format::Nff),
        ("cas", Format::Castor),
    ];

    /// The format that a file's extension stands for.
    pub fn of(path: &Path) -> Result<Self, InputError> {
        let known = "a scene file ends in .ron, .obj, .ply, .nff or .cas";
        let inside = packed::name_inside(path);
        let Some(extension) = inside.extension() else {
            return Err(InputError::in_file(path, "file name has no extension to tell its format by").help(known));
        };
        let extension = extension.to_string_lossy().to_lowercase();
        if let Some(by) = packed::unpacked_by(&extension) {
            let error =
                InputError::in_file(path, format!("files that are packed as .{extension} are not unpacked here"));
            return Err(error.help(format!("unpack it first by `{by}`, or pack it by gzip or zstd")));
        }
        if let Some((_, format)) = Self::EXTENSIONS.iter().find(|(name, _)| *name == extension) {
            return Ok(*format);
        }
        let help = match nearest(&extension, Self::EXTENSIONS.map(|(name, _)| name)) {
            Some(name) => format!("did you mean .{name}? {known}"),
            None => known.to_owned(),
        };
        Err(InputError::in_file(path, format!("unknown kind of scene file `.{extension}`")).help(help))
    }

    /// What a file of this format has.
    pub fn read(self, path: &Path, options: &ReadOptions) -> Result<Draft, InputError> {
        let mut draft = match self {
            Format::Ron => ron_scene::read(path, options)?,
            Format::Obj => obj::read(path)?,
            Format::Ply => ply::read(path)?,
            Format::Nff => nff::read(path, options)?,
            Format::Castor => castor::read(path, options)?,
        };
        draft.notes.extend(short_faces(draft.short_faces));
        draft.notes.extend(passed_over(
            draft.no_normals,
            "normal that is no direction",
            "normals that are no directions",
        ));
        Ok(draft)
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
    pub solids: Vec<Report>,
    /// Faces of fewer than 3 corners.
    short_faces: u64,
    /// Normals that are no numbers.
    no_normals: u64,
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
            solids: Vec::new(),
            short_faces: 0,
            no_normals: 0,
        }
    }

    /// Leaves out a face that has fewer than 3 corners.
    pub fn pass_over_face(&mut self) {
        self.short_faces += 1;
        self.mesh.pass_over_face();
    }

    /// Adds a normal. One that is no direction becomes zero, which shades as if there were none.
    pub fn add_normal(&mut self, numbers: [f64; 3]) -> u32 {
        let normal = vector(numbers);
        self.no_normals += u64::from(normal.is_none());
        self.mesh.add_normal(normal.unwrap_or(Vec3::ZERO))
    }

    fn finish(mut self, path: &Path) -> Result<Scene, InputError> {
        let Some((low, high)) = self.mesh.bounds() else {
            let error = InputError::in_file(path, "empty scene: the file has no faces");
            return Err(if self.notes.is_empty() { error } else { error.help(self.notes.join("; ")) });
        };
        let (mesh, report) = split_concave(self.mesh);
        self.notes.extend(report.notes());
        self.notes.extend(far_out(low, high));
        Ok(Scene {
            name: packed::name_inside(path).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            mesh,
            materials: self.materials,
            lights: self.lights,
            background: self.background,
            camera: self.camera.unwrap_or_else(|| Camera::framing(low, high, self.up)),
            notes: self.notes,
            solids: self.solids,
        })
    }
}

/// What is said of a scene that lies so far from the origin that 32 bits are short for it.
fn far_out(low: Vec3, high: Vec3) -> Option<String> {
    let (distance, size) = (low.abs().max(high.abs()).max_element(), (high - low).length());
    let times = distance / size;
    (times > FARTHEST && times.is_finite()).then(|| {
        let far = format!("the scene is {times:.0} times as far from the origin as it is large");
        format!("{far}: 32 bits place its hits only roughly, and images show it; move it to the origin")
    })
}

/// The bytes of a file of acceptable size.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, InputError> {
    file::read(path, LARGEST_FILE)
}

/// What is said of faces with too few corners, if there are any.
pub(crate) fn short_faces(count: u64) -> Option<String> {
    passed_over(count, "face of fewer than 3 corners", "faces of fewer than 3 corners")
}

fn vector([x, y, z]: [f64; 3]) -> Option<Vec3> {
    Some(Vec3::new(coordinate(x).ok()?, coordinate(y).ok()?, coordinate(z).ok()?))
}

/// Points that are nowhere, which matters only where a face uses them.
#[derive(Default)]
pub(crate) struct Nowhere {
    /// For each of them the number at fault and where it stands in the file, in bytes.
    points: HashMap<u32, (usize, f64)>,
}

impl Nowhere {
    /// Adds a point of three numbers and their places.
    pub fn add_point(&mut self, mesh: &mut Mesh, numbers: [(usize, f64); 3]) {
        let point = mesh.add_point(vector(numbers.map(|(_, number)| number)).unwrap_or(Vec3::ZERO));
        if let Some(&wrong) = numbers.iter().find(|(_, number)| coordinate(*number).is_err()) {
            self.points.insert(point, wrong);
        }
    }

    /// Checks that no face uses them. The error is the place of a number at fault and what is wrong with it.
    pub fn check(&self, draft: &mut Draft) -> Result<(), (usize, String)> {
        if self.points.is_empty() {
            return Ok(());
        }
        let mesh = &draft.mesh;
        let mut corners = mesh.faces().iter().flat_map(|face| mesh.corners(face));
        if let Some(&(at, number)) = corners.find_map(|corner| self.points.get(&corner.point)) {
            return Err((at, coordinate(number).err().unwrap_or_default()));
        }
        let (one, many) =
            ("point that is nowhere and that no face uses", "points that are nowhere and that no face uses");
        draft.notes.extend(passed_over(self.points.len() as u64, one, many));
        Ok(())
    }
}

/// Checks that a mesh stays within what a scene may hold when some corners are added.
pub(crate) fn check_size(mesh: &Mesh, added: u64) -> Result<(), String> {
    if mesh.corner_count() + added > MOST_CORNERS {
        return Err(format!("scene is too large, it has over {MOST_CORNERS} corners of faces"));
    }
    Ok(())
}
