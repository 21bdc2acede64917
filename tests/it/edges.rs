//! Rays aimed exactly at edges and vertices that polygons share: what passes between them.

use std::convert::Infallible;
use std::sync::Arc;

use crate::support::command::Folder;
use crate::support::{bits, machine, program};
use glam::Vec3;
use pcs_sim::cancel::Cancel;
use pcs_sim::geometry::{Edges, Partition, Polygons, Ray, brute_force};
use pcs_sim::program::{ArrayProgram, Layout, Sample, Surfaces, Workload};
use pcs_sim::run::{self, Workers};
use pcs_sim::scene::Mesh;
use proptest::prelude::*;

/// A closed ball of `slices` x `stacks` faces around a point, seen from a point inside: rays at all its vertices, at the middles of
/// its edges, and at a third of them.
fn ball(center: Vec3, radius: f32, (slices, stacks): (u32, u32)) -> (Mesh, Vec<Ray>) {
    let mut mesh = Mesh::default();
    let at = |slice: u32, stack: u32| {
        let (round, up) = (slice as f32 / slices as f32, stack as f32 / stacks as f32);
        let (angle, polar) = (round * std::f32::consts::TAU, up * std::f32::consts::PI);
        center + radius * Vec3::new(polar.sin() * angle.cos(), polar.sin() * angle.sin(), polar.cos())
    };
    let [top, bottom] = [1.0, -1.0].map(|z| mesh.add_point(center + radius * Vec3::new(0.0, 0.0, z)));
    let rings: Vec<Vec<u32>> =
        (1..stacks).map(|stack| (0..slices).map(|slice| mesh.add_point(at(slice, stack))).collect()).collect();
    for slice in 0..slices as usize {
        let next = (slice + 1) % slices as usize;
        mesh.add_face(&[top, rings[0][slice], rings[0][next]], 0);
        for (upper, lower) in rings.iter().zip(&rings[1..]) {
            // The quads of a ball are flat, but not to 32 bits: as triangles all is.
            mesh.add_face(&[upper[slice], lower[slice], lower[next]], 0);
            mesh.add_face(&[upper[slice], lower[next], upper[next]], 0);
        }
        let last = &rings[rings.len() - 1];
        mesh.add_face(&[bottom, last[next], last[slice]], 0);
    }
    let eye = center + radius * Vec3::new(0.13, -0.21, 0.17);
    let mut rays = Vec::new();
    for face in mesh.faces() {
        let points: Vec<Vec3> = mesh.face_points(face).collect();
        for (k, &from) in points.iter().enumerate() {
            let to = points[(k + 1) % points.len()];
            let targets = [from, (from + to) * 0.5, from + (to - from) / 3.0];
            rays.extend(targets.map(|target| Ray::new(eye, target - eye)));
        }
    }
    (mesh, rays)
}

