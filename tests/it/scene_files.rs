//! Scene files that are right: what becomes of them.

use std::fs;
use std::path::{Path, PathBuf};

use glam::Vec3;
use pcs_sim::scene::{self, Camera, Face, Material, Mesh, ReadOptions, Scene};
use proptest::prelude::*;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn load(path: &Path) -> Scene {
    let scene = scene::load(path, &ReadOptions { resolution: 8 }).unwrap_or_else(|error| panic!("{error}"));
    check_invariants(&scene);
    scene
}

/// Writes a file and loads it.
fn load_text(test: &str, extension: &str, contents: impl AsRef<[u8]>) -> Scene {
    let path = temporary(test).with_extension(extension);
    fs::write(&path, contents).unwrap();
    load(&path)
}

fn temporary(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("scene_files");
    fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

/// What every scene promises to those who trace it.
fn check_invariants(scene: &Scene) {
    let mesh = &scene.mesh;
    assert!(!mesh.faces().is_empty());
    assert!(mesh.points.iter().chain(&mesh.normals).all(|p| p.is_finite()));
    assert!(scene.camera.check().is_ok());
    for face in mesh.faces() {
        assert!(mesh.corners(face).len() >= 3);
        assert!((face.material as usize) < scene.materials.len());
        for corner in mesh.corners(face) {
            assert!((corner.point as usize) < mesh.points.len());
            assert!(corner.normal == scene::mesh::NO_NORMAL || (corner.normal as usize) < mesh.normals.len());
        }
    }
    let (_, report) = scene::split_concave(mesh.clone());
    assert_eq!(report, Default::default(), "a second cut finds nothing to do");
}

/// Every face as the list of its points.
fn polygons(mesh: &Mesh) -> Vec<Vec<Vec3>> {
    mesh.faces().iter().map(|face| mesh.face_points(face).collect()).collect()
}

fn area(mesh: &Mesh, face: &Face) -> Vec3 {
    let points: Vec<Vec3> = mesh.face_points(face).collect();
    (1..points.len() - 1).map(|i| (points[i] - points[0]).cross(points[i + 1] - points[0]) / 2.0).sum()
}

#[test]
fn obj_cube() {
    let scene = load(&data("cube.obj"));
    assert_eq!(scene.name, "cube");
    assert_eq!(scene.mesh.points.len(), 8);
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let top = vec![corner(-1., -1., 1.), corner(1., -1., 1.), corner(1., 1., 1.), corner(-1., 1., 1.)];
    assert_eq!(polygons(&scene.mesh)[1], top);
    let outward: Vec<Vec3> = scene.mesh.faces().iter().map(|face| area(&scene.mesh, face)).collect();
    assert_eq!(outward, [Vec3::NEG_Z, Vec3::Z, Vec3::NEG_Y, Vec3::X, Vec3::Y, Vec3::NEG_X].map(|n| n * 4.0));
    let normals = |face: usize| scene.mesh.corners(&scene.mesh.faces()[face]).iter().map(|c| c.normal).max();
    assert_eq!([normals(0), normals(1), normals(2)], [Some(u32::MAX), Some(0), Some(1)]);
}

#[test]
fn obj_materials() {
    let scene = load(&data("cube.obj"));
    let numbers: Vec<u32> = scene.mesh.faces().iter().map(|face| face.material).collect();
    assert_eq!(numbers, [0, 1, 1, 2, 3, 3]);
    let paint = Material {
        color: Vec3::new(0.8, 0.1, 0.1),
        specular: 0.3,
        shine: 40.0,
        refraction: 1.5,
        ..Material::default()
    };
    assert_eq!(scene.materials[1], paint);
    assert_eq!(scene.materials[2], Material::default());
    assert_eq!(scene.materials[3].transmittance, 0.75);
    assert_eq!(scene.materials[3].refraction, 1.0);
    let notes = [
        "1 material without a definition became the default material",
        "1 line was passed over (`l`): only faces are traced",
    ];
    assert_eq!(scene.notes, notes);
}

#[test]
fn obj_without_its_material_file() {
    let scene = load_text("no_mtl", "obj", "mtllib gone.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3");
    assert_eq!(scene.notes, ["material file `gone.mtl` was not found, the default material takes its place"]);
    assert_eq!(scene.materials, [Material::default(); 2]);
}

#[test]
fn obj_faces_may_come_before_their_points() {
    let scene = load_text("ahead", "obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    assert_eq!(polygons(&scene.mesh), [[Vec3::ZERO, Vec3::X, Vec3::Y]]);
}

#[test]
fn ply_cube_is_the_obj_cube() {
    let cube = polygons(&load(&data("cube.obj")).mesh);
    assert_eq!(polygons(&load(&data("cube.ply")).mesh), cube);
    for big_endian in [false, true] {
        let scene = load_text(&format!("cube_{big_endian}"), "ply", binary_cube(big_endian));
        assert_eq!(polygons(&scene.mesh), cube);
        assert_eq!(scene.mesh.normals.len(), 8);
    }
}

/// The cube as binary PLY, with normals and with lists of 16-bit lengths.
fn binary_cube(big_endian: bool) -> Vec<u8> {
    let order = if big_endian { "big" } else { "little" };
    let mut file = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex 8\r\nproperty float x\r\nproperty float y\r\n\
         property float z\r\nproperty double nx\r\nproperty float ny\r\nproperty float nz\r\nelement face 6\r\n\
         property list short int vertex_indices\r\nproperty char flag\r\nend_header\r\n"
    )
    .into_bytes();
    let mut put = |bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        if big_endian {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    let scene = load(&data("cube.obj"));
    for point in &scene.mesh.points {
        point.to_array().iter().for_each(|number| put(&number.to_le_bytes()));
        put(&f64::from(point.x).to_le_bytes());
        put(&point.y.to_le_bytes());
        put(&point.z.to_le_bytes());
    }
    for face in scene.mesh.faces() {
        let corners = scene.mesh.corners(face);
        put(&(corners.len() as i16).to_le_bytes());
        corners.iter().for_each(|corner| put(&corner.point.to_le_bytes()));
        put(&[7]);
    }
    file
}

#[test]
fn nff_shapes() {
    let scene = load(&data("shapes.nff"));
    let camera = Camera { from: Vec3::new(4., -6., 3.), at: Vec3::new(0., 0., 0.5), up: Vec3::Z, angle: 45.0 };
    assert_eq!(scene.camera, camera);
    assert_eq!(scene.background, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!(scene.lights[0].color, Vec3::splat(0.5f32.sqrt()));
    assert_eq!(scene.lights[1].color, Vec3::new(0.5, 0.5, 1.0));
    assert_eq!(scene.materials.len(), 4);
    assert_eq!(scene.materials[1].refraction, 1.0);
    assert_eq!(scene.materials[2], Material { color: Vec3::new(0.2, 0.3, 1.0), ..Material::default() });
    assert_eq!(scene.materials[3].transmittance, 0.25);
    // A polygon, a patch, two spheres of 8 slices and 4 stacks, a cone and a cylinder.
    assert_eq!(scene.mesh.face_count(), 1 + 1 + 2 * 32 + 8 + 8);
    let materials: Vec<u32> = scene.mesh.faces().iter().map(|face| face.material).collect();
    assert_eq!(materials[..2], [1, 2]);
    assert!(materials[2..].iter().all(|&material| material == 3));
    assert!(scene.notes.is_empty());
}

#[test]
fn ron_with_everything() {
    let scene = load(&data("everything.ron"));
    assert_eq!(scene.camera.angle, 35.5);
    assert_eq!(scene.lights.len(), 2);
    assert_eq!(scene.lights[0].color, Vec3::ONE);
    // The default, the file's two, and those of the cube and of the balls, which have no material of the file's.
    assert_eq!(scene.materials.len(), 1 + 2 + 4 + 2);
    // Two cubes, shapes, a floor and ten balls of four slices and two stacks, two polygons.
    assert_eq!(scene.mesh.face_count(), 6 + 6 + 82 + (1 + 10 * 4 * 2) + 2);
    let faces = scene.mesh.faces();
    assert_eq!([faces[0].material, faces[1].material], [3, 4]);
    assert_eq!([faces[6].material, faces[12].material], [1, 2]);
    // Twice as high, then up by 2.
    assert_eq!(scene.mesh.face_points(&faces[1]).map(|p| p.z).collect::<Vec<_>>(), [4.0; 4]);
    // A quarter turn brings (-1, -1) to (1, -1), then to (5, -1).
    let moved = scene.mesh.face_points(&faces[8]).next().unwrap();
    assert!((moved - Vec3::new(5.0, -1.0, -1.0)).length() < 1e-5, "{moved}");
    // Mirrored, the floor still faces up.
    assert!(area(&scene.mesh, &faces[12]).z > 0.0);
    assert!(scene.notes.contains(&"1 concave face was cut into 3 triangles".to_owned()), "{:?}", scene.notes);
    assert_eq!(faces[faces.len() - 2].number, faces[faces.len() - 3].number);
}

#[test]
fn example_scene() {
    let scene = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/example.ron"));
    assert_eq!(scene.notes, ["1 concave face was cut into 3 triangles"]);
}

#[test]
fn a_scene_without_a_camera_is_framed() {
    for (name, up) in [("cube.obj", Vec3::Y), ("cube.ply", Vec3::Z)] {
        let scene = load(&data(name));
        let Camera { from, at, up: camera_up, angle } = scene.camera;
        assert_eq!((camera_up, angle, at), (up, 40.0, Vec3::ZERO));
        assert!(from.dot(up) > 0.0);
        // The bounding sphere, of radius the root of 3, touches the cone of view.
        assert!((3f32.sqrt() / from.length() - 20f32.to_radians().sin()).abs() < 1e-6);
    }
}

#[test]
fn extensions_in_capitals() {
    let contents = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(load_text("capitals", "OBJ", contents).mesh.face_count(), 1);
}

#[test]
fn byte_order_marks_are_passed_over() {
    let contents = "\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(load_text("mark", "obj", contents).mesh.face_count(), 1);
}

/// A valid file of a format, as bytes.
fn valid(extension: &str) -> Vec<u8> {
    match extension {
        "obj" => fs::read(data("cube.obj")).unwrap(),
        "ply" => fs::read(data("cube.ply")).unwrap(),
        "nff" => fs::read(data("shapes.nff")).unwrap(),
        "ron" => fs::read(data("everything.ron")).unwrap(),
        _ => unreachable!(),
    }
}

/// What mutations put in, to get further than random bytes do.
const SCRAPS: [&str; 26] = [
    "nan",
    "-inf",
    "1e400",
    "1e15",
    "1e-50",
    "-1",
    "0",
    "4294967295",
    "4294967296",
    "99999999999999999999",
    "-0",
    "\n",
    "\r\n",
    "\\\n",
    "#",
    "/*",
    "//",
    "(",
    ")",
    "[",
    "None",
    "Some(",
    "\"",
    "p ",
    "s 0 0 0 1 ",
    "\u{e4}",
];

#[derive(Clone, Debug)]
enum Mutation {
    Byte(u8),
    Scrap(usize),
    Drop(usize),
    Repeat(usize),
    End,
}

fn mutation() -> impl Strategy<Value = (prop::sample::Index, Mutation)> {
    let kind = prop_oneof![
        any::<u8>().prop_map(Mutation::Byte),
        (0..SCRAPS.len()).prop_map(Mutation::Scrap),
        (1..40usize).prop_map(Mutation::Drop),
        (1..40usize).prop_map(Mutation::Repeat),
        Just(Mutation::End),
    ];
    (any::<prop::sample::Index>(), kind)
}

fn mutate(bytes: &mut Vec<u8>, at: usize, mutation: &Mutation) {
    match *mutation {
        Mutation::Byte(byte) => bytes[at] = byte,
        Mutation::Scrap(scrap) => drop(bytes.splice(at..at, SCRAPS[scrap].bytes())),
        Mutation::Drop(length) => drop(bytes.drain(at..(at + length).min(bytes.len()))),
        Mutation::Repeat(length) => bytes.extend_from_within(at..(at + length).min(bytes.len())),
        Mutation::End => bytes.truncate(at),
    }
}

/// Loads a mutated file: it is a scene that keeps its promises, or an error in a known file.
fn survives(extension: &str, mut bytes: Vec<u8>, mutations: &[(prop::sample::Index, Mutation)]) {
    for (at, mutation) in mutations {
        if !bytes.is_empty() {
            let at = at.index(bytes.len());
            mutate(&mut bytes, at, mutation);
        }
    }
    // Beside the valid files, so that what a scene names is found.
    let folder = temporary("mutated");
    fs::create_dir_all(&folder).unwrap();
    for name in ["cube.obj", "cube.mtl", "cube.ply", "shapes.nff"] {
        if !folder.join(name).exists() {
            fs::copy(data(name), folder.join(name)).unwrap();
        }
    }
    let path = folder.join("mutated").with_extension(extension);
    fs::write(&path, bytes).unwrap();
    match scene::load(&path, &ReadOptions { resolution: 3 }) {
        Ok(scene) => check_invariants(&scene),
        Err(error) => assert!(error.place.is_some() && !error.message.is_empty(), "{error}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_obj_files_do_not_panic(mutations in prop::collection::vec(mutation(), 1..6)) {
        survives("obj", valid("obj"), &mutations);
    }

    #[test]
    fn mutated_ply_files_do_not_panic(mutations in prop::collection::vec(mutation(), 1..6), kind in 0..3) {
        let bytes = if kind == 0 { valid("ply") } else { binary_cube(kind == 1) };
        survives("ply", bytes, &mutations);
    }

    #[test]
    fn mutated_nff_files_do_not_panic(mutations in prop::collection::vec(mutation(), 1..6)) {
        survives("nff", valid("nff"), &mutations);
    }

    #[test]
    fn mutated_ron_files_do_not_panic(mutations in prop::collection::vec(mutation(), 1..6)) {
        survives("ron", valid("ron"), &mutations);
    }
}

/// Of a material that is defined again the first definition holds, and a note says so.
#[test]
fn a_material_defined_again_is_told() {
    let folder = crate::support::command::Folder::new();
    folder.file("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl red\nKd 0 1 0\n");
    folder.file("b.mtl", "newmtl red\nKd 0 0 1\nnewmtl blue\nKd 0 0 1\nnewmtl blue\n");
    folder.file(
        "s.obj",
        "mtllib a.mtl\nmtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 2 3\n",
    );
    let told = folder.run("scenes s.obj").stderr;
    assert!(told.contains("note: a.mtl: a definition of `red` was passed over, which was defined before"), "{told}");
    assert!(
        told.contains("note: b.mtl: 2 definitions were passed over of materials that were defined before, `red` first"),
        "{told}"
    );
}
