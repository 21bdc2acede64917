//! Runs, images and replays.

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pcs_sim::geometry::Hit;
use pcs_sim::host::color_table::{ColorTable, Palette};
use pcs_sim::host::image;
use pcs_sim::measure::{Observed, Shape, StateKind};
use pcs_sim::program::Counts;
use pcs_sim::quantities::Cycles;
use pcs_sim::report::trace::{Format, Trace};
use pcs_sim::report::{bottleneck, hits};
use pcs_sim::run::Watching;
use pyo3::exceptions::{PyKeyError, PyRuntimeWarning};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::graphs::{self, Window};
use crate::made::{Described, Made, has_none, locked, profile_of, save_plots};
use crate::outputs;
use crate::table::{Table, number, text, whole};
use crate::trouble::{Trouble, wrong};
use crate::view::Picture;
use crate::work::{Crew, briefly, work};

/// A run that is over: of primary rays, of a whole image, of a recorded trace, of a farm, or of an image on a hypercube.
///
/// What a run over time looked like (`timelines`, `plot`, `page`) is found out when it is first asked for: by running it
/// again under a probe, which changes nothing.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct Run {
    made: Made,
    crew: Crew,
    seen: Mutex<Option<Arc<Observed>>>,
}

impl Run {
    /// A run that is over; who did it does it again where that is asked for.
    pub fn new(made: Made, crew: Crew) -> Run {
        Run { made, crew, seen: Mutex::default() }
    }

    /// What was run.
    pub fn made(&self) -> &Made {
        &self.made
    }

    /// Runs it once more, watched.
    fn watch(&self, py: Python<'_>, watching: &Watching) -> PyResult<Observed> {
        self.made.measured()?;
        work(py, self.crew, "rays", |task| self.made.again(watching, task))
    }

    /// What was run, as JSON.
    pub fn configuration(&self, py: Python<'_>) -> PyResult<serde_json::Value> {
        self.made.configuration().map_err(|error| wrong(py, error.to_string()))
    }

    /// The run over time, and, of a line, its beginning cycle by cycle.
    fn seen(&self, py: Python<'_>) -> PyResult<Arc<Observed>> {
        let kept = locked(&self.seen).clone();
        if let Some(seen) = kept {
            return Ok(seen);
        }
        let seen = self.seen_in(py, Cycles(0)..Cycles(u64::MAX))?;
        *locked(&self.seen) = Some(seen.clone());
        Ok(seen)
    }

    /// The same with a window of one's own.
    fn seen_in(&self, py: Python<'_>, window: Range<Cycles>) -> PyResult<Arc<Observed>> {
        let is_line = self.made.measured()?.topology.shape == Shape::Line;
        let watching = Watching { profile: true, recording: is_line.then_some(window), ..Watching::default() };
        Ok(Arc::new(self.watch(py, &watching)?))
    }
}

#[pymethods]
impl Run {
    /// Simulated time, in cycles.
    #[getter]
    fn cycles(&self) -> PyResult<u64> {
        Ok(self.made.measured()?.cycles.0)
    }

    /// Simulated time, in seconds.
    #[getter]
    fn seconds(&self) -> PyResult<f64> {
        Ok(self.made.clock().seconds(self.made.measured()?.cycles))
    }

    /// How many rays the host sent.
    #[getter]
    fn rays(&self) -> PyResult<u64> {
        match &self.made {
            Made::Farm { .. } => Err(has_none("a farm", "count of rays")),
            Made::Cube { setup, .. } => Ok(setup.scene.graph.rays.len() as u64),
            _ => Ok(self.made.measured()?.jobs),
        }
    }

    /// Rays a second of simulated time.
    #[getter]
    fn rays_per_second(&self) -> PyResult<f64> {
        let seconds = self.seconds()?;
        Ok(if seconds > 0.0 { self.rays()? as f64 / seconds } else { 0.0 })
    }

    /// One sentence on what limits the machine.
    #[getter]
    fn bottleneck(&self) -> PyResult<String> {
        Ok(bottleneck::sentence(self.made.measured()?))
    }

