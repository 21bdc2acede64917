//! Reads the materials beside an OBJ file (MTL).

use std::path::Path;

use glam::Vec3;

use super::read_file;
use super::statements::{Statements, name_of};
use crate::error::InputError;
use crate::input::text::{self, Text, Token, amount, parsed};
use crate::scene::Material;

/// What a file of materials has.
#[derive(Default)]
pub(crate) struct Library {
    /// The materials with their names, in file order.
    pub materials: Vec<(String, Material)>,
    /// What was passed over, one sentence each.
    pub notes: Vec<String>,
}

/// Reads a file of materials.
///
/// Of each material the colour (`Kd`), the highlight (`Ks`, `Ns`), the transparency (`d`, or else `Tr`) and the index of
/// refraction (`Ni`) are taken; whatever else it says, textures above all, means nothing to the array. A statement whose
/// numbers cannot be is passed over.
pub(crate) fn read(path: &Path) -> Result<Library, InputError> {
    let source = text::decode(read_file(path)?);
    let text = Text { file: path, text: &source };
    let mut drafts: Vec<(String, Properties)> = Vec::new();
    let mut wrong: Vec<Token> = Vec::new();
    let mut statements = Statements::new(text);
    let mut tokens = Vec::new();
    while statements.next_into(&mut tokens) {
        let (keyword, arguments) = (tokens[0], &tokens[1..]);
        if keyword.text == "newmtl" {
            drafts.push((name_of(text, arguments).to_owned(), Properties::default()));
        } else if let Some((_, properties)) = drafts.last_mut()
            && properties.take(keyword.text, arguments).is_none()
        {
            wrong.push(keyword);
        }
    }
    let materials = drafts.into_iter().map(|(name, properties)| (name, properties.material())).collect();
    Ok(Library { materials, notes: wrong.first().map(|&first| note(text, first, wrong.len())).into_iter().collect() })
}

fn note(text: Text, first: Token, count: usize) -> String {
    let name = text.file.file_name().unwrap_or_default().to_string_lossy();
    let (count, whose) = match count {
        1 => ("1 statement of a material was".to_owned(), "its"),
        _ => (format!("{count} statements of materials were"), "their"),
    };
    let (keyword, line) = (first.text, text.line(first.at));
    format!("{name}: {count} passed over, {whose} numbers are missing or out of range: `{keyword}` in line {line}")
}

/// What is known so far of a material.
#[derive(Default)]
struct Properties {
    plain: Material,
    dissolve: Option<f32>,
    transparency: Option<f32>,
}

impl Properties {
    /// Takes a statement; `None` if its numbers cannot be.
    fn take(&mut self, keyword: &str, arguments: &[Token]) -> Option<()> {
        let number = || first_number(arguments);
        match keyword {
            "Kd" => self.plain.color = color(arguments)?.unwrap_or(self.plain.color),
            "Ks" => self.plain.specular = color(arguments)?.map_or(0.0, Vec3::max_element).min(1.0),
            "Ns" => self.plain.shine = number()?,
            "d" => self.dissolve = Some(number().filter(|&share| share <= 1.0)?),
            "Tr" => self.transparency = Some(number().filter(|&share| share <= 1.0)?),
            // Some exporters write 0 for "does not matter".
            "Ni" => self.plain.refraction = Some(number()?).filter(|&index| index > 0.0).unwrap_or(1.0),
            _ => {}
        }
        Some(())
    }

    /// Programs do not agree on what `Tr` means, but for `d` they do.
    fn material(self) -> Material {
        let transmittance = self.dissolve.map(|share| 1.0 - share).or(self.transparency).unwrap_or(0.0);
        Material { transmittance, ..self.plain }
    }
}

/// A colour of one or three components; `Some(None)` if it is given as a spectrum or in another colour space.
fn color(arguments: &[Token]) -> Option<Option<Vec3>> {
    match *arguments {
        [kind, ..] if kind.text == "spectral" || kind.text == "xyz" => Some(None),
        [r, g, b, ..] => Some(Some(Vec3::new(checked(r)?, checked(g)?, checked(b)?))),
        [grey] => checked(grey).map(|grey| Some(Vec3::splat(grey))),
        _ => None,
    }
}

fn first_number(arguments: &[Token]) -> Option<f32> {
    match *arguments {
        [option, number, ..] if option.text == "-halo" => checked(number),
        [number, ..] => checked(number),
        [] => None,
    }
}

fn checked(token: Token) -> Option<f32> {
    amount(parsed(token.text)?).ok()
}
