//! The hits are the same bits in every mode, for every partition and number of cells, and the same as brute force.

use crate::support::{bits, hits, program, program_hits, scene, workload};
use glam::{DVec3, Vec3};
use pcs_sim::geometry::{Bounds, CellPlane, Eye, Numbering, Partition, Polygons, Pyramids, Ray, Regions, brute_force};
use pcs_sim::program::ArrayProgram;
use pcs_sim::program::cube::{Space, Walker};
use pcs_sim::scene::{Mesh, builtin};
use proptest::prelude::*;

const PARTITIONS: [Partition; 4] = [Partition::Regular, Partition::Polygons, Partition::Work, Partition::Measured];

fn by_brute_force(mesh: &Mesh, rays: &[Ray]) -> Vec<[u32; 4]> {
    let polygons = Polygons::new(mesh);
    rays.iter().map(|ray| bits(&brute_force(&polygons, ray))).collect()
}

/// Every mode, number of cells, partition and number of threads, on small versions of every scene.
#[test]
fn on_small_built_in_scenes() {
    for (name, size) in [
        ("tetra", 4),
        ("balls", 2),
        ("rings", 2),
        ("mountain", 4),
        ("gears", 1),
        ("tree", 5),
        ("lattice", 2),
        ("sombrero", 1),
        ("shells", 3),
        ("teapot", 4),
        ("room", 1),
        ("table", 1),
        ("valve", 1),
        ("chapel", 1),
        ("reference", 2),
    ] {
        let (scene, rays) = scene(name, size, 20);
        let expected = by_brute_force(&scene.mesh, &rays);
        assert!(expected.iter().any(|hit| hit[1] != u32::MAX), "no ray hits anything in {name}");
        assert_eq!(hits(&scene.mesh, &program("pipeline", 1), &rays, 2), expected, "{name}, pipeline");
        for partition in PARTITIONS {
            for (mode, groups) in [
                ("broadcast", 1),
                ("broadcast", 2),
                ("broadcast", 3),
                ("broadcast", 7),
                ("broadcast", 16),
                ("hybrid", 3),
                ("hybrid-3", 5),
            ] {
                // A measured cut lays the scene out again and again.
                if partition == Partition::Measured && groups != 3 && groups != 7 {
                    continue;
                }
                // Bounded walks and numbers from front to back for about half of them.
                let bounded_walk = groups % 3 == 0 || mode == "hybrid-3" || groups == 16;
                let numbering = if groups % 2 == 1 { Numbering::Front } else { Numbering::Cut };
                let program = ArrayProgram { partition, numbering, bounded_walk, ..program(mode, groups) };
                let threads = 1 + groups % 3;
                let found = hits(&scene.mesh, &program, &rays, threads);
                assert_eq!(found, expected, "{name}, {mode} in {groups} groups, {partition}, {threads} threads");
            }
        }
    }
}

/// The scenes as they come, with fewer rays.
#[test]
fn on_full_built_in_scenes() {
    for builtin in builtin::all() {
        let (scene, rays) = scene(builtin.name, builtin.default_size, 12);
        let expected = by_brute_force(&scene.mesh, &rays);
        for (mode, groups) in [("pipeline", 1), ("broadcast", 7), ("hybrid", 4), ("hybrid-3", 2)] {
            let found = hits(&scene.mesh, &program(mode, groups), &rays, 2);
            assert_eq!(found, expected, "{}, {mode} in {groups} groups", builtin.name);
        }
    }
}

/// A.3 in 32 bits hits a sliver as far beyond its short edge as that is long, and no filter drops what it hits.
#[test]
fn on_a_sliver_that_is_left_beyond_its_end() {
    let mut mesh = Mesh::default();
    let corners = [[-5000.0, -1.5, 5000.0], [1.0, -0.5, 9999.5], [0.0, -0.5, 10001.0]];
    let corners = corners.map(|corner| mesh.add_point(Vec3::from_array(corner)));
    mesh.add_face(&corners, 0);
    mesh.add_face(&[corners[1], corners[2], corners[0]], 0);
    let direction = Vec3::new(1.0, 1.0, 1.0);
    let rays = [0.5, 0.4, 0.3].map(|x| Ray::new(Vec3::new(x, -0.5, 10001.0) - direction, direction));
    let expected = by_brute_force(&mesh, &rays);
    assert!(expected.iter().any(|hit| hit[1] != u32::MAX), "the ray hits the sliver");
    for (name, groups) in [("pipeline", 1), ("broadcast", 1), ("broadcast", 2), ("hybrid", 1), ("hybrid-3", 2)] {
        let program = program(name, groups);
        assert_eq!(hits(&mesh, &program, &rays, 1), expected, "{name}");
        assert_eq!(program_hits(&mesh, &program, &rays), expected, "{name}");
    }
}

