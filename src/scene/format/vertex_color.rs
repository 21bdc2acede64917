//! Colours of vertices as OBJ and PLY files have them.

use glam::Vec3;

/// How far a part of a colour may lie beyond its range: what rounding does, and no more.
const ROUNDING: f32 = 0.01;

/// Decodes the colours of a whole file, given as they stand there: parts from 0 to 1, or from 0 to 255, as the largest
/// of them tells. Colours that are out of range are left out. Notes say what was guessed and what was passed over.
pub(crate) fn decode(colors: &mut Vec<Option<Vec3>>, notes: &mut Vec<String>) {
    let parts = colors.iter().flatten().flat_map(|color| color.to_array()).filter(|part| part.is_finite());
    let most = parts.fold(0.0, f32::max);
    // Between the two lie colours from 0 to 1 of which some are too bright.
    let counts_to_255 = most > 2.0 && most <= 255.0 + ROUNDING;
    if counts_to_255 {
        notes.push(format!("colours go up to {most}: they are taken to count from 0 to 255"));
    }
    let scale = if counts_to_255 { 255.0 } else { 1.0 };
    let given = colors.iter().flatten().count();
    for color in colors.iter_mut() {
        *color = color.and_then(|color| in_range(color / scale)).map(|color| color.map(light));
    }
    let left = colors.iter().flatten().count();
    match given - left {
        0 => {}
        1 => notes.push("1 colour of a point is out of range and was passed over".to_owned()),
        n => notes.push(format!("{n} colours of points are out of range and were passed over")),
    }
    if left == 0 {
        colors.clear();
    }
}

fn in_range(color: Vec3) -> Option<Vec3> {
    let allowed = -ROUNDING..=1.0 + ROUNDING;
    color.to_array().iter().all(|part| allowed.contains(part)).then(|| color.clamp(Vec3::ZERO, Vec3::ONE))
}

/// The share of light that one part of a vertex' colour stands for.
///
/// The programs that write such colours take them from pictures, and code them like those (sRGB): what is given as 0.5
/// is a middle grey to look at, which is a fifth of the light. Materials' colours are shares of light as they stand.
pub(crate) fn light(part: f32) -> f32 {
    let part = f64::from(part);
    let light = if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) };
    light as f32
}
