//! Reads Wavefront OBJ files.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::mtl;
use super::statements::{Statements, name_of};
use super::{Draft, Nowhere, read_file, vertex_color};
use crate::error::InputError;
use crate::input::text::{self, Text, Token, nearest, parsed, passed_over, plural};
use crate::scene::Material;
use crate::scene::mesh::{Corner, NO_NORMAL};

/// The statements that mean something here.
const HANDLED: &[&str] = &["v", "vn", "vt", "f", "fo", "usemtl", "mtllib", "o", "g"];

/// Those of them that take a name.
const NAMED: &[&str] = &["usemtl", "mtllib", "o", "g"];

/// What would be drawn, were it not for the array's taking polygons only.
const NOT_TRACED: &[(&str, &str, &str)] = &[
    ("l", "line", "lines"),
    ("p", "list of points", "lists of points"),
    ("curv", "curve", "curves"),
    ("surf", "surface", "surfaces"),
    ("bsp", "B-spline patch", "B-spline patches"),
    ("bzp", "Bézier patch", "Bézier patches"),
    ("cdp", "Cardinal patch", "Cardinal patches"),
    ("call", "call of another file", "calls of other files"),
];

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
    let source = text::decode(read_file(path)?);
    let text = Text { file: path, text: &source };
    let mut reader = Reader::new(text);
    let mut statements = Statements::new(text);
    let mut tokens = Vec::new();
    while statements.next_into(&mut tokens) {
        reader.statement(tokens[0], &tokens[1..])?;
        if NAMED.contains(&tokens[0].text) {
            reader.swallowed.extend(statements.swallowed(&tokens, is_keyword));
        }
    }
    reader.finish()
}

fn is_keyword(word: &str) -> bool {
    keywords().any(|keyword| keyword == word)
}

fn keywords() -> impl Iterator<Item = &'static str> {
    HANDLED.iter().copied().chain(NOT_TRACED.iter().map(|&(keyword, ..)| keyword)).chain(SILENT.iter().copied())
}

struct Reader<'a> {
    text: Text<'a>,
    draft: Draft,
    ahead: Vec<Reference>,
    materials: Materials,
    nowhere: Nowhere,
    counts: Counts,
    /// Statements that a backslash at the end of a name has made a part of it.
    swallowed: Vec<Token<'a>>,
    corners: Vec<Corner>,
}

/// What is counted for the notes.
#[derive(Default)]
struct Counts {
    /// For each of [`NOT_TRACED`].
    not_traced: [u64; NOT_TRACED.len()],
    alphas: u64,
    odd_points: u64,
    missing_normals: u64,
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
    Normal,
}

impl Kind {
    fn noun(self) -> &'static str {
        match self {
            Kind::Point => "point",
            Kind::Normal => "normal",
        }
    }
}

impl<'a> Reader<'a> {
    fn new(text: Text<'a>) -> Self {
        Reader {
            text,
            draft: Draft::new(Vec3::Y),
            ahead: Vec::new(),
            materials: Materials::default(),
            nowhere: Nowhere::default(),
            counts: Counts::default(),
            swallowed: Vec::new(),
            corners: Vec::new(),
        }
    }

