//! From a tree of solids to polygons.

use glam::{DAffine3, DVec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, Error, MeshGLP, OpType};

use super::inside::Owner;
use super::planes::{self, Plane};
use super::polygons::{Polygons, join};
use super::report::Report;
use super::shell::Shell;
use super::sources::Sources;
use super::{Cut, Solid};
use crate::input::text::coordinate;
use crate::scene::mesh::Mesh;

/// The step to which coordinates are rounded while solids are combined, as a share of the largest one: far coarser than what
/// rounding to double does to them, far finer than what the array's 32 bits tell apart.
const STEP: f64 = 1.0 / (1u64 << 42) as f64;

/// How a solid is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// What cut faces are made of.
    pub cut: Cut,
    /// Whether triangles of one face that lie side by side become convex polygons.
    pub join: bool,
}

impl Default for Options {
    /// Cut faces are of what cut them, and triangles are joined.
    fn default() -> Self {
        Options { cut: Cut::Surface, join: true }
    }
}

/// A solid as polygons.
#[derive(Clone, Debug)]
pub struct Evaluated {
    /// Its faces in the order of the tree, each shell's by surfaces; all flat and convex. It may be empty.
    pub mesh: Mesh,
    /// What it came to.
    pub report: Report,
}

/// Evaluates a solid.
///
/// # Errors
///
/// If a coordinate is too large for the array.
pub fn evaluate(solid: &Solid, options: Options) -> Result<Evaluated, String> {
    let size = extent(solid, &[]);
    coordinate(size)?;
    let mut evaluator = Evaluator { size, step: power_of_two(size * STEP), sources: Sources::default() };
    let part = evaluator.part(solid, &DAffine3::IDENTITY, false)?;
    let (points, triangles) = exported(&part.shape);
    let mut polygons = Polygons::new(&points, &triangles);
    let slivers = polygons.absorb_slivers();
    if options.join {
        join(&mut polygons);
    }
    let owner = (options.cut == Cut::Volume).then(|| Owner::new(solid));
    let mesh = polygons.into_mesh(&evaluator.sources, owner.as_ref());
    let report = Report::new(&mesh, &evaluator.sources, slivers);
    Ok(Evaluated { mesh, report })
}

/// The largest coordinate that any part has anywhere on its way to its place. `maps` take the solid's frame to each of those that
/// it is placed in.
fn extent(solid: &Solid, maps: &[DAffine3]) -> f64 {
    match solid {
        Solid::Leaf { shell, .. } => {
            let largest = |point: DVec3| {
                let places = maps.iter().map(|map| map.transform_point3(point));
                places.fold(point.abs(), |largest, place| largest.max(place.abs())).max_element()
            };
            shell.points.iter().map(|&point| largest(point)).fold(0.0, f64::max)
        }
        Solid::Union(solids) | Solid::Intersection(solids) | Solid::Difference(solids) => {
            solids.iter().map(|solid| extent(solid, maps)).fold(0.0, f64::max)
        }
        Solid::Place(own, solid) => {
            let outer = maps.iter().map(|map| *map * *own);
            extent(solid, &outer.chain([*own]).collect::<Vec<_>>())
        }
    }
}

/// The largest power of two that is not above a number; 1 for 0.
fn power_of_two(number: f64) -> f64 {
    if number > 0.0 { number.log2().floor().exp2() } else { 1.0 }
}

struct Evaluator {
    /// The largest coordinate.
    size: f64,
    /// What coordinates are rounded to multiples of.
    step: f64,
    sources: Sources,
}

/// A solid that is evaluated so far, in its own frame.
struct Part {
    shape: Manifold,
    /// The planes of all faces that went into it.
    planes: Vec<Plane>,
}

impl Evaluator {
    /// Evaluates a part of the tree. `map` takes it to its final place, for what is told of its faces; the part itself stays in
    /// its own frame, so that what meets there still does.
    fn part(&mut self, solid: &Solid, map: &DAffine3, inverted: bool) -> Result<Part, String> {
        match solid {
            Solid::Leaf { shell, .. } => self.leaf(shell, &DAffine3::IDENTITY, map, inverted),
            Solid::Place(own, inner) => match inner.as_ref() {
                Solid::Leaf { shell, .. } => self.leaf(shell, own, &(*map * *own), inverted),
                _ => {
                    let part = self.part(inner, &(*map * *own), inverted)?;
                    self.placed(part, own)
                }
            },
            Solid::Union(_) => {
                let mut operands = Vec::new();
                flatten(solid, &mut operands);
                self.union(operands, map, inverted)
            }
            Solid::Intersection(solids) => {
                let mut operands = self.parts(solids.iter().collect(), map, inverted)?.into_iter();
                let first = operands.next().ok_or(EMPTY)?;
                operands.try_fold(first, |one, other| self.combined(one, other, OpType::Intersect))
            }
            Solid::Difference(solids) => {
                let (first, rest) = solids.split_first().ok_or(EMPTY)?;
                let first = self.part(first, map, inverted)?;
                if rest.is_empty() {
                    return Ok(first);
                }
                let mut cutters = Vec::new();
                rest.iter().for_each(|solid| flatten(solid, &mut cutters));
                let cutters = self.union(cutters, map, !inverted)?;
                self.combined(first, cutters, OpType::Subtract)
            }
        }
    }

