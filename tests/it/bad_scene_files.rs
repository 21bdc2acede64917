//! What is said of files that are no scenes: message, line and column.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use pcs_sim::error::{InputError, Spot};
use pcs_sim::scene::{self, ReadOptions};

/// A folder of its own for a test.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bad_scene_files").join(test);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn refused(path: &Path) -> InputError {
    match scene::load(path, &ReadOptions::default()) {
        Err(error) => error,
        Ok(scene) => panic!("{} was taken: {:?}", path.display(), scene.notes),
    }
}

/// The error of a file with the given contents, as it is printed, without its folder.
fn report(test: &str, extension: &str, contents: &[u8]) -> String {
    let folder = folder(test);
    let path = folder.join("bad").with_extension(extension);
    fs::write(&path, contents).unwrap();
    let report = refused(&path).to_string();
    report.replace(&format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR), "")
}

/// Checks a table of contents and reports, and shows all that differ.
fn check(test: &str, extension: &str, table: &[(&str, &str)]) {
    compare(table.iter().map(|(contents, expected)| (report(test, extension, contents.as_bytes()), *expected)));
}

fn compare<'a>(reports: impl Iterator<Item = (String, &'a str)>) {
    let wrong: Vec<String> = reports
        .filter(|(report, expected)| report != expected)
        .map(|(report, expected)| format!("\n     got: {report}\nexpected: {expected}\n"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.concat());
}

#[test]
fn obj() {
    check(
        "obj",
        "obj",
        &[
            ("", "bad.obj: empty scene: the file has no faces"),
            ("v 0 0 0\n", "bad.obj: empty scene: the file has no faces"),
            ("v 0 0\n", "bad.obj:1:1: `v` needs 3 numbers and has 2"),
            ("# wide\r\nv 1 2 zwei\r\n", "bad.obj:2:7: `zwei` is not a number"),
            ("v 0 0 nan\nf 1 1 1\n", "bad.obj:1:7: NaN is not a finite number"),
            ("v 0 -inf 0\nf 1 1 1\n", "bad.obj:1:5: -inf is not a finite number"),
            ("v 0 0 1e400\nf 1 1 1\n", "bad.obj:1:7: inf is not a finite number"),
            (
                "v 0 0 \\\n  2e15\nf 1 1 1",
                "bad.obj:2:3: 2e15 is too large for the array's 32-bit arithmetic, which takes up to 1e15",
            ),
            ("f\n", "bad.obj: empty scene: the file has no faces (1 face of fewer than 3 corners was passed over)"),
            ("v 0 0 0\nf 1 1 2\n", "bad.obj:2:7: there is no point 2, the file has 1 point"),
            ("v 0 0 0\nf 1 1 -2\n", "bad.obj:2:7: there is no point -2, the file has 1 point up to here"),
            ("v 0 0 0\nf 1 1 0\n", "bad.obj:2:7: index is 0, indices count from 1"),
            ("v 0 0 0\nf 1 1 99999999999\n", "bad.obj:2:7: there is no point 99999999999, the file has 1 point"),
            (
                "v 0 0 0\nf 1 1 99999999999999999999999\n",
                "bad.obj:2:7: `99999999999999999999999` is not a corner of a face",
            ),
            ("v 0 0 0\nf 1 1 1/x/\n", "bad.obj:2:7: `1/x/` is not a corner of a face"),
            ("v 0 0 0\nf 1 1 1/1/1/1\n", "bad.obj:2:7: `1/1/1/1` has more than 3 indices"),
            ("v 0 0 0\nf 1 1 a\n", "bad.obj:2:7: `a` is not a corner of a face"),
            ("v 0 0 0\n  usemlt wood\n", "bad.obj:2:3: `usemlt` is no OBJ statement (did you mean `usemtl`?)"),
            ("ply\n", "bad.obj:1:1: `ply` is no OBJ statement"),
            ("o \u{e4}\u{f6}\u{fc}\nv 0 \u{e4} \u{e4}x0\n", "bad.obj:2:5: `ä` is not a number"),
        ],
    );
}

/// A PLY header with `vertex` and `face` of the given numbers.
fn ply(vertices: &str, faces: &str, body: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n{body}"
    )
}

