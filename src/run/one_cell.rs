//! A scene as one cell has it that does all of the work, and so each worker of a farm: what hypercubes are cut from, too.

use std::sync::Arc;

use crate::cancel::Cancel;
use crate::error::InputError;
use crate::host::camera::{ImageSize, primary_rays};
use crate::input::reading;
use crate::machine::KernelTimes;
use crate::program::{ArrayProgram, Layout, NotLaidOut, Sample, Surfaces, Workload};
use crate::scene::Scene;

/// Which scene, and how fine its grid is.
#[derive(Debug)]
pub(super) struct Whole<'a> {
    pub scene: &'a str,
    pub size_factor: Option<u32>,
    pub resolution: Option<u32>,
    /// The size of the image whose primary rays are sent.
    pub size: ImageSize,
    pub grid_coefficient: f64,
}

impl Whole<'_> {
    /// Loads the scene and lays it out. Once it is told to stop it waits for neither any longer.
    ///
    /// # Errors
    ///
    /// If the scene cannot be read, or its grid would be too large; and if it is told to stop.
    pub fn lay_out(&self, times: KernelTimes, cancel: &Cancel) -> Result<(Scene, Workload), NotLaidOut> {
        let (name, size_factor, resolution, size) =
            (self.scene.to_owned(), self.size_factor, self.resolution, self.size);
        let load = move || {
            let scene = super::load_scene(&name, size_factor, resolution)?;
            let rays = primary_rays(&scene.camera, size);
            let surfaces = Arc::new(Surfaces::new(&scene.mesh, &rays));
            Ok::<_, InputError>((scene, surfaces))
        };
        let (scene, surfaces) = reading::wait_for(cancel, load)??;
        let program = ArrayProgram::one_cell(self.grid_coefficient);
        let layout = Layout::new(surfaces, &program, times, Sample::default(), cancel)?;
        Ok((scene, Workload::of(Arc::new(layout), &program, times)))
    }
}