/// The hits of a run with closed edges, or not.
fn hits(mesh: &Mesh, program: &ArrayProgram, rays: &[Ray], edges: Edges) -> Vec<[u32; 4]> {
    let surfaces = Arc::new(Surfaces::with_edges(mesh, rays, edges));
    let times = machine().times;
    let sample = Sample { rays: rays.to_vec(), in_one_cell: None };
    let layout = Layout::new(surfaces, program, times, sample, &Cancel::default()).unwrap();
    let workload = Workload::of(Arc::new(layout), program, times);
    let outcome = run::run(&workload, &machine().spec, rays, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
    outcome.hits.iter().map(bits).collect()
}

fn by_brute_force(mesh: &Mesh, rays: &[Ray], edges: Edges) -> Vec<[u32; 4]> {
    let polygons = Polygons::for_rays(mesh, rays).with_edges(edges);
    rays.iter().map(|ray| bits(&brute_force(&polygons, ray))).collect()
}

fn passing(hits: &[[u32; 4]]) -> usize {
    hits.iter().filter(|hit| hit[1] == u32::MAX).count()
}

/// The figures of docs/machine.md.
#[test]
fn some_rays_pass_by_the_papers_rule_and_none_with_closed_edges() {
    let mut shares = Vec::new();
    for (center, radius) in [(Vec3::ZERO, 1.0), (Vec3::new(3.0, -2.0, 5.0), 0.7), (Vec3::splat(100.0), 2.0)] {
        let (mesh, rays) = ball(center, radius, (48, 24));
        let paper = by_brute_force(&mesh, &rays, Edges::Paper);
        shares.push(100.0 * passing(&paper) as f64 / rays.len() as f64);
        let closed = by_brute_force(&mesh, &rays, Edges::Closed);
        assert_eq!(passing(&closed), 0);
        for (name, groups) in [("pipeline", 1), ("broadcast", 7), ("hybrid", 3), ("hybrid-3", 2)] {
            assert_eq!(hits(&mesh, &program(name, groups), &rays, Edges::Closed), closed, "{name}");
            assert_eq!(hits(&mesh, &program(name, groups), &rays, Edges::Paper), paper, "{name}");
        }
    }
    insta::assert_snapshot!(format!("{shares:.1?}"));
}

fn point() -> impl Strategy<Value = Vec3> {
    [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from_array)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Tetrahedra of every shape, slivers too, around the ray's start: none lets a ray out, in no mode.
    #[test]
    fn nothing_leaves_a_closed_surface(
        corners in prop::array::uniform4(point()),
        thin in prop_oneof![Just(1.0f32), Just(1e-3), Just(1e-6)],
        far in prop_oneof![Just(0.0f32), Just(1e3)],
        aims in prop::collection::vec((0..4usize, 0..4usize, prop_oneof![Just(0.0f32), Just(0.5), 0.0f32..1.0]), 40),
        partition in prop::sample::select(&[Partition::Regular, Partition::Polygons][..]),
    ) {
        let corners = corners.map(|p| (p * Vec3::new(1.0, 1.0, thin)) + far);
        let mut mesh = Mesh::default();
        let points = corners.map(|corner| mesh.add_point(corner));
        for [a, b, c] in [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]] {
            mesh.add_face(&[points[a], points[b], points[c]], 0);
        }
        let middle = corners.iter().sum::<Vec3>() / 4.0;
        // It must lie inside as 32 bits have it: on the inner side of each face, by more than rounding.
        let inside = mesh.faces().iter().all(|face| {
            let p: Vec<glam::DVec3> = mesh.face_points(face).map(|p| p.as_dvec3()).collect();
            let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
            normal.dot(middle.as_dvec3() - p[0]).abs() > 1e-5 * (1.0 + f64::from(far))
        });
        prop_assume!(inside);
        let rays: Vec<Ray> = aims
            .iter()
            .map(|&(from, to, share)| Ray::new(middle, corners[from] + (corners[to] - corners[from]) * share - middle))
            .collect();
        let expected = by_brute_force(&mesh, &rays, Edges::Closed);
        prop_assert_eq!(passing(&expected), 0);
        for (name, groups) in [("pipeline", 1), ("broadcast", 4), ("hybrid", 2)] {
            let program = ArrayProgram { partition, ..program(name, groups) };
            prop_assert_eq!(&hits(&mesh, &program, &rays, Edges::Closed), &expected, "{}", name);
        }
    }
}

#[test]
fn closed_edges_are_asked_for_by_name_and_said() {
    let folder = Folder::new();
    folder.run("--scene tetra --size 8x8 --edges closed --stats s.json --hits h.csv").success();
    let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
    assert_eq!(stats["configuration"]["edges"], "closed");
    folder.run("--config s.json --hits again.csv").success();
    assert_eq!(folder.read("h.csv"), folder.read("again.csv"));
    folder.run("image tetra --size 8x8 --edges closed -o i.png").success();
    let refused = |arguments: &str| folder.run(arguments).refused();
    insta::assert_snapshot!("programs", refused("--scene tetra --size 8x8 --edges closed --cells-run programs"));
    insta::assert_snapshot!("another", refused("--scene tetra --size 8x8 --edges open"));
}
