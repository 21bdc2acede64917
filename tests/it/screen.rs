//! Screen rectangles: what the host does not send hits nothing, and all else is as it was.

use std::collections::BTreeSet;
use std::convert::Infallible;

use glam::{DVec2, Vec3};
use pcs_sim::geometry::{Polygons, brute_force};
use pcs_sim::host::camera::{ImageSize, View, primary_rays};
use pcs_sim::host::policy::{HostRules, Policy};
use pcs_sim::host::sampling::{Criterion, Sampling};
use pcs_sim::host::screen::{PixelRectangle, Screen, ScreenRectangles, rectangles};
use pcs_sim::host::shading::Limits;
use pcs_sim::machine::{Cycles, MachineSpec};
use pcs_sim::program::Workload;
use pcs_sim::run::{self, Picture, Rendered, Seen, Timed, Watching, Workers};
use pcs_sim::scene::{Camera, Scene, builtin};
use proptest::prelude::*;

use crate::support::command::Folder;
use crate::support::glass;
use crate::support::ticking::{self, Ticked};

const BOTH: [ScreenRectangles; 2] = [ScreenRectangles::Scene, ScreenRectangles::Objects];

fn screen(scene: &Scene, polygons: &Polygons, size: ImageSize, of: ScreenRectangles) -> Screen {
    Screen::new(size, &rectangles(scene, polygons, size, of))
}

/// Where in a pixel samples can lie: its corners, nearly, and its middle.
const PLACES: [(f64, f64); 5] = [(0.5, 0.5), (1e-6, 1e-6), (0.999999, 1e-6), (1e-6, 0.999999), (0.999999, 0.999999)];

/// How many pixels show nothing; none of their rays hits anything.
fn unsent(scene: &Scene, size: ImageSize, of: ScreenRectangles) -> usize {
    let polygons = Polygons::new(&scene.mesh);
    let screen = screen(scene, &polygons, size, of);
    let view = View::new(&scene.camera, size);
    let unsent: Vec<usize> = (0..size.pixels()).filter(|&pixel| !screen.shows(pixel)).collect();
    for &pixel in &unsent {
        let (column, line) = ((pixel % size.width as usize) as f64, (pixel / size.width as usize) as f64);
        for (x, y) in PLACES {
            let hit = brute_force(&polygons, &view.ray(column + x, line + y));
            assert!(!hit.is_hit(), "{}: {hit:?} in pixel {pixel} of {size:?}, {of:?}", scene.name);
        }
    }
    assert_eq!(unsent.len(), size.pixels() - screen.count());
    unsent.len()
}

#[test]
fn rays_that_are_not_sent_hit_nothing_in_any_scene() {
    let size = ImageSize { width: 27, height: 20 };
    let mut some = 0;
    for builtin in builtin::all() {
        let scene = builtin::generate(builtin.name, Some(*builtin.size_range.start()), None).unwrap();
        let [of_scene, of_objects] = BOTH.map(|of| unsent(&scene, size, of));
        assert!(of_scene <= of_objects, "{}", builtin.name);
        some += usize::from(of_objects > 0);
    }
    assert!(some >= 5, "{some} scenes leave pixels empty");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// From anywhere, among the balls and far out, and through any lens.
    #[test]
    fn rays_that_are_not_sent_hit_nothing_from_anywhere(
        from in prop_oneof![
            (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0).prop_map(Vec3::from),
            (-9.0f32..9.0, -9.0f32..9.0, -9.0f32..9.0).prop_map(Vec3::from),
            (-1e6f32..1e6, -1e6f32..1e6, -1e6f32..1e6).prop_map(Vec3::from),
        ],
        at in (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0).prop_map(Vec3::from),
        angle in prop_oneof![1e-4f32..1.0, 1.0f32..179.0],
    ) {
        let scene = builtin::generate("balls", Some(1), Some(6)).unwrap();
        let scene = Scene { camera: Camera { from, at, up: Vec3::new(0.1, 0.2, 1.0), angle }, ..scene };
        prop_assume!(scene.camera.check().is_ok());
        for of in BOTH {
            unsent(&scene, ImageSize { width: 16, height: 12 }, of);
        }
    }

    /// The sweep finds what looking at each pixel finds.
    #[test]
    fn a_screen_is_the_union_of_its_rectangles(
        all in prop::collection::vec((-3.0f64..12.0, -3.0f64..12.0, 0.0f64..9.0, 0.0f64..9.0), 0..9),
    ) {
        let size = ImageSize { width: 9, height: 7 };
        let rectangle = |&(x, y, width, height): &(f64, f64, f64, f64)| PixelRectangle {
            low: DVec2::new(x, y),
            high: DVec2::new(x + width, y + height),
        };
        let all: Vec<PixelRectangle> = all.iter().map(rectangle).collect();
        let screen = Screen::new(size, &all);
        for pixel in 0..size.pixels() {
            let (column, line) = ((pixel % 9) as u32, (pixel / 9) as u32);
            let holds = |rectangle: &PixelRectangle| {
                let [columns, lines] = rectangle.pixels(size);
                columns.contains(&column) && lines.contains(&line)
            };
            prop_assert_eq!(screen.shows(pixel), all.iter().any(holds));
        }
    }
}

