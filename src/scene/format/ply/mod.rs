//! Reads PLY files, as text and in either byte order, and writes them as text.

mod header;
mod values;
mod writer;

use std::path::Path;

use glam::Vec3;

use super::{Draft, Nowhere, check_size, read_file, vertex_color};
use crate::error::InputError;
use crate::input::text::{Text, decode, passed_over, plural};
use crate::scene::mesh::{Corner, NO_NORMAL};
use header::{Element, Encoding, Header, Property, Shape, Type, extent, parse};
use values::{Ascii, Binary, Row, Values};

pub use writer::write as write_ply;

const POSITION: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// The names that programs give to a vertex' colour.
const COLORS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];

/// The names that programs give to the list of a face's or a strip's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// What is taken of a vertex: position, normal and colour.
const PARTS: usize = 9;
/// Where in this list the colour begins.
const FIRST_COLOR: usize = 6;

/// Reads a PLY file: the elements `vertex`, `face` and `tristrips`; all others, and what these have besides, are passed
/// over.
pub(crate) fn read(path: &Path) -> Result<Draft, InputError> {
    let bytes = read_file(path)?;
    let length = extent(path, &bytes)?;
    let source = decode(bytes[..length].to_vec());
    let text = Text { file: path, text: &source };
    let header = parse(text)?;
    let body = Body::new(text, &header)?;
    match header.encoding {
        Encoding::Ascii => {
            let source = decode(bytes);
            body.read(Ascii::new(Text { file: path, text: &source }, text.text.len()))
        }
        Encoding::LittleEndian => body.read(Binary::new(path, &bytes, length, false)),
        Encoding::BigEndian => body.read(Binary::new(path, &bytes, length, true)),
    }
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
    /// The same of a strip of triangles.
    strips: Option<usize>,
}

/// What makes faces of corners: their indices, each behind its place in the file.
type TakeCorners<P, V> = fn(&P, &mut V, &[(usize, f64)], &mut Draft) -> Result<(), InputError>;

impl<'a> Body<'a> {
    fn new(text: Text, header: &'a Header) -> Result<Self, InputError> {
        let Some(vertex) = header.element("vertex") else {
            return Err(text.error(text.end(), "header has no element `vertex`"));
        };
        if let Some(missing) = POSITION.into_iter().find(|name| vertex.position(&[name]).is_none()) {
            return Err(text.error(vertex.span.clone(), format!("element `vertex` has no property `{missing}`")));
        }
        let normal = vertex.has_numbers(&NORMAL).then_some(NORMAL);
        let color = COLORS.into_iter().find(|names| vertex.has_numbers(names));
        let wanted = [Some(POSITION), normal, color].map(|names| names.map_or([None; 3], |names| names.map(Some)));
        let list = |name: &str| header.element(name).map(|element| corner_list(text, element)).transpose();
        Ok(Body {
            elements: &header.elements,
            vertices: vertex.count,
            slots: slots(text, vertex, wanted.as_flattened())?,
            has_normals: normal.is_some(),
            has_colors: color.is_some(),
            indices: list("face")?,
            strips: list("tristrips")?,
        })
    }

    fn read(&self, mut values: impl Values) -> Result<Draft, InputError> {
        let mut draft = Draft::new(Vec3::Z);
        let mut nowhere = Nowhere::default();
        // Without properties an element has no data, however many there are said to be.
        for element in self.elements.iter().filter(|element| !element.properties.is_empty()) {
            for row in (0..element.count).map(|number| Row { element, number }) {
                values.begin(row)?;
                match element.name.as_str() {
                    "vertex" => self.vertex(&mut values, row, &mut draft, &mut nowhere)?,
                    "face" => self.list(&mut values, row, self.indices, &mut draft, Body::face)?,
                    "tristrips" => self.list(&mut values, row, self.strips, &mut draft, Body::strip)?,
                    _ => element.properties.iter().try_for_each(|p| skip(&mut values, p.shape, row))?,
                }
                values.end(row)?;
            }
        }
        values.finish()?;
        nowhere.check(&mut draft).map_err(|(place, message)| values.error_at(place, message))?;
        vertex_color::decode(&mut draft.mesh.colors, &mut draft.notes);
        self.note_others(&mut draft.notes);
        Ok(draft)
    }

    fn note_others(&self, notes: &mut Vec<String>) {
        let is_other = |element: &&Element| !["vertex", "face", "tristrips"].contains(&element.name.as_str());
        let mut others = self.elements.iter().filter(is_other);
        let Some(first) = others.next() else { return };
        let (name, number) = (&first.name, others.count() as u64 + 1);
        let note = passed_over(number, "kind of element", "kinds of elements");
        notes.extend(note.map(|note| format!("{note}: points, faces and strips of triangles are read, not `{name}`")));
    }

