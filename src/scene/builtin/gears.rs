//! Gears that mesh.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::{Material, Mesh, Scene, split_concave};

/// As the Standard Procedural Databases define it: a cube of meshing gears above a mirroring ground. A gear has 36
/// teeth, two concave faces of 144 corners and a rectangle for each of their edges; every fifth gear or so is of glass.
/// Five lights.
///
/// The concave faces are cut into triangles, which carry the number of the face that they are pieces of.
pub const SCENE: Builtin = Builtin {
    name: "gears",
    about: "A cube of meshing gears, some of glass, above a mirroring ground.",
    default_size: 4,
    size_range: 1..=20,
    default_resolution: None,
    count: |size| Primitives { polygons: 1 + u64::from(size).pow(3) * (2 + CORNERS as u64), ..Primitives::default() },
    build: |size, _| build(size),
};

const TEETH: usize = 36;
const CORNERS: usize = 4 * TEETH;

/// Share of the radius that teeth take.
const TOOTH: f64 = 0.1;

/// What the teeth's outer radius is to the full one, so that gears do not touch.
const PLAY: f64 = 0.995;

fn build(size: u32) -> Scene {
    let mut mesh = Mesh::default();
    let mut materials = vec![kit::shiny(Vec3::new(1.0, 0.85, 0.7), 0.3, 0.6, 37.0)];
    kit::ground(&mut mesh, 2.0, 0.0, 0);
    let gear = Gear::new(size);
    for z in 0..size {
        for y in 0..size {
            for x in 0..size {
                gear.add(&mut mesh, [x, y, z], materials.len() as u32);
                materials.push(material(x, y, z));
            }
        }
    }
    let (mesh, report) = split_concave(mesh);
    let lights = kit::lights([
        dvec3(2.0, 4.0, 4.0),
        dvec3(-2.0, 4.0, 3.0),
        dvec3(2.0, -2.5, 2.5),
        dvec3(-1.0, -4.0, 2.0),
        dvec3(-1.111, -2.121, 2.626),
    ]);
    let camera = kit::camera(dvec3(-1.1, -2.1, 2.6), DVec3::ZERO, DVec3::Z, 45.0);
    let mut scene = kit::scene("gears", mesh, materials, lights, camera, kit::SKY);
    scene.notes = report.notes();
    scene
}

/// A colour that changes from gear to gear, its strongest part full; some gears are of glass.
fn material(x: u32, y: u32, z: u32) -> Material {
    let part = |a: u32, b: u32, c: u32, step: u32| 0.01 + f64::from((a * 3 + b * 2 + c + 1) * step % 7) / 7.0;
    let color = dvec3(part(x, y, z, 5), part(y, z, x, 3), part(z, x, y, 2));
    let color = (color / color.max_element()).as_vec3();
    if (x * 4 + y * 2 + z).is_multiple_of(5) {
        Material { transmittance: 0.8, refraction: 1.1, ..kit::matt(color, 0.2) }
    } else {
        kit::matt(color, 1.0)
    }
}

/// The measures of all gears.
struct Gear {
    radius: f64,
    thickness: f64,
    layer: f64,
}

impl Gear {
    fn new(size: u32) -> Self {
        let size = f64::from(size);
        let radius = 1.0 / (size - (size - 1.0) * TOOTH / 2.0);
        Gear { radius, thickness: (0.5 / size).min(0.1), layer: 1.0 / size }
    }

    /// Adds the gear at a place in the cube; every second is turned by half a tooth, so that they mesh.
    fn add(&self, mesh: &mut Mesh, [x, y, z]: [u32; 3], material: u32) {
        let across = |k: u32| -1.0 + self.radius + f64::from(k) * self.radius * (2.0 - TOOTH);
        mesh.begin_object();
        let center = dvec3(across(x), across(y), 1.0 - f64::from(z) * self.layer);
        let turn = PI * f64::from((x + y + z) % 2) / TEETH as f64;
        let mut ring = |z: f64| -> Vec<u32> {
            (0..CORNERS).map(|i| mesh.add_point((center + self.corner(i, turn) + DVec3::Z * z).as_vec3())).collect()
        };
        let (top, mut bottom) = (ring(0.0), ring(-self.thickness));
        mesh.add_face(&top, material);
        for i in 0..CORNERS {
            let next = (i + 1) % CORNERS;
            mesh.add_face(&[top[i], bottom[i], bottom[next], top[next]], material);
        }
        bottom.rotate_left(2);
        bottom.reverse();
        mesh.add_face(&bottom, material);
    }

    /// A corner of a gear's outline: two at the tip of a tooth, two at its foot.
    fn corner(&self, i: usize, turn: f64) -> DVec3 {
        let (share, radius) = match i % 4 {
            0 => (-0.19, PLAY),
            1 => (0.19, PLAY),
            2 => (0.3, 1.0 - TOOTH),
            _ => (0.7, 1.0 - TOOTH),
        };
        let (sin, cos) = (turn + TAU * ((i / 4) as f64 + share) / TEETH as f64).sin_cos();
        dvec3(cos, sin, 0.0) * radius * self.radius
    }
}
