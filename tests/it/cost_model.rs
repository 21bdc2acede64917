//! The cost model: its equations against counting, and its predictions against the functional half, with the errors that
//! docs/cost-model.md states.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::f64::consts::TAU;
use std::sync::Arc;

use crate::support::{machine, program, scene, workload};
use glam::{DMat3, DVec3, Vec3};
use pcs_sim::cancel::Cancel;
use pcs_sim::geometry::{Bounds, Grid, Polygons, Ray};
use pcs_sim::model::cost::{self, Filter, KernelTime};
use pcs_sim::model::{Footprint, Prediction, Survey, grid, slabs};
use pcs_sim::program::{ArrayProgram, Kernel, Surfaces, sub_sample};
use pcs_sim::run::array_model;
use pcs_sim::run::{self, Workers};
use pcs_sim::scene::Mesh;

/// Every built-in scene, the largest ones smaller than they come.
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

const COEFFICIENTS: [f64; 3] = [5.0, 50.0, 200.0];

/// Pseudo-random numbers from 0 to 1, the same every time: a low-discrepancy sequence in each of several dimensions.
struct Numbers {
    index: f64,
}

impl Numbers {
    fn next<const N: usize>(&mut self) -> [f64; N] {
        self.index += 1.0;
        // Fractional parts of multiples of square roots of primes are spread evenly.
        let primes = [2.0f64, 3.0, 5.0, 7.0, 11.0, 13.0];
        std::array::from_fn(|k| (self.index * primes[k].sqrt()).fract())
    }
}

fn direction(a: f64, b: f64) -> DVec3 {
    let z = 2.0 * a - 1.0;
    let (sin, cos) = (TAU * b).sin_cos();
    DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
}

/// Lines that are all equally likely to meet a volume; some miss it.
fn random_lines(volume: Bounds, count: usize) -> Vec<Ray> {
    let radius = volume.extent().length() / 2.0;
    let middle = (volume.low + volume.high) / 2.0;
    let mut numbers = Numbers { index: 0.0 };
    let line = |_| {
        let [a, b, c, d] = numbers.next();
        let along = direction(a, b);
        let across = along.any_orthonormal_vector();
        let (sin, cos) = (TAU * d).sin_cos();
        let offset = (across * cos + along.cross(across) * sin) * radius * c.sqrt();
        Ray::new((middle + offset - along * 2.0 * radius).as_vec3(), along.as_vec3())
    };
    (0..count).map(line).collect()
}

fn predict(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray], coefficient: f64) -> Prediction {
    let machine = machine();
    let surfaces = Arc::new(Surfaces::new(mesh, rays));
    let parts = surfaces.sub_volumes(program, machine.times, &sub_sample(rays), &Cancel::default()).unwrap();
    let array = array_model(program, &machine);
    Survey::new(surfaces.polygons(), &parts, rays).predict(&array, coefficient).unwrap()
}

#[track_caller]
fn assert_near(what: &str, value: f64, truth: f64, error: f64) {
    assert!((value / truth - 1.0).abs() <= error, "{what}: {value} is not within {error} of {truth}");
}

/// §3 and (3), by hand: P = 1000, R = 10; the grid lets 40 of 1000 through, the slabs 5 of 40.
#[test]
fn t_with_filters() {
    let kernel = |start, each| KernelTime { start, each };
    let filters = [
        Filter { time: kernel(30.0, 7.8), steps: 100.0, passes: 40.0 },
        Filter { time: kernel(9.0, 13.0), steps: 40.0, passes: 5.0 },
    ];
    let times = cost::times(&filters, kernel(1.0, 30.0), 1000.0, 10.0);
    assert_eq!(times, [300_010.0, 10.0 * (810.0 + 1201.0), 10.0 * (810.0 + 529.0 + 151.0)]);
    assert!(cost::property_1(&times));
    assert!(!cost::property_1(&[times[0], times[2], times[1]]), "a filter that costs more than it saves");
    assert_eq!(cost::time_with_grid(filters[0].time, 100.0, 40.0, 30.0, 10.0), 10.0 * (810.0 + 1200.0));
    assert_eq!(slabs::memory_words(7.0, 100_000.0), 1.4e6);
    assert_eq!(grid::memory_words(50.0, 10.0, 100_000.0), 6e6, "§3: about 6M words");
    assert_eq!(grid::steps_bound(50.0, 100_000.0).round(), 171.0);
}

