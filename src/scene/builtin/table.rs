//! The table of Argence's thesis.

use glam::{DAffine3, DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::solid::Solid;
use crate::scene::{Light, Mesh, Scene};

/// The example of the language Castor (Argence's thesis, chapter 5, section 1.1): a top and four legs, three of which touch it
/// only along an edge or in a corner. The size factor is the number of tables in a row, and of rows, on a floor of our own.
pub const SCENE: Builtin = Builtin {
    name: "table",
    about: "The table of Argence's thesis, a union of five boxes, on a floor.",
    default_size: 1,
    size_range: 1..=10,
    default_resolution: None,
    count: |size| Primitives {
        polygons: 1,
        solids: tables(size).iter().map(|table| table.leaves() as u64).sum(),
        ..Primitives::default()
    },
    build: |size, _| build(size),
};

const FLOOR: u32 = 0;
const TABLE: u32 = 1;

/// How far a table is from the next, to the right and to the back.
const APART: DVec3 = dvec3(10.0, 8.0, 0.0);

fn build(size: u32) -> Scene {
    let mut mesh = Mesh::default();
    let middle = dvec3(3.5, 2.5, 0.0) + APART * (f64::from(size) - 1.0) / 2.0;
    let half = 8.0 + 5.0 * f64::from(size);
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    kit::polygon(&mut mesh, &corners.map(|[x, y]| middle + dvec3(x * half, y * half, -3.5)), FLOOR);
    let materials = vec![
        kit::matt(Vec3::new(0.5, 0.52, 0.48), 0.9),
        // 180, 90, 80 in the thesis.
        kit::matt(Vec3::new(0.456, 0.102, 0.080), 1.0),
    ];
    let lights = vec![
        Light::point(Vec3::new(14.0, -12.0, 16.0), Vec3::splat(0.75)),
        Light::point(Vec3::new(-10.0, -14.0, 9.0), Vec3::splat(0.45)),
    ];
    let away = dvec3(9.5, -13.5, 7.0) * (0.6 + 0.4 * f64::from(size));
    let camera = kit::camera(middle + away, middle - DVec3::Z * 1.3, DVec3::Z, 36.0);
    kit::scene_of_solids("table", mesh, &tables(size), (materials, lights), camera, Vec3::new(0.35, 0.45, 0.6))
}

fn tables(size: u32) -> Vec<Solid> {
    let places = (0..size * size).map(|number| APART * dvec3(f64::from(number % size), f64::from(number / size), 0.0));
    places.map(|place| table().placed(DAffine3::from_translation(place))).collect()
}

/// In the thesis's words: a top, and a leg four times.
fn table() -> Solid {
    let top = kit::block(DVec3::ZERO, dvec3(7.0, 5.0, 0.5), TABLE);
    let leg = |x: f64, y: f64| kit::block(dvec3(x, y, -3.5), dvec3(x + 0.1, y + 0.1, 0.0), TABLE);
    Solid::Union(vec![top, leg(0.0, 0.0), leg(7.0, 0.0), leg(7.0, 5.0), leg(0.0, 5.0)])
}
