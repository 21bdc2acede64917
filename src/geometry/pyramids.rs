//! Pyramids from the eye: regions by where things are on the screen, so that a ray from the eye stays in the one in which it enters.
//!
//! A cell is a rectangle of the plane before the eye. Its planes through the eye cut a ray at times that follow from the ray alone; each
//! voxel that a ray visits is visited in all cells that it is in there, one after the other. So what a ray meets is what it meets on its
//! walk through the grid, and the same is hit, to the bit.

use glam::{DVec2, DVec3};

use super::bounds::Bounds;
use super::ray::Ray;
use super::screen::Eye;

/// Cells on the screen of an eye that has all of a volume before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pyramids {
    eye: Eye,
    /// The lower left corner of all cells, and the sides of one.
    low: DVec2,
    side: DVec2,
    /// How many there are along each side.
    cells: u32,
}

/// A ray's way through cells.
#[derive(Clone, Copy, Debug)]
pub struct PyramidWay<'a> {
    pyramids: &'a Pyramids,
    /// Where the ray starts, and where it goes, from the eye: to the right, upwards, forward.
    origin: DVec3,
    direction: DVec3,
    /// The cell that it is in.
    cell: [u32; 2],
    /// When it leaves that along each side of the screen.
    leaves: [f64; 2],
}

impl Pyramids {
    /// `cells` x `cells` of all that an eye can see of a volume. `None` if it does not have all of it before it.
    pub fn new(eye: Eye, volume: Bounds, cells: u32) -> Option<Pyramids> {
        let seen = eye.rectangle(volume);
        let extent = seen.high - seen.low;
        let is_before = seen.low.is_finite() && seen.high.is_finite() && extent.min_element() > 0.0;
        is_before.then(|| Pyramids { eye, low: seen.low, side: extent / f64::from(cells.max(1)), cells: cells.max(1) })
    }

    /// The cells in which some of a box may be: from the first to the last, along both sides.
    pub fn cells_of(&self, part: Bounds) -> [std::ops::RangeInclusive<u32>; 2] {
        let seen = self.eye.rectangle(part);
        let [low, high] = [seen.low, seen.high].map(|place| self.cell_at(place));
        [low[0]..=high[0], low[1]..=high[1]]
    }

    fn cell_at(&self, place: DVec2) -> [u32; 2] {
        let at = (place - self.low) / self.side;
        // What is no number is in the first.
        [at.x, at.y].map(|at| at.clamp(0.0, f64::from(self.cells - 1)) as u32)
    }

    /// From the eye: to the right, upwards, forward.
    fn turned(&self, way: DVec3) -> DVec3 {
        DVec3::new(way.dot(self.eye.right), way.dot(self.eye.up), way.dot(self.eye.forward))
    }

    /// A ray's way from some t on, at which it is before the eye.
    pub fn way(&self, ray: &Ray, t: f64) -> PyramidWay<'_> {
        let origin = self.turned((ray.origin - self.eye.at).as_dvec3());
        let direction = self.turned(ray.direction.as_dvec3());
        let at = origin + direction * t;
        let cell = self.cell_at(at.truncate() / at.z);
        let mut way = PyramidWay { pyramids: self, origin, direction, cell, leaves: [f64::INFINITY; 2] };
        way.leaves = [0, 1].map(|side| way.leaves_cell(side));
        way
    }
}

