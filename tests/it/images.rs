//! Whole images: right as an independent path has them, the same bits whatever makes them, and timed as the host's rules
//! say.

use std::convert::Infallible;
use std::path::Path;

use crate::support::command::Folder;
use crate::support::ticking::{self, Ticked};
use crate::support::whitted::Judge;
use crate::support::{fifo, glass, spent};
use glam::{DVec3, Vec3};
use pcs_sim::geometry::{Polygons, Ray, brute_force};
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::policy::{HostRules, Policy};
use pcs_sim::host::sampling::{Criterion, Sampling};
use pcs_sim::host::shading::{Branch, Limits, RayKind, Shader, reflect, refract};
use pcs_sim::machine::{Cycles, KernelTimes, MachineFile, MachineSpec, Words};
use pcs_sim::program::{Counts, Workload};
use pcs_sim::run::{self, KindCounts, Picture, Rendered, Seen, Timed, Timing, Watching, Workers};
use pcs_sim::scene::{Material, Mesh, ReadOptions, Scene, builtin};
use pcs_sim::seam::{OpBatch, OpKind};

const POLICIES: [Policy; 3] = [Policy::SecondariesFirst, Policy::PrimariesFirst, Policy::ByGeneration];

fn workload(scene: &Scene, program: &str, groups: usize, times: KernelTimes) -> Workload {
    Workload::new(&scene.mesh, &crate::support::program(program, groups), times, &[]).unwrap()
}

fn picture<'a>(scene: &'a Scene, workload: &'a Workload, width: u32, sampling: Sampling) -> Picture<'a> {
    let size = ImageSize { width, height: width * 3 / 4 };
    Picture { scene, workload, size, sampling, limits: Limits::default(), screen: None, rules: Default::default() }
}

fn plain(side: u32) -> Sampling {
    Sampling { side, adaptive: None }
}

fn untimed(picture: &Picture, threads: usize) -> Rendered {
    run::render(picture, None, &Workers::new(threads), |_| Ok::<_, Infallible>(())).unwrap()
}

/// A timed image, and the ops that the host and the cells did.
fn timed(picture: &Picture, spec: &MachineSpec, rules: HostRules) -> (Rendered, Vec<OpBatch>) {
    let mut batches = Vec::new();
    let rendered =
        run::render(picture, Some(Timed { spec, rules, watching: Watching::default() }), &Workers::new(2), |seen| {
            if let Seen::Sent(ops, ..) = seen {
                batches.push(ops.clone());
            }
            Ok::<_, Infallible>(())
        });
    (rendered.unwrap(), batches)
}

fn timing(rendered: Rendered) -> Timing {
    rendered.timing.unwrap()
}

/// A host that takes its time.
fn slow_host() -> KernelTimes {
    let mut times = crate::support::machine().times;
    times.host.ray = Cycles(700);
    times.host.hit = Cycles(1900);
    times
}

