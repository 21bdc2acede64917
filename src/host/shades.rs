//! Rule A4c: a point inside the cone of shadow within a polygon is always shaded by it.
//!
//! The cone's tip is the light, its axis leads to the middle of a triangle of the polygon's fan, its angle is the least to a plane through the
//! light and a side. Of a light that shines from one direction it is a cylinder. A ray that starts inside may still start before the polygon, or meet
//! the seam between two triangles, which A.3 can let it through: so A.3 is asked at last, in its own arithmetic. What it hits there is hit for certain,
//! be it that something else is hit before. That says all only where nothing lets light through.

use glam::{DVec3, Vec3};

use super::occluders::Told;
use crate::geometry::{Hit, Polygons, Ray};
use crate::scene::{Light, LightFrom, Scene};

/// The large polygons of a scene, as its lights see them.
#[derive(Clone, Debug)]
pub struct Shades {
    lights: Vec<Vec<Inscribed>>,
}

/// A cone of shadow within a triangle, or a cylinder.
#[derive(Clone, Copy, Debug)]
struct Inscribed {
    polygon: u32,
    /// The light, or the middle of the triangle where light comes from a direction.
    at: DVec3,
    /// From the light to the triangle, or to the light from it, of unit length.
    axis: DVec3,
    within: Within,
}

#[derive(Clone, Copy, Debug)]
enum Within {
    /// The cosine of the angle of a cone.
    Cosine(f64),
    /// The radius of a cylinder.
    Radius(f64),
}

/// Triangles are looked at that have at least this share of the largest side of the scene's box.
const LEAST_SHARE: f64 = 0.01;

/// And at the most so many of them, the largest.
const MOST: usize = 64;

impl Shades {
    /// Those of a scene; none, if any material lets light through.
    pub fn new(scene: &Scene, polygons: &Polygons, lights: &[Light]) -> Shades {
        let is_opaque = scene.materials.iter().all(|material| material.transmittance == 0.0);
        let triangles = if is_opaque { largest(scene, polygons) } else { Vec::new() };
        let of = |light: &Light| {
            triangles.iter().filter_map(|(polygon, corners)| Inscribed::new(light, *polygon, corners)).collect()
        };
        Shades { lights: lights.iter().map(of).collect() }
    }

    /// Tells a hit of a ray to a light, if it starts in the shadow of a large polygon.
    pub fn look(&self, polygons: &Polygons, ray: &Ray, light: u32) -> Told {
        let mut tests = 0;
        let origin = ray.origin.as_dvec3();
        let foretold = self.lights[light as usize].iter().find_map(|inscribed| {
            tests += 1;
            let hit = inscribed.holds(origin).then(|| polygons.intersect(ray, inscribed.polygon, f32::INFINITY))??;
            Some(Hit { t: hit.t, polygon: inscribed.polygon, alpha: hit.alpha, beta: hit.beta })
        });
        Told { foretold, tests }
    }
}

/// The largest triangles, with their polygons.
fn largest(scene: &Scene, polygons: &Polygons) -> Vec<(u32, [DVec3; 3])> {
    let extent = scene.mesh.bounds().map_or(Vec3::ZERO, |(low, high)| high - low).as_dvec3();
    let side = (extent.x * extent.y).max(extent.y * extent.z).max(extent.z * extent.x);
    let fan = |polygon: u32| {
        let corners = polygons.vertices(polygon);
        let others = corners.windows(2).skip(1);
        others.map(move |pair| (polygon, [corners[0], pair[0], pair[1]].map(|corner| corner.as_dvec3())))
    };
    let area = |[a, b, c]: &[DVec3; 3]| (*b - *a).cross(*c - *a).length() / 2.0;
    let mut all: Vec<_> = (0..polygons.len() as u32).flat_map(fan).collect();
    all.retain(|(_, corners)| area(corners) > 0.0 && area(corners) >= LEAST_SHARE * side);
    all.sort_by(|(_, a), (_, b)| area(b).total_cmp(&area(a)));
    all.truncate(MOST);
    all
}

impl Inscribed {
    /// `None` if the light shines along the triangle.
    fn new(light: &Light, polygon: u32, corners: &[DVec3; 3]) -> Option<Inscribed> {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let sides = [0, 1, 2].map(|corner| [corners[corner], corners[(corner + 1) % 3]]);
        match light.from {
            LightFrom::Point(at) => {
                let at = at.as_dvec3();
                let axis = (middle - at).try_normalize()?;
                let sines = sides.map(|[from, to]| {
                    let plane = (from - at).cross(to - at).try_normalize();
                    plane.map_or(0.0, |normal| normal.dot(axis).abs())
                });
                let sine = sines.into_iter().fold(1.0, f64::min);
                let within = Within::Cosine((1.0 - sine * sine).max(0.0).sqrt());
                (sine > 0.0).then_some(Inscribed { polygon, at, axis, within })
            }
            LightFrom::Direction(towards) => {
                let axis = towards.as_dvec3().try_normalize()?;
                let distances = sides.map(|[from, to]| {
                    let plane = (to - from).cross(axis).try_normalize();
                    plane.map_or(0.0, |normal| normal.dot(middle - from).abs())
                });
                let radius = distances.into_iter().fold(f64::INFINITY, f64::min);
                let within = Within::Radius(radius);
                (radius > 0.0).then_some(Inscribed { polygon, at: middle, axis, within })
            }
        }
    }

    fn holds(&self, point: DVec3) -> bool {
        let away = point - self.at;
        let along = away.dot(self.axis);
        match self.within {
            Within::Cosine(cosine) => along > cosine * away.length(),
            Within::Radius(radius) => (away - self.axis * along).length() < radius,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn right_triangle() -> [DVec3; 3] {
        [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.0)]
    }

    /// All of the cone goes through the triangle, and it reaches to one of its sides.
    #[test]
    fn a_cone_lies_within_its_triangle() {
        let light = DVec3::new(0.5, 0.5, 0.0);
        let cone = Inscribed::new(&Light::point(light.as_vec3(), Vec3::ONE), 0, &right_triangle()).unwrap();
        let inside = |at: DVec3| at.x > 0.0 && at.y > 0.0 && at.x + at.y < 1.0;
        let mut nearest: f64 = 1.0;
        for step in 0..10_000 {
            let at = DVec3::new(f64::from(step % 100) / 100.0 + 0.003, f64::from(step / 100) / 100.0 + 0.003, 1.0);
            let is_held = cone.holds(light + (at - light) * 2.0);
            assert!(!is_held || inside(at), "{at}");
            nearest =
                if is_held { nearest.min(at.x).min(at.y).min((1.0 - at.x - at.y) / 2f64.sqrt()) } else { nearest };
        }
        assert!(nearest < 0.02, "{nearest}");
    }

    #[test]
    fn a_cylinder_lies_within_its_triangle() {
        let cylinder = Inscribed::new(&Light::directional(Vec3::Z, Vec3::ONE), 0, &right_triangle()).unwrap();
        assert!(cylinder.holds(DVec3::new(0.3, 0.3, 0.0)) && !cylinder.holds(DVec3::new(0.6, 0.6, 0.0)));
        assert!(cylinder.holds(DVec3::new(0.11, 0.33, 0.0)), "up to its nearest side");
        assert!(!cylinder.holds(DVec3::new(-0.01, 0.33, 0.0)));
        assert!(
            Inscribed::new(&Light::directional(Vec3::X, Vec3::ONE), 0, &right_triangle()).is_none(),
            "seen edge on"
        );
    }
}
