//! The main job as a user types it: what it prints, what it writes, and that threads change nothing.

use pcs_sim::run::moot;

use crate::support::command::Folder;
use crate::support::pictures::decoded;

#[test]
fn the_summary_tells_what_ran_and_what_limits_it() {
    let folder = Folder::new();
    let summary = folder.run("--mode pipeline --scene room --size 8x6").success();
    insta::assert_snapshot!(summary);
    let summary = folder.run("--mode broadcast --cells 3 --scene room --size 8x6 --link-mb-s 20").success();
    insta::assert_snapshot!(summary);
}

#[test]
fn scenes_are_listed() {
    insta::assert_snapshot!(Folder::new().run("scenes").success());
}

#[test]
fn results_are_files_and_the_last_lines_name_them() {
    let folder = Folder::new();
    let all = "--scene room --size 8x6 --stats s.json --hits h.csv --ops a.ops --image i.png";
    let stdout = folder.run(all).success();
    assert!(stdout.ends_with("wrote s.json\nwrote h.csv\nwrote a.ops\nwrote i.png\n"), "{stdout}");
    assert_eq!(folder.names(), ["a.ops", "h.csv", "i.png", "s.json"]);
    insta::assert_snapshot!("stats", folder.read("s.json"));
    let hits = folder.read("h.csv");
    assert_eq!(hits.lines().count(), 49);
    insta::assert_snapshot!("first hits", hits.lines().take(5).collect::<Vec<_>>().join("\n"));
    insta::assert_snapshot!("first ops", folder.read("a.ops").lines().take(18).collect::<Vec<_>>().join("\n"));
    let info = decoded(&folder.path("i.png")).info;
    assert_eq!((info.width, info.height), (8, 6));
}

#[test]
fn every_mode_gives_the_same_hits_file() {
    let folder = Folder::new();
    let common = "--scene teapot --size-factor 4 --size 16x12 --force --hits";
    folder.run(&format!("--mode pipeline {common} pipeline.csv")).success();
    for other in
        ["--mode broadcast --cells 5", "--mode hybrid --groups 3 --partition work", "--program hybrid-3 --mailbox"]
    {
        folder.run(&format!("{other} {common} other.csv")).success();
        assert_eq!(folder.read("other.csv"), folder.read("pipeline.csv"), "{other}");
    }
}

#[test]
fn threads_change_no_byte() {
    let folder = Folder::new();
    for threads in [1, 2, 5] {
        let files =
            format!("--stats s{threads}.json --hits h{threads}.csv --ops a{threads}.ops --image i{threads}.png");
        let run = "--mode broadcast --cells 4 --partition work --scene teapot --size-factor 3 --size 70x50";
        folder.run(&format!("{run} --threads {threads} {files}")).success();
    }
    for (file, end) in [("s", "json"), ("h", "csv"), ("a", "ops"), ("i", "png")] {
        let bytes = |threads: u32| std::fs::read(folder.path(&format!("{file}{threads}.{end}"))).unwrap();
        assert!(bytes(1) == bytes(2) && bytes(1) == bytes(5), "{file} differs");
    }
}

