//! Rules of the chapter on graphs that are not offered: A3, which is wrong for meshes, and A6, which is right and does what the grid does
//! with less. docs/beyond.md has what both would come to.

use std::collections::BTreeMap;

use glam::Vec3;
use pcs_sim::geometry::partition::reached;
use pcs_sim::geometry::polygon::flat_bounds;
use pcs_sim::geometry::{Bounds, Hit, Polygons, Ray, RaySlabs, Slabs};
use pcs_sim::host::camera::{ImageSize, primary_rays};
use pcs_sim::program::Workload;
use pcs_sim::run::TreeRay;
use pcs_sim::scene::{Scene, builtin};
use proptest::prelude::*;

use crate::rules::{NONE, Traced, image, panes, picture, soup, traced};
use crate::support::{bits, machine, program};

/// A3, counter-example: of an object that is not closed, "inside" never ends. A ray that has entered by a pane hits what lies beyond all
/// boxes that meet the pane's.
#[test]
fn behind_a_single_pane_is_no_inside() {
    let scene = panes();
    let polygons = Polygons::new(&scene.mesh);
    let inside = Ray::new(Vec3::new(0.0, 0.1, 0.0), Vec3::Y);
    let bounds = |polygon| pcs_sim::geometry::polygon::flat_bounds(&polygons, polygon);
    assert!(bounds(0).intersection(bounds(2)).is_empty(), "the rule would not look at the triangle");
    assert!(polygons.intersect(&inside, 2, f32::INFINITY).is_some());
}

/// How many rays A3 is about, which start on the inner side of a polygon; and how many of them hit what it would not look at, as its
/// object's box does not meet that of the object that they start on.
fn treated_by_a3(scene: &Scene, polygons: &Polygons, traced: &Traced) -> (u64, u64) {
    let object = |polygon: u32| scene.mesh.object(&scene.mesh.faces()[polygon as usize]).number();
    let mut boxes: BTreeMap<_, Bounds> = BTreeMap::new();
    for polygon in 0..polygons.len() as u32 {
        let bounds = boxes.entry(object(polygon)).or_insert(Bounds::EMPTY);
        *bounds = bounds.union(flat_bounds(polygons, polygon));
    }
    let (mut inside, mut lost) = (0, 0);
    for (ray, start) in &traced.rays {
        let (first, count) = ray.children;
        for (child, hit) in &traced.rays[first as usize..][..count as usize] {
            if child.ray.direction.dot(polygons.normal(start.polygon)) < 0.0 {
                let own = boxes[&object(start.polygon)];
                inside += 1;
                lost += u64::from(hit.is_hit() && own.intersection(boxes[&object(hit.polygon)]).is_empty());
            }
        }
    }
    (inside, lost)
}

/// All polygons in the order of their boxes along an axis, one way and the other: by where they begin.
struct DepthLists {
    axis: usize,
    lists: [Vec<(f64, u32)>; 2],
}

impl DepthLists {
    /// Of polygons, along the axis next to a direction.
    fn new(polygons: &Polygons, towards: Vec3) -> DepthLists {
        let axis = (0..3).max_by(|&a, &b| towards[a].abs().total_cmp(&towards[b].abs())).unwrap();
        let sorted = |near: &dyn Fn(Bounds) -> f64| {
            let with_near = |polygon| (near(reached(polygons, &[polygon])), polygon);
            let mut list: Vec<(f64, u32)> = (0..polygons.len() as u32).map(with_near).collect();
            list.sort_by(|a, b| a.0.total_cmp(&b.0));
            list
        };
        DepthLists { axis, lists: [sorted(&|bounds| bounds.low[axis]), sorted(&|bounds| -bounds.high[axis])] }
    }

    /// A ray's first hit by A6, and how many polygons it looks at for that: from the list's first to one whose box begins behind the
    /// nearest hit by then.
    fn trace(&self, (polygons, slabs): (&Polygons, &Slabs), ray: &Ray) -> (Hit, u64) {
        let turns_back = ray.direction[self.axis] < 0.0;
        let depth = |t: f32| {
            let at = f64::from(ray.origin[self.axis]) + f64::from(t) * f64::from(ray.direction[self.axis]);
            if turns_back { -at } else { at }
        };
        let ray_slabs = RaySlabs::new(ray, polygons.largest_coordinate());
        let (mut hit, mut looked_at) = (Hit::MISS, 0);
        for &(near, polygon) in &self.lists[usize::from(turns_back)] {
            looked_at += 1;
            if hit.is_hit() && near > depth(hit.t) {
                break;
            }
            if slabs.meets(&ray_slabs, polygon) {
                hit = polygons.nearer(ray, polygon, hit);
            }
        }
        (hit, looked_at)
    }

