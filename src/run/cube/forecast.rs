//! What the sub-sample says of an image before it is made.

use std::convert::Infallible;

use super::cut::lattice;
use super::{CubeScene, CubeSpec, Tracing, one_node};
use crate::machine::Cycles;
use crate::model::Bounds;
use crate::model::cube::regions_of_random_line;
use crate::run::{RunError, Workers};

/// What is expected of an image on a hypercube.
#[derive(Clone, Debug)]
pub struct CubeForecast {
    /// The sub-sample by itself.
    pub sample: CubeScene,
    /// For how many samples of the image each of its own stands.
    pub times: f64,
    /// How many regions a random line meets, if the nodes have regions that are boxes.
    pub regions_of_line: Option<f64>,
    /// What all pixels take on one node.
    pub one_node: Cycles,
    /// What the run takes at the least.
    pub bounds: Bounds,
}

impl CubeSpec {
    /// What the sub-sample says.
    ///
    /// # Errors
    ///
    /// As [`CubeSpec::lay_out`].
    pub fn forecast(&self, workers: &Workers) -> Result<CubeForecast, RunError<Infallible>> {
        let machine = self.machine.build()?;
        let share = self.regions.unwrap_or_default().sub_sample;
        let pixels = lattice(self.size, share);
        let mut regions_of_line = None;
        let sample = self.lay_out_by(false, workers, |tracing| {
            regions_of_line = met_by_lines(tracing).filter(|_| self.regions.is_some());
            tracing.trace((pixels.len(), |sample| pixels[sample]), workers, |_| Ok(()))
        })?;
        let times = self.samples() as f64 / pixels.len().max(1) as f64;
        let bounds = match &self.regions {
            Some(_) => self.bounds(&sample, &machine, &self.node_of(&sample.cut, &machine)),
            // A lattice of pixels does not tell how they are dealt out.
            None => Bounds::of_shared_memory(&machine, &sample.graph, None),
        };
        let one_node = Cycles((one_node(&sample.graph, &machine)?.0 as f64 * times).round() as u64);
        Ok(CubeForecast { sample, times, regions_of_line, one_node, bounds: bounds.scaled(times) })
    }
}

/// How many of the regions a random line meets, if they are boxes.
fn met_by_lines(tracing: &Tracing<'_>) -> Option<f64> {
    let grid = tracing.picture.workload.grids().next().filter(|_| tracing.space.pyramids.is_none())?;
    Some(regions_of_random_line(&tracing.space.regions.volumes(grid), &grid.volume()))
}