#[test]
fn rays_from_a_file_take_the_place_of_the_camera() {
    let folder = Folder::new();
    folder.file("rays.csv", "ox,oy,oz,dx,dy,dz,tmax\n0.5,0.25,-1,0,0,2,inf\n0.5,0.25,-1,0,0,2,0.25\n7,7,7,1,0,0,9\n");
    folder.file("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    folder.run("--scene square.obj --rays rays.csv --hits h.csv").success();
    assert_eq!(folder.read("h.csv"), "ray,t,polygon,alpha,beta\n0,0.5,0,0.25,0.25\n1,,,,\n2,,,,\n");
}

/// The statistics alone go to standard output, and are those of the file.
#[test]
fn statistics_go_to_stdout() {
    let folder = Folder::new();
    for run in [
        "--scene room --size 8x6",
        "image room --size 8x6 -o i.png",
        "farm rectangles --size 20x10 --tasks 2",
        "model room --size 8x8",
        "why --scene room --size 8x6",
    ] {
        folder.run(&format!("{run} --stats s.json --force")).success();
        let stats = folder.read("s.json");
        assert_eq!(folder.run(&format!("{run} --json --force")).success(), stats, "{run}");
        assert_eq!(folder.run(&format!("{run} --stats - --force")).success(), stats, "{run}");
    }
    let error = folder.run("--scene room --size 8x6 --stats - --hits -").refused();
    assert!(error.contains("named for two results"), "{error}");
}

/// A pipe gives a recording, which is read more than once, and other inputs.
#[cfg(unix)]
#[test]
fn inputs_come_from_stdin() {
    let folder = Folder::new();
    folder.run("--scene room --size 8x6 --ops a.ops --stats run.json").success();
    let piped = |args: &str, input: &str| {
        let command = format!("{} {args} < {input}", env!("CARGO_BIN_EXE_pcs-sim"));
        let output = std::process::Command::new("sh").args(["-c", &command]).current_dir(folder.path(".")).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{args}: {output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let from_file = folder.run("replay a.ops").success();
    assert_eq!(piped("replay -", "a.ops"), from_file.replace("replay of a.ops", "replay of -"));
    assert_eq!(piped("--config - --json", "run.json"), folder.read("run.json"));
}

#[test]
fn the_quiet_say_nothing() {
    let folder = Folder::new();
    for run in ["--quiet --scene room --size 8x6 --link-mb-s 30 --stats s.json", "image room --size 8x6 -o i.png -q"] {
        let finished = folder.run(run);
        assert_eq!((finished.status, finished.stdout.as_str(), finished.stderr.as_str()), (0, "", ""), "{run}");
    }
    assert_eq!(folder.names(), ["i.png", "s.json"]);
    assert!(folder.run("--quiet --scene atlantis").refused().contains("atlantis"));
}

/// What people read fits a terminal of 80 columns: tables and sentences.
#[test]
fn results_fit_80_columns() {
    let folder = Folder::new();
    folder.run("--scene room --size 8x6 --ops a.ops --stats a.json").success();
    folder.file("steps", "break 18\nlist\nbreak\nquit\n");
    let programs = std::fs::canonicalize("pcs-programs/cells").unwrap();
    std::os::unix::fs::symlink(&programs, folder.path("cells")).unwrap();
    let names = std::fs::read_dir(&programs).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let listings: Vec<String> =
        names.filter(|name| name.ends_with(".pcs")).map(|name| format!("asm cells/{name} --listing")).collect();
    assert!(listings.len() > 5);
    for run in [
        "--scene room --size 8x6 --why",
        "--scene room --size 4x4 --cells-run programs",
        "--scene teapot --size 48x48 --mode hybrid --cells 12 --fifo-words 4 --link-mb-s 10",
        "image room --size 8x6 -o i.png --why",
        "farm rectangles --size 40x30 --tasks 3",
        "farm rectangles --size 40x30 --tasks 1..3",
        "farm rectangles --size 40x30 --tasks 3 --why",
        "ipsc2 room --size 16x16 --nodes 4 --mode shared-memory",
        "replay a.ops --fifo-words 8",
        "size-fifos --ops a.ops",
        "why a.ops --cell 1 --at 20000",
        "why a.ops --by-cell",
        "model room --size 8x6",
        "compare a.json a.json --all",
        "scenes",
        "figure7",
        "image room --size 8x6 -o c.png --colors 24 --palette peano-large",
        "step cells/fir.pcs --script steps",
    ]
    .into_iter()
    .map(str::to_owned)
    .chain(listings)
    {
        let text = folder.run(&run).success();
        let widest = text.lines().max_by_key(|row| row.chars().count()).unwrap();
        assert!(widest.chars().count() <= 80, "{run}: {widest}");
    }
}

/// The help tells every default of the machine.
#[test]
fn help_tells_defaults() {
    let help = Folder::new().run("--help").success();
    let flat = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flat.contains("[default: the machine file's; 512 in the standard one]"), "{help}");
    assert!(flat.contains("Figure 7: the grid's work, in µs a voxel [default: the machine file's; 7.8"), "{help}");
}

/// What a command refuses in any case, its help leaves out; a command that takes it tells of it.
#[test]
fn help_leaves_out_what_is_always_refused() {
    let folder = Folder::new();
    folder.run("--scene room --size 8x6 --ops a.ops").success();
    for (command, refused) in moot::ALWAYS_REFUSED {
        let (name, input) = match command {
            "run" => ("", "--scene room"),
            "replay" => (command, "a.ops"),
            "size-fifos" => (command, "--scene room"),
            "calibrate-ipsc2" => (command, "room --seconds 100"),
            _ => (command, "room"),
        };
        let help = folder.run(&format!("{name} --help")).success();
        for flag in refused.iter().map(|parameter| format!("--{}", parameter.replace('_', "-"))) {
            let takes_value =
                !["--adaptive", "--mailbox", "--why", "--enough", "--bounded-walk", "--early-slabs", "--stepped-walk"]
                    .contains(&flag.as_str());
            let value = if takes_value { "2" } else { "" };
            let error = folder.run(&format!("{name} {input} {flag} {value}")).refused();
            let about = flag.trim_start_matches("--").split('-').next().unwrap();
            assert!(error.contains(about), "{name} {flag}: {error}");
            assert!(!help.contains(&format!(" {flag} ")) && !help.contains(&format!(" {flag}\n")), "{name} {flag}");
        }
    }
    assert!(folder.run("image --help").success().contains("--host-hit-us"));
}

/// Each heading stands once, and what is about no part of a run stands under the first.
#[test]
fn flags_stand_under_their_headings() {
    let folder = Folder::new();
    for command in ["", "image", "farm", "replay", "size-fifos", "why", "sweep", "model", "plot", "compare", "asm"] {
        let help = folder.run(&format!("{command} --help")).success();
        let is_heading = |line: &&str| line.ends_with(':') && line.starts_with(|c: char| c.is_alphabetic());
        let mut headings: Vec<&str> = help.lines().filter(is_heading).collect();
        let all = headings.len();
        headings.sort_unstable();
        headings.dedup();
        assert_eq!(headings.len(), all, "{command}: {help}");
        let under = |flag: &str| {
            let before: Vec<&str> = help.lines().take_while(|line| !line.contains(flag)).collect();
            before.into_iter().rev().find(is_heading)
        };
        assert_eq!(under("-q, --quiet"), Some("Options:"), "{command}");
        for flag in ["      --threads", "      --config"].into_iter().filter(|flag| help.contains(flag)) {
            assert_eq!(under(flag), Some("Options:"), "{command}");
        }
    }
}

#[test]
fn shells_and_the_manual_know_the_flags() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.run(&format!("completions {shell}")).success();
        assert!(script.contains("fifo-words") && script.contains("sweep"), "{shell}: {script}");
    }
    let told = folder.run("man pages").success();
    assert!(told.starts_with("wrote pages/pcs-sim.1\n") && told.contains("wrote pages/pcs-sim-sweep.1\n"), "{told}");
    let page = folder.read("pages/pcs-sim-sweep.1");
    assert!(page.contains("accept\\-failures") && page.starts_with(".ie"), "{page}");
    assert!(folder.run("man pages").refused().contains("exists already"));
    folder.run("man pages --force").success();
}