impl PyramidWay<'_> {
    /// The number of the cell that the ray is in: along the first side they run fastest.
    pub fn cell(&self) -> usize {
        self.cell[0] as usize + self.pyramids.cells as usize * self.cell[1] as usize
    }

    /// When it leaves that cell for the next, if it does.
    pub fn next(&self) -> f64 {
        self.leaves[0].min(self.leaves[1])
    }

    /// Goes on to the next cell, across the first side if it leaves by both.
    pub fn advance(&mut self) {
        let side = usize::from(self.leaves[1] < self.leaves[0]);
        self.cell[side] = if self.rises(side) { self.cell[side] + 1 } else { self.cell[side] - 1 };
        self.leaves[side] = self.leaves_cell(side).max(self.leaves[side]);
    }

    /// Whether the ray goes to higher cells: its place on the screen is a quotient, whose slope has one sign all the way.
    fn slope(&self, side: usize) -> f64 {
        self.direction[side] * self.origin.z - self.origin[side] * self.direction.z
    }

    fn rises(&self, side: usize) -> bool {
        self.slope(side) > 0.0
    }

    fn leaves_cell(&self, side: usize) -> f64 {
        let Pyramids { low, side: sides, cells, .. } = self.pyramids;
        let rises = self.rises(side);
        let is_last = if rises { self.cell[side] + 1 >= *cells } else { self.cell[side] == 0 };
        if is_last || self.slope(side) == 0.0 {
            return f64::INFINITY;
        }
        let border = low[side] + sides[side] * f64::from(self.cell[side] + u32::from(rises));
        // On the plane through the eye and the border the place is the border: a x + b = border (c x + d).
        let slope = self.direction[side] - border * self.direction.z;
        let t = (border * self.origin.z - self.origin[side]) / slope;
        // The line may meet that plane behind the eye; before it, it then never gets there.
        let is_before = self.origin.z + self.direction.z * t > 0.0;
        if is_before { t } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;

    fn pyramids(cells: u32) -> Pyramids {
        let eye = Eye { at: Vec3::ZERO, forward: DVec3::Y, right: DVec3::X, up: DVec3::Z };
        let volume = Bounds { low: DVec3::new(-2.0, 3.0, -1.0), high: DVec3::new(2.0, 6.0, 1.0) };
        Pyramids::new(eye, volume, cells).unwrap()
    }

    #[test]
    fn a_ray_from_the_eye_stays_in_its_cell() {
        let way = pyramids(16);
        for x in [-0.5f32, -0.2, 0.0, 0.3] {
            assert_eq!(way.way(&Ray::new(Vec3::ZERO, Vec3::new(x, 1.0, 0.1)), 3.0).next(), f64::INFINITY);
        }
    }

    /// Its place on the screen nears one before the border, and the plane of the border is met behind the eye alone.
    #[test]
    fn a_ray_that_nears_a_border_for_ever_does_not_cross_it() {
        let (from, to) = (Vec3::new(0.83, 4.5, 0.0), Vec3::new(0.97, 5.49, 0.0));
        let pyramids = pyramids(2);
        let way = pyramids.way(&Ray::new(from, to - from), 0.0);
        assert_eq!((way.cell() % 2, way.next()), (1, f64::INFINITY));
    }

    #[test]
    fn an_eye_inside_has_no_pyramids() {
        let eye = Eye { at: Vec3::ZERO, forward: DVec3::Y, right: DVec3::X, up: DVec3::Z };
        let around = Bounds { low: DVec3::splat(-1.0), high: DVec3::splat(1.0) };
        assert_eq!(Pyramids::new(eye, around, 8), None);
    }

    proptest! {
        /// The cell that a way tells is the one in which its point is on the screen, between any two crossings.
        #[test]
        fn a_way_is_where_its_points_are(
            from in prop::array::uniform3(-1.0f32..1.0), to in prop::array::uniform3(-1.0f32..1.0), cells in 1u32..40,
        ) {
            let pyramids = pyramids(cells);
            let point = |[x, y, z]: [f32; 3]| Vec3::new(2.0 * x, 4.5 + 1.4 * y, z);
            let ray = Ray::new(point(from), point(to) - point(from));
            let mut way = pyramids.way(&ray, 0.0);
            let mut t = 0.0;
            while t < 1.0 {
                let next = way.next().min(1.0);
                if next - t > 1e-6 {
                    let at = pyramids.turned((ray.origin - pyramids.eye.at).as_dvec3() + ray.direction.as_dvec3() * ((t + next) / 2.0));
                    let [x, y] = pyramids.cell_at(at.truncate() / at.z);
                    prop_assert_eq!(way.cell(), (x + cells * y) as usize);
                }
                if way.next() >= 1.0 {
                    break;
                }
                t = next;
                way.advance();
            }
        }
    }
}
