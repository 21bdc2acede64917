//! The houses of the reference scene.

use glam::{DVec2, DVec3, dvec2};

use super::stuff::Stuff;
use crate::scene::Mesh;
use crate::scene::builtin::kit::polygon;
use crate::scene::builtin::noise::{ramp, unit};

/// Polygons of a house: four walls, a roof of two, a chimney of five, a door and two windows.
pub const HOUSE_FACES: u32 = 14;

/// Height of the village's ground.
pub const LEVEL: f64 = 1.0;

const MIDDLE: DVec2 = dvec2(-13.0, 6.0);

/// How much the ground is made even for the village: 1 among the houses, 0 away from them.
pub fn ground(at: DVec2) -> f64 {
    1.0 - ramp(13.0, 20.0, from_middle(at))
}

/// Distance from the village's middle; the village is a little wider than deep.
fn from_middle(at: DVec2) -> f64 {
    ((at - MIDDLE) / dvec2(1.3, 0.8)).length()
}

/// Adds `count` houses, those nearest to the village's middle first.
pub fn add(mesh: &mut Mesh, count: u32) {
    let mut places: Vec<[i32; 2]> = (-12..=12).flat_map(|x| (-12..=12).map(move |y| [x, y])).collect();
    let middle = |&[x, y]: &[i32; 2]| MIDDLE + dvec2(f64::from(x) * 2.5, f64::from(y) * 2.1);
    places.sort_by(|a, b| from_middle(middle(a)).total_cmp(&from_middle(middle(b))));
    for place in places.iter().take(count as usize) {
        house(mesh, *place, middle(place));
    }
}

/// A house's own axes: along the ridge, across it, and up.
struct House {
    middle: DVec3,
    along: DVec3,
    across: DVec3,
}

impl House {
    fn at(&self, along: f64, across: f64, up: f64) -> DVec3 {
        self.middle + self.along * along + self.across * across + DVec3::Z * up
    }
}

fn house(mesh: &mut Mesh, place: [i32; 2], middle: DVec2) {
    let random = |lane: u64| unit(100 + lane, place);
    let (sin, cos) = (0.5 * random(0) - 0.25 + if random(1) < 0.3 { 1.5 } else { 0.0 }).sin_cos();
    let shift = dvec2(random(2) - 0.5, random(3) - 0.5) * 0.4;
    let house = House {
        middle: (middle + shift).extend(LEVEL - 0.05),
        along: dvec2(cos, sin).extend(0.0),
        across: dvec2(-sin, cos).extend(0.0),
    };
    let (length, width) = (0.7 + 0.25 * random(4), 0.5 + 0.15 * random(5));
    let (eaves, ridge) = (0.9 + 0.5 * random(6), 1.6 + 0.6 * random(7));
    let wall = if random(8) < 0.7 { Stuff::Plaster } else { Stuff::Brick };
    walls(mesh, &house, [length, width, eaves, ridge], wall);
    roof(mesh, &house, [length, width, eaves, ridge]);
    chimney(mesh, &house, [eaves, ridge]);
    openings(mesh, &house, [length, width]);
}

/// Two long walls and two gables.
fn walls(mesh: &mut Mesh, house: &House, [length, width, eaves, ridge]: [f64; 4], wall: Stuff) {
    for side in [1.0, -1.0] {
        let (l, w) = (length * side, width * side);
        let long = [house.at(-l, -w, 0.0), house.at(l, -w, 0.0), house.at(l, -w, eaves), house.at(-l, -w, eaves)];
        polygon(mesh, &long, wall.index());
        let gable = [
            house.at(l, -w, 0.0),
            house.at(l, w, 0.0),
            house.at(l, w, eaves),
            house.at(l, 0.0, ridge),
            house.at(l, -w, eaves),
        ];
        polygon(mesh, &gable, wall.index());
    }
}

/// Two sloping rectangles that overhang the gables.
fn roof(mesh: &mut Mesh, house: &House, [length, width, eaves, ridge]: [f64; 4]) {
    for side in [1.0, -1.0] {
        let (l, w) = (1.12 * length * side, width * side);
        // A little above the walls, or the roof would cut into the gables' edges.
        let lift = 0.03;
        let slope = [
            house.at(-l, -w, eaves + lift),
            house.at(l, -w, eaves + lift),
            house.at(l, 0.0, ridge + lift),
            house.at(-l, 0.0, ridge + lift),
        ];
        polygon(mesh, &slope, Stuff::Roof.index());
    }
}

/// A chimney of four sides and a top, which grows out of the roof.
fn chimney(mesh: &mut Mesh, house: &House, [eaves, ridge]: [f64; 2]) {
    let (half, low, high) = (0.1, eaves, ridge + 0.35);
    let corners = [(half, half), (-half, half), (-half, -half), (half, -half)];
    let ring = |up: f64| corners.map(|(along, across)| house.at(0.3 + along, 0.15 + across, up));
    let (bottom, top) = (ring(low), ring(high));
    for i in 0..4 {
        let next = (i + 1) % 4;
        polygon(mesh, &[bottom[i], bottom[next], top[next], top[i]], Stuff::Brick.index());
    }
    polygon(mesh, &top, Stuff::Dark.index());
}

/// A door in one long wall, a window in each, just in front of the wall.
fn openings(mesh: &mut Mesh, house: &House, [length, width]: [f64; 2]) {
    let mut opening = |side: f64, middle: f64, half: f64, [low, high]: [f64; 2]| {
        let (across, left, right) = (-(width + 0.02) * side, (middle - half) * side, (middle + half) * side);
        let corners = [(left, low), (right, low), (right, high), (left, high)];
        polygon(mesh, &corners.map(|(along, up)| house.at(along, across, up)), Stuff::Dark.index());
    };
    opening(1.0, -0.4 * length, 0.14, [0.0, 0.6]);
    opening(1.0, 0.35 * length, 0.17, [0.35, 0.7]);
    opening(-1.0, 0.0, 0.17, [0.35, 0.7]);
}
