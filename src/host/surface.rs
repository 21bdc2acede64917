//! What a hit has met: a point of a surface, worked out by the host in double precision.

use glam::DVec3;

use crate::geometry::{Hit, Polygons, Ray, rounding};
use crate::scene::mesh::NO_NORMAL;
use crate::scene::{Material, Scene};

/// The point of a surface that a ray has hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Where.
    pub point: DVec3,
    /// The polygon's normal, of unit length, on the ray's side.
    pub flat: DVec3,
    /// The normal that is shaded with (see [`Surface::at`]), of unit length, on the ray's side.
    pub normal: DVec3,
    /// Whether the ray comes from outside: from where the polygon's corners are seen counter-clockwise.
    pub from_outside: bool,
    /// What it is made of.
    pub material: &'a Material,
    /// How far from the surface a new ray must start, so as not to hit the polygon that it leaves.
    clearance: f64,
}

impl<'a> Surface<'a> {
    /// What `hit`, which must be one, has met. The normal lies between those of the fan triangle's corners,
    /// N_P = (1 - (α + β)) N_0 + α N_1 + β N_2 (A.3); where the corners have none it is the polygon's own.
    pub fn at(scene: &'a Scene, polygons: &Polygons, ray: &Ray, hit: &Hit) -> Surface<'a> {
        let direction = ray.direction.as_dvec3();
        let flat = polygons.normal(hit.polygon).as_dvec3().normalize_or_zero();
        let from_outside = flat.dot(direction) <= 0.0;
        let flat = if from_outside { flat } else { -flat };
        let normal = corner_normal(scene, polygons, ray, hit).unwrap_or(flat);
        let origin = ray.origin.abs().max_element() as f64;
        Surface {
            point: ray.origin.as_dvec3() + direction * hit.t as f64,
            flat,
            normal: if normal.dot(flat) < 0.0 { -normal } else { normal },
            from_outside,
            material: &scene.materials[scene.mesh.faces()[hit.polygon as usize].material as usize],
            clearance: 2.0 * rounding::reach_error(origin, polygons.largest_coordinate()),
        }
    }

    /// Where a ray starts that leaves on the side of the ray that came.
    pub fn before(&self) -> DVec3 {
        self.point + self.flat * self.clearance
    }

    /// Where a ray starts that goes on behind the surface.
    pub fn behind(&self) -> DVec3 {
        self.point - self.flat * self.clearance
    }
}

fn corner_normal(scene: &Scene, polygons: &Polygons, ray: &Ray, hit: &Hit) -> Option<DVec3> {
    let corners = scene.mesh.corners(&scene.mesh.faces()[hit.polygon as usize]);
    if corners[0].normal == NO_NORMAL {
        return None;
    }
    // HIT does not say which triangle of the fan it was; the test finds it again.
    let found = polygons.intersect(ray, hit.polygon, f32::INFINITY)?;
    let first = found.triangle as usize + 1;
    let normals = [corners[0], corners[first], corners[first + 1]].map(|corner| corner.normal);
    if normals.contains(&NO_NORMAL) {
        return None;
    }
    let [n0, n1, n2] = normals.map(|normal| scene.mesh.normals[normal as usize].as_dvec3().normalize_or_zero());
    let (alpha, beta) = (hit.alpha as f64, hit.beta as f64);
    (n0 * (1.0 - (alpha + beta)) + n1 * alpha + n2 * beta).try_normalize()
}