#[test]
fn ply_header() {
    check(
        "ply_header",
        "ply",
        &[
            ("", "bad.ply: file is empty"),
            ("solid cube\n", "bad.ply:1:1: no PLY file: its first line must be `ply`"),
            ("ply\nformat ascii 1.0\n", "bad.ply:2:17: file ends in its header, before `end_header`"),
            ("ply\nend_header\n", "bad.ply:1:1: header has no `format` line"),
            ("ply\nformat ascii 1.0\nend_header\n", "bad.ply:3:11: header has no element `vertex`"),
            ("ply\nformat asci 1.0\nend_header\n", "bad.ply:2:8: unknown PLY encoding `asci` (did you mean `ascii`?)"),
            ("ply\nformat ascii 2.0\nend_header\n", "bad.ply:2:14: unknown PLY version `2.0`, expected 1.0"),
            ("ply\nformat ascii\nend_header\n", "bad.ply:2:1: `format` needs an encoding and a version"),
            ("ply\nproperty float x\nend_header\n", "bad.ply:2:1: property stands before any element"),
            (
                "ply\nelements vertex 3\nend_header\n",
                "bad.ply:2:1: unknown PLY header statement `elements` (did you mean `element`?)",
            ),
            ("ply\nelement vertex\nend_header\n", "bad.ply:2:1: `element` needs a name and a number"),
            ("ply\nelement vertex -3\nend_header\n", "bad.ply:2:16: number of elements is negative: -3"),
            ("ply\nelement vertex 3.5\nend_header\n", "bad.ply:2:16: `3.5` is not a whole number"),
            (
                "ply\nelement vertex 99999999999\nend_header\n",
                "bad.ply:2:16: 99999999999 elements are too many, there may be up to 4294967295",
            ),
            ("ply\nelement vertex 3\nelement vertex 3\nend_header\n", "bad.ply:3:9: there are two elements `vertex`"),
            (
                "ply\nelement vertex 3\nproperty flaot x\nend_header\n",
                "bad.ply:3:10: unknown PLY type `flaot` (did you mean `float`?)",
            ),
            (
                "ply\nelement vertex 3\nproperty half x\nend_header\n",
                "bad.ply:3:10: unknown PLY type `half` (known are char, int8, uchar, uint8, short, int16, ushort, uint16, int, int32, uint, uint32, float, float32, double, float64)",
            ),
            (
                "ply\nelement vertex 3\nproperty x\nend_header\n",
                "bad.ply:3:1: `property` needs a type and a name, or `list`, two types and a name",
            ),
            (
                "ply\nelement vertex 3\nproperty float x\nproperty int x\nend_header\n",
                "bad.ply:4:14: element `vertex` has two properties `x`",
            ),
            (
                "ply\nelement face 3\nproperty list float int vertex_indices\nend_header\n",
                "bad.ply:3:15: length of a list must be of an integer type",
            ),
            (
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nend_header\n",
                "bad.ply:3:9: element `vertex` has no property `z`",
            ),
            (
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty list int int x\nproperty float y\nproperty float z\nend_header\n",
                "bad.ply:4:23: property `x` of `vertex` must not be a list",
            ),
            (
                &ply("1", "1", "").replace("vertex_indices", "corners"),
                "bad.ply:7:9: element `face` has no list `vertex_indices`",
            ),
            (
                &ply("1", "1", "").replace("uchar int", "uchar float"),
                "bad.ply:8:27: property `vertex_indices` of `face` must be a list of integers",
            ),
        ],
    );
}

