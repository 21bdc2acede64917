//! What a solid came to, in the array's 32 bits: triangles without area merged away, the others joined to convex polygons.
//!
//! All of it keeps a closed surface closed: every edge stays that of two polygons, one each way round.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::inside::Owner;
use super::sources::{Source, Sources};
use crate::scene::convex;
use crate::scene::mesh::{Corner, Mesh, NO_NORMAL};

/// Polygons that share corners.
pub(super) struct Polygons {
    points: Vec<Vec3>,
    /// Those that became part of others have no corners left.
    polygons: Vec<Polygon>,
    /// The polygon of each edge, or that there are several.
    edges: HashMap<Edge, u32>,
}

/// From corner to corner, as a polygon goes round.
type Edge = (u32, u32);

struct Polygon {
    corners: Vec<u32>,
    /// The face that it is a piece of, counted into the solid's [`Sources`].
    face: u32,
}

/// In the place of a polygon's number: the edge belongs to several.
const SEVERAL: u32 = u32::MAX;

impl Polygons {
    /// Rounds triangles to 32 bits. Points that become one are one; what becomes an edge by that is gone, as are two triangles
    /// back to back.
    pub fn new(points: &[DVec3], triangles: &[([u32; 3], u32)]) -> Polygons {
        let (points, places) = welded(points);
        let corners = triangles.iter().map(|(triangle, face)| (triangle.map(|corner| places[corner as usize]), *face));
        let whole: Vec<([u32; 3], u32)> = corners.filter(|([a, b, c], _)| a != b && b != c && c != a).collect();
        let mut sides: HashMap<[u32; 3], i32> = HashMap::new();
        for (triangle, _) in &whole {
            *sides.entry(sorted(*triangle)).or_default() += turn(*triangle);
        }
        let mut polygons = Polygons { points, polygons: Vec::new(), edges: HashMap::new() };
        for (triangle, face) in whole {
            let left = sides.get_mut(&sorted(triangle)).filter(|left| left.signum() == turn(triangle));
            if let Some(left) = left {
                *left -= turn(triangle);
                polygons.polygons.push(Polygon { corners: triangle.to_vec(), face });
                polygons.claim(polygons.polygons.len() - 1);
            }
        }
        polygons
    }

    /// Merges triangles that are no wider than what rounding does into the polygons along their longest edges, and returns how
    /// many there were.
    pub fn absorb_slivers(&mut self) -> u32 {
        let mut slivers: Vec<usize> = (0..self.polygons.len()).filter(|&number| self.is_sliver(number)).collect();
        let all = slivers.len();
        // Every absorption takes a sliver away, and every flip shortens a longest edge; the limit is for rounding.
        for _ in 0..=all {
            let before = slivers.len();
            let mut flipped = false;
            for &sliver in &slivers {
                flipped |= !self.absorb(sliver) && self.flip(sliver);
            }
            slivers.retain(|&sliver| !self.polygons[sliver].corners.is_empty());
            if slivers.len() == before && !flipped {
                break;
            }
        }
        slivers.iter().for_each(|&sliver| self.give_up(sliver));
        all as u32
    }

    /// Merges a sliver into the polygon along its longest edge, unless that is a sliver, too.
    fn absorb(&mut self, sliver: usize) -> bool {
        let Some((from, to)) = self.longest_edge(sliver) else { return true };
        let neighbour = self.neighbour((from, to)).filter(|&neighbour| !self.is_sliver(neighbour));
        let Some(neighbour) = neighbour else { return false };
        let Some(corners) = self.spliced(neighbour, sliver, (to, from)) else { return false };
        self.merge(neighbour, sliver, corners);
        true
    }

    /// Two slivers along their longest edge become two along the other diagonal, which is shorter.
    fn flip(&mut self, sliver: usize) -> bool {
        let Some((a, b)) = self.longest_edge(sliver) else { return false };
        let Some(other) = self.neighbour((a, b)).filter(|&other| self.longest_edge(other) == Some((b, a))) else {
            return false;
        };
        let apex =
            |number: usize| self.polygons[number].corners.iter().copied().find(|&corner| corner != a && corner != b);
        let (Some(c), Some(d)) = (apex(sliver), apex(other)) else { return false };
        if c == d || self.edges.contains_key(&(c, d)) || self.edges.contains_key(&(d, c)) {
            return false;
        }
        self.release(sliver);
        self.release(other);
        self.polygons[sliver].corners = vec![a, d, c];
        self.polygons[other].corners = vec![d, b, c];
        self.claim(sliver);
        self.claim(other);
        true
    }

    /// Takes a sliver out that nothing would absorb, if it has no area at all.
    fn give_up(&mut self, sliver: usize) {
        if self.height(sliver) == 0.0 {
            self.release(sliver);
            self.polygons[sliver].corners.clear();
        }
    }