    /// Evaluates operands in the order of the tree, and returns them with the highest priority first.
    fn parts(&mut self, solids: Vec<&Solid>, map: &DAffine3, inverted: bool) -> Result<Vec<Part>, String> {
        let mut parts: Vec<(i32, Part)> = solids
            .into_iter()
            .map(|solid| Ok((solid.priority(), self.part(solid, map, inverted)?)))
            .collect::<Result<_, String>>()?;
        parts.sort_by_key(|(priority, _)| std::cmp::Reverse(*priority));
        Ok(parts.into_iter().map(|(_, part)| part).collect())
    }

    /// The union of solids, of neighbours two by two, so that large parts meet seldom and those in front stay in front.
    fn union(&mut self, solids: Vec<&Solid>, map: &DAffine3, inverted: bool) -> Result<Part, String> {
        let mut parts = self.parts(solids, map, inverted)?;
        while parts.len() > 1 {
            let mut halved = Vec::with_capacity(parts.len().div_ceil(2));
            let mut rest = parts.into_iter();
            while let Some(one) = rest.next() {
                halved.push(match rest.next() {
                    Some(other) => self.combined(one, other, OpType::Add)?,
                    None => one,
                });
            }
            parts = halved;
        }
        parts.pop().ok_or_else(|| EMPTY.to_owned())
    }

    fn leaf(&mut self, shell: &Shell, own: &DAffine3, map: &DAffine3, inverted: bool) -> Result<Part, String> {
        let first = self.sources.add(shell, map, inverted);
        let shell = shell.clone().placed(own);
        let triangles: Vec<_> =
            shell.triangles().into_iter().map(|(triangle, face)| (triangle, first + face)).collect();
        self.made(shell.points, &triangles)
    }

    /// A part in another place.
    fn placed(&self, part: Part, map: &DAffine3) -> Result<Part, String> {
        let (mut points, mut triangles) = exported(&part.shape);
        points.iter_mut().for_each(|point| *point = map.transform_point3(*point));
        if map.matrix3.determinant() < 0.0 {
            triangles.iter_mut().for_each(|(triangle, _)| triangle.reverse());
        }
        self.made(points, &triangles)
    }

    fn made(&self, mut points: Vec<DVec3>, triangles: &[([u32; 3], u32)]) -> Result<Part, String> {
        points.iter_mut().for_each(|point| *point = self.rounded(*point));
        let planes = planes::of(&points, triangles, self.size);
        Ok(Part { shape: checked(manifold(&points, triangles))?, planes })
    }

    /// Two parts in one frame combined.
    ///
    /// The quick way tells coincident faces apart by shifting one part by less than any number, now here, now there; where
    /// there may be some, the exact way has to go by our rule.
    fn combined(&self, one: Part, other: Part, operation: OpType) -> Result<Part, String> {
        let coincide = planes::coincide(&one.planes, &other.planes, self.size);
        let exact = coincide || [&one, &other].iter().any(|part| part.shape.as_impl().is_soup);
        let shape = if exact {
            let (one, other) = (self.on_steps(&one.shape)?, self.on_steps(&other.shape)?);
            one.boolean_with_engine(&other, operation, BooleanEngine::Robust)
        } else {
            one.shape.boolean_with_engine(&other.shape, operation, BooleanEngine::Exact)
        };
        Ok(Part { shape: checked(shape)?, planes: planes::merged(one.planes, other.planes) })
    }

    /// A shape with its points on multiples of the step, so that faces which were cut still lie in the planes of others.
    fn on_steps(&self, shape: &Manifold) -> Result<Manifold, String> {
        let (points, triangles) = exported(shape);
        let rounded: Vec<DVec3> = points.iter().map(|&point| self.rounded(point)).collect();
        if rounded == points { Ok(shape.clone()) } else { checked(manifold(&rounded, &triangles)) }
    }

    fn rounded(&self, point: DVec3) -> DVec3 {
        (point / self.step).round() * self.step
    }
}

const EMPTY: &str = "an operation has no operands";

/// The operands of unions within unions, in order.
fn flatten<'a>(solid: &'a Solid, operands: &mut Vec<&'a Solid>) {
    match solid {
        Solid::Union(solids) => solids.iter().for_each(|solid| flatten(solid, operands)),
        _ => operands.push(solid),
    }
}

/// A closed mesh in triangles as the library has it; each triangle with the number of the face that it is a piece of.
pub(super) fn manifold(points: &[DVec3], triangles: &[([u32; 3], u32)]) -> Manifold {
    if triangles.is_empty() {
        return Manifold::empty();
    }
    let mesh = MeshGLP::<f64, u32> {
        num_prop: 3,
        vert_properties: points.iter().flat_map(|point| point.to_array()).collect(),
        tri_verts: triangles.iter().flat_map(|(triangle, _)| *triangle).collect(),
        face_id: triangles.iter().map(|(_, face)| *face).collect(),
        ..MeshGLP::default()
    };
    Manifold::from_mesh_glp_robust(&mesh)
}

fn checked(shape: Manifold) -> Result<Manifold, String> {
    match shape.status() {
        Error::NoError => Ok(shape),
        status => Err(format!("the solid cannot be evaluated: {}", status.to_str().to_lowercase())),
    }
}

/// Points, and triangles with the numbers of their faces.
fn exported(shape: &Manifold) -> (Vec<DVec3>, Vec<([u32; 3], u32)>) {
    let mesh: MeshGLP<f64, u32> = shape.get_mesh_glp(-1);
    let points = mesh.vert_properties.chunks_exact(3).map(DVec3::from_slice).collect();
    let corners = mesh.tri_verts.chunks_exact(3).map(|triangle| [triangle[0], triangle[1], triangle[2]]);
    (points, corners.zip(mesh.face_id).collect())
}