    fn vertex(
        &self,
        values: &mut impl Values,
        row: Row,
        draft: &mut Draft,
        nowhere: &mut Nowhere,
    ) -> Result<(), InputError> {
        let mut numbers = [(0, 0.0); PARTS];
        for (property, slot) in row.element.properties.iter().zip(&self.slots) {
            match (property.shape, slot) {
                (Shape::Scalar(kind), Some(slot)) => {
                    let value = values.value(kind, row)?;
                    let value = if *slot < FIRST_COLOR { value } else { color_part(kind, value) };
                    numbers[*slot] = (values.place(), value);
                }
                (shape, _) => skip(values, shape, row)?,
            }
        }
        let [x, y, z, nx, ny, nz, r, g, b] = numbers;
        nowhere.add_point(&mut draft.mesh, [x, y, z]);
        if self.has_normals {
            draft.add_normal([nx.1, ny.1, nz.1]);
        }
        if self.has_colors {
            draft.mesh.color_point(Vec3::new(r.1 as f32, g.1 as f32, b.1 as f32));
        }
        Ok(())
    }

    /// A row that has a list of corners, of which `take` makes faces.
    fn list<V: Values>(
        &self,
        values: &mut V,
        row: Row,
        corners: Option<usize>,
        draft: &mut Draft,
        take: TakeCorners<Self, V>,
    ) -> Result<(), InputError> {
        for (i, property) in row.element.properties.iter().enumerate() {
            match property.shape {
                Shape::List { count, item } if Some(i) == corners => {
                    let count = length(values, count, row)?;
                    check_size(&draft.mesh, count).map_err(|message| values.error(message))?;
                    let mut indices = Vec::new();
                    for _ in 0..count {
                        let index = values.value(item, row)?;
                        indices.push((values.place(), index));
                    }
                    take(self, values, &indices, draft)?;
                }
                shape => skip(values, shape, row)?,
            }
        }
        Ok(())
    }

    fn face<V: Values>(&self, values: &mut V, list: &[(usize, f64)], draft: &mut Draft) -> Result<(), InputError> {
        if list.len() < 3 {
            draft.pass_over_face();
            return Ok(());
        }
        let corners: Vec<Corner> = list.iter().map(|&index| self.corner(values, index)).collect::<Result<_, _>>()?;
        draft.mesh.add_smooth_face(&corners, 0);
        Ok(())
    }

    /// Strips of triangles, each of which shares an edge with the one before; -1 ends a strip.
    fn strip<V: Values>(&self, values: &mut V, list: &[(usize, f64)], draft: &mut Draft) -> Result<(), InputError> {
        for strip in list.split(|&(_, index)| index == -1.0) {
            let corners: Vec<Corner> =
                strip.iter().map(|&index| self.corner(values, index)).collect::<Result<_, _>>()?;
            for (i, triangle) in corners.windows(3).enumerate() {
                let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
                // A corner twice is how strips are joined.
                if a == b || b == c || a == c {
                    continue;
                }
                // Every other triangle runs the other way around.
                draft.mesh.add_smooth_face(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] }, 0);
            }
        }
        Ok(())
    }

    fn corner(&self, values: &impl Values, (place, index): (usize, f64)) -> Result<Corner, InputError> {
        if index < 0.0 || index >= self.vertices as f64 {
            let total = plural(self.vertices, "point");
            let message = format!("there is no point {index}, the file has {total} and counts from 0");
            return Err(values.error_at(place, message));
        }
        let point = index as u32;
        Ok(Corner { point, normal: if self.has_normals { point } else { NO_NORMAL } })
    }
}

/// A part of a colour: unsigned bytes and words count up to the largest of their type.
fn color_part(kind: Type, value: f64) -> f64 {
    match kind {
        Type::Uint8 => value / f64::from(u8::MAX),
        Type::Uint16 => value / f64::from(u16::MAX),
        _ => value,
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
            _ => Ok(slot),
        }
    };
    vertex.properties.iter().map(slot).collect()
}

/// Finds the list of a face's or strip's corners among its properties.
fn corner_list(text: Text, element: &Element) -> Result<usize, InputError> {
    let name = &element.name;
    let Some(position) = element.position(&CORNERS) else {
        return Err(text.error(element.span.clone(), format!("element `{name}` has no list `{}`", CORNERS[0])));
    };
    let property = &element.properties[position];
    match property.shape {
        Shape::List { item, .. } if item.is_integer() => Ok(position),
        _ => {
            let message = format!("property `{}` of `{name}` must be a list of integers", property.name);
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