#[test]
fn ply_ascii() {
    check(
        "ply_ascii",
        "ply",
        &[
            (&ply("1", "0", "0 0 0\n"), "bad.ply: empty scene: the file has no faces"),
            (&ply("2", "0", "0 0 0\n"), "bad.ply:10:6: file ends before `vertex` 2 of 2"),
            (&ply("4000000000", "4000000000", "0 0 0\n"), "bad.ply:10:6: file ends before `vertex` 2 of 4000000000"),
            (&ply("2", "0", "0 0 0\n0 0\n"), "bad.ply:11:4: line ends in the middle of `vertex` 2 of 2"),
            (&ply("1", "0", "0 0 0 0\n"), "bad.ply:10:7: line goes on after the end of `vertex` 1 of 1"),
            (&ply("1", "1", "0 NaN 0\n3 0 0 0\n"), "bad.ply:10:3: NaN is not a finite number"),
            (
                &ply("1", "1", "0 1e16 0\n3 0 0 0\n"),
                "bad.ply:10:3: 1e16 is too large for the array's 32-bit arithmetic, which takes up to 1e15",
            ),
            (&ply("1", "0", "0 - 0\n"), "bad.ply:10:3: `-` is no number of type float"),
            (
                &ply("1", "1", "0 0 0\n3 0 0 1\n"),
                "bad.ply:11:7: there is no point 1, the file has 1 point and counts from 0",
            ),
            (
                &ply("1", "1", "0 0 0\n3 0 0 -1\n"),
                "bad.ply:11:7: there is no point -1, the file has 1 point and counts from 0",
            ),
            (&ply("1", "1", "0 0 0\n3 0 0 0.5\n"), "bad.ply:11:7: `0.5` is no number of type int"),
            (
                &ply("1", "1", "0 0 0\n2 0 0\n"),
                "bad.ply: empty scene: the file has no faces (1 face of fewer than 3 corners was passed over)",
            ),
            (&ply("1", "1", "0 0 0\n-3 0 0\n"), "bad.ply:11:1: `-3` is no number of type uchar"),
            (
                &ply("1", "1", "0 0 0\n-3 0 0\n").replace("uchar", "char"),
                "bad.ply:11:1: length of a list is negative: -3",
            ),
            (&ply("1", "1", "0 0 0\n3 0 0\n"), "bad.ply:11:6: line ends in the middle of `face` 1 of 1"),
            (
                &ply("1", "1", "0 0 0\n3 0 0 0\n3 0 0 0\n"),
                "bad.ply:12:1: file goes on after the last element that its header tells of",
            ),
        ],
    );
}

