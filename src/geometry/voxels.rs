//! Which voxels a polygon lies in: conservative voxelisation.

use glam::DVec3;

use super::bounds::Bounds;
use super::polygon::Polygons;

/// Polygons with more edges are voxelised by their box and plane alone.
const MOST_EDGES: usize = 256;

/// Ranges of fewer voxels are looked at one by one.
const SHORT_RANGE: u32 = 6;

/// The first and the last voxel along an axis; none if the last lies before the first.
type Range = (u32, u32);

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
        if !polygons.can_be_hit(polygon) {
            return;
        }
        let points: Vec<DVec3> = polygons.flattened(polygon).collect();
        let bounds = Bounds::around(points.iter().copied()).grown(margin);
        let Some([xs, ys, zs]) = self.voxel_range(bounds) else { return };
        let half = self.voxel_extent() / 2.0 + margin;
        let separators = separators(polygons, polygon, &points, half);
        for z in zs.0..=zs.1 {
            let (first, last) = self.rows_reached(&separators, xs, ys, z);
            for y in first..=last {
                let (first, last) = self.row_reached(&separators, xs, y, z);
                for x in first..=last {
                    let center = self.center([x, y, z]);
                    if separators.iter().all(|separator| separator.admits(center)) {
                        visit(self.index([x, y, z]));
                    }
                }
            }
        }
    }

    /// Of the rows `ys` along x in layer z, those in which a polygon may lie: just those with such a voxel, as the crossings of
    /// its edges with the x axis separate it from all others. So the time follows the voxels that it reaches, not its box.
    fn rows_reached(&self, separators: &[Separator], xs: Range, ys: Range, z: u32) -> Range {
        separators.iter().fold(ys, |ys, separator| {
            let ends = if separator.direction.x >= 0.0 { xs } else { (xs.1, xs.0) };
            let along = |x: u32, y: u32| separator.along(self.center([x, y, z]));
            let (least, most) = (|y| along(ends.0, y), |y| along(ends.1, y));
            narrowed(ys, separator.direction.y >= 0.0, |y| most(y) < separator.low, |y| least(y) > separator.high)
        })
    }

    /// Of the voxels `xs` in one row, those that a polygon may reach.
    fn row_reached(&self, separators: &[Separator], xs: Range, y: u32, z: u32) -> Range {
        separators.iter().fold(xs, |xs, separator| {
            let along = |x: u32| separator.along(self.center([x, y, z]));
            narrowed(xs, separator.direction.x >= 0.0, |x| along(x) < separator.low, |x| along(x) > separator.high)
        })
    }

    /// First and last voxel along each axis that a box touches, if it touches the volume.
    fn voxel_range(&self, Bounds { low, high }: Bounds) -> Option<[Range; 3]> {
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
    /// Where a point lies along the direction. In each coordinate of the point, it rises or falls all the way, for rounding as
    /// well: products and sums keep their order when they are rounded.
    #[inline]
    fn along(&self, center: DVec3) -> f64 {
        self.direction.dot(center)
    }

    #[inline]
    fn admits(&self, center: DVec3) -> bool {
        let s = self.along(center);
        self.low <= s && s <= self.high
    }
}

/// The part of a range without its voxels before and beyond an interval: those that are before it lie all at one end and those
/// beyond it at the other, the former at the start if what is measured `rises`. Short ranges stay as they are: to look at all
/// of their voxels is as fast.
#[inline]
fn narrowed((first, last): Range, rises: bool, before: impl Fn(u32) -> bool, beyond: impl Fn(u32) -> bool) -> Range {
    if last < first.saturating_add(SHORT_RANGE) {
        return (first, last);
    }
    let (start, end) = match rises {
        true => (first_not(first, last, before), first_not(first, last, |at| !beyond(at))),
        false => (first_not(first, last, beyond), first_not(first, last, |at| !before(at))),
    };
    // An empty range is one whose last voxel lies before its first.
    if start < end { (start, end - 1) } else { (1, 0) }
}

