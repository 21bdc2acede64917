//! Solids: is what they come to closed, of the right volume, and the same as intervals along a ray say?

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use glam::{DAffine3, DQuat, DVec3, Vec3, dvec2, dvec3};
use pcs_sim::scene::solid::{Cut, Evaluated, Options, Shell, Solid, evaluate};
use pcs_sim::scene::{self, Mesh, ReadOptions, Scene};
use proptest::prelude::*;

use crate::support::command::Folder;
use crate::support::intervals::{self, Node};

fn leaf(shell: Shell) -> Solid {
    Solid::leaf(shell)
}

fn cube(low: DVec3, high: DVec3, material: u32) -> Solid {
    let map = DAffine3::from_translation(low) * DAffine3::from_scale(high - low);
    leaf(Shell::cube().of_material(material)).placed(map)
}

fn done(solid: &Solid) -> Evaluated {
    evaluate(solid, Options::default()).unwrap()
}

fn volume(solid: &Solid) -> f64 {
    let report = done(solid).report;
    assert!(report.closed, "{}", report.sentence());
    report.volume
}

/// Twice the area of the regular polygon around the unit circle.
fn round(corners: u32) -> f64 {
    f64::from(corners) * (TAU / f64::from(corners)).sin()
}

/// Rounding to 32 bits moves a point by some parts in 10^8.
#[track_caller]
fn about(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{found} is not {expected}");
}

#[test]
fn primitives_have_their_volumes() {
    about(volume(&leaf(Shell::cube())), 1.0);
    for slices in [3, 8, 17, 32] {
        about(volume(&leaf(Shell::cylinder(slices))), round(slices) / 2.0);
        about(volume(&leaf(Shell::cone(slices))), round(slices) / 6.0);
        let stacks = (slices / 2).max(2);
        let area = |stack: u32| round(slices) / 2.0 * (PI * (f64::from(stack) / f64::from(stacks) - 0.5)).cos().powi(2);
        let height = |stack: u32| -(PI * f64::from(stack) / f64::from(stacks)).cos();
        let frustum = |stack: u32| {
            let (low, high) = (area(stack), area(stack + 1));
            (height(stack + 1) - height(stack)) / 3.0 * (low + (low * high).sqrt() + high)
        };
        about(volume(&leaf(Shell::sphere(slices))), (0..stacks).map(frustum).sum());
        let tube = round((slices / 2).max(3)) / 2.0 * 0.3 * 0.3;
        about(volume(&leaf(Shell::torus(0.3, slices))), tube * round(slices));
    }
    about(volume(&leaf(Shell::sphere(32))), 4.121942);
    let arrow = [dvec2(0.0, 0.0), dvec2(2.0, 1.0), dvec2(0.0, 2.0), dvec2(1.0, 1.0)];
    let turned: Vec<_> = arrow.iter().rev().copied().collect();
    about(volume(&leaf(Shell::prism(&arrow).unwrap())), 1.0);
    about(volume(&leaf(Shell::prism(&turned).unwrap())), 1.0);
}

#[test]
fn operations_have_the_volumes_of_closed_forms() {
    let two = cube(DVec3::ZERO, DVec3::splat(2.0), 0);
    let corner = Solid::Difference(vec![two.clone(), cube(DVec3::ONE, DVec3::splat(2.0), 0)]);
    let report = done(&corner).report;
    about(report.volume, 7.0);
    about(report.area, 24.0);
    // Three squares without and within; three sides with a notch, which take two convex polygons each, and get up to three.
    assert!((12..=15).contains(&report.polygons), "{}", report.polygons);
    for (slices, expected) in [(8, 6.585786), (32, 6.439277), (128, 6.429834)] {
        let drill = DAffine3::from_translation(dvec3(1.0, 1.0, -1.0)) * DAffine3::from_scale(dvec3(0.5, 0.5, 4.0));
        let hole = Solid::Difference(vec![two.clone(), leaf(Shell::cylinder(slices)).placed(drill)]);
        about(volume(&hole), expected);
        about(volume(&hole), 8.0 - round(slices) / 4.0);
    }
    let (one, beside) = (cube(DVec3::ZERO, DVec3::ONE, 0), cube(DVec3::X, dvec3(2.0, 1.0, 1.0), 0));
    let [both, first, none] = [
        Solid::Union(vec![one.clone(), beside.clone()]),
        Solid::Difference(vec![one.clone(), beside.clone()]),
        Solid::Intersection(vec![one, beside]),
    ]
    .map(|solid| done(&solid).report);
    about(both.volume, 2.0);
    about(both.area, 10.0);
    about(first.volume, 1.0);
    about(first.area, 6.0);
    assert_eq!(first.polygons, 6);
    assert_eq!(none.polygons, 0, "two cubes that touch have nothing in common");
}

