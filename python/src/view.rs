//! Pictures of a run.

use std::path::PathBuf;

use pcs_sim::error;
use pcs_sim::report::plot;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::outputs;
use crate::work::briefly;

/// A picture, as SVG and as PNG. A notebook shows it.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct Picture {
    /// Its name, and its files.
    pub picture: plot::Picture,
}

#[pymethods]
impl Picture {
    /// What it shows, in a word.
    #[getter]
    fn name(&self) -> &str {
        &self.picture.name
    }

    /// As SVG.
    #[getter]
    fn svg(&self) -> &str {
        &self.picture.rendered.svg
    }

    /// As PNG.
    #[getter]
    fn png<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.picture.rendered.png)
    }

    /// Writes the picture: a name that ends in .svg, .png or .pdf says as what.
    #[pyo3(signature = (path, *, force=false))]
    fn save(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let bytes: &[u8] = match extension.as_deref() {
            Some("svg") => self.picture.rendered.svg.as_bytes(),
            Some("png") => &self.picture.rendered.png,
            Some("pdf") => &self.picture.rendered.pdf,
            _ => {
                let error = error::InputError::in_file(&path, "is no name of a picture");
                return Err(crate::trouble::Trouble::from(error.help("pictures end in .svg, .png or .pdf")).raise(py));
            }
        };
        briefly(py, |_| outputs::write(&path, force, |file| std::io::Write::write_all(file, bytes)).map(drop))
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        self.png(py)
    }

    fn __repr__(&self) -> String {
        format!("<pcs_sim.Picture {}>", self.picture.name)
    }
}
