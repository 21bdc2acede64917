//! A.3: the intersection of a ray and a convex polygon.

use glam::{DVec3, Vec3};

use super::bounds::{Bounds, largest_coordinate};
use super::closed;
use super::edges::Edges;
use super::hit::{Hit, PolygonHit};
use super::ray::{Ray, dot};
use super::rounding;
use super::slivers::overshoot;
use crate::scene::{Face, Mesh};

/// Projected triangles with a smaller determinant are points to 32-bit arithmetic, and are never hit.
const SMALLEST_DETERMINANT: f32 = 1e-30;

/// Words of a polygon's record in a cell's memory, without its vertices: N, d, its number, and its vertex count with the
/// plane of projection.
pub const RECORD_WORDS: u64 = 6;

/// All polygons of a scene, as the intersection kernel has them.
#[derive(Clone, Debug)]
pub struct Polygons {
    records: Vec<Record>,
    /// The vertices of all polygons, one polygon after the other.
    vertices: Vec<Vec3>,
    /// The same in their polygon's plane of projection.
    projected: Vec<[f32; 2]>,
    /// For each polygon, the number of the file's face that it is, or is a piece of.
    faces: Vec<u32>,
    largest_coordinate: f64,
    /// How far out rays may start for the margin to be wide enough.
    reach: f64,
    /// How the inside of each is told.
    edges: Edges,
    /// The few polygons with slack, in rising order, and how much.
    slack: Vec<(u32, f64)>,
}

/// A polygon's plane N.P = d (equation 8), and where its vertices are.
#[derive(Clone, Copy, Debug)]
struct Record {
    /// N, of unit length: so that neither tiny nor huge polygons leave the range of 32 bits; zero if the polygon has no
    /// area.
    normal: Vec3,
    d: f32,
    first: u32,
    count: u32,
    /// i1 and i2, the directions that span the plane of projection.
    axes: [u8; 2],
}

impl Polygons {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> u64 {
        let Polygons { records, vertices, projected, faces, slack, .. } = self;
        let of_vertices = size_of_val(&vertices[..]) + size_of_val(&projected[..]);
        (size_of_val(&records[..]) + of_vertices + size_of_val(&faces[..]) + size_of_val(&slack[..])) as u64
    }

    /// Takes the polygons of a mesh, whose faces must be convex and finite, with at least 3 corners; for rays that start
    /// among them.
    pub fn new(mesh: &Mesh) -> Polygons {
        Polygons::for_rays(mesh, &[])
    }

    /// The same, for rays that start as far out as some do.
    pub fn for_rays(mesh: &Mesh, rays: &[Ray]) -> Polygons {
        let mut polygons = Polygons {
            records: Vec::with_capacity(mesh.faces().len()),
            vertices: Vec::new(),
            projected: Vec::new(),
            faces: Vec::with_capacity(mesh.faces().len()),
            largest_coordinate: 0.0,
            reach: 0.0,
            edges: Edges::Paper,
            slack: Vec::new(),
        };
        for face in mesh.faces() {
            polygons.add(mesh, face);
        }
        let farthest = rays.iter().map(|ray| largest_coordinate(ray.origin)).fold(0.0, f32::max) as f64;
        let scene = polygons.largest_coordinate;
        polygons.reach = farthest.clamp(rounding::NEAREST * scene, rounding::FARTHEST * scene);
        let with_slack = |polygon| Some((polygon, polygons.overshoot(polygon))).filter(|(_, slack)| *slack > 0.0);
        polygons.slack = (0..polygons.len() as u32).filter_map(with_slack).collect();
        polygons
    }

    /// The same with an inside that is told in another way.
    pub fn with_edges(mut self, edges: Edges) -> Polygons {
        self.edges = edges;
        // Slack is what α and β of A.3 are off by.
        self.slack.retain(|_| edges == Edges::Paper);
        self
    }

    /// Whether rays can hit a polygon at all: A.3 finds none in one without area.
    pub fn can_be_hit(&self, polygon: u32) -> bool {
        self.edges == Edges::Closed || self.normal(polygon) != Vec3::ZERO
    }

    /// By how much a polygon's hits can lie farther off it, in each coordinate, than the margin allows for.
    fn overshoot(&self, polygon: u32) -> f64 {
        let covered = rounding::COVERED * self.largest_coordinate;
        let record = &self.records[polygon as usize];
        // What lies off in the plane of projection lies off along its axis by so much more, as steep as the polygon's plane is.
        let normal = record.normal.abs().as_dvec3();
        let steep = (normal.length_squared() / normal.max_element().powi(2) - 1.0).max(0.0).sqrt().max(1.0);
        if !steep.is_finite() {
            return 0.0;
        }
        let enough = covered / steep;
        let vertices = self.projected(record);
        let edges = vertices.windows(2).skip(1).map(|edge| [sub(edge[0], vertices[0]), sub(edge[1], vertices[0])]);
        let farthest = edges.map(|[first, second]| overshoot(first, second, enough)).fold(0.0, f64::max);
        (farthest * steep - covered).max(0.0)
    }

