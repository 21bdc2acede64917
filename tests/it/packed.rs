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
