//! What an image on a hypercube is: all that its results depend on, with every default filled in.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::options::{
    CellCuts, CubeMode, CubeRunOptions, Distribution, First, FlowKind, Grant, Grids, Mapping, Percent, PixelOrder,
    PixelsOf, QueueRays, Termination,
};
use crate::error::InputError;
use crate::host::camera::ImageSize;
use crate::host::rules::Rules;
use crate::host::sampling::Sampling;
use crate::host::shading::Limits;
use crate::input::fields::is_default;
use crate::machine::Ipsc2File;
use crate::program::cube::{self, Ends, Flow};
use crate::run::spec::{CUBE, configuration, read_configuration, standard_size};
use crate::run::{FarmRays, Key};

/// An image on a hypercube, described: enough to make it again to the cycle.
///
/// It is the `configuration` of its statistics; fields that it does not know are refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CubeSpec {
    /// The simulator's version that wrote it.
    pub version: String,
    /// A built-in scene or a file.
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
    /// How rays are traced.
    pub rays: FarmRays,
    /// What spares tests and rays.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rules: Rules,
    /// The regions; `None` if nodes share a memory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub regions: Option<RegionSpec>,
    /// Bytes of a page of the memory that nodes share; `None` if they have regions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page_bytes: Option<u32>,
    /// How nodes that share a memory share the pixels.
    #[serde(default, skip_serializing_if = "is_default")]
    pub distribution: Distribution,
    /// The machine, as its file would have it.
    pub machine: Ipsc2File,
}

/// How nodes that have a region each go about it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// Share of the pixels on which the regions' work is measured.
    pub sub_sample: Percent,
    /// Cells along each side of the plane.
    pub cell_grid: u32,
    /// How they are cut.
    #[serde(default, skip_serializing_if = "is_default")]
    pub cell_cuts: CellCuts,
    /// Whose grid a node walks through.
    #[serde(default, skip_serializing_if = "is_default")]
    pub grids: Grids,
    /// Which region is on which node.
    pub mapping: Mapping,
    /// How rays find room.
    pub flow: FlowKind,
    /// Slots of a node, if these are limited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub queue_rays: Option<QueueRays>,
    /// How a node knows that another has a slot.
    #[serde(default, skip_serializing_if = "is_default")]
    pub grant: Grant,
    /// Pixels under way on a node, if these are limited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window: Option<u32>,
    /// How it is found out that all is done.
    pub termination: Termination,
    /// In which order a node begins its pixels.
    pub pixel_order: PixelOrder,
    /// What a node does first.
    pub first: First,
    /// Who begins a pixel.
    pub pixels: PixelsOf,
}

/// Voxels of the grid for each polygon, where nothing is said.
const GRID_COEFFICIENT: f64 = 10.0;
/// Slots of a node.
const QUEUE_RAYS: QueueRays = QueueRays::Count(4096);
/// Pixels under way on a node.
const WINDOW: u32 = 64;
/// Bytes of a page.
const PAGE_BYTES: u32 = 1024;

impl Default for RegionSpec {
    fn default() -> RegionSpec {
        RegionSpec {
            sub_sample: Percent(1.5),
            cell_grid: 64,
            cell_cuts: CellCuts::default(),
            grids: Grids::default(),
            mapping: Mapping::default(),
            flow: FlowKind::default(),
            queue_rays: None,
            grant: Grant::default(),
            window: None,
            termination: Termination::default(),
            pixel_order: PixelOrder::default(),
            first: First::default(),
            pixels: PixelsOf::default(),
        }
    }
}

impl RegionSpec {
    fn new(options: &CubeRunOptions, base: Option<RegionSpec>) -> RegionSpec {
        let (asked, below) = (&options.cube, base.unwrap_or_default());
        let flow = asked.flow.unwrap_or(below.flow);
        let queue_rays = asked.queue_rays.or(below.queue_rays).unwrap_or(QUEUE_RAYS);
        let grant = asked.grant.unwrap_or(below.grant);
        let window = asked.window.or(below.window).unwrap_or(WINDOW);
        RegionSpec {
            sub_sample: asked.sub_sample.unwrap_or(below.sub_sample),
            cell_grid: asked.cell_grid.unwrap_or(below.cell_grid),
            cell_cuts: asked.cell_cuts.unwrap_or(below.cell_cuts),
            grids: asked.grids.unwrap_or(below.grids),
            mapping: asked.mapping.unwrap_or(below.mapping),
            flow,
            queue_rays: matches!(flow, FlowKind::Block | FlowKind::Classes).then_some(queue_rays),
            grant: if flow == FlowKind::Classes { grant } else { Grant::Known },
            window: (flow == FlowKind::Window).then_some(window),
            termination: asked.termination.unwrap_or(below.termination),
            pixel_order: asked.pixel_order.unwrap_or(below.pixel_order),
            first: asked.first.unwrap_or(below.first),
            pixels: asked.pixels.unwrap_or(below.pixels),
        }
    }

    /// What the nodes go by, if each has so many slots.
    pub fn rules(&self, slots: u32) -> cube::Rules {
        cube::Rules {
            flow: match self.flow {
                FlowKind::Unlimited => Flow::Unlimited,
                FlowKind::Block => Flow::Block(slots),
                FlowKind::Window => Flow::Window(self.window.unwrap_or(WINDOW)),
                FlowKind::Classes => Flow::Classes(slots),
            },
            ends: match self.termination {
                Termination::Credit => Ends::Credit,
                Termination::Token => Ends::Token,
            },
            asks_for_slots: self.grant == Grant::Handshake,
            pixels_first: self.first == First::Pixels,
        }
    }

