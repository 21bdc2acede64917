//! Concave and uneven faces cut into triangles: the array's intersection takes flat convex polygons only.

use std::f64::consts::TAU;

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

use super::mesh::{Face, Mesh};

/// How far a corner may lie off its face's plane, as a share of the face's size.
///
/// Neighbours share corners, not planes: where a corner lies off a face's plane, the face ends before or behind its
/// neighbour, and rays pass between the two. So no more is taken for flat than what the array's own arithmetic may be
/// off by.
const UNEVENNESS: f64 = 1e-6;

/// Largest number of corners for which ears are looked for: beyond, it could take minutes.
const MOST_CORNERS: usize = 1 << 17;

/// What becomes of larger ones.
const FAN: &str = "cut into triangles around the first corner, which may cover more";

/// What [`split_concave`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConcaveReport {
    /// Flat faces that were concave.
    pub concave: Cut,
    /// Faces that were not flat.
    pub uneven: Cut,
    /// Faces whose outline crosses itself: they were cut into a fan around their first corner, which may cover more than
    /// the face.
    pub crossing: Cut,
    /// Faces that are concave or not flat and have too many corners for a better cut than such a fan.
    pub large: Cut,
}

/// A number of faces and what they were cut into.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cut {
    /// Faces that were cut.
    pub faces: u32,
    /// Triangles that they became.
    pub triangles: u32,
}

impl ConcaveReport {
    /// The report as sentences for [`Scene::notes`](super::Scene::notes); none if no face was cut.
    pub fn notes(&self) -> Vec<String> {
        let concave = |cut: Cut| match cut.faces {
            1 => format!("1 concave face was cut into {} triangles", cut.triangles),
            n => format!("{n} concave faces were cut into {} triangles", cut.triangles),
        };
        let uneven = |cut: Cut| match cut.faces {
            1 => format!("1 face is not flat and was cut into {} triangles", cut.triangles),
            n => format!("{n} faces are not flat and were cut into {} triangles", cut.triangles),
        };
        let crossing = |cut: Cut| match cut.faces {
            1 => format!("1 face crosses itself and was cut into a fan of {} triangles", cut.triangles),
            n => format!("{n} faces cross themselves and were cut into fans of {} triangles", cut.triangles),
        };
        let large = |cut: Cut| match cut.faces {
            1 => format!("1 face that is concave or not flat has more than {MOST_CORNERS} corners: {FAN}"),
            n => format!("{n} faces that are concave or not flat have more than {MOST_CORNERS} corners: {FAN}"),
        };
        let sentences = [
            (self.large, large(self.large)),
            (self.concave, concave(self.concave)),
            (self.uneven, uneven(self.uneven)),
            (self.crossing, crossing(self.crossing)),
        ];
        sentences.into_iter().filter(|(cut, _)| cut.faces > 0).map(|(_, sentence)| sentence).collect()
    }
}

impl Cut {
    fn count(&mut self, triangles: usize) {
        self.faces += 1;
        self.triangles += triangles as u32;
    }
}

/// Cuts every face that is concave or not flat into triangles of the same face number, material and corners; the
/// others stay as they are.
///
/// A face counts as flat if its corners keep within a millionth of its size, and what the rounding of coordinates to 32
/// bits can do, of its plane. Corners on a straight line are no concavity, nor is what rounding can make of one.
pub fn split_concave(mesh: Mesh) -> (Mesh, ConcaveReport) {
    let shapes: Vec<Shape> = mesh.faces().iter().map(|face| shape(&mesh, face)).collect();
    let mut report = ConcaveReport::default();
    if shapes.iter().all(|&shape| shape == Shape::Convex) {
        return (mesh, report);
    }
    let mut cut = Mesh::default();
    for (face, shape) in mesh.faces().iter().zip(shapes) {
        let corners = mesh.corners(face);
        if shape == Shape::Convex {
            cut.add_piece(corners.iter().copied(), face.material, face.number);
            continue;
        }
        let outline = Outline::of(in_double(mesh.face_points(face)));
        let (triangles, whole) = outline.triangles();
        for triangle in &triangles {
            cut.add_piece(triangle.map(|i| corners[i]), face.material, face.number);
        }
        count(&mut report, shape, whole, triangles.len());
    }
    cut.points = mesh.points;
    cut.normals = mesh.normals;
    cut.colors = mesh.colors;
    cut.objects = mesh.objects;
    cut.passed_over = mesh.passed_over;
    (cut, report)
}

fn shape(mesh: &Mesh, face: &Face) -> Shape {
    if mesh.corners(face).len() <= 3 { Shape::Convex } else { Outline::of(in_double(mesh.face_points(face))).shape() }
}

/// Whether a polygon would stay as it is: it is flat and convex.
pub(super) fn stays_whole(points: impl Iterator<Item = Vec3>) -> bool {
    Outline::of(in_double(points)).shape() == Shape::Convex
}

/// A flat polygon cut into triangles of its corners' indices, turned as it is.
pub(super) fn triangles(points: &[DVec3]) -> Vec<[usize; 3]> {
    Outline::of(points.iter().copied()).triangles().0
}

fn in_double(points: impl Iterator<Item = Vec3>) -> impl Iterator<Item = DVec3> {
    points.map(|point| point.as_dvec3())
}

fn count(report: &mut ConcaveReport, shape: Shape, whole: bool, triangles: usize) {
    let cut = match (whole, shape) {
        (false, _) if triangles + 2 > MOST_CORNERS => &mut report.large,
        (false, _) => &mut report.crossing,
        (true, Shape::Uneven) => &mut report.uneven,
        (true, _) => &mut report.concave,
    };
    cut.count(triangles);
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Convex,
    Concave,
    Uneven,
}

