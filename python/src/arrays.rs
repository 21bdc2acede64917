//! Arrays in: scenes and rays of numbers.

use std::sync::Arc;

use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods};
use pcs_sim::geometry::Ray;
use pcs_sim::host::ray_file;
use pcs_sim::scene::{Arrays, Scene as SceneData};
use pyo3::prelude::*;

use crate::trouble::wrong;
use crate::work::briefly;

type Point = [f64; 3];

/// A scene of arrays.
///
/// `points` are n x 3 numbers. `faces` are m x k numbers of points, from 0, or a list of such rows of any lengths; faces
/// that are concave or not flat are cut into triangles. `colors` (n x 3, linear RGB) colour the points, `lights` (n x 3) are
/// points of white light. The camera is at `eye` and looks at `at`; without, it frames the scene. `up` is the direction
/// that is up in the image, `angle` the angle of view of its height, in degrees.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct Scene {
    /// The scene.
    pub data: Arc<SceneData>,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (points, faces, *, colors=None, lights=None, background=[0.0; 3], eye=None, at=None, up=[0.0, 0.0, 1.0], angle=40.0, name="scene"))]
    // A keyword each.
    #[expect(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        colors: Option<&Bound<'_, PyAny>>,
        lights: Option<&Bound<'_, PyAny>>,
        background: Point,
        eye: Option<Point>,
        at: Option<Point>,
        up: Point,
        angle: f64,
        name: &str,
    ) -> PyResult<Scene> {
        let (points, faces) = (rows(py, "points", points)?, face_rows(py, faces)?);
        let faces: Vec<&[i64]> = faces.iter().map(Vec::as_slice).collect();
        let maybe =
            |name, array: Option<&Bound<'_, PyAny>>| array.map_or(Ok(Vec::new()), |array| rows(py, name, array));
        let (colors, lights) = (maybe("colors", colors)?, maybe("lights", lights)?);
        let view = match (eye, at) {
            (Some(eye), Some(at)) => Some((eye, at)),
            (None, None) => None,
            _ => return Err(wrong(py, "a camera needs both eye and at, or neither")),
        };
        let arrays = Arrays {
            name,
            points: &points,
            faces: &faces,
            colors: &colors,
            lights: &lights,
            background,
            view,
            up,
            angle,
        };
        Ok(Scene { data: Arc::new(briefly(py, |_| Ok(arrays.scene()?))?) })
    }

    /// What it is called.
    #[getter]
    fn name(&self) -> &str {
        &self.data.name
    }

    /// What reading the arrays changed, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.data.notes.clone()
    }

    /// How many polygons it has.
    #[getter]
    fn polygons(&self) -> usize {
        self.data.mesh.faces().len()
    }

    fn __repr__(&self) -> String {
        format!("<pcs_sim.Scene {}: {} polygons>", self.data.name, self.polygons())
    }
}

/// Rays of an array of n x 6 numbers (origin, direction), or 7 with tmax.
pub fn rays(py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<Vec<Ray>> {
    let array = numbers(py, "rays", value)?;
    let columns = array.shape().get(1).copied().unwrap_or_default();
    if array.ndim() != 2 || !(6..=7).contains(&columns) {
        return Err(wrong(
            py,
            format!("rays: expected n x 6 numbers (ox, oy, oz, dx, dy, dz), or 7 with tmax, not {}", shape(&array)),
        ));
    }
    let array: PyReadonlyArray2<'_, f64> = array.extract()?;
    let rows = array.as_array();
    let ray = |(number, row): (usize, numpy::ndarray::ArrayView1<'_, f64>)| {
        let t_max = row.get(6).copied().unwrap_or(f64::INFINITY);
        let ray = ray_file::ray([row[0], row[1], row[2], row[3], row[4], row[5], t_max]);
        ray.map_err(|why| wrong(py, format!("ray {number}: {why}")))
    };
    let rays: Vec<Ray> = rows.rows().into_iter().enumerate().map(ray).collect::<PyResult<_>>()?;
    if rays.is_empty() || u32::try_from(rays.len()).is_err() {
        return Err(wrong(py, format!("rays: expected from 1 to {} of them, not {}", u32::MAX, rays.len())));
    }
    Ok(rays)
}

/// An array of numbers in double precision.
fn numbers<'py>(py: Python<'py>, name: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    let array = py.import("numpy")?.getattr("asarray")?.call1((value, "float64"));
    let array = array.map_err(|error| wrong(py, format!("{name}: {}", error.value(py))))?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}

/// `3 x 4`, or `one number`.
fn shape(array: &Bound<'_, PyUntypedArray>) -> String {
    match array.shape() {
        [] => "one number".to_owned(),
        shape => shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x "),
    }
}

/// n x 3 numbers.
fn rows(py: Python<'_>, name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Point>> {
    let array = numbers(py, name, value)?;
    if array.ndim() != 2 || array.shape()[1] != 3 {
        return Err(wrong(py, format!("{name}: expected n x 3 numbers, not {}", shape(&array))));
    }
    let array: PyReadonlyArray2<'_, f64> = array.extract()?;
    Ok(array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect())
}

/// The points of each face: rows of whole numbers.
fn face_rows(py: Python<'_>, faces: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<i64>>> {
    let numpy = py.import("numpy")?;
    let row = |face: Bound<'_, PyAny>| {
        let whole =
            numpy.getattr("asarray")?.call1((face,))?.call_method("astype", ("int64",), Some(&same_kind(py)?))?;
        let whole: PyReadonlyArray1<'_, i64> = whole.extract()?;
        Ok::<_, PyErr>(whole.as_array().to_vec())
    };
    let rows = faces.try_iter().and_then(|faces| faces.map(|face| row(face?)).collect::<PyResult<Vec<_>>>());
    rows.map_err(|error| wrong(py, format!("faces: expected rows of whole numbers: {}", error.value(py))))
}

fn same_kind(py: Python<'_>) -> PyResult<Bound<'_, pyo3::types::PyDict>> {
    let options = pyo3::types::PyDict::new(py);
    options.set_item("casting", "same_kind")?;
    Ok(options)
}
