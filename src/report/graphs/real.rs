//! G_r: parts of the scene, which processes have, and what is in them.

use std::collections::{BTreeMap, BTreeSet};

use super::Of;
use super::graph::{Attributes, Graph, number, text, whole};
use crate::error::InputError;
use crate::geometry::polygon::flat_bounds;
use crate::geometry::{Bounds, Hit, Polygons, Ray};
use crate::scene::Scene;

/// The most polygons that a graph has as vertices.
const MOST_POLYGONS: usize = 10_000;

/// Two parts of the scene that touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// The part on the side of the smaller coordinates, and the one on the other.
    pub parts: [usize; 2],
    /// The axis across which they touch, and where.
    axis: usize,
    at: f64,
    /// What they have in common.
    face: Bounds,
    /// Rays that pass from the first to the second, and back.
    pub rays: [u64; 2],
}

impl Contact {
    /// All of some boxes.
    pub fn between(boxes: &[Bounds]) -> Vec<Contact> {
        let mut contacts = Vec::new();
        for (low, first) in boxes.iter().enumerate() {
            for (high, second) in boxes.iter().enumerate() {
                let face = first.intersection(*second);
                let touches = |&axis: &usize| {
                    let beside = [(axis + 1) % 3, (axis + 2) % 3];
                    first.high[axis] == second.low[axis] && beside.iter().all(|&side| face.high[side] > face.low[side])
                };
                let axis = (0..3).find(touches).filter(|_| low != high);
                contacts.extend(axis.map(|axis| Contact {
                    parts: [low, high],
                    axis,
                    at: first.high[axis],
                    face,
                    rays: [0; 2],
                }));
            }
        }
        contacts
    }

    /// The area of what they have in common.
    pub fn area(&self) -> f64 {
        let extent = self.face.extent();
        extent[(self.axis + 1) % 3] * extent[(self.axis + 2) % 3]
    }

    /// Counts a ray if it passes through what they have in common before its hit.
    pub fn count(&mut self, ray: &Ray, hit: &Hit) {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let t = (self.at - origin[self.axis]) / direction[self.axis];
        if !(t > 0.0 && t <= f64::from(hit.t.min(ray.t_max))) {
            return;
        }
        let at = origin + direction * t;
        let inside = |side: usize| self.face.low[side] <= at[side] && at[side] < self.face.high[side];
        if inside((self.axis + 1) % 3) && inside((self.axis + 2) % 3) {
            self.rays[usize::from(direction[self.axis] < 0.0)] += 1;
        }
    }
}

/// A box as attributes.
pub fn of_box(bounds: &Bounds) -> Attributes {
    let side = |(name, at): (&str, f64)| number(name, at);
    let Bounds { low, high } = bounds;
    [("low_x", low.x), ("low_y", low.y), ("low_z", low.z), ("high_x", high.x), ("high_y", high.y), ("high_z", high.z)]
        .map(side)
        .into()
}

/// The objects of a scene: what is looked at as one thing, and made of one material.
pub struct Objects<'a> {
    polygons: &'a Polygons,
    /// The object of each polygon.
    of_polygon: Vec<usize>,
    all: Vec<Object>,
}

struct Object {
    material: u32,
    faces: BTreeSet<u32>,
    polygons: u64,
    bounds: Bounds,
}

