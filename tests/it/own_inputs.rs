//! No result replaces a file that the command reads, be it one that another file names, whatever the command.

use crate::support::command::Folder;

/// A scene file that takes an OBJ, whose materials stand in a third file; a sweep of it; a machine; a program of parts.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("all.ron", "(meshes: [(shape: File(\"part.obj\"))])");
    folder.file("part.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    folder.file("m.mtl", "newmtl red\nKd 1 0 0\n");
    folder.file("sweep.ron", "(scene: \"all.ron\", size: \"2x2\")");
    folder.file("rays.csv", "ox,oy,oz,dx,dy,dz\n0.2,0.2,1,0,0,-1\n");
    folder.file("m.ron", std::fs::read_to_string("pcs-programs/pcs.ron").unwrap());
    folder.file("main.pcs", ".include \"part.pcs\"\n");
    folder.file("part.pcs", "done\n");
    folder
}

#[test]
fn no_command_writes_over_what_it_reads() {
    let folder = folder();
    let before: Vec<String> = folder.names();
    let texts = || -> Vec<String> { before.iter().map(|name| folder.read(name)).collect() };
    let all = texts();
    for command in [
        "--scene all.ron --size 2x2 --stats all.ron",
        "--scene all.ron --size 2x2 --hits part.obj",
        "--scene all.ron --size 2x2 --ops ./m.mtl",
        "--scene all.ron --rays rays.csv --hits rays.csv",
        "model all.ron --size 2x2 --stats m.mtl",
        "calibrate --machine m.ron -o m.ron",
        "asm main.pcs -o main.pcs",
        "asm main.pcs -o part.pcs",
    ] {
        let error = folder.run(&format!("{command} --force")).refused();
        assert!(error.contains("the file is an input of this run"), "{command}: {error}");
        assert_eq!(folder.names(), before, "{command}");
    }
    assert!(texts() == all);
    // Images and tables have endings of their own: so links lead to inputs.
    for (link, target) in [("i.png", "m.mtl"), ("t.csv", "part.obj"), ("u.parquet", "sweep.ron")] {
        std::os::unix::fs::symlink(folder.path(target), folder.path(link)).unwrap();
    }
    for command in ["image all.ron --size 2x2 -o i.png", "sweep sweep.ron -o t.csv", "sweep sweep.ron -o u.csv"] {
        let error = folder.run(&format!("{command} --force")).refused();
        assert!(error.contains("the file is an input of this run"), "{command}: {error}");
    }
    assert!(texts() == all);
}

#[test]
fn outputs_that_cannot_be_say_why() {
    let folder = Folder::new();
    let link = |name: &str, target: &str| std::os::unix::fs::symlink(target, folder.path(name)).unwrap();
    link("nowhere.json", "not/there.json");
    link("circle.json", "circle2.json");
    link("circle2.json", "circle.json");
    folder.file("file", "");
    for (name, command) in [
        ("link to nowhere", "--stats nowhere.json"),
        ("link in a circle", "--stats circle.json --force"),
        ("folder that is a file", "--plot file"),
        ("folder in a file", "--plot file/plots"),
        ("folder that is a link to nowhere", "--plot nowhere.json"),
    ] {
        let error = folder.run(&format!("--scene tetra --size 2x2 {command}")).refused();
        insta::assert_snapshot!(format!("outputs {name}"), error);
    }
    assert_eq!(folder.names(), ["circle.json", "circle2.json", "file", "nowhere.json"]);
}

#[test]
fn files_without_an_end_are_refused() {
    let folder = Folder::new();
    for name in ["scene.obj", "scene.ply", "scene.nff", "scene.ron"] {
        std::os::unix::fs::symlink("/dev/zero", folder.path(name)).unwrap();
        let error = folder.run(&format!("--scene {name} --size 2x2")).refused();
        assert!(error.contains("no end was found within 256 MiB"), "{name}: {error}");
    }
    folder.file("p.pcs", "done\n");
    for command in ["calibrate --machine /dev/zero", "--rays /dev/zero --scene room", "step p.pcs --script /dev/zero"] {
        let error = folder.run(command).refused();
        assert!(error.contains("no end was found within 256 MiB"), "{command}: {error}");
    }
}
