//! An inside test by which no ray passes between two polygons that share an edge (after Woop, Benthin and Wald, 2013).
//!
//! A.3 projects each polygon along an axis of its own, and rounds α and β polygon by polygon: two neighbours may both hold that a
//! ray which is aimed at their edge passes beside them. Here all polygons are seen along the ray. A corner comes out as the same
//! two 32-bit numbers for every polygon that has it, and on which side of an edge the ray passes follows from these without
//! rounding: products of 32-bit numbers are exact in 64 bits, and their difference has the right sign. So the two polygons of an
//! edge never disagree on it; on the edge itself, the ray is inside both.
//!
//! t, α and β are those of the point of the triangle that the ray passes through: a mean of its corners, so that a polygon that is
//! seen nearly edge-on cannot put it elsewhere.

use glam::Vec3;

use super::hit::PolygonHit;
use super::ray::Ray;

/// A corner as it is seen along the ray: the ray is the axis of `z`.
#[derive(Clone, Copy)]
struct Seen {
    x: f32,
    y: f32,
    z: f32,
}

/// What is the same for all corners: the axis along which the ray goes farthest, the other two, and the slopes along them.
struct View {
    axes: [usize; 3],
    slopes: [f32; 2],
}

impl View {
    fn new(ray: &Ray) -> View {
        let z = ray.direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let slope = |axis: usize| ray.direction[axis] / ray.direction[z];
        View { axes, slopes: [slope(axes[0]), slope(axes[1])] }
    }

    fn of(&self, ray: &Ray, corner: Vec3) -> Seen {
        let from_origin = corner - ray.origin;
        let [x, y, z] = self.axes.map(|axis| from_origin[axis]);
        Seen { x: x - self.slopes[0] * z, y: y - self.slopes[1] * z, z }
    }
}

/// On which side of the edge the ray passes: twice the area between both, its sign exact.
fn side(from: Seen, to: Seen) -> f64 {
    f64::from(from.x) * f64::from(to.y) - f64::from(from.y) * f64::from(to.x)
}

/// The intersection of a ray with the fan of a polygon, in the first of its triangles that the ray passes through in front of its
/// start.
pub fn intersect(ray: &Ray, corners: &[Vec3], nearest: f32) -> Option<PolygonHit> {
    let view = View::new(ray);
    let first = view.of(ray, corners[0]);
    corners.windows(2).skip(1).zip(0..).find_map(|(edge, triangle)| {
        let [second, third] = [edge[0], edge[1]].map(|corner| view.of(ray, corner));
        // The weights of the three corners, each by the edge that it is opposite to.
        let weights = [side(second, third), side(third, first), side(first, second)];
        let total: f64 = weights.iter().sum();
        let inside = weights.iter().all(|&weight| weight >= 0.0) || weights.iter().all(|&weight| weight <= 0.0);
        if !inside || total == 0.0 {
            return None;
        }
        let share = weights.map(|weight| weight / total);
        let along: f64 =
            share.iter().zip([first, second, third]).map(|(share, corner)| share * f64::from(corner.z)).sum();
        let t = (along / f64::from(ray.direction[view.axes[2]])) as f32;
        let counts = t > 0.0 && t <= ray.t_max && t <= nearest;
        counts.then_some(PolygonHit { t, alpha: share[1] as f32, beta: share[2] as f32, triangle })
    })
}