/// A face in double precision, with its projection along the largest component of its normal.
struct Outline {
    points: Vec<DVec3>,
    flat: Vec<DVec2>,
    /// Newell's normal: as long as twice the face's area.
    normal: DVec3,
    /// The coordinate that the projection drops.
    dropped: usize,
    /// How far rounding to 32 bits may have moved a point.
    rounding: f64,
}

impl Outline {
    fn of(points: impl Iterator<Item = DVec3>) -> Self {
        let points: Vec<DVec3> = points.collect();
        let normal = newell(&points);
        let dropped = largest_axis(plane(&points, normal));
        let flat = points.iter().map(|&p| project(p, dropped)).collect();
        let largest = points.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
        Outline { points, flat, normal, dropped, rounding: 2.0 * f64::from(f32::EPSILON) * largest }
    }

    fn shape(&self) -> Shape {
        if !self.is_flat() {
            Shape::Uneven
        } else if !self.is_convex() {
            Shape::Concave
        } else {
            Shape::Convex
        }
    }

    fn is_flat(&self) -> bool {
        let Some(normal) = self.normal.try_normalize() else { return true };
        let (low, high) = bounds(&self.points);
        let middle = self.points.iter().sum::<DVec3>() / self.points.len() as f64;
        let tolerance = UNEVENNESS * (high - low).length() + self.rounding;
        self.points.iter().all(|&p| (p - middle).dot(normal).abs() <= tolerance)
    }

    /// Whether all corners turn the same way, and once around in all.
    fn is_convex(&self) -> bool {
        let mut distinct = self.flat.clone();
        distinct.dedup();
        while distinct.len() > 1 && distinct.first() == distinct.last() {
            distinct.pop();
        }
        let turns: Vec<Turn> = (0..distinct.len()).map(|i| Turn::at(&distinct, i)).collect();
        if turns.iter().all(|turn| turn.depth().abs() <= self.rounding) {
            return true; // All on a line: there is nothing to hit.
        }
        let sign = self.area().signum();
        let around = turns.iter().map(Turn::angle).sum::<f64>() * sign / TAU;
        turns.iter().all(|turn| turn.depth() * sign >= -self.rounding) && (around - 1.0).abs() < 0.5
    }

    /// The cut, as indices of corners, and whether it covers the face and no more.
    fn triangles(&self) -> (Vec<[usize; 3]>, bool) {
        let mut indices: Vec<usize> = Vec::new();
        let flat: Vec<[f64; 2]> = self.flat.iter().map(DVec2::to_array).collect();
        if flat.len() <= MOST_CORNERS {
            Earcut::new().earcut_slice(&flat, &[], &mut indices);
        }
        let triangles: Vec<[usize; 3]> =
            indices.chunks_exact(3).map(|t| self.turned_like_face([t[0], t[1], t[2]])).collect();
        let covered: f64 = triangles.iter().map(|t| self.triangle_area(t).abs()).sum();
        let area = self.area().abs();
        if !triangles.is_empty() && (covered - area).abs() <= 1e-6 * area {
            (triangles, true)
        } else {
            ((1..self.points.len() - 1).map(|i| [0, i, i + 1]).collect(), false)
        }
    }

    fn turned_like_face(&self, [a, b, c]: [usize; 3]) -> [usize; 3] {
        if self.triangle_area(&[a, b, c]) * self.area() < 0.0 { [a, c, b] } else { [a, b, c] }
    }

    /// Twice the signed area of a triangle of the projection.
    fn triangle_area(&self, &[a, b, c]: &[usize; 3]) -> f64 {
        (self.flat[b] - self.flat[a]).perp_dot(self.flat[c] - self.flat[a])
    }

    /// Twice the signed area of the projection.
    fn area(&self) -> f64 {
        self.normal[self.dropped]
    }
}

/// The way an outline turns at a corner.
struct Turn {
    arriving: DVec2,
    leaving: DVec2,
}

impl Turn {
    fn at(outline: &[DVec2], i: usize) -> Self {
        let n = outline.len();
        Turn { arriving: outline[i] - outline[(i + n - 1) % n], leaving: outline[(i + 1) % n] - outline[i] }
    }

    /// How far the corner lies from the line through its neighbours; positive for a turn to the left.
    fn depth(&self) -> f64 {
        let chord = (self.arriving + self.leaving).length();
        let cross = self.arriving.perp_dot(self.leaving);
        if chord > 0.0 { cross / chord } else { 0.0 }
    }

    /// The angle of the turn in radians, positive to the left.
    fn angle(&self) -> f64 {
        self.arriving.perp_dot(self.leaving).atan2(self.arriving.dot(self.leaving))
    }
}

/// The sum of the cross products of successive corners, taken from the first one to lose no digits far from the origin.
fn newell(points: &[DVec3]) -> DVec3 {
    let origin = points.first().copied().unwrap_or_default();
    points.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum()
}

/// A normal to tell the face's plane by: Newell's, unless the face's parts cancel out.
fn plane(points: &[DVec3], normal: DVec3) -> DVec3 {
    let n = points.len();
    let turns = (0..n).map(|i| (points[(i + 1) % n] - points[i]).cross(points[(i + 2) % n] - points[i]));
    let sharpest = turns.fold(DVec3::ZERO, |most, turn| if turn.length() > most.length() { turn } else { most });
    if normal.length() > 1e-6 * sharpest.length() { normal } else { sharpest }
}

fn largest_axis(normal: DVec3) -> usize {
    normal.abs().max_position()
}

/// Drops a coordinate, keeping the sense of rotation around its axis.
fn project(point: DVec3, dropped: usize) -> DVec2 {
    match dropped {
        0 => DVec2::new(point.y, point.z),
        1 => DVec2::new(point.z, point.x),
        _ => DVec2::new(point.x, point.y),
    }
}

fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
}
