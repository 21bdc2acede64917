//! The cut that is measured in the parts and cut again, and the numbering from front to back.

use std::convert::Infallible;
use std::sync::Arc;

use crate::support::{machine, program, scene, workload};
use glam::{DVec3, Vec3};
use pcs_sim::cancel::Cancel;
use pcs_sim::geometry::partition::front_to_back;
use pcs_sim::geometry::{Bounds, Partition, Ray};
use pcs_sim::program::{ArrayProgram, Layout, Sample, Surfaces, Workload, sub_sample};
use pcs_sim::run::{self, Layers, PlannedRun, Rendered, RunOptions, RunSpec, Setup, Workers};

/// By how much the busiest cell works more than the mean one.
fn imbalance(workload: &Workload, rays: &[Ray]) -> f64 {
    let outcome = run::run(workload, &machine().spec, rays, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
    over_mean(&outcome.stats)
}

fn over_mean(stats: &pcs_sim::measure::Measured) -> f64 {
    let works =
        |cell| stats.topology.states.sum(cell, |state| state.kind == pcs_sim::measure::StateKind::Works).0 as f64;
    let all: Vec<f64> = stats.stations.iter().map(works).collect();
    all.iter().copied().fold(0.0, f64::max) / (all.iter().sum::<f64>() / all.len() as f64)
}

/// Measured again, the parts come nearer to equal work than cut once by what one cell would work: on rays of which most were not
/// looked at.
#[test]
fn it_evens_the_work_out() {
    for (name, size, groups, mode) in
        [("mountain", 6, 8, "broadcast"), ("rings", 3, 8, "broadcast"), ("teapot", 8, 6, "hybrid")]
    {
        let (scene, rays) = scene(name, size, 96);
        let cut = |partition| {
            imbalance(&workload(&scene.mesh, &ArrayProgram { partition, ..program(mode, groups) }, &rays), &rays)
        };
        let (work, measured) = (cut(Partition::Work), cut(Partition::Measured));
        assert!(measured - 1.0 < 0.5 * (work - 1.0), "{name}: {measured} measured, {work} by work");
    }
}

/// A scene that is laid out for one cell already is cut as one that is not.
#[test]
fn a_cut_is_the_same_with_one_cells_grid_at_hand() {
    let (scene, rays) = scene("teapot", 4, 64);
    let (times, surfaces) = (machine().times, Arc::new(Surfaces::new(&scene.mesh, &rays)));
    let lay_out = |program: &ArrayProgram, sample| {
        Arc::new(Layout::new(surfaces.clone(), program, times, sample, &Cancel::default()).unwrap())
    };
    for partition in [Partition::Work, Partition::Measured] {
        let program = ArrayProgram { partition, ..program("hybrid", 5) };
        let whole = lay_out(&ArrayProgram::one_cell(program.grid_coefficient), Sample::default());
        let cut = |in_one_cell| {
            let layout = lay_out(&program, Sample { rays: sub_sample(&rays), in_one_cell });
            let workload = Workload::of(layout, &program, times);
            workload.grids().map(|grid| (grid.volume(), grid.reference_count())).collect::<Vec<_>>()
        };
        let parts = cut(None);
        assert!(parts.len() == 5 && parts.windows(2).all(|pair| pair[0] != pair[1]), "{parts:?}");
        assert_eq!(cut(Some(whole)), parts, "{partition}");
    }
}

#[test]
fn boxes_are_numbered_as_rays_meet_them() {
    let slice = |low: f64| Bounds { low: DVec3::new(low, 0.0, 0.0), high: DVec3::new(low + 1.0, 1.0, 1.0) };
    let boxes = vec![slice(1.0), slice(0.0), slice(2.0)];
    let ray = |x: f32, direction: f32| Ray::new(Vec3::new(x, 0.5, 0.5), Vec3::new(direction, 0.0, 0.0));
    let numbered =
        |rays: &[Ray]| -> Vec<f64> { front_to_back(boxes.clone(), rays).iter().map(|volume| volume.low.x).collect() };
    assert_eq!(numbered(&[]), [1.0, 0.0, 2.0], "as they were cut");
    assert_eq!(numbered(&[ray(-1.0, 1.0)]), [0.0, 1.0, 2.0]);
    assert_eq!(numbered(&[ray(4.0, -2.0), ray(4.0, -1.0), ray(-1.0, 1.0)]), [2.0, 1.0, 0.0]);
    // A ray that starts between boxes, or ends before some, says nothing of the others.
    assert_eq!(numbered(&[ray(1.5, -1.0)]), [1.0, 2.0, 0.0]);
    assert_eq!(numbered(&[Ray { t_max: 1.5, ..ray(-1.0, 1.0) }]), [1.0, 0.0, 2.0]);
}

fn layers(parameters: &[(&str, &str)]) -> Setup {
    let mut options = RunOptions::default();
    let all = [("scene", "room"), ("size", "48x48"), ("mode", "broadcast"), ("cells", "8"), ("partition", "measured")];
    all.iter().chain(parameters).for_each(|(name, value)| options.set(name, value).unwrap());
    let planned = PlannedRun::new(RunSpec::of_image(&options, None).unwrap()).unwrap();
    Setup::new(planned, &mut Layers::default(), &Cancel::default()).unwrap()
}

/// An image is cut by its rays of all kinds: more evenly for these than by those of the camera.
#[test]
fn an_image_is_cut_by_all_its_rays() {
    let image = layers(&[]);
    let by_camera = workload(&image.scene.mesh, &image.spec.program, &image.prepared.rays);
    let busiest = |workload: &Workload| {
        let picture = run::Picture { workload, ..image.picture() };
        let timed = run::Timed {
            spec: &image.machine.spec,
            rules: image.image().host_rules(image.spec.order),
            watching: run::Watching::default(),
        };
        let rendered: Rendered =
            run::render(&picture, Some(timed), &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
        over_mean(&rendered.timing.unwrap().stats)
    };
    let (all, camera) = (busiest(&image.workload), busiest(&by_camera));
    assert!(all < camera, "{all} by all rays, {camera} by the camera's");
}
