//! The model's throughput bounds: no run passes one, and deep FIFOs and even work come up to it.

use std::convert::Infallible;
use std::sync::Arc;

use crate::support::{ops, program, scene, spent};
use glam::Vec3;
use pcs_sim::cancel::Cancel;
use pcs_sim::geometry::{Partition, Ray};
use pcs_sim::machine::{Cycles, Machine, MachineSpec, RateCounts, Words};
use pcs_sim::measure::Measured;
use pcs_sim::model::{ArrayModel, Bound, CellLoad, Limit, LinkLoad, RayWork, Stage, Survey};
use pcs_sim::program::work;
use pcs_sim::program::{ArrayProgram, Kernel, Masks, Surfaces, Workload};
use pcs_sim::run::{self, Workers};
use pcs_sim::run::{CountedLoads, array_model};
use pcs_sim::scene::Mesh;
use pcs_sim::seam::{OpBatch, OpKind, Unit};
use proptest::prelude::*;

/// What the cells and links do for a ray, from their ops.
fn loads(workload: &Workload, rays: &[Ray], array: &ArrayModel) -> (Vec<CellLoad>, Vec<LinkLoad>) {
    let (batches, costs): (Vec<OpBatch>, _) = (ops(workload, rays), workload.costs());
    let (count, rays) = (workload.cells(), rays.len() as f64);
    let mut cells = vec![CellLoad::default(); count];
    let mut links = vec![LinkLoad::default(); count + 1];
    links[0].x = 8.0 + array.mask_words;
    let gap = array.links.cycles_per_word - 1.0;
    for (index, op) in batches
        .iter()
        .flat_map(|batch| batch.cells.iter().enumerate())
        .flat_map(|(index, stream)| stream.lines().flat_map(move |(_, ops)| ops.iter().map(move |op| (index, *op))))
    {
        let (load, amount) = (&mut cells[index], f64::from(op.count()) / rays);
        match op.kind() {
            OpKind::Work(unit) => {
                let cycles = amount * costs.of(unit).0 as f64;
                match costs.activity(unit) {
                    work::GRID => load.grid += cycles,
                    work::SLABS => load.slabs += cycles,
                    _ => load.intersection += cycles,
                }
            }
            OpKind::PassX if index + 1 < count => {
                load.moving += amount;
                load.link_wait += (f64::from(op.count()) - 1.0) * gap / rays;
                links[index + 1].x += amount;
            }
            OpKind::WriteY => {
                load.moving += amount;
                load.link_wait += (f64::from(op.count()) - 1.0) * gap / rays;
                links[index + 1].y += amount;
            }
            _ => load.moving += amount,
        }
    }
    (cells, links)
}

fn machine(spec: MachineSpec, host_ray: u64) -> Machine {
    let mut machine = Machine { spec, ..crate::support::machine() };
    machine.times.host.ray = Cycles(host_ray);
    machine
}

