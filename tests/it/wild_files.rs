//! Files as other programs write them: what is not geometry does not stop geometry, and nothing is passed over silently.

use std::convert::Infallible;
use std::path::Path;

use glam::Vec3;
use pcs_sim::geometry::{Polygons, Ray, brute_force};
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::ray_file;
use pcs_sim::host::sampling::Sampling;
use pcs_sim::host::shading::Limits;
use pcs_sim::program::Workload;
use pcs_sim::run::{self, Picture, Workers};
use pcs_sim::scene::mesh::NO_NORMAL;
use pcs_sim::scene::{self, Material, Mesh, ReadOptions, Scene};

use crate::support::command::Folder;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
const RED: &str = "newmtl red\nKd 1 0 0\n";
const BLUE: &str = "newmtl red\nKd 0 0 1\n";

fn load_in(folder: &Folder, name: &str) -> Scene {
    scene::load(&folder.path(name), &ReadOptions { resolution: 8 }).unwrap_or_else(|error| panic!("{error}"))
}

fn load(name: &str, contents: impl AsRef<[u8]>) -> Scene {
    let folder = Folder::new();
    folder.file(name, contents);
    load_in(&folder, name)
}

/// What is said of a file that is refused, without its folder.
fn refused(name: &str, contents: impl AsRef<[u8]>) -> String {
    let folder = Folder::new();
    let path = folder.file(name, contents);
    let error = scene::load(&path, &ReadOptions::default()).expect_err("it is no scene");
    error.to_string().replace(&path.display().to_string(), name)
}

fn polygons(mesh: &Mesh) -> Vec<Vec<Vec3>> {
    mesh.faces().iter().map(|face| mesh.face_points(face).collect()).collect()
}

/// A PLY file of four points and a square, with more properties for each point.
fn ply(properties: &str, points: [&str; 4], rest: &str) -> String {
    let places = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];
    let points: String = places.iter().zip(points).map(|(place, rest)| format!("{place} {rest}\n")).collect();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{properties}\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n{points}4 0 1 2 3\n{rest}"
    )
}

