//! What the reference scene is made of.

use glam::Vec3;

use crate::scene::Material;
use crate::scene::builtin::kit;

/// A material of the scene; as a number, its place in [`materials`].
#[derive(Clone, Copy)]
pub enum Stuff {
    Water,
    Sand,
    Grass,
    Rock,
    Snow,
    Trunk,
    Fir,
    Leaves,
    Plaster,
    Brick,
    Roof,
    Dark,
    WhiteTile,
    BlackTile,
    Gold,
    Mirror,
    Paper,
}

impl Stuff {
    /// The material's index.
    pub fn index(self) -> u32 {
        self as u32
    }
}

/// All materials, in the order of [`Stuff`].
pub fn materials() -> Vec<Material> {
    let matt = |r: f32, g: f32, b: f32| kit::matt(Vec3::new(r, g, b), 0.9);
    vec![
        kit::shiny(Vec3::new(0.1, 0.25, 0.35), 0.4, 0.5, 5.0),
        matt(0.8, 0.7, 0.5),
        matt(0.35, 0.5, 0.2),
        matt(0.45, 0.4, 0.36),
        matt(0.95, 0.96, 1.0),
        matt(0.35, 0.24, 0.15),
        matt(0.1, 0.3, 0.15),
        matt(0.25, 0.45, 0.12),
        matt(0.92, 0.88, 0.78),
        matt(0.7, 0.45, 0.3),
        matt(0.65, 0.2, 0.12),
        matt(0.15, 0.12, 0.12),
        kit::shiny(Vec3::splat(0.95), 0.7, 0.3, 10.0),
        kit::shiny(Vec3::new(0.12, 0.12, 0.2), 0.7, 0.3, 10.0),
        kit::shiny(Vec3::new(1.0, 0.7, 0.2), 0.6, 0.4, 15.0),
        kit::shiny(Vec3::new(0.95, 0.95, 1.0), 0.1, 0.8, 5.0),
        matt(0.95, 0.35, 0.25),
    ]
}