/// nb_steps is cbrt(nb_voxel) for random lines through a cube, as Devillers has it. In the boxes that the paper generalises
/// it to it is 1.11 times too large (1 x 3 x 2) or 1.86 times (1 x 1 x 0.1); the sharper form is right in any.
#[test]
fn steps_of_random_lines() {
    let (scene, _) = scene("mountain", 4, 1);
    for (stretch, factor) in [(DVec3::ONE, 1.0), (DVec3::new(1.0, 3.0, 2.0), 1.11), (DVec3::new(1.0, 1.0, 0.1), 1.86)] {
        let mut mesh = scene.mesh.clone();
        let (low, high) = mesh.bounds().unwrap();
        mesh.points.iter_mut().for_each(|point| *point = (*point - low) / (high - low) * stretch.as_vec3());
        let rays = random_lines(Bounds { low: DVec3::ZERO, high: stretch }, 40_000);
        let polygons = Polygons::for_rays(&mesh, &rays);
        let all: Vec<u32> = (0..polygons.len() as u32).collect();
        let filled =
            Grid::new(&polygons, &all, Bounds { low: DVec3::ZERO, high: stretch }, 50.0, &Cancel::default()).unwrap();
        let (mut meets, mut voxels, mut found) = (0.0, 0.0, 0.0);
        for ray in &rays {
            let before = voxels;
            filled.walk(ray, 0.0, |voxel| {
                voxels += 1.0;
                found += voxel.polygons.len() as f64;
                std::ops::ControlFlow::Continue(())
            });
            meets += f64::from(u8::from(voxels > before));
        }
        let size = DVec3::from_array(filled.size().map(f64::from));
        let expected = grid::steps_of_random_line(size, filled.volume().extent() / size);
        assert_near("steps", expected, voxels / meets, 0.005);
        assert_near("cbrt", grid::steps_bound(50.0, polygons.len() as f64), factor * voxels / meets, 0.02);
        // nb_filter1 = nb_steps nb_poly/voxel is right, too, for such lines, wherever the polygons are.
        let per_polygon = filled.reference_count() as f64 / polygons.len() as f64;
        let coefficient = filled.voxel_count() as f64 / polygons.len() as f64;
        let per_voxel = grid::polygons_per_voxel(per_polygon, coefficient);
        // (What lines find varies much more from line to line than how far they walk.)
        assert_near("candidates", grid::candidates(expected, per_voxel), found / meets, 0.03);
    }
}

/// Augmented volumes: polygons of any shape and direction anywhere in a grid, Cleary & Wyvill's mean over directions, and
/// ours for polygons as they lie.
#[test]
fn voxels_of_random_polygons() {
    let mut numbers = Numbers { index: 0.0 };
    for (half, shape) in [(0.2, 3), (1.0, 4), (3.0, 3), (3.0, 6)] {
        let (mut mesh, mut area, mut perimeter) = (Mesh::default(), 0.0, 0.0);
        for _ in 0..4000 {
            let [a, b, c, x, y, z] = numbers.next();
            let turn = DMat3::from_axis_angle(direction(a, b), 0.0)
                * DMat3::from_cols(
                    direction(a, b).any_orthonormal_vector(),
                    direction(a, b).cross(direction(a, b).any_orthonormal_vector()),
                    direction(a, b),
                )
                * DMat3::from_rotation_z(TAU * c);
            let middle = DVec3::new(x, y, z) * 20.0;
            let corner = |k: i32| {
                let (sin, cos) = (TAU * f64::from(k) / f64::from(shape)).sin_cos();
                middle + turn * (DVec3::new(cos, 0.5 * sin, 0.0) * half)
            };
            let corners: Vec<DVec3> = (0..shape).map(corner).collect();
            let edges = (0..corners.len()).map(|k| corners[(k + 1) % corners.len()] - corners[k]);
            perimeter += edges.map(|edge| edge.length()).sum::<f64>() / 4000.0;
            area += (1..corners.len() - 1)
                .map(|k| (corners[k] - corners[0]).cross(corners[k + 1] - corners[0]).length() / 2.0)
                .sum::<f64>()
                / 4000.0;
            let points: Vec<u32> = corners.iter().map(|corner| mesh.add_point(corner.as_vec3())).collect();
            mesh.add_face(&points, 0);
        }
        let polygons = Polygons::new(&mesh);
        let all: Vec<u32> = (0..4000).collect();
        let filled = Grid::new(
            &polygons,
            &all,
            Bounds { low: DVec3::splat(-9.0), high: DVec3::splat(29.0) },
            6.0,
            &Cancel::default(),
        )
        .unwrap();
        let edge = filled.volume().extent() / DVec3::from_array(filled.size().map(f64::from));
        let counted = filled.reference_count() as f64 / 4000.0;
        let isotropic = grid::voxels_per_polygon(area, perimeter, edge.element_product().cbrt());
        assert_near("voxels a polygon", isotropic, counted, 0.02);
        let mut as_they_lie = Footprint::default();
        for polygon in all {
            as_they_lie += Footprint::within(polygons.flattened(polygon), filled.volume(), 1e-3);
        }
        assert_near("the same as they lie", as_they_lie.voxels(edge) / 4000.0, counted, 0.01);
    }
}

