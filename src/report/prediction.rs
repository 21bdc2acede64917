//! The cost model held against a run: what it predicts, what the functional half counts, what the timing half measures.

use serde::Serialize;

use super::summary::{aligned, grouped, table, wrapped};
use crate::measure::Measured;
use crate::model::{ArrayModel, CellLoad, Depth, Expectation, Limit, LinkLoad, Prediction, Stage};
use crate::program::{ArrayProgram, CellMemory, Counts, Workload};
use crate::run::{CountedLoads, Forecast, RunSpec};

/// A run, for the model to be held against.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// How the scene was laid out.
    pub workload: &'a Workload,
    /// What was counted.
    pub counts: &'a Counts,
    /// What was measured.
    pub stats: &'a Measured,
}

/// One quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What it is.
    pub quantity: String,
    /// By the paper's formulas.
    pub paper: Option<f64>,
    /// By the model, from what it has surveyed.
    pub model: f64,
    /// By the functional half.
    pub counted: Option<f64>,
    /// By the timing half.
    pub measured: Option<f64>,
}

impl Row {
    pub(super) fn new(quantity: impl Into<String>, model: f64) -> Row {
        Row { quantity: quantity.into(), paper: None, model, counted: None, measured: None }
    }

    fn paper(self, paper: f64) -> Row {
        Row { paper: Some(paper), ..self }
    }

    pub(super) fn counted(self, counted: Option<f64>) -> Row {
        Row { counted, ..self }
    }

    pub(super) fn measured(self, measured: Option<f64>) -> Row {
        Row { measured, ..self }
    }

    /// By which share the model is above what was measured, or else counted.
    pub fn error(&self) -> Option<f64> {
        let truth = self.measured.or(self.counted)?;
        (truth != 0.0).then(|| self.model / truth - 1.0)
    }
}

/// All quantities, of a prediction alone or with the run that it was made for.
pub fn rows(forecast: &Forecast, run: Option<Run<'_>>) -> Vec<Row> {
    let (prediction, array) = (&forecast.predicted, &forecast.array);
    let loads = run.map(|run| CountedLoads::new(run.stats, array, &prediction.cells));
    let mut rows = counts(prediction, array, run);
    rows.extend(memory(prediction, array, run));
    rows.extend(cells(prediction, array, loads.as_ref()));
    rows.extend(speed(forecast, run, loads.as_ref()));
    rows
}

fn counts(prediction: &Prediction, array: &ArrayModel, run: Option<Run<'_>>) -> Vec<Row> {
    let a_ray = |of: fn(&Counts) -> u64| run.map(|run| of(run.counts) as f64 / run.stats.jobs.max(1) as f64);
    let slabs = array.has_slabs();
    let candidates = a_ray(if slabs { |counts| counts.slab_tests } else { |counts| counts.intersection_tests });
    let mut rows = vec![
        Row::new("voxels a ray", prediction.total(|work| work.voxels))
            .paper(prediction.paper.voxels)
            .counted(a_ray(|counts| counts.voxels)),
        Row::new("candidates a ray", prediction.total(|work| work.candidates))
            .paper(prediction.paper.candidates)
            .counted(candidates),
    ];
    if slabs {
        let survivors = prediction.total(|work| work.survivors);
        rows.push(Row::new("slabs passed a ray", survivors).counted(a_ray(|counts| counts.intersection_tests)));
    }
    rows
}

fn memory(prediction: &Prediction, array: &ArrayModel, run: Option<Run<'_>>) -> Vec<Row> {
    let sizes = &prediction.sizes;
    let grids =
        |of: fn(&crate::geometry::Grid) -> usize| run.map(|run| run.workload.grids().map(of).sum::<usize>() as f64);
    let references = grids(|grid| grid.reference_count());
    let voxels = grids(|grid| grid.voxel_count());
    let words = |of: fn(&CellMemory) -> u64| {
        run.map(|run| (0..run.workload.cells()).map(|cell| of(&run.workload.memory_of(cell))).sum::<u64>() as f64)
    };
    let paper = &prediction.paper;
    let mut rows = vec![
        Row::new("voxels a polygon", sizes.voxels_per_polygon())
            .paper(paper.voxels_per_polygon)
            .counted(references.map(|references| references / sizes.polygons.max(1.0))),
        Row::new("polygons a voxel", sizes.polygons_per_voxel())
            .paper(paper.polygons_per_voxel)
            .counted(references.zip(voxels).map(|(references, voxels)| references / voxels.max(1.0))),
        Row::new("words of grids", sizes.grid_words()).paper(paper.grid_words).counted(words(|memory| memory.grid.0)),
    ];
    if array.has_slabs() {
        let slabs = sizes.slabs_words();
        rows.push(Row::new("words of slabs", slabs).paper(slabs).counted(words(|memory| memory.slabs.0)));
    }
    rows
}

