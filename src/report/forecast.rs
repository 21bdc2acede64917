//! What a sub-sample predicts of an image on a hypercube, held against the image.

use serde::Serialize;

use super::cube::{at_least, machine_line, means, sentence};
use super::prediction::{Row, to_table};
use super::summary::{plural, prose};
use crate::machine::{Cycles, Ipsc2};
use crate::model::Bounds;
use crate::program::cube::TaskGraph;
use crate::run::{CubeForecast, CubeOutcome, CubeSetup, CubeSpec};

/// The image itself, with what it takes at the least by all its rays.
#[derive(Clone, Copy, Debug)]
pub struct Made<'a> {
    /// What was run.
    pub setup: &'a CubeSetup,
    /// What it came to.
    pub outcome: &'a CubeOutcome,
    /// The bounds.
    pub bounds: &'a Bounds,
}

/// All quantities, of a forecast alone or with the image that it was made for.
pub fn rows(forecast: &CubeForecast, machine: &Ipsc2, made: Option<Made<'_>>) -> Vec<Row> {
    let CubeForecast { sample, times, regions_of_line, one_node, bounds } = forecast;
    let has_regions = bounds.busiest().is_some();
    let seconds = |cycles: Cycles| machine.clock.seconds(cycles);
    let graph = made.map(|made| &made.setup.scene.graph);
    let counted = |of: fn(&TaskGraph) -> f64| graph.map(of);
    let of_bounds = |of: fn(&Bounds) -> Cycles| made.map(|made| seconds(of(made.bounds)));
    let a_ray = |count: u64, graph: &TaskGraph| count as f64 / graph.rays.len().max(1) as f64;
    let mut rows = vec![Row::new("rays", sample.graph.rays.len() as f64 * times).counted(counted(rays))];
    rows.extend(regions_of_line.map(|met| Row::new("regions a random line meets", met)));
    if has_regions {
        let sent = made.map(|made| a_ray(made.bounds.ray_messages, &made.setup.scene.graph));
        let messages = a_ray(bounds.ray_messages, &sample.graph) / times;
        rows.extend([
            Row::new("regions a ray meets", legs_a_ray(&sample.graph)).counted(counted(legs_a_ray)),
            Row::new("ray messages a ray", messages).counted(sent),
        ]);
    }
    rows.push(
        Row::new("seconds of one node", seconds(*one_node)).counted(made.map(|made| seconds(made.outcome.one_node))),
    );
    let busiest = |bounds: &Bounds| bounds.busiest().map_or(Cycles(0), |(_, work)| work);
    if has_regions {
        rows.push(Row::new("seconds of the busiest node's work", seconds(busiest(bounds))).counted(of_bounds(busiest)));
    }
    rows.extend([
        Row::new("seconds of an equal part of all work", seconds(bounds.equal))
            .counted(of_bounds(|bounds| bounds.equal)),
        Row::new("seconds of a pixel's longest chain", seconds(bounds.chain)).counted(of_bounds(|bounds| bounds.chain)),
        Row::new("seconds, at least", seconds(bounds.least()))
            .counted(of_bounds(Bounds::least))
            .measured(made.map(|made| seconds(made.outcome.stats.cycles))),
    ]);
    rows
}

fn rays(graph: &TaskGraph) -> f64 {
    graph.rays.len() as f64
}

fn legs_a_ray(graph: &TaskGraph) -> f64 {
    graph.legs.len() as f64 / rays(graph).max(1.0)
}

/// What people read of a forecast, alone or with the image that it was made for.
pub fn text(spec: &CubeSpec, machine: &Ipsc2, forecast: &CubeForecast, made: Option<Made<'_>>) -> String {
    let CubeForecast { sample, bounds, .. } = forecast;
    let title = format!(
        "image of {} ({}) on {} {}: {}, {} of them sampled",
        sample.name,
        plural(sample.polygons as u64, "polygon"),
        plural(spec.machine.nodes as u64, "node"),
        means(spec),
        plural(spec.size.pixels() as u64, "pixel"),
        plural(sample.graph.trees.len() as u64, "pixel"),
    );
    let expected = format!("The model expects that it takes {}.", at_least(bounds, machine.clock));
    let measured = made.map(|Made { setup, outcome, bounds }| {
        let times = outcome.stats.cycles.0 as f64 / bounds.least().0.max(1) as f64;
        format!("\nMeasured: {times:.2} times as long as by all its rays at the least. {}", sentence(setup, outcome))
    });
    let head = format!("{title}\n{}", machine_line(spec));
    let sentences = format!("{expected}{}\n", measured.unwrap_or_default());
    format!("{}\n\n{}\n{}", prose(&head), to_table(&rows(forecast, machine, made)), prose(&sentences))
}

#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    quantities: &'a [Row],
    configuration: &'a CubeSpec,
}

/// All of it as indented JSON.
pub fn to_json(spec: &CubeSpec, scene: &str, rows: &[Row]) -> serde_json::Result<String> {
    let report = Report { scene, quantities: rows, configuration: spec };
    serde_json::to_string_pretty(&report).map(|json| json + "\n")
}