/// Steinmetz' solids; with 64 sides, whose corners lie on the axes, and in the limit.
#[test]
fn crossed_cylinders_are_steinmetz_solids() {
    let long = DAffine3::from_translation(DVec3::Z * -2.0) * DAffine3::from_scale(dvec3(1.0, 1.0, 4.0));
    let along = |slices: u32, axis: DVec3| {
        let turn = DAffine3::from_quat(DQuat::from_rotation_arc(DVec3::Z, axis));
        leaf(Shell::cylinder(slices)).placed(long).placed(turn)
    };
    let all = |slices: u32| [DVec3::Z, DVec3::X, DVec3::Y].map(|axis| along(slices, axis));
    let of = |slices: u32, count: usize| volume(&Solid::Intersection(all(slices)[..count].to_vec()));
    about(of(64, 2), 5.320493);
    about(of(64, 3), 4.675009);
    assert!((of(256, 2) - 16.0 / 3.0).abs() < 1e-3);
    assert!((of(256, 3) - 8.0 * (2.0 - 2f64.sqrt())).abs() < 1.2e-3);
}

/// Points less edges plus triangles, by Euler's formula 2 for each shell, less 2 for each hole through it.
fn characteristic(solid: &Solid) -> i64 {
    let mesh = evaluate(solid, Options { join: false, ..Options::default() }).unwrap().mesh;
    let (mut points, mut edges) = (BTreeSet::new(), BTreeSet::new());
    for face in mesh.faces() {
        let corners: Vec<u32> = mesh.corners(face).iter().map(|corner| corner.point).collect();
        let next = corners.iter().cycle().skip(1);
        points.extend(corners.iter().copied());
        assert!(corners.iter().zip(next).all(|(&from, &to)| edges.insert((from, to))), "an edge is walked twice");
    }
    assert!(edges.iter().all(|&(from, to)| edges.contains(&(to, from))), "an edge is walked one way alone");
    points.len() as i64 - edges.len() as i64 / 2 + mesh.faces().len() as i64
}

#[test]
fn shells_and_holes_are_as_many_as_they_should_be() {
    let two = cube(DVec3::ZERO, DVec3::splat(2.0), 0);
    let drill = |x: f64| {
        let map = DAffine3::from_translation(dvec3(x, 1.0, -1.0)) * DAffine3::from_scale(dvec3(0.25, 0.25, 4.0));
        leaf(Shell::cylinder(16)).placed(map)
    };
    assert_eq!(characteristic(&two), 2);
    assert_eq!(characteristic(&Solid::Difference(vec![two.clone(), cube(DVec3::ONE, DVec3::splat(2.0), 0)])), 2);
    assert_eq!(characteristic(&Solid::Difference(vec![two.clone(), drill(1.0)])), 0);
    assert_eq!(characteristic(&Solid::Difference(vec![two, drill(0.5), drill(1.5)])), -2);
    assert_eq!(characteristic(&leaf(Shell::torus(0.3, 12))), 0);
    let hollow = leaf(Shell::cube().hollow(dvec3(0.9, 0.9, 0.75)).unwrap());
    assert_eq!(characteristic(&hollow), 4);
}

