//! Reads Wavefront OBJ files.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::path::Path;

use glam::Vec3;

use super::mtl;
use super::statements::{Statements, name_of};
use super::{Draft, read_file, vertex_color};
use crate::error::InputError;
use crate::input::text::{Text, Token, nearest, plural, too_few_corners};
use crate::scene::Material;
use crate::scene::mesh::{Corner, NO_NORMAL};

/// The statements that mean something here.
const HANDLED: &[&str] = &["v", "vn", "vt", "f", "fo", "usemtl", "mtllib", "o", "g"];

/// What would be drawn, were it not for the array's taking polygons only.
const NOT_TRACED: &[&str] = &["l", "p", "curv", "surf", "bsp", "bzp", "cdp", "call"];

/// What says how things are shaded, how curves run, or is for other programs.
const SILENT: &[&str] = &[
    "s",
    "mg",
    "lod",
    "bevel",
    "c_interp",
    "d_interp",
    "maplib",
    "usemap",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "vp",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "res",
    "curv2",
    "cdc",
    "csh",
];

/// Reads an OBJ file and the material files that it names, as far as they stand beside it.
pub(crate) fn read(path: &Path) -> Result<Draft, InputError> {
    let bytes = read_file(path)?;
    let text = Text::decode(path, &bytes)?;
    let mut reader = Reader::new(text);
    let mut statements = Statements::new(text);
    let mut tokens = Vec::new();
    while statements.next_into(&mut tokens) {
        reader.statement(tokens[0], &tokens[1..])?;
    }
    reader.finish()
}

struct Reader<'a> {
    text: Text<'a>,
    draft: Draft,
    /// How many texture coordinates there are; only the indices into them are looked at.
    textures: usize,
    ahead: Vec<Reference>,
    materials: Materials,
    not_traced: BTreeMap<&'a str, u64>,
    corners: Vec<Corner>,
}

/// An index that points at what the file does not have yet.
struct Reference {
    span: Range<usize>,
    kind: Kind,
    index: u64,
}

#[derive(Clone, Copy)]
enum Kind {
    Point,
    Texture,
    Normal,
}

impl Kind {
    fn noun(self) -> &'static str {
        match self {
            Kind::Point => "point",
            Kind::Texture => "texture coordinate",
            Kind::Normal => "normal",
        }
    }
}

impl<'a> Reader<'a> {
    fn new(text: Text<'a>) -> Self {
        Reader {
            text,
            draft: Draft::new(Vec3::Y),
            textures: 0,
            ahead: Vec::new(),
            materials: Materials::default(),
            not_traced: BTreeMap::new(),
            corners: Vec::new(),
        }
    }