#[test]
fn ply_binary() {
    let header = ply("1", "1", "").replace("ascii", "binary_little_endian").replace("uchar", "char");
    let file = |numbers: &[f32], rest: &[u8]| {
        let numbers: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        [header.as_bytes(), &numbers, rest].concat()
    };
    let triangle = [3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    let table = [
        (file(&[], &[]), "bad.ply: byte 168: file ends in the middle of `vertex` 1 of 1"),
        (file(&[0.0, 0.0], &[0]), "bad.ply: byte 177: file ends in the middle of `vertex` 1 of 1"),
        (file(&[0.0, f32::NAN, 0.0], &triangle), "bad.ply: byte 172: NaN is not a finite number"),
        (
            file(&[0.0, 0.0, 3e15], &triangle),
            "bad.ply: byte 176: 3e15 is too large for the array's 32-bit arithmetic, which takes up to 1e15",
        ),
        (file(&[0.0; 3], &triangle[..12]), "bad.ply: byte 192: file ends in the middle of `face` 1 of 1"),
        (
            file(&[0.0; 3], &[&triangle[..], &[7]].concat()),
            "bad.ply: byte 193: file goes on after the last element that its header tells of",
        ),
        (file(&[0.0; 3], &[0x80]), "bad.ply: byte 180: length of a list is negative: -128"),
        (
            file(&[0.0; 3], &[3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0]),
            "bad.ply: byte 185: there is no point 16777216, the file has 1 point and counts from 0",
        ),
    ];
    let reports = table.iter().map(|(contents, expected)| (report("ply_binary", "ply", contents), *expected));
    compare(reports);
}

#[test]
fn nff() {
    check(
        "nff",
        "nff",
        &[
            ("", "bad.nff: empty scene: the file has no faces"),
            ("# nothing\nb 0 0 0", "bad.nff: empty scene: the file has no faces"),
            ("b 0 0", "bad.nff:1:6: file ends in the middle of `b`"),
            ("l 0 0 0 1", "bad.nff:1:10: file ends in the middle of `l`"),
            ("f 1 1 red", "bad.nff:1:7: `red` is not a number"),
            ("f 1 1 1 1 1 1 1 1 1", "bad.nff:1:19: `1` is no NFF entity (known are v, b, l, f, p, pp, s, c)"),
            ("v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\n", "bad.nff:1:1: view has no `angle`"),
            (
                "v\nfrom 0 0 1\nat 0 0 1\nup 0 1 0\nangle 40\n",
                "bad.nff:1:1: camera is in the very point that it looks at",
            ),
            (
                "v\nfrom 0 0 1\nat 0 0 0\nup 0 0 1\nangle 40\n",
                "bad.nff:1:1: camera's up direction is parallel to its line of sight",
            ),
            (
                "v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangle 180\n",
                "bad.nff:1:1: camera's angle must be above 0 and below 180 degrees",
            ),
            (
                "v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangel 40\n",
                "bad.nff:5:1: `angel` is no NFF entity (did you mean `angle`, a part of the view?)",
            ),
            (
                "p 2\n0 0 0\n1 0 0\n",
                "bad.nff: empty scene: the file has no faces (1 face of fewer than 3 corners was passed over)",
            ),
            ("p -3\n0 0 0\n", "bad.nff:1:3: `-3` is not a number of vertices"),
            ("p 4\n0 0 0\n1 0 0\n1 1 0\n", "bad.nff:4:6: file ends in the middle of `p`"),
            ("p 3\n0 0 0\n1 0 0\ns 0 0 0 1\n", "bad.nff:4:1: `s` is not a number"),
            ("p 18446744073709551615\n0 0 0\n", "bad.nff:2:6: file ends in the middle of `p`"),
            ("s 0 0 0 0\n", "bad.nff:1:1: sphere has a radius of 0"),
            (
                "s 0 0 0 1e300\n",
                "bad.nff:1:9: 1e300 is too large for the array's 32-bit arithmetic, which takes up to 1e15",
            ),
            ("c 0 0 0 1 0 0 0 1\n", "bad.nff:1:1: base and apex of the cone are the same point"),
            ("c 0 0 0 1 0 0 1 -1\n", "bad.nff:1:1: one radius of the cone is negative and the other is not"),
            ("c 0 0 0 0 0 0 1 0\n", "bad.nff:1:1: both radii of the cone are 0"),
            ("q 1 2 3\n", "bad.nff:1:1: `q` is no NFF entity (known are v, b, l, f, p, pp, s, c)"),
            (
                "nff\nversion 2.0\n",
                "bad.nff:1:1: `nff` is no NFF entity (this may be the format of WorldToolKit, which has the same name)",
            ),
        ],
    );
}

#[test]
fn ron() {
    fs::write(folder("ron").join("cube.stl"), "solid").unwrap();
    fs::write(folder("ron").join("wrong.obj"), "v 0 0 0\nf 1 1 2\n").unwrap();
    fs::write(folder("ron").join("far.obj"), "v 0 0 1e15\nf 1 1 1\n").unwrap();
    check(
        "ron",
        "ron",
        &[
            ("", "bad.ron:1:1: expected opening `(` for struct `Scene`"),
            ("(meshes: [])", "bad.ron: empty scene: the file has no faces"),
            ("()", "bad.ron:1:2: field `meshes` is missing"),
            ("(meshes: [],\n  lihgts: [])", "bad.ron:2:3: unknown field `lihgts` (did you mean `lights`?)"),
            (
                "(meshes: [],\n  surroundings: [])",
                "bad.ron:2:3: unknown field `surroundings` (known fields are camera, lights, background, materials, meshes)",
            ),
            ("(meshes: []\n  lights: [])", "bad.ron:2:3: expected comma"),
            ("(meshes: [],\n  meshes: [])", "bad.ron:2:3: field `meshes` is given twice"),
            ("(\n  meshes: [(shape: Fiel(\"a.obj\"))])", "bad.ron:2:20: unknown name `Fiel` (did you mean `File`?)"),
            (
                "(\n  meshes: [(shape: File(\"a.obj\"))])",
                "bad.ron:2:25: mesh file `a.obj` was not found beside the scene file",
            ),
            (
                "(\n  meshes: [(shape: File(\"cube.stl\"))])",
                "bad.ron:2:25: unknown kind of scene file `.stl` (a scene file ends in .ron, .obj, .ply, .nff or .cas)",
            ),
            (
                "(\n  meshes: [(shape: File(\"bad.ron\"))])",
                "bad.ron:2:25: a scene file cannot be the mesh of another one",
            ),
            (
                "(\n  meshes: [(shape: File(\"wrong.obj\"))])",
                "wrong.obj:2:7: there is no point 2, the file has 1 point",
            ),
            (
                "(\n  meshes: [(shape: File(\"far.obj\"),\n transform: [Scale(2, 2, 2)])])",
                "bad.ron:3:14: transformed coordinate 2e15 is too large for the array's 32-bit arithmetic, which takes up to 1e15",
            ),
            ("(meshes: [(shape: Builtin(name: \"nonsense\", size: -1))])", "bad.ron:1:52: integer is out of bounds"),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0)], faces: [\n[0, 0, 1]]))])",
                "bad.ron:2:1: there is no point 1, the mesh has 1 point and counts from 0",
            ),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0)], faces: [\n[0, 0, -1]]))])",
                "bad.ron:2:1: there is no point -1, the mesh has 1 point and counts from 0",
            ),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0)], faces: [\n[0, 0]]))])",
                "bad.ron: empty scene: the file has no faces (1 face of fewer than 3 corners was passed over)",
            ),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0)], faces: [\n[0, 0, x]]))])",
                "bad.ron:2:8: expected integer",
            ),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0),\n /* here */ (0, NaN, 0) ], faces: []))])",
                "bad.ron:2:13: NaN is not a finite number",
            ),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0),\n (0, inf, 0)], faces: []))])",
                "bad.ron:2:2: inf is not a finite number",
            ),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0),\n (0, 1e20, 0)], faces: []))])",
                "bad.ron:2:2: 1e20 is too large for the array's 32-bit arithmetic, which takes up to 1e15",
            ),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0),\n (0, 1)], faces: []))])",
                "bad.ron:2:7: expected a tuple of size 3 but found 2 elements instead",
            ),
            (
                "(meshes: [(shape: Polygons(points: [(0, 0, 0),\n (0, 1, \"2\")], faces: []))])",
                "bad.ron:2:9: expected float",
            ),
            (
                "(materials: [(name: \"red\")],\n meshes: [(shape: File(\"a.obj\"), material: \"rad\")])",
                "bad.ron:2:44: there is no material `rad` (did you mean `red`?)",
            ),
            (
                "(materials: [(name: \"red\"), (name: \"blue\")],\n meshes: [(shape: File(\"a.obj\"), material: \"wood\")])",
                "bad.ron:2:44: there is no material `wood` (known materials are blue, red)",
            ),
            (
                "(meshes: [(shape: File(\"a.obj\"), material: \"wood\")])",
                "bad.ron:1:44: there is no material `wood` (the file defines no materials)",
            ),
            (
                "(materials: [(name: \"red\"), (name: \"red\")], meshes: [])",
                "bad.ron:1:36: there are two materials `red`",
            ),
            ("(materials: [(name: \"red\", color: (1, 0, -1))], meshes: [])", "bad.ron:1:35: -1 is negative"),
            ("(materials: [(name: \"red\", diffuse: 2)], meshes: [])", "bad.ron:1:37: 2 is not from 0 to 1"),
            ("(materials: [(name: \"red\", diffuse: \"2\")], meshes: [])", "bad.ron:1:37: expected float"),
            ("(materials: [(name: \"red\", refraction: 0)], meshes: [])", "bad.ron:1:40: 0 is not above 0"),
            (
                "(camera: (from: (0, 0, 0), at: (1, 0, 0), up: (0, 0, 1), angle: 180), meshes: [])",
                "bad.ron:1:65: camera's angle must be above 0 and below 180 degrees",
            ),
            (
                "(camera: (from: (0, 0, 0), at: (1, 0, 0), up: (1, 0, 0), angle: 40), meshes: [])",
                "bad.ron:1:47: camera's up direction is parallel to its line of sight",
            ),
            (
                "(camera: (from: (0, 0, 0), at: (0, 0, 0), up: (1, 0, 0), angle: 40), meshes: [])",
                "bad.ron:1:32: camera is in the very point that it looks at",
            ),
            (
                "(camera: (from: (0, 0, 0), at: (1, 0, 0), angle: 40), meshes: [])",
                "bad.ron:1:52: field `up` is missing",
            ),
            (
                "(lights: [(at: (0, 0, 0), colour: (1, 1, 1))], meshes: [])",
                "bad.ron:1:27: unknown field `colour` (did you mean `color`?)",
            ),
            (
                "(meshes: [(shape: File(\"far.obj\"), transform: [Scale(1, 0, 1)])])",
                "bad.ron:1:48: scale factor is 0, nothing would be left to see",
            ),
            (
                "(meshes: [(shape: File(\"far.obj\"), transform: [Rotate(axis: (0, 0, 0), degrees: 1)])])",
                "bad.ron:1:48: axis of rotation is zero",
            ),
            (
                "(meshes: [(shape: File(\"far.obj\"), transform: [Rotate(axis: (0, 0, 1), degrees: NaN)])])",
                "bad.ron:1:48: NaN is not a finite number",
            ),
            (
                "(meshes: [(shape: File(\"far.obj\"), transform: [Move(1, 0, 1)])])",
                "bad.ron:1:48: unknown name `Move` (known names are Translate, Scale, Rotate)",
            ),
            (
                "(meshes: [(shape: File(\"far.obj\"), transform: [Rotate(axis: (0, 0, 1), angle: 1)])])",
                "bad.ron:1:72: unknown field `angle` (known fields are axis, degrees)",
            ),
            ("(meshes: [(shape: File(\"far.obj\"", "bad.ron:1:25: expected closing `)`"),
            ("(meshes: []) 7", "bad.ron:1:13: non-whitespace trailing characters"),
            (&"[".repeat(2000), "bad.ron:1:1: expected opening `(` for struct `Scene`"),
            (&format!("(lights: [(at: {}", "(".repeat(2000)), "bad.ron:1:77: values are nested too deeply"),
        ],
    );
}

