//! Rules that spare tests and rays change no bit of any hit; and what they would change if they were read more widely.

use std::convert::Infallible;

use glam::{DVec3, Vec3};
use pcs_sim::geometry::{Bounds, Edges, Hit, Polygons, Ray};
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::policy::HostRules;
use pcs_sim::host::rules::Rules;
use pcs_sim::host::sampling::Sampling;
use pcs_sim::host::shading::{Limits, RayKind};
use pcs_sim::machine::MachineSpec;
use pcs_sim::program::{ArrayProgram, Spared, Surfaces, Workload};
use pcs_sim::run::{self, Picture, Rendered, Seen, Timed, TreeRay, Watching, Workers};
use pcs_sim::scene::{Camera, Light, Material, Mesh, ReadOptions, Scene, builtin};
use proptest::prelude::*;

use crate::support::command::Folder;
use crate::support::ticking::{self, Ticked};
use crate::support::{bits, glass, machine, program};

pub const NONE: Rules = Rules { own: false, a4b: false, a4c: false };
const OWN: Rules = Rules { own: true, ..NONE };
const A4B: Rules = Rules { a4b: true, ..NONE };
const A4C: Rules = Rules { a4c: true, ..NONE };
const ALL: Rules = Rules { own: true, a4b: true, a4c: true };

/// What an image came to, ray by ray, tree by tree: those that a rule did not send among them, with what it says of their hits.
/// Children are numbered among all.
pub struct Traced {
    pub rendered: Rendered,
    pub rays: Vec<(TreeRay, Hit)>,
}

fn workload(scene: &Scene, program: &ArrayProgram, rules: Rules) -> Workload {
    let workload = Workload::new(&scene.mesh, program, machine().times, &[]).unwrap();
    if rules.own { workload.naming_own() } else { workload }
}

pub fn picture<'a>(scene: &'a Scene, workload: &'a Workload, size: ImageSize, rules: Rules) -> Picture<'a> {
    let (sampling, limits) = (Sampling::default(), Limits { depth: 4, contribution: 0.001 });
    Picture { scene, workload, size, sampling, limits, screen: None, rules }
}

pub fn traced(picture: &Picture<'_>) -> Traced {
    let mut rays = Vec::new();
    let rendered = run::render(picture, None, &Workers::new(2), |seen| {
        if let Seen::Grown(trees, _) = seen {
            let before = rays.len() as u32;
            let numbered = |ray: &TreeRay| TreeRay { children: (before + ray.children.0, ray.children.1), ..*ray };
            rays.extend(trees.rays.iter().map(numbered).zip(trees.traced.hits.iter().copied()));
        }
        Ok::<_, Infallible>(())
    });
    Traced { rendered: rendered.unwrap(), rays }
}

pub fn image(scene: &Scene, program: &ArrayProgram, width: u32, rules: Rules) -> Traced {
    let size = ImageSize { width, height: width * 3 / 4 };
    traced(&picture(scene, &workload(scene, program, rules), size, rules))
}

/// Fails if rays or hits of trees are not the same to the bit. Of a ray that is not sent it must be said truly whether it hits anything.
#[track_caller]
fn hold(plain: &Traced, ruled: &Traced, name: &str) {
    let words = |ray: &Ray| {
        let [o, d] = [ray.origin, ray.direction].map(|v| v.to_array().map(f32::to_bits));
        [o[0], o[1], o[2], d[0], d[1], d[2], ray.t_max.to_bits()]
    };
    assert_eq!(plain.rays.len(), ruled.rays.len(), "{name}");
    for ((ray, hit), (ruled_ray, found)) in plain.rays.iter().zip(&ruled.rays) {
        assert_eq!(words(&ray.ray), words(&ruled_ray.ray), "{name}");
        match ruled_ray.is_sent {
            true => assert_eq!(bits(hit), bits(found), "{name}"),
            false => assert_eq!((ray.kind, hit.is_hit()), (RayKind::Shadow, found.is_hit()), "{name}: {ray:?}"),
        }
    }
    assert!(light(plain) == light(ruled), "{name}");
}

fn light(traced: &Traced) -> Vec<[u32; 3]> {
    traced.rendered.pixels.iter().map(|pixel| pixel.to_array().map(f32::to_bits)).collect()
}

