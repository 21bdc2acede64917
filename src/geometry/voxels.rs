//! Which voxels a polygon lies in: conservative voxelisation.

use glam::DVec3;

use super::bounds::Bounds;
use super::polygon::Polygons;

/// Polygons with more edges are voxelised by their box and plane alone.
const MOST_EDGES: usize = 256;

/// A volume cut into equal voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// The volume.
    pub volume: Bounds,
    /// Number of voxels along each axis, at least 1.
    pub size: [u32; 3],
}

/// A direction along which no part of a polygon lies beyond an interval: where a voxel's centre lies outside `low` to
/// `high`, grown by the voxel's own half width, the two cannot meet.
struct Separator {
    direction: DVec3,
    low: f64,
    high: f64,
}

impl Lattice {
    /// About `voxels` cubic-ish voxels over a volume, none of them thinner than `thinnest`.
    pub fn cubic(volume: Bounds, voxels: f64, thinnest: f64) -> Lattice {
        let extent = volume.extent().max(DVec3::ZERO);
        let mut edge = thinnest;
        // Along a side shorter than an edge there is one voxel, and the others share the rest.
        for flat_sides in 0..3 {
            let mut sides = extent.to_array();
            sides.sort_by(f64::total_cmp);
            let long = &sides[flat_sides..];
            edge = (long.iter().product::<f64>() / voxels.max(1.0)).powf(1.0 / long.len() as f64).max(thinnest);
            if long[0] >= edge {
                break;
            }
        }
        let along = |side: f64| if edge > 0.0 { (side / edge).round().clamp(1.0, 65_535.0) as u32 } else { 1 };
        Lattice { volume, size: extent.to_array().map(along) }
    }

    /// Number of voxels.
    pub fn voxel_count(&self) -> usize {
        self.size.iter().map(|&n| n as usize).product()
    }

    /// The number of a voxel: x runs fastest.
    #[inline]
    pub fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        x as usize + self.size[0] as usize * (y as usize + self.size[1] as usize * z as usize)
    }

    /// Edges of a voxel.
    pub fn voxel_extent(&self) -> DVec3 {
        self.volume.extent() / DVec3::from_array(self.size.map(f64::from))
    }

    /// Calls `visit` with the number of every voxel within `margin` of a polygon as A.3 has it, in rising order. May visit
    /// a few more at the polygon's corners, never fewer.
    pub fn for_each_voxel(&self, polygons: &Polygons, polygon: u32, margin: f64, mut visit: impl FnMut(usize)) {
        if polygons.normal(polygon) == glam::Vec3::ZERO {
            return;
        }
        let points: Vec<DVec3> = polygons.flattened(polygon).collect();
        let bounds = Bounds::around(points.iter().copied()).grown(margin);
        let Some([xs, ys, zs]) = self.voxel_range(bounds) else { return };
        let half = self.voxel_extent() / 2.0 + margin;
        let separators = separators(polygons, polygon, &points, half);
        for z in zs.0..=zs.1 {
            for y in ys.0..=ys.1 {
                for x in xs.0..=xs.1 {
                    let center = self.center([x, y, z]);
                    if separators.iter().all(|separator| separator.admits(center)) {
                        visit(self.index([x, y, z]));
                    }
                }
            }
        }
    }

    /// First and last voxel along each axis that a box touches, if it touches the volume.
    fn voxel_range(&self, Bounds { low, high }: Bounds) -> Option<[(u32, u32); 3]> {
        let mut range = [(0, 0); 3];
        let extent = self.voxel_extent();
        for axis in 0..3 {
            if high[axis] < self.volume.low[axis] || low[axis] > self.volume.high[axis] {
                return None;
            }
            let at = |coordinate: f64| {
                let steps = (coordinate - self.volume.low[axis]) / extent[axis];
                // A flat volume has voxels without width: all of it is in its only one.
                if steps.is_nan() { 0 } else { (steps.max(0.0) as u32).min(self.size[axis] - 1) }
            };
            range[axis] = (at(low[axis]), at(high[axis]));
        }
        Some(range)
    }

    fn center(&self, voxel: [u32; 3]) -> DVec3 {
        let position = DVec3::from_array(voxel.map(|n| n as f64 + 0.5));
        self.volume.low + position * self.voxel_extent()
    }
}

/// The directions that can separate a polygon from a box, beyond the box's own: the polygon's normal, and each edge
/// crossed with each axis. `half` is half the box's edges.
fn separators(polygons: &Polygons, polygon: u32, points: &[DVec3], half: DVec3) -> Vec<Separator> {
    let normal = polygons.normal(polygon).as_dvec3();
    let edges = (0..points.len()).map(|k| points[(k + 1) % points.len()] - points[k]);
    // Each edge is held against each corner: with very many, the box and the plane must do.
    let edges = edges.filter(|_| points.len() <= MOST_EDGES);
    let crossed = edges.flat_map(|edge| DVec3::AXES.map(|axis| edge.cross(axis)));
    std::iter::once(normal)
        .chain(crossed.filter(|direction| direction.length_squared() > 0.0))
        .map(|direction| {
            let reach = half.dot(direction.abs());
            let along = points.iter().map(|point| direction.dot(*point));
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
            Separator { direction, low: low - reach, high: high + reach }
        })
        .collect()
}

impl Separator {
    #[inline]
    fn admits(&self, center: DVec3) -> bool {
        let s = self.direction.dot(center);
        self.low <= s && s <= self.high
    }
}