    fn statement(&mut self, keyword: Token<'a>, arguments: &[Token<'a>]) -> Result<(), InputError> {
        match keyword.text {
            "v" => self.point(keyword, arguments)?,
            "vn" => {
                self.draft.mesh.add_normal(self.vector(keyword, arguments)?);
            }
            "vt" => self.textures += 1,
            "f" | "fo" => self.face(keyword, arguments)?,
            "o" | "g" => self.draft.mesh.begin_object(),
            "usemtl" => self.materials.choose(name_of(self.text, arguments)),
            "mtllib" => self.material_files(arguments)?,
            other if NOT_TRACED.contains(&other) => *self.not_traced.entry(other).or_default() += 1,
            other if SILENT.contains(&other) => {}
            _ => return Err(self.unknown(keyword)),
        }
        Ok(())
    }

    /// A point, which may have a weight, that means nothing here, or a colour.
    fn point(&mut self, keyword: Token, arguments: &[Token]) -> Result<(), InputError> {
        self.draft.mesh.add_point(self.vector(keyword, arguments)?);
        match *arguments {
            [_, _, _] | [_, _, _, _] => {}
            [_, _, _, r, g, b] => {
                let part = |token| {
                    let part = vertex_color::decoded(self.text.number(token)?);
                    part.map_err(|message| self.text.error_at(token, message))
                };
                self.draft.mesh.color_point(Vec3::new(part(r)?, part(g)?, part(b)?));
            }
            _ => {
                let message =
                    format!("`v` has {} numbers, it takes 3, 4 with a weight, 6 with a colour", arguments.len());
                return Err(self.text.error_at(keyword, message));
            }
        }
        Ok(())
    }

    /// The first three numbers.
    fn vector(&self, keyword: Token, arguments: &[Token]) -> Result<Vec3, InputError> {
        match *arguments {
            [x, y, z, ..] => self.text.vector([x, y, z]),
            _ => {
                let message = format!("`{}` needs 3 numbers and has {}", keyword.text, arguments.len());
                Err(self.text.error_at(keyword, message))
            }
        }
    }

    fn face(&mut self, keyword: Token, arguments: &[Token]) -> Result<(), InputError> {
        if arguments.len() < 3 {
            return Err(self.text.error_at(keyword, too_few_corners(arguments.len())));
        }
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for &argument in arguments {
            corners.push(self.corner(argument)?);
        }
        self.draft.mesh.add_smooth_face(&corners, self.materials.current);
        self.corners = corners;
        Ok(())
    }

    /// A corner: `point`, `point/texture`, `point//normal` or `point/texture/normal`.
    fn corner(&mut self, token: Token) -> Result<Corner, InputError> {
        let mut parts = token.text.split('/');
        let point = self.index(token, parts.next().unwrap_or(""), Kind::Point)?;
        if let Some(texture) = parts.next().filter(|part| !part.is_empty()) {
            self.index(token, texture, Kind::Texture)?;
        }
        let normal = match parts.next().filter(|part| !part.is_empty()) {
            Some(normal) => self.index(token, normal, Kind::Normal)?,
            None => NO_NORMAL,
        };
        match parts.next() {
            Some(_) => Err(self.text.error_at(token, format!("`{}` has more than 3 indices", token.text))),
            None => Ok(Corner { point, normal }),
        }
    }

    /// Counts from 0 what the file counts from 1, or from -1 backwards.
    fn index(&mut self, token: Token, part: &str, kind: Kind) -> Result<u32, InputError> {
        let at = self.text.offset_of(part);
        let span = at..at + part.len();
        let index: i64 = part
            .parse()
            .map_err(|_| self.text.error_at(token, format!("`{}` is not a corner of a face", token.text)))?;
        let count = self.count(kind);
        if index == 0 {
            return Err(self.text.error(span, "index is 0, indices count from 1"));
        }
        if index > 0 {
            if index as u64 > count {
                self.ahead.push(Reference { span, kind, index: index as u64 });
            }
            return Ok((index as u64 - 1) as u32);
        }
        match count.checked_sub(index.unsigned_abs()) {
            Some(index) => Ok(index as u32),
            None => {
                let (noun, so_far) = (kind.noun(), plural(count, kind.noun()));
                Err(self.text.error(span, format!("there is no {noun} {index}, the file has {so_far} up to here")))
            }
        }
    }

    fn count(&self, kind: Kind) -> u64 {
        let count = match kind {
            Kind::Point => self.draft.mesh.points.len(),
            Kind::Texture => self.textures,
            Kind::Normal => self.draft.mesh.normals.len(),
        };
        count as u64
    }

    fn material_files(&mut self, arguments: &[Token]) -> Result<(), InputError> {
        let folder = self.text.file.parent().unwrap_or(Path::new(""));
        // One file whose name has spaces, or several files.
        let whole = name_of(self.text, arguments);
        let names = if folder.join(whole).is_file() { vec![whole] } else { arguments.iter().map(|a| a.text).collect() };
        for name in names {
            let path = folder.join(name);
            if path.is_file() {
                self.materials.known.extend(mtl::read(&path)?);
            } else {
                self.materials.file_missing = true;
                let note = format!("material file `{name}` was not found, the default material takes its place");
                self.draft.notes.push(note);
            }
        }
        Ok(())
    }

    fn unknown(&self, keyword: Token) -> InputError {
        let error = self.text.error_at(keyword, format!("`{}` is no OBJ statement", keyword.text));
        let known = HANDLED.iter().chain(NOT_TRACED).chain(SILENT);
        match nearest(keyword.text, known.copied()) {
            Some(name) => error.help(format!("did you mean `{name}`?")),
            None => error,
        }
    }

    fn finish(mut self) -> Result<Draft, InputError> {
        for ahead in &self.ahead {
            let count = self.count(ahead.kind);
            if ahead.index > count {
                let (noun, total) = (ahead.kind.noun(), plural(count, ahead.kind.noun()));
                let message = format!("there is no {noun} {}, the file has {total}", ahead.index);
                return Err(self.text.error(ahead.span.clone(), message));
            }
        }
        self.draft.materials = self.materials.list(&mut self.draft.notes);
        for (statement, count) in self.not_traced {
            let times = plural(count, "time");
            self.draft.notes.push(format!("`{statement}` was skipped {times}: only faces are traced"));
        }
        Ok(self.draft)
    }
}

/// The materials that the faces use, numbered as they come: the default one first.
#[derive(Default)]
struct Materials {
    used: Vec<String>,
    numbers: HashMap<String, u32>,
    current: u32,
    /// What the material files define.
    known: HashMap<String, Material>,
    file_missing: bool,
}

impl Materials {
    fn choose(&mut self, name: &str) {
        let number = self.used.len() as u32 + 1;
        self.current = *self.numbers.entry(name.to_owned()).or_insert(number);
        if self.current == number {
            self.used.push(name.to_owned());
        }
    }

    fn list(&self, notes: &mut Vec<String>) -> Vec<Material> {
        let unknown = self.used.iter().filter(|name| !self.known.contains_key(*name)).count() as u64;
        // A missing file has been told of already.
        if unknown > 0 && !self.file_missing {
            notes.push(format!("{} without a definition became the default material", plural(unknown, "material")));
        }
        let material = |name| self.known.get(name).copied().unwrap_or_default();
        std::iter::once(Material::default()).chain(self.used.iter().map(material)).collect()
    }
}
