//! The reference image's scene.

mod forest;
mod lake;
mod land;
mod stuff;
mod village;

use glam::{DVec3, Vec3, dvec3};

use super::kit;
use super::teapot;
use super::{Builtin, Primitives};
use crate::scene::{Light, Mesh, Scene};

/// A scene of our own: what stands for the paper's reference image of 100 000 polygons, of which the paper says no more
/// than the count. It has exactly a thousand polygons for each unit of the size factor, 100 000 by default.
///
/// A camera at the near shore looks over a lake to a village before snow-covered mountains, all 100 by 100 units wide.
/// All rays start within the scene. Of the default's polygons
///
/// - 45 000 are triangles of the ground, sand, grass, rock and snow by height and slope,
/// - 1 960 make 140 houses with gables, chimneys, doors and windows,
/// - 4 032 make a teapot, on a terrace of 64 tiles and 4 sides in the lake,
/// - 3 528 make nine mirroring balls, one ball that hops over the lake to the terrace, nine times,
/// - 1 is the water,
/// - 45 390 make 1 513 trees of 30 polygons, firs, and round trees with a bush at their foot,
/// - 21 are paper gliders: what is left.
///
/// Other sizes keep these shares as nearly as whole houses and trees allow; from a size of 98 on the village grows no
/// more.
pub const SCENE: Builtin = Builtin {
    name: "reference",
    about: "A lake with a teapot, a village, woods and mountains: exactly 100 000 polygons, as the paper's image has.",
    default_size: 100,
    size_range: 1..=2000,
    default_resolution: None,
    count: |size| Primitives { polygons: u64::from(size) * 1000, ..Primitives::default() },
    build: |size, _| build(size),
};

const EYE: DVec3 = dvec3(0.0, -47.0, 8.5);

fn build(size: u32) -> Scene {
    let shares = Shares::new(size * 1000);
    let mut mesh = Mesh::default();
    land::add(&mut mesh, shares.cells);
    lake::add(&mut mesh, shares.pot_steps, shares.ball_slices);
    village::add(&mut mesh, shares.houses);
    forest::add(&mut mesh, shares.trees);
    lake::gliders(&mut mesh, shares.gliders);
    let sun = Light::point(Vec3::new(-90.0, -80.0, 80.0), Vec3::new(0.9, 0.82, 0.68));
    let sky = Light::point(Vec3::new(60.0, -60.0, 120.0), Vec3::new(0.2, 0.25, 0.35));
    let camera = kit::camera(EYE, dvec3(0.0, -10.0, 1.0), DVec3::Z, 45.0);
    kit::scene("reference", mesh, stuff::materials(), vec![sun, sky], camera, Vec3::new(0.45, 0.62, 0.85))
}

/// How many polygons go where.
struct Shares {
    /// Squares along a side of the ground, of two triangles each.
    cells: u32,
    houses: u32,
    pot_steps: u32,
    ball_slices: u32,
    trees: u32,
    gliders: u32,
}

impl Shares {
    fn new(total: u32) -> Self {
        let cells = (total * 9 / 40).isqrt();
        let houses = (total / 700).clamp(1, 140);
        let pot_steps = (3..).find(|&steps| teapot::faces(steps) > u64::from(total / 24)).map_or(2, |steps| steps - 1);
        let ball_slices = ((total / 450).isqrt() * 2).max(4);
        let used = 2 * cells * cells
            + houses * village::HOUSE_FACES
            + teapot::faces(pot_steps) as u32
            + lake::ball_faces(ball_slices)
            + lake::FIXED_FACES;
        let left = total - used;
        Shares {
            cells,
            houses,
            pot_steps,
            ball_slices,
            trees: left / forest::TREE_FACES,
            gliders: left % forest::TREE_FACES,
        }
    }
}