/// Coordinates that make trouble: on a coarse lattice, so that faces touch and coincide, or anywhere.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![4 => (-4i32..=4).prop_map(|n| n as f32 * 0.5), 2 => -2.0f32..2.0, 1 => Just(0.0)]
}

fn point() -> impl Strategy<Value = Vec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

#[derive(Clone, Debug)]
enum Shape {
    Triangle([Vec3; 3]),
    /// A parallelogram: corner and two edges.
    Parallelogram([Vec3; 3]),
    /// Thin or flat: two corners and a third on the line between them, nearly.
    Sliver(Vec3, Vec3, f32, Vec3),
    /// Far longer than wide: one corner, the way to the two others, how these lie apart, and which comes first.
    Needle(Vec3, Vec3, Vec3, usize),
    /// All corners in one point.
    Point(Vec3),
    /// A regular n-gon in a plane of constant z.
    Disc(Vec3, f32, u32),
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        4 => [point(), point(), point()].prop_map(Shape::Triangle),
        2 => [point(), point(), point()].prop_map(Shape::Parallelogram),
        1 => (point(), point(), 0.0f32..1.0, point())
            .prop_map(|(a, b, share, off)| Shape::Sliver(a, b, share, off)),
        2 => (point(), point(), point(), prop_oneof![1e-7f32..1e-5, 1e-5f32..1e-2], 0..3usize)
            .prop_map(|(a, way, off, width, first)| Shape::Needle(a, way, off * width, first)),
        1 => point().prop_map(Shape::Point),
        1 => (point(), 0.1f32..2.0, 3u32..9).prop_map(|(c, r, n)| Shape::Disc(c, r, n)),
    ]
}

fn corners(shape: &Shape) -> Vec<Vec3> {
    match *shape {
        Shape::Triangle(points) => points.to_vec(),
        Shape::Parallelogram([s, a, b]) => vec![s, s + a, s + a + b, s + b],
        Shape::Sliver(a, b, share, off) => vec![a, b, a + (b - a) * share + off * 1e-6],
        Shape::Needle(a, way, off, first) => {
            let corners = [a, a + way, a + way + off];
            (0..3).map(|k| corners[(first + k) % 3]).collect()
        }
        Shape::Point(p) => vec![p; 3],
        Shape::Disc(center, radius, n) => (0..n)
            .map(|k| {
                let angle = k as f32 / n as f32 * std::f32::consts::TAU;
                center + Vec3::new(angle.cos(), angle.sin(), 0.0) * radius
            })
            .collect(),
    }
}

/// Some shapes, some of them twice, all moved and scaled: tiny, huge, far from the origin of coordinates.
fn soup() -> impl Strategy<Value = Mesh> {
    let scale = prop_oneof![6 => Just(1.0f32), 1 => Just(1e-12), 1 => Just(1e12), 1 => 1e-3f32..1e3];
    let offset = prop_oneof![6 => Just(0.0f32), 1 => Just(1e3), 1 => Just(1e6)];
    (prop::collection::vec((shape(), 1usize..3), 1..40), scale, offset).prop_map(|(shapes, scale, offset)| {
        let mut mesh = Mesh::default();
        for (shape, copies) in shapes {
            let place = |p: Vec3| (p + Vec3::new(offset, -offset, 0.0)) * scale;
            let points: Vec<u32> = corners(&shape).into_iter().map(|p| mesh.add_point(place(p))).collect();
            (0..copies).for_each(|_| mesh.add_face(&points, 0));
        }
        mesh
    })
}

