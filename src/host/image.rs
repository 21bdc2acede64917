//! Pictures as files, and the quick look at primary rays' hits alone.

use std::io::Write;

use glam::{DVec3, Vec3};

use super::camera::ImageSize;
use super::color_table::{Color, ColorTable};
use super::shading::AMBIENT;
use super::surface::Surface;
use crate::geometry::{Hit, Polygons, Ray};
use crate::scene::{Light, LightFrom, Scene};

/// Writes pixels of linear light, line by line from the top left, as PNG.
pub fn write_png(out: &mut impl Write, size: ImageSize, pixels: &[Vec3]) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(out, size.width, size.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&on_screen(pixels).concat())?;
    writer.finish()
}

/// Writes a picture of few colours as PNG, which has them once in a table.
pub fn write_indexed_png(out: &mut impl Write, size: ImageSize, table: &ColorTable) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(out, size.width, size.height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(table.colors.concat());
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&table.pixels)?;
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
