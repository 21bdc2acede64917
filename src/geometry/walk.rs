//! A ray on its way through a grid.

use super::grid::Grid;
use super::ray::Ray;

/// A ray on its way: where each axis's next plane is crossed, and how to go on from there.
pub(super) struct Walk {
    /// The voxel that it is in.
    pub voxel: usize,
    /// t_x, t_y, t_z: where the next plane of each axis is crossed.
    t_next: [f32; 3],
    origin: [f32; 3],
    inverse: [f32; 3],
    /// How many planes of each axis are crossed from t to t + 1, roughly.
    per_t: [f32; 3],
    /// The next plane's number along each axis.
    plane: [i32; 3],
    /// 1 or -1.
    step: [i32; 3],
    /// By how much the voxel's number changes with a step.
    stride: [isize; 3],
    /// Planes still to be crossed before the volume is left, counting the one that leaves it.
    left: [i32; 3],
}

/// What a ray did that went on without being watched.
pub(super) struct Leap {
    /// Voxels that it left.
    pub voxels: u64,
    /// Whether it is in another voxel now. Else it has left the volume, or come to the end that it was given.
    pub goes_on: bool,
}

impl Walk {
    /// A ray that enters a grid's volume, or starts in it, at `t_enter`.
    pub fn new(grid: &Grid, ray: &Ray, t_enter: f32) -> Walk {
        let at = grid.voxel_at(ray.at(t_enter));
        let size = grid.size();
        let strides = [1, size[0] as isize, size[0] as isize * size[1] as isize];
        let mut walk = Walk {
            voxel: grid.index(at),
            t_next: [f32::INFINITY; 3],
            origin: ray.origin.to_array(),
            inverse: [1.0; 3],
            per_t: (ray.direction.abs() * grid.per_edge()).to_array(),
            plane: [0; 3],
            step: [1; 3],
            stride: strides,
            left: [0; 3],
        };
        for axis in 0..3 {
            let inverse = 1.0 / ray.direction[axis];
            if inverse.is_finite() {
                walk.inverse[axis] = inverse;
            } else {
                // A ray that does not move along an axis, as far as 32 bits can tell, crosses none of its planes: they are
                // infinitely far away.
                walk.origin[axis] = f32::NEG_INFINITY;
            }
            let forward = walk.inverse[axis] > 0.0;
            walk.step[axis] = if forward { 1 } else { -1 };
            walk.stride[axis] = if forward { strides[axis] } else { -strides[axis] };
            walk.plane[axis] = at[axis] as i32 + forward as i32;
            walk.left[axis] = if forward { size[axis] - at[axis] } else { at[axis] + 1 } as i32;
            walk.t_next[axis] = walk.t_of_plane(grid, axis, 0);
        }
        walk
    }

    /// The axis whose plane is crossed next, and where.
    #[inline]
    pub fn next_crossing(&self) -> (usize, f32) {
        first_of(self.t_next)
    }

    /// Goes to the next voxel along an axis; false if that leaves the volume.
    #[inline]
    pub fn cross(&mut self, grid: &Grid, axis: usize) -> bool {
        self.left[axis] -= 1;
        if self.left[axis] == 0 {
            return false;
        }
        self.voxel = self.voxel.wrapping_add_signed(self.stride[axis]);
        self.plane[axis] += self.step[axis];
        self.t_next[axis] = self.t_of_plane(grid, axis, 0);
        true
    }

    /// Goes on until it has crossed `clearance` planes along some axis, has left the volume, or is in the voxel that it leaves
    /// at `t_end` or behind: to the same voxel, by the same number of voxels, as plane by plane.
    #[inline(always)]
    pub fn leap(&mut self, grid: &Grid, clearance: u8, t_end: f32) -> Leap {
        let most = self.left.map(|left| left.min(clearance as i32));
        let at_most = |axis: usize| self.t_of_plane(grid, axis, most[axis] - 1);
        let (axis, t) = first_of([at_most(0), at_most(1), at_most(2)]);
        if t >= t_end {
            let before = |axis: usize| self.planes_before(grid, axis, most[axis] - 1, t_end, false).0;
            return Leap { voxels: (before(0) + before(1) + before(2)) as u64 + 1, goes_on: false };
        }
        let leaves = most[axis] == self.left[axis];
        let mut voxels = 0;
        for other in 0..3 {
            // Of planes at the same t, those of the axes before this one are crossed before its own.
            let (crossed, t_next) = match other == axis {
                true if leaves => (most[axis], f32::INFINITY),
                true => (most[axis], self.t_of_plane(grid, axis, most[axis])),
                false => self.planes_before(grid, other, most[other] - 1, t, other < axis),
            };
            self.left[other] -= crossed;
            self.voxel = self.voxel.wrapping_add_signed(self.stride[other] * crossed as isize);
            self.plane[other] += self.step[other] * crossed;
            self.t_next[other] = t_next;
            voxels += crossed;
        }
        Leap { voxels: voxels as u64, goes_on: !leaves }
    }

