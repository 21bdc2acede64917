//! Adaptive sampling: which pixels each criterion gives more samples, and what they then show.

use std::collections::BTreeSet;
use std::convert::Infallible;

use glam::Vec3;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::order::Order;
use pcs_sim::host::sampling::{Criterion, Pass, Sampling, Shown};
use pcs_sim::host::shading::Limits;
use pcs_sim::program::Workload;
use pcs_sim::run::{self, Picture, Rendered, Workers};
use pcs_sim::scene::{self, Camera, Light, Scene, builtin};

use crate::support::command::Folder;
use crate::support::glass;
use crate::support::pictures::decoded;

const SIDE: u32 = 24;

const WHITTED: Criterion = Criterion::Whitted { threshold: Criterion::THRESHOLD };

const ALL: [Criterion; 4] = [Criterion::Object, Criterion::Surface, Criterion::Lao, WHITTED];

fn render(scene: &Scene, sampling: Sampling, width: u32) -> Rendered {
    let program = crate::support::program("pipeline", 1);
    let workload = Workload::new(&scene.mesh, &program, crate::support::machine().times, &[]).unwrap();
    let size = ImageSize { width, height: width };
    let picture = Picture {
        scene,
        workload: &workload,
        size,
        sampling,
        limits: Limits::default(),
        screen: None,
        rules: Default::default(),
    };
    run::render(&picture, None, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap()
}

fn refined(scene: &Scene, criterion: Criterion, width: u32) -> BTreeSet<u32> {
    render(scene, Sampling { side: 2, adaptive: Some(criterion) }, width).refined.into_iter().collect()
}

/// What an OBJ file has before a camera that sees 4 x 4 units of the plane z = 0, lit from far behind it.
fn before_the_eye(contents: &str) -> Scene {
    let folder = Folder::new();
    let mut scene = scene::load(&folder.file("scene.obj", contents), &Default::default()).unwrap();
    let angle = 2.0 * 0.2f32.atan().to_degrees();
    scene.camera = Camera { from: Vec3::Z * 10.0, at: Vec3::ZERO, up: Vec3::Y, angle };
    scene.lights = vec![Light::directional(Vec3::Z, Vec3::ONE)];
    scene
}

#[test]
fn one_polygon_over_the_whole_picture_asks_for_nothing() {
    let scene = before_the_eye("v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\n");
    for criterion in ALL {
        assert_eq!(refined(&scene, criterion, SIDE), BTreeSet::new(), "{criterion:?}");
    }
}

/// The edge of a half-plane: of the pixels on either side those that have it among their four neighbours, or their eight.
#[test]
fn the_edge_of_a_half_plane_asks_for_the_pixels_beside_it() {
    // Upright, between two columns.
    let upright = before_the_eye("v -9 -9 0\nv 0.01 -9 0\nv 0.01 9 0\nv -9 9 0\nf 1 2 3 4\n");
    for criterion in ALL {
        assert_eq!(refined(&upright, criterion, SIDE).len() as u32, 2 * SIDE, "{criterion:?}");
    }
    // Along the diagonal: pixels show the half-plane where their column is at least their line.
    let slanted = before_the_eye("v -9.01 9 0\nv 9 -9.01 0\nv 9 9 0\nf 1 2 3\n");
    let inside = |column: i32, line: i32| column >= line;
    let has = |ways: &[(i32, i32)]| {
        let side = SIDE as i32;
        let pixels = (0..side).flat_map(|line| (0..side).map(move |column| (column, line)));
        let differs = |&(column, line): &(i32, i32)| {
            let beside = ways.iter().map(|(x, y)| (column + x, line + y));
            let mut beside = beside.filter(|(x, y)| (0..side).contains(x) && (0..side).contains(y));
            beside.any(|(x, y)| inside(x, y) != inside(column, line))
        };
        pixels.filter(differs).map(|(column, line)| (line * side + column) as u32).collect::<BTreeSet<u32>>()
    };
    let four = [(-1, 0), (1, 0), (0, -1), (0, 1)];
    let eight = [&four[..], &[(-1, -1), (1, -1), (-1, 1), (1, 1)]].concat();
    assert_eq!(refined(&slanted, Criterion::Object, SIDE), has(&four));
    assert_eq!(refined(&slanted, Criterion::Surface, SIDE), has(&four));
    assert_eq!(refined(&slanted, Criterion::Lao, SIDE), has(&eight));
    assert_eq!(refined(&slanted, WHITTED, SIDE), has(&eight));
    assert_eq!((has(&four).len() as u32, has(&eight).len() as u32), (2 * SIDE - 1, 4 * SIDE - 4));
}

#[test]
fn each_criterion_finds_what_the_one_before_finds() {
    let builtin = |name: &str, size: u32| builtin::generate(name, Some(size), Some(8)).unwrap();
    let rooms = builtin::generate("room", None, None).unwrap();
    let valve = builtin::generate("valve", Some(1), Some(8)).unwrap();
    let mut more = [0; 2];
    for scene in [glass(), rooms, builtin("balls", 2), builtin("tree", 2), valve] {
        let [object, surface, lao] =
            [Criterion::Object, Criterion::Surface, Criterion::Lao].map(|criterion| refined(&scene, criterion, 32));
        assert!(object.is_subset(&surface) && surface.is_subset(&lao), "{}", scene.name);
        assert!(lao.len() < 32 * 32, "{}", scene.name);
        more[0] += surface.len() - object.len();
        more[1] += lao.len() - surface.len();
    }
    assert!(more[0] > 20 && more[1] > 100, "{more:?}");
}

/// Two walls of one object that meet at an angle are one object and two surfaces; a shadow's edge is on one surface, and has the lights
/// differ; a mirror image's edge has what is reflected differ.
#[test]
fn surfaces_shadows_and_mirror_images_have_their_edges() {
    let walls =
        before_the_eye("v -9 -9 0\nv 0.01 -9 0\nv 0.01 9 0\nv -9 9 0\nv 9 -9 -4\nv 9 9 -4\nf 1 2 3 4\nf 2 5 6 3\n");
    assert_eq!(refined(&walls, Criterion::Object, SIDE).len(), 0);
    assert_eq!(refined(&walls, Criterion::Surface, SIDE).len() as u32, 2 * SIDE);
    assert_eq!(refined(&walls, Criterion::Lao, SIDE).len() as u32, 2 * SIDE);
    // One that stands beside the picture throws its shadow into it.
    let mut shadow = before_the_eye(
        "o wall\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\no post\nv -9 -9 3\nv -2.99 -9 3\nv -2.99 9 3\nv -9 9 3\nf 5 6 7 8\n",
    );
    shadow.lights = vec![Light::directional(Vec3::new(-1.0, 0.0, 1.0), Vec3::ONE)];
    assert_eq!(refined(&shadow, Criterion::Surface, SIDE).len(), 0);
    assert_eq!(refined(&shadow, Criterion::Lao, SIDE).len() as u32, 2 * SIDE);
    assert_eq!(refined(&shadow, WHITTED, SIDE).len() as u32, 2 * SIDE);
    // The same seen in a mirror, behind the eye.
    let mut mirror = before_the_eye(
        "o wall\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\no poster\nv -99 -99 20\nv -99 99 20\nv 0.01 99 20\nv 0.01 -99 20\nf 5 6 7 8\n",
    );
    mirror.lights = vec![Light::point(Vec3::Z * 9.0, Vec3::ONE)];
    assert_eq!(refined(&mirror, Criterion::Lao, SIDE).len(), 0);
    mirror.materials[0].specular = 0.6;
    let found = refined(&mirror, Criterion::Lao, SIDE);
    assert!((0..SIDE).all(|line| [11, 12].iter().all(|column| found.contains(&(line * SIDE + column)))), "{found:?}");
    assert_eq!(refined(&mirror, Criterion::Surface, SIDE).len(), 0);
}

/// A ball between the middles of four pixels, which no ray of the first pass meets.
#[test]
fn a_ball_smaller_than_a_pixel_is_found_by_lao_alone() {
    let folder = Folder::new();
    let text = "(camera: (from: (0, 0, 10), at: (0, 0, 0), up: (0, 1, 0), angle: 22.6),
        meshes: [(shape: Csg(Sphere(slices: 12)), transform: [Scale(0.04, 0.04, 0.04)])])";
    let scene = scene::load(&folder.file("ball.ron", text), &Default::default()).unwrap();
    for criterion in [Criterion::Object, Criterion::Surface, WHITTED] {
        assert_eq!(refined(&scene, criterion, SIDE).len(), 0, "{criterion:?}");
    }
    // It reaches into four pixels, and each of their neighbours looks at one of them.
    let found = refined(&scene, Criterion::Lao, SIDE);
    assert_eq!(found.len(), 16);
    let one = render(&scene, Sampling::default(), SIDE);
    let picture = render(&scene, Sampling { side: 8, adaptive: Some(Criterion::Lao) }, SIDE);
    assert!(one.pixels.iter().all(|pixel| *pixel == scene.background));
    assert_eq!(picture.pixels.iter().filter(|pixel| **pixel != scene.background).count(), 4);
}