/// For each stage, the cell of the group that has most to do there.
fn cells(prediction: &Prediction, array: &ArrayModel, loads: Option<&CountedLoads>) -> Vec<Row> {
    let stages = array.stages.len();
    let most = |cells: &[CellLoad], stage: usize| {
        cells.iter().skip(stage).step_by(stages).map(CellLoad::total).fold(0.0, f64::max)
    };
    let row = |stage: usize| {
        let which = if prediction.groups.len() > 1 { "busiest " } else { "" };
        let name = format!("cycles a ray, {which}{} cell", stage_name(array.stages[stage]));
        Row::new(name, most(&prediction.cells, stage)).counted(loads.map(|loads| most(&loads.cells, stage)))
    };
    (0..stages).map(row).collect()
}

fn speed(forecast: &Forecast, run: Option<Run<'_>>, loads: Option<&CountedLoads>) -> Vec<Row> {
    let Forecast { predicted: prediction, array, expected, .. } = forecast;
    let bound = prediction.bound.cycles_per_ray;
    let counted = loads.map(|loads| loads.bound.cycles_per_ray);
    let measured = run.map(|run| run.stats.cycles.0 as f64 / run.stats.jobs.max(1) as f64);
    let rate = |cycles: f64| array.cycles_per_second / cycles;
    let mut rows = vec![
        Row::new("cycles a ray, at least", bound).counted(counted),
        Row::new("rays a second, at most", rate(bound)).counted(counted.map(rate)),
    ];
    if let Some(expected) = expected {
        let lost = counted.zip(measured).map(|(counted, cycles)| 100.0 * (1.0 - counted / cycles));
        rows.push(Row::new("cycles a ray", expected.cycles_per_ray).measured(measured));
        rows.push(Row::new("rays a second", rate(expected.cycles_per_ray)).measured(measured.map(rate)));
        rows.push(Row::new("lost to waiting, %", 100.0 * expected.loss()).measured(lost));
    }
    let cycles = expected.as_ref().map_or(bound, |expected| expected.cycles_per_ray);
    let busiest = |links: &[LinkLoad]| links.iter().map(|link| link.cycles(array.links)).fold(0.0, f64::max);
    let link = loads.zip(measured).map(|(loads, cycles)| 100.0 * busiest(&loads.links) / cycles);
    rows.push(Row::new("busiest link used, %", 100.0 * busiest(&prediction.links) / cycles).measured(link));
    let host = Row::new("host used, %", 100.0 * prediction.host / cycles);
    rows.push(host.measured(measured.map(|cycles| 100.0 * prediction.host / cycles)));
    rows
}

fn stage_name(stage: Stage) -> String {
    let kernels = [(stage.grid, "grid"), (stage.slabs, "slabs"), (stage.intersection, "intersection")];
    let names: Vec<&str> = kernels.iter().filter(|kernel| kernel.0).map(|kernel| kernel.1).collect();
    names.join("+")
}

/// Columns that a quantity's name has.
const QUANTITY_WIDTH: usize = 34;

/// The quantities as a table.
pub fn to_table(rows: &[Row]) -> String {
    let has_run = rows.iter().any(|row| row.counted.is_some() || row.measured.is_some());
    let has_paper = rows.iter().any(|row| row.paper.is_some());
    let of_run = ["counted", "measured", "error"];
    let header = [""].into_iter().chain(has_paper.then_some("paper")).chain(["model"]);
    let header: Vec<&str> = header.chain(of_run.into_iter().filter(|_| has_run)).collect();
    let mut text = table(&header);
    for row in rows {
        let optional = |value: Option<f64>| value.map_or(String::new(), number);
        let quantity = wrapped(&row.quantity, QUANTITY_WIDTH);
        let mut cells = vec![quantity];
        cells.extend(has_paper.then(|| optional(row.paper)));
        cells.push(number(row.model));
        if has_run {
            let error = row.error().map_or(String::new(), |error| format!("{:+.1} %", 100.0 * error));
            cells.extend([optional(row.counted), optional(row.measured), error]);
        }
        text.add_row(cells);
    }
    aligned(text)
}

