//! A.2: bounding volumes of slabs in seven directions (Kay & Kajiya).

use glam::{DVec3, Vec3};

use super::polygon::Polygons;
use super::ray::Ray;
use super::rounding;

/// Number of directions of slabs.
pub const DIRECTIONS: usize = 7;

/// Words of slabs a polygon (equation 6: 2 x directions).
pub const WORDS: u64 = 2 * DIRECTIONS as u64;

/// Directions rounded up to whole vector registers; the last repeats the first.
const LANES: usize = 8;

/// Numbers in a vector register that every processor has: two of them hold all lanes.
const REGISTER: usize = LANES / 2;

/// N_1 to N_7. The factor √3/3 of N_4 to N_7 cancels out of equation (7) and is left out.
const NORMALS: [[i8; 3]; LANES] =
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [-1, 1, 1], [-1, -1, 1], [1, -1, 1], [1, 0, 0]];

/// The slabs of all polygons of a scene.
#[derive(Clone, Debug)]
pub struct Slabs(Vec<PolygonSlabs>);

/// d_min and d_max of one polygon, in each direction (equation 5, with N_i.P = d_i).
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct PolygonSlabs {
    low: [f32; LANES],
    high: [f32; LANES],
}

/// S_i and T_i of one ray: S_i = N_i.O and T_i = 1 / N_i.D, the former as the range within which the ray's hits may lie
/// for rounding.
#[derive(Clone, Copy, Debug)]
pub struct RaySlabs {
    s_low: [f32; LANES],
    s_high: [f32; LANES],
    t: [f32; LANES],
    t_max: f32,
}

impl Slabs {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.0[..]) as u64
    }

    /// Encloses each polygon.
    pub fn new(polygons: &Polygons) -> Slabs {
        let enclosed = |polygon| enclose(polygons.flattened(polygon), 3.0 * polygons.slack(polygon));
        Slabs((0..polygons.len() as u32).map(enclosed).collect())
    }

    /// d_min and d_max of a polygon in one direction after the other, as a cell's memory holds them.
    pub fn words(&self, polygon: u32) -> impl Iterator<Item = f32> + '_ {
        let slabs = &self.0[polygon as usize];
        (0..DIRECTIONS).flat_map(|i| [slabs.low[i], slabs.high[i]])
    }

    /// Whether the ray meets the volume between all slabs of a polygon (equation 7).
    ///
    /// T_i is infinite for a ray parallel to the slab, which gives an interval of all t or of none.
    #[inline(always)]
    pub fn meets(&self, ray: &RaySlabs, polygon: u32) -> bool {
        let slabs = &self.0[polygon as usize];
        let (mut enters, mut leaves) = ([0.0f32; REGISTER], [ray.t_max; REGISTER]);
        for first in [0, REGISTER] {
            for i in 0..REGISTER {
                let lane = first + i;
                let at_low = (slabs.low[lane] - ray.s_high[lane]) * ray.t[lane];
                let at_high = (slabs.high[lane] - ray.s_low[lane]) * ray.t[lane];
                enters[i] = greater(lesser(at_low, at_high), enters[i]);
                leaves[i] = lesser(greater(at_low, at_high), leaves[i]);
            }
        }
        let enters = greater(greater(enters[0], enters[1]), greater(enters[2], enters[3]));
        let leaves = lesser(lesser(leaves[0], leaves[1]), lesser(leaves[2], leaves[3]));
        enters <= leaves
    }
}

/// The lesser of two numbers; the second if either is none. One instruction, which `f32::min` is not.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two numbers; the second if either is none.
#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl RaySlabs {
    /// The start of a ray, paid once. `scene` is the scene's largest coordinate, which bounds the rounding of its hits.
    pub fn new(ray: &Ray, scene: f64) -> RaySlabs {
        let error = rounding::reach_error(ray.origin.abs().max_element() as f64, scene) as f32;
        let mut slabs = RaySlabs { s_low: [0.0; LANES], s_high: [0.0; LANES], t: [0.0; LANES], t_max: ray.t_max };
        for (lane, normal) in NORMALS.into_iter().enumerate() {
            let s = along(normal, ray.origin);
            // A point moved by `error` in each coordinate moves by at most three times that along N_4 to N_7.
            slabs.s_low[lane] = s - 3.0 * error;
            slabs.s_high[lane] = s + 3.0 * error;
            slabs.t[lane] = 1.0 / along(normal, ray.direction);
        }
        slabs
    }

    /// Those of the same ray when it ends elsewhere.
    pub fn ending_at(self, t_max: f32) -> RaySlabs {
        RaySlabs { t_max, ..self }
    }
}

/// The slabs of a polygon, each `slack` wider on both sides.
fn enclose(vertices: impl Iterator<Item = DVec3> + Clone, slack: f64) -> PolygonSlabs {
    let mut slabs = PolygonSlabs { low: [0.0; LANES], high: [0.0; LANES] };
    for (lane, normal) in NORMALS.into_iter().enumerate() {
        let normal = DVec3::from_array(normal.map(f64::from));
        let d = vertices.clone().map(|vertex| normal.dot(vertex));
        let (low, high) = d.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
        slabs.low[lane] = rounding::down(low - slack);
        slabs.high[lane] = rounding::up(high + slack);
    }
    slabs
}

