//! What is at hand stands for what is named: scenes and rays of arrays, runs and sweeps in JSON.

use std::convert::Infallible;
use std::sync::Arc;

use pcs_sim::host::ray_file;
use pcs_sim::run::{self, Layers, Outcome, PlannedRun, RunOptions, RunSpec, Setup, Workers};
use pcs_sim::scene::Arrays;
use pcs_sim::sweep::Sweep;
use serde_json::json;

use crate::support::command::Folder;

const OBJ: &str = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 2 3\nf 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
const POINTS: [[f64; 3]; 5] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0], [2.0, 2.0, 3.0]];
const FACES: [&[i64]; 5] = [&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];

fn pyramid() -> Arrays<'static> {
    let (colors, lights) = (&[], &[]);
    // An OBJ file's vertical.
    let up = [0.0, 1.0, 0.0];
    Arrays {
        name: "pyramid",
        points: &POINTS,
        faces: &FACES,
        colors,
        lights,
        background: [0.0; 3],
        view: None,
        up,
        angle: 40.0,
    }
}

fn planned(parameters: &[(&str, &str)]) -> PlannedRun {
    let mut options = RunOptions::default();
    parameters.iter().for_each(|(name, value)| options.set(name, value).unwrap());
    PlannedRun::new(RunSpec::new(&options, None).unwrap()).unwrap()
}

fn outcome(run: PlannedRun, mut layers: Layers) -> Outcome {
    let workers = Workers::new(2);
    let setup = Setup::new(run, &mut layers, &workers.cancel).unwrap();
    let rays = &setup.prepared.rays;
    run::run(&setup.workload, &setup.machine.spec, rays, &workers, |_| Ok::<_, Infallible>(())).unwrap()
}

#[test]
fn a_scene_of_arrays_is_as_one_of_a_file() {
    let folder = Folder::new();
    let file = folder.file("pyramid.obj", OBJ);
    let read = outcome(planned(&[("scene", file.to_str().unwrap()), ("size", "24x24")]), Layers::default());
    let (run, mut layers) = (planned(&[("scene", "pyramid (arrays)"), ("size", "24x24")]), Layers::default());
    layers.give_scene(&run, Arc::new(pyramid().scene().unwrap()));
    let given = outcome(run, layers);
    assert!(given.counts.hits > 100);
    assert_eq!(given, read);
}

#[test]
fn rays_of_numbers_are_as_those_of_a_file() {
    let folder = Folder::new();
    let numbers = |k: u32| [f64::from(k % 5), -8.0, 0.3 * f64::from(k % 7), 0.1, 1.0, 0.05, f64::INFINITY];
    let lines = (0..35).map(|k| numbers(k).map(|number| number.to_string()).join(",") + "\n");
    let file = folder.file("rays.csv", "ox,oy,oz,dx,dy,dz,tmax\n".to_owned() + &lines.collect::<String>());
    let read = outcome(planned(&[("scene", "room"), ("rays", file.to_str().unwrap())]), Layers::default());
    let (run, mut layers) = (planned(&[("scene", "room"), ("rays", "none.csv")]), Layers::default());
    layers.give_rays(&run, (0..35).map(|k| ray_file::ray(numbers(k)).unwrap()).collect()).unwrap();
    assert_eq!(outcome(run, layers), read);
}

#[test]
fn what_arrays_cannot_be_is_said() {
    let refused = |arrays: Arrays| arrays.scene().unwrap_err().to_string();
    let faces: &[&[i64]] = &[&[0, 1, 5]];
    assert_eq!(refused(Arrays { faces, ..pyramid() }), "face 0: there is no point 5, there are 5 points, from 0");
    let faces: &[&[i64]] = &[&[0, 1]];
    let none = refused(Arrays { faces, ..pyramid() });
    assert!(none.contains("the file has no faces") && none.contains("1 face of fewer than 3 corners"), "{none}");
    let points = &[[f64::NAN; 3]];
    assert_eq!(refused(Arrays { points, ..pyramid() }), "point 0: NaN is not a finite number");
    let colors = &[[0.5; 3]];
    assert_eq!(refused(Arrays { colors, ..pyramid() }), "there are 5 points and 1 colours: it takes one for each");
    let view = Some(([1.0; 3], [1.0; 3]));
    assert_eq!(refused(Arrays { view, ..pyramid() }), "camera is in the very point that it looks at");
    assert_eq!(ray_file::ray([0.0; 7]).unwrap_err(), "the direction is zero");
    let behind = ray_file::ray([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0]);
    assert_eq!(behind.unwrap_err(), "a tmax of -1, expected one of 0 or more, or inf");
}

#[test]
fn a_run_in_json_is_the_run() {
    let spec = planned(&[("scene", "room"), ("mode", "broadcast"), ("cells", "3")]).spec;
    let value = serde_json::to_value(&spec).unwrap();
    assert_eq!(RunSpec::from_json(value.clone()).unwrap(), spec);
    let statistics = json!({ "cycles": 1, "configuration": value });
    assert_eq!(RunSpec::from_json(statistics).unwrap(), spec);
    assert!(RunSpec::from_json(json!([1])).unwrap_err().to_string().starts_with("describes no run: "));
}

#[test]
fn a_sweep_in_json_is_that_of_a_file() {
    let folder = Folder::new();
    let file = folder.file("sweep.ron", "(scene: \"room\", size: [8, \"16x12\"], cells: (from: 3, to: 12, times: 2))");
    let given = json!({ "cells": { "from": 3, "to": 12, "times": 2 }, "scene": "room", "size": [8, "16x12"] });
    assert_eq!(Sweep::from_json(given, |_, _| Ok(())).unwrap(), Sweep::read(&file).unwrap());
    let refused = |value| Sweep::from_json(value, |_, _| Ok(())).unwrap_err().to_string();
    assert_eq!(refused(json!({ "cels": 3 })), "unknown parameter `cels` (did you mean `cells`?)");
    assert!(refused(json!({ "cells": "many" })).starts_with("cells: invalid type"));
    assert!(refused(json!([3])).starts_with("a sweep is"));
}
