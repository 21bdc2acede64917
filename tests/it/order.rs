//! Orders of the rays change when things happen, and nothing else: hits and images stay, and the cycles are those of the same rays
//! written to a file in that order.

use std::convert::Infallible;
use std::fmt::Write;

use crate::support::command::Folder;
use crate::support::{bits, program};
use pcs_sim::geometry::{Ray, brute_force};
use pcs_sim::host::camera::{ImageSize, primary_rays};
use pcs_sim::host::order::Order;
use pcs_sim::host::policy::{HostRules, Policy};
use pcs_sim::host::sampling::{Criterion, Sampling};
use pcs_sim::host::shading::Limits;
use pcs_sim::machine::MachineSpec;
use pcs_sim::program::Workload;
use pcs_sim::run::{self, Picture, Rendered, Seen, Timed, Watching, Workers};
use pcs_sim::scene::builtin;
use serde_json::Value;

const ORDERS: [Order; 5] = [Order::Columns, Order::Tiles(8), Order::Hilbert, Order::Stride, Order::Shuffle(7)];
const SIZE: ImageSize = ImageSize { width: 29, height: 22 };

fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&folder.read(name)).unwrap()
}

/// Rays as a file of `--rays`.
fn csv(rays: &[Ray]) -> String {
    let mut text = "ox,oy,oz,dx,dy,dz\n".to_owned();
    for Ray { origin: o, direction: d, .. } in rays {
        writeln!(text, "{},{},{},{},{},{}", o.x, o.y, o.z, d.x, d.y, d.z).unwrap();
    }
    text
}

#[test]
fn hits_and_pictures_stay_and_cycles_are_those_of_the_rays_in_a_file() {
    let scene = builtin::generate("teapot", Some(3), None).unwrap();
    let rays = primary_rays(&scene.camera, SIZE);
    let mut cycles = Vec::new();
    for mode in [
        "--mode pipeline",
        "--mode broadcast --cells 4",
        "--mode broadcast --cells 3 --partition work",
        "--mode hybrid",
    ] {
        let folder = Folder::new();
        let run = format!("{mode} --scene teapot --size-factor 3 --fifo-words 40");
        let camera = format!("{run} --size {}x{}", SIZE.width, SIZE.height);
        folder.run(&format!("{camera} --hits h.csv --image i.png --stats s.json")).success();
        for order in ORDERS {
            let name = order.to_string();
            folder.run(&format!("{camera} --order {name} --hits o.csv --image o.png --stats o.json --force")).success();
            assert_eq!(folder.read("o.csv"), folder.read("h.csv"), "{mode} {name}");
            let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
            assert!(bytes("o.png") == bytes("i.png"), "{mode} {name}");
            folder.file("rays.csv", csv(&order.of_pixels(SIZE).arrange(rays.clone())));
            folder.run(&format!("{run} --rays rays.csv --stats r.json --force")).success();
            let (ordered, listed) = (json(&folder, "o.json"), json(&folder, "r.json"));
            for field in ["cycles", "cells", "fifos", "counts", "bottleneck"] {
                assert_eq!(ordered[field], listed[field], "{mode} {name} {field}");
            }
            cycles.push(ordered["cycles"].as_u64());
        }
        cycles.push(json(&folder, "s.json")["cycles"].as_u64());
    }
    let all = cycles.len();
    cycles.sort_unstable();
    cycles.dedup();
    assert!(cycles.len() > all * 3 / 4, "orders hardly matter here: {cycles:?}");
}

#[test]
fn rays_of_a_file_have_orders_too_but_none_of_pixels() {
    let folder = Folder::new();
    let scene = builtin::generate("room", None, None).unwrap();
    let rays = primary_rays(&scene.camera, SIZE);
    folder.file("rays.csv", csv(&rays));
    folder.file("other.csv", csv(&Order::Shuffle(3).of_list(rays.len()).unwrap().arrange(rays)));
    let run = |flags: &str| {
        folder.run(&format!("--scene room {flags} --hits h.csv --stats s.json --force")).success();
        (folder.read("h.csv"), json(&folder, "s.json")["cycles"].as_u64())
    };
    let (hits, _) = run("--rays rays.csv");
    let (ordered, cycles) = run("--rays rays.csv --order shuffle:3");
    assert_eq!(ordered, hits);
    let (others, listed) = run("--rays other.csv");
    assert_ne!(others, hits);
    assert_eq!(cycles, listed);
    for order in ["columns", "tiles:4", "hilbert"] {
        let error = folder.run(&format!("--scene room --rays rays.csv --order {order}")).refused();
        assert!(error.contains("is an order of pixels"), "{error}");
    }
    assert!(folder.run("--scene room --order spiral").refused().contains("tiles:N"));
    assert!(
        folder
            .run("image room -o a.png --timing off --order stride")
            .refused()
            .contains("--order is about the machine")
    );
}