    fn add(&mut self, mesh: &Mesh, face: &Face) {
        let first = self.vertices.len();
        self.vertices.extend(mesh.face_points(face));
        let vertices = &self.vertices[first..];
        let normal = unit_normal(vertices);
        let axes = projection_axes(normal);
        let center: DVec3 = vertices.iter().map(|v| v.as_dvec3()).sum::<DVec3>() / vertices.len() as f64;
        self.projected.extend(vertices.iter().map(|v| [v[axes[0] as usize], v[axes[1] as usize]]));
        let largest = vertices.iter().map(|&v| largest_coordinate(v)).fold(0.0, f32::max);
        self.largest_coordinate = self.largest_coordinate.max(largest as f64);
        self.records.push(Record {
            normal,
            d: normal.as_dvec3().dot(center) as f32,
            first: first as u32,
            count: vertices.len() as u32,
            axes,
        });
        self.faces.push(face.number);
    }

    /// P, the number of polygons.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// The vertices of a polygon, in order.
    pub fn vertices(&self, polygon: u32) -> &[Vec3] {
        let record = &self.records[polygon as usize];
        &self.vertices[record.first as usize..][..record.count as usize]
    }

    /// N, of unit length, or zero for a polygon without area.
    pub fn normal(&self, polygon: u32) -> Vec3 {
        self.records[polygon as usize].normal
    }

    /// d of the plane N.P = d.
    pub fn d(&self, polygon: u32) -> f32 {
        self.records[polygon as usize].d
    }

    /// i1 and i2, the axes that span the plane of projection.
    pub fn projection(&self, polygon: u32) -> [u8; 2] {
        self.records[polygon as usize].axes
    }

    /// How far out rays may start for the grid's margin to be wide enough.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The number of the file's face that a polygon is, or is a piece of.
    pub fn face(&self, polygon: u32) -> u32 {
        self.faces[polygon as usize]
    }

    /// The largest absolute value of the vertices' coordinates.
    pub fn largest_coordinate(&self) -> f64 {
        self.largest_coordinate
    }

    /// How far from a polygon the grid must list it; see [`rounding`].
    pub fn margin(&self) -> f64 {
        rounding::reach_error(self.reach, self.largest_coordinate)
    }

    /// How much larger than it is the filters must take a polygon to be, in each coordinate: 0 but for slivers; see [`rounding`].
    pub fn slack(&self, polygon: u32) -> f64 {
        self.slack.binary_search_by_key(&polygon, |entry| entry.0).map_or(0.0, |place| self.slack[place].1)
    }

    /// By how much hits of a ray that starts at `origin` can lie outside what the margin allows for: 0 within reach.
    #[inline]
    pub fn beyond_margin(&self, origin: Vec3) -> f32 {
        let out = largest_coordinate(origin) as f64;
        if out <= self.reach { 0.0 } else { rounding::reach_error(out, self.largest_coordinate) as f32 }
    }

    /// Words that some polygons take in the memory of an intersection cell.
    pub fn memory_words(&self, members: &[u32]) -> u64 {
        members.iter().map(|&polygon| self.record_words(polygon)).sum()
    }

    /// Words of a polygon's record and vertices.
    pub fn record_words(&self, polygon: u32) -> u64 {
        RECORD_WORDS + 3 * self.vertices(polygon).len() as u64
    }

    /// The vertices moved along the axis of projection into the plane: what A.3 takes the polygon to be. With closed edges, the
    /// vertices as they are.
    pub fn flattened(&self, polygon: u32) -> impl Iterator<Item = DVec3> + Clone + '_ {
        let record = self.records[polygon as usize];
        let axis = 3 - (record.axes[0] + record.axes[1]) as usize;
        let (normal, d) = (record.normal.as_dvec3(), record.d as f64);
        self.vertices(polygon).iter().map(move |vertex| {
            let vertex = vertex.as_dvec3();
            let mut flat = vertex;
            flat[axis] += (d - normal.dot(vertex)) / normal[axis];
            if flat[axis].is_finite() && self.edges == Edges::Paper { flat } else { vertex }
        })
    }

    /// The intersection of a ray with one polygon, unless it lies beyond `nearest`.
    #[inline]
    pub fn intersect(&self, ray: &Ray, polygon: u32, nearest: f32) -> Option<PolygonHit> {
        if self.edges == Edges::Closed {
            return closed::intersect(ray, self.vertices(polygon), nearest);
        }
        let record = &self.records[polygon as usize];
        let t = record.plane_hit(ray)?;
        if !(t > 0.0 && t <= ray.t_max && t <= nearest) {
            return None;
        }
        let [i1, i2] = record.axes.map(usize::from);
        let p = [ray.origin[i1] + t * ray.direction[i1], ray.origin[i2] + t * ray.direction[i2]];
        let (alpha, beta, triangle) = fan_hit(p, self.projected(record))?;
        Some(PolygonHit { t, alpha, beta, triangle })
    }

    /// Whether a ray cannot hit a polygon, as A.3 finds by its plane alone: in the same arithmetic, so that it finds none in any case.
    /// (With closed edges, which know no plane, by all of the test.)
    pub fn surely_misses(&self, ray: &Ray, polygon: u32) -> bool {
        if self.edges == Edges::Closed {
            return self.intersect(ray, polygon, f32::INFINITY).is_none();
        }
        let t = self.records[polygon as usize].plane_hit(ray);
        !t.is_some_and(|t| t > 0.0 && t <= ray.t_max)
    }

    #[inline]
    fn projected(&self, record: &Record) -> &[[f32; 2]] {
        &self.projected[record.first as usize..][..record.count as usize]
    }

    /// The nearer of a hit and this polygon's, if there is one.
    #[inline]
    pub fn nearer(&self, ray: &Ray, polygon: u32, nearest: Hit) -> Hit {
        match self.intersect(ray, polygon, nearest.t) {
            Some(hit) => nearest.nearer(Hit { t: hit.t, polygon, alpha: hit.alpha, beta: hit.beta }),
            None => nearest,
        }
    }
}

