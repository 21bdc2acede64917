//! The walk bounded by the hit from the left: the same hits for less work, of all kinds of rays and in every door.
//! (`modes_agree` holds the hits against brute force, `timing_is_exact` the times against ticking.)

use std::collections::BTreeSet;
use std::convert::Infallible;

use crate::support::command::Folder;
use crate::support::{bits, hits, machine, program, program_hits, scene, workload};
use glam::Vec3;
use pcs_sim::geometry::{Polygons, Ray, brute_force};
use pcs_sim::program::{ArrayProgram, Counts};
use pcs_sim::run::{self, Workers};
use pcs_sim::scene::{Mesh, builtin};

fn bounded(name: &str, groups: usize) -> ArrayProgram {
    ArrayProgram { bounded_walk: true, ..program(name, groups) }
}

fn counts(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray]) -> Counts {
    let workload = workload(mesh, program, rays);
    run::run(&workload, &machine().spec, rays, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap().counts
}

/// Two polygons in one plane, at the same t: the one with the higher number reaches through all of the scene, so that the left cell
/// hits it in the right cell's part; the lower one lies there alone. Who is bounded must still test what lies just at the bound.
#[test]
fn a_hit_at_the_bound_counts_if_its_number_is_lower() {
    let square = |mesh: &mut Mesh, low: [f32; 2], high: [f32; 2], z: f32| {
        let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        let corners = corners.map(|[x, y]| mesh.add_point(Vec3::new(x, y, z)));
        mesh.add_face(&corners, 0);
    };
    let mut mesh = Mesh::default();
    square(&mut mesh, [2.0, 2.0], [3.0, 3.0], 0.0);
    square(&mut mesh, [-8.0, -4.0], [8.0, 4.0], 0.0);
    square(&mut mesh, [-8.0, -4.0], [8.0, 4.0], 2.0);
    let (from, to) = (Vec3::new(-3.0, 2.5, 0.25), Vec3::new(2.5, 2.5, 0.0));
    let ray = Ray::new(from, to - from);
    let polygons = Polygons::new(&mesh);
    let t = |polygon| polygons.intersect(&ray, polygon, f32::INFINITY).unwrap().t;
    assert_eq!(t(0).to_bits(), t(1).to_bits(), "both are hit at the same t");
    let program = ArrayProgram { grid_coefficient: 1.0, ..bounded("broadcast", 2) };
    // What the left cell finds, it finds beyond its own part.
    let left = workload(&mesh, &program, &[ray]);
    assert!(left.grids().next().unwrap().planes(0).last().unwrap() < &1.0);
    let expected = vec![bits(&brute_force(&polygons, &ray))];
    assert_eq!(expected[0][1], 0);
    assert_eq!(hits(&mesh, &program, &[ray], 1), expected);
    assert_eq!(program_hits(&mesh, &program, &[ray]), expected);
    assert_eq!(hits(&mesh, &ArrayProgram { bounded_walk: false, ..program }, &[ray], 1), expected);
}

/// No kernel works more than without the bound, in no scene, and in most they work less.
#[test]
fn it_saves_work_and_costs_none() {
    let mut saves = 0;
    for builtin in builtin::all() {
        let (scene, rays) = scene(builtin.name, builtin.default_size.min(4), 16);
        for (name, groups) in [("broadcast", 9), ("hybrid", 4), ("hybrid-3", 3)] {
            let free = counts(&scene.mesh, &program(name, groups), &rays);
            let found = counts(&scene.mesh, &bounded(name, groups), &rays);
            assert!(found.voxels <= free.voxels && found.slab_tests <= free.slab_tests, "{}, {name}", builtin.name);
            assert!(found.intersection_tests <= free.intersection_tests && found.hits == free.hits);
            saves += usize::from(found.voxels < free.voxels);
        }
    }
    assert!(saves > 20, "{saves} of 45 save voxels");
}

/// The earlier hit is read before anything is begun, by every cell of a group, and goes ahead of the candidates.
#[test]
fn what_the_cells_read_when() {
    let folder = Folder::new();
    folder.file("wall.obj", "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 0 4 0\nv 0 4 4\nv 4 4 4\nf 1 2 3 4\nf 5 6 7\n");
    folder.file("rays.csv", "ox,oy,oz,dx,dy,dz\n1,-1,3,0,1,0\n1,9,1,0,-1,0\n");
    let run = "--scene wall.obj --rays rays.csv --grid-coefficient 32 --groups 2 --ops a.ops --ops-form priced --force";
    folder.run(&format!("{run} --mode broadcast --bounded-walk")).success();
    insta::assert_snapshot!("broadcast", folder.read("a.ops"));
    folder.run(&format!("{run} --program hybrid-3 --bounded-walk")).success();
    insta::assert_snapshot!("hybrid of three", folder.read("a.ops"));
}

/// Shadow, reflected and refracted rays are bounded too, and no pixel changes.
#[test]
fn an_image_is_the_same() {
    let folder = Folder::new();
    let image = |name: &str, more: &str| {
        let run =
            format!("image room --size 20x16 --mode broadcast --cells 6 -o {name}.png --stats {name}.json {more}");
        folder.run(&run).success();
        let stats: serde_json::Value = serde_json::from_str(&folder.read(&format!("{name}.json"))).unwrap();
        (std::fs::read(folder.path(&format!("{name}.png"))).unwrap(), stats)
    };
    let (plain, free) = image("plain", "");
    for (name, more) in [
        ("bounded", "--bounded-walk"),
        ("cut", "--bounded-walk --partition measured --numbering front"),
        ("programs", "--bounded-walk --cells-run programs"),
    ] {
        let (png, stats) = image(name, more);
        assert!(png == plain, "{name}");
        assert_eq!(stats["configuration"]["program"]["bounded_walk"], true);
        assert!(name == "cut" || stats["counts"]["voxels"].as_u64() < free["counts"]["voxels"].as_u64(), "{name}");
        // What was run can be run again.
        folder.run(&format!("image --config {name}.json -o again.png --stats again.json --force")).success();
        assert_eq!(folder.read("again.json"), folder.read(&format!("{name}.json")));
    }
}

/// What is said of a run stands over what its files say, be it false.
#[test]
fn what_is_false_in_a_sweep_is_not_done() {
    let folder = Folder::new();
    folder.file(
        "p.ron",
        "(name: \"p\", groups: 4, stages: [[grid, slabs, intersection]], bounded_walk: true, mailbox: true)",
    );
    folder.file(
        "s.ron",
        "(scene: \"teapot\", size_factor: 3, size: 12, program: \"p.ron\", bounded_walk: [false, true], mailbox: [false, true])",
    );
    folder.file(
        "i.ron",
        "(image: true, scene: \"room\", size: 12, samples: 2, adaptive: [false, true], adaptive_by: \"lao\")",
    );
    for (sweep, points) in [("s.ron", 4), ("i.ron", 2)] {
        folder.run(&format!("sweep {sweep} -o t.csv --force")).success();
        let table = folder.read("t.csv");
        let column = table.lines().next().unwrap().split(',').position(|name| name == "cycles").unwrap();
        let cycles: BTreeSet<&str> = table.lines().skip(1).map(|row| row.split(',').nth(column).unwrap()).collect();
        assert_eq!(cycles.len(), points, "{table}");
    }
}
