//! The built-in scenes: are they what they are published to be, and what the array can take?

use std::hash::{DefaultHasher, Hash, Hasher};

use glam::DVec3;
use pcs_sim::scene::builtin::{self, Builtin, Primitives};
use pcs_sim::scene::{Mesh, ReadOptions, Scene};

fn generate(name: &str, size: u32) -> Scene {
    builtin::generate(name, Some(size), None).unwrap()
}

fn find(name: &str) -> &'static Builtin {
    builtin::all().iter().find(|scene| scene.name == name).unwrap()
}

fn primitives(polygons: u64, spheres: u64, cones: u64) -> Primitives {
    Primitives { polygons, spheres, cones, solids: 0 }
}

/// Every scene at its default size and at the two smallest.
fn samples() -> impl Iterator<Item = Scene> {
    builtin::all().iter().flat_map(|scene| sizes(scene).map(|size| generate(scene.name, size)))
}

fn sizes(scene: &Builtin) -> impl Iterator<Item = u32> + use<> {
    let least = *scene.size_range.start();
    [least, least + 1, scene.default_size].into_iter()
}

/// The table of the databases' guide, and what their programs say of the later scenes.
#[test]
fn default_counts_are_the_published_ones() {
    let published = [
        ("balls", 4, primitives(1, 7381, 0)),
        ("gears", 4, primitives(9345, 0, 0)),
        ("lattice", 12, primitives(0, 2197, 6084)),
        ("mountain", 6, primitives(8192, 4, 0)),
        ("rings", 7, primitives(1, 4200, 4200)),
        ("shells", 5, primitives(0, 5761, 0)),
        ("sombrero", 1, primitives(1922, 0, 0)),
        ("teapot", 12, primitives(9264, 0, 0)),
        ("tetra", 6, primitives(4096, 0, 0)),
        ("tree", 11, primitives(1, 4095, 4095)),
        ("room", 1, primitives(45, 0, 0)),
        ("table", 1, Primitives { polygons: 1, solids: 5, ..Primitives::default() }),
        ("valve", 2, Primitives { solids: 42, ..Primitives::default() }),
        ("chapel", 3, Primitives { solids: 62, ..Primitives::default() }),
        ("reference", 100, primitives(100_000, 0, 0)),
    ];
    assert_eq!(builtin::all().len(), published.len());
    for (name, size, count) in published {
        let scene = find(name);
        assert_eq!(scene.default_size, size, "{name}");
        assert_eq!(scene.primitives(size), count, "{name}");
    }
}

#[test]
fn other_sizes_count_as_published() {
    for (size, count) in [(1, 8), (2, 32), (3, 128)] {
        assert_eq!(find("mountain").primitives(size), primitives(count, 4, 0));
    }
    for (size, spheres, cylinders) in [(1, 8, 12), (2, 27, 54), (3, 64, 144), (5, 216, 540)] {
        assert_eq!(find("lattice").primitives(size), primitives(0, spheres, cylinders));
    }
    for (size, patches, squares) in [(2, 240, 4), (3, 552, 9), (12, 9120, 144)] {
        assert_eq!(find("teapot").primitives(size), primitives(patches + squares, 0, 0));
    }
    for (size, faces, rectangles) in [(1, 2, 144), (2, 16, 1152), (3, 54, 3888)] {
        assert_eq!(find("gears").primitives(size), primitives(1 + faces + rectangles, 0, 0));
    }
}

#[test]
fn scenes_have_as_many_faces_as_they_announce() {
    for scene in builtin::all() {
        for size in sizes(scene) {
            let mesh = generate(scene.name, size).mesh;
            assert_eq!(u64::from(mesh.face_count()), scene.faces(size, None), "{} {size}", scene.name);
        }
    }
}

#[test]
fn resolution_sets_the_slices() {
    for (resolution, faces) in [(3, 1 + 10 * 3 * 2), (4, 1 + 10 * 4 * 2), (9, 1 + 10 * 9 * 4)] {
        let mesh = builtin::generate("balls", Some(1), Some(resolution)).unwrap().mesh;
        assert_eq!(mesh.faces().len(), faces);
        assert_eq!(find("balls").faces(1, Some(resolution)), faces as u64);
    }
    let flat = builtin::generate("tetra", Some(2), Some(9)).unwrap().mesh;
    assert_eq!(flat.faces().len(), 16);
}

#[test]
fn reference_has_a_thousand_polygons_for_each_unit_of_size() {
    for size in (1..=40).chain([98, 99, 100, 101, 997]) {
        assert_eq!(generate("reference", size).mesh.faces().len(), size as usize * 1000);
    }
}

#[test]
fn gear_faces_are_cut_into_pieces_of_the_same_number() {
    let mesh = generate("gears", 1).mesh;
    let pieces = |number: u32| mesh.faces().iter().filter(|face| face.number == number).count();
    assert_eq!(mesh.face_count(), 147);
    assert_eq!((pieces(0), pieces(1), pieces(2), pieces(146)), (1, 142, 1, 142));
}

#[test]
fn all_faces_are_finite_flat_convex_and_not_empty() {
    for scene in samples() {
        for (i, face) in scene.mesh.faces().iter().enumerate() {
            let points: Vec<DVec3> = scene.mesh.face_points(face).map(|point| point.as_dvec3()).collect();
            assert!(points.iter().all(|point| point.is_finite()), "{}: face {i} is not finite", scene.name);
            check_shape(&points).unwrap_or_else(|fault| panic!("{}: face {i} {fault}: {points:?}", scene.name));
        }
    }
}

