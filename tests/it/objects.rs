//! What one looks at as one thing, and adaptive sampling, which looks more closely where two things meet.

use std::collections::BTreeSet;
use std::convert::Infallible;
use std::fs;
use std::path::{Path, PathBuf};

use glam::Vec3;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::sampling::{Criterion, Sampling};
use pcs_sim::host::shading::Limits;
use pcs_sim::program::Workload;
use pcs_sim::run::{self, Picture, Rendered, Workers};
use pcs_sim::scene::{self, Camera, Face, Light, Object, ReadOptions, Scene, builtin};

fn file(name: &str, contents: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("objects");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), contents).unwrap();
    folder.join(name)
}

fn load(name: &str, contents: &str) -> Scene {
    scene::load(&file(name, contents), &ReadOptions { resolution: 4 }).unwrap_or_else(|error| panic!("{error}"))
}

/// The objects of a scene as numbers, face by face, in the order in which they first occur.
fn objects(scene: &Scene) -> Vec<usize> {
    let mut known: Vec<Object> = Vec::new();
    let number = |face: &Face| {
        let object = scene.mesh.object(face);
        known.iter().position(|other| *other == object).unwrap_or_else(|| {
            known.push(object);
            known.len() - 1
        })
    };
    scene.mesh.faces().iter().map(number).collect()
}

fn count(scene: &Scene) -> usize {
    objects(scene).into_iter().collect::<BTreeSet<usize>>().len()
}

const POINTS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const FACE: &str = "f 1 2 3\n";

#[test]
fn of_obj_are_its_groups_and_materials() {
    let of = |body: &str| objects(&load("groups.obj", &format!("{POINTS}{body}").replace('F', FACE)));
    assert_eq!(of("FFF"), [0, 0, 0]);
    assert_eq!(of("o a\nFFo b\nFg c\nF"), [0, 0, 1, 2]);
    assert_eq!(of("Fo a\nF"), [0, 1]);
    assert_eq!(of("o a\nusemtl x\nFusemtl y\nFusemtl x\nF"), [0, 1, 0]);
}

#[test]
fn of_nff_are_spheres_cones_polygons_and_surfaces_of_patches() {
    let triangle = "0 0 0\n1 0 0\n0 1 0\n";
    let patch = "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n";
    let scene = load("things.nff", &format!("p 3 {triangle} p 3 {triangle} pp 3 {patch} pp 3 {patch} p 3 {triangle}"));
    assert_eq!(objects(&scene), [0, 1, 2, 2, 3]);
    let scene = load("round.nff", "s 0 0 0 1\ns 3 0 0 1\nc 0 0 0 1  0 0 5 1\n");
    assert_eq!(objects(&scene), [vec![0; 8], vec![1; 8], vec![2; 4]].concat());
}

#[test]
fn of_a_scene_file_are_its_meshes_and_the_objects_in_each() {
    file("two.obj", &format!("{POINTS}{FACE}o b\n{FACE}"));
    let mesh = r#"(shape: File("two.obj"))"#;
    let scene = load("meshes.ron", &format!("Scene(meshes: [{mesh}, {mesh}])"));
    assert_eq!(objects(&scene), [0, 1, 2, 3]);
    let arrow = "Polygons(points: [(0,0,0), (2,1,0), (0,2,0), (1,1,0)], faces: [[0, 1, 2, 3]])";
    let scene = load("cut.ron", &format!("Scene(meshes: [(shape: {arrow}), (shape: {arrow}), {mesh}])"));
    assert_eq!(objects(&scene), [0, 0, 1, 1, 2, 3]);
}

#[test]
fn of_built_in_scenes_are_their_pieces() {
    let count = |name: &str, size: u32| count(&builtin::generate(name, Some(size), None).unwrap());
    assert_eq!(count("balls", 1), 1 + 10);
    assert_eq!(count("tree", 1), 1 + 3 + 3);
    assert_eq!(count("gears", 2), 1 + 8);
    assert_eq!(count("tetra", 3), 16);
    assert_eq!(count("lattice", 1), 8 + 12);
    assert_eq!(count("mountain", 2), 5);
    assert_eq!(count("teapot", 3), 1 + 9);
    assert_eq!(count("room", 1), 9 + 5 + 1);
    assert_eq!(count("sombrero", 1), 1);
}

const SIDE: u32 = 24;

/// A picture, and how many primary rays it took.
fn render(scene: &Scene, sampling: Sampling) -> (Rendered, u64) {
    let workload =
        Workload::new(&scene.mesh, &crate::support::program("pipeline", 1), crate::support::machine().times, &[])
            .unwrap();
    let size = ImageSize { width: SIDE, height: SIDE };
    let picture = Picture {
        scene,
        workload: &workload,
        size,
        sampling,
        limits: Limits::default(),
        screen: None,
        rules: Default::default(),
    };
    let rendered = run::render(&picture, None, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
    let primary = rendered.kinds[0].rays;
    (rendered, primary)
}

/// Two walls of the same material, one before the other and tilted, that meet in an upright line through the picture.
fn walls(second: &str) -> Scene {
    let contents = format!(
        "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\n{second}\
         v 0.09 -9 1\nv 9 -9 3\nv 9 9 3\nv 0.09 9 1\nf 5 6 7 8\n"
    );
    let mut scene = load("walls.obj", &contents);
    // The front wall throws its shadow to where it hides it.
    scene.lights = vec![Light::directional(Vec3::new(-0.3, 0.0, 1.0), Vec3::ONE)];
    scene.camera = Camera { from: Vec3::Z * 20.0, at: Vec3::ZERO, up: Vec3::Y, angle: 10.0 };
    scene
}

#[test]
fn a_silhouette_before_the_same_material_is_refined() {
    let full = Sampling { side: 3, adaptive: None };
    let adaptive = Sampling { side: 3, adaptive: Some(Criterion::Object) };
    let difference = |scene: &Scene| {
        let ((all, _), (few, rays)) = (render(scene, full), render(scene, adaptive));
        let pairs = all.pixels.iter().zip(&few.pixels);
        (pairs.map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max), rays)
    };
    let pixels = u64::from(SIDE * SIDE);
    // Two columns of pixels have a neighbour on the other side of the line, and get nine rays more each.
    let (off, rays) = difference(&walls("o front\n"));
    assert!(off < 1e-6, "{off}");
    assert_eq!(rays, pixels + 2 * u64::from(SIDE) * 9);
    // As one object, the line goes unseen.
    let (off, rays) = difference(&walls(""));
    assert!(off > 0.005, "{off}");
    assert_eq!(rays, pixels);
}

/// Balls of one material before each other: their outlines are what is refined, and as finely as everywhere else.
#[test]
fn outlines_of_balls_before_balls_are_refined() {
    let scene = builtin::generate("balls", Some(2), Some(12)).unwrap();
    let (full, _) = render(&scene, Sampling { side: 4, adaptive: None });
    let (few, rays) = render(&scene, Sampling { side: 4, adaptive: Some(Criterion::Object) });
    let refined = full.pixels.iter().zip(&few.pixels).filter(|(a, b)| a == b).count();
    let extra = (rays - u64::from(SIDE * SIDE)) / 16;
    assert!(
        refined as u64 >= extra && extra > 0,
        "{refined} pixels are those of the full picture, {extra} were refined"
    );
    // Where materials alone are compared, only the outline against floor and sky is found: fewer than a fifth.
    assert!(extra > u64::from(SIDE * SIDE) / 5, "{extra}");
}