fn encoded(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    255.0 * if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Holds an image against the judge's: 99.9 % of the pixels must be the same within one step of 255.
fn judged(scene: &Scene, width: u32, side: u32) {
    let workload = workload(scene, "broadcast", 2, crate::support::machine().times);
    let picture = picture(scene, &workload, width, plain(side));
    let ours = untimed(&picture, 2).pixels;
    let judge = Judge::new(scene).image(picture.size, side);
    let same = |(ours, judge): (&Vec3, &DVec3)| {
        let (ours, judge) = (ours.as_dvec3().to_array().map(encoded), judge.to_array().map(encoded));
        ours.iter().zip(judge).all(|(a, b)| (a - b).abs() <= 1.0)
    };
    let differing = ours.iter().zip(&judge).filter(|pair| !same(*pair)).count();
    assert!(differing * 1000 <= ours.len(), "{}: {differing} of {} pixels differ", scene.name, ours.len());
}

#[test]
fn equal_an_independent_tracer_in_double_precision() {
    judged(&glass(), 120, 1);
    judged(&glass(), 60, 2);
    judged(&pcs_sim::scene::load(Path::new("tests/data/painted.ron"), &ReadOptions::default()).unwrap(), 100, 1);
    judged(&builtin::generate("room", None, None).unwrap(), 160, 1);
    judged(&builtin::generate("balls", Some(1), Some(12)).unwrap(), 80, 1);
    judged(&builtin::generate("teapot", Some(3), None).unwrap(), 80, 1);
    let unlit = Scene { lights: Vec::new(), ..builtin::generate("tetra", Some(3), None).unwrap() };
    judged(&unlit, 100, 1);
}

#[test]
fn do_not_depend_on_mode_cells_threads_policy_or_timing() {
    let scene = glass();
    for sampling in [plain(2), Sampling { side: 3, adaptive: Some(Criterion::Object) }] {
        let pipeline = workload(&scene, "pipeline", 1, crate::support::machine().times);
        let reference = untimed(&picture(&scene, &pipeline, 40, sampling), 1);
        for (program, groups) in [("pipeline", 1), ("broadcast", 1), ("broadcast", 5), ("hybrid", 3), ("hybrid-3", 2)] {
            let workload = workload(&scene, program, groups, slow_host());
            let picture = picture(&scene, &workload, 40, sampling);
            assert!(untimed(&picture, 3).pixels == reference.pixels, "{program} {groups}");
            for policy in POLICIES {
                let rules = HostRules { policy, in_flight: Some(7), open_samples: 10, ..HostRules::default() };
                let (rendered, _) = timed(&picture, &MachineSpec::default(), rules);
                assert!(rendered.pixels == reference.pixels, "{program} {groups} {policy:?}");
                let rays = |rendered: &Rendered| rendered.kinds.map(|kind| (kind.rays, kind.hits));
                assert_eq!(rays(&rendered), rays(&reference));
            }
        }
    }
}

#[test]
fn timing_in_a_closed_loop_is_what_ticking_its_ops_gives() {
    let scene = glass();
    let narrow = MachineSpec { fifo_words: pcs_sim::machine::Words(40), ..MachineSpec::default() };
    for (program, groups) in [("pipeline", 1), ("broadcast", 3), ("hybrid", 2)] {
        for times in [crate::support::machine().times, slow_host()] {
            let workload = workload(&scene, program, groups, times);
            let refined = (Policy::ByGeneration, Sampling { side: 2, adaptive: Some(Criterion::Object) });
            for (policy, sampling) in POLICIES.map(|policy| (policy, plain(1))).into_iter().chain([refined]) {
                let picture = picture(&scene, &workload, 6, sampling);
                for (in_flight, open_samples) in [(None, 1024), (Some(2), 3)] {
                    let rules = HostRules { policy, in_flight, open_samples, ..HostRules::default() };
                    let (rendered, batches) = timed(&picture, &narrow, rules);
                    let stats = timing(rendered).stats;
                    let ticked = ticking::run(&narrow, workload.costs(), &batches).unwrap();
                    assert_eq!(Ticked::from(&stats), ticked, "{program} {rules:?}");
                }
            }
        }
    }
}

#[test]
fn a_ray_is_sent_after_its_parents_hit_and_never_more_than_may_be_in_flight() {
    let scene = glass();
    let workload = workload(&scene, "pipeline", 1, slow_host());
    let picture = picture(&scene, &workload, 16, plain(1));
    let one = HostRules { in_flight: Some(1), ..HostRules::default() };
    let (rendered, batches) = timed(&picture, &MachineSpec::default(), one);
    let secondaries = rendered.kinds[1..].iter().map(|kind| kind.rays).sum::<u64>();
    let waits = |batch: &&OpBatch| batch.host.ops().iter().any(|op| op.kind() == OpKind::Await);
    assert!(batches.iter().filter(waits).count() as u64 >= secondaries, "every secondary ray waits for its parent");
    // One ray at a time: each waits for the one before it, so no FIFO ever holds words of two.
    let alone = timing(rendered).stats;
    let x0 = fifo(&alone, "X0");
    assert!(x0.max.0 <= 8, "{x0:?}");
    let (free, _) = timed(&picture, &MachineSpec::default(), HostRules::default());
    assert!(timing(free).stats.cycles < alone.cycles);
}

/// The row below a pixel has come back when its refined samples are sent, but the array does not run empty between the
/// two passes.
#[test]
fn refined_samples_wait_for_what_asks_for_them_and_for_no_more() {
    let scene = glass();
    let workload = workload(&scene, "pipeline", 1, crate::support::machine().times);
    let picture = picture(&scene, &workload, 40, Sampling { side: 2, adaptive: Some(Criterion::Object) });
    let pixels = picture.size.pixels();
    for (policy, open_samples) in [(Policy::SecondariesFirst, 64), (Policy::PrimariesFirst, 10_000)] {
        let rules = HostRules { policy, open_samples, ..HostRules::default() };
        let (rendered, batches) = timed(&picture, &MachineSpec::default(), rules);
        let waits = |batch: &&OpBatch| batch.host.ops().iter().any(|op| op.kind() == OpKind::Await);
        assert!(batches.iter().filter(waits).count() >= batches.len() - pixels, "only a first pass waits for nothing");
        if policy == Policy::PrimariesFirst {
            assert_eq!(batches[..pixels].iter().filter(waits).count(), 0, "all of them may be sent at once");
        }
        let stats = timing(rendered).stats;
        assert_eq!(spent(&stats, 0, "waiting X"), 1, "from the second cycle on the first cell has rays to read");
    }
}

#[test]
fn latencies_and_counts_by_kind_add_up() {
    let scene = glass();
    let workload = workload(&scene, "pipeline", 1, crate::support::machine().times);
    let picture = picture(&scene, &workload, 32, plain(1));
    let (rendered, batches) = timed(&picture, &MachineSpec::default(), HostRules::default());
    let timing = rendered.timing.unwrap();
    let sum = |of: fn(&run::KindCounts) -> u64| rendered.kinds.iter().map(of).sum::<u64>();
    assert_eq!(sum(|kind| kind.rays), timing.stats.jobs);
    assert_eq!(sum(|kind| kind.rays), batches.len() as u64);
    assert_eq!(sum(|kind| kind.hits), rendered.counts.hits);
    assert_eq!(sum(|kind| kind.busy), {
        let busy = |cell| timing.stats.topology.states.by_activity(cell).map(|(_, cycles)| cycles.0).sum::<u64>();
        timing.stats.stations.iter().map(busy).sum::<u64>()
    });
    assert_eq!(rendered.kinds[0].rays, picture.size.pixels() as u64);
    assert!(rendered.kinds.iter().all(|kind| kind.rays > 0), "the scene has all kinds");
    for latencies in &timing.latencies {
        let [least, middle, most] = [0, 50, 100].map(|percent| latencies.percentile(percent).0);
        // At the least the ray's words travel, the grid starts (600 cycles), and 5 words come back.
        assert!(least > 600 && least <= middle && middle <= most);
        assert!((least as f64) <= latencies.mean() && latencies.mean() <= most as f64);
    }
}

/// A ray's latency is one thing, whoever tells of it: what the profile counts are the latencies of all kinds.
#[test]
fn latencies_of_kinds_are_those_of_the_profile() {
    let scene = glass();
    for (program, groups, fifo_words) in [("pipeline", 1, 512), ("broadcast", 3, 16), ("pipeline", 1, 1)] {
        let workload = workload(&scene, program, groups, crate::support::machine().times);
        let picture = picture(&scene, &workload, 16, plain(1));
        let spec = &MachineSpec { fifo_words: Words(fifo_words), ..MachineSpec::default() };
        let watching = Watching { profile: true, ..Watching::default() };
        let timed = Timed { spec, rules: HostRules::default(), watching };
        let rendered = run::render(&picture, Some(timed), &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap();
        let Timing { latencies, observed, .. } = rendered.timing.unwrap();
        let profile = observed.profile.unwrap().latency;
        let of_kinds = || latencies.iter().zip(&rendered.kinds).filter(|(_, kind)| kind.rays > 0);
        let total: f64 = of_kinds().map(|(kind, counts)| kind.mean() * counts.rays as f64).sum();
        assert_eq!(profile.jobs, rendered.kinds.iter().map(|kind| kind.rays).sum::<u64>());
        assert_eq!(of_kinds().map(|(kind, _)| kind.percentile(0)).min(), Some(profile.min));
        assert_eq!(of_kinds().map(|(kind, _)| kind.percentile(100)).max(), Some(profile.max));
        assert!((total / profile.total as f64 - 1.0).abs() < 1e-12, "{total} {}", profile.total);
    }
}

#[test]
fn refraction_is_snells() {
    let normal = DVec3::Z;
    for degrees in [0.0f64, 1.0, 17.0, 45.0, 80.0, 89.9] {
        let angle = degrees.to_radians();
        let direction = DVec3::new(angle.sin(), 0.0, -angle.cos());
        for ratio in [1.0 / 1.5, 1.5, 1.0, 0.4, 2.4] {
            let sine: f64 = ratio * angle.sin();
            let bent = refract(direction, normal, ratio);
            assert_eq!(bent.is_some(), sine < 1.0, "critical angle: {degrees} degrees, {ratio}");
            let Some(bent) = bent else { continue };
            assert!((bent - DVec3::new(sine, 0.0, -sine.asin().cos())).length() < 1e-12, "{degrees} degrees, {ratio}");
        }
        assert!((reflect(direction, normal) - DVec3::new(angle.sin(), 0.0, angle.cos())).length() < 1e-15);
    }
}

/// A scene of one glass box from -1 to 1 (in z from 0 to `height`).
fn glass_box(height: f32, refraction: f32) -> Scene {
    let mut mesh = Mesh::default();
    let corner =
        |i: u32| Vec3::new((i & 1) as f32 * 2.0 - 1.0, (i >> 1 & 1) as f32 * 2.0 - 1.0, (i >> 2) as f32 * height);
    let points: Vec<u32> = (0..8).map(|i| mesh.add_point(corner(i))).collect();
    for side in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [3, 2, 6, 7], [2, 0, 4, 6], [1, 3, 7, 5]] {
        mesh.add_face(&side.map(|i: usize| points[i]), 0);
    }
    let material = Material { color: Vec3::ONE, diffuse: 0.0, transmittance: 0.9, refraction, ..Material::default() };
    Scene { mesh, materials: vec![material], ..builtin::generate("room", None, None).unwrap() }
}

/// The ray of a kind that a ray's first hit asks for.
fn next(scene: &Scene, polygons: &Polygons, branch: &Branch, kind: RayKind) -> Option<Branch> {
    let shader = Shader::new(scene, polygons, Limits { depth: 9, contribution: 0.0 });
    let mut found = None;
    shader.shade(branch, &brute_force(polygons, &branch.ray), |child| {
        if child.kind == kind {
            found = Some(child);
        }
    });
    found
}

#[test]
fn a_pane_of_glass_shifts_light_by_the_closed_form() {
    let (height, index, angle) = (0.5, 1.5, 50f64.to_radians());
    let scene = glass_box(height, index as f32);
    let polygons = Polygons::new(&scene.mesh);
    let direction = DVec3::new(angle.sin(), 0.0, -angle.cos());
    let enters = DVec3::new(-0.3, 0.1, height as f64);
    let into = Branch::primary(Ray::new((enters - direction).as_vec3(), direction.as_vec3()));
    let inside = next(&scene, &polygons, &into, RayKind::Refracted).unwrap();
    let out = next(&scene, &polygons, &inside, RayKind::Refracted).unwrap();
    assert!((out.ray.direction.as_dvec3() - direction).length() < 1e-6);
    assert!((out.weight - DVec3::splat(0.81)).length() < 1e-6);
    let bent = (angle.sin() / index).asin();
    let shift = height as f64 * (angle - bent).sin() / bent.cos();
    let beside = (out.ray.origin.as_dvec3() - enters).reject_from(direction).length();
    assert!((beside - shift).abs() < 1e-4, "{beside} for {shift}");
}

#[test]
fn glass_reflects_all_light_beyond_the_critical_angle() {
    let scene = glass_box(2.0, 1.5);
    let polygons = Polygons::new(&scene.mesh);
    let critical = (1.0f64 / 1.5).asin();
    for (angle, total) in [(critical - 1e-3, false), (critical + 1e-3, true)] {
        let direction = Vec3::new(angle.sin() as f32, 0.0, angle.cos() as f32);
        let up = Branch::primary(Ray::new(Vec3::new(-0.5, 0.2, 1.0), direction));
        let refracted = next(&scene, &polygons, &up, RayKind::Refracted);
        let reflected = next(&scene, &polygons, &up, RayKind::Reflected);
        assert_eq!(refracted.is_none(), total);
        // No share is specular: the mirrored ray carries just what could not pass.
        assert_eq!(reflected.map_or(0.0, |ray| ray.weight.x), if total { 0.9f32 as f64 } else { 0.0 });
        assert!(reflected.is_none_or(|ray| (ray.ray.direction.z + direction.z).abs() < 1e-6));
    }
}

#[test]
fn the_recorded_trace_replays_to_the_same_stats() {
    let folder = Folder::new();
    let scene = std::fs::canonicalize("tests/data/glass.ron").unwrap();
    for flags in
        ["", "--mode broadcast --cells 4 --policy primaries", "--in-flight 3 --host-ray-us 20 --host-hit-us 95.5"]
    {
        let run = format!("image {} --size 20x15 --force -o i.png --ops a.ops --stats run.json", scene.display());
        folder.run(&format!("{run} {flags}")).success();
        folder.run("replay a.ops --stats replay.json --force").success();
        let json = |name: &str| serde_json::from_str::<serde_json::Value>(&folder.read(name)).unwrap();
        let mut expected = json("run.json");
        for scenes in ["counts", "messages", "configuration", "rays_by_kind"] {
            assert!(expected.as_object_mut().unwrap().remove(scenes).is_some());
        }
        let mut replayed = json("replay.json");
        assert!(replayed.as_object_mut().unwrap().remove("configuration").is_some());
        assert_eq!(replayed, expected, "{flags}");
    }
}

#[test]
fn a_sun3_differs_from_the_standard_machine_by_its_time_alone() {
    let standard = MachineFile::standard().unwrap();
    let sun3 = MachineFile::read(Path::new("pcs-programs/pcs-sun3.ron")).unwrap();
    assert_eq!(MachineFile { host_hit_us: 20000.0, ..standard }, sun3);
    assert_eq!(sun3.build().unwrap().times.host.hit, Cycles(400_000));
}

#[test]
fn the_command_writes_the_same_picture_with_and_without_timing() {
    let folder = Folder::new();
    let common = "image room --size 24x16 --samples 2";
    let summary = folder.run(&format!("{common} -o a.png --hits h.csv --threads 1")).success();
    assert!(summary.ends_with("wrote a.png\nwrote h.csv\n"), "{summary}");
    folder.run(&format!("{common} -o b.png --timing off --threads 2")).success();
    folder.run(&format!("{common} -o c.pfm --timing off --mode broadcast")).success();
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert_eq!(bytes("a.png"), bytes("b.png"));
    assert!(bytes("c.pfm").starts_with(b"PF\n24 16\n-1.0\n"));
    assert_eq!(bytes("c.pfm").len(), 14 + 24 * 16 * 12);
    assert!(folder.read("h.csv").lines().count() > 24 * 16 * 4);
    folder.run("image room -o a.jpg").refused();
    folder.run("image room -o d.png --timing off --ops a.ops").refused();
    folder.run("image room -o d.png --in-flight 0").refused();
}

/// Lines that are made apart are those of the whole image, and their counts add up to its counts.
#[test]
fn an_image_is_its_lines_wherever_it_is_cut() {
    let scene = glass();
    let workload = workload(&scene, "broadcast", 3, crate::support::machine().times);
    for (sampling, threads) in
        [(plain(1), 1), (plain(3), 2), (Sampling { side: 4, adaptive: Some(Criterion::Object) }, 2)]
    {
        let picture = picture(&scene, &workload, 20, sampling);
        let whole = untimed(&picture, 1);
        for cuts in [&[0, 15][..], &[0, 1, 2, 9, 15], &[0, 7, 14, 15]] {
            let (mut pixels, mut counts, mut kinds) =
                (Vec::new(), Counts::default(), whole.kinds.map(|_| Default::default()));
            for cut in cuts.windows(2) {
                let workers = &Workers::new(threads);
                let lines = run::render_lines(&picture, cut[0]..cut[1], workers, |_| Ok::<_, Infallible>(())).unwrap();
                pixels.extend_from_slice(&lines.pixels[cut[0] as usize * 20..cut[1] as usize * 20]);
                counts += lines.counts;
                kinds.iter_mut().zip(lines.kinds).for_each(|(all, new): (&mut KindCounts, _)| *all += new);
            }
            assert!(
                (pixels, counts, kinds) == (whole.pixels.clone(), whole.counts, whole.kinds),
                "{sampling:?} {cuts:?}"
            );
        }
    }
}
