//! What the model expects to be lost while cells wait: its recurrence against the array, and what it makes of a few rays against the
//! whole run, with the errors that docs/cost-model.md states.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;

use crate::support::random_ops::{batches_of, case, costs};
use crate::support::{machine, ops, program, scene, workload};
use pcs_sim::cancel::Cancel;
use pcs_sim::geometry::{Partition, Ray};
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::order::Order;
use pcs_sim::machine::{Array, MachineSpec, Unfinished, Words};
use pcs_sim::model::passage::Passage;
use pcs_sim::program::ArrayProgram;
use pcs_sim::run;
use pcs_sim::seam::{Costs, OpBatch};
use proptest::prelude::*;

/// The cycles of the array; `None` if it stands still.
fn cycles(spec: &MachineSpec, costs: &Costs, batches: &[Arc<OpBatch>]) -> Option<u64> {
    let mut array = Array::new(spec, costs, batches[0].cells.len());
    for batch in batches {
        array.feed(Arc::clone(batch)).expect("an array can do it");
        array.run().ok()?;
    }
    match array.finish() {
        Ok(run) => Some(run.cycles.0),
        Err(Unfinished::Outlived(cycles)) => Some(cycles.0),
        Err(Unfinished::Stuck(_)) => None,
    }
}

/// The cycles of the recurrence over all rays.
fn passed(spec: &MachineSpec, costs: &Costs, batches: &[Arc<OpBatch>]) -> Option<u64> {
    let cells = batches[0].cells.len();
    let mut passage = Passage::new(cells);
    batches.iter().for_each(|batch| passage.take(batch, costs));
    let order: Vec<u32> = (0..passage.rays() as u32).collect();
    passage.cycles(&order, &run::fifos(spec, cells), u64::MAX)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, ..ProptestConfig::default() })]

    /// It is a bound from below, whatever the ops and the machine, and comes to an end wherever the array does.
    #[test]
    fn the_recurrence_is_never_above_the_array((spec, cells, rays, per_batch) in case()) {
        let batches: Vec<Arc<OpBatch>> = batches_of(cells, &rays, per_batch).into_iter().map(Arc::new).collect();
        let (array, passed) = (cycles(&spec, &costs(), &batches), passed(&spec, &costs(), &batches));
        if let Some(array) = array {
            prop_assert!(passed.is_some_and(|passed| passed <= array), "{passed:?} {array}");
        }
    }
}

/// On real programs only what holds up words inside messages is missing.
#[test]
fn the_recurrence_is_near_the_array_on_real_scenes() {
    for (name, size) in [("room", 1), ("teapot", 3), ("reference", 20)] {
        let (scene, rays) = scene(name, size, 24);
        for (mode, groups, stop_words, bounded_walk) in [
            ("pipeline", 1, None, false),
            ("pipeline", 1, Some(2), false),
            ("broadcast", 1, None, false),
            ("broadcast", 7, None, false),
            ("broadcast", 7, None, true),
            ("hybrid", 4, None, false),
            ("hybrid-3", 3, Some(2), false),
        ] {
            let program = ArrayProgram { stop_words, bounded_walk, ..program(mode, groups) };
            let workload = workload(&scene.mesh, &program, &rays);
            let batches: Vec<Arc<OpBatch>> = ops(&workload, &rays).into_iter().map(Arc::new).collect();
            for (fifo_words, link_mb_s, most) in
                [(512, 80.0, 0.001), (64, 80.0, 0.001), (20, 80.0, 0.005), (512, 20.0, 0.002)]
            {
                let spec = MachineSpec { fifo_words: Words(fifo_words), link_mb_s, ..MachineSpec::default() };
                let array = cycles(&spec, workload.costs(), &batches).unwrap() as f64;
                let passed = passed(&spec, workload.costs(), &batches).unwrap() as f64;
                let error = 1.0 - passed / array;
                assert!((0.0..=most).contains(&error), "{name} {program:?} {fifo_words} {link_mb_s}: {error}");
            }
        }
    }
}

/// Every built-in scene.
const SCENES: [(&str, u32); 12] = [
    ("balls", 2),
    ("gears", 2),
    ("lattice", 4),
    ("mountain", 6),
    ("rings", 3),
    ("shells", 3),
    ("sombrero", 1),
    ("teapot", 8),
    ("tetra", 6),
    ("tree", 7),
    ("room", 1),
    ("reference", 10),
];

const WIDTH: u32 = 192;
const DEPTHS: [u64; 4] = [16, 128, 512, 1 << 20];
const ORDERS: [&str; 6] = ["raster", "columns", "tiles:8", "hilbert", "stride", "shuffle:1"];

