//! What a run is made of, ready to be run.

use std::sync::Arc;

use glam::Vec3;

use super::layers::{Layers, PlannedRun, Prepared};
use super::render::Picture;
use super::spec::{ImageSpec, RunSpec};
use crate::cancel::Cancel;
use crate::geometry::Hit;
use crate::host::image;
use crate::machine::Machine;
use crate::program::{NotLaidOut, Workload};
use crate::scene::Scene;

/// A run whose scene is laid out for its array.
#[derive(Debug)]
pub struct Setup {
    /// What is run.
    pub spec: RunSpec,
    /// What is traced.
    pub scene: Arc<Scene>,
    /// On what.
    pub machine: Machine,
    /// The rays; of an image, its primary rays.
    pub prepared: Arc<Prepared>,
    /// What the array has to do.
    pub workload: Workload,
}

impl Setup {
    /// Lays a run out.
    ///
    /// # Errors
    ///
    /// As [`Layers::workload`], and if the machine cannot run the workload ([`Workload::check`]).
    pub fn new(run: PlannedRun, layers: &mut Layers, cancel: &Cancel) -> Result<Setup, NotLaidOut> {
        let workload = layers.workload(&run, cancel)?;
        workload.check(&run.machine.spec)?;
        let (scene, prepared) = (layers.scene(&run)?, layers.prepared(&run)?);
        let PlannedRun { spec, machine, .. } = run;
        Ok(Setup { spec, scene, machine, prepared, workload })
    }

    /// What the user should know before the figures: what had to be rounded, cut or assumed.
    pub fn notes(&self) -> impl Iterator<Item = &str> {
        self.machine.notes.iter().chain(&self.scene.notes).map(String::as_str)
    }

    /// How the image is made, if it is one.
    pub fn image(&self) -> ImageSpec {
        self.spec.image.clone().unwrap_or_default()
    }

    /// The hits of the rays in the order in which the host sends them, in the order of the rays' numbers: of pixels line by line. Rays
    /// that were not sent hit nothing.
    pub fn by_number(&self, hits: &[Hit]) -> Vec<Hit> {
        self.prepared.by_number(hits, Hit::MISS)
    }

    /// The picture of the primary rays' hits: its pixels, line by line.
    pub fn preview(&self, hits: &[Hit]) -> Vec<Vec3> {
        let seen = image::preview(&self.scene, self.workload.polygons(), &self.prepared.rays, hits);
        self.prepared.by_number(&seen, self.scene.background)
    }

    /// What is to be seen of an image.
    pub fn picture(&self) -> Picture<'_> {
        let (image, size) = (self.image(), self.spec.size);
        let (sampling, limits) = (image.sampling(), image.limits());
        let screen = self.prepared.screen.as_ref();
        let rules = image.rules;
        Picture { scene: &self.scene, workload: &self.workload, size, sampling, limits, screen, rules }
    }
}