impl Record {
    /// t = (d - N.O) / N.D (equation 9); `None` if the ray is parallel to the plane.
    #[inline]
    fn plane_hit(&self, ray: &Ray) -> Option<f32> {
        let n_dot_d = dot(self.normal, ray.direction);
        (n_dot_d != 0.0).then(|| (self.d - dot(self.normal, ray.origin)) / n_dot_d)
    }
}

/// The first triangle of the fan that holds a point of the plane of projection, with α and β.
#[inline]
fn fan_hit(p: [f32; 2], vertices: &[[f32; 2]]) -> Option<(f32, f32, u32)> {
    let s0 = vertices[0];
    vertices.windows(2).skip(1).zip(0..).find_map(|(edge, triangle)| {
        let (alpha, beta) = triangle_hit(sub(p, s0), sub(edge[0], s0), sub(edge[1], s0))?;
        Some((alpha, beta, triangle))
    })
}

/// α and β of the point S0 + (u0, v0) in the triangle of the edges (u1, v1) and (u2, v2) from S0, if it lies inside.
#[inline]
fn triangle_hit([u0, v0]: [f32; 2], [u1, v1]: [f32; 2], [u2, v2]: [f32; 2]) -> Option<(f32, f32)> {
    // Implied by the test of α and β in exact arithmetic; in 32 bits it keeps slivers from being hit beyond their ends.
    let beside = u0 < u1.min(u2).min(0.0) || u0 > u1.max(u2).max(0.0);
    let above_or_below = v0 < v1.min(v2).min(0.0) || v0 > v1.max(v2).max(0.0);
    if beside || above_or_below {
        return None;
    }
    let determinant = u1 * v2 - v1 * u2;
    let alpha = (u0 * v2 - v0 * u2) / determinant;
    let beta = (u1 * v0 - v1 * u0) / determinant;
    let inside = alpha >= 0.0 && beta >= 0.0 && alpha + beta <= 1.0;
    (inside && determinant.abs() >= SMALLEST_DETERMINANT).then_some((alpha, beta))
}

#[inline]
fn sub(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The direction of the sum of the fan triangles' cross products (S_k - S0) x (S_k+1 - S0): for a triangle the paper's N,
/// and for any polygon independent of which three corners might lie on one line.
fn unit_normal(vertices: &[Vec3]) -> Vec3 {
    let s0 = vertices[0].as_dvec3();
    let edges = || vertices[1..].iter().map(|v| v.as_dvec3() - s0);
    let sum: DVec3 = edges().zip(edges().skip(1)).map(|(a, b)| a.cross(b)).sum();
    // Below 1e-7 of what edges of this length could span, the direction is rounding noise of the coordinates.
    let size = edges().map(|edge| edge.length_squared()).fold(0.0, f64::max);
    if sum.length() > 1e-7 * size { (sum / sum.length()).as_vec3() } else { Vec3::ZERO }
}

/// i1 and i2: all directions but i0, that of the largest component of N.
fn projection_axes(normal: Vec3) -> [u8; 2] {
    let n = normal.abs();
    if n.x >= n.y && n.x >= n.z {
        [1, 2]
    } else if n.y >= n.z {
        [2, 0]
    } else {
        [0, 1]
    }
}

/// The box around a flattened polygon.
pub fn flat_bounds(polygons: &Polygons, polygon: u32) -> Bounds {
    Bounds::around(polygons.flattened(polygon))
}

/// The box around all of a polygon's hits, but for what the margin allows for.
pub fn hit_bounds(polygons: &Polygons, polygon: u32) -> Bounds {
    flat_bounds(polygons, polygon).grown(polygons.slack(polygon))
}
