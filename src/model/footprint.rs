//! What a grid has to know of a polygon's size: Cleary & Wyvill's augmented volumes, for polygons as they lie.

use glam::DVec3;

use crate::geometry::Bounds;

/// A polygon's part in a grid, or the sum of several.
///
/// The voxels that meet a convex polygon are those whose middle lies in the polygon grown by a voxel. The volume of that
/// body, in voxels, is 1 + Σ w_i / e_i + Σ s_i e_i / (e_x e_y e_z) for voxels with the edges e: exact on average over all
/// places of the grid, and linear in what is measured, so that footprints can be added up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// Number of polygons.
    pub count: f64,
    /// w, the polygon's extents along x, y and z.
    pub widths: DVec3,
    /// s, the areas of its shadows along x, y and z: A |n_i|.
    pub shadows: DVec3,
}

impl Footprint {
    /// nb_voxel/poly: voxels with edges `edge` that the polygons meet, each polygon by itself.
    pub fn voxels(&self, edge: DVec3) -> f64 {
        // In a volume without width, a voxel may be too small for its size to be a number above 0.
        let size = edge.element_product().max(f64::MIN_POSITIVE);
        self.count + (self.widths / edge).element_sum() + self.shadows.dot(edge) / size
    }

    /// The footprint of a convex polygon's part inside a volume that a grid fills.
    ///
    /// The grid's own faces lie where the volume's do, not anywhere: a polygon that ends at a face needs no part of a
    /// voxel beyond it. `tolerance` says how near an end counts as at the face.
    pub fn within(corners: impl Iterator<Item = DVec3>, volume: Bounds, tolerance: f64) -> Footprint {
        let corners = clip(corners.collect(), volume);
        if corners.len() < 3 {
            return Footprint::default();
        }
        let bounds = Bounds::around(corners.iter().copied());
        let widths = bounds.extent();
        // Along each axis, the part of a voxel by which the polygon's ends stick out on average.
        let mut free = DVec3::ONE;
        for axis in 0..3 {
            let at_face = [bounds.low[axis] - volume.low[axis], volume.high[axis] - bounds.high[axis]];
            if widths[axis] > tolerance {
                free[axis] -= 0.5 * at_face.iter().filter(|&&gap| gap <= tolerance).count() as f64;
            }
        }
        Footprint {
            count: free.element_product(),
            widths: widths * DVec3::new(free.y * free.z, free.x * free.z, free.x * free.y),
            shadows: area_vector(&corners).abs(),
        }
    }
}

impl std::ops::AddAssign for Footprint {
    fn add_assign(&mut self, other: Footprint) {
        self.count += other.count;
        self.widths += other.widths;
        self.shadows += other.shadows;
    }
}

impl std::ops::Mul<f64> for Footprint {
    type Output = Footprint;

    fn mul(self, factor: f64) -> Footprint {
        Footprint { count: self.count * factor, widths: self.widths * factor, shadows: self.shadows * factor }
    }
}

/// A polygon's area times its unit normal.
pub(super) fn area_vector(corners: &[DVec3]) -> DVec3 {
    let from = corners[0];
    corners.windows(2).map(|pair| (pair[0] - from).cross(pair[1] - from)).sum::<DVec3>() / 2.0
}

/// A polygon's part inside a box (Sutherland & Hodgman).
fn clip(mut corners: Vec<DVec3>, volume: Bounds) -> Vec<DVec3> {
    for axis in 0..3 {
        for (sign, limit) in [(1.0, volume.high[axis]), (-1.0, -volume.low[axis])] {
            let beyond = |p: DVec3| sign * p[axis] - limit;
            if corners.iter().all(|&p| beyond(p) <= 0.0) {
                continue;
            }
            let mut kept = Vec::with_capacity(corners.len() + 2);
            for (index, &a) in corners.iter().enumerate() {
                let b = corners[(index + 1) % corners.len()];
                let (out_a, out_b) = (beyond(a), beyond(b));
                if out_a <= 0.0 {
                    kept.push(a);
                }
                if (out_a > 0.0) != (out_b > 0.0) {
                    kept.push(a + (b - a) * (out_a / (out_a - out_b)));
                }
            }
            corners = kept;
        }
    }
    corners
}