/// N.V of a normal whose components are -1, 0 or 1.
fn along(normal: [i8; 3], vector: Vec3) -> f32 {
    let normal = normal.map(f32::from);
    normal[0] * vector.x + normal[1] * vector.y + normal[2] * vector.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancel::Cancel;
    use crate::geometry::{Grid, Ray};
    use crate::scene::Mesh;
    use proptest::prelude::*;
    use std::cell::Cell;
    use std::ops::ControlFlow;

    /// Three corners of a needle, the first of which may be any of them: one far from the others, that lie as close together as
    /// they may; as large as the scene or smaller, anywhere.
    fn needle() -> impl Strategy<Value = [Vec3; 3]> {
        let direction = || [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from_array);
        // Diagonals have the largest rectangles.
        let long = (direction(), 0..3usize).prop_map(|(off, axis)| {
            let mut diagonal = Vec3::ONE;
            diagonal[axis] = off[axis];
            diagonal + off * 1e-3
        });
        let far = prop_oneof![3 => Just(0.0f32), 1 => 0.0f32..1e4, 1 => 0.0f32..1e6];
        let thin = prop_oneof![Just(1e-1f32), Just(1e-3), 1e-6f32..1e-4, Just(1e-7)];
        (long, direction(), direction(), thin, far, prop_oneof![Just(1.0f32), Just(7e3), Just(1e-9)], 0..3usize)
            .prop_map(|(long, place, off, thin, far, scale, first)| {
                let apex = place + Vec3::splat(far);
                let across = off - long * off.dot(long) / long.length_squared();
                let points = [apex, apex + long, apex + long + across * thin];
                [0, 1, 2].map(|k| points[(first + k) % 3] * scale)
            })
    }

    /// Rays at points near a needle's edges, the shortest above all, and somewhat beyond.
    fn ray() -> impl Strategy<Value = (usize, Vec3, Vec3)> {
        let share = || [-0.1f32..1.1, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from_array);
        (0..3usize, share(), share())
    }

    fn aimed(points: [Vec3; 3], (edge, share, direction): (usize, Vec3, Vec3)) -> Ray {
        let length = |k: usize| (points[(k + 1) % 3] - points[k]).length();
        let short = (0..3).min_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
        let at = if edge == 0 { edge } else { short };
        let (from, to) = (points[at], points[(at + 1) % 3]);
        let target = from + (to - from) * share.x + (to - from).length() * Vec3::new(share.y, share.z, -share.y) * 0.5;
        Ray::new(target - direction * length(short), direction)
    }

    fn polygons(points: [Vec3; 3]) -> Polygons {
        let mut mesh = Mesh::default();
        let corners = points.map(|point| mesh.add_point(point));
        mesh.add_face(&corners, 0);
        Polygons::new(&mesh)
    }

    thread_local! {
        /// Hits, and those of them that slabs as large as the polygon, or a grid that lists it where it lies, would drop.
        static SEEN: Cell<[u32; 2]> = const { Cell::new([0; 2]) };
    }

    /// With `PROPTEST_CASES=10000` a million rays.
    #[test]
    fn no_filter_drops_a_hit_of_a_needle() {
        let asked = ProptestConfig::default();
        // Enough of them that hits which need slack are always among them.
        let config = ProptestConfig { cases: asked.cases.max(2000), failure_persistence: None, ..asked };
        let mut runner = proptest::test_runner::TestRunner::new(config);
        let cases = (needle(), prop::collection::vec(ray(), 100));
        let result = runner.run(&cases, |(points, plans)| {
            let polygons = polygons(points);
            let slabs = Slabs::new(&polygons);
            let plain = Slabs(vec![enclose(polygons.flattened(0), 0.0)]);
            let volume = crate::geometry::partition::reached(&polygons, &[0]);
            let grid = Grid::new(&polygons, &[0], volume, 5000.0, &Cancel::default())
                .map_err(|error| TestCaseError::fail(error.to_string()))?;
            for plan in plans {
                let ray = aimed(points, plan);
                let Some(hit) = polygons.intersect(&ray, 0, f32::INFINITY) else { continue };
                let ray_slabs = RaySlabs::new(&ray, polygons.largest_coordinate());
                prop_assert!(slabs.meets(&ray_slabs, 0), "the slabs drop {:?} of {:?}", hit, ray);
                let mut is_found = false;
                grid.walk(&ray, polygons.beyond_margin(ray.origin), |visit| {
                    // As a cell with grid and intersection does, the walk ends behind the hit.
                    is_found |= !visit.polygons.is_empty();
                    if is_found || visit.t_exit >= hit.t { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                });
                prop_assert!(is_found, "the grid drops {:?} of {:?}", hit, ray);
                let [hits, dropped] = SEEN.get();
                SEEN.set([hits + 1, dropped + u32::from(!plain.meets(&ray_slabs, 0))]);
            }
            Ok(())
        });
        result.unwrap_or_else(|error| panic!("{error}"));
        let [hits, dropped] = SEEN.get();
        assert!(hits > 1000 && dropped > 10, "the test has {hits} hits, {dropped} of which need slack");
    }
}