    /// Whether a polygon is a triangle whose height is within what the rounding of its corners can do.
    fn is_sliver(&self, number: usize) -> bool {
        let corners = &self.polygons[number].corners;
        let largest =
            corners.iter().map(|&corner| self.points[corner as usize].abs().max_element()).fold(0.0, f32::max);
        corners.len() == 3 && self.height(number) <= f64::from(2.0 * f32::EPSILON * largest)
    }

    /// A triangle's height above its longest edge.
    fn height(&self, number: usize) -> f64 {
        let Some((from, to)) = self.longest_edge(number) else { return 0.0 };
        let [a, b, c] = [0, 1, 2].map(|at| self.point(self.polygons[number].corners[at]));
        (b - a).cross(c - a).length() / (self.point(to) - self.point(from)).length()
    }

    /// A triangle's longest edge; of several, the first in the order of their corners' numbers.
    fn longest_edge(&self, number: usize) -> Option<Edge> {
        let length = |&(from, to): &Edge| (self.point(to) - self.point(from)).length_squared();
        let first = |&(from, to): &Edge| std::cmp::Reverse((from.min(to), from.max(to)));
        let edges = edges(&self.polygons[number].corners);
        edges.max_by(|one, other| length(one).total_cmp(&length(other)).then(first(one).cmp(&first(other))))
    }

    fn point(&self, corner: u32) -> DVec3 {
        self.points[corner as usize].as_dvec3()
    }

    /// The one polygon on the other side of a polygon's edge.
    fn neighbour(&self, (from, to): Edge) -> Option<usize> {
        let other = *self.edges.get(&(to, from))?;
        let single = other != SEVERAL && self.edges.get(&(from, to)) != Some(&SEVERAL);
        single.then_some(other as usize)
    }

    /// The outline of two polygons together, without the edge that `one` has from corner to corner and `other` back; none if
    /// they touch elsewhere, too, or if nothing would be left.
    fn spliced(&self, one: usize, other: usize, (from, to): Edge) -> Option<Vec<u32>> {
        let around = |number: usize, first: u32| {
            let corners = &self.polygons[number].corners;
            let start = corners.iter().position(|&corner| corner == first)?;
            Some(corners[start..].iter().chain(&corners[..start]).copied())
        };
        // The one from the edge's end around to its start; the other from there on.
        let mut corners: Vec<u32> = around(one, to)?.collect();
        corners.extend(around(other, from)?.skip(1));
        corners.pop();
        drop_spikes(&mut corners);
        let mut distinct = corners.clone();
        distinct.sort_unstable();
        distinct.dedup();
        (corners.len() >= 3 && distinct.len() == corners.len()).then_some(corners)
    }

    /// Gives the outline of both to one polygon.
    fn merge(&mut self, one: usize, other: usize, corners: Vec<u32>) {
        self.release(one);
        self.release(other);
        self.polygons[other].corners.clear();
        self.polygons[one].corners = corners;
        self.claim(one);
    }

    fn claim(&mut self, number: usize) {
        for edge in edges(&self.polygons[number].corners) {
            self.edges.entry(edge).and_modify(|owner| *owner = SEVERAL).or_insert(number as u32);
        }
    }

    fn release(&mut self, number: usize) {
        for edge in edges(&self.polygons[number].corners) {
            if self.edges.get(&edge) == Some(&(number as u32)) {
                self.edges.remove(&edge);
            }
        }
    }

    /// The polygons as a mesh, in the order of their faces.
    pub fn into_mesh(self, sources: &Sources, owner: Option<&Owner>) -> Mesh {
        let mut left: Vec<&Polygon> = self.polygons.iter().filter(|polygon| !polygon.corners.is_empty()).collect();
        left.sort_by_key(|polygon| polygon.face);
        let mut made = Made { mesh: Mesh::default(), points: HashMap::new(), normals: HashMap::new() };
        for surface in left.chunk_by(|one, other| sources.of(one.face).thing() == sources.of(other.face).thing()) {
            made.mesh.begin_object();
            made.normals.clear();
            for polygon in surface {
                made.add(&self.points, polygon, sources.of(polygon.face), owner);
            }
        }
        made.mesh
    }
}

/// Joins polygons of one face, side by side, as long as they stay convex: over the longest edges first.
pub(super) fn join(polygons: &mut Polygons) {
    loop {
        let mut between: Vec<Edge> = polygons.edges.keys().copied().filter(|(from, to)| from < to).collect();
        let length = |&(from, to): &Edge| (polygons.point(to) - polygons.point(from)).length_squared();
        between.sort_by(|one, other| length(other).total_cmp(&length(one)).then(one.cmp(other)));
        let joined = between.into_iter().filter(|&edge| join_over(polygons, edge)).count();
        if joined == 0 {
            return;
        }
    }
}