#[test]
fn hollow_shapes_need_no_operation() {
    let shell = leaf(Shell::cube().hollow(dvec3(0.9, 0.9, 0.75)).unwrap());
    let hollow = done(&shell);
    about(hollow.report.volume, 0.3925);
    assert_eq!((hollow.report.polygons, hollow.report.closed), (12, true));
    assert_eq!(evaluate(&shell, Options { join: false, ..Options::default() }).unwrap().report.polygons, 24);
    let sphere = Shell::sphere(16).hollow(DVec3::splat(0.5)).unwrap();
    about(volume(&leaf(sphere.clone())), 7.0 / 8.0 * volume(&leaf(Shell::sphere(16))));
    // The other way of making it.
    let inner = leaf(Shell::sphere(16)).placed(DAffine3::from_scale(DVec3::splat(0.5)));
    about(volume(&Solid::Difference(vec![leaf(Shell::sphere(16)), inner])), volume(&leaf(sphere.clone())));
    // Cut open it is a cup.
    let above = cube(dvec3(-2.0, -2.0, 0.0), DVec3::splat(2.0), 0);
    about(volume(&Solid::Difference(vec![leaf(sphere.clone()), above])), volume(&leaf(sphere)) / 2.0);
}

/// The materials of a solid's faces whose plane is where `at` says, by area.
fn areas(solid: &Solid, cut: Cut, at: impl Fn(DVec3) -> bool) -> Vec<(u32, f64)> {
    let mesh = evaluate(solid, Options { cut, join: true }).unwrap().mesh;
    let mut areas = std::collections::BTreeMap::new();
    for face in mesh.faces() {
        let points: Vec<DVec3> = mesh.face_points(face).map(|point| point.as_dvec3()).collect();
        if points.iter().all(|&point| at(point)) {
            let twice: DVec3 = points.windows(2).map(|pair| (pair[0] - points[0]).cross(pair[1] - points[0])).sum();
            *areas.entry(face.material).or_insert(0.0) += twice.length() / 2.0;
        }
    }
    areas.into_iter().collect()
}

/// Of two faces in one plane that look the same way the first operand's stays, whatever the side, and the one of the higher priority.
#[test]
fn faces_that_coincide_go_by_rule() {
    for axis in 0..3 {
        for side in [0.0, 1.0] {
            let at = move |point: DVec3| (point[axis] - side).abs() < 1e-6;
            // A unit cube, and half of it that shares four of its sides' planes.
            let large = cube(DVec3::ZERO, DVec3::ONE, 1);
            let mut high = DVec3::ONE;
            high[(axis + 1) % 3] = 0.5;
            let small = cube(DVec3::ZERO, high, 2);
            let pair = |one: &Solid, other: &Solid| vec![one.clone(), other.clone()];
            let faces = |solid: Solid| areas(&solid, Cut::Surface, at);
            assert_eq!(faces(Solid::Union(pair(&large, &small))), [(1, 1.0)]);
            assert_eq!(faces(Solid::Union(pair(&small, &large))), [(1, 0.5), (2, 0.5)]);
            assert_eq!(faces(Solid::Intersection(pair(&large, &small))), [(1, 0.5)]);
            assert_eq!(faces(Solid::Intersection(pair(&small, &large))), [(2, 0.5)]);
            assert_eq!(faces(Solid::Difference(pair(&large, &small))), [(1, 0.5)]);
            let urgent = Solid::Leaf { shell: Shell::cube().of_material(2), priority: 1 };
            let urgent = urgent.placed(DAffine3::from_scale(high));
            assert_eq!(faces(Solid::Union(pair(&large, &urgent))), [(1, 0.5), (2, 0.5)]);
            let inner = Solid::Union(pair(&small, &urgent));
            assert_eq!(faces(Solid::Union(pair(&large, &inner))), [(1, 0.5), (2, 0.5)]);
            // What only touches.
            let mut way = DVec3::ZERO;
            way[axis] = 2.0 * side - 1.0;
            let beside = cube(way, way + DVec3::ONE, 3);
            assert_eq!(faces(Solid::Difference(pair(&large, &beside))), [(1, 1.0)]);
            assert_eq!(faces(Solid::Union(pair(&large, &beside))), []);
        }
    }
}