#[derive(Clone, Debug)]
struct RayPlan {
    /// From this point, or from this face's corner or middle.
    origin: Vec3,
    from_face: Option<(usize, f32, f32)>,
    to_face: Option<(usize, f32, f32)>,
    direction: Vec3,
    flatten: u8,
    length: f32,
    t_max: Option<f32>,
}

fn ray_plan() -> impl Strategy<Value = RayPlan> {
    let on_face = || prop::option::of((any::<usize>(), -0.01f32..1.01, -0.01f32..1.01));
    (
        prop_oneof![3 => point(), 1 => point().prop_map(|p| p * 30.0), 1 => point().prop_map(|p| p * 300.0), 1 => point().prop_map(|p| p * 3e5)],
        on_face(),
        on_face(),
        point(),
        0u8..8,
        prop_oneof![4 => Just(1.0f32), 1 => Just(1e-9), 1 => Just(1e9)],
        prop::option::weighted(0.3, 0.0f32..4.0),
    )
        .prop_map(|(origin, from_face, to_face, direction, flatten, length, t_max)| RayPlan {
            origin,
            from_face,
            to_face,
            direction,
            flatten,
            length,
            t_max,
        })
}

/// A point in the plane of a face: inside, on an edge, or just outside.
fn on_face(mesh: &Mesh, (face, a, b): (usize, f32, f32)) -> Vec3 {
    let face = &mesh.faces()[face % mesh.faces().len()];
    let points: Vec<Vec3> = mesh.face_points(face).collect();
    points[0] + (points[1] - points[0]) * a * (1.0 - b) + (points[2] - points[0]) * b
}

fn ray(mesh: &Mesh, plan: &RayPlan) -> Option<Ray> {
    let (low, high) = mesh.bounds()?;
    let size = (high - low).max_element().max(f32::MIN_POSITIVE);
    let origin = plan.from_face.map_or((low + high) / 2.0 + plan.origin * size / 4.0, |at| on_face(mesh, at));
    let mut direction = plan.to_face.map_or(plan.direction * size, |at| on_face(mesh, at) - origin);
    for axis in 0..3 {
        if plan.flatten >> axis & 1 == 1 {
            direction[axis] = 0.0;
        }
    }
    let direction = direction / direction.abs().max_element() * plan.length;
    let t_max = plan.t_max.map_or(f32::INFINITY, |t| t * size / plan.length);
    (direction.is_finite() && direction != Vec3::ZERO).then_some(Ray { origin, direction, t_max })
}

/// The rays, and those that hit something once more, ending just there: a cell whose walk is bounded has such rays.
fn and_ending_where_they_hit(mesh: &Mesh, mut rays: Vec<Ray>) -> Vec<Ray> {
    let polygons = Polygons::new(mesh);
    let ending: Vec<Ray> = rays.iter().map(|ray| ray.until(brute_force(&polygons, ray).t)).collect();
    rays.extend(ending.into_iter().filter(|ray| ray.t_max.is_finite()));
    rays
}

