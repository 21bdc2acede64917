//! What a farm is: all that its results depend on, with every default filled in.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::options::FarmRunOptions;
use crate::error::InputError;
use crate::host::camera::ImageSize;
use crate::machine::CapitanFile;
use crate::program::farm::{HandOut, ItemKind, Rectangles, SceneBy};
use crate::run::spec::{FARM, configuration, read_configuration, standard_size};
use crate::run::{ImageSpec, Key, LightOptions};

/// A farm, described: enough to run it again to the nanosecond.
///
/// It is the `configuration` of a farm's statistics; fields that it does not know are refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FarmSpec {
    /// The simulator's version that wrote it.
    pub version: String,
    /// A built-in scene or a file, or [`FarmSpec::RECTANGLES`].
    pub scene: String,
    /// Size factor of a built-in scene; `None` for its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_factor: Option<u32>,
    /// Slices of spheres and cones; `None` for the scene's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<u32>,
    /// Size of the image.
    #[serde(default = "standard_size")]
    pub size: ImageSize,
    /// The made-up scene; `None` for one of polygons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rectangles: Option<Rectangles>,
    /// How a scene of polygons is traced; `None` for a made-up one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rays: Option<FarmRays>,
    /// How many workers there are.
    pub tasks: usize,
    /// What the master hands out.
    pub items: ItemKind,
    /// Side of a tile, in pixels, if it hands out tiles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tile: Option<u32>,
    /// How work items come to the workers.
    pub hand_out: HandOut,
    /// How the scene comes to the tasks.
    pub scene_by: SceneBy,
    /// The machine, as its file would have it.
    pub machine: CapitanFile,
}

/// How a worker traces the rays of a scene of polygons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FarmRays {
    /// Voxels of the grid for each polygon.
    pub grid_coefficient: f64,
    /// Samples along each side of a pixel.
    pub samples: u32,
    /// How often light may be reflected or refracted.
    pub depth: u8,
    /// The least share of a pixel for which a ray is followed.
    pub min_contribution: f64,
}

/// Side of a tile where none is given, in pixels.
const TILE: u32 = 8;

impl Default for FarmRays {
    fn default() -> FarmRays {
        let ImageSpec { samples, depth, min_contribution, .. } = ImageSpec::default();
        FarmRays { grid_coefficient: 50.0, samples, depth, min_contribution }
    }
}

impl FarmSpec {
    /// What stands for the made-up scene.
    pub const RECTANGLES: &str = "rectangles";

    /// The farm that was asked for by `options`: they are laid over `base`, or over the defaults. If they ask for a range of
    /// workers, it has the most of them.
    ///
    /// Fails if a file cannot be read, or if the options make an impossible machine or farm.
    pub fn new(options: &FarmRunOptions, base: Option<FarmSpec>) -> Result<FarmSpec, InputError> {
        let base = base.as_ref();
        let (shape, farm) = (&options.shape, &options.farm);
        let mut machine = match (&farm.machine, base) {
            (Some(path), _) => CapitanFile::read(path)?,
            (None, Some(base)) => base.machine.clone(),
            (None, None) => CapitanFile::standard()?,
        };
        options.machine.change(&mut machine);
        let scene = options.scene.scene.clone().or(base.map(|base| base.scene.clone()));
        let scene = scene.unwrap_or_else(|| FarmSpec::RECTANGLES.to_owned());
        let of_same_scene = base.filter(|base| base.scene == scene);
        let is_made_up = scene == FarmSpec::RECTANGLES;
        let items = farm.items.or(base.map(|base| base.items)).unwrap_or_default();
        let tile = farm.tile.or(base.and_then(|base| base.tile)).unwrap_or(TILE);
        let tasks = farm.tasks.map(|range| range.last).or(base.map(|base| base.tasks));
        let spec = FarmSpec {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            size_factor: shape.size_factor.or(of_same_scene.and_then(|base| base.size_factor)),
            resolution: shape.resolution.or(of_same_scene.and_then(|base| base.resolution)),
            size: shape.size.or(base.map(|base| base.size)).unwrap_or_else(standard_size),
            rectangles: is_made_up.then(|| rectangles(options, of_same_scene)),
            rays: (!is_made_up).then(|| rays(options, base)),
            tasks: tasks.unwrap_or((machine.processors as usize).saturating_sub(1)),
            items,
            tile: (items == ItemKind::Tiles).then_some(tile),
            hand_out: farm.hand_out.or(base.map(|base| base.hand_out)).unwrap_or_default(),
            scene_by: farm.scene_by.or(base.map(|base| base.scene_by)).unwrap_or_default(),
            scene,
            machine,
        };
        spec.check()?;
        Ok(spec)
    }

