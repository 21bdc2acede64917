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
    /// Encloses each polygon.
    pub fn new(polygons: &Polygons) -> Slabs {
        Slabs((0..polygons.len() as u32).map(|polygon| enclose(polygons.flattened(polygon))).collect())
    }

    /// d_min and d_max of a polygon in one direction after the other, as a cell's memory holds them.
    pub fn words(&self, polygon: u32) -> impl Iterator<Item = f32> + '_ {
        let slabs = &self.0[polygon as usize];
        (0..DIRECTIONS).flat_map(|i| [slabs.low[i], slabs.high[i]])
    }

    /// Whether the ray meets the volume between all slabs of a polygon (equation 7).
    ///
    /// T_i is infinite for a ray parallel to the slab, which gives an interval of all t or of none.
    #[inline]
    pub fn meets(&self, ray: &RaySlabs, polygon: u32) -> bool {
        let slabs = &self.0[polygon as usize];
        let (mut near, mut far) = ([0.0f32; LANES], [0.0f32; LANES]);
        for i in 0..LANES {
            let at_low = (slabs.low[i] - ray.s_high[i]) * ray.t[i];
            let at_high = (slabs.high[i] - ray.s_low[i]) * ray.t[i];
            near[i] = if at_low < at_high { at_low } else { at_high };
            far[i] = if at_low > at_high { at_low } else { at_high };
        }
        let enters = near.into_iter().fold(0.0, |t, near| if near > t { near } else { t });
        let leaves = far.into_iter().fold(ray.t_max, |t, far| if far < t { far } else { t });
        enters <= leaves
    }
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
}

fn enclose(vertices: impl Iterator<Item = DVec3> + Clone) -> PolygonSlabs {
    let mut slabs = PolygonSlabs { low: [0.0; LANES], high: [0.0; LANES] };
    for (lane, normal) in NORMALS.into_iter().enumerate() {
        let normal = DVec3::from_array(normal.map(f64::from));
        let d = vertices.clone().map(|vertex| normal.dot(vertex));
        let (low, high) = d.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
        slabs.low[lane] = rounding::down(low);
        slabs.high[lane] = rounding::up(high);
    }
    slabs
}

/// N.V of a normal whose components are -1, 0 or 1.
fn along(normal: [i8; 3], vector: Vec3) -> f32 {
    let normal = normal.map(f32::from);
    normal[0] * vector.x + normal[1] * vector.y + normal[2] * vector.z
}
