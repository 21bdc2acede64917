//! A valve cut open.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3, dvec3};

use super::kit;
use super::{Builtin, Primitives};
use crate::scene::solid::{Shell, Solid};
use crate::scene::{Light, Material, Mesh, Scene};

/// A scene of our own: the body of a globe valve, made as a founder and a turner would, with a quarter cut away, and its
/// spindle. At size 2 the body is the outcome of 36 operations. The size factor is a quarter of the number of bolts in
/// each flange of the pipe.
pub const SCENE: Builtin = Builtin {
    name: "valve",
    about: "The body of a valve, cut open, with its spindle: a solid of some forty operations.",
    default_size: 2,
    size_range: 1..=6,
    default_resolution: Some(16),
    count: |size| Primitives { solids: (body(size, 3).leaves() + spindle(3).leaves()) as u64, ..Primitives::default() },
    build,
};

const CAST: u32 = 0;
const TURNED: u32 = 1;
const SECTION: u32 = 2;
const BRASS: u32 = 3;

fn build(size: u32, slices: u32) -> Scene {
    let materials = vec![
        kit::matt(Vec3::new(0.22, 0.34, 0.40), 1.0),
        Material { shine: 30.0, specular: 0.25, ..kit::matt(Vec3::new(0.62, 0.64, 0.66), 0.75) },
        kit::matt(Vec3::new(0.75, 0.16, 0.10), 0.95),
        Material { shine: 40.0, specular: 0.3, ..kit::matt(Vec3::new(0.85, 0.62, 0.22), 0.7) },
    ];
    let lights = vec![
        Light::point(Vec3::new(6.0, -14.0, 14.0), Vec3::splat(0.75)),
        Light::point(Vec3::new(-12.0, -10.0, 5.0), Vec3::splat(0.4)),
    ];
    let camera = kit::camera(dvec3(6.5, -14.5, 8.0), dvec3(0.1, 0.0, 1.15), DVec3::Z, 34.0);
    let solids = [body(size, slices), spindle(slices)];
    kit::scene_of_solids("valve", Mesh::default(), &solids, (materials, lights), camera, Vec3::new(0.75, 0.78, 0.8))
}

/// A casting, bored, with its seat, cut open, its flanges drilled.
fn body(size: u32, slices: u32) -> Solid {
    let hollow = Solid::Difference(vec![casting(slices), bores(slices)]);
    let mut parts = vec![Solid::Union(vec![hollow, seat(slices)])];
    // From left of the middle to the right, and in front of it.
    parts.push(kit::block(dvec3(-2.9, -6.0, -6.0), dvec3(6.0, 0.0, 6.0), SECTION));
    parts.extend(bolts(size, slices));
    Solid::Difference(parts)
}

/// A pipe along x with a bulge and a neck, and flanges at all ends.
fn casting(slices: u32) -> Solid {
    let rod = |base, along, radius| kit::rod(base, along, radius, slices, CAST);
    Solid::Union(vec![
        rod(dvec3(-4.0, 0.0, 0.0), DVec3::X * 8.0, 1.05),
        kit::ball(DVec3::ZERO, 1.9, slices, CAST),
        rod(DVec3::ZERO, DVec3::Z * 2.6, 1.0),
        rod(dvec3(-4.3, 0.0, 0.0), DVec3::X * 0.6, 2.0),
        rod(dvec3(3.7, 0.0, 0.0), DVec3::X * 0.6, 2.0),
        rod(DVec3::Z * 2.4, DVec3::Z * 0.5, 1.7),
    ])
}

/// What is taken out of the casting.
fn bores(slices: u32) -> Solid {
    Solid::Union(vec![
        kit::rod(dvec3(-5.0, 0.0, 0.0), DVec3::X * 10.0, 0.7, slices, TURNED),
        kit::ball(DVec3::ZERO, 1.55, slices, TURNED),
        kit::rod(DVec3::ZERO, DVec3::Z * 4.0, 0.65, slices, TURNED),
    ])
}

/// The wall between the two halves of the pipe: below on the left, level in the middle with the seat in it, above on the right.
fn seat(slices: u32) -> Solid {
    let wall = Solid::Union(vec![
        kit::block(dvec3(-1.2, -1.8, -0.15), dvec3(1.2, 1.8, 0.15), CAST),
        kit::block(dvec3(-1.3, -1.8, -0.1), dvec3(-1.05, 1.8, 1.8), CAST),
        kit::block(dvec3(1.05, -1.8, -1.8), dvec3(1.3, 1.8, 0.1), CAST),
    ]);
    let within = Solid::Intersection(vec![wall, kit::ball(DVec3::ZERO, 1.7, slices, CAST)]);
    Solid::Difference(vec![within, kit::rod(DVec3::Z * -0.5, DVec3::Z, 0.62, slices, TURNED)])
}

/// The holes for bolts: `4 size` in each flange of the pipe, six in that of the neck.
fn bolts(size: u32, slices: u32) -> Vec<Solid> {
    let hole = |base, along| kit::rod(base, along, 0.17, slices / 2 + 3, TURNED);
    let around = |count: u32| (0..count).map(move |bolt| (TAU * (f64::from(bolt) + 0.5) / f64::from(count)).sin_cos());
    let pipe =
        [-4.6, 3.4].into_iter().flat_map(|x| around(4 * size).map(move |(sin, cos)| dvec3(x, 1.6 * sin, 1.6 * cos)));
    let neck = around(6).map(|(sin, cos)| dvec3(1.35 * sin, 1.35 * cos, 2.1));
    pipe.map(|base| hole(base, DVec3::X * 1.2)).chain(neck.map(|base| hole(base, DVec3::Z * 1.1))).collect()
}

/// A plug that closes the seat, its stem, and a hand wheel.
fn spindle(slices: u32) -> Solid {
    let rod = |base, along, radius| kit::rod(base, along, radius, slices / 2 + 3, BRASS);
    let hub = DVec3::Z * 4.6;
    Solid::Union(vec![
        kit::round(Shell::cone(slices), DVec3::Z * 0.75, -DVec3::Z, dvec3(0.9, 0.9, 1.0), BRASS),
        rod(DVec3::Z * 0.6, DVec3::Z * 4.2, 0.22),
        kit::round(Shell::torus(0.12, 2 * slices), hub, DVec3::Z, DVec3::splat(1.3), BRASS),
        rod(hub - DVec3::X * 1.3, DVec3::X * 2.6, 0.1),
        rod(hub - DVec3::Y * 1.3, DVec3::Y * 2.6, 0.11),
    ])
}
