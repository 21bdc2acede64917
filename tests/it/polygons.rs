//! What faces are turned into: concave ones into triangles, spheres and cones into polygons.

use std::collections::HashMap;
use std::f32::consts::TAU;

use glam::{Quat, Vec3};
use pcs_sim::scene::convex::{ConcaveReport, Cut};
use pcs_sim::scene::{Face, Mesh, split_concave, tessellate};
use proptest::prelude::*;

fn mesh_of(points: impl IntoIterator<Item = Vec3>) -> Mesh {
    let mut mesh = Mesh::default();
    let corners: Vec<u32> = points.into_iter().map(|point| mesh.add_point(point)).collect();
    mesh.add_face(&corners, 0);
    mesh
}

fn flat(points: &[(f32, f32)]) -> Vec<Vec3> {
    points.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect()
}

/// The area of a face as a vector along its normal.
fn area(mesh: &Mesh, face: &Face) -> Vec3 {
    let points: Vec<Vec3> = mesh.face_points(face).collect();
    (1..points.len() - 1).map(|i| (points[i] - points[0]).cross(points[i + 1] - points[0]) / 2.0).sum()
}

fn total_area(mesh: &Mesh) -> Vec3 {
    mesh.faces().iter().map(|face| area(mesh, face)).sum()
}

fn cut(faces: u32, triangles: u32) -> Cut {
    Cut { faces, triangles }
}

fn report_of(points: impl IntoIterator<Item = Vec3>) -> ConcaveReport {
    split_concave(mesh_of(points)).1
}

const L_SHAPE: [(f32, f32); 6] = [(0., 0.), (2., 0.), (2., 1.), (1., 1.), (1., 2.), (0., 2.)];

#[test]
fn concave_faces_become_triangles_that_keep_all_else() {
    let mut mesh = mesh_of(flat(&[(5., 5.), (6., 5.), (6., 6.), (5., 6.)]));
    let first = mesh.points.len() as u32;
    mesh.points.extend(flat(&L_SHAPE));
    let corners: Vec<u32> = (first..first + 6).collect();
    mesh.add_face(&corners, 3);
    mesh.add_face(&[0, 1, 2], 0);
    let before = total_area(&mesh);
    let (mesh, report) = split_concave(mesh);
    assert_eq!(report, ConcaveReport { concave: cut(1, 4), ..Default::default() });
    assert_eq!(report.notes(), ["1 concave face was cut into 4 triangles"]);
    assert_eq!(mesh.face_count(), 3);
    let numbers: Vec<(u32, u32)> = mesh.faces().iter().map(|face| (face.number, face.material)).collect();
    assert_eq!(numbers, [(0, 0), (1, 3), (1, 3), (1, 3), (1, 3), (2, 0)]);
    assert_eq!(total_area(&mesh), before);
    assert!(mesh.faces().iter().all(|face| area(&mesh, face).z > 0.0));
}

#[test]
fn pieces_keep_the_normals_of_their_corners() {
    let mut mesh = Mesh::default();
    let corners: Vec<_> = flat(&L_SHAPE)
        .into_iter()
        .map(|p| pcs_sim::scene::Corner { point: mesh.add_point(p), normal: mesh.add_normal(p) })
        .collect();
    mesh.add_smooth_face(&corners, 0);
    let (mesh, _) = split_concave(mesh);
    for corner in mesh.faces().iter().flat_map(|face| mesh.corners(face)) {
        assert_eq!(mesh.points[corner.point as usize], mesh.normals[corner.normal as usize]);
    }
}

#[test]
fn corners_on_a_straight_line_are_no_concavity() {
    let square = flat(&[(0., 0.), (1., 0.), (2., 0.), (2., 2.), (1., 2.), (0., 2.), (0., 1.), (0., 0.5)]);
    assert_eq!(report_of(square), ConcaveReport::default());
    let line = flat(&[(0., 0.), (1., 0.), (2., 0.), (1.5, 0.)]);
    assert_eq!(report_of(line), ConcaveReport::default());
}

#[test]
fn stars_that_go_around_twice_are_not_convex() {
    let star = (0..5).map(|i| Quat::from_rotation_z(TAU * 2.0 * i as f32 / 5.0) * Vec3::X);
    let report = report_of(star);
    assert_eq!(report, ConcaveReport { crossing: cut(1, 3), ..Default::default() });
    assert_eq!(report.notes(), ["1 face crosses itself and was cut into a fan of 3 triangles"]);
}

#[test]
fn bow_ties_cross_themselves() {
    let report = report_of(flat(&[(0., 0.), (2., 2.), (2., 0.), (0., 2.)]));
    assert_eq!(report.crossing.faces, 1);
}

#[test]
fn uneven_faces_become_triangles() {
    let bent = |height| [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, height), Vec3::Y];
    assert_eq!(report_of(bent(4e-6)), ConcaveReport::default());
    let report = report_of(bent(1e-4));
    assert_eq!(report, ConcaveReport { uneven: cut(1, 2), ..Default::default() });
    assert_eq!(report.notes(), ["1 face is not flat and was cut into 2 triangles"]);
}

#[test]
fn faces_of_too_many_corners_are_not_said_to_cross_themselves() {
    // A comb, every other tooth of which is longer.
    let teeth = (0..1 << 17).map(|i| (i as f32, if i % 2 == 0 { 1.0 } else { 2.0 }));
    let outline: Vec<(f32, f32)> = [(131071.0, 0.0), (0.0, 0.0)].into_iter().chain(teeth).collect();
    let report = report_of(flat(&outline));
    assert_eq!(report, ConcaveReport { large: cut(1, 1 << 17), ..Default::default() });
    let what = "1 face that is concave or not flat has more than 131072 corners";
    assert_eq!(report.notes(), [format!("{what}: cut into triangles around the first corner, which may cover more")]);
}