/// Two squares that face the eye: the pixels of either, less those of both.
#[test]
fn of_two_squares_so_many_rays_are_sent_as_they_have_pixels() {
    let folder = Folder::new();
    let square = |x: f32| format!("v {x} 0 0\nv {0} 0 0\nv {0} 1 0\nv {x} 1 0\n", x + 1.0);
    folder.file("two.obj", format!("o a\n{}f 1 2 3 4\no b\n{}f 5 6 7 8\n", square(0.02), square(0.52)));
    let mut scene = pcs_sim::scene::load(&folder.path("two.obj"), &Default::default()).unwrap();
    // At a distance of 10 the picture is 4 units high: 10 pixels a unit.
    let angle = 2.0 * 0.2f32.atan().to_degrees();
    scene.camera = Camera { from: Vec3::Z * 10.0, at: Vec3::ZERO, up: Vec3::Y, angle };
    let size = ImageSize { width: 40, height: 40 };
    let polygons = Polygons::new(&scene.mesh);
    // From 0.02 to 1.02 on and from 0.52 to 1.52 on; from 0 to 1, whose edges lie between lines and are rounded outward.
    let (first, second, both, lines) = (11, 11, 6, 12);
    assert_eq!(screen(&scene, &polygons, size, ScreenRectangles::Objects).count(), (first + second - both) * lines);
    assert_eq!(screen(&scene, &polygons, size, ScreenRectangles::Scene).count(), (first + second - both) * lines);
}

fn json(folder: &Folder, name: &str) -> serde_json::Value {
    serde_json::from_str(&folder.read(name)).unwrap()
}

/// The same hits, and the cycles of the trace without the rays that are not sent.
#[test]
fn a_run_is_that_of_the_trace_without_the_rays_that_are_not_sent() {
    let folder = Folder::new();
    for (mode, scene) in [
        ("--mode pipeline", "tree --size-factor 3"),
        ("--mode broadcast --cells 5", "teapot --size-factor 3"),
        ("--mode hybrid --groups 3", "lattice --size-factor 2 --order hilbert"),
    ] {
        let run = format!("--scene {scene} {mode} --size 20x16 --force");
        folder.run(&format!("{run} --ops all.ops --hits all.csv --image all.png")).success();
        for of in ["scene", "objects"] {
            let flags = format!("--screen-rectangles {of}");
            let text = folder
                .run(&format!("{run} {flags} --ops few.ops --hits few.csv --image few.png --stats few.json"))
                .success();
            assert_eq!(folder.read("all.csv"), folder.read("few.csv"), "{scene} {of}");
            let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
            assert!(bytes("all.png") == bytes("few.png"));
            let few = json(&folder, "few.json");
            let (sent, samples) = (few["rays"].as_u64().unwrap(), few["samples"].as_u64().unwrap());
            assert!(samples == 320 && sent > 20 && (sent < samples || of == "scene"), "{sent} of {samples}");
            assert!(text.contains(&format!("320 samples, {sent} sent (")), "{text}");
            // What each ray of the one trace is in the other, only their order tells: those of the pixels that show something.
            let name = scene.split(' ').next().unwrap();
            let size: u32 = scene.split(' ').nth(2).unwrap().parse().unwrap();
            let built = builtin::generate(name, Some(size), None).unwrap();
            let size = ImageSize { width: 20, height: 16 };
            let of = if of == "scene" { ScreenRectangles::Scene } else { ScreenRectangles::Objects };
            let screen = screen(&built, &Polygons::new(&built.mesh), size, of);
            let order = if scene.contains("hilbert") { "hilbert" } else { "raster" };
            let numbers = order.parse::<pcs_sim::host::order::Order>().unwrap().of_pixels(size);
            let kept: BTreeSet<String> = (0..320)
                .filter(|&place| screen.shows(numbers.number(place)))
                .map(|place: usize| place.to_string())
                .collect();
            assert_eq!(kept.len() as u64, sent);
            let all = folder.read("all.ops");
            let is_kept = |line: &&str| {
                let first = line.split(' ').next().unwrap();
                first.parse::<u32>().is_err() || kept.contains(first)
            };
            let lines: Vec<&str> = all.lines().filter(is_kept).collect();
            folder.file("edited.ops", lines.join("\n") + "\n");
            folder.run("replay edited.ops --stats edited.json --force").success();
            folder.run("replay few.ops --stats replayed.json --force").success();
            let cycles = |name: &str| json(&folder, name)["cycles"].as_u64().unwrap();
            assert_eq!(cycles("few.json"), cycles("edited.json"), "{scene} {mode} {of:?}");
            assert_eq!(cycles("few.json"), cycles("replayed.json"), "{scene} {mode} {of:?}");
        }
    }
}