fn join_over(polygons: &mut Polygons, edge: Edge) -> bool {
    let sides = (polygons.neighbour((edge.1, edge.0)), polygons.neighbour(edge));
    let (Some(one), Some(other)) = sides else { return false };
    if one == other || polygons.polygons[one].face != polygons.polygons[other].face {
        return false;
    }
    let Some(corners) = polygons.spliced(one, other, edge) else { return false };
    let stays_whole = convex::stays_whole(corners.iter().map(|&corner| polygons.points[corner as usize]));
    if stays_whole {
        polygons.merge(one, other, corners);
    }
    stays_whole
}

/// The corner to begin at so that the triangles around it, into which the array's intersection cuts a polygon, are as large as
/// can be: the smallest of them counts.
fn best_start(places: &[DVec3]) -> usize {
    let count = places.len();
    let smallest = |start: usize| {
        let place = |step: usize| places[(start + step) % count];
        let areas = (1..count - 1).map(|step| (place(step) - place(0)).cross(place(step + 1) - place(0)).length());
        areas.fold(f64::INFINITY, f64::min)
    };
    // The first of equals.
    (0..count).rev().max_by(|&one, &other| smallest(one).total_cmp(&smallest(other))).unwrap_or_default()
}

/// Takes ways there and back out of an outline.
fn drop_spikes(corners: &mut Vec<u32>) {
    loop {
        let count = corners.len();
        let spike = (0..count).find(|&at| count > 2 && corners[at] == corners[(at + 2) % count]);
        let Some(at) = spike else { return };
        let (tip, back) = ((at + 1) % count, (at + 2) % count);
        corners.remove(tip.max(back));
        corners.remove(tip.min(back));
    }
}

fn edges(corners: &[u32]) -> impl Iterator<Item = Edge> + '_ {
    (0..corners.len()).map(|at| (corners[at], corners[(at + 1) % corners.len()]))
}

fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// Which way round a triangle goes, by its corners' numbers: 1 or -1.
fn turn([a, b, c]: [u32; 3]) -> i32 {
    if (a < b) as i32 + (b < c) as i32 + (c < a) as i32 == 2 { 1 } else { -1 }
}

/// Points in 32 bits, each once, and for each point its place there.
fn welded(points: &[DVec3]) -> (Vec<Vec3>, Vec<u32>) {
    let mut places: HashMap<[u32; 3], u32> = HashMap::new();
    let mut welded = Vec::new();
    let place = |point: &DVec3| {
        // Zeros of either sign are one place.
        let point = point.as_vec3() + Vec3::ZERO;
        *places.entry(point.to_array().map(f32::to_bits)).or_insert_with(|| {
            welded.push(point);
            (welded.len() - 1) as u32
        })
    };
    let places = points.iter().map(place).collect();
    (welded, places)
}

/// A mesh in the making.
struct Made {
    mesh: Mesh,
    /// The places of points in the mesh.
    points: HashMap<u32, u32>,
    /// The places of one surface's normals.
    normals: HashMap<[u32; 3], u32>,
}

impl Made {
    fn add(&mut self, points: &[Vec3], polygon: &Polygon, source: &Source, owner: Option<&Owner>) {
        let mut outline = polygon.corners.clone();
        let place = |&corner: &u32| points[corner as usize].as_dvec3();
        let start = best_start(&outline.iter().map(place).collect::<Vec<_>>());
        outline.rotate_left(start);
        let places: Vec<DVec3> = outline.iter().map(place).collect();
        let facing: DVec3 = places.windows(2).map(|pair| (pair[0] - places[0]).cross(pair[1] - places[0])).sum();
        let normals: Option<Vec<DVec3>> = places.iter().map(|&place| source.normal_at(place)).collect();
        let normals = normals.filter(|normals| normals.iter().all(|normal| normal.dot(facing) > 0.0));
        let corners: Vec<Corner> = (0..places.len())
            .map(|at| {
                let corner = outline[at];
                let point = *self.points.entry(corner).or_insert_with(|| self.mesh.add_point(points[corner as usize]));
                let normal = normals.as_ref().map_or(NO_NORMAL, |normals| {
                    let normal = normals[at].as_vec3();
                    let bits = normal.to_array().map(f32::to_bits);
                    *self.normals.entry(bits).or_insert_with(|| self.mesh.add_normal(normal))
                });
                Corner { point, normal }
            })
            .collect();
        let behind = || {
            let middle = places.iter().sum::<DVec3>() / places.len() as f64;
            middle - facing.normalize_or_zero() * facing.length().sqrt() * 1e-5
        };
        let material = owner.and_then(|owner| owner.material_at(behind())).unwrap_or(source.material);
        self.mesh.add_smooth_face(&corners, material);
    }
}
