//! Reads the materials beside an OBJ file (MTL).

use std::path::Path;

use glam::Vec3;

use super::read_file;
use super::statements::{Statements, name_of};
use crate::error::InputError;
use crate::input::text::{Text, Token};
use crate::scene::Material;

/// Reads a file of materials, in file order.
///
/// Of each material the colour (`Kd`), the highlight (`Ks`, `Ns`), the transparency (`d`, `Tr`) and the index of
/// refraction (`Ni`) are taken; whatever else it says, textures above all, means nothing to the array.
pub(crate) fn read(path: &Path) -> Result<Vec<(String, Material)>, InputError> {
    let bytes = read_file(path)?;
    let text = Text::decode(path, &bytes)?;
    let mut materials: Vec<(String, Material)> = Vec::new();
    let mut statements = Statements::new(text);
    let mut tokens = Vec::new();
    while statements.next_into(&mut tokens) {
        let (keyword, arguments) = (tokens[0], &tokens[1..]);
        if keyword.text == "newmtl" {
            materials.push((name_of(text, arguments).to_owned(), Material::default()));
        } else if let Some((_, material)) = materials.last_mut() {
            property(text, keyword, arguments, material)?;
        }
    }
    Ok(materials)
}

fn property(text: Text, keyword: Token, arguments: &[Token], material: &mut Material) -> Result<(), InputError> {
    let number = || first_number(text, keyword, arguments);
    match keyword.text {
        "Kd" => material.color = color(text, keyword, arguments)?.unwrap_or(material.color),
        "Ks" => material.specular = color(text, keyword, arguments)?.map_or(0.0, Vec3::max_element).min(1.0),
        "Ns" => material.shine = number()?,
        "d" => material.transmittance = 1.0 - number()?.min(1.0),
        "Tr" => material.transmittance = number()?.min(1.0),
        // Some exporters write 0 for "does not matter".
        "Ni" => material.refraction = Some(number()?).filter(|&index| index > 0.0).unwrap_or(1.0),
        _ => {}
    }
    Ok(())
}

/// A colour of one or three components; none if it is given as a spectrum or in another colour space.
fn color(text: Text, keyword: Token, arguments: &[Token]) -> Result<Option<Vec3>, InputError> {
    match *arguments {
        [kind, ..] if kind.text == "spectral" || kind.text == "xyz" => Ok(None),
        [r, g, b, ..] => text.color([r, g, b]).map(Some),
        [grey] => text.color([grey; 3]).map(Some),
        _ => Err(text.error_at(keyword, format!("`{}` needs 3 numbers", keyword.text))),
    }
}

fn first_number(text: Text, keyword: Token, arguments: &[Token]) -> Result<f32, InputError> {
    match *arguments {
        [option, number, ..] if option.text == "-halo" => text.amount(number),
        [number, ..] => text.amount(number),
        [] => Err(text.error_at(keyword, format!("`{}` needs a number", keyword.text))),
    }
}