#[test]
fn where_all_rays_are_sent_nothing_changes_but_the_hosts_time() {
    let folder = Folder::new();
    let run = "--scene room --size 12x9 --mode broadcast --cells 3 --force";
    folder.run(&format!("{run} --stats all.json")).success();
    folder.run(&format!("{run} --screen-rectangles objects --stats few.json")).success();
    folder.run(&format!("{run} --screen-rectangles objects --host-filter-us 500 --stats slow.json")).success();
    let [all, few, slow] = ["all.json", "few.json", "slow.json"].map(|name| json(&folder, name));
    assert_eq!((&all["rays"], &all["cycles"]), (&few["rays"], &few["cycles"]));
    // 500 µs are 10 000 cycles: the host tests the last sample after 108 of them, and then come 8 words at the least.
    let cycles = slow["cycles"].as_u64().unwrap();
    assert!(cycles > all["cycles"].as_u64().unwrap() && cycles > 108 * 10_000 + 8, "{cycles}");
    assert_eq!(slow["configuration"]["machine"]["host_filter_us"], 500.0);
    assert_eq!(all["configuration"].get("screen_rectangles"), None);
}

#[test]
fn a_picture_of_nothing_sends_nothing() {
    let folder = Folder::new();
    folder.file(
        "away.ron",
        "(camera: (from: (0, 0, 5), at: (0, 0, 9), up: (0, 1, 0), angle: 40), background: (0.2, 0.4, 0.6),
          meshes: [(shape: Csg(Sphere(slices: 12)))])",
    );
    for of in ["scene", "objects"] {
        let flags = format!("--size 6x4 --screen-rectangles {of} --force");
        let text = folder.run(&format!("--scene away.ron {flags} --hits h.csv --stats s.json --image p.png")).success();
        assert!(text.contains("24 samples, 0 sent (0.0 %), of these 0 hit"), "{text}");
        assert_eq!(folder.read("h.csv").lines().filter(|line| line.ends_with(",,,,")).count(), 24);
        assert_eq!(json(&folder, "s.json")["rays"], 0);
        assert!(text.contains("\nNo ray is sent.\n"), "{text}");
        folder.run(&format!("--scene away.ron {flags} --ops a.ops")).success();
        assert!(folder.run("replay a.ops").refused().contains("the trace sends no ray: there is nothing to time"));
        folder.run(&format!("image away.ron {flags} -o i.png --samples 2 --adaptive")).success();
        folder.run("image away.ron --size 6x4 -o plain.png --timing off --force").success();
        let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
        assert!(bytes("i.png") == bytes("plain.png") && bytes("p.png") == bytes("plain.png"));
    }
}

fn far_glass() -> Scene {
    let mut scene = glass();
    // From farther off, so that much of the picture is empty.
    scene.camera.from = scene.camera.at + (scene.camera.from - scene.camera.at) * 4.5;
    scene
}