/// The second pass begins a pixel when the line below it is known as far as the criterion looks: to the pixel just below, or to the one
/// across the corner.
#[test]
fn a_pixel_waits_for_what_the_criterion_looks_at() {
    const WIDTH: usize = 5;
    let size = ImageSize { width: WIDTH as u32, height: 4 };
    let keys: Vec<u64> = (0..size.pixels()).map(|pixel| u64::from(pixel == 2 * WIDTH + 2)).collect();
    for (criterion, count, known) in
        [(Criterion::Object, 5, WIDTH + 1), (Criterion::Surface, 5, WIDTH + 1), (Criterion::Lao, 9, WIDTH + 2)]
    {
        let sampling = Sampling { side: 2, adaptive: Some(criterion) };
        let first = Pass::first(size, sampling, Order::Raster);
        let second = Pass::second(&first, (criterion, 2), &Shown { keys: keys.clone(), small: None });
        assert_eq!(second.len(), 4 * count, "{criterion:?}");
        for sample in 0..second.len() {
            let expected = (second.pixel(sample) + known).min(size.pixels());
            assert_eq!(second.decided_by(sample), expected, "{criterion:?}, pixel {}", second.pixel(sample));
        }
    }
}

/// A pixel that got more samples is that of the picture which has them everywhere; any other is that of the picture with one each.
#[test]
fn pixels_are_those_of_the_one_picture_or_the_other() {
    for scene in [glass(), builtin::generate("room", None, None).unwrap()] {
        let one = render(&scene, Sampling::default(), 30);
        let many = render(&scene, Sampling { side: 3, adaptive: None }, 30);
        assert_eq!((one.samples, many.samples), (900, 8100));
        for criterion in ALL.into_iter().chain([Criterion::Whitted { threshold: 0 }]) {
            let some = render(&scene, Sampling { side: 3, adaptive: Some(criterion) }, 30);
            let refined: BTreeSet<u32> = some.refined.iter().copied().collect();
            assert!(!refined.is_empty() && some.samples == 900 + 9 * refined.len() as u64);
            for (pixel, found) in (0..).zip(&some.pixels) {
                let expected = if refined.contains(&pixel) { &many.pixels } else { &one.pixels };
                assert!(*found == expected[pixel as usize], "{criterion:?} {pixel}");
            }
        }
    }
}

