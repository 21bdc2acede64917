//! Files that are packed, and what comes by standard input and goes to standard output whatever its format.

use std::fs::File;
use std::io::Read;
use std::process::{Command, Stdio};

use crate::support::command::Folder;

const RUN: &str = "--mode broadcast --cells 4 --scene room --size 12x10";

/// What the command prints, given a file of the folder on standard input.
fn given(folder: &Folder, file: &str, args: &str) -> Vec<u8> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pcs-sim"));
    command.args(args.split(' ')).current_dir(folder.path("")).stdin(File::open(folder.path(file)).unwrap());
    let output = command.stderr(Stdio::piped()).output().unwrap();
    assert!(output.status.success(), "{args}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

#[test]
fn traces_are_packed_and_unpacked() {
    let folder = Folder::new();
    for name in ["a.ops", "a.ops.gz", "a.ops.zst"] {
        folder.run(&format!("{RUN} --ops {name}")).success();
    }
    folder.run(&format!("{RUN} --threads 1 --ops one.ops.zst")).success();
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert_eq!(bytes("a.ops.zst"), bytes("one.ops.zst"));
    let mut unpacked = Vec::new();
    flate2::read::GzDecoder::new(bytes("a.ops.gz").as_slice()).read_to_end(&mut unpacked).unwrap();
    assert!(unpacked == bytes("a.ops"));
    assert!(zstd::decode_all(bytes("a.ops.zst").as_slice()).unwrap() == bytes("a.ops"));
    assert!(["a.ops.gz", "a.ops.zst"].iter().all(|name| 3 * bytes(name).len() < bytes("a.ops").len()));
    // What one frame or member ends with, the next may go on from.
    let two: Vec<u8> = [&b"# a comment\n"[..]].iter().flat_map(|part| zstd::encode_all(*part, 0).unwrap()).collect();
    folder.file("two.ops", [two, bytes("a.ops.zst")].concat());
    let figures = |name: &str| {
        let json = folder.run(&format!("replay {name} --fifo-words 16 --json")).success();
        json.replace(name, "a.ops")
    };
    for name in ["a.ops.gz", "a.ops.zst", "two.ops"] {
        assert_eq!(figures(name), figures("a.ops"), "{name}");
    }
    let streamed = given(&folder, "a.ops.zst", "replay - --fifo-words 16 --json");
    assert_eq!(String::from_utf8(streamed).unwrap().replace("\"-\"", "\"a.ops\""), figures("a.ops"));
}

#[test]
fn packed_files_that_are_cut_are_refused() {
    let folder = Folder::new();
    for name in ["a.ops.gz", "a.ops.zst"] {
        folder.run(&format!("{RUN} --ops {name}")).success();
        let bytes = std::fs::read(folder.path(name)).unwrap();
        folder.file("cut.ops", &bytes[..bytes.len() / 2]);
        assert!(folder.run("replay cut.ops").refused().contains("cut.ops"));
        folder.file("cut.ops", &bytes[..5]);
        assert!(folder.run("replay cut.ops").refused().contains("cut.ops"));
    }
}

#[test]
fn statistics_and_scenes_are_unpacked_too() {
    let folder = Folder::new();
    folder.run(&format!("{RUN} --stats a.json")).success();
    folder.run(&format!("{RUN} --stats a.json.gz")).success();
    folder.run("compare a.json a.json.gz").success();
    let again = folder.run("--config a.json.gz --json").success();
    assert_eq!(again, folder.read("a.json"));
}

/// A name that is a dash and an ending stands for a stream of that format.
#[test]
fn formats_that_endings_tell_come_and_go_by_streams() {
    let folder = Folder::new();
    folder.file("scene.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.run("--scene scene.obj --size 8x8 --image a.png --hits a.csv --trace a.vcd").success();
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(given(&folder, "scene.obj", "--scene -.obj --size 8x8 --image -.png") == bytes("a.png"));
    assert!(given(&folder, "scene.obj", "--scene -.obj --size 8x8 --hits -") == bytes("a.csv"));
    let dump = given(&folder, "scene.obj", "--scene -.obj --size 8x8 --trace -.vcd");
    let from = |dump: &[u8]| {
        let text = String::from_utf8(dump.to_vec()).unwrap();
        text[text.find("$enddefinitions").unwrap()..].to_owned()
    };
    assert_eq!(from(&dump), from(&bytes("a.vcd")));
    assert_eq!(folder.names(), ["a.csv", "a.png", "a.vcd", "a.vcd.gtkw", "scene.obj"]);
    folder.run("image room --size 8x8 -o a.pfm").success();
    let image = given(&folder, "scene.obj", "image room --size 8x8 -o -.pfm");
    assert!(image == bytes("a.pfm"));
}

/// Scenes and rays may be packed as results are; what others packed is named, with what unpacks it.
#[test]
fn scenes_and_rays_are_unpacked() {
    let folder = Folder::new();
    let (scene, rays) = ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "ox,oy,oz,dx,dy,dz\n0.2,0.2,1,0,0,-1\n");
    let gzip = |text: &str| {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        std::io::Write::write_all(&mut packed, text.as_bytes()).unwrap();
        packed.finish().unwrap()
    };
    folder.file("square.obj", scene);
    folder.file("square.obj.gz", gzip(scene));
    folder.file("square.obj.zst", zstd::encode_all(scene.as_bytes(), 0).unwrap());
    folder.file("rays.csv", rays);
    folder.file("rays.csv.gz", gzip(rays));
    let run = |scene: &str, rays: &str| folder.run(&format!("--scene {scene} --rays {rays}")).success();
    let plain = run("square.obj", "rays.csv");
    assert!(plain.contains("scene square (1 polygon), 1 ray\n"), "{plain}");
    assert_eq!(run("square.obj.gz", "rays.csv.gz"), plain);
    assert_eq!(run("square.obj.zst", "rays.csv"), plain);
    let error = folder.run("--scene square.obj.gz --resolution 4 --size 4x4").refused();
    assert!(error.contains("this scene is of polygons only"), "{error}");
    for (ending, start, by) in [
        ("xz", &b"\xfd7zXZ\0"[..], "xz -d"),
        ("bz2", b"BZh91AY&SY", "bzip2 -d"),
        ("zip", b"PK\x03\x04", "unzip"),
        ("7z", b"7z\xbc\xaf\x27\x1c", "7z x"),
    ] {
        for name in ["square.obj", "rays.csv", "run.ops", "run.json"] {
            folder.file(&format!("{name}.{ending}"), start);
            folder.file(&format!("renamed-{name}"), start);
        }
        for command in [
            format!("--scene square.obj.{ending}"),
            "--scene renamed-square.obj".to_owned(),
            format!("--scene square.obj --rays rays.csv.{ending}"),
            format!("replay run.ops.{ending}"),
            "replay renamed-run.ops".to_owned(),
            format!("--config run.json.{ending}"),
        ] {
            let error = folder.run(&command).refused();
            assert!(error.contains(&format!("`{by}`")) && error.contains(&format!(".{ending}")), "{command}: {error}");
        }
    }
}

/// Streams stand wherever files do: without a flag, too, and each only once.
#[test]
fn streams_stand_for_files_without_a_flag() {
    let folder = Folder::new();
    folder.file("scene.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.file("t.csv", "x,y\n1,2\n2,3\n");
    folder.run("image scene.obj --size 8x8 -o a.png --ops a.ops --stats a.json").success();
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(given(&folder, "scene.obj", "image -.obj --size 8x8 -o -.png") == bytes("a.png"));
    assert!(given(&folder, "scene.obj", "scenes -.obj").starts_with(b"scene -: 1 polygon over 3 points"));
    given(&folder, "a.ops", "replay -.ops --quiet");
    given(&folder, "a.json", "compare --all -.json a.json");
    folder.run("plot t.csv x=x y=y -o p").success();
    for format in ["svg", "png"] {
        let picture = given(&folder, "t.csv", &format!("plot -.csv x=x y=y -o -.{format} --title t"));
        folder.run(&format!("plot t.csv x=x y=y -o {format} --title t")).success();
        assert!(picture == bytes(&format!("{format}.{format}")), "{format}");
    }
    for (command, complaint) in [
        ("plot t.csv x=x y=y -o -.gif", "is no name of a picture"),
        ("--scene room --size 4x4 --image -.gif", "the picture is written as PNG"),
        ("--scene room --size 4x4 --stats - --hits -.csv", "standard output is named for two results"),
        ("--scene room --size 4x4 --stats - --hits -", "standard output is named for two results"),
        ("--scene room --size 4x4 --plot -", "standard output is no folder"),
        ("--scene - --size 4x4", "name it with an ending: -.obj"),
        ("scenes -", "name it with an ending: -.obj"),
        ("image room -o -", "-.png and -.pfm are standard output"),
        ("scenes room --export -", "-.ply is standard output"),
        ("--scene room --size 4x4 --trace -", "-.vcd is standard output"),
        ("image room -.png", "unexpected argument"),
        ("image -.obj --colours 5 -o a.png", "unexpected argument '--colours'"),
    ] {
        let error = folder.run(command).refused();
        assert!(error.contains(complaint), "{command}: {error}");
    }
    let error = folder.run("man -").failed();
    assert!(error.contains("standard output is no folder"), "{error}");
    assert!(!folder.path("-").exists());
}