/// The first number of a range for which something that holds up to there does not hold, or the one behind the range.
fn first_not(first: u32, last: u32, holds: impl Fn(u32) -> bool) -> u32 {
    if !holds(first) {
        return first;
    }
    if holds(last) {
        return last + 1;
    }
    let (mut yes, mut no) = (first, last);
    while yes + 1 < no {
        let middle = yes + (no - yes) / 2;
        if holds(middle) { yes = middle } else { no = middle }
    }
    no
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use glam::Vec3;
    use proptest::prelude::*;

    /// Triangles of every shape: slivers and needles are two points and one near the line through them.
    fn triangle() -> impl Strategy<Value = [Vec3; 3]> {
        let point = || [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from_array);
        (point(), point(), point(), prop_oneof![Just(1.0f32), Just(1e-3), Just(1e-6), Just(0.0)], -0.5f32..1.5)
            .prop_map(|(a, b, c, off, along)| [a, b, a + (b - a) * along + (c - a) * off])
    }

    fn polygons(points: &[Vec3]) -> Polygons {
        let mut mesh = Mesh::default();
        let corners: Vec<u32> = points.iter().map(|&point| mesh.add_point(point)).collect();
        mesh.add_face(&corners, 0);
        Polygons::new(&mesh)
    }

    /// All voxels of the polygon's box that no separator keeps apart from it: what the narrowing must not change.
    fn one_by_one(lattice: &Lattice, polygons: &Polygons, margin: f64) -> Vec<usize> {
        let points: Vec<DVec3> = polygons.flattened(0).collect();
        let bounds = Bounds::around(points.iter().copied()).grown(margin);
        let Some([xs, ys, zs]) = lattice.voxel_range(bounds) else { return Vec::new() };
        let separators = separators(polygons, 0, &points, lattice.voxel_extent() / 2.0 + margin);
        let all = (zs.0..=zs.1).flat_map(|z| (ys.0..=ys.1).flat_map(move |y| (xs.0..=xs.1).map(move |x| [x, y, z])));
        let meets = |&voxel: &[u32; 3]| separators.iter().all(|separator| separator.admits(lattice.center(voxel)));
        all.filter(meets).map(|voxel| lattice.index(voxel)).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

        #[test]
        fn a_polygon_is_in_the_same_voxels_as_when_all_are_looked_at(
            points in triangle(),
            size in prop_oneof![[1u32..40, 1u32..40, 1u32..40], [1u32..3, 1u32..300, 1u32..300]],
            margin in prop_oneof![Just(0.0), Just(1e-6), Just(0.05)],
            far in prop_oneof![Just(0.0f32), Just(1000.0)],
        ) {
            let polygons = polygons(&points.map(|point| point + far));
            prop_assume!(polygons.normal(0) != Vec3::ZERO);
            let low = DVec3::splat(f64::from(far) - 0.9);
            let lattice = Lattice { volume: Bounds { low, high: low + 1.8 }, size };
            let mut found = Vec::new();
            lattice.for_each_voxel(&polygons, 0, margin, |voxel| found.push(voxel));
            prop_assert_eq!(found, one_by_one(&lattice, &polygons, margin));
        }
    }

    /// The time follows the voxels that a polygon reaches: a needle across the volume reaches few of its box.
    #[test]
    fn a_needle_across_a_fine_grid_takes_no_time() {
        let polygons = polygons(&[Vec3::splat(-1.0), Vec3::splat(1.0), Vec3::new(1.0, 1.0, 0.9999)]);
        let volume = Bounds { low: DVec3::splat(-1.0), high: DVec3::ONE };
        let lattice = Lattice { volume, size: [20_000; 3] };
        let mut found = 0;
        // Looking at the 8e12 voxels of its box would take hours.
        lattice.for_each_voxel(&polygons, 0, 1e-6, |_| found += 1);
        assert!((20_000..200_000).contains(&found), "{found}");
    }
}