/// A wall that is a face of the volume lies in one layer of voxels and ends with them.
#[test]
fn footprints_end_at_the_faces() {
    let volume = Bounds { low: DVec3::ZERO, high: DVec3::splat(4.0) };
    let square = |low: f64, high: f64| {
        [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| DVec3::new(x, y, 0.0)).into_iter()
    };
    let voxels = |low, high| Footprint::within(square(low, high), volume, 1e-6).voxels(DVec3::ONE);
    assert_eq!(voxels(0.0, 4.0), 16.0, "all of a face of 4 x 4 voxels");
    assert_eq!(voxels(-2.0, 9.0), 16.0, "what lies outside does not count");
    assert_near("1 x 1 anywhere: 2 x 2 on average", voxels(1.3, 2.3), 4.0, 1e-12);
    assert_near("from an edge on", voxels(0.0, 1.5), 4.0, 1e-12);
    assert_eq!(voxels(5.0, 6.0), 0.0);
}

/// How far a prediction is from what is counted, by quantity: the largest error over all scenes but those named.
///
/// In gears, lattice, sombrero and tetra many polygons lie just in the planes between voxels, and so in the voxels on both sides; room has
/// 45 polygons as large as itself.
#[test]
fn predictions_stand_within_the_stated_errors() {
    // Mode, quantity, error; then what the scenes outside it have.
    type Exceptions = &'static [(&'static str, f64)];
    let stated: [(&str, &str, f64, Exceptions); 8] = [
        ("pipeline", "voxels", 0.015, &[("room", 0.045)]),
        (
            "pipeline",
            "candidates",
            0.09,
            &[("gears", 0.40), ("lattice", 0.23), ("room", 0.50), ("sombrero", 0.35), ("tetra", 0.14)],
        ),
        ("pipeline", "survivors", 0.16, &[("gears", 0.50), ("tetra", 0.23)]),
        ("pipeline", "references", 0.08, &[("gears", 0.40), ("lattice", 0.18), ("sombrero", 0.32), ("tetra", 0.12)]),
        ("broadcast", "voxels", 0.04, &[("room", 0.06)]),
        ("broadcast", "candidates", 0.21, &[("gears", 0.50), ("lattice", 0.28), ("room", 0.75), ("sombrero", 0.45)]),
        ("broadcast", "survivors", 0.19, &[("gears", 0.22), ("reference", 0.25)]),
        ("broadcast", "cycles", 0.11, &[("gears", 0.24)]),
    ];
    let mut worst: BTreeMap<(&str, &str, &str), f64> = BTreeMap::new();
    for (name, size) in SCENES {
        let (scene, rays) = scene(name, size, 48);
        for mode in ["pipeline", "broadcast"] {
            for grid_coefficient in COEFFICIENTS {
                let program = ArrayProgram { grid_coefficient, ..program(mode, 1) };
                for (quantity, factor) in factors(&scene.mesh, &program, &rays) {
                    let entry = worst.entry((mode, quantity, name)).or_insert(0.0);
                    *entry = entry.max((factor - 1.0).abs());
                }
            }
        }
    }
    let mut failures = String::new();
    for (&(mode, quantity, name), &error) in &worst {
        let Some(entry) = stated.iter().find(|entry| (entry.0, entry.1) == (mode, quantity)) else { continue };
        let allowed = entry.3.iter().find(|exception| exception.0 == name).map_or(entry.2, |exception| exception.1);
        if error > allowed {
            failures += &format!("{mode}, {quantity} of {name}: off by {error:.3}, stated {allowed}\n");
        }
    }
    // What is stated is no wider than it must be.
    for (mode, quantity, allowed, exceptions) in stated {
        let of = |name: &str| {
            let entry = worst.iter().find(|((of, what, scene), _)| (*of, *what, *scene) == (mode, quantity, name));
            entry.map_or(0.0, |entry| *entry.1)
        };
        let others = SCENES.iter().filter(|scene| exceptions.iter().all(|exception| exception.0 != scene.0));
        let most = others.map(|scene| of(scene.0)).fold(0.0, f64::max);
        let stated = exceptions.iter().map(|&(name, allowed)| (name, of(name), allowed));
        for (name, error, allowed) in stated.chain([("all others", most, allowed)]) {
            if error < 0.8 * allowed && allowed > 0.01 {
                failures += &format!("{mode}, {quantity} of {name}: only {error:.3}, stated {allowed}\n");
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Predicted over counted, in one group.
fn factors(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray]) -> [(&'static str, f64); 5] {
    let predicted = predict(mesh, program, rays, program.grid_coefficient);
    let counted = count(mesh, program, rays);
    let work = predicted.groups[0];
    [
        ("voxels", work.voxels / counted.voxels),
        ("candidates", work.candidates / counted.candidates),
        ("survivors", work.survivors / counted.survivors),
        ("references", predicted.sizes.references / counted.references),
        ("cycles", predicted.bound.cycles_per_ray / counted.cycles),
    ]
}

/// What a run counts, a ray; and the grids' references.
struct Counted {
    voxels: f64,
    candidates: f64,
    survivors: f64,
    references: f64,
    /// Cycles that the busiest cell works.
    cycles: f64,
}

fn count(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray]) -> Counted {
    let workload = workload(mesh, program, rays);
    let outcome = run::run(&workload, &machine().spec, rays, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
    let works = outcome.stats.stations.iter().map(|cell| outcome.stats.topology.states.works(cell)).max().unwrap();
    let a_ray = |count: u64| count as f64 / rays.len() as f64;
    Counted {
        voxels: a_ray(outcome.counts.voxels),
        candidates: a_ray(outcome.counts.slab_tests),
        survivors: a_ray(outcome.counts.intersection_tests),
        references: workload.grids().map(Grid::reference_count).sum::<usize>() as f64,
        cycles: a_ray(works.0),
    }
}

/// The table of docs/cost-model.md: for each scene at UgRay's coefficient, counted over the paper's formulas, and counted
/// over predicted.
#[test]
fn the_documented_errors_are_these() {
    let mut table = String::from(
        "| scene | nb_steps | stopped | nb_filter1 | nb_voxel/poly | voxels | candidates | slabs passed | cycles |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for (name, size) in SCENES {
        let (scene, rays) = scene(name, size, 48);
        let pipeline = predict(&scene.mesh, &program("pipeline", 1), &rays, 50.0);
        let whole = count(&scene.mesh, &program("pipeline", 1), &rays);
        let stopping = count(&scene.mesh, &program("broadcast", 1), &rays);
        let (paper, work) = (pipeline.paper, pipeline.groups[0]);
        let broadcast = predict(&scene.mesh, &program("broadcast", 1), &rays, 50.0);
        let columns = [
            whole.voxels / paper.voxels,
            stopping.voxels / paper.voxels,
            whole.candidates / paper.candidates,
            whole.references / pipeline.sizes.polygons / paper.voxels_per_polygon,
            whole.voxels / work.voxels,
            whole.candidates / work.candidates,
            whole.survivors / work.survivors,
            stopping.cycles / broadcast.bound.cycles_per_ray,
        ];
        let cells: Vec<String> = columns.iter().map(|factor| format!("{factor:.2}")).collect();
        table += &format!("| {name} {size} | {} |\n", cells.join(" | "));
    }
    insta::assert_snapshot!("errors", table);
    assert!(include_str!("../../docs/cost-model.md").contains(&table), "docs/cost-model.md has another table");
}

/// T_0 to T_2 of a scene in one cell, from counting, with the grid coefficient that suits T_1 and T_2 best of those tried.
fn counted_times(name: &str, size: u32) -> [f64; 3] {
    let (scene, rays) = scene(name, size, 40);
    let without = ArrayProgram { stages: vec![vec![Kernel::Grid, Kernel::Intersection]], ..program("broadcast", 1) };
    let with = program("broadcast", 1);
    let best = |program: &ArrayProgram| {
        let time = |&grid_coefficient: &f64| {
            let program = ArrayProgram { grid_coefficient, ..program.clone() };
            count(&scene.mesh, &program, &rays).cycles
        };
        [3.0, 10.0, 30.0, 100.0, 300.0, 1000.0].iter().map(time).fold(f64::INFINITY, f64::min)
    };
    let inter = machine().times.intersection;
    let all = inter.start.0 as f64 + inter.each.0 as f64 * scene.mesh.faces().len() as f64;
    [all, best(&without), best(&with)]
}

/// Property (1), and what slabs gain: the paper has over 8 % on all of its images.
#[test]
fn slabs_gain_what_is_documented() {
    let mut table =
        String::from("| scene | T0, ms a ray | T1, µs | T2, µs | slabs gain |\n| --- | ---: | ---: | ---: | ---: |\n");
    for (name, size) in SCENES {
        let times = counted_times(name, size).map(|cycles| cycles * 0.05);
        assert!(times[0] > times[1] && times[0] > times[2], "{name}: the grid pays");
        let gain = 100.0 * (1.0 - times[2] / times[1]);
        table +=
            &format!("| {name} {size} | {:.1} | {:.0} | {:.0} | {gain:.1} % |\n", times[0] / 1e3, times[1], times[2]);
    }
    insta::assert_snapshot!("gains", table);
    assert!(include_str!("../../docs/cost-model.md").contains(&table), "docs/cost-model.md has another table");
}

/// The grid that minimises T is not the one that filters most (§3): more voxels always let fewer polygons through, and
/// from some number on they cost more than that saves.
#[test]
fn the_best_grid_is_not_the_one_that_filters_most() {
    let (scene, rays) = scene("reference", 20, 48);
    let program = program("broadcast", 1);
    let at = |coefficient| {
        let prediction = predict(&scene.mesh, &program, &rays, coefficient);
        (prediction.groups[0].candidates, prediction.bound.cycles_per_ray)
    };
    let [few, some, many] = [0.5, 5.0, 500.0].map(at);
    assert!(few.0 > some.0 && some.0 > many.0);
    assert!(some.1 < few.1 && some.1 < many.1);
}

/// The coefficient that the model takes for the best costs at most 10 % more than the best of those that it chose from.
#[test]
fn the_best_coefficient_is_good() {
    for (name, size) in [("reference", 10), ("teapot", 12), ("mountain", 6), ("rings", 3)] {
        let (scene, rays) = scene(name, size, 48);
        for mode in ["pipeline", "broadcast"] {
            let program = program(mode, 1);
            let machine = machine();
            let surfaces = Arc::new(Surfaces::new(&scene.mesh, &rays));
            let parts = surfaces.sub_volumes(&program, machine.times, &sub_sample(&rays), &Cancel::default()).unwrap();
            let array = array_model(&program, &machine);
            let (chosen, _) = Survey::new(surfaces.polygons(), &parts, &rays).best_coefficient(&array).unwrap();
            let counted = |&grid_coefficient: &f64| {
                let program = ArrayProgram { grid_coefficient, ..program.clone() };
                count(&scene.mesh, &program, &rays).cycles
            };
            let best = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0].iter().map(counted).fold(f64::INFINITY, f64::min);
            let loss = counted(&chosen) / best - 1.0;
            assert!(loss <= 0.10, "{name}, {mode}: {chosen} costs {loss:.3} more than the best");
        }
    }
}

/// Rays that start inside, end early or miss are predicted as others are.
#[test]
fn rays_of_any_kind() {
    let (scene, _) = scene("teapot", 8, 1);
    let (low, high) = scene.mesh.bounds().unwrap();
    let mut numbers = Numbers { index: 0.0 };
    let ray = |_| {
        let [a, b, x, y, z, t] = numbers.next();
        let origin = low + (high - low) * Vec3::new(x as f32, y as f32, z as f32);
        Ray { t_max: 2.0 * t as f32, ..Ray::new(origin, direction(a, b).as_vec3()) }
    };
    let rays: Vec<Ray> = (0..2000).map(ray).collect();
    for mode in ["pipeline", "broadcast"] {
        for (quantity, factor) in factors(&scene.mesh, &program(mode, 1), &rays) {
            assert_near(&format!("{mode}, {quantity}"), factor, 1.0, 0.12);
        }
    }
}
