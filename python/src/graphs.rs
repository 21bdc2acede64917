//! The graphs of a run: by running it once more, with its rays gathered.

use std::convert::Infallible;

use pcs_sim::error::InputError;
use pcs_sim::report::graphs::{Asked, Format, Gathered, Graphs, Of, of_cube, of_line};
use pcs_sim::run::{self, CubeSetup, Seen, Setup, Switch, Timed};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::calls::samples;
use crate::made::{Made, UNTIMED, has_none};
use crate::trouble::{Trouble, wrong};
use crate::work::{Crew, Task, work};

/// Columns and lines of an image, each from the first to before the last.
pub type Window = ((u32, u32), (u32, u32));

/// What is asked of graphs, as the command's flags have it.
pub fn asked(py: Python<'_>, of: &str, pixels: Option<Window>) -> PyResult<Asked> {
    let of = match of {
        "regions" => Of::Regions,
        "objects" => Of::Objects,
        "polygons" => Of::Polygons,
        _ => {
            let message = format!("invalid value '{of}' for of: expected one of regions, objects, polygons");
            return Err(wrong(py, message));
        }
    };
    let window = |((left, right), (top, bottom))| format!("{left}..{right},{top}..{bottom}").parse();
    let pixels = pixels.map(window).transpose();
    let pixels = pixels.map_err(|why: String| wrong(py, format!("these are no pixels: {why}")))?;
    Ok(Asked { of, pixels })
}

/// The graphs of a run, as the command's JSON has them: `G_r`, `G_v`, `G_p` and `classification`.
pub fn graphs<'py>(py: Python<'py>, made: &Made, crew: Crew, asked: &Asked) -> PyResult<Bound<'py, PyDict>> {
    let size = match made {
        Made::Replay { .. } => return Err(has_none("a replay", "graphs")),
        Made::Farm { .. } => return Err(has_none("a farm", "graphs")),
        Made::Image { setup, .. } if setup.image().timing == Switch::Off => return Err(has_none(UNTIMED, "graphs")),
        Made::Rays { setup, .. } | Made::Image { setup, .. } => setup.spec.size,
        Made::Cube { setup, .. } => setup.spec.size,
    };
    let fits = asked.pixels.map_or(Ok(()), |window| window.check(size));
    fits.map_err(|error| Trouble::from(error).raise(py))?;
    let graphs = work(py, crew, "rays", |task| match made {
        Made::Rays { setup, .. } => of_rays(setup, asked, task),
        Made::Image { setup, .. } => of_image(setup, asked, task),
        Made::Cube { setup, .. } => of_nodes(setup, asked, task),
        Made::Replay { .. } | Made::Farm { .. } => Err(InputError::new("it has no graphs").into()),
    })?;
    let told = PyDict::new(py);
    let read = |json: String| py.import("json")?.getattr("loads")?.call1((json,));
    for graph in graphs.all() {
        told.set_item(graph.name, read(Format::Json.write(graph))?)?;
    }
    told.set_item("classification", read(graphs.classification)?)?;
    Ok(told)
}

fn of_rays(setup: &Setup, asked: &Asked, task: &Task) -> Result<Graphs, Trouble> {
    let (mut gathered, rays) = (Gathered::new(setup), &setup.prepared.rays);
    task.set(0, rays.len() as u64);
    let watched = (&setup.machine.spec, &asked.watching());
    let outcome = run::run_watched(&setup.workload, watched, rays, &task.workers, |batch, _| {
        task.add(batch.hits.len() as u64);
        gathered.take_batch(batch, setup);
        Ok::<_, Infallible>(())
    })?;
    Ok(of_line(setup, &gathered, (&outcome.stats, &outcome.observed), asked)?)
}

fn of_image(setup: &Setup, asked: &Asked, task: &Task) -> Result<Graphs, Trouble> {
    let mut gathered = Gathered::new(setup);
    let rules = setup.image().host_rules(setup.spec.order);
    let timed = Timed { spec: &setup.machine.spec, rules, watching: asked.watching() };
    let rendered = run::render(&setup.picture(), Some(timed), &task.workers, |seen| {
        match seen {
            Seen::Samples { done, of, .. } => task.set(done as u64, of as u64),
            Seen::Grown(trees, pixels) => gathered.take_trees(trees, pixels),
            Seen::Sent(.., ray) => gathered.take_sent(ray),
        }
        Ok::<_, Infallible>(())
    })?;
    let timing = rendered.timing.ok_or_else(|| InputError::new("the image was not timed"))?;
    Ok(of_line(setup, &gathered, (&timing.stats, &timing.observed), asked)?)
}

/// The image is laid out once more, with its hits, which nobody else asks for.
fn of_nodes(setup: &CubeSetup, asked: &Asked, task: &Task) -> Result<Graphs, Trouble> {
    let spec = setup.spec.clone();
    let told = samples(task, spec.samples());
    let setup = CubeSetup::new(spec, true, &task.workers, told)?;
    let outcome = setup.run(&asked.watching(), &task.workers.cancel)?;
    Ok(of_cube(&setup, &outcome, asked)?)
}