fn case() -> impl Strategy<Value = (Mesh, Vec<Ray>)> {
    (soup(), prop::collection::vec(ray_plan(), 1..60)).prop_map(|(mesh, plans)| {
        let rays = plans.iter().filter_map(|plan| ray(&mesh, plan)).collect();
        (mesh, rays)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..ProptestConfig::default() })]

    #[test]
    fn on_random_soups(
        (mesh, rays) in case(),
        cells in 1usize..9,
        partition in prop::sample::select(&PARTITIONS[..]),
        coefficient in prop_oneof![Just(50.0), Just(1.0), Just(0.01), Just(500.0)],
        mailbox: bool,
        stop_words in prop::option::of(prop_oneof![1u32..6, 1u32..80]),
        forward_ahead in prop_oneof![Just(0u32), 1u32..70],
        rays_per_message in prop_oneof![Just(1u32), 1u32..70],
        numbering in prop::sample::select(&[Numbering::Cut, Numbering::Front][..]),
        bounded_walk: bool,
    ) {
        let groups = cells.min(mesh.faces().len());
        let rays = and_ending_where_they_hit(&mesh, rays);
        let expected = by_brute_force(&mesh, &rays);
        for name in ["pipeline", "broadcast", "hybrid", "hybrid-3"] {
            let groups = if name == "pipeline" { 1 } else { groups };
            let stop_words = stop_words.filter(|_| name != "broadcast");
            let program = ArrayProgram {
                grid_coefficient: coefficient,
                mailbox,
                partition,
                stop_words,
                forward_ahead: if rays_per_message == 1 { forward_ahead } else { 0 },
                rays_per_message,
                numbering,
                bounded_walk: bounded_walk && rays_per_message == 1,
                ..program(name, groups)
            };
            prop_assert_eq!(&hits(&mesh, &program, &rays, 1), &expected, "{}", name);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn on_random_soups_with_programs(
        (mesh, rays) in case(),
        cells in 1usize..9,
        coefficient in prop_oneof![Just(50.0), Just(1.0), Just(0.01), Just(500.0)],
        mailbox: bool,
        bounded_walk: bool,
    ) {
        let groups = cells.min(mesh.faces().len());
        let expected = by_brute_force(&mesh, &rays);
        for name in ["pipeline", "broadcast", "hybrid", "hybrid-3"] {
            let groups = if name == "pipeline" { 1 } else { groups };
            let program =
                ArrayProgram { grid_coefficient: coefficient, mailbox, bounded_walk, ..program(name, groups) };
            prop_assert_eq!(&program_hits(&mesh, &program, &rays), &expected, "{}", name);
        }
    }
}

/// An eye outside a volume, on its side in that direction, which looks at its middle.
fn eye_before(volume: Bounds, side: [f64; 3]) -> Eye {
    let middle = (volume.low + volume.high) / 2.0;
    let away = DVec3::from_array(side).try_normalize().unwrap_or(DVec3::X);
    let forward = -away;
    let right = forward.any_orthonormal_vector();
    let at = (middle + away * volume.extent().length() * 1.2).as_vec3();
    Eye { at, forward, right, up: right.cross(forward) }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..ProptestConfig::default() })]

    /// Nodes that have a region each find the same, however its cells are cut; where these are blocks of the grid, they visit its voxels
    /// just as one node does.
    #[test]
    fn through_the_regions_of_random_soups(
        (mesh, rays) in case(),
        regions in 1usize..12,
        cells in 1u32..20,
        coefficient in prop_oneof![Just(50.0), Just(1.0), Just(0.01), Just(500.0)],
        side in prop::array::uniform3(-1.0f64..1.0),
        seed: u64,
    ) {
        let expected = by_brute_force(&mesh, &rays);
        let workload = workload(&mesh, &ArrayProgram::one_cell(coefficient), &rays);
        let Some(grid) = workload.grids().next() else { return Ok(()) };
        let pyramids = Pyramids::new(eye_before(grid.volume(), side), grid.volume(), cells);
        let work = |[across, down]: [u32; 2]| -> Vec<u64> {
            (0..u64::from(across * down)).map(|cell| (cell ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40).collect()
        };
        let finest = CellPlane::finest(grid);
        let joined = finest.quantiles(&work(finest.size()), cells).0;
        let whole = Regions::whole(CellPlane::new(grid, 1));
        let voxels = |space: Space<'_>| {
            let (mut walker, mut legs, mut uses) = (Walker::new(&workload, space, None), Vec::new(), Vec::new());
            let hits: Vec<[u32; 4]> = rays.iter().map(|ray| bits(&walker.trace((ray, None), &mut legs, &mut uses))).collect();
            (hits, legs.iter().map(|leg| u64::from(leg.voxels)).sum::<u64>())
        };
        let (_, of_one) = voxels(Space::of(&whole));
        let blocks = [CellPlane::new(grid, cells), joined].map(|plane| (plane, None));
        let screen = pyramids.as_ref().map(|pyramids| (CellPlane::of_screen(cells), Some(pyramids)));
        for (plane, pyramids) in blocks.into_iter().chain(screen) {
            let amounts = work(plane.size());
            let Ok(cut) = Regions::of_equal_work(plane, &amounts, regions) else { continue };
            let (found, visited) = voxels(Space { pyramids, ..Space::of(&cut) });
            prop_assert_eq!(&found, &expected, "{}", if pyramids.is_some() { "pyramids" } else { "blocks" });
            prop_assert!(if pyramids.is_some() { visited >= of_one } else { visited == of_one }, "{} {}", visited, of_one);
        }
    }
}