#[test]
fn cut_faces_are_of_the_cutter_or_of_what_was_cut() {
    let low = cube(DVec3::ZERO, dvec3(2.0, 2.0, 1.0), 1);
    let high = cube(dvec3(0.0, 0.0, 1.0), DVec3::splat(2.0), 2);
    let drill = cube(dvec3(0.5, 0.5, -1.0), dvec3(1.5, 1.5, 3.0), 3);
    let drilled = Solid::Difference(vec![Solid::Union(vec![low, high]), drill]);
    let inside = |point: DVec3| point.x > 0.4 && point.x < 1.6 && point.y > 0.4 && point.y < 1.6;
    assert_eq!(areas(&drilled, Cut::Surface, inside), [(3, 8.0)]);
    // The drill's sides are not cut where the two boxes meet, so each is made of what is behind its middle.
    let volume: f64 = areas(&drilled, Cut::Volume, inside)
        .iter()
        .filter(|(material, _)| [1, 2].contains(material))
        .map(|(_, area)| area)
        .sum();
    assert_eq!(volume, 8.0);
}

/// Objects are the smooth surfaces of the primitives that are left; they keep their normals, turned over where they cut.
#[test]
fn objects_and_normals_are_by_origin() {
    let drill = DAffine3::from_translation(dvec3(0.5, 0.5, -1.0)) * DAffine3::from_scale(dvec3(0.2, 0.2, 3.0));
    let hole = Solid::Difference(vec![leaf(Shell::cube()), leaf(Shell::cylinder(24).of_material(1)).placed(drill)]);
    let mesh = done(&hole).mesh;
    let mut objects: Vec<_> = mesh.faces().iter().map(|face| mesh.object(face)).collect();
    objects.dedup();
    assert_eq!(objects.len(), 7, "six sides of the cube and the cylinder's");
    let mut smooth = 0;
    for face in mesh.faces() {
        for corner in mesh.corners(face).iter().filter(|corner| corner.normal != u32::MAX) {
            let (point, normal) = (mesh.points[corner.point as usize], mesh.normals[corner.normal as usize]);
            let towards_axis = (Vec3::new(0.5, 0.5, point.z) - point).normalize();
            assert!(normal.distance(towards_axis) < 1e-5, "{point} {normal}");
            assert_eq!(face.material, 1);
            smooth += 1;
        }
    }
    assert_eq!(smooth, 24 * 4);
}

#[test]
fn joined_polygons_are_fewer_and_the_same() {
    let ball = leaf(Shell::sphere(12)).placed(DAffine3::from_translation(dvec3(0.3, 0.2, 0.9)));
    let solid = Solid::Difference(vec![leaf(Shell::cube()), ball]);
    let [joined, cut] = [true, false].map(|join| evaluate(&solid, Options { join, ..Options::default() }).unwrap());
    assert!(
        joined.report.polygons * 10 < cut.report.polygons * 8,
        "{} of {}",
        joined.report.polygons,
        cut.report.polygons
    );
    about(joined.report.volume, cut.report.volume);
    about(joined.report.area, cut.report.area);
    assert!(joined.report.closed && cut.report.closed);
    assert!(cut.mesh.faces().iter().all(|face| cut.mesh.corners(face).len() == 3));
    assert_eq!(done(&leaf(Shell::cube())).report.polygons, 6);
}

/// Coordinates on a coarse lattice, so that faces touch and coincide, or anywhere.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![2 => (-3i32..=3).prop_map(|n| f64::from(n) * 0.5), 1 => -1.5f64..1.5]
}

fn a_leaf() -> impl Strategy<Value = Node> {
    let place = (coordinate(), coordinate(), coordinate());
    let size = prop_oneof![Just(1.0), Just(0.5), 0.4f64..1.6];
    let turn = prop_oneof![Just(0.0), Just(90.0), 0.0f64..360.0];
    (0u32..5, place, size, turn).prop_map(|(kind, (x, y, z), size, turn)| {
        let shell = match kind {
            0 | 1 => Shell::cube(),
            2 => Shell::sphere(6),
            3 => Shell::cylinder(7),
            _ => Shell::cone(5),
        };
        let turn = DQuat::from_rotation_z(f64::to_radians(turn));
        Node::Leaf(shell, DAffine3::from_scale_rotation_translation(DVec3::splat(size), turn, dvec3(x, y, z)))
    })
}

