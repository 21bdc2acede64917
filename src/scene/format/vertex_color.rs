//! Colours of vertices as OBJ and PLY files have them.

/// The share of light that one part of a vertex' colour stands for.
///
/// The programs that write such colours take them from pictures, and code them like those (sRGB): what is given as 0.5
/// is a middle grey to look at, which is a fifth of the light. Materials' colours are shares of light as they stand.
pub(crate) fn decoded(part: f64) -> Result<f32, String> {
    if !(0.0..=1.0).contains(&part) {
        return Err(format!("{part} is no part of a vertex' colour, which is from 0 to 1"));
    }
    let light = if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) };
    Ok(light as f32)
}