    /// How often the kernels did their work: `voxels`, `slab_tests`, `intersection_tests`, `hits`.
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Counts { voxels, slab_tests, intersection_tests, hits, .. } = *self.made.tallied()?;
        let counts = PyDict::new(py);
        counts.set_item("voxels", voxels)?;
        counts.set_item("slab_tests", slab_tests)?;
        counts.set_item("intersection_tests", intersection_tests)?;
        counts.set_item("hits", hits)?;
        Ok(counts)
    }

    /// Where every cell's cycles went: a row a cell, a column a state. The states of a cell sum to the run's cycles.
    #[getter]
    fn cells(&self) -> PyResult<Table> {
        let stats = self.made.measured()?;
        let names = match &self.made {
            Made::Farm { .. } | Made::Cube { .. } => {
                (0..stats.stations.len()).map(|task| stats.topology.station(task)).collect()
            }
            _ => self.made.described().names,
        };
        let all = 0..stats.stations.len();
        let states = stats.topology.states.all().iter().filter(|state| state.used || state.kind == StateKind::Works);
        let mut columns = vec![
            whole("cell", all.clone().map(|cell| cell as u64)),
            text("runs", all.map(|cell| names.get(cell).cloned().unwrap_or_default())),
        ];
        columns.extend(states.map(|state| whole(state.key(), stats.stations.iter().map(|times| times.of(state.id).0))));
        Table::new(columns)
    }

    /// What every FIFO held, or the queue of every node of a hypercube: a row a FIFO. `capacity` (none if they take all that come), `words`
    /// (through it), `max` and `mean` are in words, or rays; `full` and `empty` are shares of the run. Asked for by `enough`, that is the depth
    /// from which nothing changes any more, in words.
    #[getter]
    fn fifos(&self) -> PyResult<Table> {
        let stats = self.made.measured()?;
        let infos = || stats.topology.fifos.iter();
        let fifos = || stats.fifos.iter();
        let capacities: Option<Vec<u64>> = infos().map(|info| Some(info.capacity?.0)).collect();
        let mut columns = vec![
            text("name", infos().map(|info| info.name.clone())),
            text("channel", infos().map(|info| info.group.clone())),
            text("from", infos().map(|info| info.from.to_string())),
            text("to", infos().map(|info| info.to.to_string())),
        ];
        columns.extend(capacities.map(|words| whole("capacity", words)));
        columns.extend([
            whole("words", fifos().map(|fifo| fifo.words.0)),
            whole("max", fifos().map(|fifo| fifo.max.0)),
            number("mean", fifos().map(|fifo| Some(fifo.mean(stats.cycles)))),
            number("full", fifos().map(|fifo| Some(stats.share(fifo.full)))),
            number("empty", fifos().map(|fifo| Some(stats.share(fifo.empty)))),
        ]);
        if fifos().any(|fifo| fifo.enough.is_some()) {
            columns.push(whole("enough", fifos().map(|fifo| fifo.enough.unwrap_or_default().0)));
        }
        Table::new(columns)
    }

    /// Each ray's first hit, of a run in the order of the rays' numbers (of pixels, line by line), of an image in the order
    /// in which the host sent them: a structured array of `t` (inf on a miss),
    /// `polygon` (the number of the scene's face, -1 on a miss), `alpha` and `beta`.
    #[getter]
    fn hits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (setup, hits) = self.made.found()?;
        let polygons = setup.workload.polygons();
        let face = |hit: &Hit| if hit.is_hit() { i64::from(polygons.face(hit.polygon)) } else { -1 };
        let kinds = [("t", "f4"), ("polygon", "i8"), ("alpha", "f4"), ("beta", "f4")];
        let array = py.import("numpy")?.getattr("empty")?.call1((hits.len(), kinds.to_vec()))?;
        array.set_item("t", PyArray1::from_iter(py, hits.iter().map(|hit| hit.t)))?;
        array.set_item("polygon", PyArray1::from_iter(py, hits.iter().map(face)))?;
        array.set_item("alpha", PyArray1::from_iter(py, hits.iter().map(|hit| hit.alpha)))?;
        array.set_item("beta", PyArray1::from_iter(py, hits.iter().map(|hit| hit.beta)))?;
        Ok(array)
    }

    /// The picture: height x width x 3, linear light, line by line from the top left. None if the rays are no camera's.
    #[getter]
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f32>>>> {
        let size = self.made.setup("image")?.spec.size;
        let Some(pixels) = self.made.pixels() else { return Ok(None) };
        let array = PyArray1::from_vec(py, pixels);
        Ok(Some(array.reshape([size.height as usize, size.width as usize, 3])?))
    }

    /// The picture in so many `colors` at the most, from 1 to 65536: `colors`, the table (n x 3, bytes of red, green and blue as a screen has
    /// them); `pixels`, each one's place in it (height x width); and how far they are off, in steps of 255: `mean_square` and `largest`;
    /// `bound` is the most that an octree's can be. They are chosen by a `palette`: peano (the default), peano-large, fixed, popularity, median-cut or gervautz.
    #[pyo3(signature = (colors, palette=None))]
    fn few_colors<'py>(&self, py: Python<'py>, colors: i64, palette: Option<&str>) -> PyResult<Bound<'py, PyDict>> {
        let (most, palette) = few(py, colors, palette)?;
        let (size, pixels) = self.made.picture().map_err(|trouble| trouble.raise(py))?;
        let pixels = image::on_screen(&pixels);
        let table = briefly(py, |_| Ok(ColorTable::new(&pixels, most, palette)))?;
        let error = table.error(&pixels);
        let made = PyDict::new(py);
        let places = PyArray1::from_slice(py, &table.pixels);
        made.set_item("colors", PyArray1::from_vec(py, table.colors.concat()).reshape([table.colors.len(), 3])?)?;
        made.set_item("pixels", places.reshape([size.height as usize, size.width as usize])?)?;
        made.set_item("mean_square", error.mean_square)?;
        made.set_item("largest", error.largest)?;
        made.set_item("bound", table.bound())?;
        Ok(made)
    }

    /// The run over time, cut into bins of `bin` cycles: `start` is each one's first cycle; `cells` has for each state the
    /// cycles of every cell (cells x bins); `fifos` the `min`, `max` and `mean` of what every FIFO held, and the `full` cycles
    /// (FIFOs x bins); `rays` how many answers came back.
    #[getter]
    fn timelines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seen = self.seen(py)?;
        let profile = profile_of(&seen).map_err(|trouble| trouble.raise(py))?;
        let (bins, bin) = (profile.jobs.len(), profile.bin.0);
        let grid = |rows: usize, values: Vec<u64>| PyArray1::from_vec(py, values).reshape([rows, bins]);
        let cells = PyDict::new(py);
        for state in profile.topology.states.used() {
            let times = profile.stations.iter().flatten().map(|times| times.of(state.id).0);
            cells.set_item(state.key(), grid(profile.stations.len(), times.collect())?)?;
        }
        let held = || profile.fifos.iter().flat_map(|fifo| fifo.bins.iter());
        let count = profile.fifos.len();
        let length = |index: usize| bin.min(profile.cycles.0 - index as u64 * bin) as f64;
        let means = profile.fifos.iter().flat_map(|fifo| fifo.bins.iter().enumerate());
        let means = means.map(|(index, held)| held.word_cycles as f64 / length(index));
        let fifos = PyDict::new(py);
        fifos.set_item("min", grid(count, held().map(|held| held.min.0).collect())?)?;
        fifos.set_item("max", grid(count, held().map(|held| held.max.0).collect())?)?;
        fifos.set_item("mean", PyArray1::from_iter(py, means).reshape([count, bins])?)?;
        fifos.set_item("full", grid(count, held().map(|held| held.full.0).collect())?)?;
        let timelines = PyDict::new(py);
        timelines.set_item("bin", bin)?;
        timelines.set_item("start", PyArray1::from_iter(py, (0..bins as u64).map(|index| index * bin)))?;
        timelines.set_item("cells", cells)?;
        timelines.set_item("fifos", fifos)?;
        timelines.set_item("rays", PyArray1::from_slice(py, &profile.jobs))?;
        Ok(timelines)
    }

    /// The graphs of the run, as `--graphs` writes them to JSON: `G_r` of the scene's parts, `G_v` of the rays and `G_p` of the processes,
    /// each a dict that `networkx.node_link_graph(graph, edges="edges")` takes; and `classification`, what is known of them when.
    /// `of` is what G_r has beside the parts: regions (nothing), objects or polygons. With `pixels`, the columns and the lines from the
    /// first to before the last as ((10, 20), (40, 44)), G_v has each ray of these. They are found out by running it again.
    #[pyo3(signature = (*, of="regions", pixels=None))]
    fn graphs<'py>(&self, py: Python<'py>, of: &str, pixels: Option<Window>) -> PyResult<Bound<'py, PyDict>> {
        graphs::graphs(py, &self.made, self.crew, &graphs::asked(py, of, pixels)?)
    }

    /// All statistics: what `--stats` writes.
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.getattr("loads")?.call1((self.made.json()?,))
    }

    /// What was run, with every default filled in: `config=` repeats it.
    #[getter]
    fn config<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.getattr("loads")?.call1((self.configuration(py)?.to_string(),))
    }

    /// What the user should know: what had to be rounded, cut or assumed.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.made.notes()
    }

    /// All pictures of the run over time, by name.
    fn plots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seen = self.seen(py)?;
        let pictures = PyDict::new(py);
        for picture in briefly(py, |_| self.made.drawn(&seen))? {
            let name = picture.name.clone();
            pictures.set_item(name, Py::new(py, Picture { picture })?)?;
        }
        Ok(pictures)
    }

    /// A picture of the run over time: `cells` (of a farm `tasks`, and the first if none is named), `fifos`,
    /// `fifo-histograms`, `rays` or `latency`. (Of many FIFOs there is one for each channel: `fifos-x`, ...)
    #[pyo3(signature = (name=None))]
    fn plot<'py>(&self, py: Python<'py>, name: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
        let (pictures, name) = (self.plots(py)?, name.unwrap_or(self.made.first_picture()));
        let names = pictures.keys();
        let picture = pictures.get_item(name)?;
        picture.ok_or_else(|| PyKeyError::new_err(format!("there is no picture '{name}', there are {names}")))
    }

    /// The page that shows the run in a browser, as HTML.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let (seen, stats) = (self.seen(py)?, self.made.measured()?);
        briefly(py, |_| self.made.html(stats, &seen))
    }

    /// Writes results as the command does, all or none of each: statistics, hits, the picture, the page, a folder of plots, a
    /// trace for viewers (.pftrace, .vcd, .fst) of the cycles from `trace_window[0]` to before `trace_window[1]`. Files that
    /// exist are replaced only with `force`. Gives the files that it wrote.
    /// `colors` writes the picture in so many at the most, chosen by a `palette`, as `Run.few_colors` has it.
    #[pyo3(signature = (*, stats=None, hits=None, image=None, colors=None, palette=None, page=None, plot=None, trace=None, trace_window=None, force=false))]
    // A keyword each.
    #[expect(clippy::too_many_arguments)]
    fn save(
        &self,
        py: Python<'_>,
        stats: Option<PathBuf>,
        hits: Option<PathBuf>,
        image: Option<PathBuf>,
        colors: Option<i64>,
        palette: Option<&str>,
        page: Option<PathBuf>,
        plot: Option<PathBuf>,
        trace: Option<PathBuf>,
        trace_window: Option<(u64, u64)>,
        force: bool,
    ) -> PyResult<Vec<PathBuf>> {
        let mut written = Vec::new();
        if let Some(path) = stats {
            let json = self.made.json()?;
            written.push(briefly(py, |_| outputs::write(&path, force, |file| file.write_all(json.as_bytes())))?);
        }
        if let Some(path) = hits {
            let (setup, found) = self.made.found()?;
            let polygons = setup.workload.polygons();
            written.push(briefly(py, |_| outputs::write(&path, force, |file| hits::write(file, polygons, &found)))?);
        }
        if let Some(path) = image {
            self.made.setup("image")?;
            let colors = colors.map(|most| few(py, most, palette)).transpose()?;
            written.push(briefly(py, |_| self.made.save_picture(&path, colors, force))?);
        } else if colors.is_some() || palette.is_some() {
            return Err(wrong(py, "colors and palette are about the picture: name a file for it by image"));
        }
        let window = trace_window.map(|(from, until)| Cycles(from)..Cycles(until));
        if window.as_ref().is_some_and(Range::is_empty) {
            return Err(wrong(py, "trace_window has no cycle: its end must be larger than its start"));
        }
        let seen = || window.clone().map_or_else(|| self.seen(py), |window| self.seen_in(py, window));
        if let Some(path) = page {
            let (seen, stats) = (seen()?, self.made.measured()?);
            written.push(briefly(py, |_| {
                let html = self.made.html(stats, &seen)?;
                outputs::write(&path, force, |file| file.write_all(html.as_bytes()))
            })?);
        }
        if let Some(folder) = plot {
            let seen = seen()?;
            written.extend(briefly(py, |_| save_plots(&folder, force, self.made.drawn(&seen)?))?);
        }
        if let Some(path) = trace {
            let window = window.unwrap_or(Cycles(0)..Cycles(u64::MAX));
            written.extend(self.save_trace(py, &path, window, force)?);
        }
        Ok(written)
    }

    fn __str__(&self) -> String {
        self.made.text()
    }

    fn __repr__(&self) -> String {
        format!("<pcs_sim.Run: {}>", self.made.described().caption.title)
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let picture = match self.made.measured() {
            Ok(_) => {
                let seen = self.seen(py)?;
                let pictures = briefly(py, |_| self.made.drawn(&seen))?;
                let first = self.made.first_picture();
                pictures.into_iter().find(|picture| picture.name == first).map(|picture| picture.rendered.svg)
            }
            Err(_) => None,
        };
        let helpers = py.import("pcs_sim._helpers")?;
        helpers.getattr("html_text")?.call1((self.__str__(), picture))?.extract()
    }
}