    /// How many of an axis's next `most` planes are crossed before t, and at t if those count as well; and where the one behind
    /// them is crossed. Guessed from the ray's speed, and then put right by the planes' own t, in which rounding may be seen.
    #[inline(always)]
    fn planes_before(&self, grid: &Grid, axis: usize, most: i32, t: f32, at_t: bool) -> (i32, f32) {
        let is_before = |plane: f32| plane < t || at_t && plane == t;
        // `as` takes what is not a number to 0.
        let guess = (t - self.t_next[axis]) * self.per_t[axis] + 1.0;
        let mut count = (guess as i32).clamp(0, most);
        let mut next = self.t_of_plane(grid, axis, count);
        while count < most && is_before(next) {
            count += 1;
            next = self.t_of_plane(grid, axis, count);
        }
        while count > 0 {
            let last = self.t_of_plane(grid, axis, count - 1);
            if is_before(last) {
                break;
            }
            (count, next) = (count - 1, last);
        }
        (count, next)
    }

    /// Where an axis's plane so many planes behind the next one is crossed. The paper adds δt from step to step; taking each
    /// plane's t by itself costs no more and does not add up rounding.
    #[inline(always)]
    fn t_of_plane(&self, grid: &Grid, axis: usize, ahead: i32) -> f32 {
        let plane = self.plane[axis] + self.step[axis] * ahead;
        (grid.planes(axis)[plane as usize] - self.origin[axis]) * self.inverse[axis]
    }
}

/// The axis whose plane is crossed first, and where. On an edge or a corner the axes take turns, x first.
#[inline]
fn first_of([x, y, z]: [f32; 3]) -> (usize, f32) {
    if x <= y && x <= z {
        (0, x)
    } else if y <= z {
        (1, y)
    } else {
        (2, z)
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::ops::ControlFlow;

    use glam::Vec3;
    use proptest::prelude::*;

    use crate::cancel::Cancel;
    use crate::geometry::{Grid, Polygons, Ray};
    use crate::scene::Mesh;

    /// Small triangles here and there in a box, some of them where others are too.
    fn grid() -> impl Strategy<Value = Grid> {
        let point = || [-8i32..8, -8i32..8, -2i32..8].prop_map(|place| Vec3::from_array(place.map(|n| n as f32)));
        let triangles = prop::collection::vec((point(), point(), point()), 1..30);
        (triangles, prop_oneof![Just(50.0), Just(3000.0), Just(20_000.0)]).prop_filter_map(
            "empty",
            |(triangles, coefficient)| {
                let mut mesh = Mesh::default();
                for (a, b, c) in triangles {
                    let corners = [a, a + b * 0.4, a + c * 0.4].map(|point| mesh.add_point(point));
                    mesh.add_face(&corners, 0);
                }
                let polygons = Polygons::new(&mesh);
                let members: Vec<u32> = (0..polygons.len() as u32).collect();
                let volume = crate::geometry::partition::reached(&polygons, &members);
                Grid::new(&polygons, &members, volume, coefficient, &Cancel::default()).ok()
            },
        )
    }

    /// Rays of all directions, among them along axes and diagonals, on which planes of several axes are crossed at the same t.
    fn ray() -> impl Strategy<Value = Ray> {
        let number = || prop_oneof![-1.0f32..1.0, (-1i32..2).prop_map(|n| n as f32), Just(1e-30f32)];
        let origin = || prop_oneof![-9.0f32..9.0, (-9i32..9).prop_map(|n| n as f32)];
        let t_max = prop_oneof![Just(f32::INFINITY), 0.0f32..30.0];
        ([origin(), origin(), origin()], [number(), number(), number()], t_max).prop_map(|(o, d, t_max)| Ray {
            origin: o.into(),
            direction: d.into(),
            t_max,
        })
    }

    thread_local! {
        /// Voxels that were walked through, and those of them with polygons.
        static SEEN: Cell<[u64; 2]> = const { Cell::new([0; 2]) };
    }

    #[test]
    fn leaps_go_the_way_that_steps_go() {
        let asked = ProptestConfig::default();
        let config = ProptestConfig { cases: asked.cases.max(400), failure_persistence: None, ..asked };
        let mut runner = proptest::test_runner::TestRunner::new(config);
        let cases = (grid(), prop::collection::vec((ray(), 0u64..6, 0.0f32..30.0), 50));
        let result = runner.run(&cases, |(grid, plans)| {
            for (ray, met, end) in plans {
                // From the `met`-th voxel with polygons on, nothing behind `end` counts.
                let t_end = |so_far: usize| if so_far as u64 > met { end } else { f32::INFINITY };
                let (mut by_steps, mut voxels) = (Vec::new(), 0);
                grid.walk(&ray, 0.0, |visit| {
                    voxels += 1;
                    if !visit.polygons.is_empty() {
                        by_steps.push((std::mem::take(&mut voxels), visit.polygons));
                    }
                    let is_done = t_end(by_steps.len()) <= visit.t_exit;
                    if is_done { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                });
                let mut by_leaps = Vec::new();
                let behind = grid.walk_occupied(&ray, 0.0, |stretch| {
                    by_leaps.push((stretch.voxels, stretch.polygons));
                    t_end(by_leaps.len())
                });
                prop_assert_eq!((&by_leaps, behind), (&by_steps, voxels), "{:?}", ray);
                let [all, full] = SEEN.get();
                let walked = by_steps.iter().map(|stretch| stretch.0).sum::<u64>() + voxels;
                SEEN.set([all + walked, full + by_steps.len() as u64]);
            }
            Ok(())
        });
        result.unwrap_or_else(|error| panic!("{error}"));
        let [all, full] = SEEN.get();
        assert!(all > 50_000 && full > 1000 && full * 3 < all, "{full} of {all} voxels have polygons");
    }
}