    fn statement(&mut self, keyword: Token<'a>, arguments: &[Token<'a>]) -> Result<(), InputError> {
        match keyword.text {
            "v" => self.point(keyword, arguments)?,
            "vn" => {
                self.draft.add_normal([0, 1, 2].map(|i| number_or_none(arguments.get(i))));
            }
            "f" | "fo" => self.face(arguments)?,
            "o" | "g" => self.draft.mesh.begin_object(),
            "usemtl" => self.materials.choose(name_of(self.text, arguments)),
            "mtllib" => self.material_files(name_of(self.text, arguments)),
            "vt" => {}
            other => match NOT_TRACED.iter().position(|&(name, ..)| name == other) {
                Some(kind) => self.counts.not_traced[kind] += 1,
                None if SILENT.contains(&other) => {}
                None => return Err(self.unknown(keyword)),
            },
        }
        Ok(())
    }

    /// A point, which may have a weight, that means nothing here, or a colour.
    fn point(&mut self, keyword: Token, arguments: &[Token]) -> Result<(), InputError> {
        let [x, y, z, rest @ ..] = arguments else {
            let message = format!("`v` needs 3 numbers and has {}", arguments.len());
            return Err(self.text.error_at(keyword, message));
        };
        let number = |token: &Token| Ok((token.at, self.text.any_number(*token)?));
        let numbers = [number(x)?, number(y)?, number(z)?];
        self.nowhere.add_point(&mut self.draft.mesh, numbers);
        match rest.len() {
            0 | 1 => return Ok(()),
            3 => {}
            4 => self.counts.alphas += 1,
            _ => {
                self.counts.odd_points += 1;
                return Ok(());
            }
        }
        let part = |i| number_or_none(rest.get(i)) as f32;
        self.draft.mesh.color_point(Vec3::new(part(0), part(1), part(2)));
        Ok(())
    }

    fn face(&mut self, arguments: &[Token]) -> Result<(), InputError> {
        if arguments.len() < 3 {
            self.draft.pass_over_face();
            return Ok(());
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
        let point = self.index(token, parts.next().unwrap_or(""), Kind::Point)?.unwrap_or(0);
        if let Some(texture) = parts.next().filter(|part| !part.is_empty()) {
            self.integer(token, texture)?;
        }
        let normal = match parts.next().filter(|part| !part.is_empty()) {
            Some(normal) => self.index(token, normal, Kind::Normal)?.unwrap_or(NO_NORMAL),
            None => NO_NORMAL,
        };
        match parts.next() {
            Some(_) => Err(self.text.error_at(token, format!("`{}` has more than 3 indices", token.text))),
            None => Ok(Corner { point, normal }),
        }
    }

    fn integer(&self, token: Token, part: &str) -> Result<i64, InputError> {
        let message = || format!("`{}` is not a corner of a face", token.text);
        part.parse().map_err(|_| self.text.error_at(token, message()))
    }

    /// Counts from 0 what the file counts from 1, or from -1 backwards; `None` for a normal that there is not.
    fn index(&mut self, token: Token, part: &str, kind: Kind) -> Result<Option<u32>, InputError> {
        let at = self.text.offset_of(part);
        let span = at..at + part.len();
        let index = self.integer(token, part)?;
        let count = self.count(kind);
        if index > 0 {
            if index as u64 > count {
                self.ahead.push(Reference { span, kind, index: index as u64 });
            }
            return Ok(u32::try_from(index - 1).ok());
        }
        match count.checked_sub(index.unsigned_abs()) {
            Some(behind) if index < 0 => Ok(Some(behind as u32)),
            _ if matches!(kind, Kind::Normal) => {
                self.counts.missing_normals += 1;
                Ok(None)
            }
            _ if index == 0 => Err(self.text.error(span, "index is 0, indices count from 1")),
            _ => {
                let (noun, so_far) = (kind.noun(), plural(count, kind.noun()));
                Err(self.text.error(span, format!("there is no {noun} {index}, the file has {so_far} up to here")))
            }
        }
    }

    fn count(&self, kind: Kind) -> u64 {
        let count = match kind {
            Kind::Point => self.draft.mesh.points.len(),
            Kind::Normal => self.draft.mesh.normals.len(),
        };
        count as u64
    }

    fn material_files(&mut self, names: &str) {
        let folder = self.text.file.parent().unwrap_or(Path::new(""));
        // One file whose name has spaces, or several files.
        let whole = found(folder, names).map(|_| vec![names]);
        for name in whole.unwrap_or_else(|| split_names(names)) {
            if self.materials.files.insert(name.to_owned()) {
                self.materials.file(found(folder, name), name, &mut self.draft.notes);
            }
        }
    }

    fn unknown(&self, keyword: Token) -> InputError {
        let error = self.text.error_at(keyword, format!("`{}` is no OBJ statement", keyword.text));
        match nearest(keyword.text, keywords()) {
            Some(name) => error.help(format!("did you mean `{name}`?")),
            None => error,
        }
    }

    fn finish(mut self) -> Result<Draft, InputError> {
        self.check_ahead()?;
        let wrong = |(at, message)| {
            let token = self.text.tokens(&self.text.text[at..]).next();
            self.text.error(token.map_or(at..at, |token| token.span()), message)
        };
        self.nowhere.check(&mut self.draft).map_err(wrong)?;
        vertex_color::decode(&mut self.draft.mesh.colors, &mut self.draft.notes);
        self.draft.materials = self.materials.list(&mut self.draft.notes);
        self.notes();
        Ok(self.draft)
    }

    /// Checks what pointed ahead: points must be there by now; normals that are not are done without.
    fn check_ahead(&mut self) -> Result<(), InputError> {
        let missing = |ahead: &&Reference| ahead.index > self.count(ahead.kind);
        let (mut points, mut normals) = (None, 0);
        for ahead in self.ahead.iter().filter(missing) {
            match ahead.kind {
                Kind::Point => points = points.or(Some(ahead)),
                Kind::Normal => normals += 1,
            }
        }
        if let Some(ahead) = points {
            let total = plural(self.count(Kind::Point), "point");
            let message = format!("there is no point {}, the file has {total}", ahead.index);
            return Err(self.text.error(ahead.span.clone(), message));
        }
        if normals > 0 {
            self.counts.missing_normals += normals;
            self.draft.mesh.drop_missing_normals();
        }
        Ok(())
    }

    fn notes(&mut self) {
        let notes = &mut self.draft.notes;
        for (&(keyword, one, many), &count) in NOT_TRACED.iter().zip(&self.counts.not_traced) {
            let note = passed_over(count, one, many);
            notes.extend(note.map(|note| format!("{note} (`{keyword}`): only faces are traced")));
        }
        let (one, many) = ("alpha of a point's colour", "alphas of points' colours");
        notes.extend(passed_over(self.counts.alphas, one, many));
        let (one, many) = ("point's weight and colour", "points' weights and colours");
        let odd = passed_over(self.counts.odd_points, one, many);
        notes.extend(odd.map(|note| format!("{note}: `v` takes 3 numbers, 4, 6 with a colour or 7 with its alpha")));
        let (one, many) = ("corner's normal that is not in the file", "corners' normals that are not in the file");
        notes.extend(passed_over(self.counts.missing_normals, one, many));
        if let Some(first) = self.swallowed.first() {
            let lines = plural(self.swallowed.len() as u64, "name");
            let (keyword, line) = (first.text, self.text.line(first.at));
            notes.push(format!(
                "{lines} took in the next line, as a backslash at the end of a line asks for: `{keyword}` in line {line}"
            ));
        }
    }
}

