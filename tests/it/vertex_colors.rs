//! Colours of vertices, and materials of faces: from each format that has them, through the array's alpha and beta, to the picture's light.

use std::convert::Infallible;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3, Vec3};
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::sampling::Sampling;
use pcs_sim::host::shading::Limits;
use pcs_sim::program::Workload;
use pcs_sim::run::{self, Picture, Workers};
use pcs_sim::scene::{self, Camera, Corner, Face, Light, ReadOptions, Scene};

/// A square with a colour at each corner, coded as in a picture.
const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
const CODED: [[f64; 3]; 4] = [[1.0, 0.0, 0.2], [0.0, 1.0, 0.4], [0.6, 0.0, 1.0], [1.0, 0.8, 0.0]];

/// A part of a colour as linear light (IEC 61966-2-1).
fn linear(coded: f64) -> f64 {
    if coded <= 0.04045 { coded / 12.92 } else { ((coded + 0.055) / 1.055).powf(2.4) }
}

fn linear_colors() -> [DVec3; 4] {
    CODED.map(|color| DVec3::from(color.map(linear)))
}

/// Puts a file where the other files of these tests are.
fn file(name: &str, contents: impl AsRef<[u8]>) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("vertex_colors");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), contents).unwrap();
    folder.join(name)
}

fn load(name: &str, contents: impl AsRef<[u8]>) -> Scene {
    let path = file(name, contents);
    scene::load(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn obj() -> String {
    let vertex = |i: usize| {
        let ([x, y], [r, g, b]) = (CORNERS[i], CODED[i]);
        format!("v {x} {y} 0 {r} {g} {b}\n")
    };
    (0..4).map(vertex).collect::<String>() + "f 1 2 3 4\n"
}

fn ply(kind: &str, names: [&str; 3], most: f64) -> String {
    let colors: String = names.iter().map(|name| format!("property {kind} {name}\n")).collect();
    let vertex = |i: usize| {
        let ([x, y], [r, g, b]) = (CORNERS[i], CODED[i].map(|part| part * most));
        format!("{x} {y} 0 {r} {g} {b} 7\n")
    };
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{colors}\
         property uchar alpha\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n{}4 0 1 2 3\n",
        (0..4).map(vertex).collect::<String>(),
    )
}

fn ron() -> String {
    let points = CORNERS.map(|[x, y]| format!("({x}, {y}, 0)")).join(", ");
    let colors = linear_colors().map(|c| format!("({}, {}, {})", c.x, c.y, c.z)).join(", ");
    format!("Scene(meshes: [(shape: Polygons(points: [{points}], faces: [[0, 1, 2, 3]], colors: [{colors}]))])")
}

/// A picture of the unit square from above, each pixel the light of its middle.
fn seen_from_above(mut scene: Scene, side: u32) -> Vec<Vec3> {
    // Light straight from above makes a matt surface as bright as its colour.
    scene.lights = vec![Light::directional(Vec3::Z, Vec3::ONE)];
    let angle = (2.0 * 0.5f32.atan2(10.0)).to_degrees();
    scene.camera = Camera { from: Vec3::new(0.5, 0.5, 10.0), at: Vec3::new(0.5, 0.5, 0.0), up: Vec3::Y, angle };
    let machine = crate::support::machine();
    let workload = Workload::new(&scene.mesh, &crate::support::program("pipeline", 1), machine.times, &[]).unwrap();
    let size = ImageSize { width: side, height: side };
    let (sampling, limits) = (Sampling::default(), Limits::default());
    let picture =
        Picture { scene: &scene, workload: &workload, size, sampling, limits, screen: None, rules: Default::default() };
    run::render(&picture, None, &Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap().pixels
}

/// The middles of the pixels on the square, line by line from the top left.
fn places(side: u32) -> Vec<DVec2> {
    let middle = |k: u32| (k as f64 + 0.5) / side as f64;
    (0..side * side).map(|pixel| DVec2::new(middle(pixel % side), 1.0 - middle(pixel / side))).collect()
}

/// The colour at a place of the square: it is a fan of two triangles around its first corner, in each of which colours
/// are linear functions of the place.
fn between(colors: [DVec3; 4], at: DVec2) -> DVec3 {
    let [c0, c1, c2, c3] = colors;
    if at.y <= at.x { c0 + (c1 - c0) * at.x + (c2 - c1) * at.y } else { c0 + (c3 - c0) * at.y + (c2 - c3) * at.x }
}

#[track_caller]
fn expect(scene: Scene, colors: [DVec3; 4], tolerance: f64) {
    let name = scene.name.clone();
    let pixels = seen_from_above(scene, 21);
    for (pixel, place) in pixels.iter().zip(places(21)) {
        let expected = between(colors, place);
        let off = (pixel.as_dvec3() - expected).abs().max_element();
        assert!(off < tolerance, "{name}: {pixel} for {expected} at {place}");
    }
}

#[test]
fn every_format_that_has_them_paints_the_closed_form() {
    expect(load("square.obj", obj()), linear_colors(), 1e-5);
    expect(load("square.ron", ron()), linear_colors(), 1e-5);
    // All parts are whole 255ths.
    expect(load("bytes.ply", ply("uchar", ["red", "green", "blue"], 255.0)), linear_colors(), 1e-5);
    expect(
        load("words.ply", ply("ushort", ["diffuse_red", "diffuse_green", "diffuse_blue"], 65535.0)),
        linear_colors(),
        1e-5,
    );
    expect(load("floats.ply", ply("float", ["r", "g", "b"], 1.0)), linear_colors(), 1e-5);
}

#[test]
fn a_vertex_without_a_colour_has_its_materials() {
    file("paint.mtl", "newmtl paint\nKd 0.1 0.2 0.9\n");
    let mixed = obj().replace(" 0 1 0.4\n", "\n").replace("f 1", "usemtl paint\nf 1");
    let [c0, _, c2, c3] = linear_colors();
    expect(load("mixed.obj", format!("mtllib paint.mtl\n{mixed}")), [c0, DVec3::new(0.1, 0.2, 0.9), c2, c3], 1e-5);
}

#[test]
fn a_scene_file_keeps_the_colours_of_a_mesh_unless_it_names_a_material() {
    file("inner.obj", obj());
    let scene = |rest: &str| {
        let plain = r#"(shape: Builtin(name: "tetra", size: 1), transform: [Translate(0, 0, -5)])"#;
        let materials = r#"materials: [(name: "blue", color: (0, 0, 1))]"#;
        format!("Scene({materials}, meshes: [{plain}, (shape: File(\"inner.obj\"){rest})])")
    };
    expect(load("keeps.ron", scene("")), linear_colors(), 1e-5);
    expect(load("names.ron", scene(", material: \"blue\"")), [DVec3::Z; 4], 1e-5);
    // Mirrored, the square's corners run the other way: its fan is around the last one, now at the top right.
    let mirrored = load("mirrored.ron", scene(", transform: [Scale(-1, 1, 1), Translate(1, 0, 0)]"));
    let [c0, c1, c2, c3] = linear_colors();
    for (pixel, place) in seen_from_above(mirrored, 21).iter().zip(places(21)) {
        let expected = between([c3, c2, c1, c0], DVec2::ONE - place);
        assert!((pixel.as_dvec3() - expected).abs().max_element() < 1e-5, "{pixel} for {expected} at {place}");
    }
}

#[test]
fn faces_of_a_scene_file_may_have_materials_of_their_own() {
    let materials = r#"materials: [(name: "red", color: (1, 0, 0)), (name: "blue", color: (0, 0, 1))]"#;
    let halves = "points: [(0,0,0), (0.5,0,0), (1,0,0), (1,1,0), (0.5,1,0), (0,1,0)], faces: [[0,1,4,5], [1,2,3,4]]";
    let shape = format!("(shape: Polygons({halves}, materials: [\"blue\", \"red\"]))");
    let scene = load("halves.ron", format!("Scene({materials}, meshes: [{shape}])"));
    for (pixel, place) in seen_from_above(scene, 20).iter().zip(places(20)) {
        let expected = if place.x < 0.5 { Vec3::Z } else { Vec3::X };
        assert!((*pixel - expected).abs().max_element() < 1e-6, "{pixel} at {place}");
    }
}

#[test]
fn a_concave_face_keeps_the_colours_of_its_corners() {
    let arrow = "v 0 0 0 1 0 0\nv 1 0.5 0 1 0 0\nv 0 1 0 1 0 0\nv 0.4 0.5 0 1 0 0\nf 1 2 3 4\n";
    let scene = load("arrow.obj", arrow);
    assert_eq!(scene.mesh.faces().len(), 2);
    let pixels = seen_from_above(scene, 9);
    let colored = |pixel: &Vec3| (*pixel - Vec3::X).abs().max_element() < 1e-6;
    assert!(pixels.iter().all(|pixel| colored(pixel) || *pixel == Vec3::ZERO));
    assert!(pixels.iter().any(colored));
}

/// What is said of a file that is refused, without its folder.
fn refused(name: &str, contents: &str) -> String {
    let path = file(name, contents);
    let report = scene::load(&path, &ReadOptions::default()).expect_err(contents).to_string();
    report.replace(&path.display().to_string(), name)
}

#[test]
fn mistakes_in_them_are_told_with_their_place() {
    let red = ["red", "green", "blue"];
    let bytes = ply("uchar", red, 255.0);
    let wrong = refused("bad.ply", &bytes.replacen("0 0 0 255", "0 0 0 256", 1));
    assert_eq!(wrong, "bad.ply:14:7: `256` is no number of type uchar");
    let short = refused("bad.ply", &bytes.replacen(" 0 51 7", " 0", 1));
    assert_eq!(short, "bad.ply:14:12: line ends in the middle of `vertex` 1 of 4");
    let ron = |colors: &str| {
        let points = "points: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], faces: [[0, 1, 2]]";
        refused("bad.ron", &format!("(meshes: [(shape: Polygons({points},\n colors: [{colors}]))])"))
    };
    let message = "bad.ron:2:22: mesh has 3 points and 2 colours, it needs one for each point";
    assert_eq!(ron("(1, 0, 0), (0, 1, 0)"), message);
    assert_eq!(ron("(1, 0, 0), (0, 1, 0), (0, -1, 0)"), "bad.ron:2:33: -1 is negative");
    assert_eq!(ron("(1, 0, 0), (0, 1, 0), 7"), "bad.ron:2:33: expected opening `(`");
    // The same of materials, which each face may have.
    let faces = |rest: &str| {
        let points = "points: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], faces: [[0, 1, 2], [2, 1, 0]]";
        let materials = r#"materials: [(name: "red"), (name: "blue")]"#;
        refused("bad.ron", &format!("({materials}, meshes: [(shape: Polygons({points},\n {rest})])"))
    };
    let message = "bad.ron:2:14: mesh has 2 faces and 1 material, it needs one for each face";
    assert_eq!(faces(r#"materials: ["red"])"#), message);
    let message = "bad.ron:2:21: there is no material `bleu` (did you mean `blue`?)";
    assert_eq!(faces(r#"materials: ["red", "bleu"])"#), message);
    let message = "bad.ron:2:41: mesh has a material, and so has each of its faces";
    assert_eq!(faces(r#"materials: ["red", "blue"]), material: "red""#), message);
}

#[test]
fn cost_nothing_where_there_are_none() {
    assert_eq!(size_of::<Corner>(), 8);
    assert_eq!(size_of::<Face>(), 16);
    let plain = load("plain.obj", "v 0 0 0\nv 1 0 0 1\nv 0 1 0\nf 1 2 3\n");
    assert!(!plain.mesh.has_colors());
    assert!(!scene::builtin::generate("teapot", Some(2), None).unwrap().mesh.has_colors());
}