/// Holds the rules against the same without: the same rays in the same trees, the same hits, the same light. Returns what they spared.
fn check(scene: &Scene, program: &ArrayProgram, width: u32, name: &str) -> Spared {
    let plain = image(scene, program, width, NONE);
    let mut spared = Spared::default();
    for rules in [OWN, A4B, A4C, ALL] {
        let name = &format!("{name}, {rules}");
        let ruled = image(scene, program, width, rules);
        hold(&plain, &ruled, name);
        spared = ruled.rendered.counts.spared;
        let unsent =
            |hits: bool| ruled.rays.iter().filter(|(ray, hit)| !ray.is_sent && hit.is_hit() == hits).count() as u64;
        assert_eq!((unsent(false), unsent(true)), (spared.lit_rays, spared.shaded_rays), "{name}");
        assert!((rules.a4b || spared.lit_rays == 0) && (rules.a4c || spared.shaded_rays == 0), "{name}");
        let (before, after) = (plain.rendered.counts, ruled.rendered.counts);
        assert_eq!(before.hits, after.hits + spared.shaded_rays, "{name}");
        if rules == OWN {
            let tests = |counts: &pcs_sim::program::Counts| (counts.slab_tests, counts.intersection_tests);
            let (slabs, intersections) = tests(&after);
            assert_eq!(
                tests(&before),
                (slabs + spared.slab_tests, intersections + spared.intersection_tests),
                "{name}"
            );
        }
    }
    spared
}

#[test]
fn no_rule_changes_a_bit_of_any_built_in_scene() {
    for scene in builtin::all() {
        let made = builtin::generate(scene.name, None, None).unwrap();
        let spared = check(&made, &program("pipeline", 1), 24, scene.name);
        println!("{}: {spared:?}", scene.name);
    }
}

/// The command proves it of an image, too, before it makes it.
#[test]
fn rules_are_checked_where_that_is_asked_for() {
    let folder = Folder::new();
    let image = "image balls --size-factor 2 --size 24x18 -o i.png";
    let told = folder.run(&format!("{image} --rules own+a4b+a4c --check-rules")).success();
    assert!(told.contains("rules own+a4b+a4c: all ") && told.contains("hit as they do without, to the bit"), "{told}");
    let refused = folder.run(&format!("{image} --check-rules --force")).refused();
    assert!(refused.contains("--check-rules has no rules to check"), "{refused}");
}

#[test]
fn nor_of_scenes_in_files_in_any_program() {
    let mut spared = 0;
    for name in ["glass.ron", "everything.ron", "painted.ron", "shapes.nff", "cube.obj"] {
        let path = std::path::Path::new("tests/data").join(name);
        let scene = pcs_sim::scene::load(&path, &ReadOptions::default()).unwrap();
        let stop_words = ArrayProgram { stop_words: Some(3), ..program("hybrid", 3) };
        let mailbox = ArrayProgram { mailbox: true, bounded_walk: true, ..program("broadcast", 4) };
        for program in [program("pipeline", 1), program("broadcast", 5), stop_words, mailbox] {
            spared += check(&scene, &program, 20, name).lit_rays;
        }
    }
    assert!(spared > 0, "some rays are spared");
}

#[test]
fn nor_where_edges_are_closed() {
    let scene = glass();
    let size = ImageSize { width: 20, height: 15 };
    let one = |rules: Rules| {
        let surfaces = Surfaces::with_edges(&scene.mesh, &[], Edges::Closed).into();
        let program = program("broadcast", 3);
        let cancel = Default::default();
        let layout = pcs_sim::program::Layout::new(surfaces, &program, machine().times, Default::default(), &cancel);
        let workload = Workload::of(layout.unwrap().into(), &program, machine().times);
        let workload = if rules.own { workload.naming_own() } else { workload };
        traced(&picture(&scene, &workload, size, rules))
    };
    let plain = one(NONE);
    for rules in [OWN, A4B, A4C, ALL] {
        hold(&plain, &one(rules), &rules.to_string());
    }
}

