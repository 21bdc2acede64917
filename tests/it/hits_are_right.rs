//! The hits against geometry done in another way, in double precision: Möller and Trumbore's triangle test.

use glam::DVec3;
use pcs_sim::geometry::{Polygons, Ray, brute_force};

/// Where a ray hits a triangle, and by how much it does so inside: the smallest barycentric coordinate.
fn triangle(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<(f64, f64)> {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let s = (origin - a) / determinant;
    let u = s.dot(p);
    let q = s.cross(ab);
    let v = direction.dot(q);
    let t = ac.dot(q);
    (t > 0.0).then_some((t, u.min(v).min(1.0 - u - v)))
}

/// The nearest hit, and whether the ray passes so close by an edge that 32 bits may see it otherwise.
fn nearest(polygons: &Polygons, ray: &Ray) -> (f64, bool) {
    let (mut nearest, mut doubtful) = (f64::INFINITY, false);
    for polygon in 0..polygons.len() as u32 {
        let points: Vec<DVec3> = polygons.vertices(polygon).iter().map(|v| v.as_dvec3()).collect();
        for k in 1..points.len() - 1 {
            let Some((t, inside)) = triangle(ray, [points[0], points[k], points[k + 1]]) else { continue };
            doubtful |= inside.abs() < 1e-4;
            if inside >= 0.0 {
                nearest = nearest.min(t);
            }
        }
    }
    (nearest, doubtful)
}

#[test]
fn on_built_in_scenes() {
    for (name, size) in [("tetra", 4), ("balls", 2), ("mountain", 3), ("gears", 1), ("teapot", 4), ("room", 1)] {
        let (scene, rays) = crate::support::scene(name, size, 40);
        let polygons = Polygons::new(&scene.mesh);
        let mut certain = 0;
        for ray in &rays {
            let (expected, doubtful) = nearest(&polygons, ray);
            if doubtful {
                continue;
            }
            certain += 1;
            let found = brute_force(&polygons, ray).t as f64;
            let agrees = found == expected || (found - expected).abs() <= 1e-5 * expected;
            assert!(agrees, "{name}: {ray:?} hits at {expected}, not at {found}");
        }
        assert!(certain * 10 > rays.len() * 7, "{name}: only {certain} of {} rays are certain", rays.len());
    }
}

/// α and β place the point in the fan's triangle: S0 + α (S1 - S0) + β (S2 - S0) is where the ray is at t.
#[test]
fn alpha_and_beta_find_the_point_again() {
    let (scene, rays) = crate::support::scene("gears", 1, 60);
    let polygons = Polygons::new(&scene.mesh);
    let mut beyond_the_first = 0;
    for ray in &rays {
        let hit = brute_force(&polygons, ray);
        if !hit.is_hit() {
            continue;
        }
        let found = polygons.intersect(ray, hit.polygon, f32::INFINITY).unwrap();
        assert_eq!((found.t, found.alpha, found.beta), (hit.t, hit.alpha, hit.beta));
        beyond_the_first += (found.triangle > 0) as u32;
        let v = polygons.vertices(hit.polygon);
        let (s0, s1, s2) = (v[0], v[found.triangle as usize + 1], v[found.triangle as usize + 2]);
        let point = s0 + (s1 - s0) * hit.alpha + (s2 - s0) * hit.beta;
        assert!(point.distance(ray.at(hit.t)) < 1e-4, "{point} is not {}", ray.at(hit.t));
    }
    assert!(beyond_the_first > 100);
}
