//! A room with windows of stained glass.

use glam::{DAffine3, DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::solid::{Shell, Solid};
use crate::scene::{Light, Material, Mesh, Scene};

/// A scene of our own, after the seventh picture of Argence's thesis, a room with a stained-glass window: a hollow shell, so
/// that its inside needs no operation, cut by arched windows with coloured panes, as many as the size factor says; two
/// columns, a font and a bench. One light inside, one outside.
pub const SCENE: Builtin = Builtin {
    name: "chapel",
    about: "A hollow room with arched windows of stained glass, columns, a font and a bench: all solids.",
    default_size: 3,
    size_range: 1..=8,
    default_resolution: Some(12),
    count: |size| Primitives {
        solids: solids(size, 3).iter().map(|solid| solid.leaves() as u64).sum(),
        ..Primitives::default()
    },
    build,
};

const WALL: u32 = 0;
const REVEAL: u32 = 1;
const STONE: u32 = 2;
const WOOD: u32 = 3;
const WATER: u32 = 4;
const FIRST_GLASS: u32 = 5;
const GLASS_COLORS: [[f32; 3]; 4] = [[0.85, 0.12, 0.10], [0.12, 0.25, 0.80], [0.90, 0.70, 0.10], [0.10, 0.55, 0.20]];

/// The room within, from the origin.
const ROOM: DVec3 = dvec3(8.0, 5.0, 4.0);
/// How thick its walls are.
const THICK: f64 = 0.3;

fn build(size: u32, slices: u32) -> Scene {
    let plain = [[0.82, 0.78, 0.70], [0.9, 0.88, 0.85], [0.62, 0.60, 0.58], [0.45, 0.28, 0.15]];
    let mut materials: Vec<Material> = plain.map(|color| kit::matt(Vec3::from(color), 0.9)).to_vec();
    materials.push(Material { specular: 0.5, shine: 60.0, ..kit::matt(Vec3::new(0.12, 0.25, 0.28), 0.5) });
    materials.extend(GLASS_COLORS.map(|color| Material { transmittance: 0.6, ..kit::matt(Vec3::from(color), 0.4) }));
    let lights = vec![
        Light::point(Vec3::new(2.2, 1.2, 3.4), Vec3::new(0.7, 0.66, 0.58)),
        Light::point(Vec3::new(3.0, 16.0, 9.0), Vec3::splat(0.5)),
    ];
    let camera = kit::camera(dvec3(0.35, 0.35, 1.9), dvec3(5.0, 3.6, 1.45), DVec3::Z, 64.0);
    kit::scene_of_solids(
        "chapel",
        Mesh::default(),
        &solids(size, slices),
        (materials, lights),
        camera,
        Vec3::new(0.6, 0.75, 0.95),
    )
}

fn solids(size: u32, slices: u32) -> Vec<Solid> {
    let windows: Vec<Window> = (0..size).map(|number| Window::new(number, size)).collect();
    let panes = windows.iter().map(|window| window.panes(slices));
    let rest = [column(dvec3(2.6, 3.9, 0.0), slices), column(dvec3(5.4, 3.9, 0.0), slices), font(slices), bench()];
    std::iter::once(shell(&windows, slices)).chain(panes).chain(rest).collect()
}

/// The walls: a hollow box, less the windows and a door.
fn shell(windows: &[Window], slices: u32) -> Solid {
    let outer = ROOM + 2.0 * THICK;
    // The factors are between 0 and 1, and the centre of a box sees all of it.
    let hollow = Shell::cube().of_material(WALL).hollow(ROOM / outer).unwrap_or_default();
    let map = DAffine3::from_translation(DVec3::splat(-THICK)) * DAffine3::from_scale(outer);
    let mut parts = vec![Solid::leaf(hollow).placed(map)];
    parts.extend(windows.iter().map(|window| window.opening((4.5, 1.5), 0.0, slices, REVEAL)));
    parts.push(kit::block(dvec3(7.5, 1.2, 0.12), dvec3(9.0, 2.6, 2.5), REVEAL));
    Solid::Difference(parts)
}

/// An arched window in the wall at the far end of y.
struct Window {
    /// Its middle.
    x: f64,
    half: f64,
}

impl Window {
    /// From the floor to the sill, and to where the arch begins.
    const SILL: f64 = 1.0;
    const SPRING: f64 = 2.5;

    fn new(number: u32, of: u32) -> Window {
        let share = ROOM.x / f64::from(of);
        Window { x: share * (f64::from(number) + 0.5), half: (0.3 * share).min(0.75) }
    }

    /// What is seen through it: from `y` on, so deep, and larger all round by a margin.
    fn opening(&self, (y, deep): (f64, f64), margin: f64, slices: u32, material: u32) -> Solid {
        let (left, right) = (self.x - self.half - margin, self.x + self.half + margin);
        let block = kit::block(dvec3(left, y, Self::SILL - margin), dvec3(right, y + deep, Self::SPRING), material);
        let arch = kit::rod(dvec3(self.x, y, Self::SPRING), DVec3::Y * deep, self.half + margin, 2 * slices, material);
        Solid::Union(vec![block, arch])
    }

    /// Its panes: coloured boxes, two by four, of which the arch leaves what fits. They reach a little into the wall.
    fn panes(&self, slices: u32) -> Solid {
        let size = dvec3(self.half + 0.05, 0.04, 0.65);
        let low = dvec3(self.x - size.x, ROOM.y + 0.1, Self::SILL - 0.1);
        let panes = (0..8u32).map(|pane| {
            let corner = low + size * dvec3(f64::from(pane % 2), 0.0, f64::from(pane / 2));
            kit::block(corner, corner + size, FIRST_GLASS + (pane % 2 + 3 * (pane / 2)) % 4)
        });
        let frame = self.opening((ROOM.y + 0.05, 0.14), 0.03, slices, STONE);
        Solid::Intersection(vec![Solid::Union(panes.collect()), frame])
    }
}

/// A shaft on a plinth, with rings at foot and head.
fn column(foot: DVec3, slices: u32) -> Solid {
    let ring = |z: f64| kit::round(Shell::torus(0.3, slices), foot + DVec3::Z * z, DVec3::Z, DVec3::splat(0.24), STONE);
    let slab = |z: f64| kit::block(foot + dvec3(-0.34, -0.34, z), foot + dvec3(0.34, 0.34, z + 0.2), STONE);
    let shaft = kit::rod(foot + DVec3::Z * 0.1, DVec3::Z * (ROOM.z - 0.2), 0.22, slices, STONE);
    Solid::Union(vec![shaft, slab(0.0), slab(ROOM.z - 0.2), ring(0.25), ring(ROOM.z - 0.25)])
}

/// A bowl of water on a stem.
fn font(slices: u32) -> Solid {
    let middle = dvec3(5.6, 2.0, 1.0);
    let bowl = Solid::Difference(vec![
        kit::ball(middle, 0.5, 2 * slices, STONE),
        kit::block(middle + dvec3(-1.0, -1.0, 0.05), middle + dvec3(1.0, 1.0, 1.0), STONE),
        kit::ball(middle + DVec3::Z * 0.12, 0.42, 2 * slices, STONE),
    ]);
    let water = kit::rod(middle - DVec3::Z * 0.2, DVec3::Z * 0.17, 0.42, 2 * slices, WATER);
    let stem = kit::round(Shell::cone(slices), middle.with_z(0.0), DVec3::Z, dvec3(0.4, 0.4, 1.1), STONE);
    Solid::Union(vec![bowl, water, stem])
}

/// A seat with its back, on two legs, the back pierced.
fn bench() -> Solid {
    let part = |low: [f64; 3], high: [f64; 3]| kit::block(DVec3::from(low), DVec3::from(high), WOOD);
    let whole = Solid::Union(vec![
        part([2.6, 1.6, 0.42], [4.4, 2.1, 0.5]),
        part([2.7, 1.65, 0.0], [2.8, 2.05, 0.45]),
        part([4.2, 1.65, 0.0], [4.3, 2.05, 0.45]),
        part([2.6, 2.04, 0.45], [4.4, 2.1, 1.1]),
    ]);
    let holes = (0..5).map(|hole| {
        let x = 2.8 + 0.3 * f64::from(hole);
        part([x, 1.9, 0.65], [x + 0.2, 2.3, 0.95])
    });
    Solid::Difference(std::iter::once(whole).chain(holes).collect())
}