/// Fails unless a face has an area, lies in its plane and turns one way only.
///
/// Coordinates are rounded to 32 bits, which lifts a corner off its plane by some parts in ten million of its
/// distance from the origin.
fn check_shape(points: &[DVec3]) -> Result<(), &'static str> {
    let next = |i: usize| points[(i + 1) % points.len()];
    let area: DVec3 = (1..points.len() - 1).map(|i| (points[i] - points[0]).cross(points[i + 1] - points[0])).sum();
    let normal = area.try_normalize().ok_or("has no area")?;
    let rounding = 4e-7 * points.iter().map(|point| point.length()).fold(0.0, f64::max);
    if points.iter().any(|&point| (point - points[0]).dot(normal).abs() > rounding) {
        return Err("is not flat");
    }
    let convex = (0..points.len()).all(|i| {
        let edge = next(i) - points[i];
        let inward = normal.cross(edge).normalize();
        points.iter().all(|&point| (point - points[i]).dot(inward) > -rounding)
    });
    if convex { Ok(()) } else { Err("is not convex") }
}

#[test]
fn normals_are_on_the_front_of_their_face() {
    for builtin in builtin::all() {
        let scene = generate(builtin.name, builtin.default_size);
        for face in scene.mesh.faces() {
            let points: Vec<DVec3> = scene.mesh.face_points(face).map(|point| point.as_dvec3()).collect();
            let flat = (points[1] - points[0]).cross(points[2] - points[0]);
            for corner in scene.mesh.corners(face).iter().filter(|corner| corner.normal != u32::MAX) {
                let normal = scene.mesh.normals[corner.normal as usize].as_dvec3();
                assert!(normal.is_finite() && normal.length() > 0.1, "{}", scene.name);
                assert!(normal.dot(flat) > 0.0, "{}: {points:?} {normal}", scene.name);
            }
        }
    }
}

#[test]
fn generation_is_deterministic() {
    let hash = |mesh: &Mesh| {
        let mut hasher = DefaultHasher::new();
        for vector in mesh.points.iter().chain(&mesh.normals) {
            vector.to_array().map(f32::to_bits).hash(&mut hasher);
        }
        for face in mesh.faces() {
            let corners: Vec<(u32, u32)> = mesh.corners(face).iter().map(|c| (c.point, c.normal)).collect();
            (corners, face.material, face.number).hash(&mut hasher);
        }
        hasher.finish()
    };
    for (one, two) in samples().zip(samples()) {
        assert_eq!(hash(&one.mesh), hash(&two.mesh), "{}", one.name);
    }
}

#[test]
fn scenes_are_complete() {
    for scene in samples() {
        let materials = scene.materials.len() as u32;
        assert!(scene.mesh.faces().iter().all(|face| face.material < materials), "{}", scene.name);
        assert!(!scene.lights.is_empty(), "{}", scene.name);
        assert_eq!(scene.camera.check(), Ok(()), "{}", scene.name);
    }
}

#[test]
fn the_eye_of_our_own_scenes_is_inside() {
    for name in ["room", "chapel", "reference"] {
        let scene = builtin::generate(name, None, None).unwrap();
        let (low, high) = scene.mesh.bounds().unwrap();
        assert!(scene.camera.from.cmpgt(low).all() && scene.camera.from.cmplt(high).all(), "{name}");
    }
}

#[test]
fn sizes_out_of_range_are_refused() {
    for scene in builtin::all() {
        let (least, most) = (*scene.size_range.start(), *scene.size_range.end());
        for size in [least - 1, most + 1] {
            let error = builtin::generate(scene.name, Some(size), None).unwrap_err();
            let expected = format!("size {size} of scene `{}` is not in {least} to {most}", scene.name);
            assert_eq!(error.message, expected);
        }
    }
}

#[test]
fn resolutions_out_of_range_are_refused() {
    let (least, most) = ReadOptions::RESOLUTIONS.into_inner();
    for resolution in [0, least - 1, most + 1, u32::MAX] {
        let error = builtin::generate("balls", Some(1), Some(resolution)).unwrap_err();
        let expected = format!("resolution {resolution} of scene `balls` is not in {least} to {most}");
        assert_eq!(error.message, expected);
    }
}

#[test]
fn largest_sizes_fit_at_the_default_resolution() {
    for scene in builtin::all() {
        let most = *scene.size_range.end();
        assert!(scene.faces(most, None) <= 20_000_000, "{}", scene.name);
    }
    let error = builtin::generate("balls", Some(6), Some(64)).unwrap_err();
    assert!(error.message.contains("polygons, more than the"), "{error}");
}

#[test]
fn unknown_names_are_refused_with_a_suggestion() {
    let error = builtin::generate("teapots", None, None).unwrap_err();
    assert!(error.message.contains("balls, gears, lattice, mountain, rings, shells, sombrero, teapot"), "{error}");
    assert_eq!(error.help.as_deref(), Some("did you mean `teapot`?"));
    assert_eq!(builtin::generate("elephant", None, None).unwrap_err().help, None);
}