fn run(mesh: &Mesh, program: &ArrayProgram, machine: &Machine, rays: &[Ray]) -> (Measured, Workload) {
    let workload = Workload::new(mesh, program, machine.times, rays).unwrap();
    let outcome = run::run(&workload, &machine.spec, rays, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
    (outcome.stats, workload)
}

/// The bound of a run's ops.
fn bound(workload: &Workload, program: &ArrayProgram, machine: &Machine, rays: &[Ray]) -> Bound {
    let array = array_model(program, machine);
    let (cells, links) = loads(workload, rays, &array);
    Bound::new(array.host_load(), &cells, &links, array.links)
}

fn deep() -> MachineSpec {
    MachineSpec { fifo_words: Words(MachineSpec::MAX_FIFO_WORDS), ..MachineSpec::default() }
}

fn triangles() -> impl Strategy<Value = Mesh> {
    let point = || prop::array::uniform3(-4.0f32..4.0).prop_map(Vec3::from_array);
    let triangle = (point(), point(), point());
    prop::collection::vec(triangle, 8..30).prop_map(|triangles| {
        let mut mesh = Mesh::default();
        for (a, b, c) in triangles {
            let points = [a, b * 0.3 + a, c * 0.3 + a].map(|point| mesh.add_point(point));
            mesh.add_face(&points, 0);
        }
        mesh
    })
}

fn some_rays() -> impl Strategy<Value = Vec<Ray>> {
    let vector = || prop::array::uniform3(-1.0f32..1.0).prop_map(Vec3::from_array);
    let ray = (vector(), vector()).prop_filter_map("no direction", |(from, to)| {
        (from.distance(to) > 0.1).then(|| Ray::new(from * 6.0, to - from))
    });
    prop::collection::vec(ray, 1..60)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any mode, number of cells, FIFO depth, link, latency and host.
    #[test]
    fn no_run_passes_its_bound(
        mesh in triangles(),
        rays in some_rays(),
        mode in prop::sample::select(vec!["pipeline", "broadcast", "hybrid", "hybrid-3"]),
        groups in 1usize..7,
        slabs in prop::bool::ANY,
        fifo_words in prop::sample::select(vec![1u64, 2, 8, 64, 512, 100_000]),
        link_mb_s in prop::sample::select(vec![1.0, 5.0, 20.0, 80.0, 160.0]),
        rate_counts in prop::sample::select(vec![RateCounts::Link, RateCounts::Channel]),
        latency in 1u64..20,
        host_ray in prop::sample::select(vec![0u64, 100, 5000]),
    ) {
        let mut program = program(mode, if mode == "pipeline" { 1 } else { groups });
        if !slabs {
            program.stages.iter_mut().for_each(|stage| stage.retain(|&kernel| kernel != Kernel::Slabs));
            program.stages.retain(|stage| !stage.is_empty());
        }
        let fifo_words = Words(fifo_words);
        let spec = MachineSpec { fifo_words, link_mb_s, rate_counts, latency: Cycles(latency), ..MachineSpec::default() };
        let machine = machine(spec, host_ray);
        let (stats, workload) = run(&mesh, &program, &machine, &rays);
        let bound = bound(&workload, &program, &machine, &rays);
        let least = bound.cycles_per_ray * rays.len() as f64;
        prop_assert!(stats.cycles.0 as f64 >= least * (1.0 - 1e-12), "{} cycles, bound {least}: {bound:?}", stats.cycles);
    }
}

/// The loads that the model works out from counts are those of the ops, to the last cycle and word.
#[test]
fn loads_are_those_of_the_ops() {
    let (scene, rays) = scene("teapot", 6, 24);
    for link_mb_s in [80.0, 20.0] {
        let machine = machine(MachineSpec { link_mb_s, ..MachineSpec::default() }, 0);
        let program = program("pipeline", 1);
        let (stats, workload) = run(&scene.mesh, &program, &machine, &rays);
        let counts =
            run::run(&workload, &machine.spec, &rays, &Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap().counts;
        let a_ray = |count: u64| count as f64 / rays.len() as f64;
        let work = RayWork {
            voxels: a_ray(counts.voxels),
            candidates: a_ray(counts.slab_tests),
            survivors: a_ray(counts.intersection_tests),
            ..RayWork::default()
        };
        let array = array_model(&program, &machine);
        let (cells, links) = loads(&workload, &rays, &array);
        let same = |a: f64, b: f64| assert!((a - b).abs() <= 1e-9 * b.abs(), "{a} {b}");
        let modelled = array.cell_loads(&[work]);
        for (modelled, counted) in modelled.iter().zip(&cells) {
            same(modelled.grid, counted.grid);
            same(modelled.slabs, counted.slabs);
            same(modelled.intersection, counted.intersection);
            same(modelled.moving, counted.moving);
            // The model does not know which candidates follow each other at once.
            assert!(modelled.link_wait <= counted.link_wait + 1e-9);
        }
        for (modelled, counted) in array.link_loads(&[work]).iter().zip(&links) {
            same(modelled.x, counted.x);
            same(modelled.y, counted.y);
        }
        if link_mb_s < 80.0 {
            continue;
        }
        let from_stats = CountedLoads::new(&stats, &array, &modelled);
        same(
            from_stats.bound.cycles_per_ray,
            Bound::new(array.host_load(), &cells, &links, array.links).cycles_per_ray,
        );
    }
}

/// With masks, too, in every mode: cells that only pass a ray on start nothing, and tell nobody of its end. How many rays each group is
/// spared, the survey finds out to the ray.
#[test]
fn loads_with_masks_are_those_of_the_ops() {
    let (scene, rays) = scene("teapot", 3, 16);
    let machine = machine(MachineSpec::default(), 0);
    for (mode, groups) in [("pipeline", 1), ("broadcast", 8), ("broadcast", 33), ("hybrid", 5), ("hybrid-3", 3)] {
        for masks in [Masks::Off, Masks::Boxes, Masks::Rectangles] {
            let program = ArrayProgram { masks, ..program(mode, groups) };
            let workload = Workload::new(&scene.mesh, &program, machine.times, &rays).unwrap().seen_by(&scene.camera);
            let array = array_model(&program, &machine);
            let work = work_of_groups(&workload, &rays);
            let (cells, links) = loads(&workload, &rays, &array);
            let same = |a: f64, b: f64| assert!((a - b).abs() <= 1e-9 * b.abs(), "{mode} {groups} {masks:?}: {a} {b}");
            for (modelled, counted) in array.cell_loads(&work).iter().zip(&cells) {
                same(modelled.grid, counted.grid);
                same(modelled.slabs, counted.slabs);
                same(modelled.intersection, counted.intersection);
                same(modelled.moving, counted.moving);
            }
            for (modelled, counted) in array.link_loads(&work).iter().zip(&links) {
                same(modelled.x, counted.x);
                same(modelled.y, counted.y);
            }
            let surfaces = Arc::new(Surfaces::new(&scene.mesh, &rays));
            let parts = surfaces.sub_volumes(&program, machine.times, &[], &Cancel::default()).unwrap();
            let survey = Survey::new(surfaces.polygons(), &parts, &rays).masked(masks, &scene.camera);
            let surveyed = survey.predict(&array, program.grid_coefficient).unwrap().groups;
            surveyed.iter().zip(&work).for_each(|(surveyed, counted)| same(surveyed.spared, counted.spared));
            // The rectangle of all of the scene is the whole picture here.
            let spares = masks == Masks::Boxes || masks == Masks::Rectangles && groups > 1;
            assert_eq!(work.iter().any(|work| work.spared > 0.1), spares, "{mode} {groups} {masks:?}");
        }
    }
}

/// What each group does for a ray, from its ops.
fn work_of_groups(workload: &Workload, rays: &[Ray]) -> Vec<RayWork> {
    let batches = ops(workload, rays);
    let stages = workload.cells() / workload.groups();
    let group = |group: usize| {
        let cells = batches.iter().flat_map(|batch| &batch.cells[group * stages..(group + 1) * stages]);
        let ops: Vec<_> = cells.flat_map(|stream| stream.ops()).collect();
        let a_ray = |unit: Unit| {
            let counts = ops.iter().filter(|op| op.unit() == Some(unit)).map(|op| f64::from(op.count()));
            counts.sum::<f64>() / rays.len() as f64
        };
        RayWork {
            voxels: a_ray(work::GRID_VOXEL),
            candidates: a_ray(work::SLABS_POLYGON),
            survivors: a_ray(work::INTERSECTION_POLYGON),
            finds: a_ray(work::SLABS_START),
            meets: a_ray(work::INTERSECTION_START),
            spared: 1.0 - a_ray(work::GRID_START),
        }
    };
    (0..workload.groups()).map(group).collect()
}

/// By how many cycles each of many equal rays makes a run longer.
fn cycles_of_one_more(mesh: &Mesh, program: &ArrayProgram, machine: &Machine, ray: Ray) -> u64 {
    let cycles = |count: usize| run(mesh, program, machine, &vec![ray; count]).0.cycles.0;
    cycles(301) - cycles(300)
}

/// With the same ray over and over, each takes just what the bound says: cells, links and host, in every mode.
#[test]
fn even_work_comes_up_to_the_bound() {
    let (scene, rays) = scene("teapot", 4, 9);
    let through = rays[40];
    let beside = Ray::new(Vec3::new(100.0, 0.0, 0.0), Vec3::Y);
    let cell: fn(Limit) -> bool = |limit| matches!(limit, Limit::Cell(_));
    let link: fn(Limit) -> bool = |limit| matches!(limit, Limit::Link(_));
    let host: fn(Limit) -> bool = |limit| limit == Limit::Host;
    for (mode, groups, link_mb_s, host_ray, grid_start, ray, limit) in [
        ("pipeline", 1, 80.0, 0, 600, through, cell),
        ("broadcast", 1, 80.0, 0, 600, through, cell),
        ("broadcast", 6, 80.0, 0, 600, beside, cell),
        ("hybrid", 4, 80.0, 0, 600, beside, cell),
        ("hybrid-3", 3, 80.0, 0, 600, beside, cell),
        ("broadcast", 5, 0.5, 0, 0, beside, link),
        ("pipeline", 1, 80.0, 50_000, 600, through, host),
    ] {
        let program = program(mode, groups);
        let mut machine = machine(MachineSpec { link_mb_s, ..deep() }, host_ray);
        machine.times.grid.start = Cycles(grid_start);
        let workload = Workload::new(&scene.mesh, &program, machine.times, &[ray]).unwrap();
        let bound = bound(&workload, &program, &machine, &[ray]);
        let one_more = cycles_of_one_more(&scene.mesh, &program, &machine, ray);
        assert_eq!(one_more as f64, bound.cycles_per_ray.round(), "{mode} {groups} {link_mb_s} {host_ray}: {bound:?}");
        assert!(limit(bound.limit), "{mode} {groups}: {bound:?}");
    }
}

/// A broadcast cell pays the grid's start for every ray, hit or miss: 30 µs and the words, however many cells there are.
#[test]
fn the_floor_of_broadcast() {
    let machine = crate::support::machine();
    let array = array_model(&program("broadcast", 64), &machine);
    let bound = Bound::new(array.host_load(), &array.cell_loads(&[RayWork::default(); 64]), &[], array.links);
    assert_eq!(bound.cycles_per_ray, 600.0 + 8.0 + 5.0 + 5.0);
    assert_eq!((array.cycles_per_second / bound.cycles_per_ray) as u64, 32_362);
    let stage = Stage { grid: true, slabs: true, intersection: true };
    assert_eq!(array.stages, [stage]);
}

/// On real scenes deep FIFOs bring the macro-pipeline to its bound: what is left is the way of the first ray in and of the
/// last ones out. In `reference` the last rays, at the lower edge of the image, leave the later cells a backlog.
#[test]
fn deep_fifos_come_up_to_the_bound() {
    for (name, size, within) in
        [("teapot", 8, 0.01), ("reference", 10, 0.034), ("mountain", 5, 0.01), ("lattice", 4, 0.01), ("tetra", 6, 0.01)]
    {
        let (scene, rays) = scene(name, size, 64);
        let program = program("pipeline", 1);
        let machine = machine(deep(), 0);
        let (stats, workload) = run(&scene.mesh, &program, &machine, &rays);
        let bound = bound(&workload, &program, &machine, &rays);
        let least = (bound.cycles_per_ray * rays.len() as f64).round() as u64;
        let over = stats.cycles.0 - least;
        assert!((over as f64) < within * least as f64, "{name}: {over} cycles over {least}");
        // The bound cell is never blocked, and waits for words on the first ray alone.
        let first = |state: &str| spent(&stats, 0, state);
        assert_eq!((first("blocked X"), first("blocked Y")), (0, 0), "{name}");
        assert_eq!(least + first("waiting X") + first("idle"), stats.cycles.0, "{name}");
    }
}

/// The loads of all partitions are bounds of real scenes, too.
#[test]
fn real_scenes_stay_under_their_bounds() {
    let (scene, rays) = scene("reference", 5, 48);
    for partition in [Partition::Regular, Partition::Polygons, Partition::Work, Partition::Measured] {
        for (mode, groups) in [("broadcast", 2), ("broadcast", 16), ("hybrid", 5), ("hybrid-3", 4)] {
            let program = ArrayProgram { partition, ..program(mode, groups) };
            let mut last = u64::MAX;
            for fifo_words in [16, 512, 100_000] {
                let machine = machine(MachineSpec { fifo_words: Words(fifo_words), ..MachineSpec::default() }, 0);
                let (stats, workload) = run(&scene.mesh, &program, &machine, &rays);
                let least = bound(&workload, &program, &machine, &rays).cycles_per_ray * rays.len() as f64;
                assert!(stats.cycles.0 as f64 >= least, "{mode} {groups} {partition} {fifo_words}");
                assert!(stats.cycles.0 <= last, "deeper FIFOs are never slower");
                last = stats.cycles.0;
            }
        }
    }
}
