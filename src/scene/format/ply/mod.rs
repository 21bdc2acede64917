//! Reads PLY files, as text and in either byte order.

mod header;
mod values;

use std::path::Path;

use glam::Vec3;

use super::{Draft, check_size, read_file, vertex_color};
use crate::error::InputError;
use crate::input::text::{Text, coordinate, plural, too_few_corners};
use crate::scene::mesh::{Corner, Mesh, NO_NORMAL};
use header::{Element, Encoding, Header, Property, Shape, Type, extent, parse};
use values::{Ascii, Binary, Row, Values};

const POSITION: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// The names that programs give to a vertex' colour.
const COLORS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];

const COLOR_TYPES: [Type; 4] = [Type::Uint8, Type::Uint16, Type::Float32, Type::Float64];

/// What is taken of a vertex: position, normal and colour.
const PARTS: usize = 9;
/// Where in this list the colour begins.
const FIRST_COLOR: usize = 6;

/// Reads a PLY file: the elements `vertex` and `face`; all others, and what the two have besides, are passed over.
pub(crate) fn read(path: &Path) -> Result<Draft, InputError> {
    let bytes = read_file(path)?;
    let length = extent(path, &bytes)?;
    let text = Text::decode(path, &bytes[..length])?;
    let header = parse(text)?;
    let body = Body::new(text, &header)?;
    let mut draft = Draft::new(Vec3::Z);
    draft.mesh = match header.encoding {
        Encoding::Ascii => body.mesh(Ascii::new(Text::decode(path, &bytes)?, length))?,
        Encoding::LittleEndian => body.mesh(Binary::new(path, &bytes, length, false))?,
        Encoding::BigEndian => body.mesh(Binary::new(path, &bytes, length, true))?,
    };
    Ok(draft)
}

/// What is to be found behind a header.
struct Body<'a> {
    elements: &'a [Element],
    vertices: u64,
    /// For every property of a vertex, which of its [`PARTS`] it is.
    slots: Vec<Option<usize>>,
    has_normals: bool,
    has_colors: bool,
    /// Which property of a face is the list of its corners.
    indices: Option<usize>,
}

impl<'a> Body<'a> {
    fn new(text: Text, header: &'a Header) -> Result<Self, InputError> {
        let Some(vertex) = header.element("vertex") else {
            return Err(text.error(text.end(), "header has no element `vertex`"));
        };
        if let Some(missing) = POSITION.into_iter().find(|name| vertex.position(&[name]).is_none()) {
            return Err(text.error(vertex.span.clone(), format!("element `vertex` has no property `{missing}`")));
        }
        let has_all = |names: &[&str; 3]| names.iter().all(|name| vertex.position(&[name]).is_some());
        let normal = has_all(&NORMAL).then_some(NORMAL);
        let color = COLORS.into_iter().find(has_all);
        let wanted = [Some(POSITION), normal, color].map(|names| names.map_or([None; 3], |names| names.map(Some)));
        Ok(Body {
            elements: &header.elements,
            vertices: vertex.count,
            slots: slots(text, vertex, wanted.as_flattened())?,
            has_normals: normal.is_some(),
            has_colors: color.is_some(),
            indices: header.element("face").map(|face| corner_list(text, face)).transpose()?,
        })
    }

    fn mesh(&self, mut values: impl Values) -> Result<Mesh, InputError> {
        let mut mesh = Mesh::default();
        // Without properties an element has no data, however many there are said to be.
        for element in self.elements.iter().filter(|element| !element.properties.is_empty()) {
            for row in (0..element.count).map(|number| Row { element, number }) {
                values.begin(row)?;
                match element.name.as_str() {
                    "vertex" => self.vertex(&mut values, row, &mut mesh)?,
                    "face" => self.face(&mut values, row, &mut mesh)?,
                    _ => element.properties.iter().try_for_each(|p| skip(&mut values, p.shape, row))?,
                }
                values.end(row)?;
            }
        }
        values.finish()?;
        Ok(mesh)
    }

