//! The judge of images: Whitted's model in double precision, recursive, testing every triangle, written from the model's
//! description and sharing no code with the host or the geometry but the scene's data.

use glam::DVec3;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::scene::mesh::NO_NORMAL;
use pcs_sim::scene::{LightFrom, Material, Scene};

const AMBIENT: f64 = 0.15;
const DEPTH: u32 = 5;
const LEAST: f64 = 1.0 / 256.0;

struct Triangle {
    corners: [DVec3; 3],
    normals: Option<[DVec3; 3]>,
    /// The whole face's, from Newell's sum.
    flat: DVec3,
    material: Material,
    /// The corners' own colours, or the material's.
    colors: [DVec3; 3],
}

struct Found<'a> {
    t: f64,
    triangle: &'a Triangle,
    normal: DVec3,
    color: DVec3,
}

pub struct Judge<'a> {
    scene: &'a Scene,
    triangles: Vec<Triangle>,
    tiny: f64,
}

impl<'a> Judge<'a> {
    pub fn new(scene: &'a Scene) -> Judge<'a> {
        let mut triangles = Vec::new();
        for face in scene.mesh.faces() {
            let corners = scene.mesh.corners(face);
            let points: Vec<DVec3> = scene.mesh.face_points(face).map(|p| p.as_dvec3()).collect();
            let next = |i: usize| points[(i + 1) % points.len()];
            let flat: DVec3 = (0..points.len()).map(|i| (points[i] - points[0]).cross(next(i) - points[0])).sum();
            for k in 1..points.len() - 1 {
                let chosen = [corners[0], corners[k], corners[k + 1]];
                let smooth = chosen.iter().all(|corner| corner.normal != NO_NORMAL);
                let material = scene.materials[face.material as usize];
                let normal = |i: usize| scene.mesh.normals[chosen[i].normal as usize].as_dvec3().normalize();
                triangles.push(Triangle {
                    corners: [points[0], points[k], points[k + 1]],
                    normals: smooth.then(|| [normal(0), normal(1), normal(2)]),
                    flat: flat.normalize_or_zero(),
                    material,
                    colors: chosen.map(|c| scene.mesh.point_color(c.point).unwrap_or(material.color).as_dvec3()),
                });
            }
        }
        let largest = triangles.iter().flat_map(|t| t.corners).map(|p| p.abs().max_element()).fold(0.0, f64::max);
        Judge { scene, triangles, tiny: 1e-7 * largest }
    }

    /// The image, `side` x `side` samples a pixel.
    pub fn image(&self, size: ImageSize, side: u32) -> Vec<DVec3> {
        let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
        pixels.map(|(x, y)| self.pixel(size, side, x, y)).collect()
    }

    fn pixel(&self, size: ImageSize, side: u32, x: u32, y: u32) -> DVec3 {
        let camera = &self.scene.camera;
        let forward = (camera.at.as_dvec3() - camera.from.as_dvec3()).normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let pixel = 2.0 * (camera.angle as f64 / 2.0).to_radians().tan() / size.height as f64;
        let mut sum = DVec3::ZERO;
        for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
            let right_by = x as f64 + (i as f64 + 0.5) / side as f64 - size.width as f64 / 2.0;
            let down_by = y as f64 + (j as f64 + 0.5) / side as f64 - size.height as f64 / 2.0;
            let direction = forward + right * (right_by * pixel) - up * (down_by * pixel);
            sum += self.light(camera.from.as_dvec3(), direction.normalize(), DVec3::ONE, 0);
        }
        sum / (side * side) as f64
    }