/// A ball before the whole picture, lit by a lamp beside it: no two neighbours have the same colour.
#[test]
fn where_all_pixels_are_asked_for_the_picture_is_that_of_many_samples() {
    let mut scene = before_the_eye("v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\n");
    scene.lights = vec![Light::point(Vec3::new(-6.0, -5.0, 4.0), Vec3::ONE)];
    let sampling = Sampling { side: 3, adaptive: Some(Criterion::Whitted { threshold: 0 }) };
    let (some, all) = (render(&scene, sampling, SIDE), render(&scene, Sampling { side: 3, adaptive: None }, SIDE));
    assert_eq!(some.refined.len() as u32, SIDE * SIDE);
    assert!(some.pixels == all.pixels);
}

#[test]
fn the_command_tells_what_was_oversampled() {
    let folder = Folder::new();
    let mut report = String::new();
    folder.run("image room --size 24x24 --samples 8 --timing off -o truth.pfm").success();
    for by in ["object", "surface", "lao", "whitted", "whitted --threshold 60"] {
        let flags = format!("--samples 3 --adaptive-by {by} --against truth.pfm --force");
        let text = folder
            .run(&format!("image room --size 24x24 {flags} -o i.png --stats s.json --refined mask.png"))
            .success();
        let lines = text.lines().filter(|line| line.contains("oversampled") || line.starts_with("off from"));
        report += &format!("{by}\n{}\n", lines.collect::<Vec<_>>().join("\n"));
        let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        let mask = decoded(&folder.path("mask.png")).bytes;
        let white = mask.iter().filter(|value| **value == 255).count() as u64;
        assert_eq!(stats["refined_pixels"].as_u64(), Some(white), "{by}");
        assert_eq!(mask.len(), 24 * 24);
    }
    insta::assert_snapshot!(report);
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    folder.file("short.pfm", "PF\n4 4\n-1.0\nabc");
    folder.run("image room --size 5x4 --timing off -o other.pfm").success();
    let mut report = String::new();
    for flags in [
        "--samples 2 --adaptive-by eye",
        "--adaptive-by lao",
        "--samples 2 --adaptive-by whitted --threshold 256",
        "--samples 2 --adaptive-by whitted --threshold=-1",
        "--samples 2 --adaptive-by lao --threshold 3",
        "--samples 2 --refined mask.png",
        "--against short.pfm",
        "--against other.pfm",
        "--against nowhere.pfm",
        "--samples 2 --adaptive-by lao --rays rays.csv",
    ] {
        report += &format!("{flags}\n{}\n", folder.run(&format!("image room --size 4x4 -o i.png {flags}")).refused());
    }
    insta::assert_snapshot!(report);
}