    fn vertex(&self, values: &mut impl Values, row: Row, mesh: &mut Mesh) -> Result<(), InputError> {
        let mut numbers = [0.0; PARTS];
        for (property, slot) in row.element.properties.iter().zip(&self.slots) {
            match (property.shape, slot) {
                (Shape::Scalar(kind), Some(slot)) => {
                    let value = values.value(kind, row)?;
                    let part = if *slot < FIRST_COLOR { coordinate(value) } else { color_part(kind, value) };
                    numbers[*slot] = part.map_err(|message| values.error(message))?;
                }
                (shape, _) => skip(values, shape, row)?,
            }
        }
        let [x, y, z, nx, ny, nz, r, g, b] = numbers;
        mesh.add_point(Vec3::new(x, y, z));
        if self.has_normals {
            mesh.add_normal(Vec3::new(nx, ny, nz));
        }
        if self.has_colors {
            mesh.color_point(Vec3::new(r, g, b));
        }
        Ok(())
    }

    fn face(&self, values: &mut impl Values, row: Row, mesh: &mut Mesh) -> Result<(), InputError> {
        for (i, property) in row.element.properties.iter().enumerate() {
            match property.shape {
                Shape::List { count, item } if Some(i) == self.indices => {
                    let count = length(values, count, row)?;
                    if count < 3 {
                        return Err(values.error(too_few_corners(count as usize)));
                    }
                    check_size(mesh, count).map_err(|message| values.error(message))?;
                    let mut corners = Vec::new();
                    for _ in 0..count {
                        corners.push(self.corner(values, item, row)?);
                    }
                    mesh.add_smooth_face(&corners, 0);
                }
                shape => skip(values, shape, row)?,
            }
        }
        Ok(())
    }

    fn corner(&self, values: &mut impl Values, kind: Type, row: Row) -> Result<Corner, InputError> {
        let index = values.value(kind, row)?;
        if index < 0.0 || index >= self.vertices as f64 {
            let total = plural(self.vertices, "point");
            return Err(values.error(format!("there is no point {index}, the file has {total} and counts from 0")));
        }
        let point = index as u32;
        Ok(Corner { point, normal: if self.has_normals { point } else { NO_NORMAL } })
    }
}

/// A part of a colour: integers count up to the largest of their type, other numbers to 1.
fn color_part(kind: Type, value: f64) -> Result<f32, String> {
    match kind.range() {
        Some((_, most)) => vertex_color::decoded(value / most as f64)
            .map_err(|_| format!("{value} is no part of a colour, which is from 0 to {most}")),
        None => vertex_color::decoded(value),
    }
}

/// Finds which of the wanted properties each property of a vertex is.
fn slots(text: Text, vertex: &Element, wanted: &[Option<&str>]) -> Result<Vec<Option<usize>>, InputError> {
    let slot = |property: &Property| {
        let slot = wanted.iter().position(|name| *name == Some(property.name.as_str()));
        match property.shape {
            Shape::List { .. } if slot.is_some() => {
                let message = format!("property `{}` of `vertex` must not be a list", property.name);
                Err(text.error(property.span.clone(), message))
            }
            Shape::Scalar(kind) if slot >= Some(FIRST_COLOR) && !COLOR_TYPES.contains(&kind) => {
                let types = COLOR_TYPES.map(Type::name).join(", ");
                let message =
                    format!("colour `{}` is of type {}, it must be one of {types}", property.name, kind.name());
                Err(text.error(property.span.clone(), message))
            }
            _ => Ok(slot),
        }
    };
    vertex.properties.iter().map(slot).collect()
}

/// Finds the list of a face's corners among its properties.
fn corner_list(text: Text, face: &Element) -> Result<usize, InputError> {
    let Some(position) = face.position(&["vertex_indices", "vertex_index"]) else {
        return Err(text.error(face.span.clone(), "element `face` has no list `vertex_indices`"));
    };
    let property = &face.properties[position];
    match property.shape {
        Shape::List { item, .. } if item.is_integer() => Ok(position),
        _ => {
            let message = format!("property `{}` of `face` must be a list of integers", property.name);
            Err(text.error(property.span.clone(), message))
        }
    }
}

fn length(values: &mut impl Values, kind: Type, row: Row) -> Result<u64, InputError> {
    let count = values.value(kind, row)?;
    if count < 0.0 {
        return Err(values.error(format!("length of a list is negative: {count}")));
    }
    Ok(count as u64)
}

fn skip(values: &mut impl Values, shape: Shape, row: Row) -> Result<(), InputError> {
    match shape {
        Shape::Scalar(kind) => values.value(kind, row).map(drop),
        Shape::List { count, item } => {
            for _ in 0..length(values, count, row)? {
                values.value(item, row)?;
            }
            Ok(())
        }
    }
}