/// Pixels and rays of all kinds but the primary ones are the same; the times are what ticking the ops gives.
#[test]
fn images_are_the_same_and_timed_as_their_ops_say() {
    let scene = far_glass();
    let program = crate::support::program("broadcast", 3);
    for filter in [0, 300] {
        let mut times = crate::support::machine().times;
        (times.host.filter, times.host.hit) = (Cycles(filter), Cycles(filter));
        // From so far off that rays would stray which the margins were not made for.
        let rays = primary_rays(&scene.camera, ImageSize { width: 2, height: 2 });
        let workload = Workload::new(&scene.mesh, &program, times, &rays).unwrap();
        let tested = workload.clone().with_samples_tested(Default::default());
        for (sampling, size) in
            [(Sampling::default(), (6, 4)), (Sampling { side: 2, adaptive: Some(Criterion::Lao) }, (7, 5))]
        {
            let size = ImageSize { width: size.0, height: size.1 };
            let limits = Limits::default();
            let plain = Picture {
                scene: &scene,
                workload: &workload,
                size,
                sampling,
                limits,
                screen: None,
                rules: Default::default(),
            };
            let (all, _) = timed(&plain, HostRules::default());
            for of in BOTH {
                let screen = screen(&scene, workload.polygons(), size, of);
                assert!(screen.count() < size.pixels() && screen.count() > 2);
                let picture = Picture { workload: &tested, screen: Some(&screen), ..plain };
                for (policy, in_flight, open_samples) in
                    [(Policy::SecondariesFirst, None, 1024), (Policy::PrimariesFirst, Some(3), 4)]
                {
                    let rules = HostRules { policy, in_flight, open_samples, ..HostRules::default() };
                    let (few, batches) = timed(&picture, rules);
                    assert!(few.pixels == all.pixels && few.refined == all.refined && few.samples == all.samples);
                    assert_eq!(
                        few.kinds[1..].iter().map(|kind| kind.rays).sum::<u64>(),
                        all.kinds[1..].iter().map(|kind| kind.rays).sum::<u64>()
                    );
                    assert!(few.kinds[0].rays < all.kinds[0].rays && few.kinds[0].hits == all.kinds[0].hits);
                    // Many cycles are many words of the judge's memory.
                    if sampling.side > 1 && (filter == 0 || of == ScreenRectangles::Scene) {
                        continue;
                    }
                    let ticked = ticking::run(&MachineSpec::default(), tested.costs(), &batches).unwrap();
                    assert_eq!(Ticked::from(&few.timing.unwrap().stats), ticked, "{rules:?} {of:?} {filter}");
                }
            }
        }
    }
}

fn timed(picture: &Picture, rules: HostRules) -> (Rendered, Vec<pcs_sim::seam::OpBatch>) {
    let mut batches = Vec::new();
    let timed = Timed { spec: &MachineSpec::default(), rules, watching: Watching::default() };
    let rendered = run::render(picture, Some(timed), &Workers::new(2), |seen| {
        if let Seen::Sent(ops, ..) = seen {
            batches.push(ops.clone());
        }
        Ok::<_, Infallible>(())
    });
    (rendered.unwrap(), batches)
}

#[test]
fn rectangles_are_drawn_on_the_picture() {
    let folder = Folder::new();
    let image = "image tree --size-factor 2 --size 30x20 --timing off --screen-rectangles objects";
    folder.run(&format!("{image} -o plain.pfm")).success();
    folder.run(&format!("{image} -o drawn.pfm --show-rectangles")).success();
    let [plain, drawn] =
        ["plain.pfm", "drawn.pfm"].map(|name| pcs_sim::host::image::read_pfm(&folder.path(name)).unwrap().1);
    let different = plain.iter().zip(&drawn).filter(|(a, b)| a != b);
    assert!(different.clone().count() > 20 && different.clone().all(|(_, drawn)| drawn.x == 1.0 && drawn.y < 0.1));
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    folder.file("rays.csv", "ox,oy,oz,dx,dy,dz\n0,0,0,1,0,0\n");
    let mut report = String::new();
    for flags in [
        "--scene room --rays rays.csv --screen-rectangles scene",
        "--scene room --size 4x4 --screen-rectangles all",
        "--scene room --size 4x4 --screen-rectangles scene --host-filter-us=-1",
        "--scene room --size 4x4 --screen-rectangles scene --host-filter-us nan",
        "--scene room --size 4x4 --host-filter-us 3",
        "image room --size 4x4 -o i.png --show-rectangles",
        "image room --size 4x4 -o i.png --timing off --screen-rectangles scene --host-filter-us 3",
    ] {
        report += &format!("{flags}\n{}\n", folder.run(flags).refused());
    }
    insta::assert_snapshot!(report);
}