#[test]
fn files_that_exist_are_kept_unless_asked() {
    let folder = Folder::new();
    folder.file("s.json", "precious");
    let error = folder.run("--scene room --size 4x4 --stats s.json").refused();
    insta::assert_snapshot!(error);
    assert_eq!(folder.read("s.json"), "precious");
    folder.run("--scene room --size 4x4 --stats s.json --force").success();
    assert!(folder.read("s.json").starts_with("{\n  \"cycles\": "));
}

/// A camera far off, and a scene far from the origin of coordinates, cost the array about what they cost nearby.
#[test]
fn distance_makes_rays_no_dearer() {
    let folder = Folder::new();
    let voxels = |translate: u32, distance: u32| {
        let scene = format!(
            "Scene(camera: Camera(from: ({x}, -{distance}, 10), at: ({x}, 0, 1), up: (0, 0, 1), angle: {}), \
             meshes: [Mesh(shape: Builtin(name: \"teapot\"), transform: [Translate({translate}, 0, 0)])])",
            600.0 / distance as f64,
            x = translate,
        );
        folder.file("far.ron", scene);
        folder.run("--scene far.ron --size 32x32 --stats s.json --force").success();
        let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        stats["counts"]["voxels"].as_u64().unwrap() + stats["counts"]["slab_tests"].as_u64().unwrap()
    };
    let near = voxels(0, 100);
    for (translate, distance) in [(0, 1000), (0, 5000), (1000, 100)] {
        let far = voxels(translate, distance);
        assert!(far < 2 * near, "{far} voxels and tests, not {near}, with {translate} and {distance}");
    }
}

