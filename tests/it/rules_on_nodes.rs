//! Rules that spare tests and rays on the nodes of a hypercube: they change no bit there either.

use std::convert::Infallible;

use pcs_sim::geometry::Hit;
use pcs_sim::host::shading::RayKind;
use pcs_sim::run::{CubeRunOptions, CubeScene, CubeSpec, Found, Workers};
use pcs_sim::scene::builtin;

use crate::support::bits;
use crate::support::command::Folder;

/// What nodes have to do for a small image of a scene.
fn laid_out(scene: &str, parameters: &[(&str, &str)], rules: &str) -> CubeScene {
    let mut options = CubeRunOptions::default();
    let all = [("scene", scene), ("size", "24x18"), ("nodes", "6"), ("sub_sample", "20"), ("rules", rules)];
    all.iter().chain(parameters).for_each(|(name, value)| options.set(name, value).unwrap());
    let spec = CubeSpec::new(&options, None).unwrap();
    spec.lay_out(true, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap()
}

fn light(scene: &CubeScene) -> Vec<[u32; 3]> {
    scene.pixels.iter().map(|pixel| pixel.to_array().map(f32::to_bits)).collect()
}

/// All rays of a kind, or all but those, with their hits' bits.
fn hits(scene: &CubeScene, is_shadow: bool) -> Vec<(u32, u8, [u32; 4])> {
    let Found { hits, .. } = scene.found.as_ref().unwrap();
    let rays = scene.graph.rays.iter().zip(hits);
    let of_kind = rays.filter(|(ray, _)| (ray.kind == RayKind::Shadow) == is_shadow);
    of_kind.map(|(ray, hit): (_, &Hit)| (ray.tree, ray.turns, bits(hit))).collect()
}

/// Tests of all legs, against slabs and for intersection.
fn tests(scene: &CubeScene) -> (u64, u64) {
    let legs = scene.graph.legs.iter();
    legs.fold((0, 0), |(slabs, tests), leg| {
        (slabs + u64::from(leg.slab_tests), tests + u64::from(leg.intersection_tests))
    })
}

/// Holds an image by each rule against the same without. Returns how many tests were spared, and rays.
fn check(scene: &str, parameters: &[(&str, &str)]) -> (u64, u64) {
    let plain = laid_out(scene, parameters, "none");
    assert_eq!(plain.spared, Default::default());
    let (all, shadows) = (plain.graph.rays.len() as u64, hits(&plain, true));
    let mut spared_in_all = (0, 0);
    for rules in ["own", "a4b", "a4c", "own+a4b+a4c"] {
        let name = format!("{scene} {parameters:?} {rules}");
        let ruled = laid_out(scene, parameters, rules);
        let spared = ruled.spared;
        ruled.graph.check().unwrap();
        assert!(light(&plain) == light(&ruled), "{name}");
        assert!(hits(&plain, false) == hits(&ruled, false), "{name}");
        assert_eq!(all, ruled.graph.rays.len() as u64 + spared.lit_rays + spared.shaded_rays, "{name}");
        // The shadow rays that are left have their hits; those that are not met nothing, or something.
        let mut left = hits(&ruled, true).into_iter().peekable();
        let missing: Vec<_> = shadows.iter().filter(|ray| left.next_if_eq(ray).is_none()).collect();
        assert!(left.next().is_none(), "{name}: all that are left are there without rules, in that order");
        let does_hit = missing.iter().filter(|(.., hit)| hit[1] != Hit::NO_POLYGON).count() as u64;
        assert_eq!((missing.len() as u64 - does_hit, does_hit), (spared.lit_rays, spared.shaded_rays), "{name}");
        assert_eq!(
            ruled.graph.ray_bytes(),
            plain.graph.ray_bytes() + if rules.contains("own") { 4 } else { 0 },
            "{name}"
        );
        // Regions are cut by what the sub-sample takes by these rules: where a leg looks at all again, its tests depend on that.
        let is_same_work = |(_, value): &(&str, &str)| !["own", "pyramids"].contains(value);
        if rules == "own" && (parameters.iter().all(is_same_work) || parameters.contains(&("nodes", "1"))) {
            let ((slabs, intersections), left) = (tests(&plain), tests(&ruled));
            assert_eq!(
                (slabs - left.0, intersections - left.1),
                (spared.slab_tests, spared.intersection_tests),
                "{name}"
            );
        }
        spared_in_all = (spared.slab_tests, spared.lit_rays + spared.shaded_rays);
    }
    spared_in_all
}

#[test]
fn no_rule_changes_a_bit_of_any_image() {
    for scene in builtin::all() {
        check(scene.name, &[]);
    }
}

#[test]
fn nor_in_grids_of_their_own_nor_in_pyramids_nor_in_a_shared_memory() {
    let ways: [&[(&str, &str)]; 7] = [
        &[("grids", "own")],
        &[("grids", "own"), ("nodes", "1")],
        &[("cell_cuts", "pyramids"), ("nodes", "1")],
        &[("cell_cuts", "pyramids")],
        &[("cell_cuts", "quantiles"), ("samples", "2")],
        &[("mode", "shared-memory")],
        &[("depth", "2"), ("nodes", "1")],
    ];
    for way in ways {
        let (tests, rays) = check("gears", way);
        assert!(tests > 0 && rays > 0, "{way:?}");
    }
    // Polygons that an eye outside of the scene's margin looks at: rays that have strayed.
    check("sombrero", &[("grids", "own"), ("size_factor", "2")]);
}

/// The command says so, with messages that are a word longer; recorded tasks go by what they were recorded by.
#[test]
fn nodes_go_by_rules() {
    let folder = Folder::new();
    let stats = |args: &str| {
        let size = "--size 24x18 --nodes 4 --stats s.json --force";
        folder.run(&format!("{args} {size}")).success();
        serde_json::from_str::<serde_json::Value>(&folder.read("s.json")).unwrap()
    };
    let plain = stats("image gears --on ipsc2 -o plain.png --tasks plain.tasks");
    let ruled = stats("image gears --on ipsc2 -o ruled.png --tasks ruled.tasks --rules own+a4b");
    assert!(plain.get("rules").is_none() && plain["configuration"].get("rules").is_none());
    assert!(std::fs::read(folder.path("plain.png")).unwrap() == std::fs::read(folder.path("ruled.png")).unwrap());
    for (rule, count) in [("own", "slab_tests"), ("own", "intersection_tests"), ("a4b", "rays_not_sent")] {
        assert!(ruled["rules"][rule][count].as_u64() > Some(0), "{rule} {count}");
    }
    assert!(ruled["cycles"].as_u64() < plain["cycles"].as_u64());
    let bytes = |stats: &serde_json::Value| {
        let rays = &stats["messages"]["virtual_object"];
        rays["bytes"].as_u64().unwrap() as f64 / rays["sent"].as_u64().unwrap() as f64
    };
    assert_eq!((bytes(&plain), bytes(&ruled)), (52.0, 56.0));
    folder.run("replay ruled.tasks --on ipsc2 --stats again.json").success();
    let again: serde_json::Value = serde_json::from_str(&folder.read("again.json")).unwrap();
    assert_eq!((&again["cycles"], &again["rules"]), (&ruled["cycles"], &ruled["rules"]));
    let refused = folder.run("ipsc2 gears --size 8x6 --nodes 2 --rules a4c --hits h.csv").refused();
    assert!(refused.contains("--hits"), "{refused}");
    folder.file("s.ron", "(scene: \"room\", size: \"8x6\", on: \"ipsc2\", nodes: 2, rules: [\"none\", \"own+a4b\"])");
    folder.run("sweep s.ron -o t.csv").success();
    let table = folder.read("t.csv");
    assert!(table.contains(",none,") && table.contains(",own+a4b,"), "{table}");
}