fn number_or_none(token: Option<&Token>) -> f64 {
    token.and_then(|token| parsed(token.text)).unwrap_or(f64::NAN)
}

/// The file of that name in a folder; the name may stand in quotes, and may have backslashes between its folders.
fn found(folder: &Path, name: &str) -> Option<PathBuf> {
    let bare = name.trim_matches('"');
    [folder.join(bare), folder.join(bare.replace('\\', "/"))].into_iter().find(|path| path.is_file())
}

/// The names of several files, of which those with spaces stand in quotes.
fn split_names(names: &str) -> Vec<&str> {
    let mut split = Vec::new();
    for (i, part) in names.split('"').enumerate() {
        if i % 2 == 1 { split.push(part) } else { split.extend(part.split_whitespace()) }
    }
    split
}

/// A note of materials that were defined before, if there are any.
fn defined_again(file: &str, names: &[String]) -> Option<String> {
    let first = names.first()?;
    Some(match names.len() {
        1 => format!("{file}: a definition of `{first}` was passed over, which was defined before"),
        count => format!(
            "{file}: {count} definitions were passed over of materials that were defined before, `{first}` first"
        ),
    })
}

/// The materials that the faces use, numbered as they come: the default one first.
#[derive(Default)]
struct Materials {
    used: Vec<String>,
    numbers: HashMap<String, u32>,
    current: u32,
    /// What the material files define; of a material that is defined twice, the first.
    known: HashMap<String, Material>,
    /// The names of the material files so far.
    files: HashSet<String>,
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

    fn file(&mut self, path: Option<PathBuf>, name: &str, notes: &mut Vec<String>) {
        let instead = "the default material takes its place";
        match path.as_deref().map(mtl::read) {
            Some(Ok(library)) => {
                let mut again = Vec::new();
                for (name, material) in library.materials {
                    match self.known.entry(name) {
                        Entry::Vacant(place) => drop(place.insert(material)),
                        Entry::Occupied(place) => again.push(place.key().clone()),
                    }
                }
                notes.extend(library.notes);
                notes.extend(defined_again(name, &again));
            }
            Some(Err(error)) => notes.push(format!("material file `{name}`: {}, {instead}", error.message)),
            None => notes.push(format!("material file `{name}` was not found, {instead}")),
        }
        self.file_missing |= path.is_none();
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
