//! A picture of the primary rays' hits: shaded by normal and light.

use std::io::Write;

use glam::Vec3;

use super::camera::ImageSize;
use crate::geometry::{Hit, Polygons, Ray};
use crate::scene::mesh::NO_NORMAL;
use crate::scene::{Light, Scene};

/// Share of a surface's colour that it shows where no light falls on it.
const AMBIENT: f32 = 0.15;

/// Writes a PNG with a pixel a ray. `rays` and `hits` are those of [`super::camera::primary_rays`] for `size`.
pub fn write_png(
    out: &mut impl Write,
    size: ImageSize,
    scene: &Scene,
    polygons: &Polygons,
    rays: &[Ray],
    hits: &[Hit],
) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(out, size.width, size.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let pixels = rays.iter().zip(hits).flat_map(|(ray, hit)| srgb(shade(scene, polygons, ray, hit)));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels.collect::<Vec<u8>>())?;
    writer.finish()
}

/// The colour of a hit under the scene's lights, without shadows; without lights, under one at the eye.
pub fn shade(scene: &Scene, polygons: &Polygons, ray: &Ray, hit: &Hit) -> Vec3 {
    if !hit.is_hit() {
        return scene.background;
    }
    let material = &scene.materials[scene.mesh.faces()[hit.polygon as usize].material as usize];
    let point = ray.at(hit.t);
    let normal = facing(shading_normal(scene, polygons, ray, hit), ray.direction);
    let head_light = [Light { at: ray.origin, color: Vec3::ONE }];
    let lights = if scene.lights.is_empty() { &head_light[..] } else { &scene.lights };
    // SPD's lights each have the strength of one; together they should not wash the picture out.
    let share = 1.0 / (lights.len() as f32).sqrt();
    let falls_in = |light: &Light| light.color * normal.dot((light.at - point).normalize_or_zero()).max(0.0) * share;
    let light: Vec3 = lights.iter().map(falls_in).sum();
    material.color * (AMBIENT + (1.0 - AMBIENT) * light)
}

/// The normal at a hit: between those of the fan triangle's corners, N_P = (1 - (α + β)) N_0 + α N_1 + β N_2 (A.3), or the
/// polygon's own where the corners have none.
fn shading_normal(scene: &Scene, polygons: &Polygons, ray: &Ray, hit: &Hit) -> Vec3 {
    let flat = polygons.normal(hit.polygon);
    // HIT does not say which triangle of the fan it was; the test finds it again.
    let Some(found) = polygons.intersect(ray, hit.polygon, f32::INFINITY) else { return flat };
    let corners = scene.mesh.corners(&scene.mesh.faces()[hit.polygon as usize]);
    let first = found.triangle as usize + 1;
    let normals = [corners[0], corners[first], corners[first + 1]].map(|corner| corner.normal);
    if normals.contains(&NO_NORMAL) {
        return flat;
    }
    let [n0, n1, n2] = normals.map(|normal| scene.mesh.normals[normal as usize].normalize_or_zero());
    let normal = n0 * (1.0 - (hit.alpha + hit.beta)) + n1 * hit.alpha + n2 * hit.beta;
    normal.try_normalize().unwrap_or(flat)
}

/// The normal of the side that the ray comes from.
fn facing(normal: Vec3, direction: Vec3) -> Vec3 {
    if normal.dot(direction) > 0.0 { -normal } else { normal }
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