/// How many colours are asked for, and how they are chosen.
fn few(py: Python<'_>, colors: i64, palette: Option<&str>) -> PyResult<(usize, Palette)> {
    let most = usize::try_from(colors).ok().filter(|most| (1..=ColorTable::MOST).contains(most));
    let most =
        most.ok_or_else(|| wrong(py, format!("{colors} colours: there can be from 1 to {}", ColorTable::MOST)))?;
    let chosen = palette.map(str::parse).transpose();
    let chosen = chosen.map_err(|why: String| wrong(py, format!("there is no such palette: {why}")))?;
    Ok((most, chosen.unwrap_or_default()))
}

impl Run {
    fn save_trace(&self, py: Python<'_>, path: &Path, window: Range<Cycles>, force: bool) -> PyResult<Vec<PathBuf>> {
        let format = Format::of(path).map_err(|error| Trouble::from(error).raise(py))?;
        let observed = self.watch(py, &Watching { recording: Some(window), ..Watching::default() })?;
        let recording = observed.recording.ok_or_else(|| has_none("a run that was not recorded", "trace"))?;
        let Described { caption, names, .. } = &self.made.described();
        let trace = Trace { caption, clock: self.made.clock(), cell_names: names, recording: &recording };
        let mut written = vec![briefly(py, |_| outputs::write(path, force, |file| trace.write(format, file)))?];
        if let Some(save) = Trace::save_path(format, path) {
            let text = trace.save_file(path);
            written.push(briefly(py, |_| outputs::write(&save, force, |file| file.write_all(text.as_bytes())))?);
        }
        for note in trace.notes(format) {
            let note = std::ffi::CString::new(note).unwrap_or_default();
            PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &note, 1)?;
        }
        Ok(written)
    }
}
