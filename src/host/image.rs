//! Pictures as files, and the quick look at primary rays' hits alone.

use std::io::Write;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::camera::ImageSize;
use super::color_table::{Color, ColorTable};
use super::screen::PixelRectangle;
use super::shading::AMBIENT;
use super::surface::Surface;
use crate::error::InputError;
use crate::geometry::{Hit, Polygons, Ray};
use crate::input::fields;
use crate::scene::{Light, LightFrom, Scene};

/// Pixels of linear light, line by line from the top left.
pub type Pixels = Vec<Vec3>;

/// Writes pixels of linear light, line by line from the top left, as PNG.
pub fn write_png(out: &mut impl Write, size: ImageSize, pixels: &[Vec3]) -> Result<(), png::EncodingError> {
    write_plain_png(out, size, &on_screen(pixels).concat(), png::ColorType::Rgb)
}

/// Writes as PNG which pixels are some: these are white, all others black.
pub fn write_mask(out: &mut impl Write, size: ImageSize, pixels: &[u32]) -> Result<(), png::EncodingError> {
    let mut mask = vec![0; size.pixels()];
    pixels.iter().for_each(|&pixel| mask[pixel as usize] = u8::MAX);
    write_plain_png(out, size, &mask, png::ColorType::Grayscale)
}

fn write_plain_png(
    out: &mut impl Write,
    size: ImageSize,
    bytes: &[u8],
    color: png::ColorType,
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(out, size.width, size.height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()
}

/// The outlines of rectangles, drawn on a picture.
pub fn outlined(pixels: &[Vec3], size: ImageSize, rectangles: &[PixelRectangle]) -> Vec<Vec3> {
    let mut drawn = pixels.to_vec();
    for rectangle in rectangles {
        let [columns, lines] = rectangle.pixels(size);
        let (Some(last_column), Some(last_line)) = (columns.clone().last(), lines.clone().last()) else { continue };
        let across = columns.clone().flat_map(|column| [(column, lines.start), (column, last_line)]);
        let down = lines.clone().flat_map(|line| [(columns.start, line), (last_column, line)]);
        across.chain(down).for_each(|(column, line)| drawn[(line * size.width + column) as usize] = OUTLINE);
    }
    drawn
}

/// The colour of outlines: a red that pictures seldom have.
const OUTLINE: Vec3 = Vec3::new(1.0, 0.05, 0.02);

/// Writes a picture of few colours as PNG, which has them once in a table; if they are more than [`ColorTable::MOST_INDEXED`], one by one.
pub fn write_indexed_png(out: &mut impl Write, size: ImageSize, table: &ColorTable) -> Result<(), png::EncodingError> {
    let entries: Result<Vec<u8>, _> = table.pixels.iter().map(|&entry| u8::try_from(entry)).collect();
    let Ok(entries) = entries else {
        return write_plain_png(out, size, &table.picture().collect::<Vec<_>>().concat(), png::ColorType::Rgb);
    };
    let mut encoder = png::Encoder::new(out, size.width, size.height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(table.colors.concat());
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&entries)?;
    writer.finish()
}

/// Pixels of linear light as a screen has them.
pub fn on_screen(pixels: &[Vec3]) -> Vec<Color> {
    pixels.iter().map(|&pixel| srgb(pixel)).collect()
}

/// Writes pixels of linear light as PFM, which keeps all of their bits: lines from the bottom, little end first.
pub fn write_pfm(out: &mut impl Write, size: ImageSize, pixels: &[Vec3]) -> std::io::Result<()> {
    write!(out, "PF\n{} {}\n-1.0\n", size.width, size.height)?;
    for value in pixels.chunks(size.width as usize).rev().flatten().flat_map(Vec3::to_array) {
        out.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

/// Reads what [`write_pfm`] wrote, or another writer of PFM in colour: the pixels of linear light, line by line from the top left.
///
/// # Errors
///
/// If the file cannot be read, or is none such.
pub fn read_pfm(path: &Path) -> Result<(ImageSize, Pixels), InputError> {
    let bytes = fields::read_bytes(path)?;
    let bad = |what: &str| InputError::in_file(path, format!("is no PFM in colour: {what}"));
    let mut rest = bytes.as_slice();
    let mut word = || {
        let text = rest.trim_ascii_start();
        let end = text.iter().position(u8::is_ascii_whitespace).ok_or_else(|| bad("its heading has no end"))?;
        let word = std::str::from_utf8(&text[..end]).map_err(|_| bad("its heading is no text"));
        // One blank ends the heading.
        rest = &text[end + 1..];
        word
    };
    if word()? != "PF" {
        return Err(bad("it must begin with PF"));
    }
    let size: ImageSize = format!("{}x{}", word()?, word()?).parse().map_err(|why: String| bad(&why))?;
    let scale: f32 = word()?.parse().map_err(|_| bad("its scale is no number"))?;
    if rest.len() != 12 * size.pixels() {
        return Err(bad(&format!("{} bytes are not 12 for each of {} pixels", rest.len(), size.pixels())));
    }
    let value = |bytes: &[u8]| {
        let bytes = bytes.try_into().unwrap_or_default();
        if scale < 0.0 { f32::from_le_bytes(bytes) } else { f32::from_be_bytes(bytes) }
    };
    let pixel = |bytes: &[u8]| Vec3::new(value(&bytes[..4]), value(&bytes[4..8]), value(&bytes[8..]));
    let lines = rest.chunks(12 * size.width as usize).rev();
    Ok((size, lines.flat_map(|line| line.chunks_exact(12).map(pixel)).collect()))
}

/// The primary rays' hits under the scene's lights, without shadows or further rays; without lights, under one at the eye.
pub fn preview(scene: &Scene, polygons: &Polygons, rays: &[Ray], hits: &[Hit]) -> Vec<Vec3> {
    rays.iter().zip(hits).map(|(ray, hit)| shade(scene, polygons, ray, hit)).collect()
}

fn shade(scene: &Scene, polygons: &Polygons, ray: &Ray, hit: &Hit) -> Vec3 {
    if !hit.is_hit() {
        return scene.background;
    }
    let surface = Surface::at(scene, polygons, ray, hit);
    let head_light = [Light::point(ray.origin, Vec3::ONE)];
    let lights = if scene.lights.is_empty() { &head_light[..] } else { &scene.lights };
    let falls_in = |light: &Light| {
        let to_light = match light.from {
            LightFrom::Point(at) => at.as_dvec3() - surface.point,
            LightFrom::Direction(towards) => towards.as_dvec3(),
        };
        light.color.as_dvec3() * surface.normal.dot(to_light.normalize_or_zero()).max(0.0)
    };
    let light: DVec3 = lights.iter().map(falls_in).sum();
    (surface.material.color.as_dvec3() * (AMBIENT + (1.0 - AMBIENT) * light)).as_vec3()
}

/// Linear light as sRGB bytes.
fn srgb(color: Vec3) -> [u8; 3] {
    let encode = |linear: f32| {
        let linear = linear.clamp(0.0, 1.0);
        let value = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
        (value * 255.0).round() as u8
    };
    color.to_array().map(encode)
}