/// A scene of loose polygons: objects of a few, which may lie in one plane, be slivers, stand through each other, shine and let light
/// through; and lights among them, in planes and corners of theirs, far away, and from directions along axes.
pub fn soup(numbers: &[i8]) -> Scene {
    let mut numbers = numbers.iter().copied().cycle();
    let mut next = || f32::from(numbers.next().unwrap_or(1));
    let mut mesh = Mesh::default();
    for object in 0..6 {
        mesh.begin_object();
        for _ in 0..1 + object % 3 {
            let corner = Vec3::new((next() / 16.0).round(), (next() / 16.0).round(), (next() / 32.0).round());
            let sliver = if next() > 90.0 { 1e-4 } else { 1.0 };
            let (a, b) =
                (Vec3::new(next(), next(), next().signum() * 4.0) / 40.0, Vec3::new(next(), 8.0, next()) / 40.0);
            let points = [corner, corner + a, corner + a + b * sliver, corner + b * sliver];
            let points = points.map(|point| mesh.add_point(point));
            mesh.add_face(&points[..if object % 2 == 0 { 3 } else { 4 }], object % 3);
        }
    }
    let transmittance = if next() > 0.0 { 0.5 } else { 0.0 };
    let through = Material { transmittance, refraction: 1.2, ..Material::default() };
    let mirror = Material { specular: 0.6, ..Material::default() };
    let white = Vec3::ONE;
    let lights = vec![
        Light::point(mesh.points[0], white),
        Light::point((mesh.points[4] + mesh.points[5]) / 2.0, white),
        Light::point(Vec3::new(next() / 16.0, next() / 16.0, next() / 16.0), white),
        Light::point(Vec3::new(3e5, 2e5, 1e5), white),
        Light::directional(Vec3::Z, white),
        Light::directional(Vec3::new(next(), next(), next() + 0.5), white),
    ];
    Scene {
        name: "soup".to_owned(),
        mesh,
        materials: vec![Material::default(), through, mirror],
        lights,
        background: Vec3::splat(0.1),
        camera: Camera { from: Vec3::new(0.5, -20.0, 3.0), at: Vec3::ZERO, up: Vec3::Z, angle: 50.0 },
        notes: Vec::new(),
        solids: Vec::new(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn nor_of_loose_polygons_in_any_light(numbers in prop::collection::vec(any::<i8>(), 60..200)) {
        check(&soup(&numbers), &program("broadcast", 2), 16, "soup");
    }
}

/// The array at work sends just what is sent, and is timed as ticking its ops gives it; RAY has a word more for its own polygon.
#[test]
fn rays_that_are_not_sent_take_no_time() {
    let scene = glass();
    let size = ImageSize { width: 12, height: 9 };
    let run = |rules: Rules| {
        let workload = workload(&scene, &program("broadcast", 3), rules);
        let picture = picture(&scene, &workload, size, rules);
        let spec = &MachineSpec::default();
        let timed = Timed { spec, rules: HostRules::default(), watching: Watching::default() };
        let mut batches = Vec::new();
        let rendered = run::render(&picture, Some(timed), &Workers::new(2), |seen| {
            if let Seen::Sent(ops, ..) = seen {
                batches.push(ops.clone());
            }
            Ok::<_, Infallible>(())
        });
        let rendered = rendered.unwrap();
        let stats = &rendered.timing.as_ref().unwrap().stats;
        assert_eq!(Ticked::from(stats), ticking::run(spec, workload.costs(), &batches).unwrap());
        let rays: u64 = rendered.kinds.iter().map(|kind| kind.rays).sum();
        assert_eq!((rays, batches.len() as u64), (stats.jobs, rays));
        let words = if rules.own { 9 } else { 8 };
        assert_eq!(crate::support::fifo(stats, "X0").words.0, words * rays);
        rendered
    };
    let plain = run(NONE);
    for rules in [OWN, A4B, A4C, ALL] {
        let ruled = run(rules);
        assert_eq!(plain.pixels, ruled.pixels);
        let spared = ruled.counts.spared;
        let jobs = |rendered: &Rendered| rendered.timing.as_ref().unwrap().stats.jobs;
        assert_eq!(jobs(&plain), jobs(&ruled) + spared.lit_rays + spared.shaded_rays);
        assert_eq!((spared.slab_tests > 0, spared.lit_rays > 0), (rules.own, rules.a4b), "{rules}");
        assert_eq!(spared.shaded_rays, 0, "glass lets light through");
    }
}

#[test]
fn what_rules_spared_is_in_the_statistics_and_rules_are_a_parameter_everywhere() {
    let folder = Folder::new();
    let run = "image gears --size 20x15 -o i.png --force --stats s.json";
    folder.run(&format!("{run} --rules own+a4b")).success();
    let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
    assert_eq!(stats["configuration"]["image"]["rules"], "own+a4b");
    for (rule, count) in [("own", "slab_tests"), ("own", "intersection_tests"), ("a4b", "rays_not_sent")] {
        assert!(stats["rules"][rule][count].as_u64() > Some(0), "{rule} {count}");
    }
    let first = std::fs::read(folder.path("i.png")).unwrap();
    folder.run("image --config s.json -o again.png --stats again.json").success();
    assert_eq!(folder.read("s.json"), folder.read("again.json"));
    folder.run(run).success();
    assert!(first == std::fs::read(folder.path("i.png")).unwrap());
    let plain: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
    assert!(plain.get("rules").is_none() && plain["configuration"]["image"].get("rules").is_none());

    folder.file("s.ron", "(scene: \"room\", size: \"8x6\", image: true, rules: [\"none\", \"own+a4b\"])");
    folder.run("sweep s.ron -o t.csv").success();
    let table = folder.read("t.csv");
    assert!(table.contains(",none,") && table.contains(",own+a4b,"), "{table}");
}

#[test]
fn rules_that_there_are_not_and_runs_without_any_are_told() {
    let folder = Folder::new();
    let refused = folder.run("image room -o i.png --rules a3").refused();
    assert!(refused.contains("there is no rule 'a3'"), "{refused}");
    let refused = folder.run("image room -o i.png --rules a4c --hits h.csv").refused();
    assert!(refused.contains("--hits"), "{refused}");
    let refused = folder.run("image room -o i.png --rules own --timing off").refused();
    assert!(refused.contains("--rules is about the machine at work"), "{refused}");
    let refused = folder.run("image room --size 4x3 -o i.png --rules own --cells-run programs").refused();
    assert!(refused.contains("know nothing of polygons that rays start on"), "{refused}");
    assert_eq!(folder.names(), [""; 0]);
}

/// The walls of a room shade most of what is outside; in a scene without glass that is told without sending a ray.
#[test]
fn large_polygons_shade_for_certain() {
    let mut scene = panes();
    scene.materials.iter_mut().for_each(|material| material.transmittance = 0.0);
    scene.lights = vec![Light::point(Vec3::new(0.0, 20.0, 0.0), Vec3::ONE), Light::directional(Vec3::Y, Vec3::ONE)];
    scene.camera.from = Vec3::new(0.5, 2.0, 0.3);
    let plain = image(&scene, &program("pipeline", 1), 24, NONE);
    let ruled = image(&scene, &program("pipeline", 1), 24, A4C);
    hold(&plain, &ruled, "panes");
    assert!(ruled.rendered.counts.spared.shaded_rays > 0, "{:?}", ruled.rendered.counts);
}

/// The rays that leave a polygon of an object and hit another polygon of the same object, by kind.
fn hits_of_own_object(scene: &Scene, traced: &Traced, kind: RayKind) -> usize {
    let object = |hit: &Hit| scene.mesh.object(&scene.mesh.faces()[hit.polygon as usize]).number();
    let mut count = 0;
    for (ray, hit) in &traced.rays {
        let (first, more) = ray.children;
        let children = &traced.rays[first as usize..][..more as usize];
        let is_own = |(child, of): &&(TreeRay, Hit)| child.kind == kind && of.is_hit() && object(of) == object(hit);
        count += children.iter().filter(is_own).count();
    }
    count
}

/// A1, A4a, counter-example: read for an object of many polygons, they lose hits. The handle of a teapot shades its body, and a gear's
/// tooth the next one.
#[test]
fn objects_of_many_polygons_hit_themselves() {
    let gears = builtin::generate("gears", None, None).unwrap();
    let traced = image(&gears, &program("pipeline", 1), 24, NONE);
    assert!(hits_of_own_object(&gears, &traced, RayKind::Shadow) > 0);
    let teapot = builtin::generate("teapot", None, None).unwrap();
    let traced = image(&teapot, &program("pipeline", 1), 48, NONE);
    let own = |kind| hits_of_own_object(&teapot, &traced, kind);
    assert!(own(RayKind::Shadow) + own(RayKind::Reflected) > 0);
}

/// Two panes of glass in one object, one behind the other: a ring of glass has such, seen from its side.
pub fn panes() -> Scene {
    let mut scene = soup(&[1]);
    scene.mesh = Mesh::default();
    scene.mesh.begin_object();
    for y in [0.0, 4.0] {
        let points =
            [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(|(x, z)| scene.mesh.add_point(Vec3::new(x, y, z)));
        scene.mesh.add_face(&points, 1);
    }
    scene.mesh.begin_object();
    let points = [(-3.0, -3.0), (3.0, -3.0), (0.0, 3.0)].map(|(x, z)| scene.mesh.add_point(Vec3::new(x, 9.0, z)));
    scene.mesh.add_face(&points, 0);
    scene.lights.truncate(1);
    scene
}

/// A2, counter-example: a ray that leaves an object through one of its polygons enters it again through another.
#[test]
fn light_that_leaves_an_object_may_enter_it_again() {
    let scene = panes();
    let traced = image(&scene, &program("pipeline", 1), 8, NONE);
    assert!(hits_of_own_object(&scene, &traced, RayKind::Refracted) > 0);
}

/// A4c, counter-example: a cone inscribed in an object's *box* holds points that the object does not shade: half of a right triangle's
/// box is empty.
#[test]
fn a_cone_inscribed_in_a_box_is_not_all_in_the_shadow() {
    let mut mesh = Mesh::default();
    let points = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| mesh.add_point(Vec3::new(x, y, 1.0)));
    mesh.add_face(&points, 0);
    let polygons = Polygons::new(&mesh);
    let light = Vec3::new(0.5, 0.5, 0.0);
    let point = light + Vec3::new(0.2, 0.2, 1.0) * 2.0;
    // The cone's axis leads to the middle of the box, its angle to the middle of a side.
    let (axis, angle) = (Vec3::Z, 0.5f32.atan());
    assert!((point - light).angle_between(axis) < angle);
    let to_light = Ray { t_max: 1.0, ..Ray::new(point, light - point) };
    assert!(polygons.intersect(&to_light, 0, f32::INFINITY).is_none(), "and yet it is in the light");
}

/// A4c, counter-example: what lets light through filters it. A point behind it is in no shadow.
#[test]
fn behind_glass_is_no_shadow() {
    let mut scene = panes();
    scene.lights = vec![Light::point(Vec3::new(0.0, -12.0, 0.0), Vec3::ONE)];
    let traced = image(&scene, &program("pipeline", 1), 12, NONE);
    let shaded = |(ray, hit): &&(TreeRay, Hit)| ray.kind == RayKind::Shadow && hit.is_hit() && ray.children.1 > 0;
    assert!(traced.rays.iter().any(|ray| shaded(&ray)), "light goes on behind a blocker");
}

/// A5, counter-example: if the zone that a ray comes to is taken to be the next one, what it hits behind that is lost.
#[test]
fn the_next_region_need_not_be_the_last() {
    let region = |x: f64| Bounds { low: DVec3::new(x, 0.0, 0.0), high: DVec3::new(x + 1.0, 1.0, 1.0) };
    let segment = region(0.0).union(region(1.0));
    let object = Bounds { low: DVec3::new(2.5, 0.2, 0.2), high: DVec3::new(2.6, 0.8, 0.8) };
    assert!(segment.intersection(object).is_empty(), "the rule would not look at it");
    assert!(object.entered_by(&Ray::new(Vec3::new(0.5, 0.5, 0.5), Vec3::X)).is_some());
    // With the box of all that lies in the ray's octant it is found.
    let all = Bounds { low: DVec3::new(0.5, 0.5, 0.5), high: DVec3::new(3.0, 1.0, 1.0) };
    assert!(!all.intersection(object).is_empty());
}