fn a_tree() -> impl Strategy<Value = Node> {
    a_leaf().prop_recursive(3, 8, 3, |inner| {
        let operands = prop::collection::vec(inner, 2..=3);
        (0..3, operands).prop_map(|(operation, operands)| match operation {
            0 => Node::Union(operands),
            1 => Node::Intersection(operands),
            _ => Node::Difference(operands),
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// The judge: intervals along rays through the shapes as they are before any operation.
    #[test]
    fn solids_are_what_intervals_along_rays_say(tree in a_tree(), seed in 0u64..1000) {
        let evaluated = done(&tree.solid());
        prop_assert!(evaluated.report.closed, "{}", evaluated.report.sentence());
        let mut compared = 0;
        for ray in intervals::rays(seed).take(60) {
            let Some(expected) = tree.changes(&ray) else { continue };
            let Some(found) = intervals::crossings(&evaluated.mesh, &ray) else { continue };
            prop_assert_eq!(expected.len(), found.len(), "{:?} {:?} {:?}", ray, expected, found);
            for (one, other) in expected.iter().zip(&found) {
                prop_assert!((one - other).abs() < 1e-4, "{:?}: {:?} {:?}", ray, expected, found);
            }
            compared += 1;
        }
        prop_assert!(compared > 30, "{} rays compared", compared);
    }

    #[test]
    fn volumes_add_up(one in a_tree(), other in a_tree()) {
        let (a, b) = (one.solid(), other.solid());
        let of = |make: fn(Vec<Solid>) -> Solid| volume(&make(vec![a.clone(), b.clone()]));
        let (union, common, without) = (of(Solid::Union), of(Solid::Intersection), of(Solid::Difference));
        let close = |found: f64, expected: f64| (found - expected).abs() < 1e-5;
        prop_assert!(close(union + common, volume(&a) + volume(&b)), "{} {} {} {}", union, common, volume(&a), volume(&b));
        prop_assert!(close(without, volume(&a) - common), "{} {} {}", without, volume(&a), common);
        let parts = Solid::Union(vec![
            Solid::Difference(vec![a.clone(), b.clone()]),
            Solid::Intersection(vec![a.clone(), b.clone()]),
        ]);
        prop_assert!(close(volume(&parts), volume(&a)), "{} {}", volume(&parts), volume(&a));
        let nothing = done(&Solid::Difference(vec![a.clone(), a.clone()])).report;
        prop_assert_eq!(nothing.polygons, 0);
    }

    #[test]
    fn the_same_solid_is_the_same_bytes(tree in a_tree()) {
        let bytes = |evaluated: Evaluated| {
            let Evaluated { mesh, report } = evaluated;
            let faces: Vec<_> = mesh.faces().iter().map(|face| (mesh.corners(face).to_vec(), face.material)).collect();
            (mesh.points.iter().map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>(), faces, report)
        };
        let solid = tree.solid();
        let here = bytes(done(&solid));
        let there = std::thread::scope(|scope| scope.spawn(|| bytes(done(&solid))).join().unwrap());
        prop_assert_eq!(here, there);
    }
}

/// Faces that should meet but for rounding: thirds and tenths, turned in one go.
#[test]
fn rounding_keeps_nothing_apart() {
    let tower = |parts: u32| {
        let step = 1.0 / f64::from(parts);
        let part = |number: u32| {
            let low = (0..number).fold(0.0, |sum, _| sum + step);
            cube(dvec3(0.0, 0.0, low), dvec3(1.0, 1.0, f64::from(number + 1) * step), 0)
        };
        Solid::Union((0..parts).map(part).collect()).placed(DAffine3::from_rotation_x(0.3))
    };
    for parts in [3, 7, 10] {
        let report = done(&tower(parts)).report;
        about(report.volume, 1.0);
        about(report.area, 6.0);
        // Every floor has sides of its own, and the whole one floor and one ceiling.
        assert_eq!(report.polygons, u64::from(4 * parts + 2));
    }
}

fn load(folder: &Folder, text: &str) -> Result<Scene, String> {
    scene::load(&folder.file("solid.ron", text), &ReadOptions::default()).map_err(|error| {
        let text = error.to_string();
        text.rsplit_once("solid.ron").map_or(text.clone(), |(_, rest)| rest.to_owned())
    })
}

fn file(meshes: &str) -> String {
    format!("(materials: [(name: \"a\", color: (1, 0, 0)), (name: \"b\", color: (0, 1, 0))], meshes: [{meshes}])")
}

#[test]
fn scene_files_have_solids() {
    let folder = Folder::new();
    folder.file("cube.ply", std::fs::read("tests/data/cube.ply").unwrap());
    let text = file(
        r#"
        (shape: Csg(Difference([
            Union([Cube(), Place([Scale(0.5, 0.5, 0.5), Translate(1, 0.25, 0.25)], Cube(material: "a", priority: 2))]),
            Place([Scale(0.2, 0.2, 3), Translate(0.5, 0.5, -1)], Cylinder(slices: 32, material: "b")),
        ])), material: "a", cut: Volume, join: false, max_polygons: 1000, transform: [Scale(-2, 2, 2)]),
        (shape: Csg(Union([
            Sphere(slices: 9), Cone(), Torus(r: 0.2, slices: 12), Prism(points: [(0, 0), (2, 0), (2, 2)]),
            Hollow(solid: Cube(), keep: (0.5, 0.5, 0.5)), Solid(shape: File("cube.ply"), material: "b"),
        ]))),
        (shape: Csg(Intersection([Cube(), Place([Translate(0.5, 0, 0)], Solid(shape: Builtin(name: "tetra", size: 1)))]))),
        "#,
    );
    let scene = load(&folder, &text).unwrap();
    assert_eq!(scene.solids.len(), 3);
    let hole = 8.0 * (1.125 - round(32) / 2.0 * 0.04);
    about(scene.solids[0].volume, hole);
    assert!(scene.solids.iter().all(|report| report.closed && report.polygons > 3), "{:?}", scene.solids);
    assert_eq!(scene.notes.iter().filter(|note| note.starts_with("solid: ")).count(), 3);
}

#[test]
fn a_solid_of_which_nothing_is_left_is_told_where_there_is_something_else() {
    let folder = Folder::new();
    let nothing = "Difference([Cube(), Place([Scale(3, 3, 3), Translate(-1, -1, -1)], Cube())])";
    let scene = load(&folder, &file(&format!("(shape: Csg(Cube())), (shape: Csg({nothing}))"))).unwrap();
    assert_eq!(scene.mesh.faces().len(), 6);
    assert!(scene.notes.contains(&"nothing is left of a solid of 2 primitives".to_owned()), "{:?}", scene.notes);
}

#[test]
fn what_cannot_be_is_refused_at_its_place() {
    let folder = Folder::new();
    let open = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n";
    folder.file("open.ply", open);
    // Two tetrahedra, the second of which sticks in the first.
    let crossing = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nv 0.5 0.5 0.5\nv 4.5 0.5 0.5\nv 0.5 4.5 0.5\nv 0.5 0.5 4.5\n";
    let faces = |first: u32| {
        let at =
            |corners: [u32; 3]| format!("f {} {} {}\n", corners[0] + first, corners[1] + first, corners[2] + first);
        [[1, 3, 2], [1, 2, 4], [1, 4, 3], [2, 3, 4]].map(at).concat()
    };
    folder.file("crossing.obj", format!("{crossing}{}{}", faces(0), faces(4)));
    let solids = [
        "Sphere(slices: 2)",
        "Cube",
        "Cub()",
        "Sphere(slice: 12)",
        "Torus(r: 1)",
        "Prism(points: [(0, 0), (1, 0)])",
        "Prism(points: [(0, 0), (1, 1), (1, 0), (0, 1)])",
        "Prism(points: [(0, 0), (1, 0), (2, 0)])",
        "Place([Scale(1, 0, 1)], Cube())",
        "Place([Scale(1, inf, 1)], Cube())",
        "Place([Translate(NaN, 0, 0)], Cube())",
        "Union([Cube()])",
        "Difference([])",
        "Hollow(solid: Cube(), keep: (0.9, 1, 0.9))",
        "Hollow(solid: Prism(points: [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]), keep: (0.9, 0.9, 0.9))",
        "Hollow(solid: Union([Cube(), Cone()]), keep: (0.9, 0.9, 0.9))",
        r#"Cube(material: "c")"#,
        r#"Solid(shape: File("open.ply"))"#,
        r#"Solid(shape: File("crossing.obj"))"#,
        r#"Solid(shape: File("none.ply"))"#,
        "Solid(shape: Csg(Cube()))",
        "Place([Scale(1e12, 1, 1), Scale(1e12, 1, 1)], Cube())",
        "Difference([Cube(), Place([Scale(3, 3, 3), Translate(-1, -1, -1)], Cube())])",
    ];
    let mut report = String::new();
    for solid in solids {
        let text = format!("(meshes: [(shape: Csg(Union([Place([Translate(9, 9, 9)], Cube()), {solid}])))])");
        // On its own where it comes to nothing.
        let text =
            if solid.starts_with("Difference([Cube") { format!("(meshes: [(shape: Csg({solid}))])") } else { text };
        let answer = load(&folder, &text).map_or_else(|error| error, |scene| scene.notes.join("; "));
        report += &format!("{solid}\n    {answer}\n");
    }
    for mesh in [
        "(shape: Csg(Sphere(slices: 40)), max_polygons: 100)",
        "(shape: Csg(Cube()), cut: Face)",
        r#"(shape: Builtin(name: "tetra"), cut: Volume)"#,
        r#"(shape: Builtin(name: "tetra"), join: false)"#,
        r#"(shape: Builtin(name: "tetra"), max_polygons: 7)"#,
    ] {
        let answer =
            load(&folder, &format!("(meshes: [{mesh}])")).map_or_else(|error| error, |scene| scene.notes.join("; "));
        report += &format!("{mesh}\n    {answer}\n");
    }
    let deep = format!("(meshes: [(shape: Csg({}Cube(){}))])", "Place([], ".repeat(200), ")".repeat(200));
    report += &format!("200 levels\n    {}\n", load(&folder, &deep).unwrap_err());
    insta::assert_snapshot!(report);
}

/// What is exported is what the array gets, to the bit, and closed where the solid is.
#[test]
fn exported_polygons_are_read_back() {
    let folder = Folder::new();
    let said = folder.run("scenes valve --size-factor 1 --resolution 9 --export valve.ply").success();
    assert!(said.ends_with("wrote valve.ply\n"), "{said}");
    let valve = scene::builtin::generate("valve", Some(1), Some(9)).unwrap();
    let read = scene::load(&folder.path("valve.ply"), &ReadOptions::default()).unwrap();
    let faces = |mesh: &Mesh| {
        let bits = |point: Vec3| point.to_array().map(f32::to_bits);
        mesh.faces().iter().map(|face| mesh.face_points(face).map(bits).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    assert_eq!(faces(&read.mesh), faces(&valve.mesh));
    assert!(folder.run("scenes valve --export valve.ply").refused().contains("--force"));
    assert!(folder.run("scenes valve --export valve.stl").refused().contains("ends in .ply"));
    assert_eq!(folder.run("scenes --export valve.ply").status, 2);
    let told = folder.run("scenes table");
    assert!(told.stderr.contains("volume 17.6400, area 87.6600, closed"), "{}", told.stderr);
    assert!(told.success().starts_with("scene table: 31 polygons"));
}

/// What solids came to is in the statistics, and does not keep them from being run again.
#[test]
fn statistics_have_the_solids() {
    let folder = Folder::new();
    folder.run("--scene table --size 8x8 --stats table.json").success();
    let stats: serde_json::Value = serde_json::from_str(&folder.read("table.json")).unwrap();
    let solid = &stats["configuration"]["solids"][0];
    assert_eq!((solid["primitives"].as_u64(), solid["closed"].as_bool()), (Some(5), Some(true)));
    about(solid["volume"].as_f64().unwrap(), 17.64);
    folder.run("--config table.json --stats again.json").success();
    assert_eq!(folder.read("table.json"), folder.read("again.json"));
}
