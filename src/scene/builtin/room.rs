//! A room to teach with.

use glam::{DVec3, Vec3, dvec3};

use super::kit;
use super::noise::unit;
use super::{Builtin, Primitives};
use crate::scene::{Light, Material, Mesh, Scene};

/// A scene of our own: a room of 6 by 4 by 3 metres, all of whose 45 polygons at size 1 are rectangles parallel to the
/// axes, so that a partition of space can be followed by hand. There are a floor, a ceiling, three walls and one with a
/// window, of four parts; a table of five boxes; and along one wall as many boxes, a cupboard or a pile, as the size
/// factor says. One light below the ceiling, one outside.
pub const SCENE: Builtin = Builtin {
    name: "room",
    about: "A small room with a window, a table and boxes, all of axis-parallel rectangles: a scene to teach with.",
    default_size: 1,
    size_range: 1..=100_000,
    default_resolution: None,
    count: |size| Primitives { polygons: 9 + 5 * 6 + 6 * u64::from(size), ..Primitives::default() },
    build: |size, _| build(size),
};

/// The corner opposite to the origin.
const ROOM: DVec3 = dvec3(6.0, 4.0, 3.0);

const WALL: u32 = 0;
const FLOOR: u32 = 1;
const CEILING: u32 = 2;
const TABLE: u32 = 3;
const FIRST_BOX: u32 = 4;
const BOX_COLORS: [[f32; 3]; 4] = [[0.75, 0.2, 0.15], [0.2, 0.45, 0.7], [0.85, 0.65, 0.2], [0.3, 0.6, 0.3]];

fn build(size: u32) -> Scene {
    let mut mesh = Mesh::default();
    walls(&mut mesh);
    window_wall(&mut mesh);
    table(&mut mesh);
    boxes(&mut mesh, size);
    let camera = kit::camera(dvec3(0.3, 0.3, 1.8), dvec3(3.9, 2.5, 0.95), DVec3::Z, 62.0);
    let lamp = Light::point(Vec3::new(2.2, 1.8, 2.5), Vec3::new(0.75, 0.72, 0.65));
    let sun = Light::point(Vec3::new(12.0, -1.0, 7.0), Vec3::new(0.6, 0.6, 0.55));
    kit::scene("room", mesh, materials(), vec![lamp, sun], camera, Vec3::new(0.55, 0.75, 0.95))
}

fn materials() -> Vec<Material> {
    let boxes = BOX_COLORS.map(|color| kit::matt(Vec3::from(color), 0.9));
    let rest = [[0.9, 0.88, 0.82], [0.5, 0.35, 0.22], [0.95, 0.95, 0.95], [0.6, 0.42, 0.25]];
    rest.map(|color| kit::matt(Vec3::from(color), 0.9)).into_iter().chain(boxes).collect()
}

/// Floor, ceiling and the three walls without a window, seen from inside.
fn walls(mesh: &mut Mesh) {
    let (x, y, z) = (DVec3::X * ROOM.x, DVec3::Y * ROOM.y, DVec3::Z * ROOM.z);
    kit::polygon(mesh, &[DVec3::ZERO, x, x + y, y], FLOOR);
    kit::polygon(mesh, &[z, z + y, z + x + y, z + x], CEILING);
    kit::polygon(mesh, &[DVec3::ZERO, z, z + x, x], WALL);
    kit::polygon(mesh, &[y, x + y, x + y + z, y + z], WALL);
    kit::polygon(mesh, &[DVec3::ZERO, y, y + z, z], WALL);
}

/// The wall at the far end of x: below, above and on both sides of the window.
fn window_wall(mesh: &mut Mesh) {
    let (left, right, sill, lintel) = (2.2, 0.9, 1.0, 2.3);
    let mut part = |y: [f64; 2], z: [f64; 2]| {
        let corners = [(y[0], z[0]), (y[0], z[1]), (y[1], z[1]), (y[1], z[0])];
        kit::polygon(mesh, &corners.map(|(y, z)| dvec3(ROOM.x, y, z)), WALL);
    };
    part([0.0, ROOM.y], [0.0, sill]);
    part([0.0, ROOM.y], [lintel, ROOM.z]);
    part([0.0, right], [sill, lintel]);
    part([left, ROOM.y], [sill, lintel]);
}

fn table(mesh: &mut Mesh) {
    let (low, high, height) = (dvec3(2.6, 0.7, 0.0), dvec3(4.4, 1.7, 0.0), 0.75);
    let top = 0.05;
    kit::cuboid(mesh, low + DVec3::Z * (height - top), high + DVec3::Z * height, TABLE);
    let leg = dvec3(0.08, 0.08, height - top);
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let corner = low + (high - low - leg.with_z(0.0)) * dvec3(x, y, 0.0);
        kit::cuboid(mesh, corner, corner + leg, TABLE);
    }
}

/// Piles `count` boxes along a wall, layer by layer; a box fills its cell in height, so that each stands on another.
fn boxes(mesh: &mut Mesh, count: u32) {
    let side = (1..).find(|side| side * side * side >= count).unwrap_or(count);
    let low = dvec3(2.8, 2.8, 0.0);
    let cell = dvec3(3.0, 1.1, 1.8) / f64::from(side);
    for number in 0..count {
        let place = dvec3(f64::from(number % side), f64::from(number / side % side), f64::from(number / (side * side)));
        let share = |lane: u32| 0.5 + 0.4 * unit(7, [number as i32, lane as i32]);
        let margin = dvec3(1.0 - share(0), 1.0 - share(1), 0.0) * cell / 2.0;
        let corner = low + place * cell;
        let color = (unit(8, [number as i32, 0]) * BOX_COLORS.len() as f64) as u32;
        kit::cuboid(mesh, corner + margin, corner + cell - margin, FIRST_BOX + color);
    }
}