impl<'a> Objects<'a> {
    /// Those of a scene, in the order of their first polygons.
    pub fn new(scene: &Scene, polygons: &'a Polygons) -> Objects<'a> {
        let (mut places, mut all) = (BTreeMap::new(), Vec::<Object>::new());
        let mut of_polygon = Vec::with_capacity(polygons.len());
        for (polygon, face) in (0..).zip(scene.mesh.faces()) {
            let place = *places.entry(scene.mesh.object(face).number()).or_insert(all.len());
            if place == all.len() {
                let empty = Bounds::EMPTY;
                all.push(Object { material: face.material, faces: BTreeSet::new(), polygons: 0, bounds: empty });
            }
            let object = &mut all[place];
            object.faces.insert(face.number);
            object.polygons += 1;
            object.bounds = object.bounds.union(flat_bounds(polygons, polygon));
            of_polygon.push(place);
        }
        Objects { polygons, of_polygon, all }
    }

    /// The object that a hit shows.
    pub fn of_hit(&self, hit: &Hit) -> Option<usize> {
        hit.is_hit().then(|| self.of_polygon[hit.polygon as usize])
    }

    fn attributes(&self, object: usize) -> Attributes {
        let Object { material, faces, polygons, bounds } = &self.all[object];
        let mut attributes = vec![
            text("label", format!("object {object}")),
            text("kind", "object"),
            whole("faces", faces.len() as u64),
            whole("polygons", *polygons),
            whole("material", (*material).into()),
        ];
        attributes.extend(of_box(bounds));
        attributes
    }

    /// Adds objects that were hit to a graph, each once, and tells their places.
    pub fn add_hit(&self, graph: &mut Graph, hit: impl Iterator<Item = usize>) -> BTreeMap<usize, usize> {
        let hit: BTreeSet<usize> = hit.collect();
        hit.into_iter()
            .map(|object| (object, graph.add_vertex(format!("object{object}"), self.attributes(object))))
            .collect()
    }

    /// Adds what is in parts of the scene to their graph: `held` has each part's vertex, and its polygons.
    ///
    /// Fails if these are too many to be vertices.
    pub fn add_contents(&self, graph: &mut Graph, of: Of, held: &[(usize, Vec<u32>)]) -> Result<(), InputError> {
        match of {
            Of::Regions => {}
            Of::Objects => {
                let places: Vec<usize> = (0..self.all.len())
                    .map(|object| graph.add_vertex(format!("object{object}"), self.attributes(object)))
                    .collect();
                for (part, polygons) in held {
                    let mut counts: BTreeMap<usize, u64> = BTreeMap::new();
                    polygons
                        .iter()
                        .for_each(|&polygon| *counts.entry(self.of_polygon[polygon as usize]).or_default() += 1);
                    for (object, count) in counts {
                        graph.add_edge(places[object], *part, vec![text("relation", IS_IN), whole("polygons", count)]);
                    }
                }
            }
            Of::Polygons if self.polygons.len() > MOST_POLYGONS => {
                let message = format!(
                    "a graph has at most {MOST_POLYGONS} polygons as vertices, and the scene has {}",
                    self.polygons.len()
                );
                return Err(InputError::new(message).help("ask for --graph-of objects"));
            }
            Of::Polygons => {
                let places: Vec<usize> =
                    (0..self.polygons.len() as u32).map(|polygon| self.add_polygon(graph, polygon)).collect();
                for (part, polygons) in held {
                    for &polygon in polygons {
                        let attributes = vec![text("relation", IS_IN), whole("polygons", 1)];
                        graph.add_edge(places[polygon as usize], *part, attributes);
                    }
                }
            }
        }
        Ok(())
    }

    fn add_polygon(&self, graph: &mut Graph, polygon: u32) -> usize {
        let mut attributes = vec![
            text("label", format!("polygon {polygon}")),
            text("kind", "polygon"),
            whole("object", self.of_polygon[polygon as usize] as u64),
            whole("corners", self.polygons.vertices(polygon).len() as u64),
        ];
        attributes.extend(of_box(&flat_bounds(self.polygons, polygon)));
        graph.add_vertex(format!("polygon{polygon}"), attributes)
    }
}

const IS_IN: &str = "is in";

/// An edge of contiguity: the area that two parts have in common, and the rays that pass through it in the edge's direction.
pub fn contiguous(area: f64, rays: u64) -> Attributes {
    vec![text("relation", "touches"), number("shared_area", area), whole("rays", rays)]
}