/// A figure as people read it: whole from a thousand on.
fn number(value: f64) -> String {
    if value >= 1000.0 { grouped(value.round() as u64) } else { format!("{value:.2}") }
}

/// What the model expects to limit the array, the coefficient that it would take instead, what is lost to waiting, and how deep FIFOs
/// must be for less.
pub fn sentences(forecast: &Forecast) -> String {
    let Forecast { predicted, best: (coefficient, other), array, expected, .. } = forecast;
    let rate = |cycles: f64| grouped((array.cycles_per_second / cycles).round() as u64);
    let limit = |prediction: &Prediction| rate(prediction.bound.cycles_per_ray);
    let waiting = match expected {
        Some(expected) => waiting(forecast, expected, &rate(expected.cycles_per_ray)),
        None => "With these FIFOs it expects the cells to come to a stop.\n".to_owned(),
    };
    format!(
        "The model expects {} to limit the array to {} rays/s.\n\
         Of the grid coefficients from 0.5 to 500 it takes {coefficient} for the best: {} would limit it to {} rays/s.\n\
         {waiting}",
        limit_name(predicted, array),
        limit(predicted),
        limit_name(other, array),
        limit(other),
    )
}

/// What is lost to waiting, and how deep FIFOs must be for less.
fn waiting(forecast: &Forecast, expected: &Expectation, rate: &str) -> String {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let mut text = format!(
        "In this order of rays it expects {rate} rays/s (from {} of them): {} of the time is lost to waiting; with FIFOs that are never \
         full it would be {}.\n",
        grouped(forecast.traced as u64),
        percent(expected.loss()),
        percent(expected.least_loss()),
    );
    let depths: Vec<String> = forecast
        .depths
        .iter()
        .map(|depth| {
            let words = |words: u64| grouped(words);
            format!(
                "{} % are lost with {} words on X and {} on Y",
                (100.0 * depth.loss).round(),
                words(depth.x),
                words(depth.y)
            )
        })
        .collect();
    if !depths.is_empty() {
        text += &format!("At most {}.\n", depths.join("; "));
    }
    text
}

/// The bottleneck, by name.
fn limit_name(prediction: &Prediction, array: &ArrayModel) -> String {
    match prediction.bound.limit {
        Limit::Host => "the host".to_owned(),
        Limit::Link(link) if link == prediction.cells.len() => "the link back to the host".to_owned(),
        Limit::Link(link) => format!("the link into cell {link}"),
        Limit::Cell(cell) => format!("cell {cell} ({})", stage_name(array.stages[cell % array.stages.len()])),
    }
}

#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    program: &'a ArrayProgram,
    limit: String,
    quantities: &'a [Row],
    best_grid_coefficient: f64,
    best_rays_per_second: f64,
    waiting: Option<Waiting>,
    configuration: &'a RunSpec,
}

#[derive(Serialize)]
struct Waiting {
    rays_traced: usize,
    cycles_per_ray: f64,
    rays_per_second: f64,
    lost: f64,
    lost_with_deep_fifos: f64,
    depths: Vec<Words>,
}

#[derive(Serialize)]
struct Words {
    lost: f64,
    x_fifo_words: u64,
    y_fifo_words: u64,
}

/// All of it as indented JSON.
pub fn to_json((scene, spec): (&str, &RunSpec), rows: &[Row], forecast: &Forecast) -> serde_json::Result<String> {
    let Forecast { predicted, best, array, expected, depths, traced, .. } = forecast;
    let words = |depth: &Depth| Words { lost: depth.loss, x_fifo_words: depth.x, y_fifo_words: depth.y };
    let waiting = expected.as_ref().map(|expected| Waiting {
        rays_traced: *traced,
        cycles_per_ray: expected.cycles_per_ray,
        rays_per_second: array.cycles_per_second / expected.cycles_per_ray,
        lost: expected.loss(),
        lost_with_deep_fifos: expected.least_loss(),
        depths: depths.iter().map(words).collect(),
    });
    let report = Report {
        scene,
        program: &spec.program,
        limit: limit_name(predicted, array),
        quantities: rows,
        best_grid_coefficient: best.0,
        best_rays_per_second: array.cycles_per_second / best.1.bound.cycles_per_ray,
        waiting,
        configuration: spec,
    };
    serde_json::to_string_pretty(&report).map(|json| json + "\n")
}