#[test]
fn gears_keep_their_area() {
    // 36 teeth of 4 corners, tilted out of all coordinate planes.
    let tilt = Quat::from_rotation_x(1.0) * Quat::from_rotation_y(0.5);
    let outline = (0..144).map(|i| {
        let radius = if i % 4 < 2 { 1.0 } else { 0.8 };
        tilt * Quat::from_rotation_z(TAU * i as f32 / 144.0) * Vec3::new(radius, 0.0, 0.0) + Vec3::splat(3.0)
    });
    let gear = mesh_of(outline);
    let before = total_area(&gear);
    let (gear, report) = split_concave(gear);
    assert_eq!(report, ConcaveReport { concave: cut(1, 142), ..Default::default() });
    assert!((total_area(&gear) - before).length() < 1e-4);
    assert!(gear.faces().iter().all(|face| area(&gear, face).dot(before) > 0.0));
}

/// Checks that every edge between two faces is run along once in each direction; gives the number of open edges.
fn open_edges(mesh: &Mesh) -> usize {
    let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
    for face in mesh.faces() {
        let corners = mesh.corners(face);
        for (i, corner) in corners.iter().enumerate() {
            let (from, to) = (corner.point, corners[(i + 1) % corners.len()].point);
            *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|count| count.abs() <= 1));
    edges.values().filter(|count| **count != 0).count()
}

/// Whether all faces and their normals point away from a point, or all towards it.
fn outward(mesh: &Mesh, center: Vec3, sign: f32) -> bool {
    mesh.faces().iter().all(|face| {
        let normal = area(mesh, face);
        let middle = mesh.face_points(face).sum::<Vec3>() / mesh.corners(face).len() as f32;
        let smooth = mesh.corners(face).iter().all(|corner| mesh.normals[corner.normal as usize].dot(normal) > 0.0);
        smooth && normal.dot(middle - center) * sign > 0.0
    })
}

#[test]
fn sphere_counts() {
    for (slices, stacks) in [(3, 2), (4, 2), (5, 2), (8, 4), (16, 8)] {
        let mut mesh = Mesh::default();
        tessellate::sphere(&mut mesh, Vec3::ONE, 2.0, slices, 1);
        assert_eq!(mesh.face_count(), slices * stacks);
        assert_eq!(mesh.points.len() as u32, slices * (stacks - 1) + 2);
        let triangles = mesh.faces().iter().filter(|face| mesh.corners(face).len() == 3).count();
        assert_eq!(triangles as u32, 2 * slices);
    }
}

#[test]
fn cone_counts() {
    for (base, apex, corners) in [(1.0, 0.5, 4), (1.0, 0.0, 3), (0.0, 1.0, 3), (1.0, 1.0, 4)] {
        let mut mesh = Mesh::default();
        tessellate::cone(&mut mesh, Vec3::ZERO, base, Vec3::ONE, apex, 7, 0);
        assert_eq!(mesh.face_count(), 7);
        assert!(mesh.faces().iter().all(|face| mesh.corners(face).len() == corners));
    }
}

#[test]
fn nothing_round_is_nothing() {
    let mut mesh = Mesh::default();
    tessellate::sphere(&mut mesh, Vec3::ONE, 0.0, 8, 0);
    tessellate::cone(&mut mesh, Vec3::ONE, 1.0, Vec3::ONE, 1.0, 8, 0);
    tessellate::cone(&mut mesh, Vec3::ONE, 0.0, Vec3::ZERO, 0.0, 8, 0);
    assert!(mesh.faces().is_empty() && mesh.points.is_empty());
}

fn vector() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-50.0f32..50.0).prop_map(Vec3::from_array)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn spheres_are_closed_and_convex(center in vector(), radius in 0.1f32..20.0, slices in 3u32..40, sign in prop::bool::ANY) {
        let sign = if sign { 1.0 } else { -1.0 };
        let mut mesh = Mesh::default();
        tessellate::sphere(&mut mesh, center, radius * sign, slices, 0);
        prop_assert_eq!(open_edges(&mesh), 0);
        prop_assert!(outward(&mesh, center, sign));
        prop_assert_eq!(split_concave(mesh).1, ConcaveReport::default());
    }

    #[test]
    fn cones_are_open_at_their_ends_and_convex(
        base in vector(), axis in vector(), radii in (0.1f32..20.0, 0.0f32..20.0), slices in 4u32..40, sign in prop::bool::ANY,
    ) {
        prop_assume!(axis.length() > 1.0);
        let sign = if sign { 1.0 } else { -1.0 };
        let mut mesh = Mesh::default();
        let apex = base + axis;
        tessellate::cone(&mut mesh, base, radii.0 * sign, apex, radii.1 * sign, slices, 0);
        let ends = if radii.1 == 0.0 { 1 } else { 2 };
        prop_assert_eq!(open_edges(&mesh), ends * slices as usize);
        let middle = (base + apex) / 2.0;
        prop_assert!(outward(&mesh, middle, sign));
        prop_assert_eq!(split_concave(mesh).1, ConcaveReport::default());
    }

    #[test]
    fn regular_polygons_are_convex_wherever_they_lie(
        center in vector(), turn in vector(), radius in 0.01f32..100.0, corners in 4u32..200,
    ) {
        let turn = Quat::from_scaled_axis(turn);
        let polygon = (0..corners).map(|i| {
            center * 10.0 + turn * Quat::from_rotation_z(TAU * i as f32 / corners as f32) * Vec3::X * radius
        });
        prop_assert_eq!(report_of(polygon), ConcaveReport::default());
    }
}