    /// Reads a description: a farm's configuration, or the statistics that have it.
    pub fn read(path: &Path) -> Result<FarmSpec, InputError> {
        let spec: FarmSpec = read_configuration(path, FARM)?;
        spec.check()?;
        Ok(spec)
    }

    /// The same from JSON that is at hand.
    pub fn from_json(value: serde_json::Value) -> Result<FarmSpec, InputError> {
        let spec: FarmSpec = configuration(value, FARM)?;
        spec.check()?;
        Ok(spec)
    }

    /// What the work on the pixels depends on, before it is priced, and whether there is room for the scene.
    pub fn work_key(&self) -> Key {
        // All fields by name, so that a new one cannot be forgotten here.
        let FarmSpec { version: _, scene, size_factor, resolution, size, rectangles, rays, machine, .. } = self;
        let FarmSpec { tasks: _, items: _, tile: _, hand_out: _, scene_by: _, .. } = self;
        Key::of((scene, size_factor, resolution, size, rectangles, rays, machine.memory_kbyte))
    }

    fn check(&self) -> Result<(), InputError> {
        self.machine.build()?;
        let (tasks, processors) = (self.tasks, self.machine.processors);
        if tasks == 0 {
            return Err(InputError::new("there must be at least 1 worker"));
        }
        if tasks >= processors as usize {
            let message =
                format!("{tasks} workers and the master need {} processors, there are {processors}", tasks + 1);
            return Err(InputError::new(message).help("ask for fewer --tasks, or give the machine more --processors"));
        }
        let count = self.rectangles.map_or(1, |rectangles| rectangles.count);
        if !(1..=Rectangles::MOST).contains(&count) {
            let most = Rectangles::MOST;
            return Err(InputError::new(format!("the made-up scene has {count} rectangles, it must be 1 to {most}")));
        }
        match &self.rays {
            Some(rays) => rays.check(),
            None => Ok(()),
        }
    }
}

impl FarmRays {
    /// The same with what is asked for.
    pub(in crate::run) fn changed(self, grid_coefficient: Option<f64>, light: &LightOptions) -> FarmRays {
        FarmRays {
            grid_coefficient: grid_coefficient.unwrap_or(self.grid_coefficient),
            samples: light.samples.unwrap_or(self.samples),
            depth: light.depth.unwrap_or(self.depth),
            min_contribution: light.min_contribution.unwrap_or(self.min_contribution),
        }
    }

    /// Fails if it makes no sense.
    pub(in crate::run) fn check(&self) -> Result<(), InputError> {
        let FarmRays { samples, depth, min_contribution, .. } = *self;
        ImageSpec { samples, depth, min_contribution, ..ImageSpec::default() }.check()
    }
}

fn rectangles(options: &FarmRunOptions, base: Option<&FarmSpec>) -> Rectangles {
    let below = base.and_then(|base| base.rectangles).unwrap_or_default();
    Rectangles { count: options.farm.rectangles.unwrap_or(below.count), seed: options.farm.seed.unwrap_or(below.seed) }
}

fn rays(options: &FarmRunOptions, base: Option<&FarmSpec>) -> FarmRays {
    let below = base.and_then(|base| base.rays.clone()).unwrap_or_default();
    below.changed(options.farm.grid_coefficient, &options.light)
}