    /// What arrives along a ray, times `weight`.
    fn light(&self, origin: DVec3, direction: DVec3, weight: DVec3, depth: u32) -> DVec3 {
        let Some(found) = self.nearest(origin, direction, f64::INFINITY) else {
            return weight * self.scene.background.as_dvec3();
        };
        let material = &found.triangle.material;
        let color = found.color;
        let outside = found.triangle.flat.dot(direction) < 0.0;
        let flat = if outside { found.triangle.flat } else { -found.triangle.flat };
        let normal = if found.normal.dot(flat) < 0.0 { -found.normal } else { found.normal };
        let point = origin + direction * found.t;
        let mirror = |n: DVec3| direction - 2.0 * direction.dot(n) * n;
        let mut total = weight * color * material.diffuse as f64 * AMBIENT;
        for (towards, distance, strength) in self.lights(point) {
            if normal.dot(towards) > 0.0 && flat.dot(towards) > 0.0 {
                let diffuse = color * material.diffuse as f64 * (1.0 - AMBIENT) * normal.dot(towards);
                let shine = mirror(normal).dot(towards).max(0.0).powf(material.shine as f64);
                let arriving = weight * strength * (diffuse + material.specular as f64 * shine);
                total += self.filtered(point + flat * self.tiny, towards, distance, arriving);
            }
        }
        if depth == DEPTH {
            return total;
        }
        let mut reflected = weight * material.specular as f64;
        let through = weight * color * material.transmittance as f64;
        if through.max_element() >= LEAST {
            let (from, to) =
                if outside { (1.0, material.refraction as f64) } else { (material.refraction as f64, 1.0) };
            // Snell by the tangential part: it is stretched by from / to.
            let tangential = (direction - normal * direction.dot(normal)) * (from / to);
            if tangential.length() < 1.0 {
                let bent = tangential - normal * (1.0 - tangential.length_squared()).sqrt();
                let bent = if bent.dot(flat) < 0.0 { bent } else { direction };
                total += self.light(point - flat * self.tiny, bent, through, depth + 1);
            } else {
                reflected += through;
            }
        }
        if reflected.max_element() >= LEAST {
            let back = if mirror(normal).dot(flat) > 0.0 { mirror(normal) } else { mirror(flat) };
            total += self.light(point + flat * self.tiny, back, reflected, depth + 1);
        }
        total
    }

    /// For each light: its direction, distance and strength as seen from a point.
    fn lights(&self, point: DVec3) -> Vec<(DVec3, f64, DVec3)> {
        let eye = pcs_sim::scene::Light::point(self.scene.camera.from, glam::Vec3::ONE);
        let lights = if self.scene.lights.is_empty() { vec![eye] } else { self.scene.lights.clone() };
        let seen = |light: &pcs_sim::scene::Light| match light.from {
            LightFrom::Point(at) => {
                let away = at.as_dvec3() - point;
                (away.normalize(), away.length(), light.color.as_dvec3())
            }
            LightFrom::Direction(towards) => (towards.as_dvec3().normalize(), f64::INFINITY, light.color.as_dvec3()),
        };
        lights.iter().map(seen).collect()
    }

    /// What is left of light behind all that is in its way.
    fn filtered(&self, mut origin: DVec3, towards: DVec3, mut distance: f64, mut light: DVec3) -> DVec3 {
        while let Some(found) = self.nearest(origin, towards, distance) {
            let material = &found.triangle.material;
            light *= found.color * material.transmittance as f64;
            if light.max_element() < LEAST {
                return DVec3::ZERO;
            }
            origin += towards * (found.t + self.tiny);
            distance -= found.t + self.tiny;
        }
        light
    }

    fn nearest(&self, origin: DVec3, direction: DVec3, most: f64) -> Option<Found<'_>> {
        let mut nearest: Option<Found> = None;
        for triangle in &self.triangles {
            let limit = nearest.as_ref().map_or(most, |found| found.t);
            if let Some((t, u, v)) = triangle.hit(origin, direction).filter(|hit| hit.0 > 1e-12 && hit.0 < limit) {
                let blend = |[a, b, c]: [DVec3; 3]| a * (1.0 - u - v) + b * u + c * v;
                let normal = triangle.normals.map_or(triangle.flat, blend).normalize_or_zero();
                nearest = Some(Found { t, triangle, normal, color: blend(triangle.colors) });
            }
        }
        nearest
    }
}

impl Triangle {
    /// t and the two barycentric coordinates, by Cramer's rule.
    fn hit(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64, f64)> {
        let [a, b, c] = self.corners;
        let (e1, e2, from_a) = (b - a, c - a, origin - a);
        let across = direction.cross(e2);
        let determinant = e1.dot(across);
        if determinant == 0.0 {
            return None;
        }
        let u = from_a.dot(across) / determinant;
        let turned = from_a.cross(e1);
        let v = direction.dot(turned) / determinant;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| (e2.dot(turned) / determinant, u, v))
    }
}
