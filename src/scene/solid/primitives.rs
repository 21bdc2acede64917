//! The shapes that solids are made of, in unit position (Argence's thesis, chapter 1, section 3.1.3).

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3, dvec2};

use super::shell::{Shell, ShellFace};

impl Shell {
    /// The cube from the origin to (1, 1, 1): 6 surfaces.
    pub fn cube() -> Shell {
        let square = [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
        column(&square, 6, |side| side)
    }

    /// The sphere of radius 1 around the origin, in `slices` slices (at least 3) from pole to pole and half as many stacks (at least 2).
    pub fn sphere(slices: u32) -> Shell {
        let stacks = (slices / 2).max(2);
        let ring = |stack: u32| {
            let latitude = PI * (f64::from(stack) / f64::from(stacks) - 0.5);
            circle(slices).map(move |way| way.extend(0.0) * latitude.cos() + DVec3::Z * latitude.sin())
        };
        let mut shell = Shell::default();
        let south = shell.add(-DVec3::Z);
        let mut below = vec![south; slices as usize];
        for stack in 1..=stacks {
            let above: Vec<u32> = if stack == stacks {
                vec![shell.add(DVec3::Z); slices as usize]
            } else {
                ring(stack).map(|point| shell.add(point)).collect()
            };
            shell.band(&below, &above, 0, |point| point.normalize());
            below = above;
        }
        shell
    }

    /// The cone over the disc of radius 1 in z = 0, its tip in (0, 0, 1): its side and its base.
    pub fn cone(slices: u32) -> Shell {
        let mut shell = Shell::default();
        let base: Vec<u32> = circle(slices).map(|point| shell.add(point.extend(0.0))).collect();
        let tip = shell.add(DVec3::Z);
        for slice in 0..base.len() {
            let corners = [base[slice], base[(slice + 1) % base.len()], tip];
            // The tip has a normal for every slice, that of the slice's middle.
            let middle = (shell.points[corners[0] as usize] + shell.points[corners[1] as usize]).normalize();
            let radial = [shell.points[corners[0] as usize], shell.points[corners[1] as usize], middle];
            let normals = radial.map(|way| (way + DVec3::Z).normalize()).to_vec();
            shell.faces.push(ShellFace { corners: corners.to_vec(), normals, surface: 0, material: 0 });
        }
        shell.cap(base.into_iter().rev().collect(), 1);
        shell
    }

    /// The cylinder over the disc of radius 1 in z = 0, up to z = 1: its side, its base and its top.
    pub fn cylinder(slices: u32) -> Shell {
        let disc: Vec<DVec2> = circle(slices).collect();
        let mut shell = column(&disc, 3, |_| 0);
        for face in shell.faces.iter_mut().filter(|face| face.surface == 0) {
            let radial = face.corners.iter().map(|&point| shell.points[point as usize].with_z(0.0).normalize());
            face.normals = radial.collect();
        }
        shell
    }

    /// The prism over a polygon in z = 0, up to z = 1, of as many surfaces as it has faces. The polygon's corners may run
    /// either way.
    ///
    /// The error says what is wrong with a polygon of fewer than 3 corners, without area, or whose edges cross or touch.
    pub fn prism(points: &[DVec2]) -> Result<Shell, String> {
        let count = points.len();
        if count < 3 {
            return Err(format!("prism's polygon has {count} corners, it needs at least 3"));
        }
        if let Some((one, other)) = crossing(points) {
            let edge = |at: usize| {
                format!(
                    "from ({}, {}) to ({}, {})",
                    points[at].x,
                    points[at].y,
                    points[(at + 1) % count].x,
                    points[(at + 1) % count].y
                )
            };
            return Err(format!(
                "prism's polygon crosses or touches itself: its edges {} and {}",
                edge(one),
                edge(other)
            ));
        }
        let area: f64 = (0..count).map(|at| points[at].perp_dot(points[(at + 1) % count])).sum();
        let mut points = points.to_vec();
        if area < 0.0 {
            points.reverse();
        }
        Ok(column(&points, count as u32 + 2, |side| side))
    }

    /// The torus around the z axis whose tube of radius `radius`, above 0 and below 1, goes around the circle of radius 1, in
    /// `slices` slices (at least 3); the tube has half as many sides (at least 3).
    pub fn torus(radius: f64, slices: u32) -> Shell {
        let sides = (slices / 2).max(3);
        let mut shell = Shell::default();
        let rings: Vec<Vec<u32>> = circle(sides)
            .map(|around| {
                let ring = circle(slices).map(|way| (way * (1.0 + radius * around.x)).extend(radius * around.y));
                ring.map(|point| shell.add(point)).collect()
            })
            .collect();
        let outward = |point: DVec3| (point - point.with_z(0.0).normalize()).normalize();
        for side in 0..rings.len() {
            shell.band(&rings[side], &rings[(side + 1) % rings.len()], 0, outward);
        }
        shell
    }

    fn add(&mut self, point: DVec3) -> u32 {
        self.points.push(point);
        (self.points.len() - 1) as u32
    }

    /// Joins two rings of points with a face for every slice; where a ring is all one point, with triangles.
    fn band(&mut self, low: &[u32], high: &[u32], surface: u32, normal: impl Fn(DVec3) -> DVec3) {
        for slice in 0..low.len() {
            let next = (slice + 1) % low.len();
            let mut corners = vec![low[slice], low[next], high[next], high[slice]];
            corners.dedup();
            if corners.first() == corners.last() {
                corners.pop();
            }
            let normals = corners.iter().map(|&point| normal(self.points[point as usize])).collect();
            self.faces.push(ShellFace { corners, normals, surface, material: 0 });
        }
    }

    fn cap(&mut self, corners: Vec<u32>, surface: u32) {
        self.faces.push(ShellFace { corners, normals: Vec::new(), surface, material: 0 });
    }
}

/// What stands on a polygon in z = 0, counter-clockwise seen from above, up to z = 1: its sides, then base and top, which
/// are the last two of `surfaces`; `surface` says to which one a side belongs.
fn column(polygon: &[DVec2], surfaces: u32, surface: impl Fn(u32) -> u32) -> Shell {
    let mut shell = Shell::default();
    let base: Vec<u32> = polygon.iter().map(|point| shell.add(point.extend(0.0))).collect();
    let top: Vec<u32> = polygon.iter().map(|point| shell.add(point.extend(1.0))).collect();
    for side in 0..base.len() {
        let next = (side + 1) % base.len();
        shell.cap(vec![base[side], base[next], top[next], top[side]], surface(side as u32));
    }
    shell.cap(base.into_iter().rev().collect(), surfaces - 2);
    shell.cap(top, surfaces - 1);
    shell
}

/// Points all around the unit circle, counter-clockwise from (1, 0).
fn circle(slices: u32) -> impl Iterator<Item = DVec2> {
    (0..slices).map(move |slice| {
        let (sin, cos) = (TAU * f64::from(slice) / f64::from(slices)).sin_cos();
        dvec2(cos, sin)
    })
}

/// Two edges of a polygon that have a point in common without being neighbours, or that lie on each other.
fn crossing(points: &[DVec2]) -> Option<(usize, usize)> {
    let count = points.len();
    let edge = |at: usize| (points[at], points[(at + 1) % count]);
    let pairs = (0..count).flat_map(|one| (one + 1..count).map(move |other| (one, other)));
    pairs.into_iter().find(|&(one, other)| {
        let ((a, b), (c, d)) = (edge(one), edge(other));
        if other == one + 1 {
            folds(a, b, d)
        } else if (other + 1) % count == one {
            folds(c, d, b)
        } else {
            touch((a, b), (c, d))
        }
    })
}

/// Whether the way from `a` over `b` to `c` goes nowhere, or back upon itself.
fn folds(a: DVec2, b: DVec2, c: DVec2) -> bool {
    a == b || b == c || ((b - a).perp_dot(c - b) == 0.0 && (b - a).dot(c - b) < 0.0)
}

/// Whether two stretches have a point in common.
fn touch((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> bool {
    let side = |from: DVec2, to: DVec2, point: DVec2| (to - from).perp_dot(point - from);
    let boxes_meet = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    boxes_meet && side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}
