//! What stands in the reference scene's lake, and flies above it.

use glam::{DAffine3, DMat3, DVec3, dvec3};

use super::stuff::Stuff;
use crate::scene::Mesh;
use crate::scene::builtin::kit::{polygon, sphere};
use crate::scene::builtin::noise::unit;
use crate::scene::builtin::teapot;

/// The water, and the terrace's tiles and sides.
pub const FIXED_FACES: u32 = 1 + TILES * TILES + 4;

const BALLS: u32 = 9;
const TILES: u32 = 8;

/// The middle of the terrace's floor, and half a side.
const TERRACE: DVec3 = dvec3(5.8, -19.0, 0.5);
const TERRACE_HALF: f64 = 5.5;

/// How many polygons all balls have together.
pub fn ball_faces(slices: u32) -> u32 {
    BALLS * slices * (slices / 2)
}

/// Adds the water, the terrace with its teapot, and the balls.
pub fn add(mesh: &mut Mesh, pot_steps: u32, ball_slices: u32) {
    let corners = [(-24.0, -36.0), (28.0, -36.0), (28.0, 1.0), (-24.0, 1.0)];
    polygon(mesh, &corners.map(|(x, y)| dvec3(x, y, 0.0)), Stuff::Water.index());
    terrace(mesh);
    let turn = DMat3::from_rotation_z(-0.5) * 1.25;
    let place = DAffine3::from_mat3_translation(turn, TERRACE + DVec3::Z * 0.01);
    teapot::pot(mesh, pot_steps, place, Stuff::Gold.index());
    for ball in 0..BALLS {
        sphere(mesh, hop(ball), 0.6, ball_slices, Stuff::Mirror.index());
    }
}

/// Where the hopping ball is at a step: three hops, each lower than the one before.
fn hop(step: u32) -> DVec3 {
    let phase = f64::from(step % 3) / 3.0 + 1.0 / 6.0;
    let height = 4.5 * 0.65f64.powi((step / 3) as i32);
    let up = 4.0 * phase * (1.0 - phase) * height;
    dvec3(-7.6 + 0.98 * f64::from(step), -28.0 + 0.8 * f64::from(step), 0.5 + up)
}

fn terrace(mesh: &mut Mesh) {
    let at = |x: u32, y: u32, z: f64| {
        let place = |k: u32| TERRACE_HALF * (2.0 * f64::from(k) / f64::from(TILES) - 1.0);
        dvec3(TERRACE.x + place(x), TERRACE.y + place(y), z)
    };
    for x in 0..TILES {
        for y in 0..TILES {
            let tile = if (x + y) % 2 == 0 { Stuff::WhiteTile } else { Stuff::BlackTile };
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            polygon(mesh, &corners.map(|(x, y)| at(x, y, TERRACE.z)), tile.index());
        }
    }
    let corners = [(0, 0), (TILES, 0), (TILES, TILES), (0, TILES)];
    for i in 0..4 {
        let ((x, y), (next_x, next_y)) = (corners[i], corners[(i + 1) % 4]);
        let low = -1.5;
        let side = [at(x, y, low), at(next_x, next_y, low), at(next_x, next_y, TERRACE.z), at(x, y, TERRACE.z)];
        polygon(mesh, &side, Stuff::Plaster.index());
    }
}

/// Adds paper gliders, triangles in the air above the lake.
pub fn gliders(mesh: &mut Mesh, count: u32) {
    for number in 0..count {
        let random = |lane: i32| unit(300, [number as i32, lane]);
        let middle = dvec3(32.0 * random(0) - 16.0, 24.0 * random(1) - 24.0, 7.0 + 5.0 * random(2));
        let (sin, cos) = (6.0 * random(3)).sin_cos();
        let (ahead, aside) = (dvec3(cos, sin, 0.15), dvec3(-sin, cos, 0.6 * random(4) - 0.3));
        polygon(mesh, &[middle + ahead * 0.7, middle + aside * 0.3, middle - aside * 0.3], Stuff::Paper.index());
    }
}
