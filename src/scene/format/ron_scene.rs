//! Reads the project's own scene files (RON): a camera, lights, materials, and meshes from wherever they come.

mod solid;

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec3, Vec3};
use serde::Deserialize;

use self::solid::Node;
use super::transform::{Step, Transform};
use super::{Draft, Format, ReadOptions, read_file, short_faces};
use crate::error::InputError;
use crate::input::ron_text::{self, Located, suggest};
use crate::input::text::{self, Text, amount, coordinate, plural};
use crate::scene::camera::CameraFault;
use crate::scene::mesh::Mesh;
use crate::scene::solid::Cut;
use crate::scene::{Camera, Light, Material, builtin};

/// Three numbers in parentheses.
type Triple<'a> = Located<'a, (f64, f64, f64)>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Scene", bound(deserialize = "'de: 'a"))]
struct SceneText<'a> {
    camera: Option<CameraText<'a>>,
    #[serde(default)]
    lights: Vec<LightText<'a>>,
    background: Option<Triple<'a>>,
    #[serde(default)]
    materials: Vec<MaterialText<'a>>,
    meshes: Vec<MeshText<'a>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Camera", bound(deserialize = "'de: 'a"))]
struct CameraText<'a> {
    from: Triple<'a>,
    at: Triple<'a>,
    up: Triple<'a>,
    angle: Located<'a, f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Light", bound(deserialize = "'de: 'a"))]
struct LightText<'a> {
    at: Option<Triple<'a>>,
    towards: Option<Triple<'a>>,
    color: Option<Triple<'a>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Material", bound(deserialize = "'de: 'a"))]
struct MaterialText<'a> {
    name: Located<'a, String>,
    color: Option<Triple<'a>>,
    diffuse: Option<Located<'a, f64>>,
    specular: Option<Located<'a, f64>>,
    shine: Option<Located<'a, f64>>,
    transmittance: Option<Located<'a, f64>>,
    refraction: Option<Located<'a, f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Mesh", bound(deserialize = "'de: 'a"))]
struct MeshText<'a> {
    shape: ShapeText<'a>,
    material: Option<Located<'a, String>>,
    #[serde(default)]
    transform: Vec<Located<'a, StepText>>,
    /// This and what follows is of `Csg` alone.
    cut: Option<Located<'a, Cut>>,
    join: Option<Located<'a, bool>>,
    max_polygons: Option<Located<'a, u64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Shape", bound(deserialize = "'de: 'a"))]