#[test]
#[cfg(unix)]
fn files_as_such() {
    let folder = folder("files_as_such");
    let said = |name: &str| refused(&folder.join(name)).to_string().replace(&folder.display().to_string(), "");
    assert_eq!(said("missing.obj"), "/missing.obj: cannot read the file: No such file or directory");
    let known = "a scene file ends in .ron, .obj, .ply, .nff or .cas";
    assert_eq!(
        said("scene.obi"),
        format!("/scene.obi: unknown kind of scene file `.obi` (did you mean .obj? {known})")
    );
    assert_eq!(said("scene.blend"), format!("/scene.blend: unknown kind of scene file `.blend` ({known})"));
    assert_eq!(said("scene"), format!("/scene: file name has no extension to tell its format by ({known})"));
    fs::create_dir_all(folder.join("folder.nff")).unwrap();
    assert_eq!(said("folder.nff"), "/folder.nff: cannot read the file: Is a directory");
    // A hole of 4 GiB and a byte, which takes no room on the disk.
    let large = folder.join("large.ply");
    File::create(&large).unwrap().set_len((1 << 32) + 1).unwrap();
    assert_eq!(said("large.ply"), "/large.ply: file is too large, it may have up to 4 GiB");
    fs::remove_file(large).unwrap();
}

#[test]
fn unknown_builtin_scenes_are_pointed_at() {
    let path = folder("builtin").join("bad.ron");
    fs::write(&path, "(meshes: [\n  (shape: Builtin(name: \"nonsense\"))])").unwrap();
    let place = refused(&path).place.unwrap();
    let source = "  (shape: Builtin(name: \"nonsense\"))])".to_owned();
    assert_eq!(place.spot, Some(Spot::Text { line: 2, column: 25, width: 10, source }));
}

#[test]
fn places_have_the_width_of_what_is_wrong() {
    let path = folder("width").join("bad.obj");
    fs::write(&path, "v 0 0 0\r\n# \u{e4}\r\n  f 1 1 \u{e4}\u{f6} # x\r\n").unwrap();
    let place = refused(&path).place.unwrap();
    assert_eq!(place.file, path);
    let source = "  f 1 1 \u{e4}\u{f6} # x".to_owned();
    assert_eq!(place.spot, Some(Spot::Text { line: 3, column: 9, width: 2, source }));
}

#[test]
fn resolutions_out_of_range() {
    let file = folder("resolution").join("any.obj");
    let error = |resolution| scene::load(&file, &ReadOptions { resolution }).unwrap_err().to_string();
    assert_eq!(error(2), "resolution is 2, it must be from 3 to 256");
    assert_eq!(error(257), "resolution is 257, it must be from 3 to 256");
}
