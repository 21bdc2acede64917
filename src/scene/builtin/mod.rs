//! Scenes that are generated: those of the Standard Procedural Databases, and five of our own.
//!
//! The Standard Procedural Databases (Eric Haines and others, 1987 to 1995) are programs that write test scenes for ray
//! tracers; a size factor sets how many primitives. The modules here follow their published definitions: shapes, order
//! of primitives, camera, lights, background and materials. Spheres, cones and cylinders are cut into polygons.
//!
//! All coordinates are worked out in double precision and rounded once. Sines, exponentials and logarithms come from
//! the platform's library, so the last bit of a coordinate may differ from one platform to another; on one machine the
//! same name, size and resolution always give the same bits.
//!
//! | name      | default size | primitives at that size          |
//! | --------- | -----------: | -------------------------------- |
//! | balls     |            4 | 7 381 spheres, 1 polygon         |
//! | gears     |            4 | 9 345 polygons, 128 of them concave |
//! | lattice   |           12 | 2 197 spheres, 6 084 cylinders   |
//! | mountain  |            6 | 8 192 polygons, 4 spheres        |
//! | rings     |            7 | 4 200 spheres, 4 200 cylinders, 1 polygon |
//! | shells    |            5 | 5 761 spheres                    |
//! | sombrero  |            1 | 1 922 polygons                   |
//! | teapot    |           12 | 9 264 polygons                   |
//! | tetra     |            6 | 4 096 polygons                   |
//! | tree      |           11 | 4 095 cones, 4 095 spheres, 1 polygon |
//! | room      |            1 | 45 polygons                      |
//! | table     |            1 | 5 closed shapes, 1 polygon       |
//! | valve     |            2 | 42 closed shapes                 |
//! | chapel    |            3 | 62 closed shapes                 |
//! | reference |          100 | 100 000 polygons                 |

mod balls;
mod chapel;
mod gears;
mod kit;
mod lattice;
mod mountain;
pub(crate) mod noise;
mod reference;
mod rings;
mod room;
mod shells;
mod sombrero;
mod table;
mod teapot;
mod tetra;
mod tree;
mod valve;

use std::ops::RangeInclusive;

use super::ReadOptions;
use super::Scene;
use crate::error::InputError;
use crate::input::text::nearest;

/// The most faces that are generated; more would not fit into the memory of many machines.
const MOST_FACES: u64 = 20_000_000;

/// A scene that can be generated.
#[derive(Clone, Debug)]
pub struct Builtin {
    /// The name that [`generate`] knows it by.
    pub name: &'static str,
    /// What it shows, as one sentence.
    pub about: &'static str,
    /// The size factor where none is given.
    pub default_size: u32,
    /// The size factors that are taken.
    pub size_range: RangeInclusive<u32>,
    /// Slices of a sphere or cone where none are given; `None` for a scene whose count does not depend on them.
    pub default_resolution: Option<u32>,
    count: fn(u32) -> Primitives,
    build: fn(u32, u32) -> Scene,
}

/// What a scene is made of before spheres and cones are cut into polygons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Primitives {
    /// Polygons, as the definition has them: concave ones count once.
    pub polygons: u64,
    /// Spheres.
    pub spheres: u64,
    /// Cones and cylinders.
    pub cones: u64,
    /// Closed shapes that solids are made of.
    pub solids: u64,
}

impl Primitives {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.polygons + self.spheres + self.cones + self.solids
    }

    /// How many faces they make with `resolution` slices, concave faces counted once; those of solids not counted, as they
    /// cut each other.
    pub fn faces(&self, resolution: u32) -> u64 {
        let slices = u64::from(resolution);
        let stacks = (slices / 2).max(2);
        self.polygons + self.spheres * slices * stacks + self.cones * slices
    }
}

impl Builtin {
    /// What the scene is made of at a size factor, by its definition; at one outside of the range that is taken, the
    /// nearest that is.
    pub fn primitives(&self, size: u32) -> Primitives {
        (self.count)(size.clamp(*self.size_range.start(), *self.size_range.end()))
    }

    /// How many faces the scene has at a size factor with `resolution` slices, or with its default number of them;
    /// a concave face counts once, however many pieces it is cut into.
    pub fn faces(&self, size: u32, resolution: Option<u32>) -> u64 {
        let (primitives, slices) = (self.primitives(size), self.slices(resolution));
        if primitives.solids == 0 {
            primitives.faces(slices)
        } else {
            (self.build)(size, slices).mesh.face_count().into()
        }
    }

    fn slices(&self, resolution: Option<u32>) -> u32 {
        resolution.or(self.default_resolution).unwrap_or(*ReadOptions::RESOLUTIONS.start())
    }

    /// The scene at a size factor, with `resolution` slices to a sphere or cone.
    fn generate(&self, size: Option<u32>, resolution: Option<u32>) -> Result<Scene, InputError> {
        let size = size.unwrap_or(self.default_size);
        self.check(size, resolution)?;
        Ok((self.build)(size, self.slices(resolution)))
    }

    fn check(&self, size: u32, resolution: Option<u32>) -> Result<(), InputError> {
        let name = self.name;
        if !self.size_range.contains(&size) {
            let (least, most) = (self.size_range.start(), self.size_range.end());
            return Err(InputError::new(format!("size {size} of scene `{name}` is not in {least} to {most}"))
                .help(format!("leave it out for {}", self.default_size)));
        }
        if let Some(slices) = resolution.filter(|slices| !ReadOptions::RESOLUTIONS.contains(slices)) {
            let (least, most) = ReadOptions::RESOLUTIONS.into_inner();
            return Err(InputError::new(format!("resolution {slices} of scene `{name}` is not in {least} to {most}"))
                .help("it is the number of slices of a sphere or cone"));
        }
        let faces = self.primitives(size).faces(self.slices(resolution));
        if faces > MOST_FACES {
            let message = format!("scene `{name}` would have {faces} polygons, more than the {MOST_FACES} allowed");
            return Err(InputError::new(message).help("ask for a smaller size or resolution"));
        }
        Ok(())
    }
}

/// Generates the scene called `name`.
///
/// `size` is the scene's size factor, `resolution` the number of slices that spheres and cones are cut into, from 3;
/// where they are not given, the scene's own defaults hold. All faces are flat and convex.
pub fn generate(name: &str, size: Option<u32>, resolution: Option<u32>) -> Result<Scene, InputError> {
    match ALL.iter().find(|scene| scene.name == name) {
        Some(scene) => scene.generate(size, resolution),
        None => Err(unknown(name)),
    }
}

/// All scenes that can be generated.
pub fn all() -> &'static [Builtin] {
    ALL
}

fn unknown(name: &str) -> InputError {
    let names: Vec<&str> = ALL.iter().map(|scene| scene.name).collect();
    let error = InputError::new(format!("there is no built-in scene `{name}`, there are {}", names.join(", ")));
    match nearest(name, names) {
        Some(close) => error.help(format!("did you mean `{close}`?")),
        None => error,
    }
}

static ALL: &[Builtin] = &[
    balls::SCENE,
    gears::SCENE,
    lattice::SCENE,
    mountain::SCENE,
    rings::SCENE,
    shells::SCENE,
    sombrero::SCENE,
    teapot::SCENE,
    tetra::SCENE,
    tree::SCENE,
    room::SCENE,
    table::SCENE,
    valve::SCENE,
    chapel::SCENE,
    reference::SCENE,
];