/// A device is written to, not replaced, and so is the file that a link leads to.
#[cfg(unix)]
#[test]
fn devices_and_links_are_written_through() {
    let folder = Folder::new();
    folder.run("--scene room --size 4x4 --stats /dev/null --hits /dev/null").success();
    folder.file("target.json", "old");
    std::os::unix::fs::symlink(folder.path("target.json"), folder.path("link.json")).unwrap();
    folder.run("--scene room --size 4x4 --stats link.json --force").success();
    assert!(folder.path("link.json").is_symlink());
    assert!(folder.read("target.json").starts_with('{'));
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    use std::process::{Command, Stdio};
    let mut child = Command::new(env!("CARGO_BIN_EXE_pcs-sim"))
        .args(["--scene", "room", "--size", "4x4"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

/// The README's sample is what the command prints.
#[test]
fn the_readme_shows_a_real_run() {
    let readme = include_str!("../../README.md");
    let command = "$ pcs-sim --mode pipeline --scene reference --size 512x512\n";
    let shown = readme.split(command).nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    assert_eq!(Folder::new().run(command["$ pcs-sim ".len()..].trim()).success(), shown);
}

/// One thing is one thing, wherever people read of it.
#[test]
fn one_of_a_kind_has_no_plural() {
    let folder = Folder::new();
    folder.file("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.file("one.ops", "0 host w1\n0 0 r1 o5\n");
    folder.file("one.ron", r#"(scene: "one.obj", size: "1x1", fifo_words: [4])"#);
    for run in [
        "--scene one.obj --size 1x1 --mode broadcast --cells 1 --why",
        "--scene one.obj --size 1x1 --screen-rectangles scene",
        "image one.obj --size 1x1 -o i.png --adaptive --samples 2",
        "image one.obj --size 1x1 -o few.png --colors 1",
        "farm one.obj --size 1x1 --tasks 1 --buses 1",
        "ipsc2 one.obj --size 1x1 --nodes 1 --mode shared-memory",
        "ipsc2 one.obj --size 8x8 --nodes 1 --flow window --window 1",
        "replay one.ops --fifo-words 1 --why",
        "why one.ops --cell 0 --at 1 --fifo-words 1",
        "size-fifos --ops one.ops",
        "model one.obj --size 1x1",
        "scenes one.obj",
        "sweep one.ron -o t.csv",
        "sweep one.ron --count",
    ] {
        let text = folder.run(run).success();
        let is_number = |word: &str| !word.is_empty() && word.chars().all(|c| c.is_ascii_digit());
        // The first word of a line is a name where it is a number.
        for line in text.lines() {
            let words: Vec<&str> = line.split([' ', '(']).filter(|word| !word.is_empty()).collect();
            for three in words.windows(3) {
                let noun = three[2].trim_end_matches([')', ',', ';', ':', '.']);
                let is_plural =
                    noun.len() > 2 && noun != "bus" && noun.ends_with('s') && noun.chars().all(char::is_alphabetic);
                let is_one = three[1] == "1" && !is_number(three[0]);
                assert!(!(is_one && is_plural), "{run}: {line}");
            }
        }
    }
}

/// Whatever of a machine can be changed tells what holds without.
#[test]
fn flags_of_machines_tell_their_defaults() {
    let folder = Folder::new();
    for command in ["", "image", "replay", "model", "size-fifos", "why", "farm", "ipsc2"] {
        let help = folder.run(&format!("{command} --help")).success();
        let (_, machine) = help.split_once("\nMachine:\n").unwrap();
        let is_heading = |line: &str| line.ends_with(':') && !line.starts_with(' ');
        let lines: Vec<&str> = machine.lines().take_while(|line| !is_heading(line)).collect();
        let text = lines.join("\n");
        let flags: Vec<&str> = text.split("\n      --").collect();
        assert!(flags.len() > 8, "{command}: {text}");
        for flag in flags {
            assert!(flag.contains("[default:"), "{command}: {flag}");
        }
    }
}