#[test]
fn any_encoding_is_taken() {
    let scene = load("square.obj", [b"# Gr\xF6\xDFe\no caf\xE9\n", SQUARE.as_bytes()].concat());
    assert_eq!((scene.mesh.faces().len(), scene.notes.len()), (1, 0));
    let comment = ply("", [""; 4], "").replace("element vertex", "comment by Andr\u{e9}\nelement vertex");
    let latin1: Vec<u8> = comment.chars().map(|c| c as u32 as u8).collect();
    assert_eq!(load("square.ply", latin1).mesh.faces().len(), 1);
    let utf16: Vec<u8> = "\u{feff}".encode_utf16().chain(SQUARE.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    assert_eq!(load("square.obj", utf16).mesh.faces().len(), 1);
    // Places count characters, and a name is shown as it was meant.
    assert_eq!(refused("bad.obj", b"# \xE9\nv 0 \xE9x 0\n"), "bad.obj:2:5: `\u{e9}x` is not a number");
}

#[test]
fn byte_order_marks_are_taken_everywhere() {
    assert_eq!(load("square.ply", format!("\u{feff}{}", ply("", [""; 4], ""))).mesh.faces().len(), 1);
    let wrong = ply("", [""; 4], "").replace("4 0 1", "4 0 9");
    let expected = "bad.ply:14:5: there is no point 9, the file has 4 points and counts from 0";
    assert_eq!(refused("bad.ply", format!("\u{feff}{wrong}")), expected);
}

/// The data of the tests with every line end replaced, read from a folder of their own.
fn with_line_ends(end: &str) -> Vec<Scene> {
    let folder = Folder::new();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let names = ["cube.mtl", "cube.obj", "cube.ply", "shapes.nff", "everything.ron", "glass.ron", "painted.ron"];
    for name in names {
        let text = std::fs::read_to_string(data.join(name)).unwrap();
        folder.file(name, text.replace("\r\n", "\n").replace('\n', end));
    }
    ["cube.obj", "cube.ply", "shapes.nff", "everything.ron"].iter().map(|name| load_in(&folder, name)).collect()
}

#[test]
fn lines_end_in_three_ways() {
    let expected = with_line_ends("\n");
    for end in ["\r\n", "\r"] {
        for (scene, expected) in with_line_ends(end).iter().zip(&expected) {
            assert_eq!(polygons(&scene.mesh), polygons(&expected.mesh), "{} {end:?}", scene.name);
            assert_eq!((&scene.materials, &scene.notes), (&expected.materials, &expected.notes));
        }
    }
    // In the middle of a file, too: a comment ends there.
    let mixed = SQUARE.replace("f 1", "# others\rf 1");
    assert_eq!(load("mixed.obj", mixed).mesh.faces().len(), 1);
    assert_eq!(
        refused("bad.obj", "v 0 0 0\rv 1 0 0\rf 1 2 3\r"),
        "bad.obj:3:7: there is no point 3, the file has 2 points"
    );
}

/// A triangle in binary, behind a header of given line ends.
fn binary(line_end: &str, behind: &[u8]) -> Vec<u8> {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                  property float z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n";
    // The first byte is a line feed: behind CR line ends it is data.
    let first = f32::from_bits(0x4180_000A);
    let numbers = [first, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let numbers: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    [header.replace('\n', line_end).as_bytes(), &numbers, &[3, 0, 1, 2], behind].concat()
}

#[test]
fn headers_of_binary_files_end_in_three_ways() {
    for end in ["\n", "\r\n", "\r"] {
        let scene = load("triangle.ply", binary(end, b""));
        assert_eq!(polygons(&scene.mesh)[0][0].x.to_bits(), 0x4180_000A, "{end:?}");
    }
}

#[test]
fn marks_of_the_end_are_passed_over() {
    assert_eq!(load("square.obj", format!("{SQUARE}\u{1a}")).mesh.faces().len(), 1);
    assert_eq!(load("square.obj", format!("{SQUARE}\u{1a}\r\n")).mesh.faces().len(), 1);
    assert_eq!(load("square.ply", ply("", [""; 4], "\u{1a}")).mesh.faces().len(), 1);
    for behind in ["\n", "\r\n", "\u{1a}"] {
        assert_eq!(load("triangle.ply", binary("\n", behind.as_bytes())).mesh.faces().len(), 1);
    }
    assert!(refused("bad.ply", binary("\n", b"\n\x07")).contains("file goes on after the last element"));
}

/// A square of the material `red`, which the files define that `mtllib` names.
fn painted(mtllib: &str, files: &[(&str, &str)]) -> Scene {
    let folder = Folder::new();
    for (name, contents) in files {
        folder.file(name, contents);
    }
    folder.file("painted.obj", format!("mtllib {mtllib}\nusemtl red\n{SQUARE}"));
    load_in(&folder, "painted.obj")
}

#[test]
fn numbers_of_materials_cost_only_the_statement() {
    let scene = painted("m.mtl", &[("m.mtl", "newmtl red\nKd 1 -0.0 0\nNs -1\nNi nan\nd 1.1\nKs 1 0\nTr\n")]);
    assert_eq!(scene.materials[1], Material { color: Vec3::X, ..Material::default() });
    let note =
        "m.mtl: 5 statements of materials were passed over, its numbers are missing or out of range: `Ns` in line 3";
    assert_eq!(scene.notes, [note.replace("its", "their")]);
    let nff = "f 1 0 0 0.5 -1 nan 0 0\nb 0 -1 0\np 3 0 0 0 1 0 0 0 1 0\n";
    let scene = load("m.nff", nff);
    assert_eq!(scene.materials[1], Material { color: Vec3::X, diffuse: 0.5, ..Material::default() });
    assert_eq!(scene.notes, ["3 colours or numbers of materials were passed over: out of range"]);
}

#[test]
fn of_two_definitions_the_first_listed_wins() {
    let scene = painted("a.mtl b.mtl", &[("a.mtl", RED), ("b.mtl", BLUE)]);
    assert_eq!(scene.materials[1].color, Vec3::X);
    let scene = painted("b.mtl a.mtl", &[("a.mtl", RED), ("b.mtl", BLUE)]);
    assert_eq!(scene.materials[1].color, Vec3::Z);
}

#[test]
fn material_files_are_found_by_the_names_that_programs_give() {
    for name in ["two words.mtl", "\"two words.mtl\"", "missing.mtl \"two words.mtl\"", ".\\two words.mtl"] {
        let scene = painted(name, &[("two words.mtl", RED)]);
        assert_eq!(scene.materials[1].color, Vec3::X, "{name}");
    }
}

#[test]
fn a_missing_material_file_is_noted_once() {
    let scene = painted("gone.mtl\nmtllib gone.mtl gone.mtl", &[]);
    assert_eq!(scene.notes, ["material file `gone.mtl` was not found, the default material takes its place"]);
}

#[test]
fn d_wins_over_tr() {
    for order in ["d 1\nTr 1\n", "Tr 1\nd 1\n"] {
        assert_eq!(painted("m.mtl", &[("m.mtl", &format!("{RED}{order}"))]).materials[1].transmittance, 0.0);
    }
    assert_eq!(painted("m.mtl", &[("m.mtl", &format!("{RED}Tr 0.25\n"))]).materials[1].transmittance, 0.25);
}

#[test]
fn normals_that_are_none_are_passed_over() {
    let normals = "vn 0 0 1\nvn nan nan nan\nvn -nan(ind) 1.#QNAN 0\nvn 0 1\n";
    let square = SQUARE.replace("f 1 2 3 4", "f 1//1 2//2 3//3 4//4");
    let scene = load("square.obj", format!("{normals}{square}"));
    assert_eq!(scene.notes, ["3 normals that are no directions were passed over"]);
    assert!(scene.mesh.normals.iter().all(|normal| normal.is_finite()));

    let missing = SQUARE.replace("f 1 2 3 4", "f 1//1 2//-1 3//7 4/9");
    let scene = load("square.obj", missing);
    assert_eq!(scene.notes, ["3 corners' normals that are not in the file were passed over"]);
    assert!(scene.mesh.corners(&scene.mesh.faces()[0]).iter().all(|corner| corner.normal == NO_NORMAL));

    let properties = "property float nx\nproperty float ny\nproperty float nz\n";
    let scene = load("square.ply", ply(properties, ["nan nan nan", "inf 0 0", "0 0 1", "0 0 1"], ""));
    assert_eq!(scene.notes, ["2 normals that are no directions were passed over"]);
    let scene = load("square.nff", "pp 3 0 0 0 0 0 nan 1 0 0 0 0 1 0 1 0 0 0 1\n");
    assert_eq!(scene.notes, ["1 normal that is no direction was passed over"]);
}

#[test]
fn points_that_no_face_uses_may_be_anything() {
    let note = "2 points that are nowhere and that no face uses were passed over";
    let scene = load("square.obj", format!("{SQUARE}v nan nan nan\nv 0 1e30 0\n"));
    assert_eq!((scene.mesh.faces().len(), scene.notes), (1, vec![note.to_owned()]));
    let more = ply("", [""; 4], "").replace("vertex 4", "vertex 6").replace("4 0 1", "nan nan nan\n0 0 inf\n4 0 1");
    assert_eq!(load("square.ply", &more).notes, [note]);
    assert_eq!(refused("bad.ply", more.replace("4 0 1 2 3", "4 0 1 2 5")), "bad.ply:15:5: inf is not a finite number");
    let bad = "v 0 0 0\nv 1 nan 0\nv 1 1 0\nf 1 2 3\n";
    assert_eq!(refused("bad.obj", bad), "bad.obj:2:5: NaN is not a finite number");
}

#[test]
fn faces_of_fewer_than_three_corners_are_counted() {
    let note = ["2 faces of fewer than 3 corners were passed over"];
    let scene = load("square.obj", format!("{}f 1 2 3\n", SQUARE.replace("f 1", "f 1\nf 1 2\nf 1")));
    assert_eq!(scene.notes, note);
    // The others keep their numbers.
    assert_eq!(scene.mesh.faces().iter().map(|face| face.number).collect::<Vec<_>>(), [2, 3]);
    let short = ply("", [""; 4], "0\n2 0 1\n").replace("face 1", "face 3");
    assert_eq!(load("square.ply", short).notes, note);
    assert_eq!(load("square.nff", "p 0\np 2 0 0 0 1 0 0\np 3 0 0 0 1 0 0 0 1 0\n").notes, note);
    let ron = "(meshes: [(shape: Polygons(points: [(0,0,0), (1,0,0), (0,1,0)], faces: [[0], [0,1,2], [0,1]]))])";
    let scene = load("square.ron", ron);
    assert_eq!(
        (scene.notes.as_slice(), scene.mesh.face_count(), scene.mesh.faces()[0].number),
        (&note.map(str::to_owned)[..], 3, 1)
    );
}

#[test]
fn a_file_of_lines_is_told_so() {
    let lines = SQUARE.replace("f 1 2 3 4", "l 1 2\nl 2 3\np 1");
    let note = "2 lines were passed over (`l`): only faces are traced; 1 list of points was passed over (`p`)";
    let expected = format!("lines.obj: empty scene: the file has no faces ({note}: only faces are traced)");
    assert_eq!(refused("lines.obj", lines), expected);
}

#[test]
fn a_name_that_takes_in_the_next_line_is_told() {
    let scene = load("name.obj", SQUARE.replace("f 1", "g a\\b\\\nf 1 2 3\nf 1"));
    assert_eq!(scene.mesh.faces().len(), 1);
    let note = "1 name took in the next line, as a backslash at the end of a line asks for: `f` in line 6";
    assert_eq!(scene.notes, [note]);
    // Names go on where they are meant to.
    assert!(load("name.obj", SQUARE.replace("f 1", "g a \\\n b\nf \\\n 1")).notes.is_empty());
}

/// The square with something behind each point.
fn colored(rest: &str) -> String {
    SQUARE.replace(" 0\nv", &format!(" 0 {rest}\nv")).replace(" 0\nf", &format!(" 0 {rest}\nf"))
}

#[test]
fn colours_of_points_in_many_ways() {
    let color = |scene: &Scene| scene.mesh.point_color(0);
    let scene = load("rgba.obj", colored("1 0 0 1"));
    assert_eq!(
        (color(&scene), scene.notes),
        (Some(Vec3::X), vec!["4 alphas of points' colours were passed over".to_owned()])
    );
    let scene = load("over.obj", colored("1.000001 0 -1e-7"));
    assert_eq!((color(&scene), scene.notes.len()), (Some(Vec3::X), 0));
    let guess = ["colours go up to 255: they are taken to count from 0 to 255"];
    let scene = load("bytes.obj", colored("255 0 0"));
    assert_eq!((color(&scene), scene.notes.as_slice()), (Some(Vec3::X), &guess.map(str::to_owned)[..]));
    for kind in ["float", "int"] {
        let properties = ["red", "green", "blue"].map(|name| format!("property {kind} {name}\n")).concat();
        let scene = load("bytes.ply", ply(&properties, ["255 0 0"; 4], ""));
        assert_eq!((color(&scene), scene.notes.as_slice()), (Some(Vec3::X), &guess.map(str::to_owned)[..]));
    }
    let scene = load("wrong.obj", colored("1 -0.5 0").replacen("-0.5", "0", 2));
    assert_eq!((color(&scene), scene.mesh.point_color(3)), (Some(Vec3::X), None));
    assert_eq!(scene.notes, ["2 colours of points are out of range and were passed over"]);
    for wrong in ["red 0 0", "nan 0 0", "300 0 0"] {
        let scene = load("none.obj", colored(wrong));
        assert_eq!((color(&scene), scene.mesh.has_colors(), scene.notes.len()), (None, false, 1), "{wrong}");
    }
    assert_eq!(load("odd.obj", colored("1 2")).notes.len(), 1);
}

#[test]
fn strips_of_triangles_are_read() {
    let strips = ply("", [""; 4], "").replace("element face 1", "element tristrips 1").replace("uchar int", "int int");
    let scene = load("strips.ply", strips.replace("4 0 1 2 3", "12 0 1 3 2 -1 0 0 1 2 -1 3 -1"));
    let corners: Vec<Vec<u32>> =
        scene.mesh.faces().iter().map(|face| scene.mesh.corners(face).iter().map(|c| c.point).collect()).collect();
    assert_eq!(corners, [vec![0, 1, 3], vec![3, 1, 2], vec![1, 0, 2]]);
    // All face the same way as the square.
    let up = |face: &Vec<Vec3>| (face[1] - face[0]).cross(face[2] - face[0]).z > 0.0;
    assert!(polygons(&scene.mesh)[..2].iter().all(up));
    // Beside faces, and beside what is not read.
    let both = ply("", [""; 4], "3 0 1 2\n0 1\n").replace(
        "end_header",
        "element tristrips 1\nproperty list int int vertex_indices\nelement edge 1\nproperty int a\nproperty int b\nend_header",
    );
    let scene = load("both.ply", both);
    assert_eq!(scene.mesh.faces().len(), 2);
    let note = "1 kind of element was passed over: points, faces and strips of triangles are read, not `edge`";
    assert_eq!(scene.notes, [note]);
}

/// A number from -1 to 1 that looks random.
fn noise(seed: u32) -> f32 {
    (seed.wrapping_mul(2_654_435_761) ^ seed.wrapping_mul(40_503).rotate_left(16)) as f32 / (1u64 << 31) as f32 - 1.0
}

/// A closed ball of quadrangles, and triangles at the poles, whose corners are each moved by up to `uneven` of the radius.
fn uneven_ball(uneven: f32) -> Mesh {
    let (slices, stacks) = (24, 12);
    let mut mesh = Mesh::default();
    mesh.points.extend([Vec3::Z, Vec3::NEG_Z]);
    for stack in 1..stacks {
        for slice in 0..slices {
            let polar = std::f32::consts::PI * stack as f32 / stacks as f32;
            let around = std::f32::consts::TAU * slice as f32 / slices as f32;
            let radius = 1.0 + uneven * noise(stack * 100 + slice);
            let direction = Vec3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos());
            mesh.add_point(radius * direction);
        }
    }
    let corner = |stack: u32, slice: u32| match stack {
        0 => 0,
        s if s == stacks => 1,
        s => 2 + (s - 1) * slices + slice % slices,
    };
    for (stack, slice) in (0..stacks).flat_map(|stack| (0..slices).map(move |slice| (stack, slice))) {
        let below = [corner(stack, slice), corner(stack + 1, slice)];
        let mut face = [below, [corner(stack + 1, slice + 1), corner(stack, slice + 1)]].concat();
        face.dedup();
        if face.first() == face.last() {
            face.pop();
        }
        mesh.add_face(&face, 0);
    }
    mesh
}

/// How many rays from within pass out of a mesh beside the edges of its faces: a little to both sides of each.
fn passing(mesh: &Mesh) -> usize {
    let origin = Vec3::new(0.25, -0.125, 0.375);
    let mut rays = Vec::new();
    for face in mesh.faces() {
        let points: Vec<Vec3> = mesh.face_points(face).collect();
        for (i, &a) in points.iter().enumerate() {
            let b = points[(i + 1) % points.len()];
            let aside = (b - a).cross(a).normalize();
            let on_edge = a.lerp(b, 0.5 + 0.4 * noise(rays.len() as u32));
            rays.extend([1e-5, -1e-5, 4e-5, -4e-5].map(|by: f32| Ray::new(origin, on_edge + aside * by - origin)));
        }
    }
    let polygons = Polygons::for_rays(mesh, &rays);
    rays.iter().filter(|ray| !brute_force(&polygons, ray).is_hit()).count()
}

#[test]
fn a_closed_mesh_of_uneven_faces_has_no_gaps() {
    let ball = uneven_ball(3e-4);
    assert!(passing(&ball) > 10, "faces that are taken for flat do not meet");
    let (cut, report) = scene::split_concave(ball);
    assert!(report.uneven.faces > 200, "{report:?}");
    assert_eq!(passing(&cut), 0);
    // The even ball stays as it is.
    assert_eq!(scene::split_concave(uneven_ball(0.0)).1, Default::default());
}

/// A picture of a scene, 48 pixels wide.
fn picture(scene: &Scene) -> Vec<Vec3> {
    let machine = crate::support::machine();
    let workload = Workload::new(&scene.mesh, &crate::support::program("pipeline", 1), machine.times, &[]).unwrap();
    let size = ImageSize { width: 48, height: 36 };
    let (sampling, limits) = (Sampling::default(), Limits::default());
    let picture =
        Picture { scene, workload: &workload, size, sampling, limits, screen: None, rules: Default::default() };
    run::render(&picture, None, &Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap().pixels
}

/// A table with a mirroring box just above it, both moved, and what else there is.
fn table(by: [f32; 3], more: &str) -> String {
    let [x, y, z] = by;
    let at = |a: f32, b: f32, c: f32| format!("({}, {}, {})", x + a, y + b, z + c);
    let moved = format!("transform: [Translate({x}, {y}, {z})]");
    let top = "points: [(-8,-8,0), (8,-8,0), (8,8,0), (-8,8,0)], faces: [[0,1,2,3]]";
    let corners = "(-1,-1,0.125), (1,-1,0.125), (1,1,0.125), (-1,1,0.125), (-1,-1,1), (1,-1,1), (1,1,1), (-1,1,1)";
    let sides = "[0,3,2,1], [4,5,6,7], [0,1,5,4], [1,2,6,5], [2,3,7,6], [3,0,4,7]";
    format!(
        "(camera: (from: {}, at: {}, up: (0, 0, 1), angle: 30), lights: [(at: {})],
          materials: [(name: \"box\", color: (0.9, 0.3, 0.2), specular: 0.3, shine: 20)],
          meshes: [(shape: Polygons({top}), {moved}),
                   (shape: Polygons(points: [{corners}], faces: [{sides}]), material: \"box\", {moved}), {more}])",
        at(5.0, -8.0, 4.0),
        at(0.0, 0.0, 0.5),
        at(4.0, -3.0, 8.0),
    )
}

#[test]
fn what_is_far_out_of_sight_changes_no_pixel() {
    let bird = "(shape: Polygons(points: [(1e6,1e6,1e6), (1000001,1e6,1e6), (1e6,1000001,1e6)], faces: [[0,1,2]]))";
    let alone = picture(&load("table.ron", table([0.0; 3], "")));
    let with_bird = picture(&load("table.ron", table([0.0; 3], bird)));
    assert_eq!(alone, with_bird);
}

#[test]
fn a_scene_moved_from_the_origin_looks_the_same_as_far_as_32_bits_reach() {
    let (here, there) = (load("table.ron", table([0.0; 3], "")), load("table.ron", table([1024.0, 512.0, 256.0], "")));
    assert!(there.notes.is_empty(), "{:?}", there.notes);
    let (here, there) = (picture(&here), picture(&there));
    let differ = here.iter().zip(&there).filter(|(a, b)| (**a - **b).abs().max_element() > 0.02).count();
    assert!(differ * 100 <= here.len(), "{differ} of {} pixels differ", here.len());
    let far = load("table.ron", table([1e6, 0.0, 0.0], ""));
    let note = "times as far from the origin as it is large: 32 bits place its hits only roughly, and images show it; \
                move it to the origin";
    assert!(far.notes.len() == 1 && far.notes[0].ends_with(note), "{:?}", far.notes);
}

#[test]
fn ray_files_in_many_ways() {
    let read = |contents: &[u8]| {
        let folder = Folder::new();
        ray_file::read(&folder.file("rays.csv", contents))
            .map_err(|error| error.to_string().replace(&folder.path("rays.csv").display().to_string(), "rays.csv"))
    };
    let plain = b"ox,oy,oz,dx,dy,dz\n1,2,3,0,0.1,1\n\n4,5,6,1,0,0\n";
    let expected = read(plain).unwrap();
    assert_eq!((expected.len(), expected[0].direction), (2, Vec3::new(0.0, 0.1, 1.0)));
    let plain = String::from_utf8_lossy(plain);
    for other in [
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        format!("\u{feff}{plain}\u{1a}"),
        plain.replace("ox", "\"ox\"").replace("1,2", "\"1\",2"),
        plain.replace(',', " , ").replace("\n\n", "\n  \n"),
    ] {
        assert_eq!(read(other.as_bytes()).unwrap(), expected, "{other:?}");
    }
    let wrong = |contents: &str| read(contents.as_bytes()).unwrap_err();
    let header = "ox,oy,oz,dx,dy,dz\r\r0,0,0,0,0,1\r\r";
    assert_eq!(wrong(&format!("{header}0, zero,0,0,0,1\r")), "rays.csv:5:4: `zero` is not a number");
    assert_eq!(wrong(&format!("{header}0,0,0,0,nan,1\r")), "rays.csv:5:9: NaN is not a finite number");
    assert_eq!(
        wrong(&format!("{header}0,0,0\r")),
        "rays.csv:5:1: expected 6 numbers, as the header has names, and found 3"
    );
    assert_eq!(wrong("a,b\n1,2\n"), "rays.csv:1:1: expected the header ox,oy,oz,dx,dy,dz or ox,oy,oz,dx,dy,dz,tmax");
}

/// Reading a ray file rounds its decimals once: what was written in 32 bits comes back to the bit.
#[test]
fn rays_are_rounded_once() {
    let folder = Folder::new();
    let written: Vec<f32> = (0..6000).map(|seed| f32::from_bits(0x3F00_0000 + seed * 1399)).collect();
    let lines = written.chunks(6).map(|ray| ray.iter().map(f32::to_string).collect::<Vec<_>>().join(",") + "\n");
    // Just above the middle of 1 and the next number: in 64 bits it is the middle itself.
    let middle = "1.00000005960464477540,0,0,0,0,1\n";
    let path = folder.file("rays.csv", format!("ox,oy,oz,dx,dy,dz\n{}{middle}", lines.collect::<String>()));
    let rays = ray_file::read(&path).unwrap();
    let read: Vec<f32> =
        rays.iter().flat_map(|ray| [ray.origin.to_array(), ray.direction.to_array()].concat()).collect();
    assert_eq!(read[..6000], written);
    assert_eq!(rays.last().unwrap().origin.x, 1.0f32.next_up());
}

#[test]
#[cfg(unix)]
fn a_file_without_an_end_is_told_so() {
    let folder = Folder::new();
    for name in ["endless.obj", "endless.ron", "endless.ply"] {
        std::os::unix::fs::symlink("/dev/zero", folder.path(name)).unwrap();
        let error = scene::load(&folder.path(name), &ReadOptions::default()).unwrap_err();
        assert!(error.message.starts_with("no end was found within 256 MiB"), "{error}");
    }
}