fn arrays() -> [(&'static str, ArrayProgram); 5] {
    let cut = |partition, program: ArrayProgram| ArrayProgram { partition, ..program };
    [
        ("3 cells, pipeline", program("pipeline", 1)),
        ("4 cells, regular", program("broadcast", 4)),
        ("16 cells, measured", cut(Partition::Measured, program("broadcast", 16))),
        ("32 cells, work", cut(Partition::Work, program("broadcast", 32))),
        ("16 cells, hybrid, work", cut(Partition::Work, program("hybrid", 8))),
    ]
}

/// What an error is of: an array, an order of rays and a depth, by their places.
type Place = (usize, usize, usize);

/// By how much percent the time that the model expects is off, on one scene.
fn errors((name, size): (&str, u32)) -> Vec<(Place, f64)> {
    let mut errors = Vec::new();
    let (scene, rays) = scene(name, size, WIDTH);
    for (array, (_, program)) in arrays().into_iter().enumerate() {
        let workload = workload(&scene.mesh, &program, &rays);
        for (place, order) in ORDERS.into_iter().enumerate() {
            let sequence = order.parse::<Order>().unwrap().of_pixels(ImageSize { width: WIDTH, height: WIDTH });
            let rays: Vec<Ray> = sequence.arrange(rays.clone());
            let batches: Vec<Arc<OpBatch>> = traced(&workload, &rays);
            let few = run::few(&workload, &rays, &Cancel::default()).unwrap();
            for (column, words) in DEPTHS.into_iter().enumerate() {
                let spec = MachineSpec { fifo_words: Words(words), ..machine().spec };
                let measured = cycles(&spec, workload.costs(), &batches).unwrap() as f64 / rays.len() as f64;
                let expected = few.expect(&run::fifos(&spec, workload.cells())).unwrap();
                errors.push(((array, place, column), 100.0 * (expected.cycles_per_ray / measured - 1.0)));
            }
        }
    }
    errors
}

const DOCUMENT: &str = include_str!("../../docs/cost-model.md");

/// Of a few scenes all errors lie between those of the table in docs/cost-model.md.
#[test]
fn the_documented_errors_of_the_time_hold() {
    let arrays = arrays();
    let range = |(array, place, column): Place| -> (f64, f64) {
        let row = format!("| {} | {} | ", arrays[array].0, ORDERS[place]);
        let cells = DOCUMENT.split_once(&row).expect("a row of the table").1;
        let (least, most) = cells.split(" | ").nth(column).and_then(|cell| cell.split_once(" to ")).expect("a range");
        let most = most.split(' ').next().unwrap_or_default();
        (least.parse().expect("a number"), most.parse().expect("a number"))
    };
    for scene in [("room", 1), ("sombrero", 1)] {
        for (place, error) in errors(scene) {
            let ((least, most), rounded) = (range(place), (10.0 * error).round() / 10.0);
            assert!((least..=most).contains(&rounded), "{scene:?} {place:?}: {error} is not in {least} to {most}");
        }
    }
}

/// The table itself, over all built-in scenes.
#[test]
#[ignore = "it takes minutes: run it when the model or the array has changed"]
fn the_documented_errors_of_the_time_are_these() {
    let mut ranges: BTreeMap<Place, (f64, f64)> = BTreeMap::new();
    for (place, error) in SCENES.into_iter().flat_map(errors) {
        let range = ranges.entry(place).or_insert((error, error));
        *range = (range.0.min(error), range.1.max(error));
    }
    let mut table = String::from(
        "| array | order | 16 words | 128 words | 512 words | 1 048 576 words |\n| --- | --- | ---: | ---: | ---: | ---: |\n",
    );
    for (array, (what, _)) in arrays().iter().enumerate() {
        for (place, order) in ORDERS.iter().enumerate() {
            let cell = |column| {
                let (least, most) = ranges[&(array, place, column)];
                format!("{least:+.1} to {most:+.1}")
            };
            let cells: Vec<String> = (0..DEPTHS.len()).map(cell).collect();
            table += &format!("| {what} | {order} | {} |\n", cells.join(" | "));
        }
    }
    insta::assert_snapshot!("errors_of_the_time", table);
    assert!(DOCUMENT.contains(&table), "docs/cost-model.md has another table");
}

fn traced(workload: &pcs_sim::program::Workload, rays: &[Ray]) -> Vec<Arc<OpBatch>> {
    let mut batches = Vec::new();
    run::trace(workload, rays, &run::Workers::new(2), |batch| {
        batches.push(Arc::new(batch.ops));
        Ok::<_, Infallible>(run::TracedBatch::default())
    })
    .unwrap();
    batches
}