    fn check(&self) -> Result<(), InputError> {
        if self.flow == FlowKind::Window && self.termination == Termination::Token {
            let error =
                InputError::new("a window counts pixels that are done, which --termination token does not tell");
            return Err(error.help("ask for --termination credit, or for another --flow"));
        }
        if self.cell_cuts == CellCuts::Pyramids && self.grids == Grids::Own {
            let error = InputError::new("pyramids are cut out of the one grid, and --grids own has others");
            return Err(error.help("ask for --grids one, or for other --cell-cuts"));
        }
        let Percent(share) = self.sub_sample;
        if !(share > 0.0 && share <= 100.0) {
            return Err(InputError::new(format!(
                "sub_sample is {share}, it must be more than 0 and up to 100 percent"
            )));
        }
        if self.queue_rays.is_some_and(|rays| !rays.is_possible()) {
            return Err(InputError::new(format!("impossible queue_rays: {}", QueueRays::EXPECTED)));
        }
        if self.window == Some(0) || !(1..=128).contains(&self.cell_grid) {
            return Err(InputError::new("window must be 1 or more, and cell_grid from 1 to 128"));
        }
        Ok(())
    }
}

impl CubeSpec {
    /// The image that was asked for by `options`: they are laid over `base`, or over the defaults.
    ///
    /// Fails if a file cannot be read, or if the options make an impossible machine or image.
    pub fn new(options: &CubeRunOptions, base: Option<CubeSpec>) -> Result<CubeSpec, InputError> {
        let base = base.as_ref();
        let (shape, asked) = (&options.shape, &options.cube);
        let mut machine = match (&asked.machine, base) {
            (Some(path), _) => Ipsc2File::read(path)?,
            (None, Some(base)) => base.machine.clone(),
            (None, None) => Ipsc2File::standard()?,
        };
        options.machine.change(&mut machine);
        let scene = options.scene.scene.clone().or(base.map(|base| base.scene.clone()));
        let scene = scene.ok_or_else(|| {
            InputError::new("there is no scene").help("name one: `pcs-sim scenes` lists those built in")
        })?;
        let of_same_scene = base.filter(|base| base.scene == scene);
        let mode = asked.mode.or(base.map(CubeSpec::mode)).unwrap_or_default();
        let page_bytes = asked.page_bytes.or(base.and_then(|base| base.page_bytes)).unwrap_or(PAGE_BYTES);
        let distribution = asked.distribution.or(base.map(|base| base.distribution)).unwrap_or_default();
        let regions = RegionSpec::new(options, base.and_then(|base| base.regions));
        let spec = CubeSpec {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            size_factor: shape.size_factor.or(of_same_scene.and_then(|base| base.size_factor)),
            resolution: shape.resolution.or(of_same_scene.and_then(|base| base.resolution)),
            size: shape.size.or(base.map(|base| base.size)).unwrap_or_else(standard_size),
            rays: rays(options, base),
            rules: asked.rules.or(base.map(|base| base.rules)).unwrap_or_default(),
            regions: (mode == CubeMode::Regions).then_some(regions),
            page_bytes: (mode == CubeMode::SharedMemory).then_some(page_bytes),
            distribution: if mode == CubeMode::SharedMemory { distribution } else { Distribution::Lines },
            scene,
            machine,
        };
        spec.check()?;
        Ok(spec)
    }

    /// Reads a description: a configuration, or the statistics that have it.
    pub fn read(path: &Path) -> Result<CubeSpec, InputError> {
        let spec: CubeSpec = read_configuration(path, CUBE)?;
        spec.check()?;
        Ok(spec)
    }

    /// The same from JSON that is at hand.
    pub fn from_json(value: serde_json::Value) -> Result<CubeSpec, InputError> {
        let spec: CubeSpec = configuration(value, CUBE)?;
        spec.check()?;
        Ok(spec)
    }

    /// How the nodes share the scene.
    pub fn mode(&self) -> CubeMode {
        if self.regions.is_some() { CubeMode::Regions } else { CubeMode::SharedMemory }
    }

    /// Rays from the eye.
    pub fn sampling(&self) -> Sampling {
        Sampling { side: self.rays.samples, adaptive: None }
    }

    /// Where the trees of rays end.
    pub fn limits(&self) -> Limits {
        Limits { depth: self.rays.depth, contribution: self.rays.min_contribution }
    }

    /// What the task graph depends on: regions are cut by what work takes.
    pub fn work_key(&self) -> Key {
        // All fields by name, so that a new one cannot be forgotten here.
        let CubeSpec {
            version: _,
            scene,
            size_factor,
            resolution,
            size,
            rays,
            rules,
            regions,
            page_bytes,
            machine,
            distribution: _,
        } = self;
        let regions = regions.map(|regions| (regions.sub_sample, regions.cell_grid, regions.cell_cuts, regions.grids));
        let cut = regions.map(|regions| (regions, machine.nodes, machine.times_us));
        Key::of((scene, size_factor, resolution, size, rays, rules, cut, page_bytes))
    }

    fn check(&self) -> Result<(), InputError> {
        self.machine.build()?;
        self.rays.check()?;
        match (&self.regions, self.page_bytes) {
            (Some(regions), None) => regions.check(),
            (None, Some(64..)) => Ok(()),
            _ => Err(InputError::new("nodes have either regions or pages, of 64 bytes or more")),
        }
    }
}

fn rays(options: &CubeRunOptions, base: Option<&CubeSpec>) -> FarmRays {
    let below = base.map(|base| base.rays.clone());
    let below = below.unwrap_or(FarmRays { grid_coefficient: GRID_COEFFICIENT, ..FarmRays::default() });
    below.changed(options.cube.grid_coefficient, &options.light)
}
