//! What a hit has met: a point of a surface, worked out by the host in double precision.

use glam::{DVec3, Vec3};

use crate::geometry::bounds::largest_coordinate;
use crate::geometry::{Hit, Polygons, Ray, rounding};
use crate::scene::mesh::NO_NORMAL;
use crate::scene::{Corner, Material, Mesh, Scene};

/// The point of a surface that a ray has hit.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where.
    pub point: DVec3,
    /// The polygon's normal, of unit length, on the ray's side.
    pub flat: DVec3,
    /// The normal that is shaded with (see [`Surface::at`]), of unit length, on the ray's side.
    pub normal: DVec3,
    /// Whether the ray comes from outside: from where the polygon's corners are seen counter-clockwise.
    pub from_outside: bool,
    /// What it is made of there: where corners have colours of their own, its colour lies between theirs.
    pub material: Material,
    /// How far from the surface a new ray must start, so as not to hit the polygon that it leaves.
    clearance: f64,
}

impl Surface {
    /// What `hit`, which must be one, has met. The normal lies between those of the fan triangle's corners,
    /// N_P = (1 - (α + β)) N_0 + α N_1 + β N_2 (A.3); where the corners have none it is the polygon's own. So does the
    /// colour; where a corner has none it is the material's.
    pub fn at(scene: &Scene, polygons: &Polygons, ray: &Ray, hit: &Hit) -> Surface {
        let direction = ray.direction.as_dvec3();
        // A polygon without area, which only closed edges let be hit, faces the ray.
        let flat = polygons.normal(hit.polygon).as_dvec3().try_normalize();
        let flat = flat.unwrap_or_else(|| -direction.normalize_or_zero());
        let from_outside = flat.dot(direction) <= 0.0;
        let flat = if from_outside { flat } else { -flat };
        let face = &scene.mesh.faces()[hit.polygon as usize];
        let mut material = scene.materials[face.material as usize];
        let corners = corners_to_mix(&scene.mesh, polygons, ray, hit);
        let normal = corners.and_then(|corners| normal_between(&scene.mesh, corners, hit)).unwrap_or(flat);
        if let Some(corners) = corners {
            material.color = color_between(&scene.mesh, corners, hit, material.color);
        }
        Surface {
            point: on_plane(polygons, hit.polygon, ray.origin.as_dvec3() + direction * hit.t as f64),
            flat,
            normal: if normal.dot(flat) < 0.0 { -normal } else { normal },
            from_outside,
            material,
            clearance: clearance(polygons, hit.polygon),
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

/// The point of a polygon's plane next to a hit that 32 bits have computed: however far out the ray began, what remains
/// of its error lies within the plane.
fn on_plane(polygons: &Polygons, polygon: u32, point: DVec3) -> DVec3 {
    let normal = polygons.normal(polygon).as_dvec3();
    if normal == DVec3::ZERO {
        return point;
    }
    let off = normal.dot(point) - polygons.d(polygon) as f64;
    point - normal * (off / normal.length_squared())
}

/// How far from a polygon a new ray must start.
///
/// Let u be the unit of rounding, and M the polygon's largest coordinate; the hit's are no larger. Where the ray starts
/// is rounded to 32 bits, which moves it by up to 1.8 u M along the normal, and N.O comes out with an error of up to
/// 5.2 u M: beyond 7 u M, t of the polygon itself has the right sign. A neighbour in the same plane is known by an N and
/// a d of its own, whose rounding lifts it by up to 3 u M, and as much again for the two planes' distance: 13 u M. The
/// factor below is more than twice that.
fn clearance(polygons: &Polygons, polygon: u32) -> f64 {
    let largest = polygons.vertices(polygon).iter().map(|&vertex| largest_coordinate(vertex)).fold(0.0, f32::max);
    32.0 * rounding::UNIT * largest as f64
}

/// The corners of the fan triangle that was hit, if they have normals or colours for what lies between.
fn corners_to_mix(mesh: &Mesh, polygons: &Polygons, ray: &Ray, hit: &Hit) -> Option<[Corner; 3]> {
    let corners = mesh.corners(&mesh.faces()[hit.polygon as usize]);
    if corners[0].normal == NO_NORMAL && !mesh.has_colors() {
        return None;
    }
    // HIT does not say which triangle of the fan it was; the test finds it again.
    let found = polygons.intersect(ray, hit.polygon, f32::INFINITY)?;
    let first = found.triangle as usize + 1;
    Some([corners[0], corners[first], corners[first + 1]])
}

fn normal_between(mesh: &Mesh, corners: [Corner; 3], hit: &Hit) -> Option<DVec3> {
    let normals = corners.map(|corner| corner.normal);
    if normals.contains(&NO_NORMAL) {
        return None;
    }
    let normals = normals.map(|normal| mesh.normals[normal as usize].as_dvec3().normalize_or_zero());
    between(normals, hit).try_normalize()
}

fn color_between(mesh: &Mesh, corners: [Corner; 3], hit: &Hit, plain: Vec3) -> Vec3 {
    let colors = corners.map(|corner| mesh.point_color(corner.point));
    if colors == [None; 3] {
        return plain;
    }
    between(colors.map(|color| color.unwrap_or(plain).as_dvec3()), hit).as_vec3()
}

/// What lies at a hit between three corners' values.
fn between([v0, v1, v2]: [DVec3; 3], hit: &Hit) -> DVec3 {
    let (alpha, beta) = (hit.alpha as f64, hit.beta as f64);
    v0 * (1.0 - (alpha + beta)) + v1 * alpha + v2 * beta
}