    /// Holds all rays' hits against those that were found without, to the bit. Returns how many polygons they look at.
    fn hold(&self, polygons: &Polygons, traced: &Traced, name: &str) -> u64 {
        let slabs = Slabs::new(polygons);
        let look = |(ray, found): &(TreeRay, Hit)| {
            let (hit, looked_at) = self.trace((polygons, &slabs), &ray.ray);
            // A ray that starts farther out than the margin allows for may be off by more than boxes are grown.
            assert!(polygons.beyond_margin(ray.ray.origin) > 0.0 || bits(&hit) == bits(found), "{name}: {ray:?}");
            looked_at
        };
        traced.rays.iter().map(look).sum()
    }
}

/// What is not offered, and why, as a row of docs/beyond.md: the share of all rays that A3 is about, and how many hits it would lose; what
/// A6 looks at for a ray, and what a grid does instead.
fn reasons(name: &str) -> String {
    let (size, program) = (ImageSize { width: 24, height: 18 }, program("broadcast", 1));
    let scene = builtin::generate(name, None, None).unwrap();
    // As a run has it, whose primary rays do not stray.
    let rays = primary_rays(&scene.camera, size);
    let workload = Workload::new(&scene.mesh, &program, machine().times, &rays).unwrap();
    let (polygons, traced) = (workload.polygons(), traced(&picture(&scene, &workload, size, NONE)));
    let lists = DepthLists::new(polygons, scene.camera.at - scene.camera.from);
    let (inside, lost) = treated_by_a3(&scene, polygons, &traced);
    let looked_at = lists.hold(polygons, &traced, name);
    let (rays, counts) = (traced.rays.len() as f64, traced.rendered.counts);
    let a_ray = |count: u64| count as f64 / rays;
    format!(
        "| {name} | {:.1} | {lost} | {:.0} | {:.1} | {:.1} |\n",
        100.0 * a_ray(inside),
        a_ray(looked_at),
        a_ray(counts.voxels),
        a_ray(counts.slab_tests),
    )
}

const DOCUMENT: &str = include_str!("../../docs/beyond.md");

#[test]
fn the_documented_reasons_of_small_scenes_hold() {
    for name in ["room", "table", "valve", "chapel", "sombrero"] {
        let row = reasons(name);
        assert!(DOCUMENT.contains(&row), "docs/beyond.md has not {row}");
    }
}

/// The table itself, over all built-in scenes.
#[test]
#[ignore = "it takes minutes: run it when scenes, grid or rays have changed"]
fn the_documented_reasons_are_these() {
    let mut table = String::from(
        "| scene | A3: rays inside, % | hits lost | A6: polygons looked at a ray | grid: voxels a ray | polygons tested a ray |\n\
         | --- | ---: | ---: | ---: | ---: | ---: |\n",
    );
    table.extend(builtin::all().iter().map(|scene| reasons(scene.name)));
    assert!(DOCUMENT.contains(&table), "docs/beyond.md has another table:\n{table}");
}

/// Depths of boxes along a ray, with where each is hit, if it is.
type Depths = (f64, f64, Option<f64>);

/// A6: looks through a list until a box begins behind the best hit. Returns that hit.
fn stopped_at_first_behind(list: &[Depths]) -> Option<f64> {
    let mut best: Option<f64> = None;
    for &(near, _, hit) in list {
        if best.is_some_and(|best| near > best) {
            break;
        }
        best = [best, hit].into_iter().flatten().reduce(f64::min);
    }
    best
}

/// A6, counter-example: a list that is sorted by the boxes' middles stops before a large box that holds a nearer hit.
#[test]
fn a_list_by_middles_stops_too_soon() {
    let mut boxes: [Depths; 3] = [(4.0, 6.0, Some(5.0)), (9.0, 9.5, None), (1.0, 18.0, Some(4.5))];
    boxes.sort_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1)));
    assert_eq!(stopped_at_first_behind(&boxes), Some(5.0));
    boxes.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(stopped_at_first_behind(&boxes), Some(4.5));
}

proptest! {
    /// And sorted by where boxes begin, it never does.
    #[test]
    fn a_list_by_near_depths_finds_the_nearest_hit(boxes in prop::collection::vec((0.0f64..20.0, 0.0f64..20.0, 0.0f64..2.0), 1..20)) {
        let depths = |(near, size, share): (f64, f64, f64)| (near, near + size, (share <= 1.0).then_some(near + size * share));
        let mut boxes: Vec<Depths> = boxes.into_iter().map(depths).collect();
        boxes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let nearest = boxes.iter().filter_map(|depths| depths.2).reduce(f64::min);
        prop_assert_eq!(stopped_at_first_behind(&boxes), nearest);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// On polygons as well, with all that rounding does.
    #[test]
    fn a_list_by_near_depths_finds_the_bits_that_the_grid_finds(numbers in prop::collection::vec(any::<i8>(), 60..200)) {
        let scene = soup(&numbers);
        let polygons = Polygons::new(&scene.mesh);
        let traced = image(&scene, &program("broadcast", 1), 16, NONE);
        for towards in [Vec3::X, Vec3::Y, Vec3::Z] {
            DepthLists::new(&polygons, towards).hold(&polygons, &traced, "soup");
        }
    }
}