/// A run's description has its order, unless it is the usual one; titles and the page name it.
#[test]
fn what_describes_a_run_names_its_order() {
    let folder = Folder::new();
    let run = "--scene room --size 12x9 --mode broadcast --cells 2";
    let title = folder.run(&format!("{run} --stats raster.json")).success();
    assert!(!title.contains("in the order"), "{title}");
    assert!(!folder.read("raster.json").contains("order\": \"raster"));
    let title = folder.run(&format!("{run} --order tiles:4 --stats a.json --page a.html --plot plots")).success();
    let title = title.replace('\n', " ");
    assert!(title.starts_with(
        "broadcast on 2 cells in 2 groups of 1: scene room (45 polygons), 108 rays, in the order tiles:4 machine: "
    ));
    assert_eq!(json(&folder, "a.json")["configuration"]["order"], "tiles:4");
    assert!(folder.read("a.html").contains("in the order tiles:4"));
    let plots: Vec<_> = std::fs::read_dir(folder.path("plots")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let svg: Vec<_> = plots.iter().filter(|path| path.extension().is_some_and(|ending| ending == "svg")).collect();
    assert!(svg.len() > 3 && svg.iter().all(|path| std::fs::read_to_string(path).unwrap().contains("tiles:4")));
    folder.run("--config a.json --stats b.json").success();
    assert_eq!(folder.read("b.json"), folder.read("a.json"));
    folder.run("--config a.json --order raster --stats c.json").success();
    assert_eq!(folder.read("c.json"), folder.read("raster.json"));
    let title = folder.run("image room --size 12x9 -o a.png --order hilbert --stats i.json").success();
    assert!(title.replace('\n', " ").contains(" a pixel, in the order hilbert machine: "), "{title}");
    folder.run("image --config i.json -o b.png --stats j.json").success();
    assert_eq!(folder.read("j.json"), folder.read("i.json"));
}

#[test]
fn sweeps_have_it_as_a_parameter() {
    let folder = Folder::new();
    folder.file(
        "sweep.ron",
        r#"(scene: "room", size: "20x15", mode: "broadcast", cells: 3, order: ["raster", "shuffle:7", "tiles:0"], fifo_words: [16, 512])"#,
    );
    folder.run("sweep sweep.ron -o t.csv --accept-failures").success();
    let table = folder.read("t.csv");
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|column| *column == name).unwrap();
    let (order, cycles) = (column("order"), column("cycles"));
    assert_eq!(
        rows[1..].iter().map(|row| row[order]).collect::<Vec<_>>(),
        ["raster", "raster", "shuffle:7", "shuffle:7", "tiles:0", "tiles:0"]
    );
    for (row, depth) in [(3, 16), (4, 512)] {
        folder
            .run(&format!("--scene room --size 20x15 --mode broadcast --cells 3 --order shuffle:7 --fifo-words {depth} --stats s.json --force"))
            .success();
        assert_eq!(rows[row][cycles], json(&folder, "s.json")["cycles"].to_string());
    }
    assert!(rows[5][cycles].is_empty() && table.contains("expected raster"), "{table}");
    folder.file("images.ron", r#"(scene: "room", size: "8x6", image: true, order: ["raster", "stride"])"#);
    folder.run("sweep images.ron -o i.csv").success();
    let images = folder.read("i.csv");
    assert!(images.lines().count() == 3 && images.lines().skip(1).all(|row| row.ends_with(',')), "no errors: {images}");
}

/// Makes an image with a host that begins the pixels in an order; and the hits of the rays as they were sent.
fn image(order: Order, sampling: Sampling) -> (Rendered, Vec<[u32; 4]>) {
    let scene = builtin::generate("balls", Some(1), Some(8)).unwrap();
    let workload = Workload::new(&scene.mesh, &program("broadcast", 3), crate::support::machine().times, &[]).unwrap();
    let picture = Picture {
        scene: &scene,
        workload: &workload,
        size: SIZE,
        sampling,
        limits: Limits::default(),
        screen: None,
        rules: Default::default(),
    };
    let rules = HostRules { order, policy: Policy::PrimariesFirst, open_samples: 1 << 20, ..HostRules::default() };
    let timed = Timed { spec: &MachineSpec::default(), rules, watching: Watching::default() };
    let mut hits = Vec::new();
    let rendered = run::render(&picture, Some(timed), &Workers::new(2), |seen| {
        if let Seen::Sent(_, hit, _) = seen {
            hits.push(bits(hit));
        }
        Ok::<_, Infallible>(())
    });
    (rendered.unwrap(), hits)
}

#[test]
fn images_stay_and_their_pixels_are_begun_in_that_order() {
    let one = Sampling { side: 1, adaptive: None };
    for sampling in [one, Sampling { side: 2, adaptive: None }, Sampling { side: 3, adaptive: Some(Criterion::Object) }]
    {
        let (raster, _) = image(Order::Raster, sampling);
        for order in ORDERS {
            let (ordered, _) = image(order, sampling);
            assert!(ordered.pixels == raster.pixels, "{order} {sampling:?}");
            assert_eq!(ordered.kinds.map(|kind| kind.rays), raster.kinds.map(|kind| kind.rays), "{order} {sampling:?}");
        }
    }
    let scene = builtin::generate("balls", Some(1), Some(8)).unwrap();
    let polygons = pcs_sim::geometry::Polygons::new(&scene.mesh);
    let rays = primary_rays(&scene.camera, SIZE);
    for order in ORDERS {
        let expected: Vec<[u32; 4]> =
            order.of_pixels(SIZE).arrange(rays.clone()).iter().map(|ray| bits(&brute_force(&polygons, ray))).collect();
        // With room for all samples the primary rays go first.
        assert!(image(order, one).1[..rays.len()] == expected, "{order}");
    }
}

/// A trace of two cells that take turns at being slow, for longer than FIFOs bridge, its rays in some order.
fn turns(order: impl Iterator<Item = usize>) -> String {
    let line = |ray: usize| {
        let (first, second) = if (ray / 40).is_multiple_of(2) { (900, 60) } else { (60, 900) };
        format!("{ray} host w8\n{ray} 0 x8 g{first} o5\n{ray} 1 x8 g{second} i5 o5\n")
    };
    order.map(line).collect()
}

#[test]
fn what_is_lost_to_the_order_is_what_another_order_gives_back() {
    let folder = Folder::new();
    folder.file("a.ops", turns(0..400));
    // The order in which the losses are reckoned is `shuffle:0`, but for the first ray.
    let shuffled = Order::Shuffle(0).of_list(400).unwrap();
    let others: Vec<usize> = std::iter::once(0).chain(shuffled.numbers().filter(|&ray| ray != 0)).collect();
    folder.file("b.ops", turns(others.into_iter()));
    let text = folder.run("replay a.ops --fifo-words 32 --stats a.json").success();
    folder.run("replay b.ops --fifo-words 32 --stats b.json").success();
    let (raster, random) = (json(&folder, "a.json"), json(&folder, "b.json"));
    let losses = &raster["losses"];
    let cycles = |of: &Value, field: &str| of[field].as_u64().unwrap();
    assert_eq!(losses["shuffled"], random["cycles"]);
    assert_eq!(cycles(losses, "order"), cycles(&raster, "cycles") - cycles(&random, "cycles"));
    let cell = &raster["cells"][cycles(losses, "cell") as usize];
    let works = cell["busy"]["grid"].as_u64().unwrap() + cycles(cell, "moving");
    let parts = ["order", "variance", "first_and_last"].map(|part| cycles(losses, part));
    assert_eq!(parts.iter().sum::<u64>(), cycles(&raster, "cycles") - works);
    assert!(parts[0] > 2 * parts[1] && parts[1] > 0 && parts[2] > 0, "{parts:?}");
    insta::assert_snapshot!(text.lines().rev().nth(1).unwrap());
    assert!(random.get("losses").is_none_or(|losses| cycles(losses, "order") * 20 < cycles(&random, "cycles")));
}

/// Nothing is said where the busiest cell works nearly all of the time, nor where the host or a link is to blame.
#[test]
fn nothing_is_said_of_losses_that_are_not_worth_a_word() {
    let busy = |rays: usize| {
        (0..rays).map(|ray| format!("{ray} host w8\n{ray} 0 x8 g100 o1\n{ray} 1 x8 i1 n900 o5\n")).collect::<String>()
    };
    let host = (0..50).map(|ray| format!("{ray} host c5000 w8\n{ray} 0 x8 g1000 o5\n")).collect::<String>();
    let link =
        (0..50).map(|ray| format!("{ray} host w8\n{ray} 0 x8 g10 o9\n{ray} 1 x8 i9 n10 o5\n")).collect::<String>();
    for (trace, flags) in [(busy(50), ""), (host, ""), (link, "--link-mb-s 8")] {
        let folder = Folder::new();
        folder.file("a.ops", &trace);
        let text = folder.run(&format!("replay a.ops --stats a.json {flags}")).success();
        assert!(!text.contains("Lost against"), "{text}");
        assert!(json(&folder, "a.json").get("losses").is_none());
    }
}