enum ShapeText<'a> {
    Csg(Node<'a>),
    File(Located<'a, String>),
    Builtin {
        name: Located<'a, String>,
        size: Option<u32>,
        resolution: Option<u32>,
    },
    Polygons {
        points: Vec<Triple<'a>>,
        faces: Vec<Located<'a, Vec<i64>>>,
        #[serde(default)]
        colors: Vec<Triple<'a>>,
        #[serde(default)]
        materials: Vec<Located<'a, String>>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename = "Transform")]
enum StepText {
    Translate(f64, f64, f64),
    Scale(f64, f64, f64),
    Rotate { axis: (f64, f64, f64), degrees: f64 },
}

/// Reads a scene file. The meshes that it names are looked for beside it.
///
/// Of a file or built-in scene that is taken as a mesh, only faces and materials count; its camera and its lights stay
/// out.
pub(crate) fn read(path: &Path, options: &ReadOptions) -> Result<Draft, InputError> {
    let source = text::decode(read_file(path)?);
    let text = Text { file: path, text: &source };
    let scene: SceneText = ron_text::read(text, text.text)?;
    let mut reader = Reader { text, options, draft: Draft::new(Vec3::Z), names: HashMap::new() };
    reader.draft.camera = scene.camera.as_ref().map(|camera| reader.camera(camera)).transpose()?;
    reader.draft.lights = scene.lights.iter().map(|light| reader.light(light)).collect::<Result<_, _>>()?;
    reader.draft.background = reader.color(scene.background.as_ref(), Vec3::ZERO)?;
    for material in &scene.materials {
        reader.material(material)?;
    }
    for mesh in &scene.meshes {
        reader.mesh(mesh)?;
    }
    Ok(reader.draft)
}

struct Reader<'a> {
    text: Text<'a>,
    options: &'a ReadOptions,
    draft: Draft,
    /// The numbers of the materials that the file names.
    names: HashMap<String, u32>,
}

impl Reader<'_> {
    fn camera(&self, camera: &CameraText) -> Result<Camera, InputError> {
        let read = Camera {
            from: self.vector(&camera.from)?,
            at: self.vector(&camera.at)?,
            up: self.vector(&camera.up)?,
            angle: self.checked(&camera.angle, coordinate)?,
        };
        read.check().map_err(|fault| match fault {
            CameraFault::NoLineOfSight => camera.at.error(self.text, fault.message()),
            CameraFault::NoUp => camera.up.error(self.text, fault.message()),
            CameraFault::Angle => camera.angle.error(self.text, fault.message()),
        })?;
        Ok(read)
    }

    fn light(&self, light: &LightText) -> Result<Light, InputError> {
        let color = self.color(light.color.as_ref(), Vec3::ONE)?;
        match (&light.at, &light.towards) {
            (Some(at), None) => Ok(Light::point(self.vector(at)?, color)),
            (None, Some(towards)) => {
                let direction = self.vector(towards)?;
                if direction == Vec3::ZERO {
                    return Err(towards.error(self.text, "light's direction is zero"));
                }
                Ok(Light::directional(direction, color))
            }
            (Some(_), Some(towards)) => Err(towards.error(self.text, "light has both `at` and `towards`")),
            (None, None) => {
                let message = "light has neither `at` nor `towards`";
                let file = || InputError::in_file(self.text.file, message);
                Err(light.color.as_ref().map_or_else(file, |color| color.error(self.text, message)))
            }
        }
    }

    fn material(&mut self, material: &MaterialText) -> Result<(), InputError> {
        let name = material.name.read(self.text)?;
        let plain = Material::default();
        let read = Material {
            color: self.color(material.color.as_ref(), plain.color)?,
            diffuse: self.number(material.diffuse.as_ref(), share, plain.diffuse)?,
            specular: self.number(material.specular.as_ref(), share, plain.specular)?,
            shine: self.number(material.shine.as_ref(), amount, plain.shine)?,
            transmittance: self.number(material.transmittance.as_ref(), share, plain.transmittance)?,
            refraction: self.number(material.refraction.as_ref(), above_zero, plain.refraction)?,
        };
        if self.names.contains_key(&name) {
            return Err(material.name.error(self.text, format!("there are two materials `{name}`")));
        }
        self.names.insert(name, self.draft.materials.len() as u32);
        self.draft.materials.push(read);
        Ok(())
    }

    fn mesh(&mut self, text: &MeshText) -> Result<(), InputError> {
        if let ShapeText::Csg(solid) = &text.shape {
            return self.csg(text, solid);
        }
        self.check_no_solid(text)?;
        let material = text.material.as_ref().map(|name| self.material_number(name)).transpose()?;
        let steps: Vec<Step> = text.transform.iter().map(|step| self.step(step)).collect::<Result<_, _>>()?;
        let mut shape = self.shape(&text.shape)?;
        match (&text.material, &text.shape) {
            (Some(name), ShapeText::Polygons { materials, .. }) if !materials.is_empty() => {
                return Err(name.error(self.text, "mesh has a material, and so has each of its faces"));
            }
            (Some(_), ShapeText::File(_) | ShapeText::Builtin { .. }) => shape.mesh.colors.clear(),
            _ => {}
        }
        let first = if shape.materials.is_empty() { 0 } else { self.draft.materials.len() as u32 };
        if material.is_none() {
            self.draft.materials.extend(shape.materials);
        }
        self.draft.notes.extend(shape.notes);
        let number = |own: u32| material.unwrap_or(first + own);
        let outcome = Transform::of(&steps).append(&mut self.draft.mesh, shape.mesh, number);
        outcome.map_err(|message| match (text.transform.last(), &text.shape) {
            (Some(step), _) => step.error(self.text, format!("transformed coordinate {message}")),
            (None, ShapeText::File(name) | ShapeText::Builtin { name, .. }) => name.error(self.text, message),
            (None, ShapeText::Polygons { .. } | ShapeText::Csg(_)) => InputError::in_file(self.text.file, message),
        })
    }

    /// Refuses what only solids have.
    fn check_no_solid(&self, text: &MeshText) -> Result<(), InputError> {
        let cut = text.cut.as_ref().map(|cut| cut.error(self.text, "`cut` is of solids"));
        let join = text.join.as_ref().map(|join| join.error(self.text, "`join` is of solids"));
        let most = text.max_polygons.as_ref().map(|most| most.error(self.text, "`max_polygons` is of solids"));
        cut.or(join).or(most).map_or(Ok(()), |error| Err(error.help("leave it out, or make the shape a Csg(...)")))
    }

    fn material_number(&self, name: &Located<String>) -> Result<u32, InputError> {
        let wanted = name.read(self.text)?;
        self.names.get(&wanted).copied().ok_or_else(|| {
            let error = name.error(self.text, format!("there is no material `{wanted}`"));
            if self.names.is_empty() {
                return error.help("the file defines no materials");
            }
            let mut known: Vec<&str> = self.names.keys().map(String::as_str).collect();
            known.sort_unstable();
            suggest(error, &wanted, &known, "materials")
        })
    }

    fn step(&self, text: &Located<StepText>) -> Result<Step, InputError> {
        let fault = |message: String| text.error(self.text, message);
        let vector = |x, y, z| Ok(triple((x, y, z), coordinate).map_err(fault)?.as_dvec3());
        match text.read(self.text)? {
            StepText::Translate(x, y, z) => Ok(Step::Translate(vector(x, y, z)?)),
            StepText::Scale(x, y, z) => {
                let by: DVec3 = vector(x, y, z)?;
                if by.abs().min_element() == 0.0 {
                    return Err(fault("scale factor is 0, nothing would be left to see".to_owned()));
                }
                Ok(Step::Scale(by))
            }
            StepText::Rotate { axis: (x, y, z), degrees } => {
                let axis: DVec3 = vector(x, y, z)?;
                let axis = axis.try_normalize().ok_or_else(|| fault("axis of rotation is zero".to_owned()))?;
                let degrees = coordinate(degrees).map_err(fault)?;
                Ok(Step::Rotate(axis, f64::from(degrees).to_radians()))
            }
        }
    }

    fn shape(&self, shape: &ShapeText) -> Result<Shape, InputError> {
        match shape {
            ShapeText::File(name) => self.file(name),
            ShapeText::Builtin { name, size, resolution } => {
                let scene = builtin::generate(&name.read(self.text)?, *size, *resolution);
                let scene = scene.map_err(|error| InputError {
                    help: error.help,
                    place: error.place.or(name.error(self.text, "").place),
                    message: error.message,
                })?;
                Ok(Shape { mesh: scene.mesh, materials: scene.materials, notes: scene.notes })
            }
            ShapeText::Polygons { points, faces, colors, materials } => {
                self.one_each("point", points.len(), "colour", colors)?;
                self.one_each("face", faces.len(), "material", materials)?;
                self.polygons(points, faces, colors, materials)
            }
            ShapeText::Csg(solid) => Err(solid.error(self.text, "a solid is no mesh")),
        }
    }

    fn file(&self, name: &Located<String>) -> Result<Shape, InputError> {
        let file = name.read(self.text)?;
        let path = self.text.file.parent().unwrap_or(Path::new("")).join(&file);
        if !path.is_file() {
            return Err(name.error(self.text, format!("mesh file `{file}` was not found beside the scene file")));
        }
        let format =
            Format::of(&path).map_err(|error| InputError { place: name.error(self.text, "").place, ..error })?;
        if format == Format::Ron {
            return Err(name.error(self.text, "a scene file cannot be the mesh of another one"));
        }
        let draft = format.read(&path, self.options)?;
        Ok(Shape { mesh: draft.mesh, materials: draft.materials, notes: draft.notes })
    }

    fn polygons(
        &self,
        points: &[Triple],
        faces: &[Located<Vec<i64>>],
        colors: &[Triple],
        materials: &[Located<String>],
    ) -> Result<Shape, InputError> {
        let numbers: Vec<u32> = materials.iter().map(|name| self.material_number(name)).collect::<Result<_, _>>()?;
        let mut mesh = Mesh::default();
        for (number, point) in points.iter().enumerate() {
            mesh.add_point(self.vector(point)?);
            if let Some(color) = colors.get(number) {
                mesh.color_point(self.color(Some(color), Vec3::ONE)?);
            }
        }
        let mut short = 0;
        for (number, face) in faces.iter().enumerate() {
            let corners = face.read(self.text)?;
            if corners.len() < 3 {
                short += 1;
                mesh.pass_over_face();
                continue;
            }
            if let Some(wrong) = corners.iter().find(|&&index| index < 0 || index >= points.len() as i64) {
                let total = plural(points.len() as u64, "point");
                let message = format!("there is no point {wrong}, the mesh has {total} and counts from 0");
                return Err(face.error(self.text, message));
            }
            let corners: Vec<u32> = corners.iter().map(|&index| index as u32).collect();
            mesh.add_face(&corners, numbers.get(number).copied().unwrap_or(0));
        }
        let materials = if numbers.is_empty() { vec![Material::default()] } else { Vec::new() };
        Ok(Shape { mesh, materials, notes: short_faces(short).into_iter().collect() })
    }

    /// Checks that a list is empty, or has one entry for each of `count` things.
    fn one_each<T>(&self, thing: &str, count: usize, entry: &str, list: &[Located<T>]) -> Result<(), InputError> {
        let Some(last) = list.last().filter(|_| list.len() != count) else { return Ok(()) };
        let (things, entries) = (plural(count as u64, thing), plural(list.len() as u64, entry));
        Err(last.error(self.text, format!("mesh has {things} and {entries}, it needs one for each {thing}")))
    }

    fn vector(&self, text: &Triple) -> Result<Vec3, InputError> {
        self.checked(text, |numbers| triple(numbers, coordinate))
    }

    fn color(&self, text: Option<&Triple>, default: Vec3) -> Result<Vec3, InputError> {
        text.map_or(Ok(default), |text| self.checked(text, |numbers| triple(numbers, amount)))
    }

    fn number(
        &self,
        text: Option<&Located<f64>>,
        check: fn(f64) -> Result<f32, String>,
        default: f32,
    ) -> Result<f32, InputError> {
        text.map_or(Ok(default), |text| self.checked(text, check))
    }

    /// Reads a value and checks what it means.
    fn checked<T: serde::de::DeserializeOwned, U>(
        &self,
        text: &Located<T>,
        check: impl Fn(T) -> Result<U, String>,
    ) -> Result<U, InputError> {
        check(text.read(self.text)?).map_err(|message| text.error(self.text, message))
    }
}

/// What a mesh of the file comes to, before it is transformed.
struct Shape {
    mesh: Mesh,
    /// What its faces are made of; where it is empty, they count into the scene's materials.
    materials: Vec<Material>,
    notes: Vec<String>,
}

fn triple((x, y, z): (f64, f64, f64), check: fn(f64) -> Result<f32, String>) -> Result<Vec3, String> {
    Ok(Vec3::new(check(x)?, check(y)?, check(z)?))
}

fn share(number: f64) -> Result<f32, String> {
    if (0.0..=1.0).contains(&number) { Ok(number as f32) } else { Err(format!("{number} is not from 0 to 1")) }
}

fn above_zero(number: f64) -> Result<f32, String> {
    if number > 0.0 { amount(number) } else { Err(format!("{number} is not above 0")) }
}
