//! G_v: the rays, by kind and generation or one by one.

use std::collections::BTreeMap;
use std::str::FromStr;

use super::graph::{Graph, number, text, whole};
use super::real::Objects;
use crate::error::InputError;
use crate::geometry::Hit;
use crate::host::camera::ImageSize;
use crate::host::shading::RayKind;
use crate::measure::JobSpan;

/// A ray of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayNote {
    /// The number of its pixel, line by line; of a file's rays, its own.
    pub pixel: u32,
    /// What it is for.
    pub kind: RayKind,
    /// Its distance from the ray from the eye.
    pub generation: u8,
    /// The place among all of the ray whose hit asked for it.
    pub parent: Option<u32>,
    /// Its first hit.
    pub hit: Hit,
    /// The region that it starts in; `None` if all processes have it.
    pub region: Option<u16>,
    /// How many regions worked on it.
    pub legs: u32,
    /// Cycles of work on it, of all processes together.
    pub cycles: u64,
    /// From when to when it was under way, if that was watched.
    pub span: Option<JobSpan>,
}

/// Some pixels of an image: from the first to before the last, along both sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelWindow {
    /// The first and the column behind the last.
    pub columns: [u32; 2],
    /// The same of lines.
    pub lines: [u32; 2],
}

/// The most rays that a graph has one by one.
const MOST_RAYS: usize = 10_000;

impl FromStr for PixelWindow {
    type Err = String;

    fn from_str(text: &str) -> Result<PixelWindow, String> {
        let range = |text: &str| {
            let (from, until) = text.split_once("..")?;
            let ends = [from.parse().ok()?, until.parse().ok()?];
            (ends[0] < ends[1]).then_some(ends)
        };
        let window = || {
            let (columns, lines) = text.split_once(',')?;
            Some(PixelWindow { columns: range(columns)?, lines: range(lines)? })
        };
        window()
            .ok_or_else(|| "expected columns and lines, the first number below the second: 10..20,40..44".to_owned())
    }
}

impl PixelWindow {
    fn holds(&self, [x, y]: [u32; 2]) -> bool {
        (self.columns[0]..self.columns[1]).contains(&x) && (self.lines[0]..self.lines[1]).contains(&y)
    }

    /// Fails if it reaches out of an image.
    pub fn check(&self, size: ImageSize) -> Result<(), InputError> {
        if self.columns[1] <= size.width && self.lines[1] <= size.height {
            return Ok(());
        }
        let error =
            InputError::new(format!("the pixels asked for reach beyond the image, which has {}", String::from(size)));
        Err(error.help("columns and lines are counted from 0, and the last is not among them"))
    }
}

/// The graph of the rays: those of a kind, generation and region are one vertex.
pub fn graph(rays: &[RayNote], objects: &Objects) -> Graph {
    #[derive(Default)]
    struct Sum {
        rays: u64,
        hits: u64,
        legs: u64,
        cycles: u64,
    }
    let group = |ray: &RayNote| (ray.generation, ray.kind as usize, ray.region);
    let mut sums: BTreeMap<(u8, usize, Option<u16>), Sum> = BTreeMap::new();
    let mut asks: BTreeMap<_, u64> = BTreeMap::new();
    let mut hits: BTreeMap<_, u64> = BTreeMap::new();
    for ray in rays {
        let sum = sums.entry(group(ray)).or_default();
        sum.rays += 1;
        sum.hits += u64::from(ray.hit.is_hit());
        sum.legs += u64::from(ray.legs);
        sum.cycles += ray.cycles;
        if let Some(parent) = ray.parent {
            *asks.entry((group(&rays[parent as usize]), group(ray))).or_default() += 1;
        }
        if let Some(object) = objects.of_hit(&ray.hit) {
            *hits.entry((group(ray), object)).or_default() += 1;
        }
    }
    let mut graph = Graph::new("G_v");
    let mut places = BTreeMap::new();
    for (group, sum) in &sums {
        let &(generation, kind, region) = group;
        let kind = RayKind::ALL[kind].name();
        let at = region.map_or(String::new(), |region| format!("-region{region}"));
        let mut attributes = vec![
            text("label", format!("{kind} {generation}{}", at.replace("-region", " in region "))),
            text("kind", kind),
            whole("generation", generation.into()),
        ];
        attributes.extend(region.map(|region| whole("region", region.into())));
        attributes.extend([
            whole("rays", sum.rays),
            whole("hits", sum.hits),
            whole("legs", sum.legs),
            whole("cycles", sum.cycles),
        ]);
        places.insert(*group, graph.add_vertex(format!("{kind}{generation}{at}"), attributes));
    }
    let object_places = objects.add_hit(&mut graph, hits.keys().map(|(_, object)| *object));
    for ((from, to), count) in asks {
        graph.add_edge(places[&from], places[&to], vec![text("relation", ASKS_FOR), whole("rays", count)]);
    }
    for ((from, object), count) in hits {
        graph.add_edge(places[&from], object_places[&object], vec![text("relation", HITS), whole("rays", count)]);
    }
    graph
}

const ASKS_FOR: &str = "asks for";
const HITS: &str = "hits";

/// The graph of the rays of some pixels, one by one.
///
/// Fails if these are too many.
pub fn graph_of_pixels(
    rays: &[RayNote],
    objects: &Objects,
    (window, size): (&PixelWindow, ImageSize),
) -> Result<Graph, InputError> {
    window.check(size)?;
    let at = |ray: &RayNote| [ray.pixel % size.width, ray.pixel / size.width];
    let shown: Vec<usize> = (0..rays.len()).filter(|&ray| window.holds(at(&rays[ray]))).collect();
    if shown.len() > MOST_RAYS {
        let message =
            format!("these pixels have {} rays, and a graph of single rays has at most {MOST_RAYS}", shown.len());
        return Err(InputError::new(message).help("ask for fewer --graph-pixels, or leave them out"));
    }
    let mut graph = Graph::new("G_v");
    let mut places = BTreeMap::new();
    for &number in &shown {
        let ray = &rays[number];
        let [x, y] = at(ray);
        let mut attributes = vec![
            text("label", format!("{} {number}", ray.kind.name())),
            text("kind", ray.kind.name()),
            whole("generation", ray.generation.into()),
            whole("x", x.into()),
            whole("y", y.into()),
        ];
        attributes.extend(ray.region.map(|region| whole("region", region.into())));
        attributes.extend([whole("legs", ray.legs.into()), whole("cycles", ray.cycles)]);
        if let Some(JobSpan { from, until, .. }) = ray.span {
            attributes.extend([whole("start_cycle", from.0), whole("end_cycle", until.0)]);
        }
        if ray.hit.is_hit() {
            attributes.extend([whole("polygon", ray.hit.polygon.into()), number_of("t", ray.hit.t)]);
        }
        places.insert(number, graph.add_vertex(format!("ray{number}"), attributes));
    }
    let hit = |&number: &usize| Some((number, objects.of_hit(&rays[number].hit)?));
    let hits: Vec<(usize, usize)> = shown.iter().filter_map(hit).collect();
    let object_places = objects.add_hit(&mut graph, hits.iter().map(|(_, object)| *object));
    for number in &shown {
        if let Some(parent) = rays[*number].parent.and_then(|parent| places.get(&(parent as usize))) {
            graph.add_edge(*parent, places[number], vec![text("relation", ASKS_FOR)]);
        }
    }
    for (number, object) in hits {
        graph.add_edge(places[&number], object_places[&object], vec![text("relation", HITS)]);
    }
    Ok(graph)
}

fn number_of(name: &str, t: f32) -> (String, super::Value) {
    number(name, t.into())
}
